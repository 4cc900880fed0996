//! The choices of the discrete stage: headings, turns and radii of the catalogue (thesis §3.3, stage 3).

use super::super::Problem;
use super::super::measures::to_corners;
use crate::base::trig;
use crate::geometry::Track;
use crate::model::Layout;

/// A heading this far from the grid is not on it, rad.
const OFF_GRID: f64 = 1e-7;
/// Rounding of limits, in steps.
const SLACK: f64 = 1e-9;

/// Which headings, turns and radii there are to choose from.
#[derive(Clone, Debug)]
pub struct Grid {
    /// rad
    pub step: f64,
    /// The section that headings are counted from.
    pub anchor: usize,
    /// Its written heading, rad.
    pub origin: f64,
    /// Whether the layout fixes that heading; if not, it is assumed.
    pub fixed: bool,
    /// First and last heading of each section, in steps from the origin, unwound along the loop from the anchor on:
    /// within half a turn of the written one, and within reach of turns.
    pub headings: Vec<(i64, i64)>,
    /// First and last turn in its written direction, in steps.
    pub turns: (i64, i64),
    /// Radii to choose from at each vertex, m.
    pub radii: Vec<Vec<f64>>,
    /// Steps that the whole loop turns by.
    pub winding: i64,
    /// Sections with a fixed heading that is not on the grid.
    pub off: Vec<usize>,
}

impl Grid {
    pub fn new(layout: &Layout, problem: &Problem) -> Self {
        let n = problem.signs.len();
        let step = layout.catalog.curve.angle_step;
        let track = Track::new(&to_corners(&problem.start));
        let held: Vec<usize> = (0..n).filter(|&i| problem.holds_heading(i)).collect();
        let anchor = held.first().copied().unwrap_or(0);
        let mut written = vec![0.0; n];
        let mut heading = 0.0;
        for i in (1..n).map(|k| (anchor + k) % n) {
            heading += track.fillets[i].turn / step;
            written[i] = heading;
        }
        let total: f64 = track.fillets.iter().map(|f| f.turn).sum();
        let limits = layout.turns.value;
        let half = (trig::PI / step).round() as i64;
        let near = |steps: &f64| (steps.round() as i64 - half, steps.round() as i64 + half);
        let mut grid = Grid {
            step,
            anchor,
            origin: track.straight(anchor).heading,
            fixed: !held.is_empty(),
            headings: written.iter().map(near).collect(),
            turns: ((limits.low / step - SLACK).ceil() as i64, (limits.high / step + SLACK).floor() as i64),
            radii: (0..n).map(|i| problem.radii(layout, i)).collect(),
            winding: ((total / trig::TAU).round() * (trig::TAU / step).round()) as i64,
            off: held.iter().copied().filter(|&i| (written[i] - written[i].round()).abs() * step > OFF_GRID).collect(),
        };
        for i in held.into_iter().chain([anchor]) {
            grid.headings[i] = (written[i].round() as i64, written[i].round() as i64);
        }
        grid.narrow(&problem.signs);
        grid
    }

    /// A heading in (-π, π], rad.
    pub fn heading(&self, steps: i64) -> f64 {
        trig::wrap(self.origin + steps as f64 * self.step)
    }

    /// What is added to the heading of section `i` where the loop comes to it from the section before.
    pub fn unwound(&self, i: usize) -> i64 {
        if i == self.anchor { self.winding } else { 0 }
    }

    /// First and last signed turn at a vertex.
    fn change(&self, sign: f64) -> (i64, i64) {
        let (low, high) = self.turns;
        if sign < 0.0 { (-high, -low) } else { (low, high) }
    }

    /// Leaves only headings that turns within their limits lead to, from both sides.
    fn narrow(&mut self, signs: &[f64]) {
        let n = signs.len();
        let both = |a: (i64, i64), b: (i64, i64)| (a.0.max(b.0), a.1.min(b.1));
        for _ in 0..2 {
            for i in (1..n).map(|k| (self.anchor + k) % n) {
                let (from, by) = (self.headings[(i + n - 1) % n], self.change(signs[i]));
                self.headings[i] = both(self.headings[i], (from.0 + by.0, from.1 + by.1));
            }
            for i in (1..n).rev().map(|k| (self.anchor + k) % n) {
                let next = (i + 1) % n;
                let (to, by, turned) = (self.headings[next], self.change(signs[next]), self.unwound(next));
                self.headings[i] = both(self.headings[i], (to.0 + turned - by.1, to.1 + turned - by.0));
            }
        }
    }
}
