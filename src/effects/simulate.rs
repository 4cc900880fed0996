//! Simulations of an input with its effects.

use super::{Sensed, deviations_of, sense, stiffness_temperature};
use crate::base::parallel;
use crate::chain_input::{Simulation, Unfit};
use crate::dynamics::{self, Ensemble, EnsemblePlan, Model, Outcome, Plan, Progress, Settled, Width};
use crate::signal::{Channel, Run};

/// The chain of an input with its effects.
///
/// # Errors
///
/// [`Unfit`] for an input that no chain can have, or an effect that there is not.
pub fn model(simulation: &Simulation) -> Result<Model, Unfit> {
    let (nominal, deviations) = deviations_of(simulation)?;
    Model::new(&nominal, deviations)
}

/// As [`dynamics::simulate`], of an input with its effects, those of sensors among them.
///
/// # Errors
///
/// As [`model`].
pub fn simulate(
    simulation: &Simulation,
    plan: &Plan,
    width: Width,
    watch: &mut dyn FnMut(Progress) -> bool,
) -> Result<Outcome, Unfit> {
    let (nominal, deviations) = deviations_of(simulation)?;
    let mut outcome = dynamics::simulate(&nominal, deviations, plan, width, watch)?;
    sense_run(simulation, &mut outcome.run);
    Ok(outcome)
}

/// Simulates several chains at once, on as many threads; the results, in order, do not depend on how many.
pub fn simulate_all(inputs: &[(Simulation, Plan)], width: Width, threads: usize) -> Vec<Result<Outcome, Unfit>> {
    parallel::map(inputs, threads, |(simulation, plan)| simulate(simulation, plan, width, &mut |_| true))
}

/// As [`dynamics::run_ensemble`], of an input with its effects on the chain. Those of sensors are for who reads the
/// carts' records. A stiffness that comes up in a run is what it comes to.
///
/// # Errors
///
/// As [`model`].
pub fn run_ensemble(
    simulation: &Simulation,
    ensemble: &EnsemblePlan,
    from: Option<&Settled>,
    width: Width,
) -> Result<Ensemble, Unfit> {
    let effects = stiffness_temperature::at_rest(&simulation.effects, |_| 1.0);
    let (nominal, deviations) = deviations_of(&Simulation { effects, ..simulation.clone() })?;
    dynamics::run_ensemble(&nominal, deviations, ensemble, from, width)
}

/// Puts the sensors' effects into a run.
fn sense_run(simulation: &Simulation, run: &mut Run) {
    if simulation.effects.is_empty() {
        return;
    }
    let mut forces = Channel::FORCES.map(|c| run.channels.remove(&c).unwrap_or_default());
    let top = |x: &Vec<f64>| x.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let tops = std::array::from_fn(|k| top(&forces[k]));
    let period = 1.0 / simulation.sensor.rate_hz;
    sense(simulation, &mut Sensed { time: &run.time, period, forces: &mut forces, tops });
    run.channels.extend(Channel::FORCES.into_iter().zip(forces));
}
