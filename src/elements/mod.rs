//! Standard track elements: the sequence along the track, its closure, and the bill of elements.

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

/// One article of the bill.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BillLine {
    pub article: String,
    pub description: String,
    pub shape: Shape,
    pub count: usize,
    /// EUR a piece and in all.
    pub unit_price: f64,
    pub price: f64,
    /// kg a piece and in all.
    pub unit_mass: f64,
    pub mass: f64,
    pub in_catalog: bool,
}

/// The bill of elements: articles in a fixed order (straights by length, then curves by radius and angle).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Bill {
    pub lines: Vec<BillLine>,
    pub count: usize,
    pub price: f64,
    pub mass: f64,
}
