//! Which method solves a layout's goal: polygon action and budgets have their own, on top of the stages that all others
//! go through.

use super::budget::Budget;
use super::options::{Discretise, Options, Tell};
use super::{Stage, exact, polygon, stages};
use crate::model::Layout;

/// Solves a layout's track in stages; the last one returned is the result. A stage that finds no feasible layout is the
/// last. A layout without vertices has no stages: `route::find` gives it vertices.
pub fn solve(layout: &Layout, options: &Options, watch: Tell) -> Vec<Stage> {
    solve_with(layout, options, exact::discretise, watch)
}

/// The same with a discretisation of the caller's choice.
pub fn solve_with(layout: &Layout, options: &Options, discretise: Discretise, watch: Tell) -> Vec<Stage> {
    if layout.vertices.is_empty() {
        return Vec::new();
    }
    let objective = &layout.objective;
    // Of these the price is that of the track: conveyors follow from where equipment is placed on it.
    let mut alone = layout.clone();
    alone.equipment.declared.iter_mut().for_each(|declared| declared.fed = None);
    let mut stages = if let Some(budget) = Budget::of(objective) {
        budget.solve(&alone, options, discretise, watch)
    } else if let Some(traded) = polygon::Traded::of(objective) {
        traded.solve(&alone, options, discretise, watch)
    } else if let Some(goal) = polygon::Smooth::of(objective) {
        polygon::solve(&alone, goal, options, discretise, watch)
    } else {
        return stages::solve_in_stages(layout, options, discretise, watch);
    };
    if let Some(last) = stages.last_mut() {
        last.cut = options.stop.cut();
    }
    stages
}
