//! Stiffness of a joint from a static test: deformation against force, fitted by F = K dⁿ (thesis §2.4).
//!
//! Least squares of the force residuals, all of one weight, by Levenberg and Marquardt's iteration (Marquardt 1963)
//! from the straight line through the logarithms. Deformation is scaled by its geometric mean d₀ meanwhile: K is the
//! force at a metre of deformation, a thousand times further than any test goes, so that K and n can hardly be told
//! apart; the force at d₀ and n can.
//!
//! Intervals are Student's, from the Jacobian J at the solution: covariance s²(JᵀJ)⁻¹ with s² = Σr²/(N − 2) (Seber and
//! Wild 2003, §2.1), taken for ln K rather than K, which is never below zero.

use crate::base::student;
use crate::base::trig::{exp, ln, pow};
use nalgebra::{Matrix2, Vector2};
use std::fmt;

/// The share of repeated tests whose intervals hold the truth.
pub const CONFIDENCE: f64 = 0.90;

/// A number with its interval of [`CONFIDENCE`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    pub value: f64,
    pub low: f64,
    pub high: f64,
}

/// F = K dⁿ as it fits a test best.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stiffness {
    /// K, N/mⁿ.
    pub stiffness: Estimate,
    /// n
    pub exponent: Estimate,
    /// Between ln K and n.
    pub correlation: f64,
    /// Root mean square of the residuals, N.
    pub rms: f64,
    /// 1 − Σr²/Σ(F − mean F)².
    pub r_squared: f64,
    /// Points with a deformation.
    pub points: usize,
}

/// F = K dⁿ with a given n.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fixed {
    /// N/mⁿ
    pub stiffness: f64,
    pub exponent: f64,
    /// Root mean square of the residuals, N.
    pub rms: f64,
}

/// Why nothing can be fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Unfit {
    /// Deformations and forces are not as many.
    Length { deformations: usize, forces: usize },
    /// The point of this index is not finite, or its deformation is below zero.
    Point(usize),
    /// Fewer than three points with a deformation above zero; how many there are.
    TooFew(usize),
    /// All deformations are the same.
    NoSpread,
    /// The force is nowhere above zero, or does not grow with deformation.
    NoGrowth,
    /// The iteration did not come to rest.
    Restless,
}

/// Steps of the iteration. From the logarithms' line a dozen are enough for any test that a power describes.
const STEPS: usize = 200;

/// Fits K and n to deformations (m, magnitudes) and forces (N, magnitudes). Points at zero deformation say nothing of
/// either and are left out.
///
/// # Errors
///
/// [`Unfit`].
///
/// ```
/// use lss::identify::stiffness::fit;
///
/// let deformation = [1e-4, 2e-4, 3e-4, 4e-4];
/// let found = fit(&deformation, &deformation.map(|d| 4e6 * d)).unwrap();
/// assert!((found.stiffness.value - 4e6).abs() < 1.0);
/// assert!((found.exponent.value - 1.0).abs() < 1e-9);
/// ```
pub fn fit(deformation: &[f64], force: &[f64]) -> Result<Stiffness, Unfit> {
    let points = points(deformation, force)?;
    let logs: Vec<(f64, f64)> = points.iter().map(|&(d, f)| (ln(d), f)).collect();
    let count = logs.len() as f64;
    let centre = logs.iter().map(|p| p.0).sum::<f64>() / count;
    // ln(d/d₀) and F.
    let scaled: Vec<(f64, f64)> = logs.iter().map(|&(l, f)| (l - centre, f)).collect();
    if scaled.iter().all(|p| p.0.abs() < 1e-12) {
        return Err(Unfit::NoSpread);
    }
    let solution = solve(&scaled, start(&scaled)?)?;
    let (level, exponent) = (solution[0], solution[1]);
    if exponent <= 0.0 {
        return Err(Unfit::NoGrowth);
    }
    let (normal, _, squares) = equations(&scaled, &solution);
    let dof = points.len() - 2;
    let inverse = normal.try_inverse().ok_or(Unfit::NoSpread)?;
    let covariance = inverse * (squares / dof as f64);
    // ln K = ln F(d₀) − n ln d₀.
    let (of_level, of_both, of_exponent) = (covariance[(0, 0)], covariance[(0, 1)], covariance[(1, 1)]);
    let of_log = (of_level - 2.0 * centre * of_both + centre * centre * of_exponent).max(0.0);
    let t = student::two_sided(CONFIDENCE, dof);
    let log = level - exponent * centre;
    let (wide, far) = (t * of_log.sqrt(), t * of_exponent.sqrt());
    // The same of (JᵀJ)⁻¹, which is there without residuals, too.
    let spread = inverse[(0, 0)] - 2.0 * centre * inverse[(0, 1)] + centre * centre * inverse[(1, 1)];
    let correlation = (inverse[(0, 1)] - centre * inverse[(1, 1)]) / (spread * inverse[(1, 1)]).sqrt();
    if !(exp(log).is_finite() && squares.is_finite()) {
        return Err(Unfit::Restless);
    }
    let mean = points.iter().map(|p| p.1).sum::<f64>() / count;
    let total: f64 = points.iter().map(|p| (p.1 - mean) * (p.1 - mean)).sum();
    Ok(Stiffness {
        stiffness: Estimate { value: exp(log), low: exp(log - wide), high: exp(log + wide) },
        exponent: Estimate { value: exponent, low: exponent - far, high: exponent + far },
        correlation: correlation.clamp(-1.0, 1.0),
        rms: (squares / count).sqrt(),
        r_squared: if total > 0.0 { 1.0 - squares / total } else { 0.0 },
        points: points.len(),
    })
}

/// Fits K alone, for an exponent that is given: K = ΣF dⁿ/Σd²ⁿ.
///
/// # Errors
///
/// [`Unfit`], but two points are enough.
pub fn fit_with(deformation: &[f64], force: &[f64], exponent: f64) -> Result<Fixed, Unfit> {
    let points: Vec<(f64, f64)> = points(deformation, force)?.into_iter().map(|(d, f)| (pow(d, exponent), f)).collect();
    let sum = |f: fn(&(f64, f64)) -> f64| points.iter().map(f).sum::<f64>();
    let stiffness = sum(|p| p.0 * p.1) / sum(|p| p.0 * p.0);
    if !(stiffness > 0.0 && stiffness.is_finite()) {
        return Err(Unfit::NoGrowth);
    }
    let squares: f64 = points.iter().map(|(d, f)| (f - stiffness * d) * (f - stiffness * d)).sum();
    if !squares.is_finite() {
        return Err(Unfit::Restless);
    }
    Ok(Fixed { stiffness, exponent, rms: (squares / points.len() as f64).sqrt() })
}

/// The points that say something.
fn points(deformation: &[f64], force: &[f64]) -> Result<Vec<(f64, f64)>, Unfit> {
    if deformation.len() != force.len() {
        return Err(Unfit::Length { deformations: deformation.len(), forces: force.len() });
    }
    let all = || deformation.iter().copied().zip(force.iter().copied());
    if let Some(i) = all().position(|(d, f)| !(d >= 0.0 && d.is_finite() && f.is_finite())) {
        return Err(Unfit::Point(i));
    }
    let points: Vec<_> = all().filter(|(d, _)| *d > 0.0).collect();
    if points.len() < 3 { Err(Unfit::TooFew(points.len())) } else { Ok(points) }
}

/// The line through the logarithms of the forces that have one.
fn start(scaled: &[(f64, f64)]) -> Result<Vector2<f64>, Unfit> {
    let logs: Vec<(f64, f64)> = scaled.iter().filter(|p| p.1 > 0.0).map(|&(l, f)| (l, ln(f))).collect();
    if logs.is_empty() {
        return Err(Unfit::NoGrowth);
    }
    let count = logs.len() as f64;
    let (x, y) = (logs.iter().map(|p| p.0).sum::<f64>() / count, logs.iter().map(|p| p.1).sum::<f64>() / count);
    let spread: f64 = logs.iter().map(|p| (p.0 - x) * (p.0 - x)).sum();
    let common: f64 = logs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    let slope = if spread > 0.0 { common / spread } else { 1.0 };
    Ok(Vector2::new(y - slope * x, slope))
}

/// JᵀJ, −Jᵀr and Σr² of the residuals r = F₀(d/d₀)ⁿ − F at (ln F₀, n).
fn equations(scaled: &[(f64, f64)], at: &Vector2<f64>) -> (Matrix2<f64>, Vector2<f64>, f64) {
    let (mut normal, mut right, mut squares) = (Matrix2::zeros(), Vector2::zeros(), 0.0);
    for &(log, force) in scaled {
        let model = exp(at[0] + at[1] * log);
        let row = Vector2::new(model, model * log);
        let residual = model - force;
        normal += row * row.transpose();
        right -= row * residual;
        squares += residual * residual;
    }
    (normal, right, squares)
}

/// Levenberg and Marquardt's iteration, damped by the diagonal.
fn solve(scaled: &[(f64, f64)], start: Vector2<f64>) -> Result<Vector2<f64>, Unfit> {
    let (mut at, mut damping) = (start, 1e-3);
    let (mut normal, mut right, mut squares) = equations(scaled, &at);
    for _ in 0..STEPS {
        let damped = normal + Matrix2::from_diagonal(&normal.diagonal()) * damping;
        let step = damped.try_inverse().ok_or(Unfit::NoSpread)? * right;
        let next = at + step;
        let found = equations(scaled, &next);
        if found.2 <= squares {
            at = next;
            (normal, right, squares) = found;
            damping *= 0.1;
        } else {
            damping *= 10.0;
        }
        if step.amax() < 1e-13 * at.amax().max(1.0) {
            return Ok(at);
        }
    }
    Err(Unfit::Restless)
}

impl fmt::Display for Unfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Unfit::Length { deformations, forces } => write!(f, "{deformations} deformations but {forces} forces"),
            Unfit::Point(_) => write!(f, "a deformation is below zero, or a number is not finite"),
            Unfit::TooFew(1) => write!(f, "there is 1 point with a deformation; K and n need three"),
            Unfit::TooFew(n) => write!(f, "there are {n} points with a deformation; K and n need three"),
            Unfit::NoSpread => write!(f, "all deformations are the same: K and n cannot be told apart"),
            Unfit::NoGrowth => write!(f, "the force does not grow with the deformation"),
            Unfit::Restless => write!(f, "no power of the deformation fits the force"),
        }
    }
}

impl std::error::Error for Unfit {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::trig::{TAU, cos};

    /// Normal numbers by Box and Muller from a linear congruence (Knuth's MMIX).
    struct Noise(u64);

    impl Noise {
        fn uniform(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((self.0 >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
        }

        fn normal(&mut self) -> f64 {
            (-2.0 * ln(self.uniform())).sqrt() * cos(TAU * self.uniform())
        }
    }

    fn deformations(n: usize) -> Vec<f64> {
        (0..=n).map(|i| 0.4e-3 * i as f64 / n as f64).collect()
    }

    #[test]
    fn without_noise_the_truth_is_found() {
        for (k, n) in [(4e6, 1.0), (2.5e8, 1.5), (7.3e9, 1.93), (1e5, 0.6)] {
            let d = deformations(12);
            let force: Vec<f64> = d.iter().map(|d| k * pow(*d, n)).collect();
            let found = fit(&d, &force).expect("a fit");
            assert!((found.stiffness.value / k - 1.0).abs() < 1e-10, "{found:?}");
            assert!((found.exponent.value - n).abs() < 1e-11, "{found:?}");
            assert!(found.rms < 1e-9 && found.r_squared > 1.0 - 1e-12 && found.points == 12);
            assert!(found.correlation > 0.98, "K lies far outside: {found:?}");
            let fixed = fit_with(&d, &force, n).expect("a fit");
            assert!((fixed.stiffness / k - 1.0).abs() < 1e-12 && fixed.rms < 1e-9);
        }
    }

    /// Nine of ten intervals hold the truth: over 1000 tests of ten points (200 for each of five truths), between 87
    /// and 93 %, which is three standard deviations of the count.
    #[test]
    fn nine_of_ten_intervals_hold_the_truth() {
        let (mut held, mut tests) = ([0, 0], 0);
        for (which, (k, n)) in [(4e6, 1.0), (2.5e8, 1.5), (2e10, 2.0), (3e7, 1.2), (1e6, 0.8)].into_iter().enumerate() {
            let d = deformations(10);
            let full = k * pow(0.4e-3, n);
            for seed in 0..200 {
                let mut noise = Noise(1000 * which as u64 + seed);
                let force: Vec<f64> = d.iter().map(|d| k * pow(*d, n) + 0.02 * full * noise.normal()).collect();
                let found = fit(&d, &force).expect("a fit");
                let holds = |e: Estimate, truth: f64| usize::from(e.low <= truth && truth <= e.high);
                held[0] += holds(found.stiffness, k);
                held[1] += holds(found.exponent, n);
                tests += 1;
            }
        }
        for held in held {
            let share = held as f64 / tests as f64;
            assert!((share - 0.90).abs() < 0.03, "{share}");
        }
    }

    #[test]
    fn no_neighbour_of_the_fit_is_better() {
        let found = fit(&[1.0, 2.0, 3.0], &[1.0, 2.0, 3.3]).expect("a fit");
        let by = |k: f64, n: f64| -> f64 {
            [(1.0, 1.0), (2.0, 2.0), (3.0, 3.3)].iter().map(|&(d, f)| (k * pow(d, n) - f) * (k * pow(d, n) - f)).sum()
        };
        let best = by(found.stiffness.value, found.exponent.value);
        assert!((found.rms - (best / 3.0).sqrt()).abs() < 1e-12);
        for (dk, dn) in [(1e-4, 0.0), (-1e-4, 0.0), (0.0, 1e-4), (0.0, -1e-4), (1e-4, -1e-4)] {
            assert!(by(found.stiffness.value + dk, found.exponent.value + dn) > best, "{dk} {dn}");
        }
    }

    #[test]
    fn what_cannot_be_fitted_is_told() {
        let cases: [(&[f64], &[f64], Unfit); 8] = [
            (&[1.0], &[], Unfit::Length { deformations: 1, forces: 0 }),
            (&[], &[], Unfit::TooFew(0)),
            (&[0.0, 1.0, 2.0], &[0.0, 1.0, 2.0], Unfit::TooFew(2)),
            (&[1.0, -1.0, 2.0], &[1.0, 1.0, 2.0], Unfit::Point(1)),
            (&[1.0, 1.0, f64::NAN], &[1.0, 1.0, 2.0], Unfit::Point(2)),
            (&[1.0, 1.0, 1.0], &[1.0, 1.1, 1.2], Unfit::NoSpread),
            (&[1.0, 2.0, 3.0], &[-1.0, -2.0, -3.0], Unfit::NoGrowth),
            (&[1.0, 2.0, 3.0], &[3.0, 2.0, 1.0], Unfit::NoGrowth),
        ];
        for (deformation, force, expected) in cases {
            assert_eq!(fit(deformation, force), Err(expected));
        }
    }

    /// Numbers as large or small as they come end in an answer or an error.
    #[test]
    fn extremes_are_no_panic() {
        for d in [1e-300, 1.0, 1e300] {
            for f in [1e-300, 1.0, 1e300] {
                for scale in [1.0 + 1e-9, 2.0, 1e5] {
                    if let Ok(found) = fit(&[d, d * scale, d / scale], &[f, f * scale, f / scale]) {
                        assert!(found.stiffness.value.is_finite() && found.rms.is_finite(), "{found:?}");
                    }
                    if let Ok(found) = fit_with(&[d, d * scale, d / scale], &[f, f, f], 1.5) {
                        assert!(found.stiffness.is_finite() && found.rms.is_finite(), "{found:?}");
                    }
                }
            }
        }
    }
}
