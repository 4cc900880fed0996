//! A sensor that hears another one: channel `second` says F₂ + k F₁.
//!
//! Signature: the first channel's pattern along the track in the second.

use super::{Act, Effect, Sensed, Strength, Strengths, sites};

pub const EFFECT: Effect = Effect {
    name: "sensor_crosstalk",
    about: "a channel that hears another",
    doubt: super::EXACT,
    strengths: &[Strength {
        name: "ratio",
        unit: "",
        about: "of the first channel in the second",
        trial: 0.03,
        usual: 0.0,
        low: -0.5,
        high: 0.5,
    }],
    places: &[("first", 1.0), ("second", 2.0)],
    sites: sites::ordered_pairs,
    act: Act::Sensor(act),
};

fn act(strengths: &Strengths, sensed: &mut Sensed) {
    let (first, second, ratio) = (strengths.index("first"), strengths.index("second"), strengths.of("ratio"));
    let Some(heard) = sensed.forces.get(first).cloned() else { return };
    if let Some(force) = sensed.forces.get_mut(second) {
        force.iter_mut().zip(heard).for_each(|(x, y)| *x += ratio * y);
    }
}
