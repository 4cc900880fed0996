//! Drag that grows with speed, −c v² on each cart (air and splashing lubricant; Hoerner 1965): like rolling resistance in one run, but not
//! over runs of several speeds.
//!
//! Signature: joint_xi falls from motor to motor, more at higher speed.

use super::{Act, Effect, Strength, Strengths, sites};
use crate::chain_input::Deviations;
use crate::chain_input::Simulation;

pub const EFFECT: Effect = Effect {
    name: "speed_drag",
    about: "drag that grows with speed",
    doubt: super::ASSUMED,
    strengths: &[Strength {
        name: "drag",
        unit: "N s²/m²",
        about: "of a cart",
        trial: 0.3,
        usual: 0.0,
        low: -2.0,
        high: 50.0,
    }],
    places: &[],
    sites: sites::everywhere,
    act: Act::Chain(act),
};

fn act(strengths: &Strengths, _: &mut Simulation, deviations: &mut Deviations) {
    deviations.drag += strengths.of("drag");
}
