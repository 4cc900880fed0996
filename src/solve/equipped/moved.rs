//! A track of the same shape elsewhere: where conveyors are cheaper, or where walls and obstacles leave room for equipment.

use super::Search;
use crate::geometry::{Corner, Point, Track};
use crate::placement::{self, Placement};
use crate::problem::measures::to_variables;
use crate::problem::{Problem, Scope};

/// How far a track is shifted at first, and at last, towards what feeds its equipment, m.
const SHIFTS: (f64, f64) = (4.0, 0.01);
/// Where walls or obstacles leave no room, a track is moved to so many places along x and along y, and this many times in all.
const MOVES: (usize, usize) = (9, 400);

impl Search<'_> {
    /// A track of the same shape where conveyors are cheaper, if one is found that meets every row: pattern search (Hooke
    /// and Jeeves 1961) over where it lies.
    pub(super) fn shifted(&self, corners: &[Corner], placement: &Placement) -> Option<(Vec<Corner>, Placement)> {
        if placement.conveyors <= 0.0 {
            return None;
        }
        let problem = Problem::new(self.layout, Scope::Obstacles);
        let axes = [Point::new(1.0, 0.0), Point::new(0.0, 1.0)].into_iter().zip(held(&problem, corners.len()));
        let ways: Vec<Point> = axes.filter(|(_, held)| !held).flat_map(|(way, _)| [way, -way]).collect();
        let sound = |corners: &[Corner]| meets_all(&problem, corners);
        let mut best: Option<(Vec<Corner>, Placement)> = None;
        let mut step = SHIFTS.0;
        while step >= SHIFTS.1 && !ways.is_empty() && !self.options.stop.now() {
            let (here, price) = match &best {
                Some((corners, placement)) => (corners.clone(), placement.conveyors),
                None => (corners.to_vec(), placement.conveyors),
            };
            let moved = |way: &Point| -> Option<(Vec<Corner>, Placement)> {
                let corners = shift(&here, *way * step);
                if !sound(&corners) {
                    return None;
                }
                let placement = placement::place(self.layout, &Track::new(&corners));
                (placement.is_whole() && placement.conveyors < price - 1e-6).then_some((corners, placement))
            };
            let found = ways.iter().filter_map(moved).min_by(|a, b| a.1.conveyors.total_cmp(&b.1.conveyors));
            match found {
                Some(found) => best = Some(found),
                None => step *= 0.5,
            }
        }
        best
    }

    /// A track of the same shape where everything finds room, if one is found that meets every row: the nearest of places
    /// all over the building. A track that only has to be short or cheap may end against a wall of an empty hall.
    pub(super) fn moved(&mut self, corners: &[Corner]) -> Option<(Vec<Corner>, Placement)> {
        let building = self.layout.building.as_ref()?;
        // Whether there is room does not depend on conveyors, and is found sooner without.
        let mut unfed = self.layout.clone();
        unfed.equipment.declared.iter_mut().for_each(|d| d.fed = None);
        let problem = Problem::new(self.layout, Scope::Obstacles);
        let held = held(&problem, corners.len());
        let along = |k: usize, of: fn(Point) -> f64| -> Vec<f64> {
            let extent = |values: &mut dyn Iterator<Item = f64>| {
                values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
            };
            let walls = extent(&mut building.polygon.points().iter().map(|p| of(*p)));
            let track = extent(&mut corners.iter().map(|c| of(c.point)));
            let (low, high) = (walls.0 - track.0, walls.1 - track.1);
            match held[k] || high <= low {
                true => vec![0.0],
                false => (0..MOVES.0).map(|i| low + (high - low) * (i as f64 + 0.5) / MOVES.0 as f64).collect(),
            }
        };
        let (x, y) = (along(0, |p| p.x), along(1, |p| p.y));
        let mut by: Vec<Point> = x.iter().flat_map(|x| y.iter().map(|y| Point::new(*x, *y))).collect();
        by.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
        for by in by {
            if self.moves >= MOVES.1 || self.options.stop.now() {
                return None;
            }
            let corners = shift(corners, by);
            if !meets_all(&problem, &corners) {
                continue;
            }
            self.moves += 1;
            let track = Track::new(&corners);
            if placement::place(&unfed, &track).is_whole() {
                let placement = placement::place(self.layout, &track);
                return placement.is_whole().then_some((corners, placement));
            }
        }
        None
    }
}

/// Whether a vertex' x, and whether one's y, is held.
fn held(problem: &Problem, vertices: usize) -> [bool; 2] {
    [0, 1].map(|k| (0..vertices).any(|i| problem.bounds[3 * i + k].low == problem.bounds[3 * i + k].high))
}

fn shift(corners: &[Corner], by: Point) -> Vec<Corner> {
    corners.iter().map(|c| Corner { point: c.point + by, ..*c }).collect()
}

/// Whether a track meets every row, and does not cross itself.
pub fn meets_all(problem: &Problem, corners: &[Corner]) -> bool {
    let at = problem.evaluate(&to_variables(corners), 0.0);
    at.rows.iter().all(|r| r.violation() <= 1e-6) && problem.crossings(&at.track).is_empty()
}
