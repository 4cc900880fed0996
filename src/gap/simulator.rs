//! What the diagnosis knows of a model: parameters, effects with strengths, and "simulate this run". The chain of carts
//! is one such model, any program outside is another.

use super::ids::{CandidateId, List, PerRun, RunId};
use super::settings::Settings;
use crate::chain_input::DeclaredEffect;
use crate::effects::RandomEffect;
use crate::identify::Effort;
use crate::identify::noise::ChannelNoise;
use nalgebra::{DMatrix, DVector};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A model and the constants that its runs are compared by.
#[derive(Clone, Copy)]
pub struct Context<'a> {
    pub simulator: &'a dyn Simulator,
    pub settings: &'a Settings,
}

/// A shape of a wheel or a rail, or that of a thrust.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// What has it, in words.
    pub of: String,
    /// Unit of the places: `rad` around a wheel, `m` along the track.
    pub over: &'static str,
    /// Unit of how far it is off: `m`, or empty for a share.
    pub unit: &'static str,
    /// Places, and how far it is off there.
    pub points: Vec<(f64, f64)>,
}

/// A model whose runs can be simulated with effects.
pub trait Simulator: Sync {
    /// Effects that may be added, each at one place: an effect that may sit at several places is several candidates.
    fn candidates(&self) -> &Candidates;

    /// Each run, with the nominal model already fitted to it.
    fn frames(&self) -> &PerRun<Frame>;

    /// Features of a run with its nuisances moved by a step and effects added, in the order of its frame's labels.
    /// `None` where nothing can be simulated. A model has this or [`Simulator::simulate_all`]: each is made of the
    /// other.
    fn simulate(&self, run: RunId, step: &[f64], effects: &[Applied]) -> Option<Vec<f64>> {
        let request = Request { run, step: step.to_vec(), effects: effects.to_vec() };
        self.simulate_all(&[request]).pop().flatten()
    }

    /// Effects with which the nominal model was fitted to the runs, with strengths that fit: where a search may begin.
    /// Empty where it was fitted without.
    fn begin(&self) -> &[Applied] {
        &[]
    }

    /// How many threads may work for it.
    fn threads(&self) -> usize {
        1
    }

    /// What places are counted in.
    fn axis(&self) -> Axis {
        Axis::Track
    }

    /// Why a request had no answer, in words, where that is known.
    fn reason(&self, _: &Request) -> Option<String> {
        None
    }

    /// What was simulated so far, the fits of the nominal model included.
    fn effort(&self) -> Effort {
        Effort::default()
    }

    /// The shape that an effect gives a wheel, a rail or a thrust, where it gives one: at places, or at those that show it.
    fn outline(&self, _: &Applied, _: Option<&[f64]>) -> Option<Outline> {
        None
    }

    /// Of each run, the noise of its channels' sensors, where the model has some.
    fn noise(&self) -> BTreeMap<String, BTreeMap<String, ChannelNoise>> {
        BTreeMap::new()
    }

    /// Whether effects of sensors cost no simulation where nuisances are not moved.
    fn applies_sensor_models(&self) -> bool {
        false
    }

    /// Of each request, replicate laps with its effects, in place of its frame's. `None` where the frame's hold or
    /// nothing is known.
    fn laps_all(&self, requests: &[Request]) -> Vec<Option<Laps>> {
        vec![None; requests.len()]
    }

    /// Features of several requests, in order; the answer does not depend on how many threads are used.
    fn simulate_all(&self, requests: &[Request]) -> Vec<Option<Vec<f64>>> {
        requests.iter().map(|r| self.simulate(r.run, &r.step, &r.effects)).collect()
    }
}

/// What places are counted in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Axis {
    /// Metres along the track.
    #[default]
    #[serde(rename = "m")]
    Track,
    /// Seconds.
    #[serde(rename = "s")]
    Time,
}

impl Axis {
    pub fn unit(self) -> &'static str {
        match self {
            Axis::Track => "m",
            Axis::Time => "s",
        }
    }
}

/// A simulation to be made.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    pub run: RunId,
    pub step: Vec<f64>,
    pub effects: Vec<Applied>,
}

/// An effect with its strengths.
#[derive(Clone, Debug, PartialEq)]
pub struct Applied {
    pub candidate: CandidateId,
    /// In the order of its strengths, in SI units.
    pub strengths: Vec<f64>,
}

/// All effects at all places.
pub type Candidates = List<CandidateId, Candidate>;

/// An effect at one place.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// Of the effect, as `gap.json` has it.
    pub effect: String,
    /// Where it sits, in words; empty when it has no place.
    pub place: String,
    /// What says the place, as an `effect` of a layout takes it: channel, motor, s, ...
    pub fixed: Vec<(String, f64)>,
    /// What is fitted.
    pub strengths: Vec<Strength>,
    /// Whether it is in the sensors rather than in the machine.
    pub sensor: bool,
    /// In what it differs by chance, so that laps scatter by it.
    pub random_effect: Option<RandomEffect>,
    /// By what share of itself a strength may be another in the machine, whose equation is not this one: a standard
    /// deviation.
    pub discrepancy: f64,
    /// Whether its effect may be at several places at once.
    pub several: bool,
    /// The candidate whose alternative site this is: it is screened only where that one explains something.
    pub alternative_to: Option<CandidateId>,
}

#[cfg(test)]
impl Candidate {
    /// An effect with one strength and no place.
    pub fn bare(effect: &str, trial: f64, (low, high): (f64, f64)) -> Candidate {
        let strength = Strength {
            name: "size".into(),
            unit: String::new(),
            trial,
            as_built: 0.0,
            beside: false,
            low,
            high,
            shares: PerRun::default(),
        };
        Candidate {
            effect: effect.into(),
            place: String::new(),
            fixed: Vec::new(),
            strengths: vec![strength],
            sensor: false,
            random_effect: None,
            discrepancy: 0.0,
            several: false,
            alternative_to: None,
        }
    }
}

impl Candidate {
    /// Whether an effect as an input has it is this one, whatever its strengths.
    pub fn is(&self, effect: &DeclaredEffect) -> bool {
        let same = |(name, x): &(String, f64)| effect.strengths.get(name) == Some(x);
        self.effect == effect.name && self.fixed.iter().all(same)
    }
}

/// A strength of an effect.
#[derive(Clone, Debug, PartialEq)]
pub struct Strength {
    pub name: String,
    /// SI unit; empty for a ratio.
    pub unit: String,
    /// A small one, of which the signature is taken.
    pub trial: f64,
    /// What every built machine has of it, as a deviation: that much is no gap.
    pub as_built: f64,
    /// Whether it is looked for only beside the effect's other strengths, once these explain something.
    pub beside: bool,
    /// Bounds; 0 is no effect.
    pub low: f64,
    pub high: f64,
    /// Which share of it each run has; empty where all have it as it is.
    pub shares: PerRun<f64>,
}

impl Candidate {
    /// The nearest strengths that are declared.
    pub fn bounded(&self, strengths: &[f64]) -> Vec<f64> {
        self.strengths.iter().zip(strengths).map(|(own, x)| own.bounded(*x)).collect()
    }
}

impl Strength {
    /// The nearest strength that is declared; 0 stays, as it is no effect.
    pub fn bounded(&self, x: f64) -> f64 {
        if x == 0.0 { 0.0 } else { x.max(self.low).min(self.high) }
    }

    /// What a run has of it.
    pub fn in_run(&self, x: f64, run: RunId) -> f64 {
        self.shares.at(run).map_or(x, |share| share * x)
    }

    /// How many numbers it stands for.
    pub fn count(&self) -> usize {
        self.shares.len().max(1)
    }

    /// Whether the effect is there as a whole or not at all.
    pub fn whole(&self) -> bool {
        self.low > 0.0
    }
}

/// A run as the diagnosis sees it: features, how far two replicate laps' are apart, and how they answer the nuisances.
#[derive(Clone, Debug)]
pub struct Frame {
    pub run: String,
    pub labels: Vec<Label>,
    /// NaN where a feature is missing.
    pub measured: Vec<f64>,
    /// Of the nominal model at its fit.
    pub nominal: Vec<f64>,
    pub laps: Laps,
    /// By how much features may be off together.
    pub discrepancies: Vec<Vec<f64>>,
    /// Features less the nominal ones of chains as they are built: draws of what no built chain lacks and no model has.
    pub built: Vec<Vec<f64>>,
    /// Slopes: a row a feature, a column a nuisance.
    pub slopes: DMatrix<f64>,
    /// Of each nuisance's step, mean and deviation before the run.
    pub prior: Vec<(f64, f64)>,
    /// As far as each nuisance's step can be simulated and is nearly linear.
    pub bounds: Vec<(f64, f64)>,
    /// Names of the nuisances.
    pub nuisances: Vec<String>,
}

/// How replicate laps differ.
#[derive(Clone, Debug, PartialEq)]
pub struct Laps {
    /// Of each feature, variance of the difference of two; infinite for what tells nothing.
    pub variance: Vec<f64>,
    /// Whole deviations from their mean, each a sample of the repeatability with all its correlations.
    pub scatter: Vec<Vec<f64>>,
}

/// What a feature is about.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Label {
    pub channel: String,
    pub band: Band,
    /// Of the features of its channel and band, counted along the track or in time.
    pub index: usize,
    /// Extent in mm along the track (or ms in time), so that labels sort.
    pub from: i64,
    pub to: i64,
}

/// Which kind of deviation a feature tells of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Band {
    /// Means that belong to a place.
    Track,
    /// How much a channel fluctuates at a place.
    Fluctuation,
    /// Which way a channel is struck at a place, in deviations: no part of mean squares, in which it would drown.
    Impact,
    /// How often it is low or high.
    Distribution,
    /// Power by frequency around the passing of carts.
    Cart,
    /// Power at orders of the wheels.
    Wheel,
    /// Power at orders of the motors.
    Motor,
    /// What changes slowly in time.
    Drift,
}

impl Band {
    /// The kinds that count in mean squares; of equals the last is taken first.
    pub const ALL: [Band; 7] =
        [Band::Drift, Band::Motor, Band::Wheel, Band::Cart, Band::Distribution, Band::Fluctuation, Band::Track];

    pub fn name(self) -> &'static str {
        match self {
            Band::Track => "track",
            Band::Fluctuation => "fluctuation",
            Band::Impact => "impact",
            Band::Distribution => "distribution",
            Band::Cart => "cart",
            Band::Wheel => "wheel",
            Band::Motor => "motor",
            Band::Drift => "drift",
        }
    }
}

impl Laps {
    /// As they are with other variances, each feature's deviations in proportion.
    pub fn scaled(&self, variance: Vec<f64>) -> Laps {
        let ratio = |(own, other): (&f64, &f64)| if *own > 0.0 && own.is_finite() { (other / own).sqrt() } else { 1.0 };
        let ratios: Vec<f64> = self.variance.iter().zip(&variance).map(ratio).collect();
        let lap = |lap: &Vec<f64>| lap.iter().zip(&ratios).map(|(x, ratio)| x * ratio).collect();
        Laps { scatter: self.scatter.iter().map(lap).collect(), variance }
    }
}

impl Frame {
    /// Features of the nominal model with nuisances moved by a step, as their slopes have it.
    pub fn at(&self, step: &[f64]) -> Vec<f64> {
        let moved = &self.slopes * DVector::from_column_slice(step);
        self.nominal.iter().zip(moved.iter()).map(|(n, m)| n + m).collect()
    }

    /// The effects' part of what features with nuisances moved by a step differ by from the nominal ones: nuisances as
    /// their slopes have it.
    pub fn moved(&self, features: &[f64], step: &[f64]) -> Vec<f64> {
        features.iter().zip(self.at(step)).map(|(f, n)| f - n).collect()
    }

    /// How many features are not finite though measured and nominal ones are, where that is more than a share
    /// `may_lack` of these: such an answer cannot be compared. Fewer are left out, as the last window of a series that
    /// a delay moves.
    pub fn lacking(&self, features: &[f64], may_lack: f64) -> usize {
        let known =
            || self.measured.iter().zip(&self.nominal).zip(features).filter(|((m, n), _)| (*m - *n).is_finite());
        let lacking = known().filter(|(_, x)| !x.is_finite()).count();
        if lacking as f64 > may_lack * known().count() as f64 { lacking } else { 0 }
    }

    /// Residual of features, NaN where one is missing or tells nothing.
    pub fn residual(&self, features: &[f64]) -> Vec<f64> {
        let usable = |k: usize| self.laps.variance[k].is_finite() && self.laps.variance[k] > 0.0;
        let rows = self.measured.iter().zip(features).enumerate();
        rows.map(|(k, (a, b))| if usable(k) && (a - b).is_finite() { a - b } else { f64::NAN }).collect()
    }
}

#[cfg(test)]
impl Frame {
    /// A run of one channel without nuisances, whose nominal features are 0 and have unit variance, and what laps
    /// scatter.
    pub fn bare(measured: Vec<f64>, scatter: Vec<Vec<f64>>) -> Frame {
        let features = measured.len();
        let label =
            |k: usize| Label { channel: "a".into(), band: Band::Track, index: k, from: k as i64, to: k as i64 + 1 };
        Frame {
            run: "run".into(),
            labels: (0..features).map(label).collect(),
            measured,
            nominal: vec![0.0; features],
            laps: Laps { variance: vec![1.0; features], scatter },
            discrepancies: Vec::new(),
            built: Vec::new(),
            slopes: DMatrix::zeros(features, 0),
            prior: Vec::new(),
            bounds: Vec::new(),
            nuisances: Vec::new(),
        }
    }
}
