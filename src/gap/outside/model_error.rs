//! What of a residual is noise: the part that no function of the simulated channel foretells.
//!
//! A misfit goes with what the machine does, noise does not. So the residual is fitted by a model of the model's error
//! (Ljung 1999, Model validation and model error modeling): lags of the simulated channel, of its square and cube, and
//! of the direction it moves in. It counts where it foretells stretches that it was not fitted to. What is left is the
//! noise, and a misfit that such a model cannot express.

use super::Rows;
use crate::gap::settings;
use nalgebra::{DMatrix, DVector};

/// The median of the square of a standard normal.
pub(super) const MEDIAN_SQUARE: f64 = 0.454_936;

/// Rows of samples without what their own model of the error foretells.
pub(super) fn unpredicted(left: &Rows, simulated: &Rows, settings: &settings::ModelError) -> Rows {
    left.iter().zip(simulated).map(|(left, simulated)| row(left, simulated, settings)).collect()
}

fn row(left: &[f64], simulated: &[f64], settings: &settings::ModelError) -> Vec<f64> {
    let regressors = Regressors::new(simulated, settings);
    let usable = |i: &usize| left[*i].is_finite() && regressors.at(*i).iter().all(|x| x.is_finite());
    let rows: Vec<usize> = (regressors.longest..left.len()).filter(usable).collect();
    let unknowns = regressors.count();
    if rows.len() < settings.samples_each * unknowns {
        return left.to_vec();
    }
    let block = rows.len().div_ceil(settings.blocks).max(1);
    let in_half = |half: usize| -> Vec<usize> {
        rows.iter().enumerate().filter(|(k, _)| k / block % 2 == half).map(|(_, i)| *i).collect()
    };
    let halves = [in_half(0), in_half(1)];
    let (mut before, mut after) = (0.0, 0.0);
    for (own, other) in [(0, 1), (1, 0)] {
        let Some(found) = regressors.fitted(left, &halves[own]) else { return left.to_vec() };
        for &i in &halves[other] {
            let error = left[i] - regressors.value(&found, i);
            before += left[i] * left[i];
            after += error * error;
        }
    }
    if after > (1.0 - settings.foretold) * before {
        return left.to_vec();
    }
    let Some(found) = regressors.fitted(left, &rows) else { return left.to_vec() };
    // As many degrees of freedom are lost as there are unknowns.
    let lost = (rows.len() as f64 / (rows.len() - unknowns) as f64).sqrt();
    let mut out = left.to_vec();
    // Before the longest lag nothing is foretold, so nothing is known of the noise there.
    out[..regressors.longest.min(left.len())].fill(f64::NAN);
    rows.iter().for_each(|&i| out[i] = lost * (left[i] - regressors.value(&found, i)));
    out
}

/// Functions of a simulated channel at some lags.
struct Regressors {
    functions: Vec<Vec<f64>>,
    lags: Vec<usize>,
    longest: usize,
}

impl Regressors {
    fn new(simulated: &[f64], settings: &settings::ModelError) -> Regressors {
        let known = || simulated.iter().copied().filter(|x| x.is_finite());
        let count = known().count().max(1) as f64;
        let mean = known().sum::<f64>() / count;
        let size = (known().map(|x| (x - mean) * (x - mean)).sum::<f64>() / count).sqrt().max(1e-300);
        let s: Vec<f64> = simulated.iter().map(|x| (x - mean) / size).collect();
        let slope = |i: usize| s[(i + 1).min(s.len() - 1)] - s[i.saturating_sub(1)];
        let direction = |i: usize| if slope(i) == 0.0 { 0.0 } else { slope(i).signum() };
        let functions = vec![
            s.clone(),
            s.iter().map(|x| x * x).collect(),
            s.iter().map(|x| x * x * x).collect(),
            (0..s.len()).map(direction).collect(),
        ];
        // Dense at first, then each longer by a quarter.
        let mut lags = vec![0];
        while lags.len() < settings.lags {
            let last = lags[lags.len() - 1];
            lags.push((last + 1).max(last + last / 4));
        }
        let longest = lags[lags.len() - 1];
        Regressors { functions, lags, longest }
    }

    fn count(&self) -> usize {
        self.functions.len() * self.lags.len() + 1
    }

    fn at(&self, i: usize) -> Vec<f64> {
        let each = self.functions.iter().flat_map(|f| self.lags.iter().map(move |lag| f[i - lag]));
        each.chain([1.0]).collect()
    }

    fn value(&self, found: &DVector<f64>, i: usize) -> f64 {
        self.at(i).iter().zip(found.iter()).map(|(x, y)| x * y).sum()
    }

    /// Least squares, with a ridge far below what a regressor does, as neighbouring lags are nearly the same.
    fn fitted(&self, left: &[f64], rows: &[usize]) -> Option<DVector<f64>> {
        const RIDGE: f64 = 1e-6;
        let n = self.count();
        let (mut a, mut b) = (DMatrix::<f64>::zeros(n, n), DVector::<f64>::zeros(n));
        for chunk in rows.chunks(256) {
            let x = DMatrix::from_row_iterator(chunk.len(), n, chunk.iter().flat_map(|i| self.at(*i)));
            let y = DVector::from_iterator(chunk.len(), chunk.iter().map(|i| left[*i]));
            a += x.tr_mul(&x);
            b += x.tr_mul(&y);
        }
        for k in 0..n {
            a[(k, k)] += RIDGE * rows.len() as f64;
        }
        a.cholesky().map(|c| c.solve(&b))
    }
}

/// What is faster than stretches of so many samples: each without its mean; NaN of what is lost.
pub(super) fn fast(x: &[f64], stretch: usize) -> Vec<f64> {
    let mut out = Vec::with_capacity(x.len());
    for stretch in x.chunks(stretch.max(2)) {
        let known = || stretch.iter().filter(|x| x.is_finite());
        let mean = known().sum::<f64>() / known().count().max(1) as f64;
        out.extend(stretch.iter().map(|x| x - mean));
    }
    out
}

/// Variance of white noise beside whatever is smooth: second differences have six times it. The median is taken, as a
/// jump is no noise.
pub(super) fn by_second_differences(x: &[f64]) -> f64 {
    let differences = x.windows(3).map(|w| w[0] - 2.0 * w[1] + w[2]);
    let mut squares: Vec<f64> = differences.map(|d| d * d / 6.0).filter(|d| d.is_finite()).collect();
    squares.sort_by(f64::total_cmp);
    squares.get(squares.len() / 2).map_or(0.0, |median| median / MEDIAN_SQUARE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::normal;
    use crate::base::trig;

    fn rms(x: &[f64]) -> f64 {
        let known: Vec<f64> = x.iter().copied().filter(|x| x.is_finite()).collect();
        (known.iter().map(|x| x * x).sum::<f64>() / known.len() as f64).sqrt()
    }

    /// A misfit that goes with the cube of what oscillates is told from noise, white or not.
    #[test]
    fn a_misfit_is_no_noise_and_noise_is_no_misfit() {
        let settings = settings::ModelError::default();
        let mut state = 4;
        let simulated: Vec<f64> =
            (0..4000).map(|i| trig::sin(0.3 * i as f64) + 0.5 * trig::sin(0.071 * i as f64)).collect();
        let white: Vec<f64> = (0..4000).map(|_| 0.1 * normal(&mut state)).collect();
        let misfit = |i: usize| simulated[i.saturating_sub(3)] * simulated[i.saturating_sub(3)] * simulated[i];
        let left: Vec<f64> = (0..4000).map(|i| misfit(i) + white[i]).collect();
        assert!(rms(&left) > 0.3);
        let found = rms(&fast(&row(&left, &simulated, &settings), 100));
        assert!((found / 0.1 - 1.0).abs() < 0.1, "{found}");
        let mut coloured = vec![0.0; 4000];
        for i in 1..4000 {
            coloured[i] = 0.9 * coloured[i - 1] + white[i];
        }
        let found = rms(&row(&coloured, &simulated, &settings));
        assert!((found / rms(&coloured) - 1.0).abs() < 0.05, "{found} of {}", rms(&coloured));
    }

    #[test]
    fn second_differences_see_noise_beside_what_is_smooth() {
        let mut state = 9;
        let x: Vec<f64> = (0..4000).map(|i| 50.0 * trig::sin(0.002 * i as f64) + normal(&mut state)).collect();
        assert!((by_second_differences(&x) - 1.0).abs() < 0.15, "{}", by_second_differences(&x));
    }
}
