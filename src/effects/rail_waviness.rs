//! Rails that are not quite even, as every built track's: each of the three goes off by a sum of sines whose lengths
//! are 1 to 30 m, by a as a root mean square, drawn anew for each `draw`. No diagnosis names it; it is what a diagnosis
//! expects of every chain.
//!
//! Signature: a little of everything, everywhere.

use super::{Act, Effect, Experiment, Sites, StrengthSearch, Strengths, add_profile, sites};
use crate::base::random::uniform;
use crate::base::trig;
use crate::chain_input::{Deviations, Simulation};
use crate::model::effect_definitions;

pub const EFFECT: Effect = Effect {
    definition: &effect_definitions::RAIL_WAVINESS,
    discrepancy: super::ASSUMED,
    fitted: &[StrengthSearch::alone(1e-5, 1.2e-5)],
    sites: Sites::Listed(sites::everywhere),
    separated_by: Experiment::Runs,
    act: Act::Chain(act),
    ..Effect::PLAIN
};

/// Sines of a rail, and their lengths, m.
const WAVES: usize = 16;
const LENGTHS: (f64, f64) = (1.0, 30.0);

fn act(strengths: &Strengths, simulation: &mut Simulation, deviations: &mut Deviations) {
    let lap = simulation.track.centre_line().length;
    // Sines of equal amplitude A have the root mean square A √(n/2).
    let each = strengths.of("amplitude") * (2.0 / WAVES as f64).sqrt();
    let mut state = (strengths.index("draw") as u64).wrapping_add(0x7261_696c);
    for rail in &mut deviations.rails {
        let waves: [(f64, f64); WAVES] = std::array::from_fn(|_| {
            let length = LENGTHS.0 * trig::exp(uniform(&mut state) * trig::ln(LENGTHS.1 / LENGTHS.0));
            (trig::TAU * (lap / length).round().max(1.0) / lap, trig::TAU * uniform(&mut state))
        });
        add_profile(rail, lap, |s| waves.iter().map(|(k, phase)| each * trig::sin(k * s + phase)).sum());
    }
}
