//! The model near a point: residuals there, and how features answer the parameters.

use super::design::{self, COLUMNS, RUNS};
use super::model::{Answer, Coordinates, Model, Plan};
use super::parameter::{COUNT, Parameter};
use super::repeatability::Repeatability;
use crate::base::parallel;
use crate::dynamics::{Ensemble, Settled};
use crate::identify::accumulator::{Block, FeatureAccumulator};
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;

/// Carts that pass each place in a run of the design, and in the one in its middle.
const DESIGN_PASSES: f64 = 14.0;
const CENTRE_PASSES: f64 = 90.0;

/// Columns of a sensitivity: the parameters, and behind them the floor of approach speeds.
pub const WITH_FLOOR: usize = COUNT + 1;

/// Logarithm of the factor by which a design moves the floor of approach speeds.
const FLOOR_REACH: f64 = crate::identify::FLOOR_SCALE;

/// Parameters that a design moves; the trigger's place needs no simulation.
const MOVED: [Parameter; 9] = [
    Parameter::RestitutionJointAxial,
    Parameter::RestitutionJointRadial,
    Parameter::RestitutionSteering,
    Parameter::RestitutionRunning,
    Parameter::Speed,
    Parameter::Tension,
    Parameter::RollingResistance,
    Parameter::KP,
    Parameter::KI,
];

/// Features and speed at a point, with the ensemble that gave them.
pub struct Centre {
    pub ensemble: Ensemble,
    pub answer: Answer,
}

impl Centre {
    pub fn new(model: &Model, at: &Coordinates, from: &Settled, seed: u64) -> Option<Centre> {
        let plan = Plan { passes: CENTRE_PASSES, from: Some(from), ..Plan::default() };
        model.run_ensemble(at, &plan).map(|ensemble| Centre::of(model, ensemble, seed))
    }

    pub fn of(model: &Model, ensemble: Ensemble, seed: u64) -> Centre {
        Centre { answer: model.answer(&ensemble, 0.0, seed), ensemble }
    }
}

/// How features answer the parameters.
#[derive(Clone, Debug)]
pub struct Sensitivity {
    /// Of each feature a row of slopes, and the mean speed's row last.
    pub slopes: DMatrix<f64>,
    /// Of each feature what the slopes leave of a run of the design, beyond what its carts scatter by: the model bends,
    /// and simulations differ in what all their carts share. A variance.
    pub unexplained: Vec<f64>,
    /// How far the design went, in coordinates.
    pub reach: Coordinates,
}

impl Sensitivity {
    /// Slopes from a design around a point, over `threads`. `None` when too few of its runs can be simulated.
    pub fn new(
        model: &Model,
        repeatability: &Repeatability,
        at: &Coordinates,
        centre: &Centre,
        reach: &Coordinates,
        seed: u64,
        threads: usize,
    ) -> Option<Sensitivity> {
        let runs = (0..RUNS).collect::<Vec<_>>();
        let answers = parallel::map(&runs, threads, |&run| {
            let mut point = *at;
            let levels = design::levels(run);
            for (p, level) in MOVED.iter().zip(levels) {
                let (low, high) = model.range(*p);
                point[p.index()] = (point[p.index()] + level * reach[p.index()]).clamp(low, high);
            }
            let lift = levels[MOVED.len()] * FLOOR_REACH;
            let seed = seed.wrapping_add(1000 * (run as u64 + 1));
            let plan = Plan {
                passes: DESIGN_PASSES,
                approach_floor: lift,
                from: Some(&centre.ensemble.settled),
                ..Plan::default()
            };
            let ensemble = model.run_ensemble(&point, &plan)?;
            let answer = model.answer(&ensemble, 0.0, seed);
            let moved: Vec<f64> = MOVED.iter().map(|p| point[p.index()] - at[p.index()]).chain([lift]).collect();
            Some((moved, answer))
        });
        let found: Vec<_> = answers.into_iter().flatten().collect();
        // Slopes, the middle, and enough left over to tell what chaos makes of them.
        if found.len() < COLUMNS + 4 {
            return None;
        }
        let width = MOVED.len() + 1;
        let matrix = DMatrix::from_fn(found.len(), width + 1, |i, j| if j == width { 1.0 } else { found[i].0[j] });
        let inverse = (matrix.transpose() * &matrix).try_inverse()?;
        let solve = &inverse * matrix.transpose();
        let features = centre.answer.features.len();
        let mut slopes = DMatrix::zeros(features + 1, WITH_FLOOR);
        let mut left_over: Vec<f64> = vec![f64::NAN; features];
        let column = |j: usize| if j < MOVED.len() { MOVED[j].index() } else { COUNT };
        for row in 0..=features {
            let value = |a: &Answer| if row == features { a.speed } else { a.features[row] };
            let y = DVector::from_iterator(found.len(), found.iter().map(|(_, a)| value(a)));
            if y.iter().any(|y| y.is_nan()) {
                continue;
            }
            let slope = &solve * &y;
            for j in 0..width {
                slopes[(row, column(j))] = slope[j];
            }
            if row < features {
                let rest = &y - &matrix * &slope;
                left_over[row] = rest.norm_squared() / (found.len() - width - 1).max(1) as f64;
            }
        }
        let variance: Vec<f64> = (0..width).map(|j| inverse[(j, j)]).collect();
        let names: Vec<usize> = (0..width).map(column).collect();
        let blocks = Blocks::new(model, repeatability, &left_over);
        blocks.shrink(&mut slopes, &left_over, &variance, &names, repeatability);
        trigger(&mut slopes, model, centre, seed);
        Some(Sensitivity { slopes, unexplained: blocks.unexplained(&left_over, repeatability), reach: *reach })
    }
}

/// Features that vary alike.
struct Blocks(BTreeMap<Block, Vec<usize>>);

impl Blocks {
    fn new(model: &Model, repeatability: &Repeatability, left_over: &[f64]) -> Self {
        let mut rows: BTreeMap<Block, Vec<usize>> = BTreeMap::new();
        let named = FeatureAccumulator::blocks(&model.spec);
        for k in (0..named.len()).filter(|k| repeatability.deviation[*k] > 0.0 && !left_over[*k].is_nan()) {
            rows.entry(named[k]).or_default().push(k);
        }
        Blocks(rows)
    }

    /// Takes from the slopes what chaos alone would make of them: in each block of features and each column, the slopes
    /// are shrunk together by the share of their sum of squares that is noise (James and Stein 1961, positive part),
    /// two deviations of the noise's own sum added.
    fn shrink(
        &self,
        slopes: &mut DMatrix<f64>,
        left_over: &[f64],
        variance: &[f64],
        columns: &[usize],
        repeatability: &Repeatability,
    ) {
        for rows in self.0.values() {
            let square = |x: f64, k: usize| x * x / (repeatability.deviation[k] * repeatability.deviation[k]);
            let noise: f64 = rows.iter().map(|&k| square(left_over[k].sqrt(), k)).sum();
            let noise = noise * (1.0 + 2.0 * (2.0 / rows.len() as f64).sqrt());
            for (j, &column) in columns.iter().enumerate() {
                let sum: f64 = rows.iter().map(|&k| square(slopes[(k, column)], k)).sum();
                let keep = if sum > 0.0 { (1.0 - noise * variance[j] / sum).max(0.0) } else { 0.0 };
                rows.iter().for_each(|&k| slopes[(k, column)] *= keep);
            }
        }
    }

    /// What is left over in the mean of a block beyond its carts' scatter.
    fn unexplained(&self, left_over: &[f64], repeatability: &Repeatability) -> Vec<f64> {
        let mut out = vec![0.0; left_over.len()];
        for rows in self.0.values() {
            let excess = |&k: &usize| left_over[k] - repeatability.chaos[k] * repeatability.chaos[k] / DESIGN_PASSES;
            let mean = (rows.iter().map(excess).sum::<f64>() / rows.len() as f64).max(0.0);
            rows.iter().for_each(|&k| out[k] = mean);
        }
        out
    }
}

/// The trigger moves every sample along the track: the model's own features, moved, give the slopes.
fn trigger(slopes: &mut DMatrix<f64>, model: &Model, centre: &Centre, seed: u64) {
    let reach = Parameter::TriggerPosition.reach();
    let [ahead, behind] = [reach, -reach].map(|by| model.answer(&centre.ensemble, by, seed).features);
    for (k, (a, b)) in ahead.iter().zip(&behind).enumerate() {
        // Moving the measured samples ahead leaves the model behind.
        let slope = (b - a) / (2.0 * reach);
        slopes[(k, Parameter::TriggerPosition.index())] = if slope.is_nan() { 0.0 } else { slope };
    }
}
