//! Two channels exchanged, by a share of 1 for a full exchange.
//!
//! Signature: each channel has the other's pattern along the track.

use super::{Act, Effect, Experiment, Sensed, Sites, StrengthSearch, Strengths, sites};
use crate::model::effect_definitions;

pub const EFFECT: Effect = Effect {
    definition: &effect_definitions::SENSOR_SWAPPED,
    discrepancy: super::EXACT,
    fitted: &[StrengthSearch::alone(1.0, 0.0)],
    sites: Sites::Listed(sites::unordered_pairs),
    separated_by: Experiment::Sensors,
    act: Act::Sensor(act),
    ..Effect::PLAIN
};

fn act(strengths: &Strengths, sensed: &mut Sensed) {
    let (first, second, share) = (strengths.index("first"), strengths.index("second"), strengths.of("share"));
    let (Some(a), Some(b)) = (sensed.forces.get(first).cloned(), sensed.forces.get(second).cloned()) else { return };
    let mixed =
        |own: &[f64], other: &[f64]| own.iter().zip(other).map(|(x, y)| (1.0 - share) * x + share * y).collect();
    (sensed.forces[first], sensed.forces[second]) = (mixed(&a, &b), mixed(&b, &a));
}
