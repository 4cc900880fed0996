//! Carts that bend: their compliance adds to that of the joint across the chain, 1/K + c at the joint's static load
//! (Shabana 2013, flexible bodies by their static modes).
//!
//! Signature: joint_eta and joint_zeta fluctuate less and their resonance falls.

use super::{Act, Effect, Experiment, Sites, StrengthSearch, Strengths, sites};
use crate::chain_input::{Deviations, Simulation};
use crate::dynamics::law::tangent;
use crate::model::effect_definitions;

pub const EFFECT: Effect = Effect {
    definition: &effect_definitions::CART_BENDING,
    discrepancy: super::ASSUMED,
    fitted: &[StrengthSearch::alone(2e-7, 0.0)],
    sites: Sites::Listed(sites::everywhere),
    separated_by: Experiment::Tension,
    act: Act::Chain(act),
    ..Effect::PLAIN
};

fn act(strengths: &Strengths, simulation: &mut Simulation, _: &mut Deviations) {
    let radial = &mut simulation.joint.radial;
    // Two springs in line; the joint's own stiffness at the weight that it carries.
    let load = 0.5 * simulation.cart.mass_kg * simulation.gravity_m_s2;
    let own = tangent(radial.stiffness_n_per_m_n, radial.exponent, load);
    radial.stiffness_n_per_m_n /= 1.0 + own * strengths.of("compliance");
}
