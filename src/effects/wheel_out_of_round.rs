//! A wheel out of round, r(φ) = r₀ + a sin φ, or with a flat spot: a chord that takes its depth a from the radius once
//! a revolution (Nielsen and Johansson 2000). Wheel 1 is the steering wheels, 2 the left and 3 the right running wheel;
//! shape 1 is the flat spot.
//!
//! Signature: the wheel's force at the order of its turning, v/(2πr), and its multiples.

use super::sites::Site;
use super::{Act, Effect, Experiment, Sites, StrengthSearch, Strengths};
use crate::base::trig;
use crate::chain_input::{Deviations, Simulation};
use crate::model::effect_definitions;

pub const EFFECT: Effect = Effect {
    definition: &effect_definitions::WHEEL_OUT_OF_ROUND,
    discrepancy: super::ASSUMED,
    fitted: &[StrengthSearch { trial: 3e-5, as_built: 5e-6 }],
    sites: Sites::Listed(wheels),
    separated_by: Experiment::Speed,
    act: Act::Chain(act),
    ..Effect::PLAIN
};

fn act(strengths: &Strengths, simulation: &mut Simulation, deviations: &mut Deviations) {
    const POINTS: usize = 128;
    let (amplitude, flat) = (strengths.of("amplitude"), strengths.of("shape") > 0.5);
    let wheel = strengths.index("wheel").min(2);
    let radius = if wheel == 0 { simulation.steering_wheel.radius_m } else { simulation.running_wheel.radius_m };
    // Half the angle of a chord of that depth.
    let reach = (2.0 * amplitude / radius.max(1e-6)).sqrt().max(2.5 / POINTS as f64 * trig::TAU);
    let table = &mut deviations.wheels[wheel];
    table.resize(POINTS, 0.0);
    for (k, x) in table.iter_mut().enumerate() {
        let angle = trig::TAU * k as f64 / POINTS as f64;
        let off = (angle - trig::PI) / reach;
        // Less radius lets the cart down.
        *x += if flat { -amplitude * (1.0 - off * off).max(0.0) } else { amplitude * trig::sin(angle) };
    }
}

fn wheels(_: &Simulation) -> Vec<Site> {
    let names = ["steering wheels", "left running wheel", "right running wheel"];
    let all = names.iter().enumerate().flat_map(|(k, name)| [(k, name, 0.0), (k, name, 1.0)]);
    all.map(|(k, name, shape)| Site {
        words: if shape > 0.5 { format!("{name}, flat spot") } else { (*name).to_owned() },
        fixed: vec![("wheel", k as f64 + 1.0), ("shape", shape)],
    })
    .collect()
}
