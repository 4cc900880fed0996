//! Length against cost: layouts that no other one beats in both.
//!
//! The ends are the shortest and the cheapest layout. Between two neighbours a metre is counted as many EUR as makes
//! both alike; what is best then lies below the line between them, or there is nothing (Aneja and Nair 1979). Layouts
//! that are best for no price of a metre are not found this way.

use super::{Certificate, Options, Stage, Status, Tell, least_price, solve};
use crate::geometry::Track;
use crate::model::{Goal, Layout, Objective};

/// Most layouts that are sought.
const MOST: usize = 7;
/// Prices that differ by less are alike, EUR: half a cent for each of some pieces.
const ALIKE: f64 = 0.5;
/// Lengths that differ by less are, m.
const AS_LONG: f64 = 1e-5;

/// A layout that is neither longer nor dearer than another.
#[derive(Clone, Debug)]
pub struct Trade {
    /// What a metre counted beside the price, EUR; `None` where only length did.
    pub metre: Option<f64>,
    /// m
    pub length: f64,
    /// Before the price of each piece is rounded to the cent, EUR.
    pub price: f64,
    /// The last one is the layout.
    pub stages: Vec<Stage>,
    /// That no layout is better while a metre counts so much.
    pub certificate: Option<Certificate>,
}

/// Layouts from the shortest to the cheapest; empty where none is feasible. One alone is both.
pub fn pareto(layout: &Layout, options: &Options, watch: Tell) -> Vec<Trade> {
    let seek = |metre: Option<f64>| trade(layout, metre, options, watch);
    let (Some(shortest), Some(cheapest)) = (seek(None), seek(Some(0.0))) else { return Vec::new() };
    let mut sought = 2;
    let mut pairs = vec![(shortest.clone(), cheapest.clone())];
    let mut all = vec![shortest, cheapest];
    // Level by level, so that a limit on their number leaves them spread evenly.
    while !pairs.is_empty() {
        let mut next = Vec::new();
        for (short, cheap) in pairs {
            let (saved, more) = (short.price - cheap.price, cheap.length - short.length);
            if sought == MOST || saved <= ALIKE || more <= AS_LONG {
                continue;
            }
            sought += 1;
            let metre = saved / more;
            let Some(between) = seek(Some(metre)) else { continue };
            let value = |t: &Trade| t.price + metre * t.length;
            if value(&between) < value(&short) - ALIKE {
                next.extend([(short, between.clone()), (between.clone(), cheap)]);
            }
            all.push(between);
        }
        pairs = next;
    }
    undominated(all)
}

/// The objective that counts a metre so much beside the price, or alone.
pub fn objective(layout: &Layout, metre: Option<f64>) -> Objective {
    let terms = match metre {
        None => vec![(1.0, Goal::Length)],
        Some(0.0) => vec![(1.0, Goal::Cost)],
        Some(metre) => vec![(1.0, Goal::Cost), (metre, Goal::Length)],
    };
    Objective { terms, span: layout.objective.span, ..Objective::default() }
}

fn trade(layout: &Layout, metre: Option<f64>, options: &Options, watch: Tell) -> Option<Trade> {
    let mut layout = layout.clone();
    layout.objective = objective(&layout, metre);
    let stages = solve(&layout, options, watch);
    let last = stages.last().filter(|s| s.status != Status::Infeasible)?;
    let track = Track::new(&last.corners);
    let price = least_price(&layout, &track);
    let certificate = last.certificate.clone();
    price.is_finite().then_some(Trade { metre, length: track.length, price, certificate, stages })
}

/// By length, without what another one is as good as in both.
fn undominated(mut all: Vec<Trade>) -> Vec<Trade> {
    all.sort_by(|a, b| a.length.total_cmp(&b.length).then(a.price.total_cmp(&b.price)));
    let mut kept: Vec<Trade> = Vec::new();
    for trade in all {
        match kept.last_mut() {
            Some(last) if trade.price >= last.price - ALIKE => {}
            // As long, and cheaper.
            Some(last) if trade.length <= last.length + AS_LONG => *last = trade,
            _ => kept.push(trade),
        }
    }
    kept
}
