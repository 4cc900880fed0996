//! A wheel fork that does not swivel freely: a friction moment against the cart's turning on the track, −M tanh(Δω/ω_s), with Δω
//! the cart's yaw rate less that of the track (thesis, chapter 5, names the fork's rotation missing).
//!
//! Signature: steering forces and joint_eta shift where curves begin and end, with opposite signs.

use super::{Act, Effect, Strength, Strengths, sites};
use crate::chain_input::Deviations;
use crate::chain_input::Simulation;

pub const EFFECT: Effect = Effect {
    name: "fork_swivel",
    about: "a fork that swivels against friction",
    doubt: super::ASSUMED,
    strengths: &[Strength {
        name: "moment",
        unit: "N m",
        about: "friction moment of a fork",
        trial: 2.0,
        usual: 0.0,
        low: 0.0,
        high: 100.0,
    }],
    places: &[],
    sites: sites::everywhere,
    act: Act::Chain(act),
};

fn act(strengths: &Strengths, _: &mut Simulation, deviations: &mut Deviations) {
    deviations.swivel += strengths.of("moment");
}
