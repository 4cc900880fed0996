//! A study: every run of a campaign fitted in every law that is asked for.
//!
//! Six of the laws are the same model in other coordinates, so what one law's fit found is carried over through its
//! damping χ, and only where that is beyond a law's bounds is the run fitted again. Kelvin and Voigt's damper is
//! another model.

use super::effort::Counter;
use super::fit::{Fit, FitSettings, fit};
use super::goodness::{Goodness, is_wrong};
use super::hum::Hum;
use super::measured::Measured;
use super::model::{Coordinates, Model};
use super::parameter::{COUNT, Parameter, damping};
use super::posterior::{Information, correlations, interval, posterior};
use super::words::identifiability;
use crate::base::digest::sha256;
use crate::base::number::tidy;
use crate::chain_input::{ContactLaw, Simulation};
use crate::dynamics::law::{self, achieved_restitution};
use crate::dynamics::{Plan, Width};
use crate::identify::accumulator::Block;
use crate::identify::noise::{CorrelatedNoise, channel_noise};
use crate::signal::compare::{Scale, compare_from};
use crate::signal::{Channel, Run};
use crate::solve::Stop;
use crate::{base, effects};
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Share of the posterior that an interval holds.
pub const CONFIDENCE: f64 = 0.9;

/// A run with the chain that is thought to have made it.
#[derive(Clone, Debug)]
pub struct Subject {
    pub name: String,
    pub run: Run,
    pub simulation: Simulation,
}

/// A fitted parameter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    pub value: f64,
    /// The 90 % interval.
    pub low: f64,
    pub high: f64,
    pub at_bound: bool,
    /// Whether it was fitted; otherwise the nominal value, or one shared by all runs.
    pub fitted: bool,
}

/// A run's fit in one law, as files keep it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunFit {
    pub run: String,
    pub law: ContactLaw,
    /// Of everything that the fit depends on.
    pub key: String,
    /// Of another law, when it was not fitted anew but carried over through χ.
    pub carried_from: Option<ContactLaw>,
    /// Residuals over the repeatability, root mean square: 1 is as near as two replicate laps are.
    pub objective: f64,
    pub parameters: BTreeMap<String, Estimate>,
    /// χ of the restitutions (Kelvin-Voigt: ζ), and what a free impact achieves with it.
    pub damping: BTreeMap<String, f64>,
    pub achieved: BTreeMap<String, f64>,
    /// Of a simulated lap with these parameters: root mean square difference over the measured range (thesis §2.3).
    pub nrmsd: BTreeMap<String, f64>,
    /// The same of moving means over two carts.
    pub nrmsd_two_carts: BTreeMap<String, f64>,
    /// What the run can tell, in words.
    pub identifiability: Vec<String>,
    /// Blocks of features whose residuals are far over the repeatability: what the model misses, or an effect it lacks.
    pub misfits: BTreeMap<String, f64>,
    /// What repeatability allows the objective to be, and where the model is off.
    pub goodness: Goodness,
    /// Of the sensors' white noise, N.
    pub noise: BTreeMap<String, f64>,
    /// Of the sensors, noise with a correlation time beside it, where it stands out.
    #[serde(default)]
    pub correlated_noise: BTreeMap<String, CorrelatedNoise>,
    /// Mains hum that was taken off, by channel.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub hum: BTreeMap<String, Vec<Hum>>,
    pub laps: f64,
    /// Samples bridged and left out.
    pub filled: usize,
    pub masked: usize,
    /// Time that was left out because the chain's speed changed, s.
    #[serde(default)]
    pub unsteady_s: f64,
    pub steps: usize,
    pub simulations: usize,
    /// Coordinates, and row by row their covariance, the run's own information, and where that pulls.
    pub coordinates: Vec<f64>,
    pub covariance: Vec<f64>,
    pub information: Vec<f64>,
    pub pull: Vec<f64>,
}

impl RunFit {
    /// The fit as a combination of runs needs it.
    pub fn fit(&self) -> Fit {
        let square = |x: &[f64]| DMatrix::from_row_slice(COUNT, COUNT, x);
        Fit {
            at: self.at(),
            covariance: square(&self.covariance),
            bound: vec![0; COUNT],
            objective: self.objective,
            blocks: BTreeMap::new(),
            goodness: None,
            information: DMatrix::zeros(0, 0),
            own: Information { matrix: square(&self.information), pull: DVector::from_row_slice(&self.pull) },
            steps: self.steps,
            simulations: self.simulations,
            noise: Default::default(),
        }
    }

    pub fn at(&self) -> Coordinates {
        std::array::from_fn(|k| self.coordinates.get(k).copied().unwrap_or(0.0))
    }

    /// Whether the model fits the run as well as repeatability allows.
    pub fn fits(&self) -> bool {
        self.objective <= self.goodness.limit.objective
    }

    /// Whether what stands in a file is whole.
    pub fn is_whole(&self) -> bool {
        let square = COUNT * COUNT;
        [self.coordinates.len(), self.covariance.len(), self.information.len(), self.pull.len()]
            == [COUNT, square, square, COUNT]
    }

    /// Correlations of the parameters.
    pub fn correlations(&self) -> DMatrix<f64> {
        correlations(&DMatrix::from_row_slice(COUNT, COUNT, &self.covariance))
    }

    /// The simulation input with the fitted values.
    pub fn input(&self, subject: &Subject) -> Simulation {
        let mut simulation = subject.simulation.clone();
        simulation.contact_law = self.law;
        for p in Parameter::ALL {
            if let Some(estimate) = self.parameters.get(p.name()) {
                p.set(&mut simulation, estimate.value);
            }
        }
        simulation
    }
}

impl Subject {
    /// SHA-256 of the run, its sidecar and the chain: a layout with its imports counts by what they build.
    pub fn content(&self) -> String {
        let mut all = crate::base::json::to_json(&self.simulation);
        all.extend(self.run.sidecar.write());
        all.extend(self.run.time.iter().flat_map(|t| t.to_le_bytes()));
        for (channel, samples) in &self.run.channels {
            all.extend(channel.name().bytes());
            all.extend(samples.iter().flat_map(|x| x.to_le_bytes()));
        }
        sha256(&all)
    }
}

/// What everything a fit depends on hashes to (SHA-256): this program, the run and its chain, the law, the options, and
/// what the fit started from.
pub fn key(subject: &Subject, law: ContactLaw, settings: &FitSettings, held: &str) -> String {
    // The answer depends on neither.
    let settings = FitSettings { threads: 1, stop: Stop::NEVER, ..*settings };
    sha256(format!("{} {} {law:?} {settings:?} {held}", base::program(), subject.content()).as_bytes())
}

/// Fits a run in a law; `start` is the fit to begin from, whose values what is not free keeps. What is simulated is
/// counted.
///
/// # Errors
///
/// In words, when the run cannot be used or its chain cannot be simulated.
pub fn fit_run(
    subject: &Subject,
    law: ContactLaw,
    start: Option<(ContactLaw, &Coordinates)>,
    settings: &FitSettings,
    (width, counter): (Width, &Counter),
    key: String,
) -> Result<RunFit, String> {
    let lap = subject.simulation.track.centre_line().length;
    let measured = Measured::new(&subject.run, &subject.simulation, lap)?;
    let mut model = Model::new(&subject.simulation, law, &measured, width);
    model.counter = counter.clone();
    let start = start.map(|(from, at)| carried(&model, from, at));
    let found = fit(&mut model, &measured, start, settings)?;
    fitted(subject, &model, &measured, &found, settings, key)
}

/// Carries a fit over to another law of the same model. `None` where a restitution would be beyond its bounds, or to or
/// from Kelvin and Voigt's.
pub fn carry(
    subject: &Subject,
    from: &RunFit,
    law: ContactLaw,
    settings: &FitSettings,
    width: Width,
) -> Option<RunFit> {
    let same = |law: ContactLaw| law != ContactLaw::KelvinVoigt;
    if !same(law) || !same(from.law) {
        return None;
    }
    let lap = subject.simulation.track.centre_line().length;
    let measured = Measured::new(&subject.run, &subject.simulation, lap).ok()?;
    let model = Model::new(&subject.simulation, law, &measured, width);
    let at = from.at();
    for p in Parameter::RESTITUTIONS {
        let (low, high) = model.range(p);
        let estimate = from.parameters.get(p.name())?;
        if settings.free[p.index()] && (at[p.index()] < low || at[p.index()] > high || estimate.at_bound) {
            return None;
        }
    }
    let mut carried = from.clone();
    carried.law = law;
    carried.carried_from = Some(from.law);
    carried.key = String::new();
    let covariance = DMatrix::from_row_slice(COUNT, COUNT, &from.covariance);
    (carried.parameters, carried.damping, carried.achieved) =
        estimates(&model, &at, &covariance, &[0; COUNT], &settings.free);
    Some(carried)
}

/// Where a fit of another law of the same model ends within a law's bounds, as far as what that fit knows of the run
/// reaches: the best parameters there, from its information. `None` where that is too far, or for another model.
pub fn within(
    subject: &Subject,
    from: &RunFit,
    law: ContactLaw,
    settings: &FitSettings,
    width: Width,
) -> Option<Coordinates> {
    if [law, from.law].contains(&ContactLaw::KelvinVoigt) {
        return None;
    }
    let lap = subject.simulation.track.centre_line().length;
    let measured = Measured::new(&subject.run, &subject.simulation, lap).ok()?;
    let model = Model::new(&subject.simulation, law, &measured, width);
    let mut at = from.at();
    let (own, far) = (from.fit().own, |k: usize, x: f64| (x - at[k]) / Parameter::ALL[k].reach());
    let prior = std::array::from_fn(|k| {
        let (mean, deviation) = Parameter::ALL[k].prior(law, model.nominal[k]);
        (far(k, mean), deviation / Parameter::ALL[k].reach())
    });
    let range = std::array::from_fn(|k| {
        let (low, high) = model.range(Parameter::ALL[k]);
        (far(k, low), far(k, high))
    });
    let step = posterior(&own, &prior, &range, &settings.free).step;
    for p in Parameter::ALL {
        if step[p.index()].abs() > NEAR {
            return None;
        }
        let (low, high) = model.range(p);
        at[p.index()] = (at[p.index()] + step[p.index()] * p.reach()).clamp(low, high);
    }
    Some(at)
}

/// How far slopes hold, over their design's reach.
const NEAR: f64 = 1.5;

/// Coordinates in a law from those in another.
fn carried(model: &Model, from: ContactLaw, at: &Coordinates) -> Coordinates {
    let mut out = *at;
    for p in Parameter::ALL {
        if from != model.law
            && (from == ContactLaw::KelvinVoigt || model.law == ContactLaw::KelvinVoigt)
            && p.is_restitution()
        {
            // By what a free impact achieves.
            let value = p.value(from, at[p.index()], (1e-6, 1.0));
            out[p.index()] = model.coordinate(p, achieved(from, value));
        }
        let (low, high) = model.range(p);
        out[p.index()] = out[p.index()].clamp(low, high);
    }
    out
}

/// The restitution that a free impact really has.
fn achieved(law: ContactLaw, e: f64) -> f64 {
    if law == ContactLaw::KelvinVoigt { e } else { achieved_restitution(law::factor(law, e)) }
}

type Estimates = (BTreeMap<String, Estimate>, BTreeMap<String, f64>, BTreeMap<String, f64>);

fn estimates(
    model: &Model,
    at: &Coordinates,
    covariance: &DMatrix<f64>,
    bound: &[i8],
    free: &[bool; COUNT],
) -> Estimates {
    let (mut parameters, mut factors, mut impacts) = Estimates::default();
    for p in Parameter::ALL {
        let k = p.index();
        let range = model.range(p);
        let (a, b) = interval(at[k], covariance[(k, k)].max(0.0).sqrt(), range, CONFIDENCE);
        let value = |x: f64| tidy(model_value(model, p, x));
        let (a, b) = (value(a), value(b));
        let estimate = Estimate {
            value: value(at[k]),
            low: a.min(b),
            high: a.max(b),
            at_bound: bound[k] != 0 || at[k] <= range.0 || at[k] >= range.1,
            fitted: free[k],
        };
        if p.is_restitution() {
            factors.insert(p.name().to_owned(), tidy(damping(model.law, estimate.value)));
            impacts.insert(p.name().to_owned(), tidy(achieved(model.law, estimate.value)));
        }
        parameters.insert(p.name().to_owned(), estimate);
    }
    (parameters, factors, impacts)
}

fn model_value(model: &Model, p: Parameter, coordinate: f64) -> f64 {
    p.value(model.law, coordinate, model.bounds[p.index()])
}

fn fitted(
    subject: &Subject,
    model: &Model,
    measured: &Measured,
    found: &Fit,
    settings: &FitSettings,
    key: String,
) -> Result<RunFit, String> {
    let goodness = found.goodness.clone().ok_or("the fit has no residuals")?;
    let (parameters, damping, achieved) = estimates(model, &found.at, &found.covariance, &found.bound, &settings.free);
    let prior = Parameter::ALL.map(|p| p.prior(model.law, model.nominal[p.index()]).1 / p.reach());
    let rows = |m: &DMatrix<f64>| m.transpose().as_slice().iter().map(|x| tidy(*x)).collect::<Vec<f64>>();
    let misfits = found.blocks.iter().filter(|(_, x)| is_wrong(**x)).map(|(block, x)| (block_name(*block), tidy(*x)));
    let noise = channel_noise(&found.noise, &measured.recorder.steps(), |k| measured.has(k));
    let mut out = RunFit {
        run: subject.name.clone(),
        law: model.law,
        key,
        carried_from: None,
        objective: tidy(found.objective),
        parameters,
        damping,
        achieved,
        nrmsd: BTreeMap::new(),
        nrmsd_two_carts: BTreeMap::new(),
        identifiability: identifiability(&found.information, &prior, crate::identify::FLOOR_SCALE, &settings.free),
        misfits: misfits.collect(),
        goodness,
        noise: noise.iter().map(|(name, noise)| (name.clone(), noise.white_n)).collect(),
        correlated_noise: noise.iter().filter_map(|(name, noise)| Some((name.clone(), noise.correlated?))).collect(),
        hum: measured.hum.iter().map(|(channel, lines)| (channel.name().to_owned(), lines.clone())).collect(),
        laps: tidy(measured.laps),
        filled: measured.filled,
        masked: measured.masked,
        unsteady_s: tidy(measured.unsteady),
        steps: found.steps,
        simulations: found.simulations,
        coordinates: found.at.to_vec(),
        covariance: rows(&found.covariance),
        information: rows(&found.own.matrix),
        pull: found.own.pull.iter().map(|x| tidy(*x)).collect(),
    };
    (out.nrmsd, out.nrmsd_two_carts) = deviations(subject, &out, model.spec.places.lap, model.width);
    Ok(out)
}

/// By channel.
type Deviations = BTreeMap<String, f64>;

/// How far a simulated lap with a fit's parameters is from the run: of samples, and of means over two carts.
fn deviations(subject: &Subject, fit: &RunFit, lap: f64, width: Width) -> (Deviations, Deviations) {
    let (mut samples, mut two_carts) = (Deviations::new(), Deviations::new());
    let scale = Scale { lap: Some(lap), pitch: Some(lap / subject.simulation.chain.carts as f64), exponent: 3.0 };
    let input = fit.input(subject);
    if let Ok(lap) = effects::simulate(&input, &Plan::default(), width, &mut |_| true) {
        // The measured run has its trigger where the fit puts it.
        let compared = compare_from(&subject.run, input.sensor.photocell_s_m, &lap.run, &scale);
        for (channel, deviation) in compared.into_iter().filter(|(c, _)| c.is_force()) {
            let name = channel.name().to_owned();
            samples.extend(deviation.nrmsd.map(|x| (name.clone(), tidy(x))));
            two_carts.extend(deviation.nrmsd_two_carts.map(|x| (name, tidy(x))));
        }
    }
    (samples, two_carts)
}

/// Whether a lap simulated anew is as far from the run as a kept fit says. That costs one lap, where the fit costs
/// hundreds.
pub fn is_confirmed(subject: &Subject, kept: &RunFit, width: Width) -> bool {
    let lap = subject.simulation.track.centre_line().length;
    let same = |a: &Deviations, b: &Deviations| {
        a.len() == b.len() && a.iter().zip(b).all(|((m, x), (n, y))| m == n && x.to_bits() == y.to_bits())
    };
    let (samples, two_carts) = deviations(subject, kept, lap, width);
    same(&samples, &kept.nrmsd) && same(&two_carts, &kept.nrmsd_two_carts)
}

/// What a block of features is, in words.
fn block_name(block: Block) -> String {
    let of = |what: &str, force: usize| format!("{what} of {}", Channel::FORCES[force].name());
    match block {
        Block::Mean(k) => of("means along the track", k),
        Block::Spread(k) => of("spread within curves and straights", k),
        Block::Share(k) => of("distribution", k),
        Block::Power(k) => of("spectrum", k),
        Block::Order(k) => of("orders", k),
        Block::Local(k) => of("spread by place", k),
        Block::SpeedPower => "spectrum of the chain's speed".to_owned(),
    }
}
