//! Carts of unequal length: each is longer by what chance would give, evenly within ± the deviation, and all together
//! by nothing, as the take-up holds the tension (American Chain Association 2006: wear lengthens the pitch).
//!
//! Signature: fluctuation of joint_xi and steering forces at less than the carts' passing.

use super::{Act, Effect, Experiment, RandomEffect, Sites, StrengthSearch, Strengths, sites, spread};
use crate::chain_input::{Deviations, Simulation};
use crate::model::effect_definitions;

pub const EFFECT: Effect = Effect {
    definition: &effect_definitions::PITCH_WEAR,
    discrepancy: super::ASSUMED,
    fitted: &[StrengthSearch::alone(5e-5, 1e-5)],
    sites: Sites::Listed(sites::everywhere),
    separated_by: Experiment::Runs,
    random: Some((RandomEffect::ByCart, |_| true)),
    act: Act::Chain(act),
    ..Effect::PLAIN
};

fn act(strengths: &Strengths, simulation: &mut Simulation, deviations: &mut Deviations) {
    let deviation = strengths.of("deviation");
    deviations.pitch.resize(simulation.chain.carts, 0.0);
    deviations.pitch.iter_mut().enumerate().for_each(|(i, x)| *x += deviation * spread(i));
}
