//! The cheapest places along the loop, exactly, where only what stands beside each other on one straight may be in each
//! other's way: a dynamic program.
//!
//! Equipment is placed in the order of its middles. What matters of what was placed is how much of each group there is, how
//! far each side of the track is taken, and where the last middle lies. What has no conveyor stands as early as it can:
//! with the order kept, moving it back costs nothing and leaves no less room behind. What has one stands at its
//! earliest place, at a multiple of [`super::program::STEP`] up to where its conveyor is shortest, or there: the conveyor's length is convex
//! along a straight, so that nothing beyond is cheaper.
//!
//! The same program bounds the cost of *any* places from below: a place between two multiples takes the room of the first
//! and costs what the second does ([`Count::Cells`]).

use super::latest::Latest;
use super::program::{Along, Count, Free, LeavesRoom, MOST_OPEN, Program, is_priced};
use super::task::Task;

/// Labels with as many pieces placed, where some places are looked for first.
const MOST_AT_FIRST: usize = 100;

/// The most that fits, and, where that is all of it, the cheapest.
pub fn cheapest(task: &Task, free: &Free) -> Along {
    // Where all of it fits, what leaves no room for the rest needs no look.
    let alone = Latest::alone(task, free);
    let sieve: &LeavesRoom = &|left, label| alone.leaves_room(left, label);
    let mut early = Program::of_room(task, free).leaving_room(sieve).run().best(task);
    if early.lacking() > 0 {
        early = Program::of_room(task, free).run().best(task);
    }
    if early.lacking() > 0 || !(0..task.groups.len()).any(|g| is_priced(task, g)) {
        return early;
    }
    let latest = Latest::together(task, free);
    let leaves_room: &LeavesRoom = &|left, label| latest.as_ref().is_none_or(|latest| latest.leaves_room(left, label));
    // Some places first: what costs more is not looked at again.
    let mut best = early;
    for most in [MOST_AT_FIRST, MOST_OPEN] {
        let program = Program::of_cost(task, free, Count::Places, best.cost, most);
        let better = program.leaving_room(leaves_room).run().best(task);
        best = if better.lacking() == 0 { better } else { Along { whole: better.whole, ..best } };
    }
    best
}

/// What conveyors cost at least wherever all of it stands, EUR, if that is found. `known` is what some places of all of it
/// cost.
pub fn least_cost(task: &Task, free: &Free, known: f64) -> Option<f64> {
    let latest = Latest::together(task, free);
    let leaves_room: &LeavesRoom = &|left, label| latest.as_ref().is_none_or(|latest| latest.leaves_room(left, label));
    let program = Program::of_cost(task, free, Count::Cells, known, MOST_OPEN);
    let least = program.leaving_room(leaves_room).run().best(task);
    // Nothing is cheaper than what is known where no places were found.
    let cost = if least.lacking() > 0 { known } else { least.cost.min(known) };
    least.whole.then_some(cost)
}
