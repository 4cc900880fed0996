//! Constraints a user writes, checked: vertices are indices, quantities are SI, formulas have one dimension.

use super::TrackSection;
use crate::source::Span;
use serde::Serialize;

/// The line from vertex `from` to the next one, or the straight between its tangent points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Target {
    /// Index of the first vertex; the second is the next in driving order.
    pub from: usize,
    /// Between tangent points rather than vertices.
    pub straight: bool,
}

/// The thesis' five kinds (§3.3): what is held at its written value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum FixKind {
    Length,
    /// The section's heading.
    Rotation,
    /// The shift of its midpoint along its written direction.
    Parallel,
    /// The shift of its midpoint across its written direction.
    Perpendicular,
}

#[derive(Clone, Debug, Serialize)]
pub struct Constraint {
    pub kind: ConstraintKind,
    /// The whole statement.
    pub span: Span,
    /// The user's words, repeated in messages.
    pub reason: Option<String>,
}

#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ConstraintKind {
    /// `all` is expanded to the four; sorted, without repetition.
    FixSection { target: Target, kinds: Vec<FixKind> },
    /// Coordinates of a vertex.
    FixVertex { vertex: usize },
    /// Radius of a vertex.
    FixRadius { vertex: usize },
    /// A straight part of the track with a place of its own lies on the straight of this section.
    Holds { section: usize, part: Box<TrackSection> },
    /// `low <= formula <= high`; an equality has both alike, an inequality one infinite side. Strict relations
    /// are taken as their closure.
    Require { formula: Formula, low: f64, high: f64, unit: Unit },
}

/// How a formula's value is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Unit {
    Metre,
    /// Shown in degrees.
    Radian,
    One,
    SquareMetre,
    /// Any other dimension a formula may have.
    Other,
}

impl Unit {
    /// Of SI values; nothing for a plain number or another dimension.
    pub fn symbol(self) -> &'static str {
        match self {
            Unit::Metre => "m",
            Unit::Radian => "rad",
            Unit::SquareMetre => "m^2",
            Unit::One | Unit::Other => "",
        }
    }
}

/// A checked formula over the layout's variables. Values in SI; sums and products are flat.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Formula {
    Constant(f64),
    /// Coordinate of a vertex, m.
    X(usize),
    Y(usize),
    /// Fillet radius of a vertex, m.
    Radius(usize),
    /// Length of a section or straight, m.
    Length(Target),
    /// Heading of the section from this vertex, rad in (-π, π].
    Heading(usize),
    /// Signed turn at a vertex, rad, left positive.
    Angle(usize),
    /// Distance between two vertices, m.
    DistanceVertices(usize, usize),
    /// Distance from a vertex to an obstacle's polygon (index into `Layout::obstacles`), m, 0 inside.
    DistanceObstacle(usize, usize),
    /// Distance from a vertex to the building's walls, m.
    DistanceBuilding(usize),
    Sum(Vec<Formula>),
    Product(Vec<Formula>),
    Negative(Box<Formula>),
    Reciprocal(Box<Formula>),
    Absolute(Box<Formula>),
    SquareRoot(Box<Formula>),
    Smallest(Vec<Formula>),
    Largest(Vec<Formula>),
}

impl Formula {
    /// Whether it is a direction, which full turns do not change: headings, with turns and constants added to them or
    /// taken off.
    pub fn is_heading(&self) -> bool {
        match self {
            Formula::Heading(_) => true,
            Formula::Negative(inner) => inner.is_heading(),
            Formula::Sum(terms) => {
                let fixed = |f: &Formula| match f {
                    Formula::Constant(_) | Formula::Angle(_) => true,
                    Formula::Negative(inner) => matches!(**inner, Formula::Constant(_) | Formula::Angle(_)),
                    _ => false,
                };
                terms.iter().any(Formula::is_heading) && terms.iter().all(|f| f.is_heading() || fixed(f))
            }
            _ => false,
        }
    }
}
