//! Crosstalk of one sensor into another: channel `second` says F₂ + k F₁.
//!
//! Signature: the first channel's pattern along the track in the second.

use super::{Act, Effect, Experiment, Sensed, Sites, StrengthSearch, Strengths, sites};
use crate::model::effect_definitions;

pub const EFFECT: Effect = Effect {
    definition: &effect_definitions::SENSOR_CROSSTALK,
    discrepancy: super::EXACT,
    fitted: &[StrengthSearch::alone(0.03, 0.0)],
    sites: Sites::Listed(sites::ordered_pairs),
    separated_by: Experiment::Sensors,
    act: Act::Sensor(act),
    ..Effect::PLAIN
};

fn act(strengths: &Strengths, sensed: &mut Sensed) {
    let (first, second, ratio) = (strengths.index("first"), strengths.index("second"), strengths.of("ratio"));
    let Some(other) = sensed.forces.get(first).cloned() else { return };
    if let Some(force) = sensed.forces.get_mut(second) {
        force.iter_mut().zip(other).for_each(|(x, y)| *x += ratio * y);
    }
}
