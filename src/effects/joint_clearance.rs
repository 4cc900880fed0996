//! Play in the joints: a joint carries no force until half of its play is used up (Flores, Ambrósio, Claro and
//! Lankarani 2008: F = K (|e| − c/2)ⁿ beyond the play, 0 within; named missing by the thesis, §4.2).
//!
//! Signature: joint_eta and joint_zeta rattle where their forces change sign; fluctuation rises, means hardly change.

use super::{Act, Effect, Experiment, Sites, StrengthSearch, Strengths, sites};
use crate::chain_input::{Deviations, Simulation};
use crate::model::effect_definitions;

pub const EFFECT: Effect = Effect {
    definition: &effect_definitions::JOINT_CLEARANCE,
    discrepancy: super::ASSUMED,
    fitted: &[StrengthSearch::alone(5e-5, 0.0)],
    sites: Sites::Listed(sites::everywhere),
    separated_by: Experiment::Tension,
    act: Act::Chain(act),
    ..Effect::PLAIN
};

fn act(strengths: &Strengths, _: &mut Simulation, deviations: &mut Deviations) {
    deviations.clearance += strengths.of("gap");
}
