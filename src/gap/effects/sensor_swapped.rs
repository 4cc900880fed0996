//! Two channels exchanged, by a share of 1 for a full exchange.
//!
//! Signature: each channel has the other's pattern along the track.

use super::{Act, Effect, Sensed, Strength, Strengths, sites};

pub const EFFECT: Effect = Effect {
    name: "sensor_swapped",
    about: "two channels exchanged",
    doubt: super::EXACT,
    strengths: &[Strength {
        name: "share",
        unit: "",
        about: "1 for exchanged",
        trial: 1.0,
        usual: 0.0,
        // Plugs are exchanged or not: less would be a gain with a crosstalk.
        low: 0.5,
        high: 1.0,
    }],
    places: &[("first", 1.0), ("second", 2.0)],
    sites: sites::unordered_pairs,
    act: Act::Sensor(act),
};

fn act(strengths: &Strengths, sensed: &mut Sensed) {
    let (first, second, share) = (strengths.index("first"), strengths.index("second"), strengths.of("share"));
    let (Some(a), Some(b)) = (sensed.forces.get(first).cloned(), sensed.forces.get(second).cloned()) else { return };
    let mixed =
        |own: &[f64], other: &[f64]| own.iter().zip(other).map(|(x, y)| (1.0 - share) * x + share * y).collect();
    (sensed.forces[first], sensed.forces[second]) = (mixed(&a, &b), mixed(&b, &a));
}
