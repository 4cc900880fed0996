//! What simulated or measured runs of two layouts amount to, channel by channel.

use crate::base::number::tidy;
use crate::signal::measures::statistics;
use crate::signal::{Channel, Run};
use schemars::JsonSchema;
use serde::Serialize;

/// Runs of both layouts beside each other.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Forces {
    /// The runs' files, as the reader named them.
    pub before: String,
    pub after: String,
    /// Every channel that one of them has, but the trigger.
    pub channels: Vec<ChannelChange>,
}

/// A channel of both runs; absent where a run lacks it, or has no sample of it.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ChannelChange {
    /// `steer_left`
    pub channel: &'static str,
    /// Of all numbers: `N`, `rad`, `rad/s` or `°C`.
    pub unit: &'static str,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub before: Option<Moments>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub after: Option<Moments>,
}

/// What the samples of a channel amount to, in its unit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Moments {
    pub mean: f64,
    /// Standard deviation of the samples.
    pub sd: f64,
    /// The sample that is farthest from zero, with its sign.
    pub peak: f64,
}

impl Moments {
    fn of(run: &Run, channel: Channel) -> Option<Moments> {
        let found = statistics(run.channels.get(&channel)?)?;
        let peak = if found.min.abs() > found.max.abs() { found.min } else { found.max };
        let [mean, sd, peak] = [found.mean, found.sd, peak].map(tidy);
        Some(Moments { mean, sd, peak })
    }
}

impl Forces {
    /// Compares two runs, which are named as the reader named them.
    pub fn new((before_name, before): (&str, &Run), (after_name, after): (&str, &Run)) -> Forces {
        let told = Channel::ALL.into_iter().filter(|channel| *channel != Channel::Trigger);
        let change = |channel: Channel| {
            let [before, after] = [before, after].map(|run| Moments::of(run, channel));
            let is_there = before.is_some() || after.is_some();
            is_there.then_some(ChannelChange { channel: channel.name(), unit: channel.unit(), before, after })
        };
        Forces {
            before: before_name.to_owned(),
            after: after_name.to_owned(),
            channels: told.filter_map(change).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::Sidecar;

    #[test]
    fn channels_are_told_by_mean_deviation_and_peak() {
        let run = |left: &[f64], more: Option<f64>| {
            let time = (0..left.len()).map(|k| k as f64).collect();
            let mut channels = std::collections::BTreeMap::from([(Channel::SteerLeft, left.to_vec())]);
            channels.insert(Channel::Trigger, vec![0.0; left.len()]);
            channels.extend(more.map(|x| (Channel::Temperature, vec![x; left.len()])));
            Run { time, channels, sidecar: Sidecar::default() }
        };
        let found = Forces::new(
            ("a", &run(&[1.0, 3.0, f64::NAN, -5.0, 1.0], None)),
            ("b", &run(&[2.0, 2.0, 4.0, 4.0, 3.0], Some(20.0))),
        );
        let names: Vec<_> = found.channels.iter().map(|c| (c.channel, c.unit)).collect();
        assert_eq!(names, [("steer_left", "N"), ("temperature", "°C")]);
        // (1 + 3 - 5 + 1) / 4 = 0 and √((1 + 9 + 25 + 1) / 4) = 3.
        assert_eq!(found.channels[0].before, Some(Moments { mean: 0.0, sd: 3.0, peak: -5.0 }));
        assert_eq!(found.channels[0].after.map(|m| (m.mean, m.peak)), Some((3.0, 4.0)));
        assert_eq!(found.channels[1].before, None);
        assert_eq!(found.channels[1].after, Some(Moments { mean: 20.0, sd: 0.0, peak: 20.0 }));
    }
}
