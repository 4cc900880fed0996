//! `optimise polygon_action`: a layout on the catalogue's grid whose curves cancel each other's polygon action (thesis
//! §3.4).
//!
//! Radii stay as written; those of vertices without one are the base's. What is left is to choose the turns on their
//! grid, and then, with turns and radii held, the lengths of the straights:
//!
//! 1. A *base* that meets every constraint: the shortest or cheapest layout where a budget or a sum weighs length or
//!    cost, else the one nearest to what is written, on the grid ([`base`]). It sets how long the track may become and how many carts it
//!    takes.
//! 2. With turns and radii held, each curve is a constant phasor, and straights turn them against each other. Their
//!    landscape has the cart's length as period and a great many minima: it is searched globally in the curves' phases,
//!    over the polytope of the rows linearised at the base, by improving hit-and-run with whole lines searched
//!    ([`search`]).
//! 3. The best of these are solved exactly by sequential quadratic programming, on all rows, and judged by ΔP itself.
//! 4. Neighbouring turns on the grid are tried in the same way, until none of them helps ([`turns`]).
//! 5. What is found is made to close as its chain is measured, where the source asks for it ([`closed`]).
//!
//! The result is a good layout, not a proven best one; [`least_action`] says how good any layout with its curves can
//! be.

mod base;
mod bound;
mod candidate;
mod closed;
mod goal;
mod polytope;
mod price;
mod rival;
mod rows;
mod search;
#[cfg(test)]
mod tests;
mod traded;
mod turns;

pub use bound::least_action;
pub use goal::Smooth;
pub use rival::{Rival, rival};
pub use traded::Traded;

use super::sqp::SqpSettings;
use super::violations::stage;
use super::{Discretise, Options, Progress, Stage, Status, Tell};
use crate::model::Layout;
use crate::problem::{Problem, Scope};
use candidate::Candidate;
use std::time::Instant;

/// What a search took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    /// Choices of turns.
    pub choices: usize,
    /// Evaluations of polygon action from phases.
    pub phases: usize,
    /// Iterations of the quadratic programming.
    pub iterations: usize,
}

/// Solves a layout for an even run. The last stage, `polygon`, is the result; those before are of its base.
pub fn solve(layout: &Layout, goal: Smooth, options: &Options, discretise: Discretise, watch: Tell) -> Vec<Stage> {
    run(layout, goal, options, discretise, watch).0
}

/// The same with what the search took.
pub fn run(
    layout: &Layout,
    goal: Smooth,
    options: &Options,
    discretise: Discretise,
    watch: Tell,
) -> (Vec<Stage>, Effort) {
    let (mut stages, base) = base::base(layout, goal, options, discretise, watch);
    let mut effort = Effort::default();
    let Some(base) = base else { return (stages, effort) };
    let clock = Instant::now();
    let tell = |iteration: usize, at: &Candidate| {
        watch(Progress::Iteration {
            stage: "polygon",
            iteration,
            length: at.solution.length,
            max_violation: at.solution.max_violation,
        });
    };
    let problem = Problem::new(&base.layout, Scope::Obstacles);
    let best = turns::best(&base, &problem, goal, (&mut effort, options.stop), &tell);
    let (best, problem) = closed::closed(&base, goal, &best, &mut effort).unwrap_or((best, problem));
    let mut last = stage("polygon", &problem, &best.solution, &SqpSettings::default(), clock);
    // The budget and the closing are rows of ours: elsewhere the layout's own count.
    let off = super::violations::off_grid(
        &base.layout,
        &problem,
        &best.solution.variables,
        SqpSettings::default().feasibility,
    );
    if !off.is_empty() {
        last.status = Status::Infeasible;
        last.violations.extend(off);
    }
    stages.push(last);
    (stages, effort)
}
