//! Layouts of many vertices are rounded some choices at a time (diving, Bonami and Gonçalves 2012): the headings of the
//! longest straights are held on the grid, the rest adapts, and so on; then radii. With headings held by rows that are
//! linear in coordinates, each solve begins near its end. Where choices leave no layout, those whose rows are not met take
//! their multiple on the other side, and then fewer are made at once.

use super::Grid;
use crate::base::trig;
use crate::geometry::{Point, Track};
use crate::model::Interval;
use crate::problem::measures::{radius, to_corners};
use crate::problem::{ConstraintRow, Function, Problem};
use crate::solve::sqp::{self, Solution, SqpSettings};

/// Of what is open, one part in so many is held at once.
const AT_ONCE: usize = 3;
/// Steps of a solve: what takes longer hardly ends well.
const STEPS: usize = 100;
/// Headings that are not met take their other multiple so often.
const TURNS: usize = 4;
/// Solves with one room, at most.
const SOLVES: usize = 25;

/// What a section that is off its heading counts, m a m.
const MISSED: f64 = 100.0;

/// What is asked for beyond the limits, m: a layout that touches everything leaves none on the grid beside it.
const ROOM: f64 = 0.2;

/// A section's heading on the grid, and the multiple on the other side of what it was.
#[derive(Clone, Copy, Debug)]
struct Held {
    section: usize,
    heading: i64,
    other: i64,
}

/// The problem with what is held so far, and a layout that meets it.
struct Dive<'a> {
    grid: &'a Grid<'a>,
    problem: Problem,
    at: Solution,
    /// Heading that multiples of the step are counted from, rad.
    origin: f64,
    headings: Vec<Option<i64>>,
    solves: usize,
    iterations: usize,
}

/// A layout on the grid near a start, if one is found: from there, or from one with more room around it.
pub fn dive(grid: &Grid, start: &Solution) -> Option<Solution> {
    if let Some(found) = from(grid, grid.problem.clone(), start) {
        return Some(found);
    }
    if grid.settings.stop.now() {
        return None;
    }
    let problem = with_room(grid);
    let roomy = sqp::minimise(&problem, &start.variables, &grid.settings, &|_, _, _| {});
    let fits = roomy.max_violation <= grid.settings.feasibility;
    fits.then(|| from(grid, problem, &roomy)).flatten()
}

/// The problem with more room: distances, straights, and turns that are a step within their limits.
fn with_room(grid: &Grid) -> Problem {
    let mut problem = grid.problem.clone();
    problem.keepouts.iter_mut().for_each(|keepout| keepout.distance += ROOM);
    for row in &mut problem.rows {
        match row.function {
            Function::Turn(_) if row.high - row.low > 4.0 * grid.step => {
                (row.low, row.high) = (row.low + grid.step, row.high - grid.step);
            }
            Function::Straight(_) if row.high == f64::INFINITY => row.low += ROOM,
            _ => {}
        }
    }
    problem
}

fn from(grid: &Grid, problem: Problem, start: &Solution) -> Option<Solution> {
    let origin = grid.origin.unwrap_or_else(|| Track::new(&to_corners(&start.variables)).straight(0).heading);
    let nearest = grid.nearest(&start.variables);
    let headings = (0..grid.len()).map(|i| grid.problem.holds_heading(i).then_some(nearest[i])).collect();
    let at = start.clone();
    let mut dive = Dive { grid, problem, at, origin, headings, solves: 0, iterations: 0 };
    dive.hold_headings()?;
    dive.hold_radii()?;
    let headings: Option<Vec<i64>> = dive.headings.iter().copied().collect();
    let turns = grid.turns(&headings?)?;
    let radii = (0..grid.len()).map(|i| Some(dive.at.variables[radius(i)])).collect::<Vec<_>>();
    let mut last = grid.repair(&turns, &radii, &dive.at.variables);
    last.iterations += dive.iterations;
    (last.max_violation <= grid.settings.feasibility).then_some(last)
}

impl Dive<'_> {
    /// Long sections first: what is short adapts to them.
    fn hold_headings(&mut self) -> Option<()> {
        let mut most = usize::MAX;
        loop {
            let track = Track::new(&to_corners(&self.at.variables));
            let (origin, step) = (self.origin, self.grid.step);
            let exact = |i: usize| trig::wrap(track.straight(i).heading - origin) / step;
            let mut open: Vec<usize> = (0..self.grid.len()).filter(|i| self.headings[*i].is_none()).collect();
            if open.is_empty() {
                return Some(());
            }
            open.sort_by(|a, b| track.straight(*b).length.total_cmp(&track.straight(*a).length).then(a.cmp(b)));
            let count = open.len().div_ceil(AT_ONCE).min(most).max(1);
            let mut chosen: Vec<Held> = Vec::new();
            for &section in &open {
                let value = exact(section);
                let nearest = value.round();
                let other = if value > nearest { nearest + 1.0 } else { nearest - 1.0 };
                let ways = [(nearest as i64, other as i64), (other as i64, nearest as i64)];
                let fits = ways.into_iter().find(|(heading, _)| self.may_hold(&chosen, section, *heading));
                if let Some((heading, other)) = fits.filter(|_| chosen.len() < count) {
                    chosen.push(Held { section, heading, other });
                }
            }
            if chosen.is_empty() {
                return None;
            }
            if self.try_headings(&mut chosen) {
                most = most.saturating_mul(2);
            } else if chosen.len() > 1 {
                most = chosen.len() / 2;
            } else {
                return None;
            }
        }
    }

    /// Whether turns beside a section stay within their limits.
    fn may_hold(&self, chosen: &[Held], section: usize, heading: i64) -> bool {
        let n = self.grid.len();
        let of = |i: usize| {
            let now = chosen.iter().find(|held| held.section == i).map(|held| held.heading);
            now.or(self.headings[i])
        };
        let turn = |vertex: usize, from: Option<i64>, to: Option<i64>| {
            let (Some(from), Some(to)) = (from, to) else { return true };
            self.grid.turn(vertex, from, to).is_some()
        };
        let (before, behind) = ((section + n - 1) % n, (section + 1) % n);
        turn(section, of(before), Some(heading)) && turn(behind, Some(heading), of(behind))
    }

    /// Holds headings where that leaves a layout; where it does not, those that are not met take their other multiple.
    fn try_headings(&mut self, chosen: &mut [Held]) -> bool {
        for _ in 0..TURNS {
            let mut problem = self.problem.clone();
            let known = problem.rows.len();
            problem.rows.extend(chosen.iter().map(|held| self.row(held.section, held.heading)));
            let Err(ended) = self.solve(problem.clone()) else {
                chosen.iter().for_each(|held| self.headings[held.section] = Some(held.heading));
                return true;
            };
            let off = |x: &[f64]| -> Vec<usize> {
                let at = problem.evaluate(x, 0.0);
                let missed = |k: &usize| at.rows[known + k].violation() > self.grid.settings.feasibility;
                (0..chosen.len()).filter(missed).collect()
            };
            let mut missed = off(&ended);
            if missed.is_empty() {
                missed = off(&self.relaxed(chosen));
            }
            let mut turned = false;
            for k in missed {
                let held = chosen[k];
                if self.may_hold(chosen, held.section, held.other) {
                    (chosen[k].heading, chosen[k].other) = (held.other, held.heading);
                    turned = true;
                }
            }
            if !turned {
                return false;
            }
        }
        false
    }

    /// The layout that meets all else and keeps as many of these headings as is worth it: where a distance is what fails,
    /// it says which headings ask for too much.
    fn relaxed(&mut self, chosen: &[Held]) -> Vec<f64> {
        let mut problem = self.problem.clone();
        let soft = |held: &Held| ConstraintRow { weight: Some(MISSED), ..self.row(held.section, held.heading) };
        problem.rows.extend(chosen.iter().map(soft));
        self.minimise(&problem).variables
    }

    /// From the layout that meets what is held so far.
    fn minimise(&mut self, problem: &Problem) -> Solution {
        let settings = SqpSettings { iterations: STEPS, dearest: 2e3, ..self.grid.settings };
        let at = sqp::minimise(problem, &self.at.variables, &settings, &|_, _, _| {});
        self.iterations += at.iterations;
        at
    }

    /// A section's heading as a row of coordinates.
    fn row(&self, section: usize, heading: i64) -> ConstraintRow {
        let next = (section + 1) % self.grid.len();
        let across = Point::unit(self.origin + heading as f64 * self.grid.step).left();
        let (label, span) = ("heading on the grid".to_owned(), self.problem.vertex_span(section));
        ConstraintRow::hard(Function::advance(section, next, across), (0.0, 0.0), label, span)
    }

    /// Takes a problem with its layout, if one is found near the last.
    fn solve(&mut self, problem: Problem) -> Result<(), Vec<f64>> {
        self.solves += 1;
        if self.solves > SOLVES || self.grid.settings.stop.now() {
            return Err(self.at.variables.clone());
        }
        let at = self.minimise(&problem);
        if at.max_violation > self.grid.settings.feasibility {
            return Err(at.variables);
        }
        (self.problem, self.at) = (problem, at);
        Ok(())
    }

    fn hold_radii(&mut self) -> Option<()> {
        let mut most = usize::MAX;
        loop {
            let free = |i: &usize| self.problem.bounds[radius(*i)].low < self.problem.bounds[radius(*i)].high;
            let nearest = |i: usize| self.grid.radii_by_distance(self.at.variables[radius(i)]);
            let mut open: Vec<(usize, Vec<f64>)> = (0..self.grid.len()).filter(free).map(|i| (i, nearest(i))).collect();
            if open.is_empty() {
                return Some(());
            }
            let off = |i: usize, radii: &[f64]| (self.at.variables[radius(i)] - radii[0]).abs();
            open.sort_by(|a, b| off(a.0, &a.1).total_cmp(&off(b.0, &b.1)).then(a.0.cmp(&b.0)));
            let count = open.len().div_ceil(AT_ONCE).min(most).max(1);
            let chosen: Vec<(usize, f64)> = open.iter().take(count).map(|(i, radii)| (*i, radii[0])).collect();
            if self.try_radii(&chosen) {
                most = most.saturating_mul(2);
                continue;
            }
            if count > 1 {
                most = count / 2;
                continue;
            }
            let (i, radii) = &open[0];
            if !radii.get(1..).unwrap_or_default().iter().take(2).any(|next| self.try_radii(&[(*i, *next)])) {
                return None;
            }
        }
    }

    fn try_radii(&mut self, chosen: &[(usize, f64)]) -> bool {
        let mut problem = self.problem.clone();
        for &(i, value) in chosen {
            problem.bounds[radius(i)] = Interval { low: value, high: value };
        }
        self.solve(problem).is_ok()
    }
}
