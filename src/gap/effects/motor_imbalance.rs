//! A motor that gives less than it is told, or nothing: its thrust is F (1 − loss); the controller makes the others push more.
//!
//! Signature: joint_xi along the track, a slope less between motors and a step missing at one.

use super::{Act, Effect, Strength, Strengths, sites};
use crate::chain_input::Deviations;
use crate::chain_input::Simulation;

pub const EFFECT: Effect = Effect {
    name: "motor_imbalance",
    about: "a weak or dead motor",
    doubt: super::ASSUMED,
    strengths: &[Strength {
        name: "loss",
        unit: "",
        about: "of its thrust",
        trial: 0.3,
        usual: 0.01,
        low: -1.0,
        high: 1.0,
    }],
    places: &[("motor", 1.0)],
    sites: sites::motors,
    act: Act::Chain(act),
};

fn act(strengths: &Strengths, simulation: &mut Simulation, deviations: &mut Deviations) {
    let motors = simulation.motors.s_m.len();
    deviations.thrust.resize(motors, 1.0);
    if let Some(share) = deviations.thrust.get_mut(strengths.index("motor")) {
        *share *= 1.0 - strengths.of("loss");
    }
}
