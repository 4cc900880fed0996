//! What the source's objective asks of the chain's smoothness.

use crate::kinematics::polygon::PolygonObjective as Counted;
use crate::model::{Goal, Objective};

/// `optimise polygon_action`, alone, within a budget of length or cost, or summed with them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smooth {
    /// Which values of ΔP count.
    pub counted: Counted,
    /// Weight of polygon action, a mm².
    pub action: f64,
    /// Weight of length, a m; 0 when it does not count.
    pub length: f64,
    /// Weight of the price of the pieces, a EUR; 0 when it does not count.
    pub cost: f64,
    /// Length or cost, and by how much it may exceed that of the shortest or cheapest layout, as a ratio.
    pub budget: Option<(Goal, f64)>,
}

impl Smooth {
    /// `None` when polygon action is not minimised.
    pub fn of(objective: &Objective) -> Option<Self> {
        let action = objective.weight(Goal::PolygonAction)?;
        let of = |goal: Goal| objective.weight(goal).unwrap_or(0.0);
        let (length, cost) = (of(Goal::Length), of(Goal::Cost));
        Some(Smooth { counted: Counted::All, action, length, cost, budget: objective.within })
    }

    /// Whether the solver knows the objective: a goal is no budget of itself.
    pub fn is_known(objective: &Objective) -> bool {
        Smooth::of(objective).is_some_and(|goal| goal.budget.is_none_or(|(limited, _)| limited != Goal::PolygonAction))
    }

    /// The goal whose best layout is the base to start from; `None` where polygon action alone counts, which stays near
    /// what is written.
    pub fn base(self, written: &Objective) -> Option<Objective> {
        let sum =
            [(self.cost, Goal::Cost), (self.length, Goal::Length)].into_iter().filter(|(weight, _)| *weight > 0.0);
        let terms: Vec<(f64, Goal)> = match self.budget {
            Some((limited, _)) => vec![(1.0, limited)],
            None => sum.collect(),
        };
        (!terms.is_empty()).then_some(Objective { terms, span: written.span, ..Objective::default() })
    }

    /// Whether prices matter.
    pub fn weighs_cost(self) -> bool {
        self.cost > 0.0 || self.budget.is_some_and(|(limited, _)| limited == Goal::Cost)
    }
}
