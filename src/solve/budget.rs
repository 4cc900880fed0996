//! Length or cost within a budget of the other: `optimise cost within length + 1 %`.
//!
//! The budget is counted from the best layout that is found for its own goal. What is over the budget is given a price
//! λ (Lagrange): the least of goal + λ (spent − limit) is a bound for every layout within the budget, whatever λ, and
//! the search over the catalogue's grid gives it. Layouts on both sides of the limit set the next price, as in
//! [`pareto`](super::pareto). Where it is length that is limited, a last search has the limit as a row, as layouts may
//! lie between those that are best for some price.

use super::{Certificate, Counted, Discretise, Options, Stage, Status, Tell, least_price};
use crate::geometry::Track;
use crate::model::{Constraint, ConstraintKind, Formula, Goal, Layout, Objective, Target, Unit};
use crate::solve::stages::solve_in_stages;

/// Prices that are tried, at most.
const MOST: usize = 6;
/// A budget may be exceeded by this share: rounding of sums.
pub const ROUNDING: f64 = 1e-9;

/// How much length (m) and cost (EUR) count in a sum.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Weights {
    cost: f64,
    length: f64,
}

/// A goal within a budget that is solved here.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    goal: Weights,
    limited: Goal,
    ratio: f64,
}

/// A layout with what it measures.
struct Found {
    stages: Vec<Stage>,
    /// m
    length: f64,
    /// EUR
    price: f64,
}

impl Found {
    fn spent(&self, goal: Goal) -> f64 {
        if goal == Goal::Cost { self.price } else { self.length }
    }

    fn value(&self, weights: Weights) -> f64 {
        let of = |weight: f64, amount: f64| if weight > 0.0 { weight * amount } else { 0.0 };
        of(weights.cost, self.price) + of(weights.length, self.length)
    }
}

impl Budget {
    /// `None` where there is no budget, or polygon action is part of it.
    pub fn of(objective: &Objective) -> Option<Self> {
        let (limited, ratio) = objective.within?;
        let weight = |goal: Goal| objective.weight(goal).unwrap_or(0.0);
        let known = limited != Goal::PolygonAction && weight(Goal::PolygonAction) == 0.0;
        let goal = Weights { cost: weight(Goal::Cost), length: weight(Goal::Length) };
        (known && goal.cost + goal.length > 0.0).then_some(Budget { goal, limited, ratio })
    }

    /// The goal with what is limited at a price.
    fn priced(&self, price: f64) -> Weights {
        match self.limited {
            Goal::Cost => Weights { cost: self.goal.cost + price, ..self.goal },
            _ => Weights { length: self.goal.length + price, ..self.goal },
        }
    }

    /// Solves in stages; the last stage has a certificate of the goal within the budget.
    pub fn solve(&self, layout: &Layout, options: &Options, discretise: Discretise, watch: Tell) -> Vec<Stage> {
        let of_all = options.of_all();
        let seek = |layout: &Layout, weights: Weights| {
            let stages = solve_in_stages(&weighted(layout, weights), &of_all, discretise, watch);
            measured(layout, stages)
        };
        let alone = match self.limited {
            Goal::Cost => Weights { cost: 1.0, length: 0.0 },
            _ => Weights { cost: 0.0, length: 1.0 },
        };
        let mut thrifty = match seek(layout, alone) {
            Ok(found) => found,
            Err(stages) => return stages,
        };
        let least = thrifty.spent(self.limited);
        let limit = least * (1.0 + self.ratio);
        let within = |found: &Found| found.spent(self.limited) <= limit * (1.0 + ROUNDING);
        let mut known = Known { bound: f64::NEG_INFINITY, nodes: thrifty.nodes(), assumed: Vec::new() };
        let mut best: Option<Found> = None;
        match seek(layout, self.goal) {
            Ok(found) => {
                known.learn(&found, self.goal, 0.0);
                let mut lavish = found;
                if within(&lavish) {
                    best = Some(lavish);
                } else {
                    for _ in 0..MOST {
                        let (more, saved) = (
                            thrifty.value(self.goal) - lavish.value(self.goal),
                            lavish.spent(self.limited) - thrifty.spent(self.limited),
                        );
                        if more <= ROUNDING * lavish.value(self.goal) || saved <= 0.0 || options.stop.now() {
                            break;
                        }
                        let price = more / saved;
                        let weights = self.priced(price);
                        let Ok(between) = seek(layout, weights) else { break };
                        known.learn(&between, weights, price * limit);
                        let ends = lavish.value(weights);
                        let better = between.value(weights) < ends - ROUNDING * ends.abs();
                        if within(&between) {
                            thrifty = between;
                        } else {
                            lavish = between;
                        }
                        if !better {
                            break;
                        }
                    }
                }
            }
            Err(stages) => return stages,
        }
        let mut kept = best.unwrap_or(thrifty);
        if self.limited == Goal::Length && kept.value(self.goal) > known.bound * (1.0 + ROUNDING) && !options.stop.now()
        {
            let rowed = limited(layout, limit);
            if let Ok(found) = seek(&rowed, self.goal) {
                known.learn(&found, self.goal, 0.0);
                if within(&found) && found.value(self.goal) < kept.value(self.goal) {
                    kept = found;
                }
            }
        }
        let (unit, what) = if self.limited == Goal::Cost { ("EUR", "cheapest") } else { ("m", "shortest") };
        let limit =
            format!("at most {limit:.3} {unit}, counted from the {what} layout that was found, {least:.3} {unit}");
        self.certified(kept, known, limit)
    }

    /// The stages with a certificate of the goal within the budget.
    fn certified(&self, found: Found, known: Known, limit: String) -> Vec<Stage> {
        let value = found.value(self.goal);
        // Certificates count a price as 1.
        let (counted, scale) = match self.goal.cost > 0.0 {
            true => (Counted::Price { metre: self.goal.length / self.goal.cost }, self.goal.cost),
            false => (Counted::Length, self.goal.length),
        };
        let mut stages = found.stages;
        if let Some(last) = stages.last_mut() {
            let seconds = last.certificate.as_ref().map_or(0.0, |c| c.seconds);
            // Converted, a bound is rounded once more.
            let bound = known.bound / scale * (1.0 - 4.0 * f64::EPSILON);
            let certificate = Certificate::new(counted, value / scale, bound, known.nodes, known.assumed);
            last.status = if certificate.proven { Status::Proven } else { Status::BestFound };
            last.certificate = Some(Certificate { seconds, budget: Some(limit), ..certificate });
        }
        stages
    }
}

impl Found {
    fn certificate(&self) -> Option<&Certificate> {
        self.stages.last()?.certificate.as_ref()
    }

    fn nodes(&self) -> usize {
        self.certificate().map_or(0, |c| c.nodes)
    }
}

/// What searches have proven of the goal within the budget.
struct Known {
    /// In the goal's units.
    bound: f64,
    nodes: usize,
    assumed: Vec<String>,
}

impl Known {
    /// What a search for a sum with these weights says, of which a layout at the limit spends `spent` on the limit.
    fn learn(&mut self, found: &Found, weights: Weights, spent: f64) {
        let Some(certificate) = found.certificate() else { return };
        self.nodes += certificate.nodes;
        self.bound = self.bound.max(lower_bound(certificate, weights) - spent);
        for words in &certificate.assumed {
            if !self.assumed.contains(words) {
                self.assumed.push(words.clone());
            }
        }
    }
}

/// What a certificate says of a sum with these weights, in EUR and m.
fn lower_bound(certificate: &Certificate, weights: Weights) -> f64 {
    let scale = if weights.cost > 0.0 { weights.cost } else { weights.length };
    certificate.lower_bound * scale
}

/// The layout with a sum as its objective.
fn weighted(layout: &Layout, weights: Weights) -> Layout {
    let terms = [(weights.cost, Goal::Cost), (weights.length, Goal::Length)];
    let terms = terms.into_iter().filter(|(weight, _)| *weight > 0.0).collect();
    Layout { objective: Objective { terms, span: layout.objective.span, ..Objective::default() }, ..layout.clone() }
}

/// What the last stage measures; the stages where it is none.
fn measured(layout: &Layout, stages: Vec<Stage>) -> Result<Found, Vec<Stage>> {
    let Some(last) = stages.last().filter(|s| s.status != Status::Infeasible && s.name == "stage3") else {
        return Err(stages);
    };
    let track = Track::new(&last.corners);
    let (length, price) = (track.length, least_price(layout, &track));
    Ok(Found { stages, length, price })
}

/// The layout with a row that limits its length, m.
fn limited(layout: &Layout, limit: f64) -> Layout {
    let mut limited = layout.clone();
    let arc = |i: usize| {
        let turn = Formula::Absolute(Box::new(Formula::Angle(i)));
        Formula::Product(vec![Formula::Radius(i), turn])
    };
    let straight = |from: usize| Formula::Length(Target { from, straight: true });
    let n = layout.vertices.len();
    let formula = Formula::Sum((0..n).flat_map(|i| [straight(i), arc(i)]).collect());
    let span = layout.objective.span.unwrap_or(layout.span);
    let kind = ConstraintKind::Require { formula, low: f64::NEG_INFINITY, high: limit, unit: Unit::Metre };
    let reason = Some("the budget of length".to_owned());
    limited.constraints.push(Constraint { kind, span, reason });
    limited
}
