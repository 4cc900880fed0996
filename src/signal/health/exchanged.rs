//! Two forces under each other's names, by their means: each is what the other should be, and neither is what it should
//! be itself.
//!
//! What is expected of running wheels and joints is that of [`implausible`](super::implausible). A steering wheel pushes,
//! never pulls, and hangs free on straights.

use super::super::Channel;
use super::super::measures::Statistics;
use super::implausible::Expected;
use crate::base::number::significant;
use std::collections::BTreeMap;

/// Shares of what is expected that count as it.
const NEAR: std::ops::RangeInclusive<f64> = 0.6..=1.6;
/// A steering wheel pulls by no more deviations than this, and as it hangs free for long, its mean is no more than so many.
const PULLS: f64 = 0.5;
const LOADED: f64 = 2.0;
/// A mean sideways is no more than this share of half a cart's weight.
const SIDEWAYS: f64 = 0.3;

/// The two, and why.
pub fn exchanged(levels: &BTreeMap<Channel, Statistics>, expected: &Expected) -> Option<([Channel; 2], String)> {
    let forces: Vec<Channel> = Channel::FORCES.into_iter().filter(|channel| levels.contains_key(channel)).collect();
    let fits =
        |channel: Channel, as_of: Channel| levels.get(&channel).is_some_and(|level| fits(as_of, level, expected));
    let pairs = forces.iter().enumerate().flat_map(|(k, a)| forces[k + 1..].iter().map(move |b| [*a, *b]));
    let mut found = pairs.filter(|&[a, b]| fits(a, b) && fits(b, a) && !fits(a, a) && !fits(b, b));
    let [a, b] = found.next()?;
    // Several would be said to be one of them.
    if found.next().is_some() {
        return None;
    }
    let mean = |channel: Channel| significant(levels.get(&channel).map_or(f64::NAN, |level| level.mean), 3);
    let why = format!(
        "{a} and {b} look exchanged: their means are {} N and {} N, each what the other should have; give their columns \
         the right names under `[columns]` in the sidecar",
        mean(a),
        mean(b)
    );
    Some(([a, b], why))
}

/// Whether a force is what a channel's should be.
fn fits(channel: Channel, level: &Statistics, expected: &Expected) -> bool {
    let half = 0.5 * expected.weight;
    match channel {
        Channel::RunLeft | Channel::RunRight => NEAR.contains(&(level.mean / half)),
        Channel::JointZeta if expected.hangs.abs() > SIDEWAYS * half => NEAR.contains(&(level.mean / expected.hangs)),
        Channel::JointZeta | Channel::JointEta => level.mean.abs() < SIDEWAYS * half,
        Channel::JointXi => NEAR.contains(&(level.mean / expected.tension)),
        Channel::SteerLeft | Channel::SteerRight => level.mean > -PULLS * level.sd && level.mean < LOADED * level.sd,
        _ => true,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn level(mean: f64, sd: f64, (min, max): (f64, f64)) -> Statistics {
        Statistics { count: 1000, mean, sd, min, max, rms: (mean * mean + sd * sd).sqrt() }
    }

    /// A lap of an oval with 700 N.
    fn lap() -> BTreeMap<Channel, Statistics> {
        BTreeMap::from([
            (Channel::SteerLeft, level(52.0, 55.0, (-2.0, 180.0))),
            (Channel::SteerRight, level(0.6, 2.6, (-2.0, 40.0))),
            (Channel::RunLeft, level(200.0, 2.0, (190.0, 212.0))),
            (Channel::RunRight, level(202.0, 2.0, (190.0, 212.0))),
            (Channel::JointXi, level(690.0, 36.0, (560.0, 800.0))),
            (Channel::JointEta, level(-6.3, 7.4, (-40.0, 20.0))),
            (Channel::JointZeta, level(-160.0, 2.0, (-170.0, -150.0))),
        ])
    }

    #[test]
    fn what_means_tell_of_two_exchanged_forces_is_told() {
        let expected = Expected { weight: 402.0, hangs: -161.0, tension: 700.0 };
        assert_eq!(exchanged(&lap(), &expected), None);
        let two = |a: Channel, b: Channel| {
            let mut levels = lap();
            let (one, other) = (levels[&a], levels[&b]);
            levels.extend([(a, other), (b, one)]);
            exchanged(&levels, &expected).map(|(two, _)| two)
        };
        // Wheels of one kind, and what is sideways beside a wheel without load, have the same means.
        let alike = [
            [Channel::SteerLeft, Channel::SteerRight],
            [Channel::RunLeft, Channel::RunRight],
            [Channel::SteerLeft, Channel::JointEta],
            [Channel::SteerRight, Channel::JointEta],
        ];
        for (k, a) in Channel::FORCES.into_iter().enumerate() {
            for b in Channel::FORCES.into_iter().skip(k + 1) {
                let told = (!alike.contains(&[a, b])).then_some([a, b]);
                assert_eq!(two(a, b), told, "{a} and {b}");
            }
        }
    }

    #[test]
    fn a_reversed_force_and_a_gain_are_no_exchange() {
        let expected = Expected { weight: 402.0, hangs: -161.0, tension: 700.0 };
        let changed = |channel: Channel, by: f64| {
            let mut levels = lap();
            if let Some(level) = levels.get_mut(&channel) {
                (level.mean, level.min, level.max) = (by * level.mean, by * level.min, by * level.max);
            }
            exchanged(&levels, &expected)
        };
        for channel in Channel::FORCES {
            for by in [-1.0, 0.001, 0.3, 2.0] {
                assert_eq!(changed(channel, by), None, "{channel} times {by}");
            }
        }
    }
}
