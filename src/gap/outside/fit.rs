//! Fits a model's nuisances to one part of a run: Gauss and Newton's method on means over windows, with bounds, and
//! slopes from central differences.

use super::Error;
use super::Rows;
use super::data::RunPart;
use super::model_error::unpredicted;
use super::protocol::Nuisance;
use super::repeatability::{Inputs, Repeatability};
use super::windows::{Kind, Seen, Windows};
use crate::base::trig;
use crate::gap::{Frame, settings};
use crate::identify::mode_within;
use nalgebra::{DMatrix, DVector};

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
    /// Simulated samples.
    pub rows: Rows,
}

/// What the best hypothesis simulates, from which the noise is found.
pub(super) struct Reference {
    pub rows: Rows,
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

/// Steps of what is held.
fn held(held: &[bool]) -> Vec<Option<f64>> {
    held.iter().map(|held| held.then_some(0.0)).collect()
}

/// Measured less simulated, a row a channel.
pub(super) fn left(part: &RunPart, rows: &Rows) -> Rows {
    let less = |(m, s): (&Vec<f64>, &Vec<f64>)| m.iter().zip(s).map(|(m, s)| m - s).collect();
    part.channels.iter().zip(rows).map(less).collect()
}

pub(super) struct Fitter<'a> {
    pub part: &'a RunPart,
    pub nuisances: &'a [Nuisance],
    /// How closely the model is believed to follow each channel.
    pub accuracy: &'a [f64],
    pub simulate: Simulate<'a>,
    pub settings: &'a settings::Outside,
    /// Whether answers to the same question differ a little.
    pub random: bool,
    /// What the accuracies are multiplied by.
    pub accuracy_factor: f64,
    /// Nuisances that stay where the search begins.
    pub held: &'a [bool],
    /// Where the search begins, if not at the nominal values.
    pub begin: Option<&'a [f64]>,
    pub reference: Option<&'a Reference>,
}

/// The state of a fit.
struct TrialPoint {
    at: Vec<f64>,
    rows: Rows,
}

impl FittedPart {
    /// Mean square of what is left over the noise.
    pub fn mean_square(&self) -> f64 {
        let each = self.measured.iter().zip(&self.nominal).zip(&self.repeatability.variance);
        let squares: Vec<f64> = each.map(|((m, s), v)| (m - s) * (m - s) / v).filter(|x| x.is_finite()).collect();
        squares.iter().sum::<f64>() / squares.len().max(1) as f64
    }

    /// The better one of two fits to a part.
    pub fn or(self, other: Option<FittedPart>, part: &RunPart) -> FittedPart {
        match other {
            Some(other) if error(part, &other.rows) < error(part, &self.rows) => other,
            _ => self,
        }
    }
}

/// Logarithm of the mean square error of samples, summed over the channels.
pub(super) fn error(part: &RunPart, rows: &Rows) -> f64 {
    let of = |x: &Vec<f64>| {
        let known: Vec<f64> = x.iter().copied().filter(|x| x.is_finite()).collect();
        trig::ln((known.iter().map(|x| x * x).sum::<f64>() / known.len().max(1) as f64).max(1e-300))
    };
    left(part, rows).iter().map(of).sum()
}

/// Whether a start is another one.
pub(super) fn is_far(a: &[f64], b: &[f64], least: f64) -> bool {
    a.iter().zip(b).any(|(a, b)| (a - b).abs() > least)
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
        let begin = self.begin.map_or_else(|| start.clone(), <[f64]>::to_vec);
        let mut point = TrialPoint { rows: self.one(&begin)?, at: begin };
        let mut slopes = self.slopes(&point);
        let mut noise = self.noise(&point);
        let mut windows = self.suited(&point, &noise);
        // Means wait for a fit that leaves noise; where channels swing, only samples can be fitted to.
        let mut suited = windows.kind == Kind::Samples;
        if !suited {
            windows = Windows::new(self.part, self.settings.windows.first, &self.settings.windows);
        }
        let mut repeatability = self.repeatability(&windows, &point, &noise, None);
        let mut stale = 0.0;
        for step in 0..settings.steps {
            if step <= settings.settled {
                noise = self.noise(&point);
                repeatability = self.repeatability(&windows, &point, &noise, None);
            }
            let direction = self.direction(&windows, &repeatability, &point, &slopes, &start);
            let size = direction.amax();
            if !suited && (size < settings.small || step >= 2) {
                windows = self.suited(&point, &noise);
                repeatability = self.repeatability(&windows, &point, &noise, None);
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
        let noise = self.noise(&point);
        if windows.kind == Kind::Samples {
            // What began far off may have swung by that alone.
            windows = self.suited(&point, &noise);
        }
        let repeated = again(&point.at).ok().map(|rows| windows.means(&rows));
        let repeatability = self.repeatability(&windows, &point, &noise, repeated.as_deref());
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
        let rows = point.rows;
        Ok(FittedPart { at: point.at, windows, measured, nominal, repeatability, slopes: matrix, rows })
    }

    fn one(&self, at: &[f64]) -> Result<Rows, Error> {
        let missing = || Err(Error::Nothing { run: self.part.name.clone() });
        (self.simulate)(&[at.to_vec()]).pop().unwrap_or_else(missing)
    }

    /// Measured less simulated.
    fn left(&self, rows: &Rows) -> Rows {
        left(self.part, rows)
    }

    /// What nothing foretells of what is left by the best hypothesis, or by this point.
    fn noise(&self, point: &TrialPoint) -> Rows {
        let rows = self.reference.map_or(&point.rows, |reference| &reference.rows);
        unpredicted(&self.left(rows), rows, &self.settings.model_error)
    }

    fn suited(&self, point: &TrialPoint, noise: &Rows) -> Windows {
        let from = Seen { simulated: &point.rows, left: &self.left(&point.rows), noise };
        Windows::suited(self.part, &from, &self.settings.windows)
    }

    /// Of each nuisance the change of samples with it. What cannot be simulated on one side is taken from the other; on
    /// neither, it counts as none.
    fn slopes(&self, point: &TrialPoint) -> Vec<Rows> {
        let moved = |k: usize, by: f64| {
            let mut at = point.at.clone();
            at[k] = (at[k] + by).clamp(0.0, 1.0);
            at
        };
        let fitting = &self.settings.fitting;
        let difference = if self.random { fitting.random_difference } else { fitting.difference };
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

    fn repeatability(
        &self,
        windows: &Windows,
        point: &TrialPoint,
        noise: &Rows,
        repeated: Option<&[f64]>,
    ) -> Repeatability {
        let (measured, count) = (windows.means(&self.part.channels), windows.count());
        let nominal = windows.means(&point.rows);
        let random_effect = |c: usize| {
            let pairs = repeated.unwrap_or(&nominal).iter().zip(&nominal).skip(c * count).take(count);
            let squares: Vec<f64> = pairs.map(|(a, b)| (a - b) * (a - b)).filter(|x| x.is_finite()).collect();
            squares.iter().sum::<f64>() / squares.len().max(1) as f64
        };
        let repeat: Vec<f64> = (0..self.part.channels.len()).map(random_effect).collect();
        let settled = self.reference.is_some();
        let (accuracy, factor) = (self.accuracy, self.accuracy_factor);
        let from = Inputs { windows, noise, settled, measured: &measured, accuracy, factor, repeat: &repeat };
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
        mode_within(&a, &g, &range, &mut held(self.held), 1e-12).0
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

/// Features of a run with its nuisances somewhere.
pub(super) type Features<'a> = &'a dyn Fn(&[f64]) -> Result<Vec<f64>, Error>;

/// Nuisances of a run that are fitted along with effects, from where their slopes at the nominal model put them.
pub(super) struct Along<'a> {
    pub frame: &'a Frame,
    pub settings: &'a settings::Fitting,
    pub simulate: Features<'a>,
    /// Where the search may begin again if much is left.
    pub starts: &'a [Vec<f64>],
}

impl Along<'_> {
    /// The features with the nuisances where they fit best. Each step costs a simulation: slopes are corrected by what
    /// the last step was found to change (Broyden 1965), and a step is taken while it promises enough.
    ///
    /// # Errors
    ///
    /// What the model says against being simulated where the search begins.
    pub fn fit(&self, begin: &[f64]) -> Result<Vec<f64>, Error> {
        let (features, left) = self.fit_from(begin, false)?;
        if left < self.settings.restart {
            return Ok(features);
        }
        // The other start that leaves least as it is.
        let far = |start: &&Vec<f64>| is_far(begin, start, self.settings.other_start);
        let left_of = |start: &Vec<f64>| self.mean_square(&(self.simulate)(start).ok()?).map(|x| (x, start.clone()));
        let other = self.starts.iter().filter(far).filter_map(left_of).min_by(|a, b| a.0.total_cmp(&b.0));
        match other.and_then(|(_, start)| self.fit_from(&start, true).ok()) {
            Some((other, less)) if less < left => Ok(other),
            _ => Ok(features),
        }
    }

    /// Mean square of what features leave.
    fn mean_square(&self, features: &[f64]) -> Option<f64> {
        let each = self.frame.measured.iter().zip(features).zip(&self.frame.laps.variance);
        let squares: Vec<f64> = each.map(|((m, s), v)| (m - s) * (m - s) / v).filter(|x| x.is_finite()).collect();
        (!squares.is_empty()).then(|| squares.iter().sum::<f64>() / squares.len() as f64)
    }

    /// The features, and their mean square. Far from the nominal model slopes are taken anew, once.
    fn fit_from(&self, begin: &[f64], anew: bool) -> Result<(Vec<f64>, f64), Error> {
        let settings = self.settings;
        let mut features = (self.simulate)(begin)?;
        let weight = |(k, v): (usize, &f64)| {
            let known = (self.frame.measured[k] - features[k]).is_finite() && *v > 0.0 && v.is_finite();
            if known { 1.0 / v.sqrt() } else { 0.0 }
        };
        let weights: Vec<f64> = self.frame.laps.variance.iter().enumerate().map(weight).collect();
        let left = |features: &[f64]| {
            let of = |k: usize| {
                let left = (self.frame.measured[k] - features[k]) * weights[k];
                if weights[k] > 0.0 && left.is_finite() { left } else { 0.0 }
            };
            DVector::from_fn(weights.len(), |k, _| of(k))
        };
        let mut at = begin.to_vec();
        let mut slopes = DMatrix::from_fn(weights.len(), at.len(), |i, k| self.frame.slopes[(i, k)] * weights[i]);
        for k in 0..if anew { at.len() } else { 0 } {
            let mut moved = at.clone();
            let by = if at[k] < 0.5 { settings.difference } else { -settings.difference };
            moved[k] += by;
            if let Ok(other) = (self.simulate)(&moved) {
                slopes.set_column(k, &((left(&features) - left(&other)) / by));
            }
        }
        let mut now = left(&features);
        for _ in 0..if at.is_empty() { 0 } else { settings.along } {
            let n = at.len();
            let prior = 1.0 / (settings.prior * settings.prior);
            let a = slopes.tr_mul(&slopes) + DMatrix::identity(n, n) * prior;
            let range: Vec<(f64, f64)> = at.iter().map(|at| (-at, 1.0 - at)).collect();
            let step = mode_within(&a, &slopes.tr_mul(&now), &range, &mut vec![None; n], 1e-12).0;
            let foretold = (&now - &slopes * &step).norm_squared();
            if foretold > (1.0 - settings.along_enough) * now.norm_squared() {
                break;
            }
            let mut share = 1.0;
            let mut better = false;
            while !better && share > 0.2 {
                let next: Vec<f64> = at.iter().zip(step.iter()).map(|(a, s)| (a + share * s).clamp(0.0, 1.0)).collect();
                let moved = DVector::from_iterator(n, next.iter().zip(&at).map(|(a, b)| a - b));
                share *= 0.3;
                let Ok(other) = (self.simulate)(&next) else { continue };
                let then = left(&other);
                let missed = (&now - &then) - &slopes * &moved;
                slopes += missed * moved.transpose() / moved.norm_squared().max(1e-300);
                if then.norm_squared() < now.norm_squared() {
                    (at, features, now, better) = (next, other, then, true);
                }
            }
            if !better {
                break;
            }
        }
        let known = weights.iter().filter(|w| **w > 0.0).count().max(1);
        Ok((features, now.norm_squared() / known as f64))
    }
}
