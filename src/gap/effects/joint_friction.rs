//! Friction in the joints: a moment M tanh(|Δω|/ω_s) against the turning of two carts against each other (Flores et al. 2008, dry
//! friction in a spherical joint).
//!
//! Signature: joint_eta and steering forces shift where curves begin and end.

use super::{Act, Effect, Strength, Strengths, sites};
use crate::chain_input::Deviations;
use crate::chain_input::Simulation;

pub const EFFECT: Effect = Effect {
    name: "joint_friction",
    about: "friction in every joint",
    doubt: super::ASSUMED,
    strengths: &[Strength {
        name: "moment",
        unit: "N m",
        about: "friction moment",
        trial: 1.0,
        usual: 0.0,
        low: 0.0,
        high: 20.0,
    }],
    places: &[],
    sites: sites::everywhere,
    act: Act::Chain(act),
};

fn act(strengths: &Strengths, _: &mut Simulation, deviations: &mut Deviations) {
    deviations.joint_friction += strengths.of("moment");
}
