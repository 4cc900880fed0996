//! A sensor with an offset that drifts: it says F + b + d t.
//!
//! Signature: the channel's means, everywhere alike or growing along the run. A sensor drifts while it warms up, so runs of
//! other days have rates of their own.

use super::{Act, Effect, Experiment, Sensed, Sites, StrengthSearch, Strengths, sites};
use crate::model::effect_definitions;

pub const EFFECT: Effect = Effect {
    definition: &effect_definitions::SENSOR_BIAS_DRIFT,
    discrepancy: super::EXACT,
    fitted: &[StrengthSearch::alone(10.0, 0.0), StrengthSearch::by_run(0.1)],
    sites: Sites::Listed(sites::channels),
    separated_by: Experiment::Sensors,
    act: Act::Sensor(act),
    ..Effect::PLAIN
};

fn act(strengths: &Strengths, sensed: &mut Sensed) {
    if let Some(force) = sensed.forces.get_mut(strengths.index("channel")) {
        let (offset, drift) = (strengths.of("offset"), strengths.of("drift"));
        force.iter_mut().zip(sensed.time).for_each(|(x, t)| *x += offset + drift * t);
    }
}
