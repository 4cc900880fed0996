//! What the source's objective asks of the chain's smoothness.

use crate::kinematics::polygon::PolygonObjective as Counted;
use crate::model::{Goal, Objective};

/// `optimise polygon_action`, alone, within a budget of length, or summed with length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smooth {
    /// Which values of ΔP count.
    pub counted: Counted,
    /// Weight of polygon action, a mm².
    pub action: f64,
    /// Weight of length, a m; 0 when only polygon action counts.
    pub length: f64,
    /// How much longer than the shortest layout the track may be.
    pub budget: Option<f64>,
}

impl Smooth {
    /// `None` when polygon action is not minimised.
    pub fn of(objective: &Objective) -> Option<Self> {
        let weight = |goal: Goal| objective.terms.iter().find(|(_, g)| *g == goal).map(|(w, _)| *w);
        let action = weight(Goal::PolygonAction)?;
        let budget = objective.within.and_then(|(goal, ratio)| (goal == Goal::Length).then_some(ratio));
        Some(Smooth { counted: Counted::All, action, length: weight(Goal::Length).unwrap_or(0.0), budget })
    }

    /// Whether the solver knows the objective: no price among its goals, and no budget but of length.
    pub fn is_known(objective: &Objective) -> bool {
        let known = |goal: Goal| matches!(goal, Goal::Length | Goal::PolygonAction);
        Smooth::of(objective).is_some()
            && objective.terms.iter().all(|(_, goal)| known(*goal))
            && objective.within.is_none_or(|(goal, _)| goal == Goal::Length)
    }

    /// Whether the shortest layout is the base to start from.
    pub fn weighs_length(self) -> bool {
        self.length > 0.0 || self.budget.is_some()
    }
}
