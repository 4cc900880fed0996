//! The fit of one run: a global stage for what would fool a local one (speed, trigger, tension), then Gauss-Newton
//! steps on slopes from designs of simulations.

mod global;
mod residuals;

pub use self::global::{excess, residuals};

use super::goodness::{Goodness, Left};
use super::local::{Centre, Sensitivity};
use super::measured::Measured;
use super::model::{Coordinates, Model};
use super::parameter::{COUNT, Parameter};
use super::posterior::{Information, Posterior, posterior};
use super::repeatability::{Numerics, Repeatability};
use crate::dynamics::Ensemble;
use crate::identify::accumulator::{Block, FeatureAccumulator, NoiseDraw};
use crate::identify::fit::residuals::Residuals;
use crate::identify::noise::Noise;
use crate::signal::FORCES;
use crate::solve::Stop;
use nalgebra::DMatrix;
use std::collections::BTreeMap;

/// How to fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitSettings {
    /// Which parameters are fitted; the others keep their nominal values.
    pub free: [bool; COUNT],
    pub seed: u64,
    pub threads: usize,
    /// Steps at most; with none, only what the run can tell is found.
    pub steps: usize,
    /// The sensors' correlated noise where it is known; else it is found from the run alone.
    pub correlated: Option<[Noise; FORCES]>,
    /// All of the sensors' noise where it is known, as from a fit of a model that lacks less.
    pub noise: Option<[Noise; FORCES]>,
    /// Whether the shares of the integration's step and of the start are found though no step is made.
    pub numerics: bool,
    /// When to give up: what was not simulated by then is missing, and the fit is an error.
    pub stop: Stop,
}

impl Default for FitSettings {
    fn default() -> Self {
        FitSettings {
            free: [true; COUNT],
            seed: 1,
            threads: 1,
            steps: STEPS,
            correlated: None,
            noise: None,
            numerics: false,
            stop: Stop::NEVER,
        }
    }
}

impl FitSettings {
    /// With the sensors' correlated noise, where it is known.
    pub fn knowing(self, correlated: Option<[Noise; FORCES]>) -> Self {
        FitSettings { correlated, ..self }
    }
}

/// Steps at most.
const STEPS: usize = 5;

/// A step shorter than this many deviations, in the root mean square over parameters, ends the fit.
const SHORT: f64 = 0.35;

/// A design goes at least this far, in its usual reach.
const LEAST_REACH: f64 = 0.2;

/// A fitted run.
#[derive(Clone, Debug)]
pub struct Fit {
    pub at: Coordinates,
    /// Of the coordinates.
    pub covariance: DMatrix<f64>,
    /// −1 or 1 where a parameter is at its bound.
    pub bound: Vec<i8>,
    /// Root mean square of the residuals, each over the repeatability of two replicate laps: 1 is as near as laps are
    /// to each other.
    pub objective: f64,
    /// The same of each block of features.
    pub blocks: BTreeMap<Block, f64>,
    /// What the objective may be, and where the model is off; none of a fit that was read back.
    pub goodness: Option<Goodness>,
    /// What the run says of the parameters near `at`, in coordinates divided by their reach; the floor of approach
    /// speeds is the last.
    pub information: DMatrix<f64>,
    /// The same without the floor of approach speeds, and where it pulls.
    pub own: Information,
    pub steps: usize,
    pub simulations: usize,
    /// Of the sensors.
    pub noise: [Noise; FORCES],
}

/// What is known of a run about the point where its fit ended: features, repeatability and slopes.
pub struct Landing {
    /// Where the model was simulated last.
    pub at: Coordinates,
    pub measured: Vec<f64>,
    /// What the model says of one such run.
    pub nominal: Vec<f64>,
    /// How many passes of its places each measured feature is a mean over.
    pub passes: Vec<f64>,
    /// Of the difference of two replicate runs.
    pub variance: Vec<f64>,
    pub sensitivity: Sensitivity,
    pub repeatability: Repeatability,
    pub numerics: Numerics,
    pub centre: Centre,
    pub blocks: Vec<Block>,
    /// Speed measured less simulated, and its deviation, m/s.
    pub speed: Option<(f64, f64)>,
}

/// Fits a run. `start` is where; nominal values when not given, found globally.
///
/// # Errors
///
/// In words, when the chain cannot be simulated with parameters like these.
pub fn fit(
    model: &mut Model,
    measured: &Measured,
    start: Option<Coordinates>,
    settings: &FitSettings,
) -> Result<Fit, String> {
    land(model, measured, start, settings).map(|(fit, _)| fit)
}

/// The same, with what is known about where it ended.
///
/// # Errors
///
/// As [`fit`].
pub fn land(
    model: &mut Model,
    measured: &Measured,
    start: Option<Coordinates>,
    settings: &FitSettings,
) -> Result<(Fit, Landing), String> {
    model.stop = settings.stop;
    let mut fitter = Fitter { measured, settings, simulations: 0, blocks: FeatureAccumulator::blocks(&model.spec) };
    let Begin { mut at, mut repeatability, mut centre } = fitter.begin(model, start).ok_or(LOST)?;
    let mut numerics = Numerics::none(repeatability.deviation.len());
    if settings.numerics && settings.steps == 0 {
        numerics = fitter.numerics(model, &at, &centre).ok_or(LOST)?;
    }
    let base = Parameter::ALL.map(Parameter::reach);
    let mut reach = base;
    let mut designed: Option<(Coordinates, Sensitivity)> = None;
    let mut steps = 0;
    loop {
        // Slopes hold as long as no parameter has left the design.
        let near = |(from, slopes): &(Coordinates, Sensitivity)| {
            let off = |k: usize| (from[k] - at[k]).abs() / slopes.reach[k];
            steps > 1 && (0..COUNT).all(|k| off(k) < 1.5)
        };
        let slopes = match designed.take().filter(near) {
            Some(known) => known,
            None => {
                fitter.simulations += super::design::RUNS;
                let seed = settings.seed.wrapping_add(7919 * steps as u64);
                let found = Sensitivity::new(model, &repeatability, &at, &centre, &reach, seed, settings.threads)
                    .ok_or(LOST)?;
                (at, found)
            }
        };
        let mut residuals = fitter.residuals(model, &at, &centre, &repeatability, &numerics);
        residuals.add(&slopes.1.unexplained);
        // What the model misses in a block, far from the best parameters or for good, makes the block count for less.
        let misfit = fitter.misfit(&residuals);
        let (information, whole) = fitter.information(&slopes.1, &residuals, &repeatability, &numerics, &misfit);
        let found = fitter.posterior(model, &at, &information);
        let length = deviations(&found, &settings.free);
        let narrower: Coordinates = std::array::from_fn(|k| (0.5 * slopes.1.reach[k]).max(LEAST_REACH * base[k]));
        if steps < settings.steps && narrower != slopes.1.reach && length < SHORT {
            let bare = fitter.residuals(model, &at, &centre, &repeatability, &numerics);
            if fitter.hidden(&bare, &residuals) {
                (reach, steps) = (narrower, steps + 1);
                continue;
            }
        }
        if length < SHORT || steps == settings.steps {
            let about = About { at, repeatability, numerics, centre, sensitivity: slopes.1 };
            return Ok(fitter.end(model, about, residuals, End { found, length, steps, whole, own: information }));
        }
        let before = fitter.cost(model, &at, &residuals, &misfit);
        // Slopes are believed as far as half as far again as their design went.
        let beyond = |k: usize| found.step[k].abs() * Parameter::ALL[k].reach() / (1.5 * slopes.1.reach[k]);
        let mut share = 1.0 / (0..COUNT).map(beyond).fold(1.0, f64::max);
        let from = at;
        for halving in 0..3 {
            at = from;
            move_by(model, &mut at, &found, share);
            fitter.limit(model, &at);
            centre = fitter.centre(model, &at, &centre).ok_or(LOST)?;
            let mut residuals = fitter.residuals(model, &at, &centre, &repeatability, &numerics);
            residuals.add(&slopes.1.unexplained);
            if halving == 2 || fitter.cost(model, &at, &residuals, &misfit) < 1.02 * before {
                break;
            }
            share *= 0.5;
        }
        if steps < 2 {
            // The repeatability, and how far a design need go, depend on what is fitted.
            (repeatability, centre) = fitter.anew(model, &at, &centre, true).ok_or(LOST)?;
        }
        let far = |k: usize| base[k] * (8.0 * found.covariance[(k, k)].sqrt()).max(found.step[k].abs());
        reach = std::array::from_fn(|k| far(k).clamp(LEAST_REACH * base[k], base[k]));
        if steps == 1 {
            numerics = fitter.numerics(model, &at, &centre).ok_or(LOST)?;
        }
        designed = Some(slopes);
        steps += 1;
    }
}

const LOST: &str = "the chain cannot be simulated with parameters like these";

/// Where the local steps of a fit begin.
struct Begin {
    at: Coordinates,
    repeatability: Repeatability,
    centre: Centre,
}

/// What is known about the point at which a fit ends.
struct About {
    at: Coordinates,
    repeatability: Repeatability,
    numerics: Numerics,
    centre: Centre,
    sensitivity: Sensitivity,
}

/// The last step of a fit.
struct End {
    found: Posterior,
    /// In deviations.
    length: f64,
    steps: usize,
    /// What the run says of the parameters, with the floor of approach speeds and without it.
    whole: DMatrix<f64>,
    own: Information,
}

/// Length of a step in deviations, root mean square over what is free.
fn deviations(found: &Posterior, free: &[bool; COUNT]) -> f64 {
    let open: Vec<usize> = (0..COUNT).filter(|k| free[*k] && found.covariance[(*k, *k)] > 0.0).collect();
    let square = |k: &usize| found.step[*k] * found.step[*k] / found.covariance[(*k, *k)];
    (open.iter().map(square).sum::<f64>() / open.len().max(1) as f64).sqrt()
}

fn move_by(model: &Model, at: &mut Coordinates, found: &Posterior, share: f64) {
    for p in Parameter::ALL {
        let (low, high) = model.range(p);
        let k = p.index();
        at[k] = (at[k] + share * found.step[k] * p.reach()).clamp(low, high);
    }
}

struct Fitter<'a> {
    measured: &'a Measured,
    settings: &'a FitSettings,
    simulations: usize,
    blocks: Vec<Block>,
}

impl Fitter<'_> {
    /// Finds where to begin: what would fool local steps, and the repeatability there.
    fn begin(&mut self, model: &mut Model, start: Option<Coordinates>) -> Option<Begin> {
        let settings = self.settings;
        let global = start.is_none();
        let mut at = start.unwrap_or_else(|| Parameter::ALL.map(|p| model.coordinate(p, model.nominal[p.index()])));
        if let (Some((speed, _)), true) = (self.measured.speed, settings.free[Parameter::Speed.index()] && global) {
            at[Parameter::Speed.index()] = model.coordinate(Parameter::Speed, speed);
        }
        // Where the run was is not known before its trigger is.
        model.spec.within = None;
        if !global {
            self.limit(model, &at);
        }
        self.set_thresholds(model, &at);
        let ensemble = Repeatability::run_ensemble(model, &at, None)?;
        self.find_noise(model, &at, &ensemble, false);
        let mut repeatability = self.repeatability(model, &ensemble);
        let mut centre = Centre::of(model, ensemble, settings.seed);
        if !global {
            return Some(Begin { at, repeatability, centre });
        }
        self.place(model, &mut at, &centre, &repeatability);
        if self.limit(model, &at) {
            model.record(&mut centre.ensemble.carts);
            repeatability = self.repeatability(model, &centre.ensemble);
            centre = Centre::of(model, centre.ensemble, settings.seed);
        }
        for _ in 0..2 {
            let slack = at;
            if !self.tighten(model, &mut at, &centre) {
                break;
            }
            let tight = self.centre(model, &at, &centre)?;
            if !self.agree(model, (&slack, &centre), (&at, &tight), &repeatability) {
                at = slack;
                break;
            }
            centre = tight;
        }
        self.set_thresholds(model, &at);
        let (repeatability, centre) = self.anew(model, &at, &centre, false)?;
        Some(Begin { at, repeatability, centre })
    }

    /// Repeatability and centre at a point, from a chain that has settled near it; `noise` says whether the sensors'
    /// noise is found anew, too, as it is what the chain's own scatter leaves.
    fn anew(
        &mut self,
        model: &mut Model,
        at: &Coordinates,
        near: &Centre,
        noise: bool,
    ) -> Option<(Repeatability, Centre)> {
        let ensemble = Repeatability::run_ensemble(model, at, Some(&near.ensemble.settled))?;
        if noise && self.settings.correlated.is_none() {
            self.find_noise(model, at, &ensemble, true);
        }
        let repeatability = self.repeatability(model, &ensemble);
        Some((repeatability, Centre::of(model, ensemble, self.settings.seed)))
    }

    /// What a fit comes to at the point where it ends.
    fn end(self, model: &Model, about: About, residuals: Residuals, end: End) -> (Fit, Landing) {
        let About { mut at, repeatability, numerics, centre, sensitivity } = about;
        let End { found, length, steps, whole, own } = end;
        let covariance = self.covariance(&found, length, steps);
        let bare = self.residuals(model, &at, &centre, &repeatability, &numerics);
        let (objective, blocks) = self.objective(&bare);
        let left = Left {
            residual: &bare.of,
            variance: &bare.variance,
            predicted: &bare.predicted,
            passes: &bare.passes,
            blocks: &self.blocks,
        };
        let goodness = Some(Goodness::new(&left, &repeatability, &numerics, &model.spec.places));
        let measured = self.measure(model, &at).0;
        let landing = Landing {
            at,
            measured,
            nominal: residuals.predicted,
            passes: residuals.passes,
            variance: residuals.variance,
            sensitivity,
            repeatability,
            numerics,
            centre,
            blocks: self.blocks,
            speed: residuals.speed,
        };
        // The last step is too short to be worth a simulation.
        move_by(model, &mut at, &found, if length < SHORT { 1.0 } else { 0.0 });
        let fit = Fit {
            at,
            covariance,
            bound: found.bound.clone(),
            objective,
            blocks,
            goodness,
            information: whole,
            own,
            steps,
            simulations: self.simulations,
            noise: *model.spec.noise(),
        };
        (fit, landing)
    }

    /// Covariance of the parameters' coordinates.
    fn covariance(&self, found: &Posterior, length: f64, steps: usize) -> DMatrix<f64> {
        let mut covariance: DMatrix<f64> = DMatrix::from_fn(COUNT, COUNT, |i, j| {
            found.covariance[(i, j)] * Parameter::ALL[i].reach() * Parameter::ALL[j].reach()
        });
        let trigger = Parameter::TriggerPosition.index();
        if length >= SHORT && steps > 0 {
            // Where the steps would still go is not known better than that.
            for p in Parameter::ALL {
                let left = found.step[p.index()] * p.reach();
                covariance[(p.index(), p.index())] += left * left;
            }
        }
        if self.settings.free[trigger] {
            // The edge is somewhere between two samples.
            let sample = self.measured.nominal_speed / self.measured.rate;
            covariance[(trigger, trigger)] += sample * sample / 12.0;
        }
        covariance
    }

    fn centre(&mut self, model: &Model, at: &Coordinates, from: &Centre) -> Option<Centre> {
        self.simulations += 1;
        Centre::new(model, at, &from.ensemble.settled, self.settings.seed.wrapping_add(self.simulations as u64))
    }

    /// What the integration's step and a fresh start change.
    fn numerics(&mut self, model: &Model, at: &Coordinates, centre: &Centre) -> Option<Numerics> {
        self.simulations += 2;
        let (features, settled) = (&centre.answer.features, &centre.ensemble.settled);
        Numerics::new(model, at, features, settled, self.settings.seed)
    }

    fn repeatability(&mut self, model: &Model, ensemble: &Ensemble) -> Repeatability {
        self.simulations += 1;
        Repeatability::new(model, ensemble, self.settings.seed.wrapping_add(500_000))
    }

    fn set_thresholds(&self, model: &mut Model, at: &Coordinates) {
        model.spec.set_thresholds(&self.measured.samples(), at[Parameter::TriggerPosition.index()]);
    }

    /// Simulated features are from now on those of the places that the run covers with its trigger at a place.
    /// Whether that is less than the lap.
    fn limit(&self, model: &mut Model, at: &Coordinates) -> bool {
        let coverage = self.measured.coverage();
        let within = || (coverage.clone(), at[Parameter::TriggerPosition.index()]);
        model.spec.within = (!coverage.is_whole()).then(within);
        model.spec.within.is_some()
    }

    /// Features of the run with its trigger at a place, and how many passes each is a mean over.
    fn measure(&self, model: &Model, at: &Coordinates) -> (Vec<f64>, Vec<f64>) {
        let mut accumulator = FeatureAccumulator::new(&model.spec);
        accumulator.add(&model.spec, &self.measured.samples(), at[Parameter::TriggerPosition.index()], NoiseDraw::None);
        // Half of what a cell's passage gives.
        let places = &model.spec.places;
        let least = 0.5 * places.lap / places.cells as f64 / self.measured.nominal_speed * self.measured.rate;
        (accumulator.features(least), accumulator.passes(self.measured.laps.max(residuals::LEAST_LAPS)))
    }

    fn posterior(&self, model: &Model, at: &Coordinates, information: &Information) -> Posterior {
        let prior = std::array::from_fn(|k| {
            let p = Parameter::ALL[k];
            let (mean, deviation) = p.prior(model.law, model.nominal[k]);
            ((mean - at[k]) / p.reach(), deviation / p.reach())
        });
        let range = std::array::from_fn(|k| {
            let p = Parameter::ALL[k];
            let (low, high) = model.range(p);
            ((low - at[k]) / p.reach(), (high - at[k]) / p.reach())
        });
        posterior(information, &prior, &range, &self.settings.free)
    }
}
