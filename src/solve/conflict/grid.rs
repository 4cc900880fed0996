//! The same for the catalogue's grid: lines for which stage 3 finds no layout of standard turns and radii.
//!
//! A line is left out of the layout itself, and stage 3 begins again from the continuous optimum, which meets all
//! lines.

use super::lines::{LineKind, Lines, Role};
use super::search::{Search, Set, meets};
use super::{Conflict, Examiner, MOST_ON_GRID, Member, Proof, Relaxed, Within, decided, unit, words};
use crate::geometry::Track;
use crate::model::{ConstraintKind, Formula, Goal, Interval, Layout, Objective, Side, Unit};
use crate::problem::measures::{radius, to_corners, to_variables};
use crate::problem::{Function, LEVER, Problem, Scope};
use crate::solve::options::Discretised;
use crate::solve::sqp::{Solution, SqpSettings};
use crate::solve::violations::off_grid;
use crate::solve::{Effort, Stage, exact};
use crate::source::Span;
use std::cell::Cell;
use std::collections::BTreeMap;

/// Most times that stage 3 runs for one conflict, and the nodes of each search.
const RUNS: usize = 40;
const NODES: usize = 300;

/// The lines for which stage 3 found no layout; none where leaving lines out does not help, or a run takes long.
pub fn conflicts(layout: &Layout, stages: &[Stage]) -> Vec<Conflict> {
    let [.., before, failed] = stages else { return Vec::new() };
    if layout.vertices.len() > MOST_ON_GRID {
        return Vec::new();
    }
    let open: Vec<Span> = layout.obstacles.iter().filter(|o| o.side == Side::Either).map(|o| o.span).collect();
    let mut layout = decided(layout, failed);
    layout.objective = Objective { terms: vec![(1.0, Goal::Length)], ..Objective::default() };
    layout.chain.closes_within = None;
    let layout = &layout;
    let problem = Problem::new(layout, Scope::Obstacles);
    let lines = Lines::new(layout, &problem);
    let start = to_variables(&before.corners);
    let stage = GridStage { layout, lines: &lines, start: &start, runs: Cell::new(0) };
    let all: Set = (0..lines.list.len()).collect();
    let mut set: Set = all.iter().copied().filter(|&i| stage.can_leave(i)).collect();
    let fixed: Set = all.difference(&set).copied().collect();
    let with = |set: &Set| -> Set { set.union(&fixed).copied().collect() };
    let mut without = BTreeMap::new();
    for line in set.clone() {
        let mut others = set.clone();
        others.remove(&line);
        match stage.layout(&with(&others)) {
            Some(x) => {
                without.insert(line, x);
            }
            None => set = others,
        }
    }
    if stage.runs.get() > RUNS || set.is_empty() {
        return Vec::new();
    }
    // With an obstacle on one side, nothing is proven of the other.
    let decides = set.iter().any(|&i| open.contains(&lines.list[i].span));
    let proof = match !decides && stage.run(&with(&set)).refuted {
        true => Proof::Grid,
        false if failed.refuted => Proof::GridOfAll,
        false => Proof::NotFound,
    };
    let search = Search::new(layout, &problem, &lines, &start);
    let examiner = Examiner { layout, lines: &lines, search: &search, all: &all, open: &open };
    let mut members: Vec<Member> =
        set.iter().map(|&line| stage.member(&examiner, line, &with(&set), without.get(&line))).collect();
    members.sort_by_key(|m| (m.span.file.0, m.span.start));
    let span = layout.vertices.first().map_or(layout.span, |v| v.span);
    vec![Conflict { members, together: None, proof, starts: 1, on_grid: true, span }]
}

/// Stage 3 of a layout of which lines may be left out.
struct GridStage<'a> {
    layout: &'a Layout,
    lines: &'a Lines,
    start: &'a [f64],
    runs: Cell<usize>,
}

impl GridStage<'_> {
    /// Whether a line can be left out of the layout.
    fn can_leave(&self, line: usize) -> bool {
        let line = &self.lines.list[line];
        let measured = |formula: &Formula| distance_to_obstacle(formula);
        match line.kind {
            LineKind::Room => false,
            // Formulas count obstacles.
            LineKind::Obstacle => !self.layout.constraints.iter().any(|c| match &c.kind {
                ConstraintKind::Require { formula, .. } => measured(formula),
                _ => false,
            }),
            _ => true,
        }
    }

    /// The layout with some of its lines only.
    fn only(&self, set: &Set) -> Layout {
        let mut layout = self.layout.clone();
        for (i, line) in self.lines.list.iter().enumerate() {
            if set.contains(&i) {
                continue;
            }
            match line.kind {
                LineKind::Turns => layout.turns.value = layout.catalog.curve.turns,
                LineKind::Radii => {
                    let all = &layout.catalog.curve.radii;
                    let ends = (all.first().copied(), all.last().copied());
                    if let (Some(low), Some(high)) = ends {
                        layout.radii.value = Interval { low, high };
                    }
                }
                LineKind::Building => layout.building = None,
                LineKind::Obstacle => layout.obstacles.retain(|o| o.span != line.span),
                LineKind::Room => {}
                LineKind::Fix | LineKind::Require => layout.constraints.retain(|c| c.span != line.span),
            }
        }
        layout
    }

    fn run(&self, set: &Set) -> Discretised {
        self.runs.set(self.runs.get() + 1);
        let layout = self.only(set);
        let problem = Problem::new(&layout, Scope::Obstacles);
        let start = Solution::at(&problem, self.start);
        exact::discretise(
            &layout,
            &problem,
            &start,
            &SqpSettings::default(),
            &Effort { nodes: NODES, gap: 1.0, class: false },
            &|_| (),
        )
    }

    /// A layout on the grid that meets some lines; `None` where none was found, or out of runs.
    fn layout(&self, set: &Set) -> Option<Vec<f64>> {
        if self.runs.get() > RUNS {
            return None;
        }
        let x = self.run(set).solution.variables;
        let layout = self.only(set);
        let problem = Problem::new(&layout, Scope::Obstacles);
        let on_grid = off_grid(&layout, &problem, &x, SqpSettings::default().feasibility).is_empty();
        (on_grid && meets(&problem, &x)).then_some(x)
    }

    fn member(&self, examiner: &Examiner, line: usize, set: &Set, known: Option<&Vec<f64>>) -> Member {
        let leave = |set: &Set| -> Set { set.iter().copied().filter(|&i| i != line).collect() };
        let mut others = leave(examiner.all);
        let mut layout = self.layout(&others);
        let within = if layout.is_some() { Within::Layout } else { Within::Members };
        if layout.is_none() {
            others = leave(set);
            layout = known.cloned();
        }
        let relaxed = layout.as_deref().and_then(|near| self.relaxed(examiner, line, &others, near));
        examiner.told(line, within, layout.map(|x| to_corners(&x)), relaxed)
    }

    /// How far a line must give way for the others to hold, with the turns and radii of a layout without it.
    fn relaxed(&self, examiner: &Examiner, line: usize, others: &Set, near: &[f64]) -> Option<Relaxed> {
        let stated = &self.lines.list[line];
        if matches!(stated.kind, LineKind::Turns | LineKind::Radii) {
            return None;
        }
        let role = |i: usize| match others.contains(&i) {
            _ if i == line => Role::Gives,
            true => Role::Holds,
            false => Role::Left,
        };
        let least = examiner.search.minimum_near(&held(self.lines.problem(role), near), near)?;
        confirm_held(examiner, line, least.amount, &least.at, role)
    }
}

/// An amount rounded up until a layout with the limits moved by as much is found that has the turns and radii of one
/// nearby.
pub(super) fn confirm_held(
    examiner: &Examiner,
    line: usize,
    amount: f64,
    near: &[f64],
    role: impl Fn(usize) -> Role,
) -> Option<Relaxed> {
    let unit = unit(examiner.layout, &examiner.lines.list[line]);
    (0..3).find_map(|more| {
        let said = words::stated(unit, amount, more);
        let hard = held(examiner.lines.given_way(said.slack, &role), near);
        let x = Search::reach(&hard, near)?;
        let amount = if unit == Unit::Radian { said.slack / LEVER } else { said.slack };
        Some(Relaxed { amount, text: said.text, corners: to_corners(&x) })
    })
}

/// A problem with the turns and radii of a layout.
fn held(mut problem: Problem, at: &[f64]) -> Problem {
    let track = Track::new(&to_corners(at));
    let n = problem.vertices.len();
    for row in problem.rows.iter_mut().take(n) {
        if let Function::Turn(i) = row.function {
            let turn = track.fillets[i].turn.abs();
            (row.low, row.high) = (turn, turn);
        }
    }
    for i in 0..n {
        problem.bounds[radius(i)] = Interval { low: at[radius(i)], high: at[radius(i)] };
    }
    problem
}

fn distance_to_obstacle(formula: &Formula) -> bool {
    match formula {
        Formula::DistanceObstacle(..) => true,
        Formula::Sum(all) | Formula::Product(all) | Formula::Smallest(all) | Formula::Largest(all) => {
            all.iter().any(distance_to_obstacle)
        }
        Formula::Negative(f) | Formula::Reciprocal(f) | Formula::Absolute(f) | Formula::SquareRoot(f) => {
            distance_to_obstacle(f)
        }
        _ => false,
    }
}
