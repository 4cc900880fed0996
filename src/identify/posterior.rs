//! What a run and the prior together say: the step to the best parameters, and how sure they are.
//!
//! Weighted least squares whose weights need not be the inverse covariance: with slopes J, weights W and the covariance
//! Σ of replicate laps, JᵀWr scatters by B = JᵀWΣWJ and answers the parameters by A = JᵀWJ, so the run's information is A
//! B⁻¹ A (Godambe 1960; McFadden 1989 for simulated features). The prior's is added to it.

use super::parameter::COUNT;
use nalgebra::{DMatrix, DVector, SymmetricEigen};

/// The information of a run about the parameters, in coordinates divided by their reach.
#[derive(Clone, Debug)]
pub struct Information {
    /// A B⁻¹ A
    pub matrix: DMatrix<f64>,
    /// A B⁻¹ JᵀWr: its product with the inverse is the run's own step.
    pub pull: DVector<f64>,
}

impl Information {
    /// From A, B and g = JᵀWr. With features that vary each on its own, B would be A; what B has less of is not
    /// believed, as the laps it was estimated from are few and the slopes in A carry noise.
    pub fn new(a: &DMatrix<f64>, b: &DMatrix<f64>, g: &DVector<f64>) -> Information {
        let n = a.nrows();
        let regular = a + DMatrix::identity(n, n) * (1e-9 * a.diagonal().max().max(1e-300));
        let Some(cholesky) = regular.cholesky() else {
            return Information { matrix: DMatrix::zeros(n, n), pull: DVector::zeros(n) };
        };
        let lower = cholesky.l();
        // L⁻¹ B L⁻ᵀ: the variance of the pull in directions in which the slopes' own is 1.
        let half = lower.solve_lower_triangular(b).unwrap_or_else(|| DMatrix::zeros(n, n));
        let whole = lower.solve_lower_triangular(&half.transpose()).unwrap_or_else(|| DMatrix::zeros(n, n));
        let eigen = SymmetricEigen::new((&whole + whole.transpose()) * 0.5);
        let weights = DMatrix::from_diagonal(&eigen.eigenvalues.map(|x| 1.0 / x.max(1.0)));
        let middle = &eigen.eigenvectors * weights * eigen.eigenvectors.transpose();
        let pulled = lower.solve_lower_triangular(g).unwrap_or_else(|| DVector::zeros(n));
        Information { matrix: &lower * &middle * lower.transpose(), pull: &lower * (&middle * pulled) }
    }
}

/// A normal distribution of the parameters within bounds.
#[derive(Clone, Debug)]
pub struct Posterior {
    /// The step to its mode.
    pub step: DVector<f64>,
    /// Covariance without regard to bounds.
    pub covariance: DMatrix<f64>,
    /// −1 or 1 where the mode is at the lower or upper bound, else 0.
    pub bound: Vec<i8>,
}

/// The mode of information and prior within bounds, all in coordinates less the present point, divided by their reach.
/// `prior` gives mean and deviation; what is not `free` stays.
pub fn posterior(
    information: &Information,
    prior: &[(f64, f64); COUNT],
    range: &[(f64, f64); COUNT],
    free: &[bool; COUNT],
) -> Posterior {
    let mut precision = information.matrix.clone();
    let mut pull = information.pull.clone();
    for (k, (mean, deviation)) in prior.iter().enumerate() {
        precision[(k, k)] += 1.0 / (deviation * deviation);
        pull[k] += mean / (deviation * deviation);
    }
    let mut held: Vec<Option<f64>> = free.iter().map(|free| if *free { None } else { Some(0.0) }).collect();
    let covariance = solve(&precision, &pull, &held).1;
    let (step, bound) = mode_within(&precision, &pull, range, &mut held, 1e-9);
    Posterior { step, covariance, bound }
}

/// The mode within ranges, where what is `held` stays there, and −1 or 1 for what ends at its lower or upper bound, else
/// 0. What is beyond its bound by no more than a tolerance is within.
pub fn mode_within(
    precision: &DMatrix<f64>,
    pull: &DVector<f64>,
    range: &[(f64, f64)],
    held: &mut [Option<f64>],
    tolerance: f64,
) -> (DVector<f64>, Vec<i8>) {
    let mut bound = vec![0_i8; held.len()];
    loop {
        let step = solve(precision, pull, held).0;
        // The worst offender is held at its bound, then the others are found anew.
        let beyond = |k: usize| (range[k].0 - step[k]).max(step[k] - range[k].1);
        let open = (0..held.len()).filter(|k| held[*k].is_none());
        let worst = open.max_by(|a, b| beyond(*a).total_cmp(&beyond(*b)));
        let Some(k) = worst.filter(|k| beyond(*k) > tolerance) else { return (step, bound) };
        bound[k] = if step[k] < range[k].0 { -1 } else { 1 };
        held[k] = Some(if bound[k] < 0 { range[k].0 } else { range[k].1 });
    }
}

/// Solves for what is not held; the covariance has zeros in the rows of what is.
fn solve(precision: &DMatrix<f64>, pull: &DVector<f64>, held: &[Option<f64>]) -> (DVector<f64>, DMatrix<f64>) {
    let open: Vec<usize> = (0..held.len()).filter(|k| held[*k].is_none()).collect();
    let mut step = DVector::from_iterator(held.len(), held.iter().map(|h| h.unwrap_or(0.0)));
    let mut covariance = DMatrix::zeros(held.len(), held.len());
    let matrix = DMatrix::from_fn(open.len(), open.len(), |i, j| precision[(open[i], open[j])]);
    let given = |k: usize| (0..held.len()).filter_map(|j| held[j].map(|x| precision[(k, j)] * x)).sum::<f64>();
    let right = DVector::from_iterator(open.len(), open.iter().map(|&k| pull[k] - given(k)));
    if let Some(cholesky) = matrix.cholesky() {
        let found = cholesky.solve(&right);
        let inverse = cholesky.inverse();
        for (i, &k) in open.iter().enumerate() {
            step[k] = found[i];
            for (j, &l) in open.iter().enumerate() {
                covariance[(k, l)] = inverse[(i, j)];
            }
        }
    }
    (step, covariance)
}

/// The standard normal distribution function, by Φ(x) = erfc(−x/√2)/2.
pub fn normal_cdf(x: f64) -> f64 {
    0.5 * libm::erfc(-x / std::f64::consts::SQRT_2)
}

/// The shortest interval that holds `share` of a normal distribution cut at bounds; it holds the mean.
pub fn interval(mean: f64, deviation: f64, range: (f64, f64), share: f64) -> (f64, f64) {
    if deviation <= 0.0 {
        return (mean, mean);
    }
    let cdf = |x: f64| normal_cdf((x - mean) / deviation);
    let whole = cdf(range.1) - cdf(range.0);
    let within = |half: f64| ((mean - half).max(range.0), (mean + half).min(range.1));
    let (mut low, mut high) = (0.0, 40.0 * deviation);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        let (from, to) = within(middle);
        if cdf(to) - cdf(from) < share * whole { low = middle } else { high = middle }
    }
    within(high)
}

/// Correlations of a covariance; 0 where a parameter is held.
pub fn correlations(covariance: &DMatrix<f64>) -> DMatrix<f64> {
    let deviation: Vec<f64> = covariance.diagonal().iter().map(|v| v.sqrt()).collect();
    DMatrix::from_fn(covariance.nrows(), covariance.ncols(), |i, j| {
        let scale = deviation[i] * deviation[j];
        if scale > 0.0 { covariance[(i, j)] / scale } else { 0.0 }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_are_those_of_tables_and_hold_what_is_at_a_bound() {
        let (low, high) = interval(0.0, 1.0, (-9.0, 9.0), 0.9);
        assert!((low + 1.644_853_627).abs() < 1e-8 && (high - 1.644_853_627).abs() < 1e-8);
        let (low, high) = interval(0.0, 2.0, (0.0, 90.0), 0.9);
        assert!(low == 0.0 && (high - 2.0 * 1.644_853_627).abs() < 1e-7, "half a normal: {low} {high}");
        assert_eq!(interval(3.0, 0.0, (0.0, 9.0), 0.9), (3.0, 3.0));
    }

    #[test]
    fn bounds_hold_and_the_rest_follows() {
        let mut matrix = DMatrix::identity(COUNT, COUNT) * 1e6;
        matrix[(0, 1)] = 5e5;
        matrix[(1, 0)] = 5e5;
        // The mode without bounds is at 2 and 0.
        let mut pull = DVector::zeros(COUNT);
        (pull[0], pull[1]) = (2e6, 1e6);
        let free = [true; COUNT];
        let mut range = [(-10.0, 10.0); COUNT];
        range[0] = (-1.0, 1.0);
        let found = posterior(&Information { matrix, pull }, &[(0.0, 1e3); COUNT], &range, &free);
        assert_eq!((found.step[0], found.bound[0]), (1.0, 1));
        assert!((found.step[1] - 0.5).abs() < 1e-6, "{}", found.step[1]);
    }
}
