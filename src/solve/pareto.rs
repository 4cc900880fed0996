//! Layouts that trade length, cost, the price of all that is ordered, and polygon action.
//!
//! The ends are the best layouts of each goal alone. Length, cost and total price are one family, cost with a metre counted
//! as so many EUR. Between two neighbours in it a metre is counted as many EUR as makes both alike; what is best then lies
//! below the line between them, or there is nothing (Aneja and Nair 1979). Layouts that are best for no price of a metre are
//! not found this way. Polygon action has a great many minima and is no sum's best: it is sought within budgets of length
//! and of cost (the ε-constraint method, Haimes, Lasdon and Wismer 1971).

use super::{Certificate, Options, Stage, Status, Tell, least_price, solve};
use crate::base::parallel;
use crate::geometry::Track;
use crate::model::{Goal, Layout, Objective};
use crate::placement;

/// Most layouts that are sought for each pair of ends of the family, the ends among them.
const MOST: usize = 7;
/// Prices that differ by less are alike, EUR: half a cent for each of some pieces.
const ALIKE: f64 = 0.5;
/// Lengths that differ by less are, m.
const AS_LONG: f64 = 1e-5;
/// By how much a layout of less polygon action may be longer or dearer than the least, as ratios.
const BUDGETS: [f64; 5] = [0.001, 0.002, 0.005, 0.01, 0.02];
/// Digits that a metre's price is rounded to, so that its line may be written.
const DIGITS: i32 = 6;

/// What the layouts at an end are best in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    Length,
    Cost,
    TotalPrice,
    PolygonAction,
}

/// A layout of the trade.
#[derive(Clone, Debug)]
pub struct Trade {
    /// What it is the best of, as far as is known.
    pub objective: Objective,
    /// Whose radii and vertices it began with and whose radii it keeps, instead of those that are written.
    pub radii: Option<End>,
    /// m
    pub length: f64,
    /// Of track, equipment and conveyors before the price of each piece is rounded to the cent, EUR.
    pub price: f64,
    /// The last one is the layout.
    pub stages: Vec<Stage>,
    /// What is proven of its objective.
    pub certificate: Option<Certificate>,
}

/// All layouts that were found, those of `ends` first; empty where none is feasible. Some of them may beat others. Of `alone`
/// the best is sought, too, for what is proven of it, and nothing between it and others.
///
/// `ends` has each end once, and none of `alone`.
pub fn pareto(layout: &Layout, ends: &[End], alone: &[End], options: &Options, watch: Tell) -> Vec<Trade> {
    let seek = |objective: Objective| trade(layout, objective, options, watch);
    let mut family: Vec<End> = ends.iter().copied().filter(|end| *end != End::PolygonAction).collect();
    // From the shortest to the cheapest.
    family.sort_by_key(|end| [End::Length, End::TotalPrice, End::Cost].iter().position(|other| other == end));
    let found: Option<Vec<Trade>> = family.iter().map(|end| seek(objective(layout, *end))).collect();
    let Some(mut all) = found else { return Vec::new() };
    let pairs: Vec<(Trade, Trade)> = all.windows(2).map(|pair| (pair[0].clone(), pair[1].clone())).collect();
    for pair in pairs {
        all.extend(between(layout, pair, &seek, options));
    }
    if ends.contains(&End::PolygonAction) {
        all.extend(even(layout, &family, &all, options, watch));
    }
    all.extend(alone.iter().filter_map(|end| seek(objective(layout, *end))));
    all
}

/// Layouts of little polygon action, which keep the written radii or those of an end of the family: the first layouts of
/// `found`.
fn even(layout: &Layout, family: &[End], found: &[Trade], options: &Options, watch: Tell) -> Vec<Trade> {
    let ends = || family.iter().copied().zip(found);
    let mut sought: Vec<(Goal, Option<End>, Layout)> = Vec::new();
    let counts_cost = |end: End| end != End::Length;
    for (asked, limited) in [
        (family.is_empty() || family.contains(&End::Length), Goal::Length),
        (family.iter().any(|end| counts_cost(*end)), Goal::Cost),
    ] {
        let own = ends().filter(|(end, _)| asked && counts_cost(*end) == (limited == Goal::Cost));
        sought.extend(asked.then(|| (limited, None, layout.clone())));
        sought.extend(own.map(|(end, trade)| (limited, Some(end), moved(layout, trade))));
    }
    let mut tasks: Vec<(Objective, Option<End>, &Layout)> = Vec::new();
    for (limited, radii, layout) in &sought {
        tasks.extend(BUDGETS.iter().map(|ratio| (smooth(layout, *limited, *ratio), *radii, layout)));
    }
    // Near what is written, and that itself.
    tasks.push((objective(layout, End::PolygonAction), None, layout));
    tasks.push((written(layout, Vec::new()), None, layout));
    let found = parallel::map(&tasks, options.threads, |(objective, radii, layout)| {
        let found = (!options.stop.now()).then(|| trade(layout, objective.clone(), options, watch)).flatten();
        found.map(|trade| Trade { radii: *radii, ..trade })
    });
    found.into_iter().flatten().collect()
}

/// The layout with its vertices and radii where a track has them.
fn moved(layout: &Layout, trade: &Trade) -> Layout {
    let mut moved = layout.clone();
    let corners = trade.stages.last().map_or_else(Vec::new, |last| last.corners.clone());
    for (vertex, corner) in moved.vertices.iter_mut().zip(corners) {
        vertex.point = corner.point;
        vertex.radius.value = corner.radius;
    }
    moved
}

/// Layouts between two of the family, the first of which is the shorter one.
fn between(
    layout: &Layout,
    ends: (Trade, Trade),
    seek: &dyn Fn(Objective) -> Option<Trade>,
    options: &Options,
) -> Vec<Trade> {
    let (mut all, mut sought, mut pairs) = (Vec::new(), 2, vec![ends]);
    // Level by level, so that a limit on their number leaves them spread evenly.
    while !pairs.is_empty() {
        let mut next = Vec::new();
        for (short, cheap) in pairs {
            let (saved, more) = (short.price - cheap.price, cheap.length - short.length);
            if sought == MOST || saved <= ALIKE || more <= AS_LONG || options.stop.now() {
                continue;
            }
            sought += 1;
            let metre = rounded(saved / more);
            let Some(between) = seek(counted(layout, metre)) else { continue };
            let value = |t: &Trade| t.price + metre * t.length;
            if value(&between) < value(&short).min(value(&cheap)) - ALIKE {
                next.extend([(short, between.clone()), (between.clone(), cheap)]);
            }
            all.push(between);
        }
        pairs = next;
    }
    all
}

/// To so many digits.
fn rounded(value: f64) -> f64 {
    format!("{value:.*e}", DIGITS as usize - 1).parse().unwrap_or(value)
}

/// What is minimised at an end; polygon action alone stays near what is written.
pub fn objective(layout: &Layout, end: End) -> Objective {
    let alone = |goal: Goal| written(layout, vec![(1.0, goal)]);
    match end {
        End::Length => alone(Goal::Length),
        End::Cost => alone(Goal::Cost),
        End::PolygonAction => alone(Goal::PolygonAction),
        End::TotalPrice => {
            let mut layout = layout.clone();
            layout.objective = Objective { total_price: true, ..alone(Goal::Cost) };
            layout.count_total_price();
            layout.objective
        }
    }
}

/// Cost, with so many EUR for each metre.
fn counted(layout: &Layout, metre: f64) -> Objective {
    written(layout, vec![(1.0, Goal::Cost), (metre, Goal::Length)])
}

/// The least polygon action within a budget.
fn smooth(layout: &Layout, limited: Goal, ratio: f64) -> Objective {
    Objective { within: Some((limited, ratio)), ..written(layout, vec![(1.0, Goal::PolygonAction)]) }
}

fn written(layout: &Layout, terms: Vec<(f64, Goal)>) -> Objective {
    Objective { terms, span: layout.objective.span, ..Objective::default() }
}

fn trade(layout: &Layout, objective: Objective, options: &Options, watch: Tell) -> Option<Trade> {
    let layout = Layout { objective, ..layout.clone() };
    let stages = solve(&layout, options, watch);
    let last = stages.last().filter(|s| s.status != Status::Infeasible)?;
    let track = Track::new(&last.corners);
    let price = least_price(&layout, &track) + placement::place(&layout, &track).price();
    let certificate = last.certificate.clone();
    let found = Trade { objective: layout.objective, radii: None, length: track.length, price, certificate, stages };
    price.is_finite().then_some(found)
}
