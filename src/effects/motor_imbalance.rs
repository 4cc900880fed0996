//! A motor that gives less than it is told, or nothing: its thrust is F (1 − loss); the controller makes the others
//! push more.
//!
//! Signature: joint_xi along the track, a slope less between motors and a step missing at one.

use super::{Act, Effect, Experiment, Sites, StrengthSearch, Strengths, sites};
use crate::chain_input::{Deviations, Simulation};
use crate::model::effect_definitions;

pub const EFFECT: Effect = Effect {
    definition: &effect_definitions::MOTOR_IMBALANCE,
    discrepancy: super::ASSUMED,
    fitted: &[StrengthSearch::alone(0.3, 0.01)],
    sites: Sites::Listed(sites::motors),
    several: true,
    separated_by: Experiment::Motors,
    act: Act::Chain(act),
    ..Effect::PLAIN
};

fn act(strengths: &Strengths, simulation: &mut Simulation, deviations: &mut Deviations) {
    let motors = simulation.motors.s_m.len();
    deviations.thrust.resize(motors, 1.0);
    if let Some(share) = deviations.thrust.get_mut(strengths.index("motor")) {
        *share *= 1.0 - strengths.of("loss");
    }
}
