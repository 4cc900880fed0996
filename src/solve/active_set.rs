//! The quadratic subproblem by its active set: once the steps of a run end on the same limits, one linear system gives
//! what an interior-point method needs a dozen for.
//!
//! The primal-dual active set method (Hintermüller, Ito and Kunisch 2003): solve as if the limits of the last
//! subproblem held with equality, then release what pulls the wrong way and add what is exceeded, until nothing
//! changes. Where it ends, the Karush-Kuhn-Tucker conditions hold, which make the solution of a strictly convex model
//! the only one; where it does not within a few rounds, the caller solves otherwise.

use super::convex::Quadratic;
use super::subproblem::{LinearRow, SubproblemSolution};
use nalgebra::{DMatrix, DVector};

/// What a row or a variable ends on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Limit {
    #[default]
    None,
    Low,
    High,
    /// Below its lower limit, at its price.
    Under,
    /// Above its upper limit, at its price.
    Over,
}

/// The limits that a subproblem's solution is on.
#[derive(Clone, Debug, Default)]
pub struct ActiveSet {
    pub rows: Vec<Limit>,
    /// Of the box, one a variable.
    pub bounds: Vec<Limit>,
}

/// Rounds of changes before another method is better.
const ROUNDS: usize = 8;
/// A limit that is exceeded by less is kept, and a multiplier so far on the wrong side is zero.
const TOLERANCE: f64 = 1e-10;

/// The solution of the subproblem from a guess of its active set; `None` if it is not found within a few rounds or the
/// active rows depend on one another.
pub fn solve(
    model: &Quadratic,
    [low, high]: [&[f64]; 2],
    rows: &[LinearRow],
    guess: ActiveSet,
) -> Option<(SubproblemSolution, ActiveSet)> {
    let matrix = model.matrix.dense();
    let mut set = guess;
    for (limit, row) in set.rows.iter_mut().zip(rows) {
        *limit = possible(*limit, row);
    }
    for _ in 0..ROUNDS {
        let point = stationary(&matrix, &model.linear, [low, high], rows, &set)?;
        let next = set.revised(&point, [low, high], rows);
        if next.rows == set.rows && next.bounds == set.bounds {
            let d = point.d.iter().zip(low).zip(high).map(|((d, low), high)| d.clamp(*low, *high)).collect();
            return Some((SubproblemSolution { d, multipliers: point.multipliers }, set));
        }
        set = next;
    }
    None
}

/// A limit that a row has now, for one that it had.
fn possible(limit: Limit, row: &LinearRow) -> Limit {
    let equal = row.low == row.high;
    match limit {
        Limit::None if equal => Limit::High,
        Limit::Low if equal => Limit::High,
        Limit::Under if row.price.is_none() => possible(Limit::Low, row),
        Limit::Over if row.price.is_none() => possible(Limit::High, row),
        Limit::Low | Limit::Under if !row.low.is_finite() => Limit::None,
        Limit::High | Limit::Over if !row.high.is_finite() => Limit::None,
        other => other,
    }
}

/// Where the model is stationary on the active set.
struct Stationary {
    d: Vec<f64>,
    /// One a row, positive at its upper limit.
    multipliers: Vec<f64>,
    /// The same of the box.
    bounds: Vec<f64>,
    /// a·d of each row.
    values: Vec<f64>,
}

fn stationary(
    matrix: &DMatrix<f64>,
    linear: &[f64],
    [low, high]: [&[f64]; 2],
    rows: &[LinearRow],
    set: &ActiveSet,
) -> Option<Stationary> {
    let n = linear.len();
    let mut d = vec![0.0; n];
    let mut multipliers = vec![0.0; rows.len()];
    let mut free = Vec::with_capacity(n);
    for (k, limit) in set.bounds.iter().enumerate() {
        match limit {
            Limit::Low => d[k] = low[k],
            Limit::High => d[k] = high[k],
            _ => free.push(k),
        }
    }
    let mut place = vec![None; n];
    free.iter().enumerate().for_each(|(i, &k)| place[k] = Some(i));
    // The gradient without the active rows: P d + q and the prices.
    let mut gradient = linear.to_vec();
    for (k, step) in d.iter().enumerate().filter(|(_, step)| **step != 0.0) {
        gradient.iter_mut().zip(matrix.column(k).iter()).for_each(|(g, p)| *g += p * step);
    }
    let mut active = Vec::new();
    for (r, (row, limit)) in rows.iter().zip(&set.rows).enumerate() {
        match limit {
            Limit::None => {}
            Limit::Low => active.push((r, row.low)),
            Limit::High => active.push((r, row.high)),
            Limit::Over | Limit::Under => {
                let price = row.price?;
                multipliers[r] = if *limit == Limit::Over { price } else { -price };
                row.coefficients.iter().for_each(|&(k, a)| gradient[k] += multipliers[r] * a);
            }
        }
    }
    let size = free.len() + active.len();
    let mut system = DMatrix::zeros(size, size);
    let mut right = DVector::zeros(size);
    for (i, &k) in free.iter().enumerate() {
        right[i] = -gradient[k];
        for (j, &l) in free.iter().enumerate() {
            system[(i, j)] = matrix[(k, l)];
        }
    }
    for (m, &(r, target)) in active.iter().enumerate() {
        let m = free.len() + m;
        right[m] = target;
        for &(k, a) in &rows[r].coefficients {
            match place[k] {
                Some(i) => {
                    system[(m, i)] += a;
                    system[(i, m)] += a;
                }
                None => right[m] -= a * d[k],
            }
        }
    }
    let solution = if size == 0 { right } else { regular(&system, &right)? };
    free.iter().enumerate().for_each(|(i, &k)| d[k] = solution[i]);
    for (m, &(r, _)) in active.iter().enumerate() {
        multipliers[r] = solution[free.len() + m];
    }
    let values = rows.iter().map(|row| row.coefficients.iter().map(|&(k, a)| a * d[k]).sum()).collect();
    let mut pull = matrix * DVector::from_column_slice(&d);
    pull.iter_mut().zip(linear).for_each(|(p, q)| *p += q);
    for (row, multiplier) in rows.iter().zip(&multipliers).filter(|(_, m)| **m != 0.0) {
        row.coefficients.iter().for_each(|&(k, a)| pull[k] += multiplier * a);
    }
    Some(Stationary { d, multipliers, bounds: pull.iter().map(|p| -p).collect(), values })
}

/// The solution of a system, `None` if rows of it depend on one another: they leave a pivot of rounding, and a solution
/// that solves nothing.
fn regular(system: &DMatrix<f64>, right: &DVector<f64>) -> Option<DVector<f64>> {
    let solution = system.clone().lu().solve(right)?;
    let off = (system * &solution - right).amax();
    (off <= TOLERANCE * (1.0 + right.amax()) && solution.amax() < 1e9).then_some(solution)
}

impl ActiveSet {
    /// The set that a solution of another method is on: what is within its accuracy of a limit and pulls that way.
    pub fn of(solution: &SubproblemSolution, [low, high]: [&[f64]; 2], rows: &[LinearRow]) -> Self {
        const NEAR: f64 = 1e-7;
        let bounds = solution.d.iter().zip(low).zip(high);
        let bounds = bounds.map(|((d, low), high)| match () {
            () if d - low < NEAR => Limit::Low,
            () if high - d < NEAR => Limit::High,
            () => Limit::None,
        });
        let limit = |(row, multiplier): (&LinearRow, &f64)| {
            let value: f64 = row.coefficients.iter().map(|&(k, a)| a * solution.d[k]).sum();
            let paid = row.price.is_some_and(|price| multiplier.abs() > (1.0 - 1e-4) * price);
            match () {
                () if paid && value > row.high + NEAR => Limit::Over,
                () if paid && value < row.low - NEAR => Limit::Under,
                () if *multiplier > NEAR => Limit::High,
                () if *multiplier < -NEAR => Limit::Low,
                () => Limit::None,
            }
        };
        ActiveSet { bounds: bounds.collect(), rows: rows.iter().zip(&solution.multipliers).map(limit).collect() }
    }

    /// The set with what the conditions ask for.
    fn revised(&self, at: &Stationary, [low, high]: [&[f64]; 2], rows: &[LinearRow]) -> Self {
        let bound = |(k, limit): (usize, &Limit)| match limit {
            Limit::High if at.bounds[k] < -TOLERANCE => Limit::None,
            Limit::Low if at.bounds[k] > TOLERANCE => Limit::None,
            Limit::High | Limit::Low => *limit,
            _ if at.d[k] > high[k] + TOLERANCE => Limit::High,
            _ if at.d[k] < low[k] - TOLERANCE => Limit::Low,
            _ => Limit::None,
        };
        let row = |(r, limit): (usize, &Limit)| {
            let (row, value, multiplier) = (&rows[r], at.values[r], at.multipliers[r]);
            let price = row.price.unwrap_or(f64::INFINITY);
            let equal = row.low == row.high;
            match limit {
                Limit::High | Limit::Low if multiplier > price + TOLERANCE => Limit::Over,
                Limit::High | Limit::Low if multiplier < -price - TOLERANCE => Limit::Under,
                Limit::High if multiplier < -TOLERANCE && !equal => Limit::None,
                Limit::Low if multiplier > TOLERANCE && !equal => Limit::None,
                Limit::Over if value < row.high - TOLERANCE => Limit::High,
                Limit::Under if value > row.low + TOLERANCE => possible(Limit::Low, row),
                Limit::None if value > row.high + TOLERANCE => Limit::High,
                Limit::None if value < row.low - TOLERANCE => Limit::Low,
                other => *other,
            }
        };
        ActiveSet {
            bounds: self.bounds.iter().enumerate().map(bound).collect(),
            rows: self.rows.iter().enumerate().map(row).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::convex::Symmetric;
    use crate::solve::subproblem;
    use proptest::prelude::*;
    use proptest::strategy::ValueTree;

    /// Eight variables in a box of ±1, three rows with prices, one without, one equality with a price.
    fn random(numbers: &[f64]) -> (Quadratic, Vec<LinearRow>) {
        let mut numbers = numbers.iter().copied().cycle();
        let mut next = || numbers.next().unwrap_or_default();
        let mut matrix = Symmetric::new(8);
        for _ in 0..10 {
            let v: Vec<f64> = (0..8).map(|_| next()).collect();
            (0..8).for_each(|i| (i..8).for_each(|j| matrix.add(i, j, v[i] * v[j])));
        }
        (0..8).for_each(|k| matrix.add(k, k, 0.1));
        let linear = (0..8).map(|_| 3.0 * next()).collect();
        let rows = (0..5).map(|r| {
            let coefficients = (0..4).map(|k| ((3 * r + k) % 8, next())).collect();
            let (low, high, price) = match r {
                4 => (0.3 * next(), 0.0, Some(2.0)),
                3 => (-next().abs(), next().abs(), None),
                _ => (f64::NEG_INFINITY, next(), Some(0.5)),
            };
            LinearRow { coefficients, low, high: if r == 4 { low } else { high }, price }
        });
        (Quadratic { matrix, linear }, rows.collect())
    }

    /// What a subproblem minimises, and how far its rows without a price are exceeded.
    fn merit(model: &Quadratic, rows: &[LinearRow], d: &[f64]) -> (f64, f64) {
        let linear: f64 = model.linear.iter().zip(d).map(|(q, d)| q * d).sum();
        let mut merit = (0.5 * model.matrix.quadratic_form(d) + linear, 0.0f64);
        for row in rows {
            let value: f64 = row.coefficients.iter().map(|&(k, a)| a * d[k]).sum();
            let violation = (row.low - value).max(value - row.high).max(0.0);
            match row.price {
                Some(price) => merit.0 += price * violation,
                None => merit.1 = merit.1.max(violation),
            }
        }
        merit
    }

    /// How far two points are apart whose values differ by the interior-point method's 1e-10: the least curvature is 0.1.
    const APART: f64 = 1e-4;

    proptest! {
        /// Where it answers, from nothing or from a near problem's active set, it is no worse than the interior-point
        /// method, and ends where that one does.
        #[test]
        fn an_active_set_ends_where_the_interior_point_method_does(
            numbers in prop::collection::vec(-1.0..1.0f64, 131),
        ) {
            let (mut model, rows) = random(&numbers);
            let bounds = [&[-1.0; 8][..], &[1.0; 8][..]];
            let first = subproblem::solve(&model, bounds[0], bounds[1], &rows).unwrap();
            let set = ActiveSet::of(&first, bounds, &rows);
            let nothing = ActiveSet { rows: vec![Limit::None; 5], bounds: vec![Limit::None; 8] };
            for (nudge, guess) in [(0.0, nothing), (0.0, set.clone()), (0.05, set)] {
                model.linear[0] += nudge;
                let other = subproblem::solve(&model, bounds[0], bounds[1], &rows).unwrap();
                let Some((found, _)) = solve(&model, bounds, &rows, guess) else { continue };
                let (ours, theirs) = (merit(&model, &rows, &found.d), merit(&model, &rows, &other.d));
                prop_assert!(ours.0 <= theirs.0 + 1e-8 && ours.1 <= 1e-9, "{ours:?} against {theirs:?}");
                prop_assert!((0..8).all(|k| (found.d[k] - other.d[k]).abs() < APART), "{:?} {:?}", found.d, other.d);
            }
        }
    }

    /// It answers for most problems from the set of the solution, so the test above compares something.
    #[test]
    fn the_set_of_a_solution_is_recognised() {
        let mut runner = proptest::test_runner::TestRunner::deterministic();
        let numbers = prop::collection::vec(-1.0..1.0f64, 131);
        let found = (0..100).filter(|_| {
            let numbers = numbers.new_tree(&mut runner).unwrap().current();
            let (model, rows) = random(&numbers);
            let bounds = [&[-1.0; 8][..], &[1.0; 8][..]];
            let solution = subproblem::solve(&model, bounds[0], bounds[1], &rows).unwrap();
            solve(&model, bounds, &rows, ActiveSet::of(&solution, bounds, &rows)).is_some()
        });
        assert!(found.count() > 80);
    }
}
