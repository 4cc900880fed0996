//! What a layout is still free to do at its optimum, and what the rows that hold it cost.
//!
//! A vertex can move, to first order, along the null space of the rows that are active (Nocedal and Wright 2006,
//! §12.4); without the inequalities among them, of the equations alone. A row's multiplier is the derivative of the
//! shortest length by its limit (ibid., §12.9); where several are possible, the one nearest to zero is what it is worth
//! alone.

use super::Stage;
use super::multipliers;
use super::null_space::null_space;
use super::sqp::{self, SqpSettings};
use crate::base::number::{normal, significant};
use crate::base::trig::PI;
use crate::model::{ConstraintKind, Interval, Layout};
use crate::problem::measures::{self, to_variables};
use crate::problem::{Evaluation, Expansion, Problem, RowKey, RowValue, Scope};
use crate::source::Span;
use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use std::collections::BTreeMap;

/// A row is active this close to its limit, m or rad.
const ACTIVE: f64 = 1e-6;
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
    /// Derivative of the shortest length by the value the row is held at while all others stay, m a unit: the nearest to
    /// zero where limits depend on one another. `None` where the length is not at a minimum.
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
    let directions = |equations_only: bool| {
        let rows =
            active.iter().filter(|row| !equations_only || row.low == row.high).map(|row| gradient(n, &row.expansion));
        let bounds = limits.iter().filter(|(_, limit)| !equations_only || limit.low == limit.high);
        null_space(n, rows.chain(bounds.map(|&(k, _)| unit(n, k))))
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

    let prices = multipliers.map(|known| least_prices(&problem, &here, &active, &limits, &known));
    let mut prices = prices.into_iter().flatten();
    let mut rows: Vec<ActiveRow> = active
        .iter()
        .map(|row| {
            let (mut name, span) = problem.describe(row.key);
            // A line of the layout is told by what it measures, as its limit stands beside it.
            if let RowKey::Listed(i) = row.key
                && let Some(required) = problem.rows[i].required(layout)
            {
                name = name.replacen("require", &required.measured, 1);
            }
            ActiveRow::new(name, span, row_limit(row), problem.unit(row.key), prices.next())
        })
        .collect();
    rows.extend(limits.iter().map(|&(k, limit)| {
        ActiveRow::new(problem.variable_name(k), line_of(layout, &problem, k), limit, "m", prices.next())
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
            ("m", price) => ("metre", price),
            (_, price) => ("unit", price),
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

/// Derivatives of the length by the value of each active row, then of each variable at its limit: of all that are
/// possible the ones nearest to zero. `known` are multipliers of rows.
fn least_prices(
    problem: &Problem,
    here: &Evaluation,
    active: &[&RowValue],
    limits: &[(usize, Interval)],
    known: &BTreeMap<RowKey, f64>,
) -> Vec<f64> {
    let n = problem.start.len();
    let price = |row: &RowValue| -known.get(&row.key).copied().unwrap_or(0.0);
    // The slope of the length along what only limits of variables hold.
    let mut slope = DVector::<f64>::zeros(n);
    let objective = here.objective.iter().map(|term| (term, 1.0));
    let weighted = here.rows.iter().map(|row| (&row.expansion, -price(row)));
    for (expansion, weight) in objective.chain(weighted) {
        add_gradient(&mut slope, expansion, weight);
    }
    let held = |gradient, multiplier, limit: Interval| multipliers::Held {
        gradient,
        multiplier,
        below: limit.low.is_finite(),
        above: limit.high.is_finite(),
    };
    let rows = active.iter().map(|row| held(gradient(n, &row.expansion), price(row), row_limit(row)));
    let bounds = limits.iter().map(|&(k, limit)| held(unit(n, k), slope[k], limit));
    multipliers::least(&rows.chain(bounds).collect::<Vec<_>>())
}

fn add_gradient(to: &mut DVector<f64>, expansion: &Expansion, weight: f64) {
    expansion.variables.iter().zip(&expansion.gradient).for_each(|(&k, &g)| to[k] += weight * g);
}

fn gradient(n: usize, expansion: &Expansion) -> DVector<f64> {
    let mut gradient = DVector::zeros(n);
    add_gradient(&mut gradient, expansion, 1.0);
    gradient
}

fn unit(n: usize, k: usize) -> DVector<f64> {
    DVector::from_fn(n, |i, _| if i == k { 1.0 } else { 0.0 })
}

fn row_limit(row: &RowValue) -> Interval {
    held_at(row.expansion.value, row.low, row.high)
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

/// The variables at their limits, with these.
fn variable_limits(problem: &Problem, x: &[f64]) -> Vec<(usize, Interval)> {
    let at = |k: usize| (problem.bounds[k].low, problem.bounds[k].high);
    let is_held = |&k: &usize| x[k] - at(k).0 <= ACTIVE || at(k).1 - x[k] <= ACTIVE;
    (0..x.len()).filter(is_held).map(|k| (k, held_at(x[k], at(k).0, at(k).1))).collect()
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
        ConstraintKind::Holds { .. } | ConstraintKind::Require { .. } => false,
    };
    let fixed = problem.bounds[k].low == problem.bounds[k].high;
    let statement = layout.constraints.iter().find(|c| fixed && fixes(&c.kind)).map(|c| c.span);
    statement.unwrap_or(layout.radii.span)
}

/// In how many independent ways the basis moves these variables.
fn rank(basis: &[DVector<f64>], variables: &[usize]) -> usize {
    let part = DMatrix::from_fn(variables.len(), basis.len(), |i, j| basis[j][variables[i]]);
    if basis.is_empty() { 0 } else { part.singular_values().iter().filter(|s| **s > SHARE).count() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::fixture::loop_through;
    use crate::model::instances::thesis10;
    use crate::solve::{Discretise, Options, solve_with};

    fn continuous(layout: &Layout) -> Vec<Stage> {
        let nothing: Discretise = |_, _, solution, _, _, _| solution.clone().into();
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

    /// All four turns are at 90 degrees and the winding is 360, so these limits depend on one another. Each gives way alone.
    #[test]
    fn limits_that_depend_on_one_another_cost_what_each_alone_gains() {
        let layout = loop_through("smallest", &[(0.0, 0.0, 3.0), (12.0, 0.0, 3.0), (12.0, 9.0, 3.0), (0.0, 9.0, 3.0)]);
        let stages = continuous(&layout);
        let found = freedom(&layout, &stages[1]);
        let problem = Problem::new(&layout, Scope::Obstacles);
        let step = 1e-3;
        for row in &found.rows {
            let price = row.length_per_unit.unwrap();
            let mut looser = problem.clone();
            if let Some(listed) = looser.rows.iter_mut().find(|r| r.label == row.row) {
                (listed.low, listed.high) = (listed.low - step, listed.high + step);
            } else {
                let k = (0..problem.start.len()).find(|&k| problem.variable_name(k) == row.row).unwrap();
                looser.bounds[k].low -= step;
            }
            let settings = SqpSettings { radius: 0.01, ..SqpSettings::default() };
            let start = to_variables(&stages[1].corners);
            let gain = (stages[1].length - sqp::minimise(&looser, &start, &settings, &|_, _, _| {}).length) / step;
            assert!((gain - price.abs()).abs() < 0.02, "{}: gains {gain}, said to be {price}", row.row);
        }
        assert!(found.rows.len() >= 8);
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
