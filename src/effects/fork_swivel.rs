//! A wheel fork that does not swivel freely: a friction moment against the cart's turning on the track, −M
//! tanh(Δω/ω_s), with Δω the cart's yaw rate less that of the track (thesis §4.2 names the fork's rotation missing).
//!
//! Signature: steering forces and joint_eta shift where curves begin and end, with opposite signs.

use super::{Act, Effect, Experiment, Sites, StrengthSearch, Strengths, sites};
use crate::chain_input::{Deviations, Simulation};
use crate::model::effect_definitions;

pub const EFFECT: Effect = Effect {
    definition: &effect_definitions::FORK_SWIVEL,
    discrepancy: super::ASSUMED,
    fitted: &[StrengthSearch::alone(2.0, 0.0)],
    sites: Sites::Listed(sites::everywhere),
    separated_by: Experiment::Runs,
    act: Act::Chain(act),
    ..Effect::PLAIN
};

fn act(strengths: &Strengths, _: &mut Simulation, deviations: &mut Deviations) {
    deviations.swivel += strengths.of("moment");
}
