//! What a diagnosis found, as `gap.json` has it.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The answer to a gap.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Diagnosis {
    pub verdict: Verdict,
    /// The verdict in two sentences.
    pub summary: String,
    /// All effects of the library, the most probable first.
    pub effects: Vec<Finding>,
    /// Where the gap lies, the largest share first.
    #[serde(rename = "where")]
    pub places: Vec<Place>,
    /// Probability that an effect outside the library is present.
    pub unknown_probability: f64,
    /// Probability that there is no gap.
    pub none_probability: f64,
    /// Of each channel, how far the two-cart means of two honest laps are apart (root mean square), in its unit.
    pub floor: BTreeMap<String, f64>,
    pub next_experiment: String,
    /// Effects that these runs cannot tell apart.
    pub groups: Vec<Group>,
    /// Gap of the runs, as mean square residual over the floor's: 1 is none.
    pub runs: Vec<RunGap>,
    /// Gap closed on held-out runs by a black box that names nothing.
    pub gap_closed_black_box: Option<f64>,
    /// Of the verdict's effects together, in all and by channel.
    pub gap_closed: Option<f64>,
    pub gap_closed_channels: BTreeMap<String, f64>,
    /// What the data lacked.
    pub lost: Vec<String>,
    /// Measured and simulated, before and after, where the gap is largest.
    pub overlays: Vec<Overlay>,
    /// `m` along the track, or `s`.
    pub axis: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// One effect of the machine.
    Effect,
    /// Two of them.
    Pair,
    /// An effect of a sensor.
    Sensor,
    /// No gap.
    None,
    /// A gap that no effect of the library explains.
    Unknown,
}

/// An effect and what speaks for it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    pub name: String,
    /// Name of the group of effects that it cannot be told from; its own when it can.
    pub group: String,
    /// Of its being present.
    pub probability: f64,
    pub strength: BTreeMap<String, Amount>,
    /// Of the gap on runs that took no part in fitting it.
    pub gap_closed: Option<f64>,
    pub gap_closed_placebo: Option<f64>,
    /// Where it sits, in words; empty when it has no place.
    pub place: String,
    /// What says the place, as an `effect` of a layout takes it.
    pub fixed: BTreeMap<String, f64>,
}

/// A fitted strength with its 90 % interval.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Amount {
    pub value: f64,
    pub low: f64,
    pub high: f64,
    pub unit: String,
}

/// A part of the gap.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Place {
    pub channel: String,
    pub from_m: f64,
    pub to_m: f64,
    pub band: String,
    /// Of the whole gap.
    pub share: f64,
}

/// Effects that these runs cannot tell apart.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Group {
    pub name: String,
    pub members: Vec<String>,
    /// What would separate them.
    pub experiment: String,
}

/// The gap of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunGap {
    pub run: String,
    /// Mean square residual over the floor's, of the nominal model and with the verdict's effects.
    pub before: f64,
    pub after: f64,
    /// What honest laps have, mean and upper 95 %.
    pub honest: f64,
    pub honest_high: f64,
}

/// A channel of a run over a stretch: two-cart means.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Overlay {
    pub run: String,
    pub channel: String,
    pub unit: String,
    /// Places, m along the track, or s.
    pub at: Vec<f64>,
    pub measured: Vec<f64>,
    pub before: Vec<f64>,
    pub after: Vec<f64>,
    /// Deviation of honest laps.
    pub floor: Vec<f64>,
}
