//! What choices are worth: their length, or what their pieces cost.
//!
//! Prices count in units of the least that a metre of straight can cost, so that a search compares metres either way.
//! Beyond its metres, a straight's price is a step function of its length ([`Steps`]); the least of step and
//! multipliers lies at a vertex of the step function's lower convex hull, which is what a bound needs of it. A search
//! that finds a straight above its hull branches on its *cells*: break points, and the open intervals between them.

use super::grid::{Grid, track};
use super::open::{Open, place};
use crate::elements::{self, OrderedPiece, Part, PriceStep, Space, Steps};
use crate::geometry::Track;
use crate::model::{Goal, Layout, Objective};
use crate::problem::Problem;

/// What is minimised.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Aim {
    Length,
    /// The price of the pieces, EUR, and so much for each metre, EUR/m.
    Price {
        metre: f64,
    },
}

impl Aim {
    /// Of a layout's objective. The weight of cost is made 1.
    pub fn of(layout: &Layout) -> Self {
        let weight = |goal: Goal| layout.objective.weight(goal);
        match weight(Goal::Cost) {
            Some(cost) => Aim::Price { metre: weight(Goal::Length).unwrap_or(0.0) / cost },
            None => Aim::Length,
        }
    }
}

/// How exactly a search knows what straights cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Detail {
    /// At least so much a metre, whatever their length.
    Envelope,
    /// By their pieces.
    Steps,
}

/// Prices of straights, arcs and turns, by stage.
#[derive(Clone, Debug)]
pub struct Tariff {
    /// Of a metre.
    pub straight: Vec<f64>,
    /// Of a metre.
    pub arc: Vec<f64>,
    /// Of each piece of a turn.
    pub piece: Vec<f64>,
    /// Pieces of a turn, by its steps; empty when length is minimised.
    pub pieces: Vec<f64>,
    /// Of each straight; empty when length is minimised.
    pub cells: Vec<Cells>,
}

impl Tariff {
    /// Of length.
    pub fn metres(n: usize) -> Self {
        let ones = vec![1.0; n];
        let (arc, piece) = (ones.clone(), vec![0.0; n]);
        Tariff { straight: ones, arc, piece, pieces: Vec::new(), cells: Vec::new() }
    }

    /// Of the layout's catalogue, for straights within limits, m.
    pub fn prices(
        layout: &Layout,
        problem: &Problem,
        grid: &Grid,
        (metre, detail): (f64, Detail),
        straights: &[(f64, f64)],
    ) -> Self {
        let n = grid.len();
        let catalog = &layout.catalog;
        let (straight, curve) = (catalog.straight.price, catalog.curve.price);
        let unit = unit(layout, Aim::Price { metre });
        let longest = straights.iter().map(|s| s.1).fold(0.0, f64::max);
        let steps = (detail == Detail::Steps).then(|| Steps::new(&catalog.straight, longest)).flatten();
        let climb = |per_metre: f64| {
            let others = [catalog.vertical.as_ref().map(|v| v.price), catalog.spiral.as_ref().map(|s| s.price)];
            // What the catalogue has none of is estimated by its curves.
            others.into_iter().map(|o| o.unwrap_or(curve).per_metre).fold(per_metre, f64::min)
        };
        let climbs = |k: usize| problem.heights.climbs(grid.vertex(k));
        let turns = |k: usize| problem.heights.climbs_around(grid.vertex(k));
        let of_straight = |k: usize| match (&steps, climbs(k)) {
            // A slope is longer than its plan, and has pieces besides.
            (_, true) => climb(straight.per_metre),
            (Some(_), false) => straight.per_metre,
            // Their envelope, also where there are too many steps to list.
            (None, false) => layout.catalog.least_of_a_metre(),
        };
        let of_arc = |k: usize| if turns(k) { climb(curve.per_metre) } else { curve.per_metre };
        let cells = |k: usize| {
            let (low, high) = straights[k];
            let steps = steps.as_ref().filter(|_| !climbs(k));
            steps.map_or_else(|| Cells::plain(low, high), |steps| Cells::new(steps, low, high, unit))
        };
        let largest = ((catalog.curve.largest + SLACK) / grid.step).floor().max(1.0) as usize;
        Tariff {
            straight: (0..n).map(|k| (of_straight(k) + metre) / unit).collect(),
            arc: (0..n).map(|k| (of_arc(k) + metre) / unit).collect(),
            piece: (0..n).map(|k| if turns(k) { 0.0 } else { curve.per_piece / unit }).collect(),
            pieces: (0..=grid.circle as usize / 2).map(|steps| steps.div_ceil(largest) as f64).collect(),
            cells: (0..n).map(cells).collect(),
        }
    }

    /// Pieces of the turn at a vertex stage.
    pub fn turn(&self, stage: usize, steps: i32) -> f64 {
        self.pieces.get(steps.unsigned_abs() as usize).map_or(0.0, |pieces| pieces * self.piece[stage])
    }

    /// Of a layout on the grid, as far as these prices say; infinite off the grid.
    pub fn value(&self, grid: &Grid, x: &[f64]) -> f64 {
        let Some(place) = place(grid, x) else { return f64::INFINITY };
        let (n, track) = (grid.len(), track(x));
        let straight = |k: usize| {
            let length = track.straight(grid.vertex(k)).length;
            let cells = &self.cells[k];
            self.straight[k] * length + cells.price(cells.cell(length, (0, cells.count() - 1)))
        };
        let curve = |k: usize| {
            let (radius, steps) =
                (grid.radii[k % n][place.radii[k % n].0], place.headings[k][0] - place.headings[k - 1][0]);
            self.arc[k % n] * radius * grid.turn(steps).0 + self.turn(k % n, steps)
        };
        (0..n).map(straight).sum::<f64>() + (1..=n).map(curve).sum::<f64>()
    }

    /// Counts a straight by its metres alone, whatever its length.
    pub fn release(&mut self, k: usize, longest: f64) {
        if !self.cells.is_empty() {
            (self.straight[k], self.cells[k]) = (1.0, Cells::plain(-longest, longest));
        }
    }

    /// Holds a straight at a length.
    pub fn hold(&mut self, k: usize, length: f64) {
        if let Some(cells) = self.cells.get_mut(k) {
            let price = cells.price(cells.cell(length, (0, cells.count() - 1)));
            cells.steps = vec![PriceStep { length, price, after: price }];
        }
    }

    /// Opens all cells.
    pub fn open(&self, open: &mut Open) {
        open.cells = self.cells.iter().map(|c| (0, c.count() - 1)).collect();
        open.hulls = self.cells.iter().zip(&open.cells).map(|(c, all)| c.hull(*all).into()).collect();
    }
}

/// Slack on angles that come from text, rad.
const SLACK: f64 = 1e-9;

/// EUR of one unit of value; 1 where that is the length, in m.
pub fn unit(layout: &Layout, aim: Aim) -> f64 {
    match aim {
        Aim::Length => 1.0,
        Aim::Price { metre } => layout.catalog.least_of_a_metre() + metre,
    }
}

/// What a metre of track is worth at least, in units of value.
pub fn least_rate(layout: &Layout, aim: Aim) -> f64 {
    let Aim::Price { metre } = aim else { return 1.0 };
    let catalog = &layout.catalog;
    let curve = catalog.curve.price;
    let longest = catalog.curve.largest * catalog.curve.radii.last().copied().unwrap_or(1.0);
    let least =
        layout.catalog.least_of_a_metre().min(curve.per_metre + curve.per_piece / longest.max(f64::MIN_POSITIVE));
    let climbs = [catalog.vertical.as_ref().map(|v| v.price), catalog.spiral.as_ref().map(|s| s.price)];
    let raised =
        climbs.into_iter().map(|c| c.unwrap_or(curve).per_metre).fold(catalog.straight.price.per_metre, f64::min);
    (if layout.is_flat() { least } else { least.min(raised) } + metre) / unit(layout, aim)
}

/// What a layout costs, and so much for each metre, EUR; infinite where its straights cannot be made.
pub fn worth(layout: &Layout, track: &Track, metre: f64) -> f64 {
    let sequence = elements::sequence(track, layout);
    let (space, _) = Space::new(layout, &sequence);
    let pieces = elements::pieces(&sequence, &space, layout);
    // What a climb leaves of its straight may be shorter than any piece: the bill estimates it.
    let stock = &layout.catalog.straight;
    let least = stock.stock.iter().copied().chain(stock.cut.map(|c| c.low)).fold(f64::INFINITY, f64::min);
    let left_over = |length: f64| !layout.is_flat() && length < least;
    let lacking =
        |p: &OrderedPiece| matches!(p.part, Part::Straight { length, .. } if !p.in_catalog && !left_over(length));
    if pieces.iter().any(lacking) {
        return f64::INFINITY;
    }
    elements::price(&pieces, layout) + metre * track.length
}

/// What a layout costs when it is bought for the least money, whatever is optimised, EUR.
pub fn least_price(layout: &Layout, track: &Track) -> f64 {
    let objective = Objective { terms: vec![(1.0, Goal::Cost)], ..Objective::default() };
    worth(&Layout { objective, ..layout.clone() }, track, 0.0)
}

/// The steps of one straight within its limits: cell 2i is the length of step i, cell 2i + 1 what lies between it and
/// the next.
#[derive(Clone, Debug, PartialEq)]
pub struct Cells {
    steps: Vec<PriceStep>,
}

/// A straight this close to a step's length has it, m.
const AT: f64 = 1e-7;

impl Cells {
    /// A straight without steps.
    fn plain(low: f64, high: f64) -> Self {
        let step = |length: f64, after: f64| PriceStep { length, price: 0.0, after };
        Cells { steps: vec![step(low, 0.0), step(high.max(low), f64::INFINITY)] }
    }

    fn new(steps: &Steps, low: f64, high: f64, unit: f64) -> Self {
        let inside = |s: &&PriceStep| s.length > low + AT && s.length < high - AT;
        let end = |length: f64| {
            let near = steps.points().iter().find(|s| (s.length - length).abs() <= AT);
            near.copied().unwrap_or_else(|| {
                let price = steps.price(length);
                PriceStep { length, price, after: price }
            })
        };
        let mut list = vec![end(low)];
        list.extend(steps.points().iter().filter(inside).copied());
        if high > low + AT {
            list.push(end(high));
        }
        list.iter_mut().for_each(|s| (s.price, s.after) = (s.price / unit, s.after / unit));
        Cells { steps: list }
    }

    pub fn count(&self) -> usize {
        (2 * self.steps.len()).saturating_sub(1)
    }

    /// The cell among some that a length lies in.
    pub fn cell(&self, length: f64, (from, to): (usize, usize)) -> usize {
        let next = self.steps.partition_point(|s| s.length <= length + AT);
        let last = next.saturating_sub(1);
        let at = (length - self.steps[last].length).abs() <= AT;
        (if at { 2 * last } else { 2 * last + 1 }).clamp(from, to)
    }

    pub fn price(&self, cell: usize) -> f64 {
        let step = &self.steps[cell / 2];
        if cell.is_multiple_of(2) { step.price } else { step.after }
    }

    /// The lower convex hull of length and price over some cells; empty where none of them can be made.
    pub fn hull(&self, (from, to): (usize, usize)) -> Vec<(f64, f64)> {
        let mut points: Vec<(f64, f64)> = Vec::new();
        let mut add = |length: f64, price: f64| {
            if price.is_finite() {
                points.push((length, price));
            }
        };
        for cell in from..=to {
            let price = self.price(cell);
            add(self.steps[cell / 2].length, price);
            if cell % 2 == 1 {
                add(self.steps[cell / 2 + 1].length, price);
            }
        }
        lower_hull(points)
    }
}

/// A hull's price at a length; beyond its ends that of the end.
pub fn on_hull(hull: &[(f64, f64)], length: f64) -> f64 {
    let next = hull.partition_point(|p| p.0 < length);
    match (next.checked_sub(1).and_then(|i| hull.get(i)), hull.get(next)) {
        (Some(a), Some(b)) => a.1 + (b.1 - a.1) * (length - a.0) / (b.0 - a.0),
        (Some(a), None) | (None, Some(a)) => a.1,
        (None, None) => f64::INFINITY,
    }
}

/// The lower convex hull of points by ascending abscissa (Andrew 1979).
fn lower_hull(mut points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    points.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    points.dedup_by(|next, kept| next.0 <= kept.0);
    let mut hull: Vec<(f64, f64)> = Vec::new();
    for p in points {
        while let [.., a, b] = hull[..] {
            if (b.1 - a.1) * (p.0 - a.0) < (p.1 - a.1) * (b.0 - a.0) {
                break;
            }
            hull.pop();
        }
        hull.push(p);
    }
    hull
}

impl Open {
    /// Lets a straight lie in these cells only. `false` when none of them can be made.
    pub fn restrict(&mut self, tariff: &Tariff, k: usize, cells: (usize, usize)) -> bool {
        let hull = tariff.cells[k].hull(cells);
        self.cells[k] = cells;
        self.hulls[k] = hull.into();
        !self.hulls[k].is_empty()
    }
}
