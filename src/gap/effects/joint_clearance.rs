//! Play in the joints: a joint carries no force until half of its play is used up (Flores, Ambrósio, Claro and Lankarani 2008:
//! F = K (|e| − c/2)ⁿ beyond the play, 0 within; named missing by the thesis, chapter 5).
//!
//! Signature: joint_eta and joint_zeta rattle where their forces change sign; fluctuation rises, means hardly change.

use super::{Act, Effect, Strength, Strengths, sites};
use crate::chain_input::Deviations;
use crate::chain_input::Simulation;

pub const EFFECT: Effect = Effect {
    name: "joint_clearance",
    about: "play in every joint",
    doubt: super::ASSUMED,
    strengths: &[Strength {
        name: "gap",
        unit: "m",
        about: "play from end to end",
        trial: 5e-5,
        usual: 0.0,
        low: 0.0,
        high: 2e-3,
    }],
    places: &[],
    sites: sites::everywhere,
    act: Act::Chain(act),
};

fn act(strengths: &Strengths, _: &mut Simulation, deviations: &mut Deviations) {
    deviations.clearance += strengths.of("gap");
}
