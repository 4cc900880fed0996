//! Fits a model's nuisances to one part of a run: Gauss and Newton's method on means over windows, with bounds, and
//! slopes from central differences.

use super::Error;
use super::data::RunPart;
use super::protocol::Nuisance;
use super::repeatability::{Inputs, Repeatability};
use super::windows::Windows;
use crate::gap::settings;
use crate::identify::mode_within;
use nalgebra::{DMatrix, DVector};

/// Rows of samples, a row a channel, on the part's times.
pub(super) type Rows = Vec<Vec<f64>>;

/// Simulates a part at several points, in order.
pub(super) type Simulate<'a> = &'a dyn Fn(&[Vec<f64>]) -> Vec<Result<Rows, Error>>;

/// A part with its nuisances fitted.
pub(super) struct FittedPart {
    /// The nuisances, from 0 at their lower bounds to 1 at their upper ones.
    pub at: Vec<f64>,
    pub windows: Windows,
    pub measured: Vec<f64>,
    pub nominal: Vec<f64>,
    pub repeatability: Repeatability,
    pub slopes: DMatrix<f64>,
}

/// Where a nuisance stands between its bounds.
pub(super) fn share(nuisance: &Nuisance, value: f64) -> f64 {
    (value - nuisance.low) / (nuisance.high - nuisance.low)
}

/// A nuisance's value from where it stands between its bounds, which it does not leave.
pub(super) fn value(nuisance: &Nuisance, share: f64) -> f64 {
    // Exact at both ends.
    let share = share.clamp(0.0, 1.0);
    (1.0 - share) * nuisance.low + share * nuisance.high
}

pub(super) struct Fitter<'a> {
    pub part: &'a RunPart,
    pub nuisances: &'a [Nuisance],
    /// How closely the model is believed to follow each channel.
    pub accuracy: &'a [f64],
    pub simulate: Simulate<'a>,
    pub settings: &'a settings::Outside,
}

/// The state of a fit.
struct TrialPoint {
    at: Vec<f64>,
    rows: Rows,
}

impl Fitter<'_> {
    /// The fit; the model is asked once more by `again`, to see by how much its answers differ.
    ///
    /// # Errors
    ///
    /// What the model says against being simulated at its nominal nuisances, and [`Error::Nothing`].
    pub fn fit(&self, again: &dyn Fn(&[f64]) -> Result<Rows, Error>) -> Result<FittedPart, Error> {
        let settings = &self.settings.fitting;
        let start: Vec<f64> = self.nuisances.iter().map(|n| share(n, n.nominal)).collect();
        let mut point = TrialPoint { rows: self.one(&start)?, at: start.clone() };
        let mut slopes = self.slopes(&point);
        let mut windows = Windows::new(self.part, self.settings.windows.first, &self.settings.windows);
        let mut repeatability = self.repeatability(&windows, &point, None);
        let (mut suited, mut stale) = (false, 0.0);
        for step in 0..settings.steps {
            if step <= settings.settled {
                repeatability = self.repeatability(&windows, &point, None);
            }
            let direction = self.direction(&windows, &repeatability, &point, &slopes, &start);
            let size = direction.amax();
            if !suited && (size < settings.small || step >= 2) {
                windows = Windows::suited(self.part, &self.left(&point), &self.settings.windows);
                repeatability = self.repeatability(&windows, &point, None);
                suited = true;
                continue;
            }
            if size < settings.converged {
                break;
            }
            let Some(next) = self.descend(&windows, &repeatability, &point, &direction, &start) else { break };
            point = next;
            stale += size;
            if stale > settings.small {
                slopes = self.slopes(&point);
                stale = 0.0;
            }
        }
        if stale > 0.0 {
            slopes = self.slopes(&point);
        }
        let repeated = again(&point.at).ok().map(|rows| windows.means(&rows));
        let repeatability = self.repeatability(&windows, &point, repeated.as_deref());
        let (measured, nominal) = (windows.means(&self.part.channels), windows.means(&point.rows));
        if !measured.iter().zip(&nominal).any(|(a, b)| (a - b).is_finite()) {
            return Err(Error::Nothing { run: self.part.name.clone() });
        }
        let columns: Vec<DVector<f64>> = slopes
            .iter()
            .map(|rows| {
                windows.means(rows).into_iter().map(|x| if x.is_finite() { x } else { 0.0 }).collect::<Vec<_>>()
            })
            .map(DVector::from_vec)
            .collect();
        let matrix = match columns.is_empty() {
            true => DMatrix::zeros(measured.len(), 0),
            false => DMatrix::from_columns(&columns),
        };
        Ok(FittedPart { at: point.at, windows, measured, nominal, repeatability, slopes: matrix })
    }

    fn one(&self, at: &[f64]) -> Result<Rows, Error> {
        let missing = || Err(Error::Nothing { run: self.part.name.clone() });
        (self.simulate)(&[at.to_vec()]).pop().unwrap_or_else(missing)
    }

    /// Measured less simulated.
    fn left(&self, point: &TrialPoint) -> Rows {
        let less = |(m, s): (&Vec<f64>, &Vec<f64>)| m.iter().zip(s).map(|(m, s)| m - s).collect();
        self.part.channels.iter().zip(&point.rows).map(less).collect()
    }

    /// Of each nuisance the change of samples with it. What cannot be simulated on one side is taken from the other; on
    /// neither, it counts as none.
    fn slopes(&self, point: &TrialPoint) -> Vec<Rows> {
        let moved = |k: usize, by: f64| {
            let mut at = point.at.clone();
            at[k] = (at[k] + by).clamp(0.0, 1.0);
            at
        };
        let difference = self.settings.fitting.difference;
        let both = |k| [moved(k, -difference), moved(k, difference)];
        let points: Vec<Vec<f64>> = (0..point.at.len()).flat_map(both).collect();
        let mut answers = (self.simulate)(&points).into_iter().map(Result::ok);
        let mut all = Vec::with_capacity(point.at.len());
        for (k, pair) in points.chunks(2).enumerate() {
            let side = |answer: Option<Option<Rows>>, at: &[f64]| match answer.flatten() {
                Some(rows) => (rows, at[k]),
                None => (point.rows.clone(), point.at[k]),
            };
            let (low, from) = side(answers.next(), &pair[0]);
            let (high, to) = side(answers.next(), &pair[1]);
            let scale = if to > from { 1.0 / (to - from) } else { 0.0 };
            let row = |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(a, b)| (b - a) * scale).collect();
            all.push(low.iter().zip(&high).map(row).collect());
        }
        all
    }

    fn repeatability(&self, windows: &Windows, point: &TrialPoint, repeated: Option<&[f64]>) -> Repeatability {
        let (measured, count) = (windows.means(&self.part.channels), windows.count());
        let nominal = windows.means(&point.rows);
        let random_effect = |c: usize| {
            let pairs = repeated.unwrap_or(&nominal).iter().zip(&nominal).skip(c * count).take(count);
            let squares: Vec<f64> = pairs.map(|(a, b)| (a - b) * (a - b)).filter(|x| x.is_finite()).collect();
            squares.iter().sum::<f64>() / squares.len().max(1) as f64
        };
        let repeat: Vec<f64> = (0..self.part.channels.len()).map(random_effect).collect();
        let left = self.left(point);
        let from = Inputs { windows, left: &left, measured: &measured, accuracy: self.accuracy, repeat: &repeat };
        Repeatability::new(&from, &self.settings.noise)
    }

    /// Of each feature one over its deviation; 0 for what is lost or tells nothing.
    fn weights(&self, windows: &Windows, repeatability: &Repeatability, simulated: &[f64]) -> Vec<f64> {
        let pairs = windows.means(&self.part.channels).into_iter().zip(simulated).zip(&repeatability.variance);
        pairs.map(|((m, s), v)| if (m - s).is_finite() && *v > 0.0 { 1.0 / v.sqrt() } else { 0.0 }).collect()
    }

    /// Residuals over their deviations, and the weights by which they were multiplied.
    fn residuals(&self, windows: &Windows, repeatability: &Repeatability, rows: &Rows) -> (DVector<f64>, Vec<f64>) {
        let (measured, simulated) = (windows.means(&self.part.channels), windows.means(rows));
        let weights = self.weights(windows, repeatability, &simulated);
        let of = |i: usize| if weights[i] > 0.0 { (measured[i] - simulated[i]) * weights[i] } else { 0.0 };
        (DVector::from_fn(weights.len(), |i, _| of(i)), weights)
    }

    fn cost(&self, windows: &Windows, repeatability: &Repeatability, point: &TrialPoint, start: &[f64]) -> f64 {
        let prior = self.settings.fitting.prior;
        let off = point.at.iter().zip(start).map(|(a, b)| (a - b) * (a - b) / (prior * prior)).sum::<f64>();
        self.residuals(windows, repeatability, &point.rows).0.norm_squared() + off
    }

    /// The step to the least squares within the bounds, if features were linear. What would leave its bounds is held at
    /// them, the worst first.
    fn direction(
        &self,
        w: &Windows,
        repeatability: &Repeatability,
        point: &TrialPoint,
        slopes: &[Rows],
        start: &[f64],
    ) -> DVector<f64> {
        let n = point.at.len();
        let (r, weights) = self.residuals(w, repeatability, &point.rows);
        let scaled = |rows: &Rows| -> Vec<f64> {
            let each = w.means(rows).into_iter().zip(&weights);
            each.map(|(x, weight)| if x.is_finite() { x * weight } else { 0.0 }).collect()
        };
        let columns: Vec<Vec<f64>> = slopes.iter().map(scaled).collect();
        let j = DMatrix::from_fn(r.len(), n, |i, k| columns[k][i]);
        let prior = self.settings.fitting.prior;
        let prior = 1.0 / (prior * prior);
        let a = j.transpose() * &j + DMatrix::identity(n, n) * prior;
        let g = j.transpose() * &r + DVector::from_fn(n, |k, _| prior * (start[k] - point.at[k]));
        let range: Vec<(f64, f64)> = point.at.iter().map(|at| (-at, 1.0 - at)).collect();
        mode_within(&a, &g, &range, &mut vec![None; n], 1e-12).0
    }

    /// Goes along a step as far as that fits better.
    fn descend(
        &self,
        w: &Windows,
        repeatability: &Repeatability,
        from: &TrialPoint,
        step: &DVector<f64>,
        start: &[f64],
    ) -> Option<TrialPoint> {
        let before = self.cost(w, repeatability, from, start);
        let mut share = 1.0;
        for _ in 0..8 {
            let at: Vec<f64> = from.at.iter().zip(step.iter()).map(|(a, s)| (a + share * s).clamp(0.0, 1.0)).collect();
            if let Ok(rows) = self.one(&at) {
                let next = TrialPoint { at, rows };
                if self.cost(w, repeatability, &next, start) < before {
                    return Some(next);
                }
            }
            share *= 0.5;
        }
        None
    }
}
