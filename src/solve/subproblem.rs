//! The quadratic subproblem of a step, solved by Clarabel: a convex model over a box, with linearised rows of which
//! some may be violated at a price.

use super::convex::Quadratic;
use crate::base::linear_program;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, SolverStatus, SupportedConeT};

/// A linearised row: low <= a·d <= high.
#[derive(Clone, Debug)]
pub struct LinearRow {
    pub coefficients: Vec<(usize, f64)>,
    pub low: f64,
    pub high: f64,
    /// Price of a unit of violation; `None` when the row holds at d = 0 and must go on doing so.
    pub price: Option<f64>,
}

/// The solution of a subproblem.
pub struct SubproblemSolution {
    pub d: Vec<f64>,
    /// One a row: positive at its upper limit, negative at its lower.
    pub multipliers: Vec<f64>,
}

/// Minimises the model within `box_low <= d <= box_high` and the rows. `None` when the numerics fail.
pub fn solve(model: &Quadratic, box_low: &[f64], box_high: &[f64], rows: &[LinearRow]) -> Option<SubproblemSolution> {
    let n = model.matrix.size;
    let mut table = Table { entries: Vec::new(), b: Vec::new() };
    let mut linear = model.linear.clone();
    // Equalities first (zero cone), then everything that is <= (nonnegative cone). `sides` remembers which constraint
    // of the cone program carries which row, and with which sign its multiplier counts.
    let mut sides: Vec<(usize, usize, f64)> = Vec::new();
    let slacks = Slacks::new(n, rows, &mut linear);
    for (r, row) in rows.iter().enumerate().filter(|(_, row)| row.low == row.high) {
        sides.push((r, table.b.len(), 1.0));
        let (over, under) = slacks.of(r);
        let extra = over.map(|s| (s, -1.0)).into_iter().chain(under.map(|s| (s, 1.0)));
        table.push(row.coefficients.iter().copied().chain(extra), row.high);
    }
    let equalities = table.b.len();
    for (r, row) in rows.iter().enumerate().filter(|(_, row)| row.low != row.high) {
        let (over, under) = slacks.of(r);
        if row.high.is_finite() {
            sides.push((r, table.b.len(), 1.0));
            table.push(row.coefficients.iter().copied().chain(over.map(|s| (s, -1.0))), row.high);
        }
        if row.low.is_finite() {
            sides.push((r, table.b.len(), -1.0));
            let negative = row.coefficients.iter().map(|&(k, a)| (k, -a));
            table.push(negative.chain(under.map(|s| (s, -1.0))), -row.low);
        }
    }
    for k in 0..n {
        table.push([(k, 1.0)].into_iter(), box_high[k]);
        table.push([(k, -1.0)].into_iter(), -box_low[k]);
    }
    for slack in n..linear.len() {
        table.push([(slack, -1.0)].into_iter(), 0.0);
    }
    let inequalities = table.b.len() - equalities;
    let p = model.matrix.to_csc(linear.len() - n);
    let (a, b) = table.into_cone_program(linear.len());
    let cones = [SupportedConeT::ZeroConeT(equalities), SupportedConeT::NonnegativeConeT(inequalities)];
    let settings = DefaultSettings { max_iter: 100, ..linear_program::settings() };
    let mut solver = DefaultSolver::new(&p, &linear, &a, &b, &cones, settings).ok()?;
    solver.solve();
    let solution = &solver.solution;
    let usable = matches!(
        solution.status,
        SolverStatus::Solved
            | SolverStatus::AlmostSolved
            | SolverStatus::InsufficientProgress
            | SolverStatus::MaxIterations
    ) && solution.x.iter().all(|v| v.is_finite());
    if !usable {
        return None;
    }
    let d = (0..n).map(|k| solution.x[k].clamp(box_low[k], box_high[k])).collect();
    let mut multipliers = vec![0.0; rows.len()];
    for (row, constraint, sign) in sides {
        multipliers[row] += sign * solution.z[constraint];
    }
    Some(SubproblemSolution { d, multipliers })
}

/// Which slack variables a row has: for exceeding its upper limit, for falling short of its lower.
struct Slacks(Vec<(Option<usize>, Option<usize>)>);

impl Slacks {
    fn new(n: usize, rows: &[LinearRow], linear: &mut Vec<f64>) -> Self {
        debug_assert_eq!(linear.len(), n);
        let mut add = |price: f64| {
            linear.push(price);
            linear.len() - 1
        };
        let of = |row: &LinearRow, add: &mut dyn FnMut(f64) -> usize| {
            let Some(price) = row.price else { return (None, None) };
            (row.high.is_finite().then(|| add(price)), row.low.is_finite().then(|| add(price)))
        };
        Slacks(rows.iter().map(|row| of(row, &mut add)).collect())
    }

    fn of(&self, row: usize) -> (Option<usize>, Option<usize>) {
        self.0[row]
    }
}

/// Constraint rows of the cone program A x + s = b.
struct Table {
    /// (column, row, value)
    entries: Vec<(usize, usize, f64)>,
    b: Vec<f64>,
}

impl Table {
    fn push(&mut self, coefficients: impl Iterator<Item = (usize, f64)>, b: f64) {
        let row = self.b.len();
        self.entries.extend(coefficients.filter(|(_, a)| *a != 0.0).map(|(k, a)| (k, row, a)));
        self.b.push(b);
    }

    /// A in compressed columns, and b.
    fn into_cone_program(mut self, columns: usize) -> (CscMatrix<f64>, Vec<f64>) {
        self.entries.sort_unstable_by_key(|&(column, row, _)| (column, row));
        let mut starts = vec![0; columns + 1];
        for &(column, ..) in &self.entries {
            starts[column + 1] += 1;
        }
        for k in 0..columns {
            starts[k + 1] += starts[k];
        }
        let (rows, values) = self.entries.iter().map(|&(_, row, value)| (row, value)).unzip();
        (CscMatrix::new(self.b.len(), columns, starts, rows, values), self.b)
    }
}
