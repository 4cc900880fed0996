//! What a problem knows of its sections, for the bound of a layout's class ([`crate::solve::homotopy`]).

use super::grid::{Grid, track};
use super::row;
use crate::geometry::Point;
use crate::model::{Formula, Layout};
use crate::problem::measures::{x, y};
use crate::problem::{Function, Problem};
use crate::solve::homotopy::{End, Held, Place, Range, Turn};

/// A straight that is shorter than this has no place among the others, m.
const SHORTEST: f64 = 0.01;
/// How far rounding may put limits that are alike apart, m.
const SLACK: f64 = 1e-9;
/// Directions that are alike, of unit vectors.
const ALIKE: f64 = 1e-9;

/// Sections of known heading, in driving order, none beside another: at known vertices, or where the building and the
/// rows of a single coordinate leave them.
pub fn known(layout: &Layout, problem: &Problem, at: &[f64]) -> Vec<Held> {
    let Some(grid) = Grid::new(layout, problem, at, 0.0).ok().filter(|grid| grid.held && layout.is_flat()) else {
        return Vec::new();
    };
    let n = grid.len();
    let stated = row::state(problem, &grid);
    let least: Vec<f64> = row::straights(&stated.rows, &stated.straights).iter().map(|limits| limits.0).collect();
    let track = track(at);
    let fixed = |k: usize| problem.bounds[k].low == problem.bounds[k].high;
    let is_known = |v: usize| fixed(x(v)) && fixed(y(v));
    let beside = |i: usize, other: usize| (other + 1) % n == i || (i + 1) % n == other;
    let is_fixed = |i: usize| is_known(i) && is_known((i + 1) % n);
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by_key(|&i| !is_fixed(i));
    let mut found: Vec<usize> = Vec::new();
    for i in order {
        let has_heading = grid.headings[grid.stage(i)].len() == 1;
        if has_heading && track.straight(i).length >= SHORTEST && !found.iter().any(|&other| beside(i, other)) {
            found.push(i);
        }
    }
    found.sort_unstable();
    let section = |&i: &usize| {
        let next = (i + 1) % n;
        let heading = grid.angle(grid.headings[grid.stage(i)][0]);
        let end = |v: usize, beyond: usize| {
            let k = grid.stage(v);
            // A straight between two of them is counted by neither.
            let shared = found.iter().any(|&other| other != i && beside(beyond, other));
            let straight = if shared { 0.0 } else { least[grid.stage(beyond)] };
            let (fewest, most) = grid.turns[k];
            let steps = || (fewest..=most).map(|steps| grid.turn(steps).0);
            let turns = grid.radii[k].iter().flat_map(|&r| steps().map(move |angle| Turn::new(r, angle, straight)));
            End { vertex: track.corners[v].point, sign: f64::from(grid.signs[k]), turns: turns.collect() }
        };
        let place = match is_fixed(i) {
            true => Place::Known([end(i, (i + n - 1) % n), end(next, next)]),
            false => Place::Within(range(problem, [i, next], heading, least[grid.stage(i)])?),
        };
        Some(Held { section: i, heading, place })
    };
    found.iter().filter_map(section).collect()
}

/// Where a section of known heading can be: within the walls, and where rows of one coordinate of its vertices say.
fn range(problem: &Problem, vertices: [usize; 2], heading: f64, shortest: f64) -> Option<Range> {
    let (h, n) = (Point::unit(heading), Point::unit(heading).left());
    let walls = problem.keepouts.iter().find(|keepout| keepout.region.outside)?;
    let (low, high) = walls.region.polygon.bounds();
    let (low, high) = (low + Point::new(1.0, 1.0) * walls.distance, high - Point::new(1.0, 1.0) * walls.distance);
    let corners = [low, high, Point::new(low.x, high.y), Point::new(high.x, low.y)];
    let within = |direction: Point| {
        let values = corners.map(|corner| direction.dot(corner));
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)))
    };
    let (mut ends, mut across) = ([within(h); 2], within(n));
    // What lies between two values along an axis, if that is the range's own.
    let narrow = |range: &mut (f64, f64), own: Point, axis: Point, (low, high): (f64, f64)| {
        let scale = own.dot(axis);
        if (scale.abs() - axis.norm()).abs() < ALIKE * axis.norm() && axis.norm() > 0.0 {
            let (a, b) = (low / scale, high / scale);
            *range = (range.0.max(a.min(b)), range.1.min(a.max(b)));
        }
    };
    let axes = [Point::new(1.0, 0.0), Point::new(0.0, 1.0)];
    for v in vertices {
        for (axis, k) in axes.into_iter().zip([x(v), y(v)]) {
            narrow(&mut across, n, axis, (problem.bounds[k].low, problem.bounds[k].high));
        }
    }
    for row in problem.rows.iter().filter(|row| row.weight.is_none()) {
        let limits = (row.low, row.high);
        match &row.function {
            Function::Formula(Formula::X(v)) if vertices.contains(v) => narrow(&mut across, n, axes[0], limits),
            Function::Formula(Formula::Y(v)) if vertices.contains(v) => narrow(&mut across, n, axes[1], limits),
            Function::Linear(terms) => {
                let coefficient = |k: usize| terms.iter().filter(|t| t.0 == k).map(|t| t.1).sum::<f64>();
                for v in vertices {
                    let alone = terms.iter().all(|&(k, factor)| factor == 0.0 || k == x(v) || k == y(v));
                    if alone {
                        narrow(&mut across, n, Point::new(coefficient(x(v)), coefficient(y(v))), limits);
                    }
                }
            }
            Function::StraightEnd { section, end, direction } if *section == vertices[0] => {
                narrow(&mut ends[usize::from(*end)], h, *direction, limits);
                narrow(&mut across, n, *direction, limits);
            }
            _ => {}
        }
    }
    let range = Range { begin: ends[0], end: ends[1], across, shortest };
    let fits = across.0 <= across.1 + SLACK && range.corners().next().is_some();
    fits.then_some(range)
}
