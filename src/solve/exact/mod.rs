//! Stage 3 with a proof: branch and bound over turns on the angle step and radii on the catalogue's list.
//!
//! With headings chosen, length, closure and nearly every other row are linear in straights and radii, and sums over
//! sections and vertices. So the Lagrangian dual of a choice of open headings is a shortest path through them
//! ([`network`]); its best multipliers come from column generation ([`master`]); a search branches on headings, radii
//! and on the ways past regions ([`search`], [`beside`]); chains between fixed sections are searched apart ([`parts`]).
//! Regions may be relaxed in a bound, never in a layout: that meets every row of its [`Problem`].

mod alternative;
mod apart;
mod beside;
mod choice;
mod class;
mod closes;
mod conveyors;
mod cut;
mod enclosing;
mod found;
mod grid;
mod master;
mod network;
mod node;
mod offset;
mod open;
mod parts;
mod row;
mod search;
mod sections;
mod tariff;
mod told;
mod touched;

pub use class::{of_class, suffices};
pub use closes::Closes;
pub use conveyors::Conveyors;
pub use tariff::{least_price, worth};

use super::options::Discretised;
use super::sqp::{Solution, SqpSettings};
use super::{Certificate, Counted, Stop, Violation, discrete};
use crate::geometry::{Point, bounds};
use crate::model::Layout;
use crate::problem::Problem;
use crate::solve::options::{Effort, Tell};
use beside::Beside;
use closes::Polish;
use enclosing::Enclosing;
use found::Found;
use grid::{Grid, NoGrid, track};
use network::Limits;
use open::{Open, place};
use row::Stated;
use search::{FEASIBLE, Setting, Value};
use std::cell::RefCell;
use std::time::Instant;
use tariff::{Aim, Detail, Tariff};
use told::Told;

/// The shortest or cheapest layout on the catalogue's grid, from the saw-tooth's. What is found is proven, or says how
/// far it may be from the best.
pub fn discretise(
    layout: &Layout,
    problem: &Problem,
    start: &Solution,
    settings: &SqpSettings,
    effort: &Effort,
    watch: Tell,
) -> Discretised {
    let effort = &effort.of(layout.vertices.len());
    let rough = discrete::discretise(layout, problem, start, settings);
    let clock = Instant::now();
    let grid = match Grid::new(layout, problem, &rough.variables, 0.0) {
        Ok(grid) => grid,
        Err(why) => return Discretised { refused: refusal(problem, &why), refuted: true, ..rough.into() },
    };
    let polish = |x: &[f64], straights: Option<f64>| {
        let held = discrete::hold(layout, problem, settings, x, straights)?;
        sound(problem, &held.variables).then_some(held.variables)
    };
    let aim = Aim::of(layout);
    let unit = if aim == Aim::Length { "m" } else { "EUR" };
    let task = Task {
        layout,
        problem,
        effort: *effort,
        stop: settings.stop,
        polish: &polish,
        aim,
        conveyors: Conveyors::new(layout, &track(&problem.start)),
        cheapest: RefCell::new(None),
        told: Told::new(watch, effort.nodes, (tariff::unit(layout, aim), unit)),
    };
    let fits = place(&grid, &rough.variables).is_some() && sound(problem, &rough.variables);
    let incumbent = fits.then(|| (rough.variables.clone(), task.worth(&rough.variables))).filter(|i| i.1.is_finite());
    let mut assumed = vec!["turns go the way they are written, and as often around".to_owned()];
    if !problem.keepouts.is_empty() {
        let beside = "every straight and curve passes an obstacle on its side, but where another strand runs between \
                      them in the written or the built layout";
        assumed.push(beside.to_owned());
    }
    let near = incumbent.as_ref().filter(|(x, _)| suffices(layout, problem, x, effort)).cloned();
    let mut found = match (near, aim) {
        // The bound of its class is told of the layout that is built in the end.
        (Some((x, value)), _) => Found { variables: Some(x), value, bound: 0.0, nodes: 0, parts: Vec::new() },
        (None, Aim::Length) => task.search(&grid, incumbent, (Detail::Envelope, true), *effort),
        (None, Aim::Price { .. }) => task.cheapest(&grid, incumbent),
    };
    if let Some(closes) = Closes::new(layout) {
        found = match aim {
            Aim::Length => task.closing(&grid, found, closes),
            Aim::Price { .. } => task.closing_cheaply(&grid, found, closes),
        };
        assumed.push(match layout.levels.is_empty() {
            true => {
                "what curves near each other cut off in common is as its series says, within (c/R)² of it".to_owned()
            }
            false => {
                "with turns and radii chosen, no length closes between one and the next that was found to".to_owned()
            }
        });
    }
    let Some(variables) = found.variables else {
        // Nothing was put aside undecided, and the grid lies as it must.
        let refuted = found.bound == f64::INFINITY && (grid.held || offset::turns_freely(problem));
        return Discretised { refuted, ..rough.into() };
    };
    let counted = match aim {
        Aim::Length => Counted::Length,
        Aim::Price { metre } => Counted::Price { metre },
    };
    let unit = tariff::unit(layout, aim);
    // Converted to EUR, a bound is rounded once more.
    let bound = if aim == Aim::Length { found.bound } else { found.bound * unit * (1.0 - 4.0 * f64::EPSILON) };
    let mut certificate = Certificate::new(counted, found.value * unit, bound, found.nodes, assumed);
    if let Some(closes) = Closes::new(layout) {
        // What a chain leaves over is the mean over its phases, which curves together change by so much.
        let known = closes.coupling(&track(&variables));
        certificate = certificate.held_to(HELD * known * unit * tariff::least_rate(layout, aim));
    }
    let name = |stage: usize| layout.vertices[grid.vertex(stage % grid.len())].name.as_str();
    certificate.parts = certificate.of_chains(found.parts.iter().map(|chain| {
        let chain_name = format!("{}..{}", name(chain.from), name(chain.to));
        (chain_name, chain.gap * unit, chain.nodes)
    }));
    certificate.seconds = clock.elapsed().as_secs_f64();
    let at = problem.evaluate(&variables, 0.0);
    let solution = Solution {
        length: at.length,
        max_violation: at.rows.iter().map(|r| r.violation()).fold(0.0, f64::max),
        variables,
        iterations: rough.iterations,
        converged: rough.converged || certificate.proven,
        multipliers: rough.multipliers,
    };
    Discretised { solution, certificate: Some(certificate), refused: Vec::new(), refuted: false }
}

/// What all searches of one layout share.
struct Task<'a> {
    layout: &'a Layout,
    problem: &'a Problem,
    effort: Effort,
    stop: Stop,
    polish: &'a Polish<'a>,
    aim: Aim,
    conveyors: Conveyors,
    /// The cheapest layout that any search came by, with what it is worth.
    cheapest: RefCell<Option<(Vec<f64>, f64)>>,
    told: Told<'a>,
}

impl Task<'_> {
    /// What a layout is worth: its length, m, or its price in units.
    fn worth(&self, x: &[f64]) -> f64 {
        match self.aim {
            Aim::Length => self.problem.evaluate(x, 0.0).length,
            Aim::Price { metre } => {
                let track = track(x);
                let price = worth(self.layout, &track, metre) + self.conveyors.price(&track);
                price / tariff::unit(self.layout, self.aim)
            }
        }
    }

    /// What a search takes a layout to be worth; the cheapest is remembered.
    fn value(&self, tariff: &Tariff, grid: &Grid, x: &[f64]) -> f64 {
        if self.aim == Aim::Length {
            return self.worth(x);
        }
        let worth = self.remember(x);
        // Climbs cost more than a tariff says of them.
        match self.layout.is_flat() {
            true => tariff.value(grid, x) + self.conveyors.price(&track(x)) / tariff::unit(self.layout, self.aim),
            false => worth,
        }
    }

    fn remember(&self, x: &[f64]) -> f64 {
        let worth = self.worth(x);
        let mut cheapest = self.cheapest.borrow_mut();
        if worth < cheapest.as_ref().map_or(f64::INFINITY, |c| c.1) && sound(self.problem, x) {
            *cheapest = Some((x.to_vec(), worth));
        }
        worth
    }

    /// The cheapest layout: first with straights at the least that a metre costs, which is quickly searched, then with
    /// their pieces; where chains are searched apart, without those of the sections between chains, and then with them.
    fn cheapest(&self, grid: &Grid, incumbent: Option<(Vec<f64>, f64)>) -> Found {
        *self.cheapest.borrow_mut() = incumbent;
        let split = parts::split(grid, &row::state(self.problem, grid));
        let apart = split && self.layout.is_flat() && self.conveyors.is_empty();
        let mut phases = vec![(Detail::Envelope, apart), (Detail::Steps, apart)];
        if apart {
            phases.push((Detail::Steps, false));
        }
        let (mut bound, mut nodes) = (0.0f64, 0);
        for (i, &(detail, apart)) in phases.iter().enumerate() {
            let known = self.cheapest.borrow().clone();
            let value = known.as_ref().map_or(f64::INFINITY, |k| k.1);
            if value - bound <= search::ALIKE.max(self.effort.gap * value.min(1e12)) {
                break;
            }
            let left = self.effort.nodes.saturating_sub(nodes);
            let effort = Effort { nodes: if i + 1 < phases.len() { left / 2 } else { left }, ..self.effort };
            let found = self.search(grid, known, (detail, apart), effort);
            nodes += found.nodes;
            bound = bound.max(found.bound);
            found.variables.iter().for_each(|x| {
                self.remember(x);
            });
        }
        let (variables, value) = self.cheapest.take().map_or((None, f64::INFINITY), |(x, worth)| (Some(x), worth));
        Found { variables, value, bound: bound.min(value), nodes, parts: Vec::new() }
    }

    /// Whether a grid's offset is known, or none is better than another.
    fn is_at_one_offset(&self, grid: &Grid) -> bool {
        grid.held || (offset::turns_freely(self.problem) && self.conveyors.is_empty())
    }

    /// The best layout, whether or not its chain closes: chain by chain where that is wanted.
    fn search(
        &self,
        grid: &Grid,
        incumbent: Option<(Vec<f64>, f64)>,
        (detail, apart): (Detail, bool),
        effort: Effort,
    ) -> Found {
        let value = |tariff: &Tariff, x: &[f64]| self.value(tariff, grid, x);
        let Some(incumbent) = incumbent else {
            let (mut setting, _) = self.setting(self.problem, grid, None, (detail, &value));
            setting.effort = effort;
            return search::search(&setting, None);
        };
        if self.is_at_one_offset(grid) {
            let (mut setting, stated) = self.setting(self.problem, grid, Some(&incumbent), (detail, &value));
            setting.effort = effort;
            let longest = incumbent.1 / tariff::least_rate(self.layout, self.aim);
            let incumbent = (incumbent.0.clone(), value(&setting.limits.tariff, &incumbent.0));
            if !apart {
                return search::search(&setting, Some(incumbent));
            }
            return parts::search(setting, &stated, incumbent, longest);
        }
        let at = |relaxed: &Problem, offsets: offset::Offsets, beat: f64, effort: Effort| {
            let grid = Grid::new(self.layout, relaxed, &incumbent.0, offsets.middle).ok()?;
            let beat = (incumbent.0.clone(), beat);
            let conveyors = self.conveyors.relaxed(offsets.by, offsets.within);
            let value = |tariff: &Tariff, x: &[f64]| self.value(tariff, &grid, x) - conveyors.given_away();
            let (mut setting, _) = self.setting(relaxed, &grid, Some(&beat), (detail, &value));
            setting.conveyors = &conveyors;
            setting.effort = effort;
            setting.polish = &|_, _| None;
            Some(search::search(&setting, Some(beat)))
        };
        let improve = |x: &[f64]| {
            let x = (self.polish)(x, None)?;
            let value = self.worth(&x);
            Some((x, value))
        };
        let metre = tariff::least_rate(self.layout, self.aim);
        let part = |gap: f64| self.told.part_of(gap);
        let known = (incumbent.clone(), metre, self.conveyors.prices().iter().sum());
        offset::search(self.problem, grid.step, known, (effort, self.stop), &at, &improve, &part)
    }

    /// The shortest layout whose chain closes, from what is known of all.
    fn closing(&self, grid: &Grid, any: Found, closes: Closes<'_>) -> Found {
        let Some(x) = any.variables else { return any };
        let written = track(&self.problem.start);
        let bound = closes.next(self.layout, &written, any.bound.max(0.0));
        let best = closes.stretch(&x, self.polish).map(|x| {
            let length = self.problem.evaluate(&x, 0.0).length;
            (x, length)
        });
        // Without a layout that closes, the one that does not is shown, and said not to close.
        let (nodes, parts) = (any.nodes, Vec::new());
        let open = Found { variables: Some(x), value: any.value, bound: any.bound, nodes, parts: any.parts };
        if best.as_ref().is_some_and(|b| b.1 - bound <= 1e-6) || !self.is_at_one_offset(grid) {
            return best.map_or(open, |(x, value)| Found { variables: Some(x), value, bound, nodes, parts });
        }
        let value = |tariff: &Tariff, x: &[f64]| self.value(tariff, grid, x);
        let (mut setting, _) = self.setting(self.problem, grid, best.as_ref(), (Detail::Envelope, &value));
        setting.closes = Some(closes);
        setting.effort.nodes = self.effort.nodes.saturating_sub(any.nodes).min(CLOSING);
        let found = search::search(&setting, best);
        if found.variables.is_none() {
            return open;
        }
        Found { bound: found.bound.max(bound), nodes: found.nodes + any.nodes, ..found }
    }

    /// The cheapest layout whose chain closes, from what is known of all.
    fn closing_cheaply(&self, grid: &Grid, any: Found, closes: Closes<'_>) -> Found {
        let Some(x) = any.variables else { return any };
        // Only what closes is remembered from here on; none of it costs less than the bound of all.
        *self.cheapest.borrow_mut() = None;
        closes.stretch(&x, self.polish).iter().for_each(|x| {
            self.remember(x);
        });
        let known = self.cheapest.borrow().clone();
        let (mut bound, mut nodes) = (any.bound, any.nodes);
        let settled = known.as_ref().is_some_and(|k| k.1 - bound <= search::ALIKE);
        if !settled && self.is_at_one_offset(grid) {
            // Without one, layouts of up to twice the price are searched.
            let first = known.unwrap_or_else(|| (x.clone(), 2.0 * any.value));
            let value = |tariff: &Tariff, x: &[f64]| self.value(tariff, grid, x);
            let (mut setting, _) = self.setting(self.problem, grid, Some(&first), (Detail::Steps, &value));
            setting.closes = Some(closes);
            setting.effort.nodes = self.effort.nodes.saturating_sub(any.nodes).min(CLOSING);
            let found = search::search(&setting, Some(first));
            found.variables.iter().filter(|x| closes.lack(&track(x)) == Some(0.0)).for_each(|x| {
                self.remember(x);
            });
            bound = bound.max(found.bound);
            nodes += found.nodes;
        }
        let parts = Vec::new();
        match self.cheapest.take() {
            Some((x, value)) => Found { variables: Some(x), value, bound: bound.min(value), nodes, parts },
            // The one that does not close is shown, and said not to.
            None => Found { variables: Some(x), value: any.value, bound: any.bound, nodes, parts: any.parts },
        }
    }

    fn setting<'b>(
        &'b self,
        problem: &'b Problem,
        grid: &'b Grid,
        incumbent: Option<&(Vec<f64>, f64)>,
        (detail, value): (Detail, &'b Value<'b>),
    ) -> (Setting<'b>, Stated) {
        let stated = row::state(problem, grid);
        let most = |i: &(Vec<f64>, f64)| i.1 / tariff::least_rate(self.layout, self.aim);
        let longest = incumbent.map_or_else(|| 10.0 * problem.evaluate(&problem.start, 0.0).length, most);
        let straights: Vec<(f64, f64)> = stated.straights.iter().map(|s| (s.0, s.1.min(longest).max(s.0))).collect();
        let first = match stated.fixed.first() {
            Some(&(0, p)) => (p, p),
            _ => surroundings(self.layout, longest),
        };
        let mut known = vec![track(&problem.start)];
        known.extend(incumbent.iter().map(|i| track(&i.0)));
        let tariff = match self.aim {
            Aim::Length => Tariff::metres(grid.len()),
            Aim::Price { metre } => Tariff::prices(self.layout, problem, grid, (metre, detail), &straights),
        };
        let mut open = Open {
            headings: grid.headings.clone(),
            radii: grid.radii.iter().map(|r| (0, r.len() - 1)).collect(),
            cells: Vec::new(),
            hulls: Vec::new(),
        };
        tariff.open(&mut open);
        let setting = Setting {
            problem,
            grid,
            limits: Limits { tariff, straights, first, reliefs: self.conveyors.prices() },
            conveyors: &self.conveyors,
            rows: stated.rows.clone(),
            beside: Beside { problem, grid, known, enclosing: Some(Enclosing { problem, grid }) },
            effort: self.effort,
            stop: self.stop,
            open,
            coupled: None,
            fixed: stated.fixed.clone(),
            value,
            closes: None,
            polish: self.polish,
            told: &self.told,
        };
        (setting, stated)
    }
}

/// Most nodes of the search for a chain that closes: nearly every choice of turns can be stretched until it does.
const CLOSING: usize = 5_000;
/// Of how well a chain's left-over is known, what a proof may leave: the least length that closes is sought by so much less,
/// and so are what short straights change and the layout that was found.
const HELD: f64 = 3.0;

/// Whether a layout meets every row and does not cross itself.
fn sound(problem: &Problem, x: &[f64]) -> bool {
    let at = problem.evaluate(x, 0.0);
    at.rows.iter().all(|r| r.violation() <= FEASIBLE) && problem.crossings(&at.track).is_empty()
}

fn refusal(problem: &Problem, why: &NoGrid) -> Vec<Violation> {
    match *why {
        NoGrid::Apart { first, other, off } => {
            let row = format!(
                "the headings of {} and {}, which no whole number of angle steps joins",
                problem.section_name(first),
                problem.section_name(other)
            );
            vec![Violation { row, span: problem.vertex_span(other), amount: off, unit: "rad" }]
        }
        NoGrid::Step | NoGrid::Empty => Vec::new(),
    }
}

/// A box that holds the first vertex: no more than a whole track away from what is known.
fn surroundings(layout: &Layout, longest: f64) -> (Point, Point) {
    let (low, high) = match &layout.building {
        Some(building) => building.polygon.bounds(),
        None => bounds(layout.corners().iter().map(|c| c.point)),
    };
    let reach = Point::new(longest, longest);
    (low - reach, high + reach)
}
