//! A sensor that clips: it says no more than a share of the channel's largest force.
//!
//! Signature: the channel's highest forces are all the same.

use super::{Act, Effect, Sensed, Strength, Strengths, sites};

pub const EFFECT: Effect = Effect {
    name: "sensor_clipping",
    about: "a channel that clips",
    doubt: super::ASSUMED,
    strengths: &[Strength {
        name: "loss",
        unit: "",
        about: "of the channel's range, at its top",
        trial: 0.1,
        usual: 0.0,
        low: 0.0,
        high: 0.95,
    }],
    places: &[("channel", 1.0)],
    sites: sites::channels,
    act: Act::Sensor(act),
};

fn act(strengths: &Strengths, sensed: &mut Sensed) {
    let channel = strengths.index("channel");
    let Some(force) = sensed.forces.get_mut(channel) else { return };
    let limit = (1.0 - strengths.of("loss")) * sensed.tops[channel];
    force.iter_mut().for_each(|x| *x = if *x > limit { limit } else { *x });
}
