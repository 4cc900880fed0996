//! Finds the vertices of a loop: how many, where, with which turns and radii, from sections that it has to pass.
//!
//! 1. [`round`]: orders of the sections and ways along them.
//! 2. [`bound`]: how short a loop of each can be at best; the best ones are looked at first.
//! 3. [`ways`]: ways from each section to the next around obstacles, and [`loops`] of them, as vertices.
//! 4. Each loop is a [`candidate`] for the stages and for the search over the catalogue's grid, like any written layout.
//! 5. The best one is tried with a vertex less, as long as that helps.

mod bound;
mod candidate;
mod dubins;
mod loops;
mod plane;
mod refuse;
mod round;
mod ways;
mod write;

pub use refuse::refuse;
pub use write::text;

use crate::base::{parallel, trig};
use crate::diagnostic::Diagnostic;
use crate::model::{Goal, Layout};
use crate::solve::{self, Counted, Effort, Options, Progress, Stage, Status, Tell};
use bound::{Bounds, Places};
use loops::{Loop, Maker};
use plane::Plane;
use round::{Round, rounds};
use ways::Tangents;

/// Nodes of the branch and bound of one round, and of all together.
const NODES_OF_ROUND: usize = 300;
const NODES: usize = 20_000;
/// Loops of one round, and of all, that go through the continuous stages.
const LOOPS_OF_ROUND: usize = 6;
const LOOPS: usize = 24;
/// Rounds of which loops are made, and other places that are tried in all.
const ROUNDS: usize = 60;
/// Of these, how many go to the catalogue's grid, with how many nodes each.
const ON_GRID: usize = 4;
const GRID_NODES: usize = 150;
/// Sections that are tried at both ends of their ranges.
const SPREAD: usize = 3;

/// A loop that was found.
#[derive(Clone, Debug)]
pub struct Found {
    /// The layout with vertices.
    pub layout: Layout,
    pub stages: Vec<Stage>,
    pub summary: Summary,
}

/// What the search looked at.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// The sections in driving order.
    pub order: Vec<String>,
    /// Orders and ways along the sections that there are.
    pub rounds: usize,
    /// Loops that were optimised.
    pub tried: usize,
    /// No closed line that passes the sections in an allowed order and way, keeps its distance from building and
    /// obstacles and nowhere bends tighter than the smallest radius is shorter, m.
    pub shortest: f64,
    /// No such loop is worth less, EUR, where cost is optimised: prices, and what metres count beside them.
    pub cheapest: Option<f64>,
    /// What the loop that was found is worth, m or EUR.
    pub value: f64,
}

/// Finds a loop. `Err` says why there is none.
pub fn find(layout: &Layout, options: &Options, watch: Tell) -> Result<Found, Vec<Diagnostic>> {
    let Some(route) = &layout.route else { return Err(Vec::new()) };
    let refused = refuse(layout);
    if !refused.is_empty() {
        return Err(refused);
    }
    let plane = Plane::new(layout);
    let tangents = Tangents::new(&plane);
    let rounds = rounds(route);
    let radius = smallest_radius(layout);
    let is_clear = |a, b| plane.is_clear(a, b);
    let bounds = Bounds::new(&rounds, &tangents, radius, &is_clear);
    let mut best_first: Vec<(f64, usize, Places)> = (0..rounds.len())
        .map(|k| {
            let (bound, places) = bounds.of_round(k, NODES_OF_ROUND);
            (bound, k, places)
        })
        .filter(|(bound, ..)| bound.is_finite())
        .collect();
    best_first.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    if best_first.is_empty() {
        return Err(vec![refuse::no_way(layout, &plane)]);
    }
    let maker = Maker { layout, plane: &plane, radius };
    let search = Search { layout, options, watch, rounds: &rounds };
    let (found, tried) = search.run(&maker, &best_first);
    let Some((layout, mut stages)) = found else {
        return Err(vec![refuse::no_loop(layout, tried)]);
    };
    let length = stages.last().map_or(f64::INFINITY, |s| s.length);
    let order = layout.constraints.iter().filter_map(|c| match &c.kind {
        crate::model::ConstraintKind::Holds { part, .. } => Some(part.name.clone()),
        _ => None,
    });
    let shortest = bounds.of_all(length, NODES);
    let cheapest = cheapest(&layout, radius, shortest);
    if let Some(last) = stages.last_mut() {
        raise(last, shortest, cheapest);
    }
    let (order, value) = (order.collect(), value(&stages));
    let summary = Summary { order, rounds: rounds.len(), tried, shortest, cheapest, value };
    Ok(Found { layout, stages, summary })
}

/// Where the bound of all loops is better than that of loops with these vertices, it holds for the latter, too.
fn raise(stage: &mut Stage, shortest: f64, cheapest: Option<f64>) {
    let Some(certificate) = &mut stage.certificate else { return };
    let bound = if certificate.counted == Counted::Length { Some(shortest) } else { cheapest };
    bound.into_iter().for_each(|bound| certificate.raise(bound, "no curve is tighter than the smallest radius"));
    if certificate.proven && stage.status == Status::BestFound {
        stage.status = Status::Proven;
    }
}

/// What a loop of at least this length is worth at least, EUR, where cost is optimised. A closed line without crossings
/// turns by a full turn or more. Straights cost a metre's price and their share of the longest piece; curves a metre's
/// price, and a piece for each `largest`.
fn cheapest(layout: &Layout, radius: f64, length: f64) -> Option<f64> {
    let weight = |goal: Goal| layout.objective.weight(goal);
    let by_length = weight(Goal::Length).unwrap_or(0.0) / weight(Goal::Cost)?;
    let (straight, curve) = (&layout.catalog.straight, &layout.catalog.curve);
    let longest = straight.stock.iter().copied().chain(straight.cut.map(|cut| cut.high)).fold(0.0, f64::max);
    let share = if longest > 0.0 { straight.price.per_piece / longest } else { 0.0 };
    let metre = straight.price.per_metre + share;
    let more = curve.price.per_metre - metre;
    let turned = trig::TAU * (more * radius + curve.price.per_piece / curve.largest);
    let price = if more >= 0.0 { metre * length + turned } else { metre.min(curve.price.per_metre) * length };
    Some(price + by_length * length)
}

/// m
fn smallest_radius(layout: &Layout) -> f64 {
    let within = |r: &&f64| **r >= layout.radii.value.low - 1e-9;
    layout.catalog.curve.radii.iter().find(within).copied().unwrap_or(layout.radii.value.low)
}

struct Search<'a> {
    layout: &'a Layout,
    options: &'a Options,
    watch: Tell<'a>,
    rounds: &'a [Round],
}

/// A layout with its stages.
type Solved = (Layout, Vec<Stage>);

impl Search<'_> {
    /// The best loop, and how many were optimised. Rounds whose bound is no better than the best layout are left out.
    fn run(&self, maker: &Maker, best_first: &[(f64, usize, Places)]) -> (Option<Solved>, usize) {
        let (mut best, mut tried): (Option<Solved>, usize) = (None, 0);
        let mut elsewhere = ROUNDS;
        let by_length = self.layout.objective.terms.iter().all(|(_, goal)| *goal == Goal::Length);
        for (bound, round, places) in best_first.iter().take(ROUNDS) {
            let known = best.as_ref().map_or(f64::INFINITY, |b| length(&b.1));
            if tried >= LOOPS || (by_length && *bound >= known) || (best.is_some() && self.options.stop.now()) {
                break;
            }
            let round = &self.rounds[*round];
            for (k, places) in std::iter::once(places.clone()).chain(spread(round)).enumerate() {
                if k > 0 {
                    if elsewhere == 0 || tried >= LOOPS {
                        break;
                    }
                    elsewhere -= 1;
                }
                let loops: Vec<Loop> = maker.loops(round, &places, LOOPS_OF_ROUND.min(LOOPS - tried));
                let candidates: Vec<Layout> =
                    loops.iter().filter_map(|made| candidate::layout(self.layout, round, made)).collect();
                tried += candidates.len();
                let found = self.best_of(&candidates, best.as_ref().map(|b| value(&b.1)));
                best = found.or(best);
                if best.is_some() {
                    break;
                }
            }
        }
        while let Some((layout, stages)) = best.take_if(|_| !self.options.stop.now()) {
            let corners = stages.last().map_or(&[][..], |stage| &stage.corners);
            let (round, made) = candidate::back(&layout, corners);
            let fewer: Vec<Layout> = (0..made.corners.len())
                .filter_map(|i| candidate::layout(self.layout, &round, &made.merged(i)?))
                .collect();
            tried += fewer.len();
            let better = self.best_of(&fewer, Some(value(&stages)));
            let done = better.is_none();
            best = better.or(Some((layout, stages)));
            if done {
                break;
            }
        }
        // The best one again, with all the effort that the options allow.
        if let Some((layout, stages)) = best.take() {
            let thorough = solve::solve(&layout, self.options, self.watch);
            let better = reached(&thorough) && value(&thorough) <= value(&stages) + 1e-9;
            best = Some((layout, if better { thorough } else { stages }));
        }
        (best, tried)
    }

    /// The best of some loops on the catalogue's grid, if it is better than what is known.
    fn best_of(&self, candidates: &[Layout], known: Option<f64>) -> Option<Solved> {
        let one = Options { threads: 1, ..*self.options };
        let settled = parallel::map(candidates, self.options.threads, |layout| candidate::settled(layout, one.stop));
        let by_length = self.layout.objective.terms.iter().all(|(_, goal)| *goal == Goal::Length);
        let most = known.filter(|_| by_length).unwrap_or(f64::INFINITY);
        let mut chosen: Vec<(f64, Layout)> = settled.into_iter().flatten().filter(|s| s.0 < most).collect();
        chosen.sort_by(|a, b| a.0.total_cmp(&b.0));
        chosen.truncate(ON_GRID);
        let brief = Options { effort: Effort { nodes: GRID_NODES, ..one.effort }, ..one };
        let solved =
            parallel::map(&chosen, self.options.threads, |(_, layout)| solve::solve(layout, &brief, &|_: Progress| ()));
        let mut best: Option<(f64, usize)> = None;
        for (k, stages) in solved.iter().enumerate().filter(|(_, s)| reached(s)) {
            let value = value(stages);
            if value < best.map_or(known.unwrap_or(f64::INFINITY), |b| b.0) {
                best = Some((value, k));
            }
        }
        best.map(|(_, k)| (chosen[k].1.clone(), solved[k].clone()))
    }
}

/// Places all over the ranges of a round's sections, their middles first: where its bound is the lowest there may be no
/// room to turn, as at the end of a hall.
fn spread(round: &Round) -> impl Iterator<Item = Places> {
    let free: Vec<usize> = (0..round.sections.len()).filter(|&k| round.sections[k].freedom() > 0.0).collect();
    let tries = if free.is_empty() { 0 } else { 1 + (1 << free.len().min(SPREAD)) };
    (0..tries).map(move |number: usize| {
        let place = |k: usize| {
            let bit = free.iter().take(SPREAD).position(|&f| f == k).filter(|_| number > 0);
            let share = bit.map_or(0.5, |bit| 0.25 + 0.5 * ((number - 1) >> bit & 1) as f64);
            let at = share * round.sections[k].freedom();
            (at, at)
        };
        (0..round.sections.len()).map(place).collect()
    })
}

/// Whether a solve came to a layout on the grid.
fn reached(stages: &[Stage]) -> bool {
    stages.last().is_some_and(|s| s.name == "stage3" && s.status != Status::Infeasible)
}

fn length(stages: &[Stage]) -> f64 {
    stages.last().map_or(f64::INFINITY, |s| s.length)
}

/// m, or EUR where cost is optimised.
fn value(stages: &[Stage]) -> f64 {
    stages.last().map_or(f64::INFINITY, |s| s.certificate.as_ref().map_or(s.length, |c| c.value))
}
