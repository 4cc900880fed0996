//! The fit of one run: a global stage for what would fool a local one (speed, trigger, tension), then Gauss-Newton steps on slopes
//! from designs of simulations.

use super::floor::{Floor, Numerics};
use super::local::{Centre, Sensitivity, WITH_FLOOR};
use super::measured::Measured;
use super::model::{Coordinates, Model};
use super::parameter::{COUNT, Parameter};
use super::posterior::{Information, Posterior, posterior};
use super::summary::{Block, FORCES, Summary};
use crate::dynamics::Fleet;
use crate::geometry::trig;
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;

/// How to fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Which parameters are fitted; the others keep their nominal values.
    pub free: [bool; COUNT],
    pub seed: u64,
    pub threads: usize,
    /// Steps at most; with none, only what the run can tell is found.
    pub steps: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Settings { free: [true; COUNT], seed: 1, threads: 1, steps: STEPS }
    }
}

/// What the floor of approach speeds is divided by, as the logarithm of a factor.
pub const FLOOR_SCALE: f64 = 0.35;

/// Steps at most.
const STEPS: usize = 5;

/// A step shorter than this many deviations, in the root mean square over parameters, ends the fit.
const SHORT: f64 = 0.35;

/// A fitted run.
#[derive(Clone, Debug)]
pub struct Fit {
    pub at: Coordinates,
    /// Of the coordinates.
    pub covariance: DMatrix<f64>,
    /// −1 or 1 where a parameter is at its bound.
    pub bound: Vec<i8>,
    /// Root mean square of the residuals, each over the floor of two honest laps: 1 is as near as laps are to each other.
    pub objective: f64,
    /// The same of each block of features.
    pub blocks: BTreeMap<Block, f64>,
    /// What the run says of the parameters near `at`, in coordinates divided by their reach; the floor of approach speeds is
    /// the last.
    pub information: DMatrix<f64>,
    /// The same without the floor of approach speeds, and where it pulls.
    pub own: Information,
    pub steps: usize,
    pub simulations: usize,
    /// Deviation of the sensors' white noise, N.
    pub noise: [f64; FORCES],
}

/// Residuals of a run about a point, each with its weight.
struct Residuals {
    /// NaN where a feature is missing.
    of: Vec<f64>,
    /// Variance of the difference of two honest laps, without what the model misses.
    variance: Vec<f64>,
    /// Mean speed: residual and deviation.
    speed: Option<(f64, f64)>,
}

impl Residuals {
    /// More variance of each feature.
    fn add(&mut self, variance: &[f64]) {
        self.variance.iter_mut().zip(variance).for_each(|(sum, more)| *sum += more);
    }
}

/// What is known of a run about the point where its fit ended: features, floor and slopes.
pub struct Landing {
    /// Where the model was simulated last.
    pub at: Coordinates,
    pub measured: Vec<f64>,
    /// What the model says of one such run.
    pub nominal: Vec<f64>,
    /// Of the difference of two honest runs.
    pub variance: Vec<f64>,
    pub sensitivity: Sensitivity,
    pub floor: Floor,
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
    settings: &Settings,
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
    settings: &Settings,
) -> Result<(Fit, Landing), String> {
    let mut fitter = Fitter { measured, settings, simulations: 0, blocks: Summary::blocks(&model.recipe) };
    let lost = "the chain cannot be simulated with parameters like these";
    let global = start.is_none();
    let mut at = start.unwrap_or_else(|| Parameter::ALL.map(|p| model.coordinate(p, model.nominal[p.index()])));
    if let (Some((speed, _)), true) = (measured.speed, settings.free[Parameter::Speed.index()] && global) {
        at[Parameter::Speed.index()] = model.coordinate(Parameter::Speed, speed);
    }
    fitter.set_thresholds(model, &at);
    let fleet = Floor::fleet(model, &at, None).ok_or(lost)?;
    fitter.listen(model, &fleet);
    let mut floor = fitter.floor(model, &fleet);
    let mut centre = Centre::of(model, fleet, settings.seed);
    if global {
        fitter.place(model, &mut at, &centre, &floor);
        for _ in 0..2 {
            if !fitter.tighten(model, &mut at, &centre) {
                break;
            }
            centre = fitter.centre(model, &at, &centre).ok_or(lost)?;
        }
        fitter.set_thresholds(model, &at);
        let fleet = Floor::fleet(model, &at, Some(&centre.fleet.settled)).ok_or(lost)?;
        floor = fitter.floor(model, &fleet);
        centre = Centre::of(model, fleet, settings.seed);
    }
    let mut numerics = Numerics::none(floor.deviation.len());
    let mut reach = Parameter::ALL.map(Parameter::reach);
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
                let found =
                    Sensitivity::new(model, &floor, &at, &centre, &reach, seed, settings.threads).ok_or(lost)?;
                (at, found)
            }
        };
        let mut residuals = fitter.residuals(model, &at, &centre, &floor, &numerics);
        residuals.add(&slopes.1.unexplained);
        // What the model misses in a block, far from the best parameters or for good, makes the block count for less.
        let misfit = fitter.misfit(&residuals);
        let (information, whole) = fitter.information(&slopes.1, &residuals, &floor, &numerics, &misfit);
        let found = fitter.posterior(model, &at, &information);
        let length = deviations(&found, &settings.free);
        if length < SHORT || steps == settings.steps {
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
            if settings.free[trigger] {
                // The edge is somewhere between two samples.
                let sample = measured.nominal_speed / measured.rate;
                covariance[(trigger, trigger)] += sample * sample / 12.0;
            }
            let bare = fitter.residuals(model, &at, &centre, &floor, &numerics);
            let (objective, blocks) = fitter.objective(&bare);
            let landing = Landing {
                at,
                measured: fitter.measure(model, &at),
                nominal: fitter.predicted(&centre, &floor, &numerics),
                variance: residuals.variance,
                sensitivity: slopes.1,
                floor,
                numerics,
                centre,
                blocks: fitter.blocks,
                speed: residuals.speed,
            };
            let last = if length < SHORT { 1.0 } else { 0.0 };
            // The last step is too short to be worth a simulation.
            move_by(model, &mut at, &found, last);
            let fit = Fit {
                at,
                covariance,
                bound: found.bound.clone(),
                objective,
                blocks,
                information: whole,
                own: information,
                steps,
                simulations: fitter.simulations,
                noise: model.recipe.noise.map(f64::from),
            };
            return Ok((fit, landing));
        }
        let before = fitter.cost(model, &at, &residuals, &misfit);
        // Slopes are believed as far as half as far again as their design went.
        let beyond = |k: usize| found.step[k].abs() * Parameter::ALL[k].reach() / (1.5 * slopes.1.reach[k]);
        let mut share = 1.0 / (0..COUNT).map(beyond).fold(1.0, f64::max);
        let from = at;
        for halving in 0..3 {
            at = from;
            move_by(model, &mut at, &found, share);
            centre = fitter.centre(model, &at, &centre).ok_or(lost)?;
            let mut residuals = fitter.residuals(model, &at, &centre, &floor, &numerics);
            residuals.add(&slopes.1.unexplained);
            if halving == 2 || fitter.cost(model, &at, &residuals, &misfit) < 1.02 * before {
                break;
            }
            share *= 0.5;
        }
        if steps < 2 {
            // The floor, and how far a design need go, depend on what is fitted.
            let fleet = Floor::fleet(model, &at, Some(&centre.fleet.settled)).ok_or(lost)?;
            floor = fitter.floor(model, &fleet);
            centre = Centre::of(model, fleet, settings.seed);
        }
        let base = Parameter::ALL.map(Parameter::reach);
        let far = |k: usize| base[k] * (8.0 * found.covariance[(k, k)].sqrt()).max(found.step[k].abs());
        reach = std::array::from_fn(|k| far(k).clamp(0.2 * base[k], base[k]));
        if steps == 1 {
            let (features, settled) = (&centre.answer.features, &centre.fleet.settled);
            numerics = Numerics::new(model, &at, features, settled, settings.seed).ok_or(lost)?;
            fitter.simulations += 2;
        }
        designed = Some(slopes);
        steps += 1;
    }
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
    settings: &'a Settings,
    simulations: usize,
    blocks: Vec<Block>,
}

impl Fitter<'_> {
    fn centre(&mut self, model: &Model, at: &Coordinates, from: &Centre) -> Option<Centre> {
        self.simulations += 1;
        Centre::new(model, at, &from.fleet.settled, self.settings.seed.wrapping_add(self.simulations as u64))
    }

    fn floor(&mut self, model: &Model, fleet: &Fleet) -> Floor {
        self.simulations += 1;
        Floor::new(model, fleet, self.settings.seed.wrapping_add(500_000))
    }

    /// Finds the sensors' noise: what is measured above the low-pass and not simulated there.
    fn listen(&self, model: &mut Model, fleet: &Fleet) {
        let simulated = model.answer(fleet, 0.0, 0).summary;
        let mut measured = Summary::new(&model.recipe);
        measured.add(&model.recipe, &self.measured.samples(), 0.0, None);
        let ((a, share), (b, _)) = (measured.high_power(&model.recipe), simulated.high_power(&model.recipe));
        for k in 0..FORCES {
            let variance = if share > 0.0 { (a[k] - b[k]).max(0.0) / share } else { 0.0 };
            model.recipe.noise[k] = variance.sqrt() as f32;
        }
    }

    fn set_thresholds(&self, model: &mut Model, at: &Coordinates) {
        model.recipe.set_thresholds(&self.measured.samples(), at[Parameter::TriggerPosition.index()]);
    }

    /// Features of the run with its trigger at a place.
    fn measure(&self, model: &Model, at: &Coordinates) -> Vec<f64> {
        let mut summary = Summary::new(&model.recipe);
        summary.add(&model.recipe, &self.measured.samples(), at[Parameter::TriggerPosition.index()], None);
        // Half of what a cell's passage gives.
        let places = &model.recipe.places;
        let least = 0.5 * places.lap / places.cells as f64 / self.measured.nominal_speed * self.measured.rate;
        summary.features(least)
    }

    /// The global stage for the trigger: where the means along the track fit best, whatever their level.
    fn place(&self, model: &Model, at: &mut Coordinates, centre: &Centre, floor: &Floor) {
        let k = Parameter::TriggerPosition.index();
        if !self.settings.free[k] {
            return;
        }
        let places = &model.recipe.places;
        let samples = self.measured.samples();
        let apart = |trigger: f64| {
            let mut summary = Summary::new(&model.recipe);
            summary.add_places(&model.recipe, &samples, trigger);
            let features = summary.features(1.0);
            let mut sum = 0.0;
            for force in 0..FORCES {
                let rows = force * places.cells..(force + 1) * places.cells;
                let difference: Vec<f64> = rows
                    .map(|i| (features[i] - centre.answer.features[i]) / floor.deviation[i])
                    .filter(|x| x.is_finite())
                    .collect();
                let mean = difference.iter().sum::<f64>() / difference.len().max(1) as f64;
                sum += difference.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
            }
            sum
        };
        let (low, high) = model.range(Parameter::TriggerPosition);
        let mut best = (at[k], apart(at[k]));
        for reach in [high - low, 0.4, 0.08] {
            let from = best.0;
            for i in -20..=20 {
                let trigger = (from + 0.5 * reach * f64::from(i) / 20.0).clamp(low, high);
                let cost = apart(trigger);
                if cost < best.1 {
                    best = (trigger, cost);
                }
            }
        }
        at[k] = best.0;
    }

    /// The global stage for the tension: in proportion to the joint's mean force. Whether it moved much.
    fn tighten(&self, model: &Model, at: &mut Coordinates, centre: &Centre) -> bool {
        let k = Parameter::Tension.index();
        let mut measured = Summary::new(&model.recipe);
        measured.add_places(&model.recipe, &self.measured.samples(), 0.0);
        let (Some(found), Some(simulated)) = (measured.mean(4), centre.answer.summary.mean(4)) else { return false };
        if !self.settings.free[k] || found <= 0.0 || simulated <= 0.0 {
            return false;
        }
        let step = trig::ln(found / simulated).clamp(-1.0, 1.0);
        let (low, high) = model.range(Parameter::Tension);
        at[k] = (at[k] + step).clamp(low, high);
        step.abs() > 0.02
    }

    fn residuals(
        &self,
        model: &Model,
        at: &Coordinates,
        centre: &Centre,
        floor: &Floor,
        numerics: &Numerics,
    ) -> Residuals {
        let laps = self.measured.laps.max(0.02);
        let features = self.measure(model, at);
        let predicted = self.predicted(centre, floor, numerics);
        let mut of = Vec::with_capacity(features.len());
        let mut variance = Vec::with_capacity(features.len());
        for (k, x) in features.iter().enumerate() {
            let laps = self.laps(k, laps);
            let difference = x - predicted[k];
            let lap = floor.deviation[k] * floor.deviation[k] / laps;
            let spread = lap + numerics.variance[k];
            let usable = difference.is_finite() && spread.is_finite() && lap > 0.0;
            of.push(if usable { difference } else { f64::NAN });
            variance.push(spread);
        }
        let speed = self.measured.speed.map(|(speed, deviation)| {
            (speed - centre.answer.speed, trig::hypot(deviation, floor.speed / laps.sqrt()).max(1e-6 * speed))
        });
        Residuals { of, variance, speed }
    }

    /// Features that a run as long as the measured one has at a point.
    fn predicted(&self, centre: &Centre, floor: &Floor, numerics: &Numerics) -> Vec<f64> {
        let laps = self.measured.laps.max(0.02);
        let features = centre.answer.features.iter().enumerate();
        features.map(|(k, x)| x + numerics.correction[k] + floor.bias[k] / self.laps(k, laps)).collect()
    }

    /// How many laps a feature is a mean over: what belongs to a place is measured once or not at all.
    fn laps(&self, feature: usize, laps: f64) -> f64 {
        self.blocks[feature].laps(laps)
    }

    /// Of each block the sum of squared residuals over the floor's, and their number.
    fn squares(&self, residuals: &Residuals) -> BTreeMap<Block, (f64, f64)> {
        let mut sums: BTreeMap<Block, (f64, f64)> = BTreeMap::new();
        for (k, block) in self.blocks.iter().enumerate().filter(|(k, _)| residuals.of[*k].is_finite()) {
            let sum = sums.entry(*block).or_default();
            *sum = (sum.0 + residuals.of[k] * residuals.of[k] / residuals.variance[k], sum.1 + 1.0);
        }
        sums
    }

    /// By how much a block's mean square is over the floor's.
    fn misfit(&self, residuals: &Residuals) -> BTreeMap<Block, f64> {
        self.squares(residuals).into_iter().map(|(block, (sum, n))| (block, (sum / n).max(1.0))).collect()
    }

    /// Root mean square over all features, and over each block's.
    fn objective(&self, residuals: &Residuals) -> (f64, BTreeMap<Block, f64>) {
        let squares = self.squares(residuals);
        let (sum, n) = squares.values().fold((0.0, 0.0), |a: (f64, f64), b| (a.0 + b.0, a.1 + b.1));
        ((sum / n.max(1.0)).sqrt(), squares.into_iter().map(|(b, (s, n))| (b, (s / n).sqrt())).collect())
    }

    fn cost(&self, model: &Model, at: &Coordinates, residuals: &Residuals, misfit: &BTreeMap<Block, f64>) -> f64 {
        let mut sum = 0.0;
        for (k, block) in self.blocks.iter().enumerate() {
            if residuals.of[k].is_finite() {
                let factor = misfit.get(block).copied().unwrap_or(1.0);
                sum += residuals.of[k] * residuals.of[k] / (residuals.variance[k] * factor);
            }
        }
        sum += residuals.speed.map_or(0.0, |(r, deviation)| r * r / (deviation * deviation));
        for p in Parameter::ALL {
            let (mean, deviation) = p.prior(model.law, model.nominal[p.index()]);
            let off = (at[p.index()] - mean) / deviation;
            sum += off * off;
        }
        sum
    }

    /// What the run says of the parameters: without the floor of approach speeds, and with it.
    fn information(
        &self,
        slopes: &Sensitivity,
        residuals: &Residuals,
        floor: &Floor,
        numerics: &Numerics,
        misfit: &BTreeMap<Block, f64>,
    ) -> (Information, DMatrix<f64>) {
        let rows: Vec<usize> = (0..self.blocks.len()).filter(|k| residuals.of[*k].is_finite()).collect();
        let last = slopes.slopes.nrows() - 1;
        let reach = |j: usize| Parameter::ALL.get(j).map_or(FLOOR_SCALE, |p| p.reach());
        let laps = self.measured.laps.max(0.02);
        let spread: Vec<f64> = rows
            .iter()
            .map(|&k| (residuals.variance[k] * misfit.get(&self.blocks[k]).copied().unwrap_or(1.0)).sqrt())
            .collect();
        // Slopes and residuals over their deviations.
        let mut scaled = DMatrix::from_fn(rows.len() + 1, WITH_FLOOR, |i, j| {
            rows.get(i).map_or(0.0, |&k| slopes.slopes[(k, j)] * reach(j) / spread[i])
        });
        let mut right =
            DVector::from_fn(rows.len() + 1, |i, _| rows.get(i).map_or(0.0, |&k| residuals.of[k] / spread[i]));
        let speed = rows.len();
        if let Some((r, deviation)) = residuals.speed {
            for j in 0..WITH_FLOOR {
                scaled[(speed, j)] = slopes.slopes[(last, j)] * reach(j) / deviation;
            }
            right[speed] = r / deviation;
        }
        let a = scaled.transpose() * &scaled;
        let g = scaled.transpose() * right;
        let carts = floor.scatter.len();
        let mut b = DMatrix::zeros(WITH_FLOOR, WITH_FLOOR);
        // How JᵀWr answers a change of the features.
        let answer = |of: &dyn Fn(usize) -> f64| {
            let value = |i: usize| rows.get(i).map_or(0.0, |&k| of(k) / spread[i]);
            scaled.transpose() * DVector::from_fn(rows.len() + 1, |i, _| value(i))
        };
        let factor = |k: usize| misfit.get(&self.blocks[k]).copied().unwrap_or(1.0).sqrt();
        for lap in &floor.scatter {
            let one = answer(&|k| lap[k] / self.laps(k, laps).sqrt() * factor(k));
            b += &one * one.transpose();
        }
        b /= carts.saturating_sub(1).max(1) as f64;
        for doubt in &numerics.doubts {
            let one = answer(&|k| doubt[k]);
            b += &one * one.transpose();
        }
        for force in 0..FORCES {
            let one = answer(&|k| if self.blocks[k] == Block::Mean(force) { floor.level[k] } else { 0.0 });
            b += &one * one.transpose();
        }
        // What the slopes leave unexplained is each feature's own.
        for (i, &k) in rows.iter().enumerate() {
            let row = scaled.row(i).transpose();
            b += &row * row.transpose() * (slopes.unexplained[k] / (spread[i] * spread[i]));
        }
        let own = scaled.row(speed).transpose();
        b += &own * own.transpose();
        let whole = Information::new(&a, &b, &g);
        let part = |m: &DMatrix<f64>| m.view((0, 0), (COUNT, COUNT)).into_owned();
        let information = Information::new(&part(&a), &part(&b), &g.rows(0, COUNT).into_owned());
        (information, whole.matrix)
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
