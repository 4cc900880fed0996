//! Ripple of a linear motor's thrust: F (1 + Σ aₙ sin(2πnd/λ + φₙ)), n from 1 to 3, with the plate's way d over the motor.
//! Cogging and ripple repeat with the pole pitch, with harmonics (Jahns and Soong 1996; Gieras, Piech and Tomczuk 2012).
//!
//! Signature: joint_xi and the chain's speed at v/λ, and at its multiples. A power says nothing of a phase, so that phases
//! are not fitted. A harmonic alone is the fundamental of a shorter pitch: it is looked for only beside the fundamental.

use super::sites::Site;
use super::{Act, Effect, Experiment, Sites, StrengthSearch, Strengths};
use crate::chain_input::{Deviations, Ripple, Simulation};
use crate::model::effect_definitions;

pub const EFFECT: Effect = Effect {
    definition: &effect_definitions::MOTOR_RIPPLE,
    discrepancy: super::ASSUMED,
    fitted: &[StrengthSearch::alone(0.1, 0.0), StrengthSearch::beside(0.1), StrengthSearch::beside(0.1)],
    sites: Sites::Listed(wavelengths),
    separated_by: Experiment::Speed,
    alternatives: |site, _| alternatives(site),
    act: Act::Chain(act),
    ..Effect::PLAIN
};

fn act(strengths: &Strengths, _: &mut Simulation, deviations: &mut Deviations) {
    let wavelength = strengths.of("wavelength").max(1e-3);
    deviations.ripple = Ripple {
        ratios: ["ratio", "twice", "thrice"].map(|name| strengths.of(name)),
        wavelength,
        phases: ["phase", "twice_phase", "thrice_phase"].map(|name| strengths.of(name)),
    };
}

fn wavelengths(simulation: &Simulation) -> Vec<Site> {
    let length = simulation.motors.length_m;
    [0.5, 0.2, 0.1, 0.05].map(|share| site(share * length)).to_vec()
}

fn site(wavelength: f64) -> Site {
    Site { words: format!("every {:.0} mm", 1e3 * wavelength), fixed: vec![("wavelength", wavelength)] }
}

/// Wavelengths between this one and the next, and beside each of them such as hardly differ.
fn alternatives(ripple: &Site) -> Vec<(Site, Vec<Site>)> {
    let Some(wavelength) = ripple.of("wavelength") else { return Vec::new() };
    let of = |share: f64| site(share * wavelength);
    let near = |share: f64| [0.96, 1.04].map(|other| of(share * other)).to_vec();
    [0.7, 0.78, 0.85, 0.92, 1.08, 1.18, 1.3, 1.43].map(|share| (of(share), near(share))).to_vec()
}
