//! The element list of the simulator, from arc length 0 on.

use super::{CentreLinePiece, Track};
use crate::base::number::tidy;
use crate::base::trig;
use crate::compiled::Compiled;
use crate::elements::{Element, Sequence, Shape, merged};
use crate::geometry::{Form, Point};
use crate::model::{Layout, StraightPlace};

impl Track {
    /// The elements from the layout's start on, with the pieces of one straight or one turn as one. The straight on
    /// which the start lies is split there.
    pub fn new(compiled: &Compiled) -> Self {
        if compiled.raised() { Track::raised(compiled) } else { Track::level(&compiled.layout, &compiled.sequence) }
    }

    /// The same in space.
    fn raised(compiled: &Compiled) -> Self {
        let (line, start) = (&compiled.space.line, compiled.start().rem_euclid(compiled.space.line.length));
        let mut at = line.stretch_at(start);
        let mut split = start - line.stretches[at].s;
        if line.stretches[at].length - split < NEAR {
            (at, split) = ((at + 1) % line.stretches.len(), 0.0);
        }
        let whole = line.stretches[at];
        let mut forms: Vec<Form> = Vec::new();
        let straight = matches!(whole.form, Form::Straight { .. });
        let cut = straight && split > NEAR;
        forms.push(if cut { whole.form.part(split, whole.length) } else { whole.form });
        forms.extend((1..line.stretches.len()).map(|k| line.stretches[(at + k) % line.stretches.len()].form));
        if cut {
            forms.push(whole.form.part(0.0, split));
        }
        let frame = if cut { whole.at(split) } else { whole.begin };
        let [x, y, z] = [frame.position.x, frame.position.y, frame.position.z].map(tidy);
        let start = [x, y, z, tidy(trig::wrap(frame.heading()))];
        Track { name: compiled.layout.name.clone(), start, elements: joined(&forms).into_iter().map(spatial).collect() }
    }

    fn level(layout: &Layout, sequence: &Sequence) -> Self {
        let start = layout.equipment.start.map_or(0.0, |place| arc_length(place, layout, sequence));
        let mut position = sequence.elements.first().map_or_else(Point::default, |e| e.position);
        let mut heading = sequence.elements.first().map_or(0.0, |e| e.heading);
        let (mut before, mut after) = (Vec::new(), Vec::new());
        let mut begin = (position, heading);
        let mut s = 0.0;
        for (_, shape) in merged(sequence) {
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
fn arc_length(place: StraightPlace, layout: &Layout, sequence: &Sequence) -> f64 {
    let begins = |e: &&Element| match e.shape {
        Shape::Straight { .. } => e.vertex == place.section,
        Shape::Curve { .. } => e.vertex == layout.next(place.section),
    };
    sequence.elements.iter().find(begins).map_or(0.0, |e| e.s + place.at)
}

/// A solver's tolerance, m.
const NEAR: f64 = 1e-6;

fn piece(shape: Shape) -> CentreLinePiece {
    match shape {
        Shape::Straight { length, .. } => CentreLinePiece::Straight { length: tidy(length), slope: 0.0 },
        Shape::Curve { radius, turn } => {
            CentreLinePiece::Arc { radius: tidy(radius), turn_deg: tidy(turn.to_degrees()) }
        }
    }
}

/// With straights of one slope that follow each other as one.
fn joined(forms: &[Form]) -> Vec<Form> {
    let mut out: Vec<Form> = Vec::new();
    let many = forms.len();
    for (k, form) in forms.iter().enumerate() {
        match (out.last_mut(), *form) {
            // The first and last are parts of one straight around the start, and stay apart.
            (Some(Form::Straight { length, slope }), Form::Straight { length: more, slope: same })
                if *slope == same && k + 1 < many =>
            {
                *length += more;
            }
            _ => out.push(*form),
        }
    }
    out
}

fn spatial(form: Form) -> CentreLinePiece {
    match form {
        Form::Straight { length, slope } => CentreLinePiece::Straight { length: tidy(length), slope: tidy(slope) },
        Form::Arc { radius, turn } => CentreLinePiece::Arc { radius: tidy(radius), turn_deg: tidy(turn.to_degrees()) },
        Form::Vertical { radius, slope_from, slope_to } => {
            CentreLinePiece::Vertical { radius: tidy(radius), slope_from: tidy(slope_from), slope_to: tidy(slope_to) }
        }
        Form::Spiral { radius, turn, rise } => {
            CentreLinePiece::Spiral { radius: tidy(radius), turn_deg: tidy(turn.to_degrees()), rise: tidy(rise) }
        }
    }
}
