//! What stands along the track, and the chain on it.

use crate::source::{Span, Spanned};
use serde::Serialize;

/// A place on the straight of a section, measured from the tangent point where the straight begins.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StraightPlace {
    /// Index of the section's first vertex.
    pub section: usize,
    /// m
    pub at: f64,
    pub span: Span,
}

/// Places at equal distances on one straight.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PlaceRow {
    /// The first one.
    pub place: StraightPlace,
    /// m
    pub every: f64,
    pub count: usize,
}

#[derive(Clone, Debug, Serialize)]
pub struct Equipment {
    /// Where arc length is 0; `None`: the first vertex' outgoing tangent point.
    pub start: Option<StraightPlace>,
    pub photocell: Option<StraightPlace>,
    pub inductions: Vec<Induction>,
    pub chutes: Vec<Chutes>,
    pub motors: Motors,
    /// Distance between supports, m.
    pub supports: Option<Spanned<f64>>,
    /// One-based number of the cart that carries the sensors.
    pub sensor_cart: usize,
}

#[derive(Clone, Debug, Serialize)]
pub struct Induction {
    pub name: String,
    pub place: StraightPlace,
}

#[derive(Clone, Debug, Serialize)]
pub struct Chutes {
    pub name: String,
    pub row: PlaceRow,
}

#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Motors {
    /// Motor j of N covers from (j + 1/2) S / N on.
    Evenly {
        count: usize,
    },
    Rows(Vec<PlaceRow>),
}

/// Height of the track over a run of sections.
#[derive(Clone, Debug, Serialize)]
pub struct Level {
    /// First and last vertex of the run; the same twice is the whole loop.
    pub from: usize,
    pub to: usize,
    /// m
    pub height: f64,
    pub span: Span,
}

/// Where and how the level changes.
#[derive(Clone, Debug, Serialize)]
pub struct Ramp {
    /// The section it begins on.
    pub section: usize,
    /// The section it ends on: the same for a ramp on one straight; curves between become spirals.
    pub last: usize,
    /// Distance from the tangent point where the straight begins, m.
    pub from: Option<f64>,
    /// Rise over run, unsigned.
    pub slope: Option<f64>,
    /// Radius of the vertical curves, m.
    pub radius: Option<f64>,
    pub span: Span,
}

#[derive(Clone, Debug, Serialize)]
pub struct ChainDeclaration {
    /// T₀, N
    pub tension: f64,
    /// Largest left-over that a whole number of carts may have, m; `None`: only reported.
    pub closes_within: Option<Spanned<f64>>,
}

/// An effect that the layout's simulations include.
#[derive(Clone, Debug, Serialize)]
pub struct DeclaredEffect {
    pub name: String,
    /// Strengths by name, SI.
    pub strengths: Vec<(String, f64)>,
    pub span: Span,
}
