//! What a layout is still free to do at its optimum, and what the rows that hold it cost.
//!
//! A vertex can move, to first order, along the null space of the rows that are active (Nocedal and Wright 2006,
//! §12.4); without the inequalities among them, of the equations alone. A row's multiplier is the derivative of the
//! shortest length by its limit (ibid., §12.9).

use super::Stage;
use super::sqp::{self, SqpSettings};
use crate::base::number::{normal, significant};
use crate::base::trig::PI;
use crate::model::{ConstraintKind, Interval, Layout};
use crate::problem::measures::{self, to_variables};
use crate::problem::{Problem, RowKey, RowValue, Scope};
use crate::source::Span;
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use serde::Serialize;

/// A row is active this close to its limit, m or rad.
const ACTIVE: f64 = 1e-6;
/// Rows are scaled to unit gradients; combinations of them that are shorter than this are none.
const RANK: f64 = 1e-5;
/// A vertex moves along a direction of the null space if it takes this share of it.
const SHARE: f64 = 1e-5;
/// An optimum found again may be this far off, m.
const SAME: f64 = 1e-3;
/// Multipliers below this are none, m a unit.
const NO_PRICE: f64 = 1e-6;

/// Whether something may still change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Hold {
    /// It can move without leaving the rows that are active.
    Free,
    /// Only rows at one of their limits hold it.
    Bound,
    /// Equations hold it wherever the rest goes.
    Fixed,
}

/// What a vertex is free to do.
#[derive(Clone, Debug, Serialize)]
pub struct VertexFreedom {
    pub vertex: String,
    pub position: Hold,
    /// Directions the position can move in: 0, 1 or 2.
    pub directions: usize,
    pub radius: Hold,
}

/// A row at its limit.
#[derive(Clone, Debug, Serialize)]
pub struct ActiveRow {
    /// As messages call it: `clearance of O1 to the curve at P2`.
    pub row: String,
    /// The line it comes from, where there is one.
    #[serde(skip)]
    pub span: Span,
    pub limit: Interval,
    /// `m` or `rad`.
    pub unit: &'static str,
    /// Derivative of the shortest length by the value the row is held at, m a unit; `None` where the length is
    /// not at a minimum.
    pub length_per_unit: Option<f64>,
    /// What that means.
    pub words: String,
}

/// The freedom of a layout at the optimum of a continuous stage.
#[derive(Clone, Debug, Serialize)]
pub struct Freedom {
    pub stage: &'static str,
    /// m
    pub length: f64,
    /// Independent ways in which the layout as a whole can still move.
    pub degrees: usize,
    pub vertices: Vec<VertexFreedom>,
    /// The dearest first.
    pub rows: Vec<ActiveRow>,
}

/// What holds a layout at the optimum that a stage found.
pub fn freedom(layout: &Layout, stage: &Stage) -> Freedom {
    let scope = if stage.name == "stage1" { Scope::Building } else { Scope::Obstacles };
    let problem = Problem::new(layout, scope);
    let mut x = to_variables(&stage.corners);
    // From its optimum a stage ends again at once, and says what it ended on. Elsewhere there are no prices.
    let settings = SqpSettings { radius: 1e-3, ..SqpSettings::default() };
    let again = sqp::minimise(&problem, &x, &settings, &|_, _, _| {});
    let moved = x.iter().zip(&again.variables).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let mut multipliers = None;
    if moved <= SAME {
        x = again.variables;
        multipliers = Some(again.multipliers);
    }
    let here = problem.evaluate(&x, ACTIVE);
    let active: Vec<&RowValue> = here.rows.iter().filter(|row| is_active(row)).collect();
    let limits = variable_limits(&problem, &x);

    let n = x.len();
    let dense = |row: &RowValue| {
        let mut gradient = DVector::zeros(n);
        row.expansion.variables.iter().zip(&row.expansion.gradient).for_each(|(&k, &g)| gradient[k] = g);
        gradient
    };
    let unit = |k: usize| DVector::from_fn(n, |i, _| if i == k { 1.0 } else { 0.0 });
    let directions = |equations_only: bool| {
        let rows = active.iter().filter(|row| !equations_only || row.low == row.high).map(|row| dense(row));
        let bounds = limits.iter().filter(|(_, limit)| !equations_only || limit.low == limit.high);
        null_space(n, rows.chain(bounds.map(|&(k, _)| unit(k))))
    };
    let (all, equations) = (directions(false), directions(true));
    let hold = |variables: &[usize]| match (rank(&all, variables), rank(&equations, variables)) {
        (0, 0) => Hold::Fixed,
        (0, _) => Hold::Bound,
        _ => Hold::Free,
    };
    let vertex = |i: usize| {
        let position = [measures::x(i), measures::y(i)];
        VertexFreedom {
            vertex: problem.vertices[i].clone(),
            position: hold(&position),
            directions: rank(&all, &position),
            radius: hold(&[measures::radius(i)]),
        }
    };

    let price = |key: RowKey| multipliers.as_ref().map(|all| all.get(&key).copied().unwrap_or(0.0));
    // The slope of the length along what only bounds hold.
    let mut slope = DVector::<f64>::zeros(n);
    let objective = here.objective.iter().map(|term| (term, 1.0));
    let weighted = here.rows.iter().filter_map(|row| price(row.key).map(|price| (&row.expansion, price)));
    for (expansion, weight) in objective.chain(weighted) {
        expansion.variables.iter().zip(&expansion.gradient).for_each(|(&k, &g)| slope[k] += weight * g);
    }
    let mut rows: Vec<ActiveRow> = active
        .iter()
        .map(|row| {
            let (name, span) = problem.describe(row.key);
            let limit = held_at(row.expansion.value, row.low, row.high);
            ActiveRow::new(name, span, limit, problem.unit(row.key), price(row.key).map(|price| -price))
        })
        .collect();
    rows.extend(limits.iter().map(|&(k, limit)| {
        let (span, limit) = (line_of(layout, &problem, k), held_at(x[k], limit.low, limit.high));
        ActiveRow::new(problem.variable_name(k), span, limit, "m", multipliers.as_ref().map(|_| slope[k]))
    }));
    // To a millionth, so that rows that cost the same stay in their order.
    let size = |row: &ActiveRow| row.length_per_unit.map_or(0.0, |price| (price.abs() * 1e6).round());
    rows.sort_by(|a, b| size(b).total_cmp(&size(a)));
    Freedom {
        stage: stage.name,
        length: here.length,
        degrees: all.len(),
        vertices: (0..problem.vertices.len()).map(vertex).collect(),
        rows,
    }
}

impl ActiveRow {
    fn new(row: String, span: Span, limit: Interval, unit: &'static str, length_per_unit: Option<f64>) -> Self {
        let length_per_unit = length_per_unit.map(normal);
        let (each, per) = match (unit, length_per_unit) {
            ("rad", price) => ("degree", price.map(|price| price * PI / 180.0)),
            (_, price) => ("metre", price),
        };
        let words = match per {
            None => "the length is not at its least here".to_owned(),
            Some(per) if per.abs() < NO_PRICE && limit.low == limit.high => {
                "a little more or less here changes nothing".to_owned()
            }
            Some(per) if per.abs() < NO_PRICE => "giving way here alone changes nothing".to_owned(),
            Some(per) => {
                let way = if per > 0.0 { "less" } else { "more" };
                format!("each {each} {way} here shortens the track by {} m", significant(per.abs(), 2))
            }
        };
        ActiveRow { row, span, limit, unit, length_per_unit, words }
    }
}

fn is_active(row: &RowValue) -> bool {
    let value = row.expansion.value;
    value - row.low <= ACTIVE || row.high - value <= ACTIVE
}

/// The limit that a value is at: both ends alike, or one of them infinite.
fn held_at(value: f64, low: f64, high: f64) -> Interval {
    match (value - low <= ACTIVE, high - value <= ACTIVE) {
        (true, true) => Interval { low, high },
        (true, false) => Interval { low, high: f64::INFINITY },
        _ => Interval { low: f64::NEG_INFINITY, high },
    }
}

/// The variables at their limits.
fn variable_limits(problem: &Problem, x: &[f64]) -> Vec<(usize, Interval)> {
    let at = |k: &usize| x[*k] - problem.bounds[*k].low <= ACTIVE || problem.bounds[*k].high - x[*k] <= ACTIVE;
    (0..x.len()).filter(at).map(|k| (k, problem.bounds[k])).collect()
}

/// The statement that limits a variable.
fn line_of(layout: &Layout, problem: &Problem, k: usize) -> Span {
    let (vertex, is_radius) = (k / 3, k % 3 == 2);
    let fixes = |kind: &ConstraintKind| match kind {
        ConstraintKind::FixVertex { vertex: v } => *v == vertex && !is_radius,
        ConstraintKind::FixRadius { vertex: v } => *v == vertex && is_radius,
        ConstraintKind::FixSection { target, kinds } => {
            !is_radius
                && !target.straight
                && kinds.len() == 4
                && (target.from == vertex || layout.next(target.from) == vertex)
        }
        ConstraintKind::Require { .. } => false,
    };
    let fixed = problem.bounds[k].low == problem.bounds[k].high;
    let statement = layout.constraints.iter().find(|c| fixed && fixes(&c.kind)).map(|c| c.span);
    statement.unwrap_or(layout.radii.span)
}

/// An orthonormal basis of what no row changes.
pub(super) fn null_space(n: usize, rows: impl Iterator<Item = DVector<f64>>) -> Vec<DVector<f64>> {
    let mut normal_matrix = DMatrix::<f64>::zeros(n, n);
    for row in rows {
        let size = row.norm();
        if size > 0.0 {
            let unit = row / size;
            normal_matrix += &unit * unit.transpose();
        }
    }
    let eigen = SymmetricEigen::new(normal_matrix);
    // Eigenvalues are squares of the rows' singular values.
    let null = (0..n).filter(|&k| eigen.eigenvalues[k] <= RANK * RANK);
    null.map(|k| eigen.eigenvectors.column(k).into_owned()).collect()
}

/// In how many independent ways the basis moves these variables.
fn rank(basis: &[DVector<f64>], variables: &[usize]) -> usize {
    let part = DMatrix::from_fn(variables.len(), basis.len(), |i, j| basis[j][variables[i]]);
    if basis.is_empty() { 0 } else { part.singular_values().iter().filter(|s| **s > SHARE).count() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::instances::thesis10;
    use crate::solve::{Discretise, Options, solve_with};

    fn continuous(layout: &Layout) -> Vec<Stage> {
        let nothing: Discretise = |_, _, solution, _, _| solution.clone().into();
        solve_with(layout, &Options::default(), nothing, &|_| {})
    }

    /// Each price against the optimum with the limit moved both ways.
    #[test]
    fn prices_are_what_moving_a_limit_changes() {
        let layout = thesis10();
        let stages = continuous(&layout);
        let found = freedom(&layout, &stages[1]);
        let problem = Problem::new(&layout, Scope::Obstacles);
        let step = 1e-4;
        let mut compared = 0;
        for row in &found.rows {
            let moved = |by: f64| {
                let mut problem = problem.clone();
                let listed = problem.rows.iter_mut().find(|r| r.label == row.row);
                if let Some(listed) = listed {
                    (listed.low, listed.high) = (listed.low + by, listed.high + by);
                } else if let Some(k) = (0..problem.start.len()).find(|&k| problem.variable_name(k) == row.row) {
                    let bound = &mut problem.bounds[k];
                    (bound.low, bound.high) = (bound.low + by, bound.high + by);
                } else {
                    let keepout = problem.keepouts.iter_mut().find(|k| row.row.contains(&k.name)).unwrap();
                    keepout.distance += by;
                }
                let settings = SqpSettings { radius: 0.01, ..SqpSettings::default() };
                sqp::minimise(&problem, &to_variables(&stages[1].corners), &settings, &|_, _, _| {}).length
            };
            // It is approached in two places, which move together.
            if row.row.contains("O1") {
                continue;
            }
            let (slope, price) = ((moved(step) - moved(-step)) / (2.0 * step), row.length_per_unit.unwrap());
            assert!((slope - price).abs() < 1e-3 * (1.0 + price.abs()), "{}: {slope} {price}", row.row);
            compared += 1;
        }
        assert!(compared > 20, "{compared}");
    }

    #[test]
    fn a_loop_that_nothing_holds_moves_as_a_body() {
        let mut layout = thesis10();
        layout.constraints.clear();
        layout.building = None;
        layout.obstacles.clear();
        let stages = continuous(&layout);
        let found = freedom(&layout, &stages[0]);
        assert!(found.degrees >= 3, "{}", found.degrees);
        assert!(found.vertices.iter().all(|v| v.position == Hold::Free && v.directions == 2), "{:?}", found.vertices);
    }

    #[test]
    fn fixed_bound_and_free() {
        let layout = thesis10();
        let found = freedom(&layout, &continuous(&layout)[1]);
        let holds: Vec<Hold> = found.vertices.iter().map(|v| v.position).collect();
        use Hold::*;
        assert_eq!(holds, [Free, Fixed, Fixed, Bound, Bound, Bound, Bound, Fixed, Fixed, Bound]);
        assert_eq!((found.degrees, found.vertices[0].directions), (1, 1));
    }
}
