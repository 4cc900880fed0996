//! What lies within a loop bounds how short it can be: a convex curve's length is the integral of its support function
//! over the directions (Cauchy 1841), and a loop is no shorter than the convex hull of what it goes around.
//!
//! That holds of a loop that does not cross itself, so not of chains that are searched apart, each beside the others as
//! they were found.

use super::alternative::Alternative;
use super::grid::Grid;
use super::open::Open;
use super::row::{GridRow, Touch};
use crate::geometry::Point;
use crate::problem::{Keepout, Problem};

/// Directions in which a loop is asked for its farthest point.
const DIRECTIONS: usize = 48;

/// A loop that goes around what it has on its inner side.
#[derive(Clone, Copy)]
pub struct Enclosing<'a> {
    pub problem: &'a Problem,
    pub grid: &'a Grid,
}

impl Enclosing<'_> {
    /// That a corner lies a distance D inside the loop's tangent of this heading, where only one place can have it.
    pub fn inside(&self, keepout: &Keepout, corner: usize, heading: f64, open: &Open) -> Option<Alternative> {
        let side = f64::from(self.encloses(keepout, open)?);
        let q = keepout.region.polygon.points()[corner];
        let mut found = self.tangents(side, (q, keepout.distance), heading, open);
        if found.len() == 1 { found.pop() } else { None }
    }

    /// The sign of the loop's turns, if it goes around once and a region lies within it.
    fn encloses(&self, keepout: &Keepout, open: &Open) -> Option<i32> {
        let winding = open.headings[self.grid.len()][0] - open.headings[0][0];
        let sign = winding.signum();
        // A loop that passes over itself may have anything on either side.
        if !self.problem.heights.is_flat() {
            return None;
        }
        let within = !keepout.region.outside && keepout.region.lies == f64::from(sign);
        (within && winding.abs() == self.grid.circle).then_some(sign)
    }

    /// What lies within the loop lies inside its tangent of every heading. The loop's farthest point in the direction of
    /// the normal has this heading, on an arc that turns as the loop does or on the section of known heading: one
    /// alternative for each run of arcs that can have it. Of all directions on offer the one that values miss most.
    pub fn enclose(&self, open: &Open, value: &dyn Fn(&GridRow) -> f64, least: f64) -> Option<Vec<Alternative>> {
        let mut worst: Option<(f64, Vec<Alternative>)> = None;
        let within: Vec<(&Keepout, i32)> =
            self.problem.keepouts.iter().filter_map(|k| Some((k, self.encloses(k, open)?))).collect();
        let side = f64::from(within.first()?.1);
        for k in 0..DIRECTIONS {
            let heading = f64::from(self.grid.circle) * k as f64 / DIRECTIONS as f64;
            let g = Point::unit(self.grid.origin + heading * self.grid.step).left() * -side;
            let points = within.iter().flat_map(|(k, _)| k.region.polygon.points().iter().map(|q| (*q, k.distance)));
            let farthest = points.max_by(|a, b| (a.1 + g.dot(a.0)).total_cmp(&(b.1 + g.dot(b.0))))?;
            let alternatives = self.tangents(side, farthest, heading, open);
            let miss = |a: &Alternative| a.rows.iter().map(|row| row.low - value(row)).fold(0.0, f64::max);
            let missed = alternatives.iter().map(miss).fold(f64::INFINITY, f64::min);
            // Few places tell more than many.
            let weight = missed / (alternatives.len() * alternatives.len()).max(1) as f64;
            if missed.is_finite() && missed > least && worst.as_ref().is_none_or(|w| weight > w.0) {
                worst = Some((weight, alternatives));
            }
        }
        worst.map(|w| w.1)
    }

    /// That a point lies a distance inside the loop's tangent of a heading, wherever the loop may have that.
    fn tangents(&self, side: f64, (q, distance): (Point, f64), heading: f64, open: &Open) -> Vec<Alternative> {
        let (grid, n) = (self.grid, self.grid.len());
        let circle = f64::from(grid.circle);
        let u = Point::unit(grid.origin + heading * grid.step);
        let g = u.left() * -side;
        let low = distance + g.dot(q);
        let mut out = Vec::new();
        let ends = [open.headings[0][0], open.headings[n][0]].map(f64::from);
        let is_known = (((heading - ends[0]) / circle).round() * circle + ends[0] - heading).abs() < 1e-9;
        if is_known {
            out.push(Alternative::row(GridRow { at: vec![(0, g)], low, ..GridRow::default() }));
        }
        // Runs of arcs, each with the heading as it counts there.
        let mut runs: Vec<(usize, usize, f64)> = Vec::new();
        for k in (1..=n).filter(|k| f64::from(grid.signs[k % n]) == side) {
            let (before, after) = (&open.headings[k - 1], &open.headings[k]);
            let least = before[0].min(after[0]);
            let most = before[before.len() - 1].max(after[after.len() - 1]);
            let mut copy = heading + ((f64::from(least) - heading) / circle).ceil() * circle;
            while copy <= f64::from(most) {
                // The arcs at the ends of the section of known heading have it where they meet that.
                let meets = (k == 1 && (copy - ends[0]).abs() < 1e-9) || (k == n && (copy - ends[1]).abs() < 1e-9);
                if !meets {
                    match runs.iter_mut().find(|(_, to, own)| to + 1 == k && (*own - copy).abs() < 1e-9) {
                        Some((_, to, _)) => *to = k,
                        None => runs.push((k, k, copy)),
                    }
                }
                copy += circle;
            }
        }
        out.extend(runs.into_iter().map(|(from, to, heading)| {
            let touch = vec![Touch { from, to, heading, normal: u.left(), pull: g }];
            let row = GridRow { at: vec![(from % n, g)], touch, low, ..GridRow::default() };
            let up_to = (f64::NEG_INFINITY, heading + 1e-9);
            let from_on = (heading - 1e-9, f64::INFINITY);
            let (before, after) = if side > 0.0 { (up_to, from_on) } else { (from_on, up_to) };
            let headings = vec![(from - 1, before.0, before.1), (to, after.0, after.1)];
            Alternative { headings, ..Alternative::row(row) }
        }));
        out
    }
}
