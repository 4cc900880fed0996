//! Standard track elements: the sequence along the track, its closure, and the bill of elements.
//!
//! A solved layout lies on the catalogue's grid to within the solver's tolerance. [`sequence`] puts it there exactly,
//! closes the loop again and covers every straight and every fillet with pieces that can be ordered; [`bill`] counts
//! them; [`lacking`] says what the catalogue does not have.

mod bill;
mod course;
mod cover;
mod lacking;
mod part;
mod sequence;
mod space;
mod steps;

pub use bill::{Bill, BillLine, bill, price};
pub use cover::Cover;
pub use lacking::lacking;
pub use part::{OrderedPiece, Part, PlaceInPlan, climbs_lacking, pieces};
pub use sequence::sequence;
pub use space::{Leg, Length, Room, Space, merged, rooms};
pub use steps::{PriceStep, Steps};

use crate::base::trig;
use crate::geometry::Point;
use serde::Serialize;

/// What a piece is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Shape {
    /// Metres.
    Straight { length: f64, cut: bool },
    /// Metres and radians (left positive).
    Curve { radius: f64, turn: f64 },
}

impl Shape {
    /// Of the centre line, m.
    pub fn length(&self) -> f64 {
        match *self {
            Shape::Straight { length, .. } => length,
            Shape::Curve { radius, turn } => radius * turn.abs(),
        }
    }

    /// Position and heading (rad in (-π, π]) at the end of a piece that begins at these.
    pub fn advance(&self, position: Point, heading: f64) -> (Point, f64) {
        match *self {
            Shape::Straight { length, .. } => (position + Point::unit(heading) * length, heading),
            Shape::Curve { radius, turn } => {
                let end = heading + turn;
                let signed = radius * turn.signum();
                let across = Point::unit(heading).left() - Point::unit(end).left();
                (position + across * signed, trig::wrap(end))
            }
        }
    }
}

/// One orderable piece at its place.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Element {
    pub shape: Shape,
    pub article: String,
    /// Where it begins, m, and its heading there, rad in (-π, π].
    pub position: Point,
    pub heading: f64,
    /// Arc length where it begins, m, from vertex 0's outgoing tangent point.
    pub s: f64,
    /// Of its centre line, m.
    pub length: f64,
    /// Vertex whose section (straight) or fillet (curve) it belongs to.
    pub vertex: usize,
    /// Whether the catalogue has it; `optimise nothing` may use others.
    pub in_catalog: bool,
}

/// The elements in driving order.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sequence {
    pub elements: Vec<Element>,
    /// Distance between the end of the last element and the beginning of the first, m, found by walking the
    /// elements from the first one's position and heading.
    pub closure: f64,
    /// The same for the heading, rad.
    pub closure_heading: f64,
}

impl Sequence {
    /// Of all elements, m.
    pub fn length(&self) -> f64 {
        self.elements.iter().map(|e| e.length).sum()
    }
}
