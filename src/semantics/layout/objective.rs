//! What is optimised.

use super::draft::{Draft, Placed};
use crate::diagnostic::{Code, Diagnostic};
use crate::model::{Catalog, Goal, Objective};
use crate::semantics::dimension::Dimension;
use crate::semantics::fields::Bounds;
use crate::semantics::scope::Context;
use crate::syntax::tree::{self, Statement};

impl<'t> Context<'t> {
    /// The objective: the length when nothing is said.
    pub(super) fn objective(&self, draft: &Draft<'t>) -> Option<Objective> {
        let Some(placed) = draft.once("optimise") else {
            return Some(Objective { terms: vec![(1.0, Goal::Length)], ..Objective::default() });
        };
        let Placed { statement: Statement::Optimise(written), span, .. } = placed else { return None };
        let all = written.terms.iter().map(|(_, goal, place)| (goal, *place));
        let budget = written.within.iter().map(|(goal, _)| (goal, written.span));
        let total = all.chain(budget).find(|(goal, _)| **goal == tree::Goal::TotalPrice).map(|(_, place)| place);
        if let Some(place) = total {
            if written.terms.len() > 1 || written.within.is_some() || written.terms.iter().any(|(w, ..)| w.is_some()) {
                self.report(
                    Diagnostic::new(Code::E0304, "`total_price` stands alone", place, "beside other goals")
                        .expected("`optimise total_price`, or other goals", "both")
                        .help("`cost` is the price of track, equipment and conveyors: it goes into sums and budgets"),
                );
                return None;
            }
            // A metre's share of the chain and its supports is known with the whole layout.
            let terms = vec![(1.0, Goal::Cost)];
            return Some(Objective { terms, total_price: true, within: None, span: Some(*span) });
        }
        let mut terms: Vec<(f64, Goal)> = Vec::new();
        let mut sound = true;
        for (weight, goal, place) in &written.terms {
            let weight = match weight {
                None => Some(1.0),
                Some(expr) => self
                    .constant(self.plain(placed), expr, Dimension::NONE, "the weight")
                    .and_then(|w| self.within(w, expr.span, "the weight", Dimension::NONE, Bounds::above(0.0, 1e6))),
            };
            match (weight, meant(*goal)) {
                (Some(weight), Some(goal)) => match terms.iter().any(|(_, g)| *g == goal) {
                    true => {
                        self.report(
                            Diagnostic::new(Code::E0213, "a goal is named twice", *place, "named again")
                                .help("add its weights instead"),
                        );
                        sound = false;
                    }
                    false => terms.push((weight, goal)),
                },
                (Some(_), None) if written.terms.len() > 1 || written.within.is_some() => {
                    self.report(
                        Diagnostic::new(Code::E0304, "`nothing` stands alone", *place, "beside other goals")
                            .expected("`optimise nothing`, or goals", "both"),
                    );
                    sound = false;
                }
                (Some(_), None) => {}
                (None, _) => sound = false,
            }
        }
        let within = match &written.within {
            None => None,
            Some((goal, budget)) => {
                let ratio = self.constant(self.plain(placed), budget, Dimension::NONE, "the budget").and_then(|b| {
                    self.within(b, budget.span, "the budget", Dimension::NONE, Bounds::between(0.0, 10.0))
                });
                let goal = meant(*goal);
                if goal.is_none() {
                    self.report(
                        Diagnostic::new(Code::E0304, "`nothing` is no budget", written.span, "within nothing")
                            .expected("`length`, `cost` or `polygon_action`", "`nothing`"),
                    );
                }
                Some((goal?, ratio?))
            }
        };
        sound.then_some(Objective { terms, within, span: Some(*span), ..Objective::default() })
    }

    /// What costs nothing has no cheapest layout.
    pub(super) fn check_prices(&self, objective: &Objective, catalog: &Catalog) {
        let budget = objective.within.map(|(goal, _)| goal);
        let wanted = objective.terms.iter().map(|(_, goal)| *goal).chain(budget).any(|goal| goal == Goal::Cost);
        let free: Vec<&str> = catalog.unpriced().collect();
        let (Some(span), true, Some(first)) = (objective.span, wanted, free.first()) else { return };
        let name = &catalog.name;
        self.report(
            Diagnostic::new(
                Code::E0312,
                format!(
                    "catalogue `{name}` has no prices to \
                                                  minimise"
                ),
                span,
                "of this catalogue",
            )
            .expected("straights and curves that cost something", format!("0 EUR for each {}", free.join(" and ")))
            .related(catalog.span, "the catalogue")
            .help(format!(
                "state them: `catalog priced from {name} {{ {first} {{ piece_price = 60 EUR  metre_price = 210 \
                     EUR/m }} }}`, one line each; or write `optimise length`"
            )),
        );
    }
}

fn meant(goal: tree::Goal) -> Option<Goal> {
    match goal {
        tree::Goal::Length => Some(Goal::Length),
        tree::Goal::Cost => Some(Goal::Cost),
        tree::Goal::PolygonAction => Some(Goal::PolygonAction),
        tree::Goal::Nothing | tree::Goal::TotalPrice => None,
    }
}
