//! Straight parts of a track whose places are known before its vertices are, and the request to find the vertices.

use crate::geometry::Point;
use crate::source::Span;
use serde::Serialize;

/// A straight part of the track that users place: inductions, a row of chutes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TrackSection {
    pub name: String,
    /// In driving order. With a `length` of its own it may lie anywhere between these two, else it runs from one to the
    /// other.
    pub from: Point,
    pub to: Point,
    /// m; `None` for a section with a fixed place.
    pub length: Option<f64>,
    /// Whether it may be driven from `to` to `from` as well.
    pub either_way: bool,
    pub from_span: Span,
    pub to_span: Span,
    pub span: Span,
}

impl TrackSection {
    /// Unit vector along it, as written.
    pub fn direction(&self) -> Point {
        (self.to - self.from) * (1.0 / self.room())
    }

    /// From `from` to `to`, m.
    pub fn room(&self) -> f64 {
        self.from.distance(self.to)
    }

    /// m
    pub fn length(&self) -> f64 {
        self.length.unwrap_or_else(|| self.room())
    }

    /// How far it may slide, m.
    pub fn freedom(&self) -> f64 {
        (self.room() - self.length()).max(0.0)
    }

    /// The same, driven the other way.
    pub fn reversed(&self) -> TrackSection {
        TrackSection { from: self.to, to: self.from, from_span: self.to_span, to_span: self.from_span, ..self.clone() }
    }
}

/// The request to find a loop's vertices.
#[derive(Clone, Debug, Serialize)]
pub struct Route {
    /// In the order in which the loop passes them, if that is fixed.
    pub sections: Vec<TrackSection>,
    pub any_order: bool,
    pub span: Span,
}
