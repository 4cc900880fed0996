//! Turns on the grid: those of the base first, then a section's heading a step to either side as long as that helps.

use super::base::Base;
use super::candidate::{Candidate, POLISHED, best as best_of};
use super::{Effort, Smooth};
use crate::problem::{Aim, Problem};
use crate::solve::Stop;
use crate::solve::sqp::{self, Solution, SqpSettings};
use std::collections::BTreeSet;

/// Choices of turns in all.
const CHOICES: usize = 200;
/// A gain worth a step.
const GAIN: f64 = 0.001;

/// The best layout found. The base itself where nothing is better.
pub fn best(
    base: &Base,
    problem: &Problem,
    goal: Smooth,
    (effort, stop): (&mut Effort, Stop),
    tell: &dyn Fn(usize, &Candidate),
) -> Candidate {
    let mut turns = base.turns(&base.variables);
    let mut best = Candidate::at(base, problem, goal, Solution::at(problem, &base.variables));
    let held = base.problem(problem, &turns, &base.variables);
    tell(0, &best);
    // The base is a layout already.
    if !stop.now() {
        take(&mut best, best_of(base, &held, goal, &base.variables, POLISHED, effort));
    }
    let mut seen: BTreeSet<Vec<i64>> = BTreeSet::from([turns.clone()]);
    // One move after another, over and over, until none of them helps.
    let moves = moves(problem);
    let mut idle = 0;
    for (section, by) in moves.iter().cycle() {
        if idle == moves.len() || effort.choices >= CHOICES || stop.now() {
            break;
        }
        idle += 1;
        let Some(next) = moved(base, problem, &turns, *section, *by) else { continue };
        if !seen.insert(next.clone()) {
            continue;
        }
        let held = base.problem(problem, &next, &base.variables);
        let Some(near) = nearest(&held, &best.solution.variables) else { continue };
        let before = best.merit;
        if take(&mut best, best_of(base, &held, goal, &near, 1, effort)) {
            turns = next;
            if best.merit < before * (1.0 - GAIN) {
                idle = 0;
            }
        }
        tell(effort.choices, &best);
    }
    best.solution.iterations = effort.iterations;
    best.solution.converged = true;
    best
}

/// Whether a new candidate is the better one, and takes its place.
fn take(best: &mut Candidate, new: Option<Candidate>) -> bool {
    match new {
        Some(new) if new.merit < best.merit => {
            *best = new;
            true
        }
        _ => false,
    }
}

/// The nearest layout with other turns that meets every row.
fn nearest(held: &Problem, from: &[f64]) -> Option<Vec<f64>> {
    let mut problem = held.clone();
    problem.aim = Aim::Near(from.to_vec());
    let settings = SqpSettings { radius: 0.3, iterations: 40, dearest: 2e3, ..SqpSettings::default() };
    let found = sqp::minimise(&problem, from, &settings, &|_, _, _| {});
    (found.max_violation <= settings.feasibility).then_some(found.variables)
}

/// Sections whose heading may change, each to either side.
fn moves(problem: &Problem) -> Vec<(usize, i64)> {
    let free = (0..problem.vertices.len()).filter(|&i| !problem.holds_heading(i));
    free.flat_map(|i| [(i, 1), (i, -1)]).collect()
}

/// Turns with a section's heading a step to one side; `None` beyond the limits of turns.
fn moved(base: &Base, problem: &Problem, turns: &[i64], section: usize, by: i64) -> Option<Vec<i64>> {
    let next = (section + 1) % turns.len();
    let step = base.layout.catalog.curve.angle_step;
    let limits = base.layout.turns.value;
    let within = |turn: i64| turn as f64 * step >= limits.low - 1e-9 && turn as f64 * step <= limits.high + 1e-9;
    let mut out = turns.to_vec();
    out[section] += by * problem.signs[section] as i64;
    out[next] -= by * problem.signs[next] as i64;
    (within(out[section]) && within(out[next])).then_some(out)
}
