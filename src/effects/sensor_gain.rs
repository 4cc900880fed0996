//! A sensor whose gain is off: it says g F.
//!
//! Signature: the channel's means and fluctuation in proportion, no other channel.

use super::{Act, Effect, Experiment, Sensed, Sites, StrengthSearch, Strengths, sites};
use crate::model::effect_definitions;

pub const EFFECT: Effect = Effect {
    definition: &effect_definitions::SENSOR_GAIN,
    discrepancy: super::EXACT,
    fitted: &[StrengthSearch::alone(0.05, 0.0)],
    sites: Sites::Listed(sites::channels),
    separated_by: Experiment::Sensors,
    act: Act::Sensor(act),
    ..Effect::PLAIN
};

fn act(strengths: &Strengths, sensed: &mut Sensed) {
    if let Some(force) = sensed.forces.get_mut(strengths.index("channel")) {
        let gain = 1.0 + strengths.of("gain");
        force.iter_mut().for_each(|x| *x *= gain);
    }
}
