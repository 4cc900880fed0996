//! A sensor that clips: it says no more than a share of the channel's largest force.
//!
//! Signature: the channel's highest forces are all the same.

use super::{Act, Effect, Experiment, Sensed, Sites, StrengthSearch, Strengths, sites};
use crate::model::effect_definitions;

pub const EFFECT: Effect = Effect {
    definition: &effect_definitions::SENSOR_CLIPPING,
    discrepancy: super::ASSUMED,
    fitted: &[StrengthSearch::alone(0.1, 0.0)],
    sites: Sites::Listed(sites::channels),
    separated_by: Experiment::Sensors,
    act: Act::Sensor(act),
    ..Effect::PLAIN
};

fn act(strengths: &Strengths, sensed: &mut Sensed) {
    let channel = strengths.index("channel");
    let Some(force) = sensed.forces.get_mut(channel) else { return };
    let limit = (1.0 - strengths.of("loss")) * sensed.tops[channel];
    force.iter_mut().for_each(|x| *x = if *x > limit { limit } else { *x });
}
