//! The cheapest places along the loop, exactly, where only what stands beside each other on one straight may be in each
//! other's way: a dynamic program.
//!
//! Equipment is placed in the order of its middles. What matters of what was placed is how much of each group there is, how
//! far each side of the track is taken, and where the last middle lies. What has no conveyor stands as early as it can:
//! with the order kept, moving it back costs nothing and leaves no less room behind. What has one stands at its
//! earliest place, at a multiple of [`STEP`](super::program::STEP) up to where its conveyor is shortest, or there: the
//! conveyor's length is convex along a straight, so that nothing beyond is cheaper.
//!
//! The same program bounds the cost of *any* places from below: a place between two multiples takes the room of the first
//! and costs what the second does ([`Count::Cells`]).

use super::latest::Latest;
use super::program::{Along, Count, Free, LeavesRoom, MOST_OPEN, Program};
use super::task::Task;

/// Labels with as many pieces placed, where some places are looked for first.
const MOST_AT_FIRST: usize = 100;

/// The most that fits, and, where that is all of it, the cheapest; with what conveyors cost at least wherever all of it
/// stands, EUR, if that is found.
pub fn cheapest(task: &Task, free: &Free) -> (Along, Option<f64>) {
    // Where all of it fits, what leaves no room for the rest needs no look.
    let alone = Latest::alone(task, free);
    let sieve: &LeavesRoom = &|left, label| alone.leaves_room(left, label);
    let mut early = Program::of_room(task, free).leaving_room(sieve).run().best(task);
    if early.lacking() > 0 {
        early = Program::of_room(task, free).run().best(task);
    }
    if early.lacking() > 0 || task.groups.iter().all(|group| group.priced_from.is_none()) {
        return (early, None);
    }
    let latest = Latest::together(task, free);
    let leaves_room: &LeavesRoom = &|left, label| latest.as_ref().is_none_or(|latest| latest.leaves_room(left, label));
    let below = |count: Count, known: f64, most: usize| {
        Program::of_cost(task, free, count, known, most).leaving_room(leaves_room).run().best(task)
    };
    // Some places first: what costs more is not looked at again.
    let mut best = early;
    for most in [MOST_AT_FIRST, MOST_OPEN] {
        let better = below(Count::Places, best.cost, most);
        best = if better.lacking() == 0 { better } else { Along { whole: better.whole, ..best } };
    }
    let least = below(Count::Cells, best.cost, MOST_OPEN);
    // Nothing is cheaper than what was found where no cells are.
    let cost = if least.lacking() > 0 { best.cost } else { least.cost.min(best.cost) };
    (best, least.whole.then_some(cost))
}
