//! Running wheels that slide sideways: Coulomb friction −μN tanh(v/v_s) across the track (thesis §4.2 names it missing;
//! the smoothing of dry friction after Andersson, Söderberg and Björklund 2007).
//!
//! Signature: sideways motion of the carts is damped; steering forces peak less where curves begin.

use super::{Act, Effect, Experiment, Sites, StrengthSearch, Strengths, sites};
use crate::chain_input::{Deviations, Simulation};

/// Wheels that creep slower than v_s tell only μ/v_s, and what v_s is of a tyre on its rail is known to a factor of
/// about two.
const CREEP: f64 = 0.6;
use crate::model::effect_definitions;

pub const EFFECT: Effect = Effect {
    definition: &effect_definitions::WHEEL_SLIDING,
    discrepancy: CREEP,
    fitted: &[StrengthSearch { trial: 0.05, as_built: 0.0 }],
    sites: Sites::Listed(sites::everywhere),
    separated_by: Experiment::Runs,
    act: Act::Chain(act),
    ..Effect::PLAIN
};

fn act(strengths: &Strengths, _: &mut Simulation, deviations: &mut Deviations) {
    deviations.sliding += strengths.of("friction");
}
