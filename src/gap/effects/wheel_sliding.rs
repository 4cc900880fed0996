//! Running wheels that slide sideways: Coulomb friction −μN tanh(v/v_s) across the track (thesis, chapter 5, names it missing; the
//! smoothing of dry friction after Andersson, Söderberg and Björklund 2007).
//!
//! Signature: sideways motion of the carts is damped; steering forces peak less where curves begin.

use super::{Act, Effect, Strength, Strengths, sites};
use crate::chain_input::Deviations;
use crate::chain_input::Simulation;

/// Wheels that creep slower than v_s tell only μ/v_s, and what v_s is of a tyre on its rail is known to a factor of about two.
const CREEP: f64 = 0.6;

pub const EFFECT: Effect = Effect {
    name: "wheel_sliding",
    about: "running wheels that slide sideways",
    doubt: CREEP,
    strengths: &[Strength {
        name: "friction",
        unit: "",
        about: "friction coefficient",
        trial: 0.05,
        usual: 0.0,
        low: 0.0,
        high: 1.0,
    }],
    places: &[],
    sites: sites::everywhere,
    act: Act::Chain(act),
};

fn act(strengths: &Strengths, _: &mut Simulation, deviations: &mut Deviations) {
    deviations.sliding += strengths.of("friction");
}
