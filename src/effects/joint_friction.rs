//! Friction in the joints: a moment M tanh(|Δω|/ω_s) against the turning of two carts against each other (Flores et al.
//! 2008, dry friction in a spherical joint).
//!
//! Signature: joint_eta and steering forces shift where curves begin and end.

use super::{Act, Effect, Experiment, Sites, StrengthSearch, Strengths, sites};
use crate::chain_input::{Deviations, Simulation};
use crate::model::effect_definitions;

pub const EFFECT: Effect = Effect {
    definition: &effect_definitions::JOINT_FRICTION,
    discrepancy: super::ASSUMED,
    fitted: &[StrengthSearch::alone(1.0, 0.0)],
    sites: Sites::Listed(sites::everywhere),
    separated_by: Experiment::Tension,
    act: Act::Chain(act),
    ..Effect::PLAIN
};

fn act(strengths: &Strengths, _: &mut Simulation, deviations: &mut Deviations) {
    deviations.joint_friction += strengths.of("moment");
}
