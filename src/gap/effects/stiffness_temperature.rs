//! Wheels and joints that soften as they warm: every stiffness is K (1 + change), and the damping of a contact in proportion (Ferry
//! 1980: polymers' moduli fall with temperature).
//!
//! Signature: fluctuation at the carts' passing, less in stiff channels than in soft ones.

use super::{Act, Effect, Strength, Strengths, sites};
use crate::chain_input::Deviations;
use crate::chain_input::Simulation;

pub const EFFECT: Effect = Effect {
    name: "stiffness_temperature",
    about: "stiffness that went with temperature",
    doubt: super::ASSUMED,
    strengths: &[Strength {
        name: "change",
        unit: "",
        about: "relative change of stiffness",
        trial: 0.1,
        usual: 0.01,
        low: -0.8,
        high: 2.0,
    }],
    places: &[],
    sites: sites::everywhere,
    act: Act::Chain(act),
};

fn act(strengths: &Strengths, simulation: &mut Simulation, _: &mut Deviations) {
    let factor = 1.0 + strengths.of("change");
    for contact in [
        &mut simulation.joint.axial,
        &mut simulation.joint.radial,
        &mut simulation.steering_wheel.contact,
        &mut simulation.running_wheel.contact,
    ] {
        contact.stiffness_n_per_m_n *= factor;
    }
}
