//! What a layout with held turns and radii costs: its curves are a constant, and each straight has the price of its
//! metres and of its pieces, a step function of its length.

use super::Smooth;
use super::base::Base;
use crate::elements::{Part, PriceStep, Space, Steps, pieces, price, sequence};
use crate::geometry::Track;
use crate::model::{Formula, Layout, Target};
use crate::problem::{ConstraintRow, Function, Problem, Waves};

/// A straight this close to a step has its length, m.
const AT: f64 = 1e-7;
/// Kept from the steps beside a straight that is on none, m: more than rows may be violated by.
const INSIDE: f64 = 1e-5;
/// What a EUR over the budget counts, m: as much as all the polygon action of phases left to chance.
const OVER: f64 = 1.0;

/// Prices of straights between held curves, in the merit of a search.
pub struct Price {
    /// `None` where the stock's steps are too many to list: straights then cost so much a metre.
    steps: Option<Steps>,
    /// EUR/m
    metre: f64,
    /// All curves, EUR.
    curves: f64,
    /// What a EUR counts, m.
    worth: f64,
    /// EUR
    limit: f64,
}

impl Price {
    /// Of a layout with these turns; `None` where prices do not count.
    pub fn new(base: &Base, goal: Smooth, waves: &Waves, track: &Track) -> Option<Self> {
        if !goal.weighs_cost() {
            return None;
        }
        let layout = &base.layout;
        let stock = &layout.catalog.straight;
        let steps = Steps::new(stock, track.length);
        let metre = if steps.is_some() { stock.price.per_metre } else { layout.catalog.least_of_a_metre() };
        let worth = goal.cost * waves.worth / goal.action;
        let limit = base.limit.unwrap_or(f64::INFINITY);
        Some(Price { steps, metre, curves: of_curves(layout, track), worth, limit })
    }

    /// The whole track by the lengths of its straights, EUR; infinite where one cannot be made.
    fn all(&self, straights: &[f64]) -> f64 {
        let pieces = |length: f64| self.steps.as_ref().map_or(0.0, |steps| steps.price(length));
        self.curves + straights.iter().map(|length| self.metre * length + pieces(*length)).sum::<f64>()
    }

    /// What the price adds to the merit of a search, m.
    pub fn merit(&self, straights: &[f64]) -> f64 {
        let price = self.all(straights);
        if price.is_infinite() {
            return price;
        }
        self.worth * price + OVER * (price - self.limit).max(0.0)
    }

    /// What a metre of straight adds to it beside its pieces, m.
    pub fn slope(&self) -> f64 {
        self.worth * self.metre
    }

    /// Lengths between two others at which the price of the pieces changes, m.
    pub fn steps(&self, low: f64, high: f64) -> impl Iterator<Item = f64> {
        let points = self.steps.as_ref().map_or(&[][..], |steps| steps.points());
        let from = points.partition_point(|p| p.length <= low);
        points[from..].iter().map(|p| p.length).take_while(move |length| *length < high)
    }

    /// Holds each straight where its pieces cost what they cost now, and the whole within the budget.
    pub fn hold(&self, problem: &mut Problem, straights: &[f64]) {
        let Some(span) = problem.rows.first().map(|row| row.span) else { return };
        let mut row = |function: Function, low: f64, high: f64, label: &str| {
            problem.rows.push(ConstraintRow::hard(function, (low, high), label.to_owned(), span));
        };
        let points = self.steps.as_ref().map_or(&[][..], |steps| steps.points());
        for (k, length) in straights.iter().enumerate().filter(|_| !points.is_empty()) {
            let (low, high) = around(points, *length);
            row(Function::Straight(k), low, high, "the pieces of a straight");
        }
        if self.limit.is_finite() && self.metre > 0.0 {
            let most = straights.iter().sum::<f64>() + (self.limit - self.all(straights)) / self.metre;
            let straight = |from: usize| Formula::Length(Target { from, straight: true });
            let sum = Formula::Sum((0..straights.len()).map(straight).collect());
            row(Function::Formula(sum), f64::NEG_INFINITY, most, "the budget of cost");
        }
    }

    /// Lengths of a straight near this one whose pieces are cheaper, the nearest first.
    pub fn cheaper(&self, length: f64, reach: f64) -> Vec<f64> {
        let Some(steps) = &self.steps else { return Vec::new() };
        let now = steps.price(length);
        let mut found: Vec<f64> =
            self.steps(length - reach, length + reach).filter(|p| steps.price(*p) < now).collect();
        found.sort_by(|a, b| (a - length).abs().total_cmp(&(b - length).abs()));
        found
    }
}

/// Limits within which a straight's pieces keep their price.
fn around(points: &[PriceStep], length: f64) -> (f64, f64) {
    let next = points.partition_point(|p| p.length <= length + AT);
    let Some(last) = next.checked_sub(1).map(|i| points[i]) else { return (length, length) };
    // Where pieces of more lengths cost the same, the straight need not be of this one.
    if (length - last.length).abs() <= AT && last.price < last.after {
        return (last.length, last.length);
    }
    let high = points.get(next).map_or(f64::INFINITY, |p| p.length - INSIDE);
    let low = (last.length + INSIDE).min(high);
    (low.min(length), high.max(length))
}

/// EUR
fn of_curves(layout: &Layout, track: &Track) -> f64 {
    let sequence = sequence(track, layout);
    let (space, _) = Space::new(layout, &sequence);
    let mut all = pieces(&sequence, &space, layout);
    all.retain(|piece| !matches!(piece.part, Part::Straight { .. }));
    price(&all, layout)
}
