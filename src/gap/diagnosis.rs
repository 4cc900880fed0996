//! What a diagnosis found, as `gap.json` has it.

use super::simulator::Axis;
use crate::chain_input::DeclaredEffect;
use crate::identify::noise::ChannelNoise;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;

/// The answer to a gap.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "lss gap diagnosis")]
pub struct Diagnosis {
    pub verdict: Verdict,
    /// The verdict in a few sentences.
    pub summary: String,
    /// Effects with which `after`, the overlays and the closures are: those that the verdict names, or else the best.
    #[serde(rename = "with")]
    pub shown: Vec<String>,
    /// All effects of the library, the most probable first.
    pub effects: Vec<Finding>,
    /// Where the gap lies, the largest share first.
    #[serde(rename = "where")]
    pub places: Vec<GapPlace>,
    /// Probability that an effect outside the library is present.
    pub unknown_probability: f64,
    /// Probability that there is no gap.
    pub none_probability: f64,
    /// Probability of effects that could not be simulated: nothing is known of it but what was believed before.
    pub untested_probability: f64,
    /// Of each channel, how far two repeated measurements of the same are apart (root mean square of the means by
    /// place), in its unit.
    #[serde(rename = "floor")]
    pub repeatability: BTreeMap<String, f64>,
    pub next_experiment: String,
    /// Effects that these runs cannot tell apart.
    pub groups: Vec<Group>,
    /// Gap of the runs, as mean square residual over that of repeated measurements: 1 is none.
    pub runs: Vec<RunGap>,
    /// What the shown effects leave.
    #[serde(default)]
    pub unexplained: Unexplained,
    /// Whether laps of the shown effects' model leave as much; null where too few are known.
    #[serde(default)]
    pub predictive_check: Option<PredictiveCheck>,
    /// Of each run, the noise of its channels' sensors as it was found; empty where the model has none.
    #[serde(default)]
    pub noise: BTreeMap<String, BTreeMap<String, ChannelNoise>>,
    /// Gap closed on held-out runs by a black box that names nothing; null where no run is over its limit.
    pub gap_closed_black_box: Option<f64>,
    /// Of the shown effects together, in all and by channel; null where no run is over its limit.
    pub gap_closed: Option<f64>,
    pub gap_closed_channels: BTreeMap<String, f64>,
    /// What the data lacked, and what could not be simulated.
    pub lost: Vec<Lost>,
    /// Measured and simulated, before and after, of the channels with the largest shares of the gap.
    pub overlays: Vec<Overlay>,
    /// What places are counted in: `m` along the track, or `s`.
    pub axis: Axis,
    /// What is known of a model outside beside.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outside: Option<OutsideModel>,
}

/// What a model outside and its campaign tell beside the verdict.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OutsideModel {
    /// Of each channel, how far single samples are off.
    pub sample_error: BTreeMap<String, SampleError>,
    /// Of each run, its nuisances as fitted with the shown effects.
    pub nuisances: BTreeMap<String, BTreeMap<String, Amount>>,
    /// The verdict with other accuracies; empty where it does not hang on them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub by_accuracy: Vec<ByAccuracy>,
    /// What else is to be known of the answer, in sentences.
    pub remarks: Vec<String>,
}

/// A verdict with another accuracy of the model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ByAccuracy {
    /// How closely the model is believed to follow each channel, in its unit.
    pub accuracy: BTreeMap<String, f64>,
    pub verdict: Verdict,
    /// The likeliest effects with their probabilities.
    pub effects: BTreeMap<String, f64>,
    pub none_probability: f64,
    pub unknown_probability: f64,
}

/// Root mean squares of a channel's samples over all runs, in its unit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SampleError {
    /// Measured less simulated, by the nominal model with its nuisances fitted.
    pub before: f64,
    /// The same with the shown effects, nuisances fitted anew.
    pub after: f64,
    /// What counts as noise of it.
    pub noise: f64,
    pub unit: String,
    /// What was compared: `means over windows` or `samples`.
    pub compared: String,
}

/// What effects leave of a gap.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Unexplained {
    /// Of the gap of all runs; null where no run is over its limit.
    pub share: Option<f64>,
    /// The mean square that is left over that of repeated measurements, in the run in which it is farthest over its
    /// limit; and that run.
    pub times_repeatability: f64,
    pub run: String,
    /// Where what is left lies, the largest share first; empty where no run is over its limit.
    #[serde(rename = "where")]
    pub places: Vec<GapPlace>,
}

/// A posterior predictive check: what is left of the runs beside what draws of the model leave, fitted in the same way.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PredictiveCheck {
    /// Whether in every run at least one draw leaves as much. A verdict whose residual no draw shows is not certain,
    /// whatever its probability.
    pub passed: bool,
    /// By the model with the shown effects; where none is shown by the nominal one.
    pub runs: Vec<CheckedRun>,
    /// By the nominal model.
    pub no_gap: Vec<CheckedRun>,
}

/// How many draws leave as much as a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CheckedRun {
    pub run: String,
    /// Laps of the model, or repetitions of a model outside.
    pub draws: usize,
    /// How many of them leave at least the run's mean square.
    pub leave_as_much: usize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Finding {
    pub name: String,
    /// Name of the group of effects that it cannot be told from; its own when it can.
    pub group: String,
    /// Of its being present.
    pub probability: f64,
    /// The part of it that was never compared with the runs, as the effect could not be simulated.
    pub untested_probability: f64,
    pub strength: BTreeMap<String, Amount>,
    /// Of the gap on runs that took no part in fitting it; null where no run is over its limit.
    pub gap_closed: Option<f64>,
    pub gap_closed_placebo: Option<f64>,
    /// Where it sits, in words; empty when it has no place.
    pub place: String,
    /// What says the place, as an `effect` of a layout takes it.
    pub fixed: BTreeMap<String, f64>,
    /// The shape that it gives a wheel, a rail or the motors' thrust; null where it gives none.
    pub shape: Option<Shape>,
    /// Where else it sits, with its strengths there.
    pub elsewhere: Vec<Elsewhere>,
}

/// Another place of an effect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Elsewhere {
    /// In words.
    pub place: String,
    /// What says the place, as an `effect` of a layout takes it.
    pub fixed: BTreeMap<String, f64>,
    pub strength: BTreeMap<String, Amount>,
}

impl Elsewhere {
    fn at_place(&self) -> AtPlace<'_> {
        AtPlace { place: &self.place, fixed: &self.fixed, strength: &self.strength }
    }
}

/// An effect at one of its places.
#[derive(Clone, Copy, Debug)]
pub struct AtPlace<'a> {
    pub place: &'a str,
    pub fixed: &'a BTreeMap<String, f64>,
    pub strength: &'a BTreeMap<String, Amount>,
}

/// A shape of a wheel or a rail, or that of a thrust, with the ends of its strengths' 90 % intervals.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Shape {
    /// What has it, and which way it counts.
    pub of: String,
    /// Unit of the places: `rad` around a wheel, `m` along the track or over a motor.
    pub over: String,
    /// Unit of `value`, `low` and `high`: `m`, or empty for a share.
    pub unit: String,
    pub at: Vec<f64>,
    /// How far it is off.
    pub value: Vec<f64>,
    pub low: Vec<f64>,
    pub high: Vec<f64>,
}

/// A fitted strength with its 90 % interval.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Amount {
    pub value: f64,
    pub low: f64,
    pub high: f64,
    pub unit: String,
    /// Which of its declared bounds the value is at, if it is: the truth may lie beyond.
    pub at_bound: Option<Bound>,
    /// What each run has, where runs have strengths of their own; `value` is the largest of them then.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub by_run: BTreeMap<String, f64>,
}

/// An end of what a strength may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Bound {
    Lower,
    Upper,
}

/// A part of the gap.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "Place")]
pub struct GapPlace {
    pub channel: String,
    #[serde(flatten)]
    pub extent: Extent,
    pub band: String,
    /// Of the whole gap.
    pub share: f64,
}

/// A stretch of the axis; the names of its ends say the unit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Extent {
    /// Along the track.
    Track { from_m: f64, to_m: f64 },
    /// In time.
    Time { from_s: f64, to_s: f64 },
}

impl Extent {
    pub fn new(axis: Axis, from: f64, to: f64) -> Extent {
        match axis {
            Axis::Track => Extent::Track { from_m: from, to_m: to },
            Axis::Time => Extent::Time { from_s: from, to_s: to },
        }
    }

    /// m or s
    pub fn length(&self) -> f64 {
        self.ends().1 - self.ends().0
    }

    /// m or s
    pub fn middle(&self) -> f64 {
        0.5 * (self.ends().0 + self.ends().1)
    }

    /// First and last place, m or s.
    pub fn ends(&self) -> (f64, f64) {
        match *self {
            Extent::Track { from_m, to_m } => (from_m, to_m),
            Extent::Time { from_s, to_s } => (from_s, to_s),
        }
    }
}

/// Effects that these runs cannot tell apart.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Group {
    pub name: String,
    pub members: Vec<String>,
    /// What would separate them.
    pub experiment: String,
}

/// The gap of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RunGap {
    pub run: String,
    /// Mean square residual over that of repeated measurements, of the nominal model and with the shown effects.
    pub before: f64,
    pub after: f64,
    /// What repeated measurements have, mean and upper 95 %: the limit over which there is a gap.
    #[serde(rename = "honest")]
    pub replicate: f64,
    #[serde(rename = "honest_high")]
    pub replicate_high: f64,
}

/// A channel of a run over a stretch: the features of one kind of deviation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Overlay {
    pub run: String,
    pub channel: String,
    /// Which kind of deviation, as in `where`.
    pub band: String,
    pub unit: String,
    /// Places in the unit of `axis`, or numbers of the features, from 1, of what belongs to no place.
    pub at: Vec<f64>,
    pub measured: Vec<f64>,
    pub before: Vec<f64>,
    pub after: Vec<f64>,
    /// Deviation of repeated measurements.
    #[serde(rename = "floor")]
    pub repeatability: Vec<f64>,
}

/// What cannot be told, and why. Of an effect that could not be simulated, the first request that failed.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Lost {
    /// Empty where it is the data that lack something.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub effect: String,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub place: String,
    /// Strengths that were asked for.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub strength: BTreeMap<String, f64>,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub run: String,
    pub why: String,
}

impl Lost {
    /// Of the data, in a sentence.
    pub fn data(why: impl Into<String>) -> Lost {
        Lost { why: why.into(), ..Lost::default() }
    }
}

impl fmt::Display for Lost {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.effect.is_empty() && self.run.is_empty() {
            return f.write_str(&self.why);
        }
        let number = crate::base::number::shortest;
        let strengths = self.strength.iter().map(|(name, x)| format!("{name} {}", number(*x)));
        let with: Vec<String> =
            Some(self.place.clone()).filter(|p| !p.is_empty()).into_iter().chain(strengths).collect();
        f.write_str(if self.effect.is_empty() { "the model" } else { &self.effect })?;
        if !with.is_empty() {
            write!(f, " ({})", with.join(", "))?;
        }
        write!(f, " could not be simulated in run {}: {}", self.run, self.why)
    }
}

impl Amount {
    /// Whether its interval holds 0, so that the effect may not be there.
    pub fn may_be_zero(&self) -> bool {
        self.low <= 0.0 && 0.0 <= self.high
    }
}

impl RunGap {
    /// Whether it is farther off than 95 % of repeated measurements: only then it has a gap.
    pub fn over(&self) -> bool {
        self.before > self.replicate_high
    }

    /// Whether the shown effects leave no more than that.
    pub fn settled(&self) -> bool {
        self.after <= self.replicate_high
    }
}

impl Finding {
    /// Whether a part of it could not be simulated.
    pub fn untested(&self) -> bool {
        self.untested_probability > 0.0
    }

    /// Whether none of its strengths is known not to be 0, at any place.
    pub fn may_be_absent(&self) -> bool {
        !self.strength.is_empty() && self.places().flat_map(|at| at.strength.values()).all(Amount::may_be_zero)
    }

    /// All places where it sits, the one that is told first before those elsewhere.
    pub fn places(&self) -> impl Iterator<Item = AtPlace<'_>> {
        let first = AtPlace { place: &self.place, fixed: &self.fixed, strength: &self.strength };
        std::iter::once(first).chain(self.elsewhere.iter().map(Elsewhere::at_place))
    }
}

impl Finding {
    /// As a simulation input has it, at each of its places.
    pub fn declared(&self) -> impl Iterator<Item = DeclaredEffect> + '_ {
        self.places().map(|at| {
            let strengths = at.strength.iter().map(|(name, amount)| (name.clone(), amount.value));
            let places = at.fixed.iter().map(|(name, x)| (name.clone(), *x));
            DeclaredEffect { name: self.name.clone(), strengths: strengths.chain(places).collect() }
        })
    }
}

impl Diagnosis {
    /// The effects that the verdict names; never one that may be absent.
    pub fn named(&self) -> Vec<&Finding> {
        match self.verdict {
            Verdict::None | Verdict::Unknown => Vec::new(),
            _ => self.with().into_iter().filter(|f| !f.may_be_absent()).collect(),
        }
    }

    /// The effects that are shown, whether the verdict names them or not.
    pub fn with(&self) -> Vec<&Finding> {
        self.shown.iter().filter_map(|name| self.effects.iter().find(|f| f.name == *name)).collect()
    }

    /// Whether a run is over its limit: without that there is nothing to close.
    pub fn has_gap(&self) -> bool {
        self.runs.iter().any(RunGap::over)
    }

    /// Whether what is named explains the gap: it leaves no run over its limit, and closes something on runs that were
    /// left out.
    pub fn explained(&self) -> bool {
        let closes = self.gap_closed.is_some_and(|closed| closed > 0.0);
        self.has_gap() && closes && self.runs.iter().all(RunGap::settled) && !self.named().is_empty()
    }

    /// What the shown effects leave in the run in which it is farthest over its limit, over that limit.
    pub fn left(&self) -> f64 {
        self.runs.iter().map(|run| run.after / run.replicate_high).fold(0.0, f64::max)
    }

    /// Of the runs that no draw of the named effects' model leaves as much as, the one that is farthest over its limit: the
    /// verdict is not certain then.
    pub fn in_doubt(&self) -> Option<&CheckedRun> {
        let check = self.predictive_check.as_ref().filter(|check| !check.passed && !self.named().is_empty())?;
        let over = |run: &CheckedRun| {
            let own = self.runs.iter().find(|own| own.run == run.run);
            own.map_or(0.0, |own| own.after / own.replicate_high)
        };
        let none = check.runs.iter().filter(|run| run.leave_as_much == 0);
        none.max_by(|a, b| over(a).total_cmp(&over(b)))
    }

    /// Effects of which something could not be simulated.
    pub fn untested(&self) -> Vec<&Finding> {
        self.effects.iter().filter(|f| f.untested()).collect()
    }

    /// Shares of the gap by channel, the largest first.
    pub fn channels(&self) -> Vec<(String, f64)> {
        ranked(&self.places)
    }
}

/// Shares of the gap by channel, the largest first.
pub fn ranked(places: &[GapPlace]) -> Vec<(String, f64)> {
    let mut shares: BTreeMap<&str, f64> = BTreeMap::new();
    let known = places.iter().filter(|p| p.share > 0.0);
    known.for_each(|p| *shares.entry(&p.channel).or_default() += p.share);
    let mut all: Vec<(String, f64)> = shares.into_iter().map(|(channel, share)| (channel.to_owned(), share)).collect();
    all.sort_by(|a, b| b.1.total_cmp(&a.1));
    all
}
