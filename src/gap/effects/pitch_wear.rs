//! Carts of unequal length: each is longer by what chance would give, evenly within ± the deviation, and all together by nothing, as the take-up
//! holds the tension (Conwell and Johnson 1995: chain wear is uneven pitch).
//!
//! Signature: fluctuation of joint_xi and steering forces at less than the carts' passing.

use super::{Act, Effect, Strength, Strengths, sites, spread};
use crate::chain_input::Deviations;
use crate::chain_input::Simulation;

pub const EFFECT: Effect = Effect {
    name: "pitch_wear",
    about: "carts of unequal length",
    doubt: super::ASSUMED,
    strengths: &[Strength {
        name: "deviation",
        unit: "m",
        about: "largest of a cart's length",
        trial: 5e-5,
        usual: 1e-5,
        low: 0.0,
        high: 2e-3,
    }],
    places: &[],
    sites: sites::everywhere,
    act: Act::Chain(act),
};

fn act(strengths: &Strengths, simulation: &mut Simulation, deviations: &mut Deviations) {
    let deviation = strengths.of("deviation");
    deviations.pitch.resize(simulation.chain.carts, 0.0);
    deviations.pitch.iter_mut().enumerate().for_each(|(i, x)| *x += deviation * spread(i));
}
