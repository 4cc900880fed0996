//! A sensor whose gain is off: it says g F.
//!
//! Signature: the channel's means and fluctuation in proportion, no other channel.

use super::{Act, Effect, Sensed, Strength, Strengths, sites};

pub const EFFECT: Effect = Effect {
    name: "sensor_gain",
    about: "a gain that is off",
    doubt: super::EXACT,
    strengths: &[Strength {
        name: "gain",
        unit: "",
        about: "change of the gain, g − 1",
        trial: 0.05,
        usual: 0.0,
        low: -0.9,
        high: 3.0,
    }],
    places: &[("channel", 1.0)],
    sites: sites::channels,
    act: Act::Sensor(act),
};

fn act(strengths: &Strengths, sensed: &mut Sensed) {
    if let Some(force) = sensed.forces.get_mut(strengths.index("channel")) {
        let gain = 1.0 + strengths.of("gain");
        force.iter_mut().for_each(|x| *x *= gain);
    }
}
