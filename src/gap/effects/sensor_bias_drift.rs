//! A sensor with an offset that drifts: it says F + b + d t.
//!
//! Signature: the channel's means, everywhere alike or growing along the run.

use super::{Act, Effect, Sensed, Strength, Strengths, sites};

pub const EFFECT: Effect = Effect {
    name: "sensor_bias_drift",
    about: "an offset that drifts",
    doubt: super::EXACT,
    strengths: &[
        Strength {
            name: "offset",
            unit: "N",
            about: "from the beginning",
            trial: 10.0,
            usual: 0.0,
            low: -2e3,
            high: 2e3,
        },
        Strength { name: "drift", unit: "N/s", about: "of the offset", trial: 0.1, usual: 0.0, low: -50.0, high: 50.0 },
    ],
    places: &[("channel", 1.0)],
    sites: sites::channels,
    act: Act::Sensor(act),
};

fn act(strengths: &Strengths, sensed: &mut Sensed) {
    if let Some(force) = sensed.forces.get_mut(strengths.index("channel")) {
        let (offset, drift) = (strengths.of("offset"), strengths.of("drift"));
        force.iter_mut().zip(sensed.time).for_each(|(x, t)| *x += offset + drift * t);
    }
}
