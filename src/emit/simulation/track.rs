//! The element list of the simulator, from arc length 0 on.

use super::{Piece, Track};
use crate::elements::{Element, Sequence, Shape};
use crate::emit::number::tidy;
use crate::geometry::{Point, trig};
use crate::model::{Layout, Place};

impl Track {
    /// The elements from the layout's start on, with the pieces of one straight or one turn as one. The straight on
    /// which the start lies is split there.
    pub fn new(layout: &Layout, sequence: &Sequence) -> Self {
        let start = layout.equipment.start.map_or(0.0, |place| arc_length(place, layout, sequence));
        let mut position = sequence.elements.first().map_or_else(Point::default, |e| e.position);
        let mut heading = sequence.elements.first().map_or(0.0, |e| e.heading);
        let (mut before, mut after) = (Vec::new(), Vec::new());
        let mut begin = (position, heading);
        let mut s = 0.0;
        for shape in merged(sequence) {
            let split = start - s;
            s += shape.length();
            // Only straights are split; a start that is nearer to a joint than the solver's tolerance lies on it.
            match shape {
                Shape::Straight { length, cut } if split > NEAR && split < length - NEAR => {
                    let first = Shape::Straight { length: split, cut };
                    begin = first.advance(position, heading);
                    before.push(first);
                    after.push(Shape::Straight { length: length - split, cut });
                }
                _ if split <= NEAR => after.push(shape),
                _ => before.push(shape),
            }
            (position, heading) = shape.advance(position, heading);
            if after.is_empty() {
                begin = (position, heading);
            }
        }
        let (point, heading) = begin;
        let elements = after.into_iter().chain(before).map(piece).collect();
        Track { name: layout.name.clone(), start: [tidy(point.x), tidy(point.y), 0.0, trig::wrap(heading)], elements }
    }
}

/// Where a place lies in the sequence, m: past the first element of its straight or, where that has no length, of the
/// curve behind it.
fn arc_length(place: Place, layout: &Layout, sequence: &Sequence) -> f64 {
    let begins = |e: &&Element| match e.shape {
        Shape::Straight { .. } => e.vertex == place.section,
        Shape::Curve { .. } => e.vertex == layout.next(place.section),
    };
    sequence.elements.iter().find(begins).map_or(0.0, |e| e.s + place.at)
}

/// A solver's tolerance, m.
const NEAR: f64 = 1e-6;

/// Straights and turns as a whole.
pub fn merged(sequence: &Sequence) -> Vec<Shape> {
    let mut shapes: Vec<(usize, Shape)> = Vec::new();
    for element in &sequence.elements {
        match (shapes.last_mut(), element.shape) {
            (Some((vertex, Shape::Straight { length, .. })), Shape::Straight { length: more, .. })
                if *vertex == element.vertex =>
            {
                *length += more;
            }
            (Some((vertex, Shape::Curve { turn, .. })), Shape::Curve { turn: more, .. })
                if *vertex == element.vertex =>
            {
                *turn += more;
            }
            (_, shape) => shapes.push((element.vertex, shape)),
        }
    }
    shapes.into_iter().map(|(_, shape)| shape).collect()
}

fn piece(shape: Shape) -> Piece {
    match shape {
        Shape::Straight { length, .. } => Piece::Straight { length: tidy(length), slope: 0.0 },
        Shape::Curve { radius, turn } => Piece::Arc { radius: tidy(radius), turn_deg: tidy(turn.to_degrees()) },
    }
}
