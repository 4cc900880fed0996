//! Layouts whose rotation nothing fixes: the offset of the grid is a variable between 0 and a step, which is branched
//! on.
//!
//! A layout whose offset is within δ of the middle of an interval becomes one at the middle when it is turned about a
//! known vertex. No point of a loop of length L through that vertex is farther from it than L/2, so that none moves by
//! more than δ L/2. Where no vertex is known, it is turned about the centre of a disk of radius L/4, in which every loop of
//! length L lies (Nitsche 1971): no point moves by more than δ L/4. With rows and regions relaxed by as much, the search
//! at the middle bounds the whole interval.

use super::search::Found;
use crate::base::trig;
use crate::model::Interval as Bounds;
use crate::problem::{ConstraintRow, Function, Problem};
use crate::solve::{Effort, Stop};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// What is searched at an offset: a problem, the offset (rad), the value that must be beaten, and how hard.
pub type At<'a> = dyn Fn(&Problem, f64, f64, Effort) -> Option<Found> + 'a;

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
        Function::StraightMiddle { .. } | Function::StraightEnd { .. } | Function::Formula(_) => true,
    }
}

/// From variables to variables and their value.
type Improve<'a> = dyn Fn(&[f64]) -> Option<(Vec<f64>, f64)> + 'a;

/// Bounds every offset, and improves the incumbent (variables and value) on the way. `improve` makes a layout of the
/// relaxed problem one of the problem, if it can; a metre of track is worth at least `metre`. `part_of` is told what is left
/// open before each search of an interval.
pub fn search(
    problem: &Problem,
    step: f64,
    (incumbent, metre): ((Vec<f64>, f64), f64),
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
        let by = (interval.high - interval.low) / 2.0 * reach * best.1 / metre;
        let most = interval.nodes.min(effort.nodes - nodes);
        let found = at(&relaxed(problem, by), middle, best.1, Effort { nodes: most, ..effort });
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
        let relaxation = trig::TAU * by * metre;
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
            // How a formula changes is not known: it counts in layouts, not in the bound.
            Function::Formula(_) => f64::INFINITY,
        };
        (row.low, row.high) = (row.low - by, row.high + by);
    }
    for k in fixed.iter().flat_map(|i| [3 * i, 3 * i + 1]) {
        let at = problem.bounds[k].low;
        problem.bounds[k] = Bounds { low: f64::NEG_INFINITY, high: f64::INFINITY };
        let (label, span) = ("fix".to_owned(), problem.vertex_span(k / 3));
        let function = Function::Linear(vec![(k, 1.0)]);
        let (low, high) = (at - by, at + by);
        problem.rows.push(ConstraintRow { function, low, high, angle: false, weight: None, label, span, reason: None });
    }
    problem
}
