//! Turns on the grid: those of the base first, then a section's heading a step to either side as long as that helps.

use super::base::Base;
use super::candidate::{Candidate, POLISHED, best as best_of};
use super::{Effort, Smooth};
use crate::problem::{Aim, Problem};
use crate::solve::sqp::{self, Settings, Solution};
use std::collections::BTreeSet;

/// Rounds over all sections.
const ROUNDS: usize = 3;
/// Choices of turns in all.
const CHOICES: usize = 60;
/// A gain worth another round.
const GAIN: f64 = 0.02;

/// The best layout found. The base itself where nothing is better.
pub fn best(
    base: &Base,
    problem: &Problem,
    goal: Smooth,
    effort: &mut Effort,
    tell: &dyn Fn(usize, &Candidate),
) -> Candidate {
    let pitch = base.layout.cart.length;
    let mut turns = base.turns(&base.variables);
    let mut best = Candidate::at(problem, goal, pitch, Solution::at(problem, &base.variables));
    let held = base.problem(problem, &turns, &base.variables);
    tell(0, &best);
    take(&mut best, best_of(base, &held, goal, &base.variables, POLISHED, effort));
    let mut seen: BTreeSet<Vec<i64>> = BTreeSet::from([turns.clone()]);
    for _ in 0..ROUNDS {
        let before = best.merit;
        let from = best.clone();
        let mut chosen = turns.clone();
        for neighbour in neighbours(base, problem, &turns) {
            if effort.choices >= CHOICES || !seen.insert(neighbour.clone()) {
                continue;
            }
            let held = base.problem(problem, &neighbour, &base.variables);
            let Some(near) = nearest(&held, &from.solution.variables) else { continue };
            if take(&mut best, best_of(base, &held, goal, &near, 1, effort)) {
                chosen = neighbour;
            }
            tell(effort.choices, &best);
        }
        turns = chosen;
        if best.merit > before * (1.0 - GAIN) {
            break;
        }
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
    let settings = Settings { radius: 0.3, iterations: 40, dearest: 2e3, ..Settings::default() };
    let found = sqp::minimise(&problem, from, &settings, &|_, _, _| {});
    (found.max_violation <= settings.feasibility).then_some(found.variables)
}

/// Turns with one section's heading a step to either side.
fn neighbours(base: &Base, problem: &Problem, turns: &[i64]) -> Vec<Vec<i64>> {
    let n = turns.len();
    let step = base.layout.catalog.curve.angle_step;
    let limits = base.layout.turns.value;
    let within = |turn: i64| turn as f64 * step >= limits.low - 1e-9 && turn as f64 * step <= limits.high + 1e-9;
    let mut out = Vec::new();
    for i in (0..n).filter(|&i| !problem.holds_heading(i)) {
        let j = (i + 1) % n;
        for by in [1, -1] {
            let mut next = turns.to_vec();
            next[i] += by * problem.signs[i] as i64;
            next[j] -= by * problem.signs[j] as i64;
            if within(next[i]) && within(next[j]) {
                out.push(next);
            }
        }
    }
    out
}
