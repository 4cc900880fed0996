//! What a drawing of the layout says beside the track: where its coordinates begin, the building's axes, the title block.

use crate::geometry::Point;
use crate::source::Span;
use serde::Serialize;

/// The coordinate that is the same all along a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Coordinate {
    X,
    Y,
}

/// An axis of the building's grid: a line of constant `x` or `y`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GridAxis {
    pub name: String,
    pub coordinate: Coordinate,
    /// m
    pub at: f64,
    pub span: Span,
}

/// Texts of the title block (ISO 7200); empty where the layout does not say.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct TitleBlock {
    pub project: String,
    /// Of the drawing.
    pub number: String,
    pub revision: String,
    /// Of this revision, as the author writes it.
    pub date: String,
    pub author: String,
    pub checked: String,
    pub approved: String,
}

/// What only drawings read.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct DrawingSettings {
    /// Where the drawing's coordinates are 0, m; the layout's own origin unless said.
    pub origin: Point,
    /// In the order in which they are written.
    pub axes: Vec<GridAxis>,
    pub title: TitleBlock,
}
