//! The layout that a search for an even run starts from, and the limits that it sets.

use super::{Smooth, rows};
use crate::base::trig;
use crate::geometry::{Track, self_crossings};
use crate::model::{Constraint, ConstraintKind, Goal, Interval, Layout, Obstacle, Side};
use crate::problem::measures::{radius, to_corners, to_variables, x, y};
use crate::problem::{Aim, Problem, Scope};
use crate::semantics::settle_sides;
use crate::solve::sqp::{self, SqpSettings};
use crate::solve::stages::solve_in_stages;
use crate::solve::violations::{as_written, off_grid, stage};
use crate::solve::{Discretise, Options, Stage, Status, Tell, discrete, worth};
use std::time::Instant;

/// Without a budget the track may grow by this ratio.
const GROWTH: f64 = 0.01;

/// A feasible layout on the grid.
pub struct Base {
    /// The layout with its radii held, and the budget and the closing of the chain among its constraints.
    pub layout: Layout,
    /// Which of its constraints the closing of the chain is.
    pub closing: usize,
    pub variables: Vec<f64>,
    /// The budget of cost, EUR.
    pub limit: Option<f64>,
    /// No coordinate goes farther from the base than this, m: the period of the landscape.
    pub reach: f64,
}

/// Stages that lead to the base, and the base unless they fail.
pub fn base(
    layout: &Layout,
    goal: Smooth,
    options: &Options,
    discretise: Discretise,
    watch: Tell,
) -> (Vec<Stage>, Option<Base>) {
    let mut held = hold_radii(layout);
    if goal.base(&layout.objective).is_none() {
        settle(&mut held, &Track::new(&layout.corners()));
    }
    let find = |layout: &Layout| match goal.base(&layout.objective) {
        Some(objective) => solve_in_stages(&Layout { objective, ..layout.clone() }, options, discretise, watch),
        None => nearest(layout),
    };
    let mut stages = find(&held);
    let failed = |stages: &[Stage]| stages.last().is_none_or(|s| s.status == Status::Infeasible);
    if failed(&stages) {
        return (stages, None);
    }
    let last = |stages: &[Stage]| stages.last().map_or_else(Vec::new, |s| to_variables(&s.corners));
    let mut variables = last(&stages);
    settle(&mut held, &Track::new(&to_corners(&variables)));
    // A whole number of carts.
    let pitch = layout.cart.length;
    let lacks = |variables: &[f64]| {
        let path = rows::path(variables, pitch);
        (path - (path / pitch).round() * pitch, path)
    };
    let (left, path) = lacks(&variables);
    let stated = layout.chain.closes_within.as_ref().map(|c| (c.value, c.span));
    let (slack, span) = stated.unwrap_or((left.abs().max(layout.take_up_travel()), layout.span));
    // The shortest layout can only become longer, and a cheaper one is mostly shorter.
    let carts = match left.abs() > slack && goal.base(&layout.objective).is_some() {
        true => ((path - slack) / pitch).ceil(),
        false => (path / pitch).round(),
    };
    let closing = rows::closing(&held, carts, (slack, 0.0), span);
    held.constraints.push(closing);
    let closing = held.constraints.len() - 1;
    if left.abs() > slack {
        stages = find(&held);
        if failed(&stages) {
            return (stages, None);
        }
        variables = last(&stages);
    }
    let track = Track::new(&to_corners(&variables));
    let length = track.length;
    let growth = match goal.budget {
        Some((limited, ratio)) => (limited == Goal::Length).then_some(ratio),
        None => (goal.base(&layout.objective).is_none()).then_some(GROWTH),
    };
    let limit = goal
        .budget
        .filter(|(limited, _)| *limited == Goal::Cost)
        .map(|(_, ratio)| (1.0 + ratio) * worth(&held, &track, 0.0));
    if let Some(growth) = growth {
        let limit = length * (1.0 + growth);
        let span = layout.objective.span.unwrap_or(layout.span);
        held.constraints.push(rows::row(
            rows::chain_path(&held, 0.0),
            (f64::NEG_INFINITY, limit),
            span,
            "the budget of length".to_owned(),
        ));
    }
    (stages, Some(Base { layout: held, closing, variables, limit, reach: pitch }))
}

/// Obstacles whose side is open lie where this track passes them.
fn settle(layout: &mut Layout, track: &Track) {
    let simple = self_crossings(track).is_empty();
    for obstacle in layout.obstacles.iter_mut().filter(|o| o.side == Side::Either) {
        let mut free = [Obstacle { pass: None, ..obstacle.clone() }];
        settle_sides(track, simple, &mut free);
        obstacle.side = free[0].side;
    }
}

/// Radii stay as written; where a vertex has none, the base chooses it.
fn hold_radii(layout: &Layout) -> Layout {
    let mut held = layout.clone();
    for (vertex, written) in layout.vertices.iter().enumerate().filter(|(_, v)| v.has_radius()) {
        let fixed = |c: &Constraint| matches!(c.kind, ConstraintKind::FixRadius { vertex: v } if v == vertex);
        if !layout.constraints.iter().any(fixed) {
            let kind = ConstraintKind::FixRadius { vertex };
            held.constraints.push(Constraint { kind, span: written.radius.span, reason: None });
        }
    }
    held
}

/// The written layout where it is feasible and on the grid, else the nearest one that is.
fn nearest(layout: &Layout) -> Vec<Stage> {
    let settings = SqpSettings::default();
    let mut problem = Problem::new(layout, Scope::Obstacles);
    let written = as_written(&problem);
    let strict = stage("written", &problem, &sqp::Solution::at(&problem, &problem.start), &settings, Instant::now());
    if strict.max_violation <= settings.feasibility
        && off_grid(layout, &problem, &problem.start, settings.feasibility).is_empty()
    {
        return vec![written];
    }
    problem.aim = Aim::Near(problem.start.clone());
    let clock = Instant::now();
    let near = sqp::minimise(&problem, &problem.start, &settings, &|_, _, _| {});
    let continuous = stage("stage2", &problem, &near, &settings, clock);
    if continuous.status == Status::Infeasible {
        return vec![continuous];
    }
    let clock = Instant::now();
    let found = discrete::discretise(layout, &problem, &near, &settings);
    let mut last = stage("stage3", &problem, &found, &settings, clock);
    let off = off_grid(layout, &problem, &found.variables, settings.feasibility);
    if !off.is_empty() {
        last.status = Status::Infeasible;
        last.violations.extend(off);
    }
    vec![continuous, last]
}

impl Base {
    /// The problem with turns held at these multiples of the angle step (in their written directions), and coordinates
    /// kept within reach of `centre`.
    pub fn problem(&self, problem: &Problem, turns: &[i64], centre: &[f64]) -> Problem {
        let mut held = problem.clone();
        let step = self.layout.catalog.curve.angle_step;
        for row in &mut held.rows {
            if let crate::problem::Function::Turn(i) = row.function {
                (row.low, row.high) = (turns[i] as f64 * step, turns[i] as f64 * step);
            }
        }
        for k in (0..turns.len()).map(radius) {
            held.bounds[k] = Interval { low: self.variables[k], high: self.variables[k] };
        }
        for k in (0..turns.len()).flat_map(|i| [x(i), y(i)]) {
            let Interval { low, high } = held.bounds[k];
            if low < high {
                held.bounds[k] =
                    Interval { low: low.max(centre[k] - self.reach), high: high.min(centre[k] + self.reach) };
            }
        }
        held
    }

    /// The turns of a layout in their written directions, as multiples of the angle step.
    pub fn turns(&self, variables: &[f64]) -> Vec<i64> {
        let step = self.layout.catalog.curve.angle_step;
        let steps = |turn: f64| (trig::wrap(turn).abs() / step).round() as i64;
        Track::new(&to_corners(variables)).fillets.iter().map(|f| steps(f.turn)).collect()
    }
}
