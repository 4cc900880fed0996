//! `optimise length within polygon_action + 1 %`: length, cost or their sum, with polygon action limited to a ratio
//! over that of the layout that `optimise polygon_action` finds.
//!
//! As in [budgets](crate::solve::budget), what is over the limit is given a price. Layouts on both sides of the limit
//! set the next price, and the best that keeps to the limit is the result: a good layout, not a proven one.

use super::Smooth;
use crate::geometry::Track;
use crate::kinematics::polygon::{Course, PolygonObjective, action};
use crate::model::{Goal, Layout, Objective};
use crate::solve::budget::ROUNDING;
use crate::solve::stages::solve_in_stages;
use crate::solve::{Discretise, Options, Stage, Status, Tell, least_price};

/// Prices that are tried, at most.
const MOST: usize = 6;

/// A goal within a limit of polygon action.
#[derive(Clone, Debug, PartialEq)]
pub struct Traded {
    /// Length and cost with their weights.
    terms: Vec<(f64, Goal)>,
    ratio: f64,
}

/// A layout with what it measures.
struct Found {
    stages: Vec<Stage>,
    /// What is optimised, m and EUR by their weights.
    value: f64,
    /// mm²
    action: f64,
}

impl Traded {
    /// `None` where polygon action is no limit, or is also a goal.
    pub fn of(objective: &Objective) -> Option<Self> {
        let (limited, ratio) = objective.within?;
        let known = limited == Goal::PolygonAction && !objective.terms.is_empty();
        let sound = objective.terms.iter().all(|(_, goal)| *goal != Goal::PolygonAction);
        (known && sound).then(|| Traded { terms: objective.terms.clone(), ratio })
    }

    /// Solves in stages.
    pub fn solve(&self, layout: &Layout, options: &Options, discretise: Discretise, watch: Tell) -> Vec<Stage> {
        let span = layout.objective.span;
        let seek = |terms: Vec<(f64, Goal)>| {
            let objective = Objective { terms, span, ..Objective::default() };
            let smooth = Smooth::of(&objective);
            let layout = Layout { objective, ..layout.clone() };
            let stages = match smooth {
                Some(goal) => super::solve(&layout, goal, options, discretise, watch),
                None => solve_in_stages(&layout, options, discretise, watch),
            };
            self.measured(&layout, stages)
        };
        let mut smooth = match seek(vec![(1.0, Goal::PolygonAction)]) {
            Ok(found) => found,
            Err(stages) => return stages,
        };
        let limit = smooth.action * (1.0 + self.ratio) * (1.0 + ROUNDING);
        let mut best = match seek(self.terms.clone()) {
            Ok(found) => found,
            Err(stages) => return stages,
        };
        if best.action <= limit {
            return best.stages;
        }
        for _ in 0..MOST {
            let (more, saved) = (smooth.value - best.value, best.action - smooth.action);
            if more <= ROUNDING * best.value.abs() || saved <= 0.0 || options.stop.now() {
                break;
            }
            let price = more / saved;
            if !price.is_finite() {
                break;
            }
            let sum = self.terms.iter().copied().chain([(price, Goal::PolygonAction)]).collect();
            let Ok(between) = seek(sum) else { break };
            let weighed = |found: &Found| found.value + price * found.action;
            let better = weighed(&between) < weighed(&smooth) * (1.0 - ROUNDING);
            let within = between.action <= limit;
            if within && between.value < smooth.value {
                smooth = between;
            } else if !within && between.action < best.action {
                best = between;
            }
            if !better {
                break;
            }
        }
        smooth.stages
    }

    /// What the last stage measures; the stages where it is none.
    fn measured(&self, layout: &Layout, stages: Vec<Stage>) -> Result<Found, Vec<Stage>> {
        let Some(last) = stages.last().filter(|s| s.status != Status::Infeasible) else { return Err(stages) };
        let track = Track::new(&last.corners);
        let action = Course::of_track(&track).and_then(|course| action(&course, layout.cart.length));
        let Ok(action) = action else { return Err(stages) };
        let of = |goal: Goal| if goal == Goal::Cost { least_price(layout, &track) } else { track.length };
        let value = self.terms.iter().map(|(weight, goal)| weight * of(*goal)).sum();
        Ok(Found { stages, value, action: 1e6 * action.value(PolygonObjective::All) })
    }
}
