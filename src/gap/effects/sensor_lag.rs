//! A sensor that answers late: it says F(t − τ).
//!
//! Signature: the channel's pattern is moved along the track by v τ, no other channel's.

use super::{Act, Effect, Sensed, Strength, Strengths, sites};

pub const EFFECT: Effect = Effect {
    name: "sensor_lag",
    about: "a channel that comes late",
    strengths: &[Strength {
        name: "delay",
        unit: "s",
        about: "behind the others",
        trial: 0.02,
        usual: 0.0,
        low: 0.0,
        high: 2.0,
    }],
    places: &[("channel", 1.0)],
    sites: sites::channels,
    act: Act::Sensor(act),
};

fn act(strengths: &Strengths, sensed: &mut Sensed) {
    let Some(force) = sensed.forces.get_mut(strengths.index("channel")) else { return };
    let [first, .., last] = sensed.time else { return };
    let late = strengths.of("delay") / ((last - first) / (sensed.time.len() - 1) as f64).max(1e-9);
    let (whole, share) = (late as usize, late - late.floor());
    let now = force.clone();
    // Before it began, the sensor is thought to have said the same.
    let at = |k: usize| now[k.min(now.len() - 1)];
    for (k, x) in force.iter_mut().enumerate() {
        *x = (1.0 - share) * at(k.saturating_sub(whole)) + share * at(k.saturating_sub(whole + 1));
    }
}
