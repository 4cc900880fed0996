//! From the plan to space: levels give sections their heights, and ramps and spirals lead from one to the next.
//!
//! Arc length counts along the slope; places on a straight count along it, too.

mod climb;
mod heights;
mod room;

pub use room::{Length, Room, rooms};

use crate::diagnostic::Diagnostic;
use crate::geometry::{CentreLine, Form, Point};
use crate::model::Layout;

use super::{Element, Sequence, Shape};

/// A piece of the centre line in space and the vertex whose section or fillet it belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leg {
    pub vertex: usize,
    /// Whether it is of the fillet.
    pub curve: bool,
    pub form: Form,
}

/// The centre line in space. It begins at vertex 0's outgoing tangent point, or where the first section with a level
/// does.
#[derive(Clone, Debug, PartialEq)]
pub struct Space {
    pub legs: Vec<Leg>,
    pub line: CentreLine,
    /// Arc length of the plan, from vertex 0's outgoing tangent point, where this begins, m.
    begin: f64,
}

impl Space {
    /// Raises a plan to the layout's levels. What cannot be climbed is reported, and stays flat.
    pub fn new(layout: &Layout, sequence: &Sequence) -> (Space, Vec<Diagnostic>) {
        let plan = merged(sequence);
        let (legs, begin, said) = if layout.levels.is_empty() {
            (plan.iter().map(|(vertex, shape)| flat(*vertex, *shape)).collect(), 0.0, Vec::new())
        } else {
            heights::raise(layout, &plan)
        };
        let first = legs.first().map(|leg| (leg.vertex, leg.curve));
        let begins = |e: &&Element| Some((e.vertex, matches!(e.shape, Shape::Curve { .. }))) == first;
        let (point, heading, s) = sequence
            .elements
            .iter()
            .find(begins)
            .map_or((Point::default(), 0.0, 0.0), |e| (e.position, e.heading, e.s));
        let forms: Vec<Form> = legs.iter().map(|leg| leg.form).collect();
        (Space { line: CentreLine::new([point.x, point.y, begin, heading], &forms), legs, begin: s }, said)
    }

    /// Arc length of the plan, from vertex 0's outgoing tangent point, where the legs begin, m.
    pub fn plan_begin(&self) -> f64 {
        self.begin
    }

    /// Arc length of what lies `s` along the plan from vertex 0's outgoing tangent point, m.
    pub fn from_plan(&self, s: f64) -> f64 {
        let plan: f64 = self.line.stretches.iter().map(|stretch| stretch.form.run()).sum();
        let mut left = (s - self.begin).rem_euclid(plan.max(f64::MIN_POSITIVE));
        for stretch in &self.line.stretches {
            let run = stretch.form.run();
            // Both arc lengths carry rounding: what ends here begins the next piece.
            if left < run - 1e-9 {
                return stretch.s + stretch.form.along(left);
            }
            left = (left - run).max(0.0);
        }
        self.line.length
    }

    /// Arc length where a section's straight begins, or what follows it if it has no length, m.
    pub fn section(&self, section: usize, layout: &Layout) -> f64 {
        let mut s = 0.0;
        for leg in &self.legs {
            if (leg.vertex == section && !leg.curve) || (leg.curve && leg.vertex == layout.next(section)) {
                return s;
            }
            s += leg.form.length();
        }
        0.0
    }
}

/// Straights and turns as a whole, each with its vertex.
pub fn merged(sequence: &Sequence) -> Vec<(usize, Shape)> {
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
    shapes
}

/// A piece of the plan, without slope.
fn flat(vertex: usize, shape: Shape) -> Leg {
    match shape {
        Shape::Straight { length, .. } => Leg { vertex, curve: false, form: Form::Straight { length, slope: 0.0 } },
        Shape::Curve { radius, turn } => Leg { vertex, curve: true, form: Form::Arc { radius, turn } },
    }
}
