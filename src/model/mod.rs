//! The checked layout: immutable, in SI units (metres, radians, kilograms, seconds, newtons), every item with the
//! span it came from. Every stage after `semantics` reads only this.

mod capacity;
mod choice;
mod components;
mod constraint;
pub mod effect_definitions;
mod equipment;
#[cfg(test)]
pub mod fixture;
mod heights;
#[cfg(test)]
pub mod instances;
mod prices;
mod print;
mod route;
mod sheet;
mod total_price;

pub use capacity::*;
pub use choice::*;
pub use components::*;
pub use constraint::*;
pub use equipment::*;
pub use heights::Heights;
pub use print::{Required, objective as objective_text, print, required};
pub use route::{Route, TrackSection};
pub use sheet::*;

use crate::geometry::{Corner, Point, Polygon};
use crate::source::{Span, Spanned};
use serde::Serialize;

/// What a layout may miss a limit by and still meet it, m and rad: solvers end this near to their rows.
pub const TOLERANCE: f64 = 1e-6;
/// How near to a whole number of angle steps fixed headings are, rad: a hundredth of [`TOLERANCE`] over a hundred metres.
pub const HEADING_TOLERANCE: f64 = 1e-8;

/// A closed interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Interval {
    pub low: f64,
    pub high: f64,
}

impl Interval {
    pub fn contains(&self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }
}

/// A layout that passed every check, with each default filled in.
#[derive(Clone, Debug, Serialize)]
pub struct Layout {
    pub name: String,
    pub span: Span,
    pub catalog: Catalog,
    pub cart: Cart,
    pub drive: Drive,
    pub sensor: Sensor,
    /// Else what the catalogue says of it holds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub take_up: Option<TakeUp>,
    /// Chain speed, m/s.
    pub speed: Spanned<f64>,
    /// Outer envelope swept by carts and carriers, m.
    pub width: Spanned<f64>,
    /// In driving order; the loop closes from the last to the first. At least three, or none with a `route`.
    pub vertices: Vec<Vertex>,
    /// Limits on the absolute turn at a vertex, rad: the catalogue's, narrowed by the layout.
    pub turns: Spanned<Interval>,
    /// Limits on the fillet radius, m: the catalogue's, narrowed by the layout.
    pub radii: Spanned<Interval>,
    pub building: Option<Building>,
    pub obstacles: Vec<Obstacle>,
    pub constraints: Vec<Constraint>,
    pub equipment: Equipment,
    pub capacity: Capacity,
    /// What of the components is free, and what they have to do.
    pub choice: Choice,
    pub levels: Vec<Level>,
    pub ramps: Vec<Ramp>,
    pub chain: ChainDeclaration,
    pub effects: Vec<DeclaredEffect>,
    pub drawing: DrawingSettings,
    pub objective: Objective,
    /// Asks for vertices, of which there are then none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub route: Option<Route>,
}

impl Layout {
    /// The written coordinates and radii.
    pub fn corners(&self) -> Vec<Corner> {
        self.vertices.iter().map(|v| Corner { point: v.point, radius: v.radius.value }).collect()
    }

    /// Scanners that the layout places itself: those of declared kinds stand among all, too, once they have their places.
    pub fn own_scanners(&self) -> impl Iterator<Item = StraightPlace> {
        let is_own = |place: &&StraightPlace| self.equipment.declared.iter().all(|d| d.span != place.span);
        self.capacity.scanners.iter().filter(is_own).copied()
    }

    /// `P4..P5`
    pub fn section_name(&self, section: usize) -> String {
        format!("{}..{}", self.vertices[section].name, self.vertices[self.next(section)].name)
    }

    /// Length of chain that the take-up compensates, m: of the layout's own, else the catalogue's.
    pub fn take_up_travel(&self) -> f64 {
        self.take_up.as_ref().map_or(self.catalog.take_up, |take_up| take_up.travel)
    }

    /// T₀ of a chain of such carts, N: what the layout says, else what the cart does.
    pub fn tension_with(&self, cart: &Cart) -> f64 {
        cart.tension.filter(|_| !self.chain.tension_is_said).unwrap_or(self.chain.tension)
    }

    /// Whether the whole track lies at one height: its plan is then all there is to optimise.
    pub fn is_flat(&self) -> bool {
        let mut heights = self.levels.iter().map(|level| level.height);
        let first = heights.next();
        self.ramps.is_empty() && heights.all(|height| Some(height) == first)
    }

    /// Index of the vertex after `i` in driving order.
    pub fn next(&self, i: usize) -> usize {
        (i + 1) % self.vertices.len()
    }
}

/// Where two straights' lines meet, with the radius of the fillet between them (thesis §3.2).
#[derive(Clone, Debug, Serialize)]
pub struct Vertex {
    pub name: String,
    pub point: Point,
    /// Where the coordinates stand.
    pub point_span: Span,
    /// Fillet radius, m. The catalogue's smallest when none is written (the span is then the vertex').
    pub radius: Spanned<f64>,
    pub span: Span,
}

impl Vertex {
    /// Whether the source writes its radius.
    pub fn has_radius(&self) -> bool {
        self.radius.span != self.span
    }
}

/// The walls: the track's band stays inside, at least `clearance` away.
#[derive(Clone, Debug, Serialize)]
pub struct Building {
    pub polygon: Polygon,
    /// m
    pub clearance: f64,
    pub span: Span,
}

/// A region that the track's band stays out of, at least `clearance` away.
#[derive(Clone, Debug, Serialize)]
pub struct Obstacle {
    pub name: String,
    pub polygon: Polygon,
    /// m
    pub clearance: f64,
    pub side: Side,
    /// Where `pass` gave the side; without, the written layout did.
    pub pass: Option<Span>,
    pub span: Span,
}

/// On which side of the direction of travel an obstacle lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    Left,
    Right,
    /// Left to the optimiser.
    Either,
}

/// What is optimised.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Objective {
    /// Weight and goal; empty for `optimise nothing`.
    pub terms: Vec<(f64, Goal)>,
    /// A budget: this goal may exceed its own optimum by the ratio.
    pub within: Option<(Goal, f64)>,
    /// Whether it is the price of all that is ordered. Its terms are cost, and what a metre of track takes of chain and
    /// supports, see [`Layout::count_total_price`].
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub total_price: bool,
    /// Where it was written; `None` when the default (length) holds.
    pub span: Option<Span>,
}

impl Objective {
    /// How much a goal counts; `None` where it does not.
    pub fn weight(&self, goal: Goal) -> Option<f64> {
        self.terms.iter().find(|(_, other)| *other == goal).map(|(weight, _)| *weight)
    }

    /// What a metre counts beside the cost, EUR; `None` where cost does not count, or polygon action does.
    pub fn metre(&self) -> Option<f64> {
        let cost = self.weight(Goal::Cost).filter(|_| self.weight(Goal::PolygonAction).is_none())?;
        Some(self.weight(Goal::Length).unwrap_or(0.0) / cost)
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Goal {
    Length,
    Cost,
    PolygonAction,
}
