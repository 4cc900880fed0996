//! Stage 3: the layout on the catalogue's grid of turns and radii (thesis §3.3, stage 3).
//!
//! A saw-tooth penalty draws every turn and radius to its nearest multiple while the layout goes on being optimised,
//! harder in each round. The turns it ends near are where a repair begins: with turns held on the grid the radii and
//! straights are re-optimised, the radii are then rounded one by one, and neighbouring turns are searched best
//! first. The result is a good layout, not a proven best one.

mod dive;

use super::sqp::{self, Solution, SqpSettings};
use crate::base::trig;
use crate::geometry::Track;
use crate::model::{Formula, Interval, Layout, Target};
use crate::problem::measures::{radius, to_corners};
use crate::problem::{ConstraintRow, Function, Problem};
use std::collections::BTreeSet;

/// Rounds of the saw-tooth: price of a radius off the grid (m a m) and of a turn (m a rad).
const ROUNDS: [(f64, f64); 4] = [(0.02, 0.3), (0.1, 1.5), (0.5, 6.0), (2.0, 25.0)];
/// How often the targets of a round are chosen anew.
const REPEATS: usize = 3;
/// How many choices of turns the repair looks at.
const CHOICES: usize = 80;
/// So many radii are rounded at once first: one by one, each takes two solves.
const MANY: usize = 24;
/// Layouts of more vertices are rounded by [`dive`] first: every choice of turns takes seconds.
pub const LARGE: usize = 40;
/// Distances beyond what obstacles and building ask for that a layout is begun from where rounding it left none, m.
const ROOM: [f64; 3] = [0.05, 0.2, 0.5];
/// A radius this close to the grid is on it, m.
const ON_GRID: f64 = 1e-6;

/// Headings of the sections as multiples of the angle step from the grid's origin.
type Headings = Vec<i64>;

/// The grid and the problem on it.
struct Grid<'a> {
    problem: &'a Problem,
    /// rad
    step: f64,
    /// Steps in a full turn.
    circle: i64,
    /// The heading that the grid is counted from: that of a section whose heading is fixed, if there is one, rad.
    origin: Option<f64>,
    /// Multiples of the step that the turn limits allow.
    multiples: (i64, i64),
    /// m, ascending, within the layout's limits.
    radii: Vec<f64>,
    settings: SqpSettings,
}

/// Discretises from a continuous optimum. Returns the best solution found, feasible or not.
pub fn discretise(layout: &Layout, problem: &Problem, start: &Solution, settings: &SqpSettings) -> Solution {
    let Some(grid) = Grid::new(layout, problem, settings) else { return start.clone() };
    if grid.len() > LARGE
        && let Some(found) = dive::dive(&grid, start)
    {
        return found;
    }
    let mut search = Search { grid: &grid, seen: BTreeSet::new(), open: Vec::new(), best: None, iterations: 0 };
    let mut x = start.variables.clone();
    search.look(grid.nearest(&x), &x);
    for (radius_price, turn_price) in ROUNDS {
        for _ in 0..REPEATS {
            let target = grid.nearest(&x);
            let drawn = grid.draw(&target, &x, radius_price, turn_price);
            search.iterations += drawn.iterations;
            x = drawn.variables;
            if grid.nearest(&x) == target {
                break;
            }
        }
        search.look(grid.nearest(&x), &x);
        if settings.stop.now() {
            break;
        }
    }
    search.run();
    for room in ROOM {
        if search.is_feasible() || settings.stop.now() {
            break;
        }
        search.begin_with_room(room, &start.variables);
        search.run();
    }
    let mut best = search.best.unwrap_or_else(|| start.clone());
    best.iterations = search.iterations;
    best
}

/// The layout nearest to `x` with its turns and radii held on the grid, and straights of at least so much in all (m) if
/// that is given; `None` where they cannot be held.
pub fn hold(
    layout: &Layout,
    problem: &Problem,
    settings: &SqpSettings,
    x: &[f64],
    straights: Option<f64>,
) -> Option<Solution> {
    let mut problem = problem.clone();
    if let Some(low) = straights {
        let straight = |from| Formula::Length(Target { from, straight: true });
        let function = Function::Formula(Formula::Sum((0..problem.vertices.len()).map(straight).collect()));
        let (label, span) = ("straights in all".to_owned(), problem.vertex_span(0));
        let high = f64::INFINITY;
        problem.rows.push(ConstraintRow {
            function,
            low,
            high,
            unit: crate::model::Unit::Metre,
            weight: None,
            label,
            span,
            reason: None,
        });
    }
    let problem = &problem;
    let grid = Grid::new(layout, problem, settings)?;
    let turns = grid.turns(&grid.nearest(x))?;
    let fixed = |i: usize| problem.bounds[radius(i)].low == problem.bounds[radius(i)].high;
    let held: Vec<Option<f64>> =
        (0..grid.len()).map(|i| (!fixed(i)).then(|| grid.radii_by_distance(x[radius(i)])[0])).collect();
    Some(grid.repair(&turns, &held, x))
}

/// Best-first search over turns.
struct Search<'a> {
    grid: &'a Grid<'a>,
    seen: BTreeSet<Headings>,
    /// Choices looked at and not yet expanded, with their solution for continuous radii.
    open: Vec<(Headings, Solution)>,
    best: Option<Solution>,
    iterations: usize,
}

impl Search<'_> {
    /// Solves for continuous radii at a choice of headings, once.
    fn look(&mut self, headings: Headings, x: &[f64]) {
        if self.seen.len() >= CHOICES || !self.seen.insert(headings.clone()) {
            return;
        }
        let Some(turns) = self.grid.turns(&headings) else { return };
        let relaxed = self.grid.repair(&turns, &vec![None; turns.len()], x);
        self.iterations += relaxed.iterations;
        self.open.push((headings, relaxed));
    }

    fn is_feasible(&self) -> bool {
        self.best.as_ref().is_some_and(|s| s.max_violation <= self.grid.settings.feasibility)
    }

    /// Looks anew at the turns of a layout that keeps a larger distance: a layout that touches everything around it may
    /// have none on the grid beside it.
    fn begin_with_room(&mut self, room: f64, x: &[f64]) {
        let mut problem = self.grid.problem.clone();
        problem.keepouts.iter_mut().for_each(|k| k.distance += room);
        let roomy = sqp::minimise(&problem, x, &self.grid.settings, &|_, _, _| {});
        self.iterations += roomy.iterations;
        self.seen.clear();
        self.open.clear();
        self.look(self.grid.nearest(&roomy.variables), &roomy.variables);
    }

    fn rank_of_best(&self) -> f64 {
        self.best.as_ref().map_or(f64::INFINITY, |s| self.grid.rank(s))
    }

    fn run(&mut self) {
        let rank = |s: &(Headings, Solution)| self.grid.rank(&s.1);
        while let Some(next) = (0..self.open.len()).min_by(|&a, &b| rank(&self.open[a]).total_cmp(&rank(&self.open[b])))
        {
            let over = self.grid.settings.stop.now();
            if over && self.best.is_some() {
                break;
            }
            let (headings, relaxed) = self.open.swap_remove(next);
            // Where even free radii are no shorter than the best, the neighbours hardly are.
            if self.grid.rank(&relaxed) >= self.rank_of_best() {
                break;
            }
            if let Some(turns) = self.grid.turns(&headings) {
                let rounded = self.grid.round_radii(&turns, relaxed.clone(), &mut self.iterations);
                if self.grid.rank(&rounded) < self.rank_of_best() {
                    self.best = Some(rounded);
                }
            }
            // Without any there would be nothing to keep.
            if over {
                break;
            }
            for neighbour in self.grid.neighbours(&headings) {
                if self.grid.settings.stop.now() {
                    break;
                }
                self.look(neighbour, &relaxed.variables);
            }
        }
    }
}

impl<'a> Grid<'a> {
    fn new(layout: &Layout, problem: &'a Problem, settings: &SqpSettings) -> Option<Self> {
        let step = layout.catalog.curve.angle_step;
        let turns = layout.turns.value;
        let slack = 1e-9;
        let multiples = (((turns.low - slack) / step).ceil() as i64, ((turns.high + slack) / step).floor() as i64);
        let limits = layout.radii.value;
        let within = |r: &f64| *r >= limits.low - slack && *r <= limits.high + slack;
        let radii: Vec<f64> = layout.catalog.curve.radii.iter().copied().filter(within).collect();
        let settings = SqpSettings { radius: 0.5, dearest: 0.0, ..*settings };
        let circle = (trig::TAU / step).round() as i64;
        let written = Track::new(&to_corners(&problem.start));
        let mut held = problem.rotations.iter().copied().chain(0..problem.vertices.len());
        let held = held.find(|&i| problem.holds_heading(i));
        let origin = held.map(|i| written.straight(i).heading);
        (multiples.0 <= multiples.1 && !radii.is_empty()).then_some(Grid {
            problem,
            step,
            circle,
            origin,
            multiples,
            radii,
            settings,
        })
    }

    fn len(&self) -> usize {
        self.problem.signs.len()
    }

    /// The nearest headings on the grid, sections with a fixed rotation where they were written.
    fn nearest(&self, x: &[f64]) -> Headings {
        let track = Track::new(&to_corners(x));
        // Where nothing fixes the rotation, the whole grid turns with the first section.
        let origin = self.origin.unwrap_or_else(|| track.straight(0).heading);
        let step = |i: usize| (trig::wrap(track.straight(i).heading - origin) / self.step).round() as i64;
        (0..self.len()).map(step).collect()
    }

    /// Turns in their written directions, as multiples of the step; `None` where one is beyond its limits.
    fn turns(&self, headings: &Headings) -> Option<Vec<i64>> {
        let n = self.len();
        (0..n).map(|i| self.turn(i, headings[(i + n - 1) % n], headings[i])).collect()
    }

    /// The turn at a vertex between two headings, likewise.
    fn turn(&self, vertex: usize, from: i64, to: i64) -> Option<i64> {
        let turn = (to - from).rem_euclid(self.circle);
        let signed = if 2 * turn > self.circle { turn - self.circle } else { turn };
        let turn = signed * self.problem.signs[vertex] as i64;
        (self.multiples.0..=self.multiples.1).contains(&turn).then_some(turn)
    }

    /// The catalogue's radii at and around a value: nearest first.
    fn radii_by_distance(&self, value: f64) -> Vec<f64> {
        let mut radii = self.radii.clone();
        radii.sort_by(|a, b| (a - value).abs().total_cmp(&(b - value).abs()));
        radii
    }

    /// The problem with turns and radii drawn to the grid: the slope of the saw-tooth's teeth they stand on.
    fn draw(&self, headings: &Headings, x: &[f64], radius_price: f64, turn_price: f64) -> Solution {
        let mut problem = self.problem.clone();
        let turns = self.turns(headings);
        for i in 0..self.len() {
            if let Some(turns) = &turns {
                problem.soft(Function::Turn(i), turns[i] as f64 * self.step, turn_price);
            }
            let aim = self.radii_by_distance(x[radius(i)])[0];
            problem.soft(Function::Linear(vec![(radius(i), 1.0)]), aim, radius_price);
        }
        sqp::minimise(&problem, x, &self.settings, &|_, _, _| {})
    }

    /// The problem with turns (multiples of the step) and some radii held on the grid.
    fn repair(&self, turns: &[i64], radii: &[Option<f64>], x: &[f64]) -> Solution {
        let mut problem = self.problem.clone();
        let mut x = x.to_vec();
        for row in &mut problem.rows {
            if let Function::Turn(i) = row.function {
                (row.low, row.high) = (turns[i] as f64 * self.step, turns[i] as f64 * self.step);
            }
        }
        for (i, held) in radii.iter().enumerate() {
            if let Some(value) = *held {
                problem.bounds[radius(i)] = Interval { low: value, high: value };
                x[radius(i)] = value;
            }
        }
        sqp::minimise(&problem, &x, &self.settings, &|_, _, _| {})
    }

    /// Holds the radii one by one at the better of their two neighbours on the grid, the farthest from it first; of many
    /// all at once, where that leaves a layout, and what is left of them once time is over.
    fn round_radii(&self, turns: &[i64], mut solution: Solution, iterations: &mut usize) -> Solution {
        // A radius that the layout fixes stays: off the grid it is reported when elements are chosen.
        let fixed = |i: usize| self.problem.bounds[radius(i)].low == self.problem.bounds[radius(i)].high;
        let mut held: Vec<Option<f64>> = vec![None; self.len()];
        if self.len() > MANY {
            let nearest = |i: usize| self.radii_by_distance(solution.variables[radius(i)])[0];
            let all: Vec<Option<f64>> = (0..self.len()).map(|i| (!fixed(i)).then(|| nearest(i))).collect();
            let rounded = self.repair(turns, &all, &solution.variables);
            *iterations += rounded.iterations;
            if rounded.max_violation <= self.settings.feasibility {
                return rounded;
            }
        }
        loop {
            let mut farthest: Option<(f64, usize)> = None;
            for i in (0..self.len()).filter(|&i| !fixed(i)) {
                if held[i].is_some() {
                    continue;
                }
                let value = solution.variables[radius(i)];
                let nearest = self.radii_by_distance(value)[0];
                if (value - nearest).abs() <= ON_GRID {
                    held[i] = Some(nearest);
                } else if farthest.is_none_or(|(d, _)| (value - nearest).abs() > d) {
                    farthest = Some(((value - nearest).abs(), i));
                }
            }
            if self.settings.stop.now() {
                for i in (0..self.len()).filter(|&i| !fixed(i)) {
                    held[i] = held[i].or(Some(self.radii_by_distance(solution.variables[radius(i)])[0]));
                }
                farthest = None;
            }
            let Some((_, i)) = farthest else {
                let last = self.repair(turns, &held, &solution.variables);
                *iterations += last.iterations;
                return last;
            };
            let mut options: Vec<Solution> = Vec::new();
            for value in self.radii_by_distance(solution.variables[radius(i)]).into_iter().take(2) {
                held[i] = Some(value);
                let option = self.repair(turns, &held, &solution.variables);
                *iterations += option.iterations;
                options.push(option);
            }
            let better = options.into_iter().min_by(|a, b| self.rank(a).total_cmp(&self.rank(b)));
            if let Some(better) = better {
                held[i] = Some(better.variables[radius(i)]);
                solution = better;
            }
        }
    }

    /// Feasible layouts by length, after them infeasible ones by violation.
    fn rank(&self, s: &Solution) -> f64 {
        if s.max_violation <= self.settings.feasibility { s.length } else { 1e9 * (1.0 + s.max_violation) }
    }

    /// Headings with one section's a step away.
    fn neighbours(&self, headings: &Headings) -> Vec<Headings> {
        let step = |i: usize, by: i64| {
            let mut next = headings.clone();
            next[i] += by;
            next
        };
        let free = (0..self.len()).filter(|&i| !self.problem.holds_heading(i));
        free.flat_map(|i| [step(i, 1), step(i, -1)]).collect()
    }
}
