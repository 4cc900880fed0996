//! How little polygon action the same curves can have, whatever straights lie between them.
//!
//! Deviations behind curves in series add up, each shifted by its phase ([`superposed`]), and peak to peak is a
//! seminorm that no shift changes. So with aₘ the ΔP of the m-th curve alone, and pₘ that behind m of them, |pₘ − pₘ₋₁|
//! ≤ aₘ ≤ pₘ + pₘ₋₁ and p₁ = a₁. The least sum of squares that these inequalities leave is a convex quadratic program
//! for each start, and a bound on every layout with these curves in this order. It holds as far as deviations add up,
//! to about 1 %.
//!
//! [`superposed`]: crate::kinematics::polygon::superposed

use crate::kinematics::polygon::{PolygonObjective, straight_behind};
use crate::solve::convex::{Quadratic, Symmetric};
use crate::solve::subproblem::{LinearRow, solve};

/// Relative error of the quadratic program that the bound gives away.
const NUMERICS: f64 = 1e-6;

/// The bound, m², from each curve's ΔP alone, m, in driving order. `None` when the numerics fail.
pub fn least_action(alone: &[f64], objective: PolygonObjective) -> Option<f64> {
    let n = alone.len();
    let scale = alone.iter().copied().fold(0.0, f64::max);
    if scale <= 0.0 {
        return Some(0.0);
    }
    let mut sum = 0.0;
    for start in 0..n {
        let a: Vec<f64> = (1..=n).map(|m| alone[straight_behind(start, m, n)] / scale).collect();
        let counted = |m: usize| objective.counts(m + 1, n);
        let mut matrix = Symmetric::new(n);
        (0..n).filter(|m| counted(*m)).for_each(|m| matrix.add(m, m, 2.0));
        let most: f64 = a.iter().sum();
        let (mut low, mut high) = (vec![0.0; n], vec![most; n]);
        (low[0], high[0]) = (a[0], a[0]);
        let row = |m: usize, sign: f64, low: f64, high: f64| LinearRow {
            coefficients: vec![(m, 1.0), (m - 1, sign)],
            low,
            high,
            price: None,
        };
        let rows: Vec<LinearRow> =
            (1..n).flat_map(|m| [row(m, 1.0, a[m], f64::INFINITY), row(m, -1.0, -a[m], a[m])]).collect();
        let found = solve(&Quadratic { matrix, linear: vec![0.0; n] }, &low, &high, &rows)?;
        sum += (0..n).filter(|m| counted(*m)).map(|m| found.d[m] * found.d[m]).sum::<f64>();
    }
    Some((1.0 - NUMERICS) * sum * scale * scale)
}
