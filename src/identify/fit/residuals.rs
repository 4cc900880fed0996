//! How far a run is from the model, and what that says of the parameters.

use super::Fitter;
use crate::base::trig;
use crate::identify::accumulator::Block;
use crate::identify::local::{Centre, Sensitivity, WITH_FLOOR};
use crate::identify::model::{Coordinates, Model};
use crate::identify::parameter::{COUNT, FLOOR_SCALE, Parameter};
use crate::identify::posterior::Information;
use crate::identify::repeatability::{Numerics, Repeatability};
use crate::signal::FORCES;
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;

/// A run counts as so much of a lap at least.
pub(super) const LEAST_LAPS: f64 = 0.02;

/// Mean square over the repeatability's above which a block is wrong.
const WRONG: f64 = 4.0;

/// Residuals of a run about a point, each with its weight.
pub(super) struct Residuals {
    /// NaN where a feature is missing.
    pub(super) of: Vec<f64>,
    /// Variance of the difference of two replicate laps, without what the model misses.
    pub(super) variance: Vec<f64>,
    /// How many passes of its places each measured feature is a mean over.
    pub(super) passes: Vec<f64>,
    /// Features that a run like the measured one has by the model.
    pub(super) predicted: Vec<f64>,
    /// Mean speed: residual and deviation.
    pub(super) speed: Option<(f64, f64)>,
}

impl Residuals {
    /// More variance of each feature.
    pub(super) fn add(&mut self, variance: &[f64]) {
        self.variance.iter_mut().zip(variance).for_each(|(sum, more)| *sum += more);
    }
}

/// Features that a run has at a point whose features are means over so many passes.
fn predicted(centre: &Centre, repeatability: &Repeatability, numerics: &Numerics, passes: &[f64]) -> Vec<f64> {
    let features = centre.answer.features.iter().enumerate();
    features.map(|(k, x)| x + numerics.correction[k] + repeatability.bias[k] / passes[k]).collect()
}

impl Fitter<'_> {
    pub(super) fn residuals(
        &self,
        model: &Model,
        at: &Coordinates,
        centre: &Centre,
        repeatability: &Repeatability,
        numerics: &Numerics,
    ) -> Residuals {
        let laps = self.measured.laps.max(LEAST_LAPS);
        let (features, passes) = self.measure(model, at);
        let predicted = predicted(centre, repeatability, numerics, &passes);
        let mut of = Vec::with_capacity(features.len());
        let mut variance = Vec::with_capacity(features.len());
        for (k, x) in features.iter().enumerate() {
            let difference = x - predicted[k];
            let lap = repeatability.deviation[k] * repeatability.deviation[k] / passes[k];
            let spread = lap + numerics.variance[k];
            let usable = difference.is_finite() && spread.is_finite() && lap > 0.0;
            of.push(if usable { difference } else { f64::NAN });
            variance.push(spread);
        }
        let speed = self.measured.speed.map(|(speed, deviation)| {
            (speed - centre.answer.speed, trig::hypot(deviation, repeatability.speed / laps.sqrt()).max(1e-6 * speed))
        });
        Residuals { of, variance, passes, predicted, speed }
    }

    /// Of each block the sum of squared residuals over the repeatability's, and their number.
    pub(super) fn squares(&self, residuals: &Residuals) -> BTreeMap<Block, (f64, f64)> {
        let mut sums: BTreeMap<Block, (f64, f64)> = BTreeMap::new();
        for (k, block) in self.blocks.iter().enumerate().filter(|(k, _)| residuals.of[*k].is_finite()) {
            let sum = sums.entry(*block).or_default();
            *sum = (sum.0 + residuals.of[k] * residuals.of[k] / residuals.variance[k], sum.1 + 1.0);
        }
        sums
    }

    /// Whether a block is wrong, and passes only for what bent slopes do not explain: a design that goes less far has
    /// straighter ones.
    pub(super) fn hidden(&self, bare: &Residuals, with_unexplained: &Residuals) -> bool {
        let (bare, with) = (self.squares(bare), self.squares(with_unexplained));
        bare.iter().any(|(block, (sum, n))| sum / n > WRONG && *sum > 2.0 * with[block].0)
    }

    /// By how much a block's mean square is over the repeatability's.
    pub(super) fn misfit(&self, residuals: &Residuals) -> BTreeMap<Block, f64> {
        self.squares(residuals).into_iter().map(|(block, (sum, n))| (block, (sum / n).max(1.0))).collect()
    }

    /// Root mean square over all features, and over each block's.
    pub(super) fn objective(&self, residuals: &Residuals) -> (f64, BTreeMap<Block, f64>) {
        let squares = self.squares(residuals);
        let (sum, n) = squares.values().fold((0.0, 0.0), |a: (f64, f64), b| (a.0 + b.0, a.1 + b.1));
        ((sum / n.max(1.0)).sqrt(), squares.into_iter().map(|(b, (s, n))| (b, (s / n).sqrt())).collect())
    }

    pub(super) fn cost(
        &self,
        model: &Model,
        at: &Coordinates,
        residuals: &Residuals,
        misfit: &BTreeMap<Block, f64>,
    ) -> f64 {
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
    pub(super) fn information(
        &self,
        slopes: &Sensitivity,
        residuals: &Residuals,
        repeatability: &Repeatability,
        numerics: &Numerics,
        misfit: &BTreeMap<Block, f64>,
    ) -> (Information, DMatrix<f64>) {
        let rows: Vec<usize> = (0..self.blocks.len()).filter(|k| residuals.of[*k].is_finite()).collect();
        let last = slopes.slopes.nrows() - 1;
        let reach = |j: usize| Parameter::ALL.get(j).map_or(FLOOR_SCALE, |p| p.reach());
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
        let carts = repeatability.scatter.len();
        let mut b = DMatrix::zeros(WITH_FLOOR, WITH_FLOOR);
        // How JᵀWr answers a change of the features.
        let answer = |of: &dyn Fn(usize) -> f64| {
            let value = |i: usize| rows.get(i).map_or(0.0, |&k| of(k) / spread[i]);
            scaled.transpose() * DVector::from_fn(rows.len() + 1, |i, _| value(i))
        };
        let factor = |k: usize| misfit.get(&self.blocks[k]).copied().unwrap_or(1.0).sqrt();
        for lap in &repeatability.scatter {
            let one = answer(&|k| lap[k] / residuals.passes[k].sqrt() * factor(k));
            b += &one * one.transpose();
        }
        b /= carts.saturating_sub(1).max(1) as f64;
        for discrepancy in &numerics.discrepancies {
            let one = answer(&|k| discrepancy[k]);
            b += &one * one.transpose();
        }
        for force in 0..FORCES {
            let one = answer(&|k| if self.blocks[k] == Block::Mean(force) { repeatability.level[k] } else { 0.0 });
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
}
