//! The thesis' way, for comparison: Box's complex method on the same base, limits and rows, with turns free between
//! theirs.

use super::base::base;
use super::candidate::{Candidate, waves};
use super::{Discretise, Options, Smooth};
use crate::model::{Interval, Layout};
use crate::problem::measures::{radius, x, y};
use crate::problem::{Problem, Scope};
use crate::solve::complex::{self, Draw};
use crate::solve::sqp::SqpSettings;

/// Where a repetition ended.
#[derive(Clone, Debug)]
pub struct Rival {
    /// Σ ΔP² of what counts, mm²; infinite where rows are violated.
    pub value: f64,
    /// Evaluations of polygon action.
    pub evaluations: usize,
    /// m or rad
    pub max_violation: f64,
    /// m
    pub length: f64,
}

/// Evaluations of a repetition.
const EVALUATIONS: usize = 5000;
/// Violations that a penalty method may leave, m and rad.
const TOLERANCE: f64 = 1e-3;

/// One repetition. Turns need not be on the grid, which makes its problem the easier one. `None` when there is no base.
pub fn rival(layout: &Layout, goal: Smooth, options: &Options, discretise: Discretise, seed: u64) -> Option<Rival> {
    let base = base(layout, goal, options, discretise, &|_| ()).1?;
    let mut problem = Problem::new(&base.layout, Scope::Obstacles);
    for i in 0..problem.vertices.len() {
        let held = base.variables[radius(i)];
        problem.bounds[radius(i)] = Interval { low: held, high: held };
        for k in [x(i), y(i)] {
            let (bound, at) = (problem.bounds[k], base.variables[k]);
            if bound.low < bound.high {
                let (low, high) = (bound.low.max(at - base.reach), bound.high.min(at + base.reach));
                problem.bounds[k] = Interval { low, high };
            }
        }
    }
    let pitch = layout.cart.length;
    let of_curves = |at: &crate::problem::Evaluation| {
        let variables = crate::problem::measures::to_variables(&at.track.corners);
        let straights: Vec<f64> = (0..at.track.fillets.len()).map(|k| at.track.straight(k).length).collect();
        waves(&variables, goal, pitch).map_or(f64::INFINITY, |w| w.value(&straights) * goal.action)
    };
    let settings = SqpSettings::default();
    let found = complex::minimise_of(
        &problem,
        &base.variables,
        &settings,
        Draw { seed, most: EVALUATIONS },
        &of_curves,
        &|_, _, _| {},
    );
    let (evaluations, max_violation) = (found.iterations, found.max_violation);
    // Judged as ours is, but for the looser tolerance.
    let judged = Candidate::judged(&base, &problem, goal, found, TOLERANCE);
    Some(Rival { value: judged.merit / goal.action, evaluations, max_violation, length: judged.solution.length })
}
