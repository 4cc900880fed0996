//! Wheels and joints that soften as they warm: every stiffness is K (1 + change), and the damping of a contact in
//! proportion (Ferry 1980: polymers' moduli fall with temperature).
//!
//! Signature: fluctuation at the carts' passing, less in stiff channels than in soft ones.

use super::{Act, Effect, Experiment, Sites, StrengthSearch, Strengths, sites};
use crate::chain_input::{Deviations, Simulation};
use crate::model::effect_definitions;

pub const EFFECT: Effect = Effect {
    definition: &effect_definitions::STIFFNESS_TEMPERATURE,
    discrepancy: super::ASSUMED,
    fitted: &[StrengthSearch { trial: 0.1, as_built: 0.01 }],
    sites: Sites::Listed(sites::everywhere),
    separated_by: Experiment::Tension,
    act: Act::Chain(act),
    ..Effect::PLAIN
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
