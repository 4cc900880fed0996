//! A run as a sensor cart would bring it home.

use lss::chain_input::Simulation;
use lss::dynamics::{End, Plan, Width};
use lss::effects::simulate;
use lss::signal::Run;

/// Of a real chain, by steps as short as it asks for; the sidecar has the nominal values.
pub fn record(real: &Simulation, nominal: &Simulation, mut plan: Plan) -> Run {
    let mut run = loop {
        let outcome = simulate(real, &plan, Width::widest(), &mut |_| true).expect("a chain");
        if outcome.end == End::Complete {
            break outcome.run;
        }
        // Damping at the joints may ask for shorter steps.
        plan.step = plan.step.map(|h| 0.5 * h);
    };
    run.sidecar.speed_setpoint = nominal.chain.speed_m_s;
    run.sidecar.tension_setpoint = Some(nominal.chain.tension_n);
    run.sidecar.trigger_position = nominal.sensor.photocell_s_m;
    run
}
