//! What a limit is worth by itself, where limits depend on one another.
//!
//! At an optimum the objective's gradient is a sum of the active limits' gradients, each with its multiplier. Where
//! those gradients depend on one another the multipliers are not the only ones, and a method of optimisation ends on
//! any of them. If one limit gives way, the objective gains as much as the least of its possible multipliers says
//! (Gauvin and Dubeau 1982): a linear program for each limit.

use super::convex::{Quadratic, Symmetric};
use super::null_space::dependences;
use super::subproblem::{self, LinearRow};
use nalgebra::DVector;

/// A limit whose multiplier moves by less of a unit step among the possible ones is independent of the others.
const INDEPENDENT: f64 = 1e-6;
/// How far from the known multipliers others are looked for, in units of the largest.
const FAR: f64 = 1e3;

/// An active limit.
pub struct Held {
    /// Of its value, by variable.
    pub gradient: DVector<f64>,
    /// Derivative of the objective by the value it is held at, one of those that are possible.
    pub multiplier: f64,
    /// Whether it is held from below and from above.
    pub below: bool,
    pub above: bool,
}

/// One multiplier a limit, in the unit of `Held::multiplier`: the one nearest to zero of all that are possible, or the
/// known one where that cannot be found.
pub fn least(limits: &[Held]) -> Vec<f64> {
    let norms: Vec<f64> = limits.iter().map(|limit| limit.gradient.norm()).collect();
    // Multipliers of unit gradients.
    let known: Vec<f64> = limits.iter().zip(&norms).map(|(limit, norm)| limit.multiplier * norm).collect();
    // What may be added to them without changing their sum.
    let directions = dependences(&limits.iter().map(|limit| &limit.gradient).collect::<Vec<_>>());
    let one = |i: usize| {
        let moves = directions.iter().any(|direction| direction[i].abs() > INDEPENDENT);
        let found = if moves { nearest_to_zero(i, limits, &known, &directions) } else { Some(known[i]) };
        if norms[i] > 0.0 { found.unwrap_or(known[i]) / norms[i] } else { limits[i].multiplier }
    };
    (0..limits.len()).map(one).collect()
}

/// The multiplier of one limit that is nearest to zero: with multipliers k + D z that keep their signs, the least
/// t ≥ |kᵢ + (D z)ᵢ|.
fn nearest_to_zero(i: usize, limits: &[Held], known: &[f64], directions: &[DVector<f64>]) -> Option<f64> {
    let size = directions.len();
    let row = |j: usize, sign: f64| -> Vec<(usize, f64)> {
        directions.iter().enumerate().map(|(k, direction)| (k, sign * direction[j])).collect()
    };
    let at_least = |coefficients, low| LinearRow { coefficients, low, high: f64::INFINITY, price: None };
    // A limit that only bounds from below makes the objective grow with it, and one from above fall.
    let signs = (0..limits.len()).filter_map(|j| match (limits[j].below, limits[j].above) {
        (true, false) => Some(at_least(row(j, 1.0), -known[j].max(0.0))),
        (false, true) => Some(at_least(row(j, -1.0), known[j].min(0.0))),
        _ => None,
    });
    let amount = [1.0, -1.0].map(|sign| {
        let mut coefficients = row(i, -sign);
        coefficients.push((size, 1.0));
        at_least(coefficients, sign * known[i])
    });
    let rows: Vec<LinearRow> = signs.chain(amount).collect();
    let largest = known.iter().fold(1.0f64, |m, k| m.max(k.abs()));
    let far = FAR * largest;
    let mut linear = vec![0.0; size + 1];
    linear[size] = 1.0;
    let model = Quadratic { matrix: Symmetric::new(size + 1), linear };
    let solution = subproblem::solve(&model, &vec![-far; size + 1], &vec![far; size + 1], &rows)?;
    Some(known[i] + directions.iter().zip(&solution.d).map(|(direction, z)| direction[i] * z).sum::<f64>())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn held(gradient: [f64; 2], multiplier: f64, [below, above]: [bool; 2]) -> Held {
        Held { gradient: DVector::from_column_slice(&gradient), multiplier, below, above }
    }

    /// x + y least, with x ≥ 0, y ≥ 0, x + y ≥ 0: multipliers (1 − t, 1 − t, t) for t in 0 to 1, and no limit alone
    /// gains.
    #[test]
    fn a_limit_that_others_hold_too_is_worth_nothing() {
        let below = [true, false];
        for t in [0.0, 0.3, 1.0] {
            let limits =
                [held([1.0, 0.0], 1.0 - t, below), held([0.0, 1.0], 1.0 - t, below), held([1.0, 1.0], t, below)];
            assert!(least(&limits).iter().all(|m| m.abs() < 1e-7), "{:?}", least(&limits));
        }
    }

    /// 2 x + y least with x ≥ 0, y ≥ 0 and x + y ≥ 0: the first alone gains 1, as the last takes at most 1.
    #[test]
    fn what_others_cannot_take_is_left() {
        let below = [true, false];
        for t in [0.0, 0.5, 1.0] {
            let limits =
                [held([1.0, 0.0], 2.0 - t, below), held([0.0, 1.0], 1.0 - t, below), held([3.0, 3.0], t / 3.0, below)];
            let found = least(&limits);
            assert!((found[0] - 1.0).abs() < 1e-7 && found[1].abs() < 1e-7 && found[2].abs() < 1e-7, "{found:?}");
        }
    }

    #[test]
    fn independent_limits_keep_their_multipliers() {
        let limits = [held([2.0, 0.0], 3.5, [true, false]), held([0.5, 1.0], -7.25, [true, true])];
        assert_eq!(least(&limits), [3.5, -7.25]);
    }
}
