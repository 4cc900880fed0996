//! A chain that closes as it is measured. The row of the search takes the series of what each curve cuts off alone. Curves
//! near each other, and those shorter than a cart, cut off tenths of a millimetre more or less: what is found is solved
//! again, with the row moved by what the joints on the track say.

use super::base::Base;
use super::candidate::{Candidate, polished};
use super::{Effort, Smooth, rows};
use crate::geometry::Track;
use crate::kinematics::{Fit, fit, level};
use crate::problem::measures::to_corners;
use crate::problem::{Problem, Scope};

/// How often the row is moved.
const ROUNDS: usize = 6;

/// The nearest layout whose chain closes to the width that the source asks for, with the problem that it meets; `None` where
/// none is asked for, where the chain closes already, and where none is found.
pub fn closed(base: &Base, goal: Smooth, found: &Candidate, effort: &mut Effort) -> Option<(Candidate, Problem)> {
    let (within, span) = base.layout.chain.closes_within.as_ref().map(|own| (own.value, own.span))?;
    let pitch = base.layout.cart.length;
    let turns = base.turns(&found.solution.variables);
    let mut measured = laid(found, pitch)?;
    if measured.is_within(within) {
        return None;
    }
    let mut at = found.clone();
    let mut layout = base.layout.clone();
    for _ in 0..ROUNDS {
        let carts = measured.carts as f64;
        let beyond = measured.left_over + carts * pitch - rows::path(&at.solution.variables, pitch);
        layout.constraints[base.closing] = rows::closing(&base.layout, carts, (within, beyond), span);
        let problem = Problem::new(&layout, Scope::Obstacles);
        let held = base.problem(&problem, &turns, &base.variables);
        at = polished(base, &held, goal, &at.solution.variables, effort)?;
        measured = laid(&at, pitch)?;
        if at.merit.is_finite() && measured.is_within(within) {
            return Some((at, problem));
        }
    }
    None
}

/// The chain on a layout's track.
fn laid(candidate: &Candidate, pitch: f64) -> Option<Fit> {
    fit(&level(&Track::new(&to_corners(&candidate.solution.variables))), pitch)
}
