//! The discrete choices: headings as multiples of the angle step, radii from the catalogue's list.

use crate::base::trig;
use crate::geometry::{Point, Track};
use crate::model::{Formula, HEADING_TOLERANCE, Layout, TOLERANCE};
use crate::problem::measures::{to_corners, x, y};
use crate::problem::{ConstraintRow, Function, Problem};

/// Slack on angles and lengths that come from text, rad or m.
const SLACK: f64 = 1e-9;

/// A loop opened at a section of known heading. *Stage* k is the k-th section after it, and the vertex where that
/// section begins; stage n is the opened section again, one winding later.
#[derive(Clone, Debug)]
pub struct Grid {
    /// rad
    pub step: f64,
    /// Steps in a full turn.
    pub circle: i32,
    /// Heading of index 0, rad.
    pub origin: f64,
    /// Section at stage 0.
    pub first: usize,
    /// Turn directions by vertex stage.
    pub signs: Vec<i32>,
    /// Steps that a vertex may turn in its direction, by vertex stage.
    pub turns: Vec<(i32, i32)>,
    /// Radii that a vertex may have, m, ascending, by vertex stage.
    pub radii: Vec<Vec<f64>>,
    /// Headings that a section may have, as unwrapped multiples of the step, ascending, by stage 0..=n.
    pub headings: Vec<Vec<i32>>,
    /// Whether any section's heading is fixed; if not, the whole grid may turn.
    pub held: bool,
    units: Vec<Point>,
    tangents: Vec<f64>,
}

/// Why there is nothing to choose from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoGrid {
    /// The step does not divide a full turn.
    Step,
    /// The headings of these two sections are fixed, and no number of steps lies between them; `off` is what lacks,
    /// rad.
    Apart { first: usize, other: usize, off: f64 },
    /// No turn or no radius is within the limits, or no choice of turns closes the loop.
    Empty,
}

impl Grid {
    /// States the choices of a problem. A grid that nothing holds is `offset` (rad) off the first section of the layout
    /// `at`.
    pub fn new(layout: &Layout, problem: &Problem, at: &[f64], offset: f64) -> Result<Self, NoGrid> {
        let n = problem.signs.len();
        let step = layout.catalog.curve.angle_step;
        let circle = (trig::TAU / step).round();
        if (circle * step - trig::TAU).abs() > SLACK {
            return Err(NoGrid::Step);
        }
        let circle = circle as i32;
        let written = Track::new(&to_corners(&problem.start));
        let fixed: Vec<usize> = (0..n).filter(|&i| heading_fixed(problem, i)).collect();
        // Best opened where a vertex is known, too.
        let known = |i: &&usize| problem.bounds[x(**i)].low == problem.bounds[x(**i)].high;
        let first = fixed.iter().find(known).or(fixed.first()).copied().unwrap_or(0);
        let track = if fixed.is_empty() { Track::new(&to_corners(at)) } else { written.clone() };
        let origin = track.straight(first).heading + if fixed.is_empty() { offset } else { 0.0 };
        let stage = |k: usize| (first + k) % n;
        let signs: Vec<i32> = (0..n).map(|k| problem.signs[stage(k)] as i32).collect();
        let turns: Vec<(i32, i32)> = (0..n).map(|k| turn_limits(problem, stage(k), step)).collect();
        let radii: Vec<Vec<f64>> = (0..n).map(|k| problem.radii(layout, stage(k))).collect();
        if turns.iter().any(|t| t.0 > t.1) || radii.iter().any(Vec::is_empty) {
            return Err(NoGrid::Empty);
        }
        let turned: f64 = written.fillets.iter().map(|f| f.turn).sum();
        let winding = (turned / trig::TAU).round() as i32 * circle;
        let mut held: Vec<Option<i32>> = vec![None; n];
        for &i in &fixed {
            let steps = trig::wrap(written.straight(i).heading - origin) / step;
            let off = (steps - steps.round()).abs() * step;
            if off > HEADING_TOLERANCE {
                return Err(NoGrid::Apart { first, other: i, off });
            }
            held[(i + n - first) % n] = Some(steps.round() as i32);
        }
        let mut headings: Vec<Vec<i32>> = vec![vec![0]];
        for k in 1..=n {
            let (low, high, sign) = (turns[k % n].0, turns[k % n].1, signs[k % n]);
            let before = &headings[k - 1];
            let (least, most) = (before[0], before[before.len() - 1]);
            let ends = [least + sign * low, least + sign * high, most + sign * low, most + sign * high];
            let (least, most) = (ends.iter().min().copied(), ends.iter().max().copied());
            let range = least.unwrap_or(0)..=most.unwrap_or(0);
            let want = |h: &i32| match (k == n, held[k % n]) {
                (true, _) => *h == winding,
                (false, Some(value)) => (h - value).rem_euclid(circle) == 0,
                (false, None) => true,
            };
            let asked = |h: &i32| headings_asked(problem, stage(k), origin + f64::from(*h) * step);
            let reached = |h: &i32| before.iter().any(|b| (low..=high).contains(&((h - b) * sign)));
            headings.push(range.filter(want).filter(asked).filter(reached).collect());
            if headings[k].is_empty() {
                return Err(NoGrid::Empty);
            }
        }
        let units = (0..circle).map(|h| Point::unit(origin + f64::from(h) * step)).collect();
        let tangents = (0..=circle / 2).map(|m| trig::tan(f64::from(m) * step / 2.0)).collect();
        let held = !fixed.is_empty();
        Ok(Grid { step, circle, origin, first, signs, turns, radii, headings, held, units, tangents })
    }

    pub fn len(&self) -> usize {
        self.signs.len()
    }

    /// Stage of a vertex, or of the section that begins there.
    pub fn stage(&self, vertex: usize) -> usize {
        (vertex + self.len() - self.first) % self.len()
    }

    /// Vertex of a stage.
    pub fn vertex(&self, stage: usize) -> usize {
        (stage + self.first) % self.len()
    }

    /// Unit vector along a heading.
    pub fn unit(&self, heading: i32) -> Point {
        self.units[heading.rem_euclid(self.circle) as usize]
    }

    /// rad
    pub fn angle(&self, heading: i32) -> f64 {
        self.origin + f64::from(heading) * self.step
    }

    /// Angle (rad) and tan(angle/2) of a turn of so many steps.
    pub fn turn(&self, steps: i32) -> (f64, f64) {
        let steps = steps.abs();
        (f64::from(steps) * self.step, self.tangents[steps as usize])
    }
}

/// Whether a section's heading is what was written: by a `fix`, or since both ends are fixed.
fn heading_fixed(problem: &Problem, i: usize) -> bool {
    let j = (i + 1) % problem.signs.len();
    let fixed = |k: usize| problem.bounds[k].low == problem.bounds[k].high;
    problem.rotations.contains(&i) || [x(i), y(i), x(j), y(j)].into_iter().all(fixed)
}

fn turn_limits(problem: &Problem, vertex: usize, step: f64) -> (i32, i32) {
    let mut limits = (1, (trig::PI / step).ceil() as i32 - 1);
    let mut narrow = |low: f64, high: f64| {
        limits.0 = limits.0.max(((low - SLACK) / step).ceil() as i32);
        limits.1 = limits.1.min(((high + SLACK) / step).floor() as i32);
    };
    for row in &problem.rows {
        if matches!(row.function, Function::Turn(i) if i == vertex) {
            narrow(row.low, row.high);
        }
        if matches!(row.function, Function::Formula(Formula::Angle(i)) if i == vertex) {
            let right = problem.signs[vertex] < 0.0;
            narrow(if right { -row.high } else { row.low }, if right { -row.low } else { row.high });
        }
    }
    limits
}

/// Whether `require heading` allows a section's heading, rad.
fn headings_asked(problem: &Problem, section: usize, heading: f64) -> bool {
    let asked = |row: &&ConstraintRow| matches!(row.function, Function::Formula(Formula::Heading(i)) if i == section);
    problem.rows.iter().filter(asked).all(|row| {
        let aim = if row.low.is_finite() && row.high.is_finite() { (row.low + row.high) / 2.0 } else { 0.0 };
        let heading = aim + trig::wrap(heading - aim);
        row.low - TOLERANCE <= heading && heading <= row.high + TOLERANCE
    })
}

/// The centre line at some variables.
pub fn track(x: &[f64]) -> Track {
    Track::new(&crate::problem::measures::to_corners(x))
}
