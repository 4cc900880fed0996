//! Layouts whose rotation nothing fixes: the offset of the grid is a variable between 0 and a step, which is branched
//! on.
//!
//! A layout whose offset is within δ of the middle of an interval becomes one at the middle when it is turned about a
//! known vertex. No point of a loop of length L through that vertex is farther from it than L/2, so that none moves by
//! more than δ L/2. Where no vertex is known, it is turned about the centre of a disk of radius L/4, in which every loop of
//! length L lies (Nitsche 1971): no point moves by more than δ L/4. With rows and regions relaxed by as much, the search
//! at the middle bounds the whole interval.

use super::found::Found;
use crate::base::trig;
use crate::model::{Formula, Interval as Bounds};
use crate::problem::{ConstraintRow, Function, Problem};
use crate::solve::{Effort, Stop};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Offsets that are searched at the middle one.
#[derive(Clone, Copy, Debug)]
pub struct Offsets {
    pub middle: f64,
    /// How far others are from it at most, rad.
    pub within: f64,
    /// By how much no point of a loop moves from them to the middle, m.
    pub by: f64,
}

/// What is searched at an offset: a problem, the offset, the value that must be beaten, and how hard.
pub type At<'a> = dyn Fn(&Problem, Offsets, f64, Effort) -> Option<Found> + 'a;

/// Intervals are not split beyond this, rad.
const FINEST: f64 = 1e-9;

/// How many nodes an interval is searched with first: narrow intervals tell more than many nodes of a wide one.
const NODES: usize = 50;
/// How many times as many, where its width is not what leaves the bound low.
const MORE: usize = 4;

struct Interval {
    bound: f64,
    low: f64,
    high: f64,
    nodes: usize,
}

impl Ord for Interval {
    fn cmp(&self, other: &Self) -> Ordering {
        other.bound.total_cmp(&self.bound).then(other.low.total_cmp(&self.low))
    }
}

impl PartialOrd for Interval {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Interval {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Interval {}

/// Whether a problem is the same however its layout is turned about one vertex.
pub fn turns_freely(problem: &Problem) -> bool {
    let fixed = problem.bounds.chunks_exact(3).filter(|b| b[..2].iter().any(|b| b.low.is_finite())).count();
    problem.keepouts.is_empty() && fixed <= 1 && problem.rows.iter().all(|row| !directed(&row.function))
}

/// Whether a row depends on where or which way the layout lies.
fn directed(function: &Function) -> bool {
    match function {
        Function::Turn(_) | Function::Section(_) | Function::Straight(_) => false,
        Function::Linear(terms) => terms.iter().any(|(k, _)| k % 3 != 2),
        Function::StraightMiddle { .. } | Function::StraightEnd { .. } => true,
        Function::Formula(formula) => change(formula, 1.0) > 0.0,
    }
}

/// By how much a formula may change at most when a layout is turned as a whole and no point of it moves by more than
/// `by`, m; infinite where that is not known.
fn change(formula: &Formula, by: f64) -> f64 {
    let of = |formula: &Formula| change(formula, by);
    let known = |f: &Formula| match f {
        Formula::Constant(value) => Some(value.abs()),
        _ => None,
    };
    match formula {
        Formula::Constant(_)
        | Formula::Radius(_)
        | Formula::Length(_)
        | Formula::Angle(_)
        | Formula::DistanceVertices(..) => 0.0,
        Formula::X(_) | Formula::Y(_) | Formula::DistanceObstacle(..) | Formula::DistanceBuilding(_) => by,
        Formula::Heading(_) => f64::INFINITY,
        Formula::Sum(terms) => terms.iter().map(of).sum(),
        Formula::Smallest(terms) | Formula::Largest(terms) => terms.iter().map(of).fold(0.0, f64::max),
        Formula::Negative(inner) | Formula::Absolute(inner) => of(inner),
        Formula::Product(factors) => {
            let changes: Vec<f64> = factors.iter().map(of).collect();
            let moving = changes.iter().filter(|c| **c > 0.0).count();
            let still = factors.iter().zip(&changes).filter(|(_, c)| **c == 0.0);
            match (moving, still.map(|(f, _)| known(f)).try_fold(1.0, |product, f| Some(product * f?))) {
                (0, _) | (_, Some(0.0)) => 0.0,
                (1, Some(factor)) => factor * changes.iter().sum::<f64>(),
                _ => f64::INFINITY,
            }
        }
        Formula::Reciprocal(inner) | Formula::SquareRoot(inner) => {
            if of(inner) > 0.0 {
                f64::INFINITY
            } else {
                0.0
            }
        }
    }
}

/// From variables to variables and their value.
type Improve<'a> = dyn Fn(&[f64]) -> Option<(Vec<f64>, f64)> + 'a;

/// Bounds every offset, and improves the incumbent (variables and value) on the way. `improve` makes a layout of the
/// relaxed problem one of the problem, if it can; a metre of track is worth at least `metre`, and what hangs on where the loop
/// lies changes its worth by `moved` for each metre. `part_of` is told what is left open before each search of an interval.
pub fn search(
    problem: &Problem,
    step: f64,
    (incumbent, metre, moved): ((Vec<f64>, f64), f64, f64),
    (effort, stop): (Effort, Stop),
    at: &At,
    improve: &Improve,
    part_of: &dyn Fn(f64),
) -> Found {
    let mut best = incumbent;
    let reach = reach(problem);
    let first = Interval { bound: 0.0, low: -step / 2.0, high: step / 2.0, nodes: NODES };
    let mut heap = BinaryHeap::from([first]);
    let (mut nodes, mut left) = (0, f64::INFINITY);
    while let Some(interval) = heap.pop() {
        let cutoff = best.1 - (1e-7f64).max(effort.gap * best.1);
        if interval.bound >= cutoff || nodes >= effort.nodes || stop.now() {
            left = left.min(interval.bound);
            break;
        }
        part_of(if interval.bound > 0.0 { best.1 - interval.bound } else { f64::INFINITY });
        let middle = (interval.low + interval.high) / 2.0;
        let within = (interval.high - interval.low) / 2.0;
        let by = within * reach * best.1 / metre;
        let most = interval.nodes.min(effort.nodes - nodes);
        let found = at(&relaxed(problem, by), Offsets { middle, within, by }, best.1, Effort { nodes: most, ..effort });
        let Some(found) = found else { continue };
        nodes += found.nodes.max(1);
        if found.value < best.1
            && let Some((x, value)) = found.variables.as_deref().and_then(improve)
            && value < best.1
        {
            best = (x, value);
        }
        let bound = interval.bound.max(found.bound);
        // A loop around what lies by so much nearer is shorter by this (Steiner 1840).
        let relaxation = (trig::TAU * metre + moved) * by;
        if best.1 - bound > 2.0 * relaxation && found.nodes >= most {
            heap.push(Interval { bound, nodes: MORE * interval.nodes, ..interval });
        } else if interval.high - interval.low < FINEST {
            left = left.min(bound);
        } else {
            heap.push(Interval { bound, high: middle, ..interval });
            heap.push(Interval { bound, low: middle, ..interval });
        }
    }
    Found { bound: left.min(best.1), variables: Some(best.0), value: best.1, nodes, parts: Vec::new() }
}

/// How far from the point that a layout is turned about any of its points may lie, for each metre of its length.
fn reach(problem: &Problem) -> f64 {
    let is_known = |b: &[Bounds]| b[..2].iter().any(|b| b.low.is_finite() || b.high.is_finite());
    if problem.bounds.chunks_exact(3).any(is_known) { 0.5 } else { 0.25 }
}

/// The problem with everything that depends on the offset relaxed by a displacement, m.
fn relaxed(problem: &Problem, by: f64) -> Problem {
    let mut problem = problem.clone();
    problem.keepouts.iter_mut().for_each(|k| k.distance -= by);
    let known = |i: usize, problem: &Problem| (0..2).all(|k| problem.bounds[3 * i + k].low.is_finite());
    let fixed: Vec<usize> = (0..problem.vertices.len()).filter(|&i| known(i, &problem)).skip(1).collect();
    for row in &mut problem.rows {
        let by = match &row.function {
            Function::Turn(_) | Function::Section(_) | Function::Straight(_) => continue,
            Function::Linear(terms) => by * terms.iter().map(|(_, factor)| factor.abs()).sum::<f64>(),
            Function::StraightMiddle { .. } | Function::StraightEnd { .. } => by,
            // Of what changes by who knows how much the bound says nothing: it counts in layouts.
            Function::Formula(formula) => change(formula, by),
        };
        (row.low, row.high) = (row.low - by, row.high + by);
    }
    for k in fixed.iter().flat_map(|i| [3 * i, 3 * i + 1]) {
        let at = problem.bounds[k].low;
        problem.bounds[k] = Bounds { low: f64::NEG_INFINITY, high: f64::INFINITY };
        let (label, span) = ("fix".to_owned(), problem.vertex_span(k / 3));
        let function = Function::Linear(vec![(k, 1.0)]);
        let (low, high) = (at - by, at + by);
        problem.rows.push(ConstraintRow::hard(function, (low, high), label, span));
    }
    problem
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::Random;
    use crate::geometry::{Point, Polygon};
    use crate::model::fixture::{rectangle, span};
    use crate::model::{Obstacle, Side, Target};
    use crate::problem::{Scope, measures};

    /// Formulas of every kind, with what is known of their change for a displacement of 1 m.
    fn formulas() -> Vec<(Formula, f64)> {
        use Formula::*;
        let section = |from| Length(Target { from, straight: false });
        let straight = |from| Length(Target { from, straight: true });
        let minus = |f: Formula| Negative(Box::new(f));
        let times = |k: f64, f: Formula| Product(vec![Constant(k), f]);
        vec![
            (section(0), 0.0),
            (Sum(vec![straight(1), minus(times(2.0, Radius(3)))]), 0.0),
            (DistanceVertices(0, 2), 0.0),
            (Angle(2), 0.0),
            (Product(vec![section(0), straight(1)]), 0.0),
            (Reciprocal(Box::new(section(2))), 0.0),
            (X(1), 1.0),
            (Sum(vec![X(1), minus(X(0)), times(0.5, Y(2))]), 2.5),
            (Absolute(Box::new(times(-3.0, Y(3)))), 3.0),
            (Smallest(vec![X(0), times(2.0, Y(1)), section(0)]), 2.0),
            (Largest(vec![minus(X(0)), Y(1)]), 1.0),
            (DistanceObstacle(2, 0), 1.0),
            (times(0.0, Heading(0)), 0.0),
            (Product(vec![X(0), Y(0)]), f64::INFINITY),
            (Product(vec![X(0), section(1)]), f64::INFINITY),
            (SquareRoot(Box::new(X(2))), f64::INFINITY),
            (Heading(1), f64::INFINITY),
        ]
    }

    #[test]
    fn no_formula_changes_by_more_than_is_known_when_a_layout_is_turned() {
        let mut layout = rectangle(30.0, 20.0, 4.0);
        let corners = [(10.0, 25.0), (14.0, 25.0), (14.0, 28.0), (10.0, 28.0)];
        let polygon = Polygon::new(corners.map(|(x, y)| Point { x, y }).to_vec()).unwrap();
        layout.obstacles.push(Obstacle {
            name: "rack".into(),
            polygon,
            clearance: 0.0,
            side: Side::Right,
            pass: None,
            span: span(),
        });
        let mut problem = Problem::new(&layout, Scope::Obstacles);
        let row = |(function, _): (Formula, f64)| ConstraintRow {
            function: Function::Formula(function),
            low: 0.0,
            high: 0.0,
            unit: crate::model::Unit::Metre,
            weight: None,
            label: String::new(),
            span: span(),
            reason: None,
        };
        problem.rows = formulas().into_iter().map(row).collect();
        let values = |x: &[f64]| -> Vec<f64> {
            problem.evaluate(x, 0.0).rows[..problem.rows.len()].iter().map(|r| r.expansion.value).collect()
        };
        let before = values(&problem.start);
        let mut random = Random::new(7);
        let mut most = vec![0.0f64; before.len()];
        for _ in 0..200 {
            let mut between = |low: f64, high: f64| low + (high - low) * random.uniform();
            let middle = Point { x: between(-10.0, 40.0), y: between(-10.0, 40.0) };
            let along = Point::unit(between(-0.02, 0.02));
            let turned = |p: Point| middle + along * (p - middle).x + along.left() * (p - middle).y;
            let mut corners = measures::to_corners(&problem.start);
            let far = corners.iter().map(|c| (turned(c.point) - c.point).norm()).fold(0.0, f64::max);
            corners.iter_mut().for_each(|c| c.point = turned(c.point));
            let after = values(&measures::to_variables(&corners));
            for (k, (formula, at_most)) in formulas().iter().enumerate() {
                let moved = (after[k] - before[k]).abs();
                assert!(moved <= change(formula, far) + 1e-9, "{formula:?} {moved} {far}");
                assert_eq!(change(formula, 1.0), *at_most, "{formula:?}");
                most[k] = most[k].max(moved / far);
            }
        }
        // What is said to change does.
        for ((formula, known), moved) in formulas().iter().zip(most) {
            assert_eq!(*known > 0.0, moved > 1e-6, "{formula:?} {moved}");
        }
    }
}
