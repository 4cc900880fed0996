//! Student's t distribution, for intervals from few degrees of freedom.
//!
//! Written here, because a crate of distributions would bring a second linear algebra for one function; it goes through
//! [`trig`](super::trig), so that intervals are the same digits everywhere.

use crate::base::trig::{FRAC_PI_2, sin_cos, tan};

/// Half the width of a two-sided interval in standard errors: the t below which |T| stays with probability `confidence`
/// for `dof` degrees of freedom. Infinite without any.
///
/// For whole degrees of freedom the distribution is a finite sum in θ = atan(t/√ν) (Abramowitz and Stegun 1964, 26.7.3
/// and 26.7.4), and θ is found by bisection.
///
/// ```
/// use lss::base::student::two_sided;
///
/// assert!((two_sided(0.90, 10) - 1.812_461_122_811).abs() < 1e-9); // any table of the distribution
/// ```
pub fn two_sided(confidence: f64, dof: usize) -> f64 {
    if dof == 0 {
        return f64::INFINITY;
    }
    let (mut low, mut high) = (0.0, FRAC_PI_2);
    // Halving the quarter turn 60 times leaves less than the last digit.
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if within(middle, dof) < confidence { low = middle } else { high = middle }
    }
    tan(0.5 * (low + high)) * (dof as f64).sqrt()
}

/// The probability that |T| stays below √ν tan θ.
fn within(angle: f64, dof: usize) -> f64 {
    let (sin, cos) = sin_cos(angle);
    let odd = !dof.is_multiple_of(2);
    // Odd: cos + 2/3 cos³ + (2·4)/(3·5) cos⁵ … up to cos^(ν−2). Even: 1 + 1/2 cos² + (1·3)/(2·4) cos⁴ … up to
    // cos^(ν−2).
    let (mut term, mut sum, mut power) = if odd { (cos, 0.0, 1) } else { (1.0, 0.0, 0) };
    while power + 2 <= dof && term > 0.0 {
        sum += term;
        power += 2;
        term *= cos * cos * (power - 1) as f64 / power as f64;
    }
    if odd { (angle + sin * sum) / FRAC_PI_2 } else { sin * sum }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        // Closed forms for one and two degrees of freedom; Fisher and Yates' table for others; the normal one far out.
        let cases = [
            (0.90, 1, tan(0.45 * 2.0 * FRAC_PI_2)),
            (0.90, 2, 2.919_985_580_354),
            (0.90, 3, 2.353_363_434_802),
            (0.95, 5, 2.570_581_835_636),
            (0.90, 30, 1.697_260_886_593),
            (0.99, 8, 3.355_387_331_334),
            (0.90, 1_000_000, 1.644_855_2),
        ];
        for (confidence, dof, expected) in cases {
            let found = two_sided(confidence, dof);
            assert!((found - expected).abs() < 2e-7 * expected, "{confidence} {dof}: {found}");
        }
        assert_eq!(two_sided(0.9, 0), f64::INFINITY);
    }
}
