//! What the catalogue does not have, said once a curve and once a straight.

use super::sequence::{degrees, millimetres};
use super::{Sequence, Shape};
use crate::base::{number, words};
use crate::diagnostic::{Code, Diagnostic};
use crate::model::Layout;

use super::course::SNAP;

/// A warning for every curve and every straight that the layout's catalogue cannot cover.
pub fn lacking(sequence: &Sequence, layout: &Layout) -> Vec<Diagnostic> {
    let special = sequence.elements.iter().filter(|e| !e.in_catalog);
    let mut diagnostics = Vec::new();
    let mut last = None;
    for element in special {
        let straight = matches!(element.shape, Shape::Straight { .. });
        // A special turn may consist of several pieces of the vertex.
        if last.replace((straight, element.vertex)) == Some((straight, element.vertex)) {
            continue;
        }
        diagnostics.push(match element.shape {
            Shape::Straight { length, .. } => straight_lacking(element.vertex, length, layout),
            Shape::Curve { radius, .. } => {
                let pieces = sequence.elements.iter().filter(|e| e.vertex == element.vertex);
                let turn = pieces.map(|e| if let Shape::Curve { turn, .. } = e.shape { turn } else { 0.0 }).sum();
                curve_lacking(element.vertex, radius, turn, layout)
            }
        });
    }
    diagnostics
}

fn straight_lacking(from: usize, length: f64, layout: &Layout) -> Diagnostic {
    let (a, b) = (&layout.vertices[from], &layout.vertices[layout.next(from)]);
    let stock = &layout.catalog.straight;
    let message = format!("no straight of catalogue `{}` covers {}..{}", layout.catalog.name, a.name, b.name);
    let label = format!("the straight from here measures {} m", metres(length));
    let lengths = list(&stock.stock, metres);
    let expected = match (stock.cut, stock.stock.is_empty()) {
        (Some(cut), true) => format!("a piece cut to {} to {} m", metres(cut.low), metres(cut.high)),
        (Some(cut), false) => {
            format!("lengths of {lengths} m and pieces cut to {} to {} m", metres(cut.low), metres(cut.high))
        }
        (None, _) => format!("a sum of lengths of {lengths} m"),
    };
    Diagnostic::new(Code::W0710, message, a.span, label)
        .related(b.span, "and ends here")
        .expected(expected, format!("{} m", metres(length)))
        .help("move a vertex so that pieces fit, or use a catalogue that cuts straights to length")
}

fn curve_lacking(at: usize, radius: f64, turn: f64, layout: &Layout) -> Diagnostic {
    let (vertex, curve) = (&layout.vertices[at], &layout.catalog.curve);
    let listed = curve.radii.iter().any(|r| (r - radius).abs() <= SNAP);
    let steps = (turn.abs() / curve.angle_step).round();
    let on_grid = (steps * curve.angle_step - turn.abs()).abs() <= SNAP;
    let message = format!(
        "catalogue `{}` has no curve of {}° with a radius of {} mm, as {} needs",
        layout.catalog.name,
        degrees(turn),
        millimetres(radius),
        vertex.name
    );
    let nearest =
        |values: &[f64]| values.iter().copied().min_by(|a, b| (a - radius).abs().total_cmp(&(b - radius).abs()));
    if listed && on_grid {
        // The turn is a multiple, but the largest piece is smaller than a step.
        let largest = degrees(curve.largest);
        return Diagnostic::new(Code::W0710, message, vertex.span, "this curve cannot be put together")
            .expected(format!("pieces of at most {largest}°"), format!("a turn of {}°", degrees(turn)));
    }
    if !listed {
        let expected = format!("a radius of {} m", list(&curve.radii, metres));
        let diagnostic = Diagnostic::new(Code::W0710, message, vertex.radius.span, "this radius is not on the list")
            .expected(expected, format!("{} m", metres(radius)));
        return match nearest(&curve.radii) {
            Some(r) => diagnostic.help(format!("the nearest is `radius {} m`", metres(r))),
            None => diagnostic,
        };
    }
    let label = format!("the track turns by {}° here", degrees(turn));
    Diagnostic::new(Code::W0710, message, vertex.point_span, label)
        .expected(format!("a multiple of {}°", degrees(curve.angle_step)), format!("{}°", degrees(turn)))
        .help(format!("the nearest turn is {}°; `optimise length` finds it", degrees(steps * curve.angle_step)))
}

fn metres(length: f64) -> String {
    number::trimmed(length, 6)
}

/// `3, 4 or 5`.
fn list(values: &[f64], show: impl Fn(f64) -> String) -> String {
    words::list(&values.iter().copied().map(show).collect::<Vec<_>>(), "or")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Track;
    use crate::model::fixture;

    fn warnings(layout: &Layout) -> Vec<String> {
        let sequence = super::super::sequence(&Track::new(&layout.corners()), layout);
        lacking(&sequence, layout)
            .into_iter()
            .map(|d| format!("{}; expected {}, found {}", d.message, d.expected.unwrap(), d.found.unwrap()))
            .collect()
    }

    #[test]
    fn nothing_is_said_about_a_layout_on_the_grid() {
        assert_eq!(warnings(&fixture::rectangle(20.3, 10.7, 4.0)), Vec::<String>::new());
    }

    #[test]
    fn each_curve_and_straight_is_named_once() {
        let mut layout = fixture::rectangle(20.0, 10.5, 4.0);
        layout.vertices[2].radius.value = 4.2;
        layout.catalog.straight.cut = None;
        assert_eq!(
            warnings(&layout),
            [
                "no straight of catalogue `thesis` covers P2..P3; \
                 expected a sum of lengths of 1, 2 or 3 m, found 2.3 m",
                "catalogue `thesis` has no curve of 90° with a radius of 4200 mm, as P3 needs; \
                 expected a radius of 3, 4, 5, 6, 7 or 8 m, found 4.2 m",
                "no straight of catalogue `thesis` covers P3..P4; \
                 expected a sum of lengths of 1, 2 or 3 m, found 11.8 m",
                "no straight of catalogue `thesis` covers P4..P1; \
                 expected a sum of lengths of 1, 2 or 3 m, found 2.5 m",
            ]
        );
    }

    #[test]
    fn a_turn_off_the_grid_is_named() {
        let layout =
            fixture::loop_through("odd", &[(0.0, 0.0, 4.0), (30.0, 0.0, 4.0), (30.0, 20.0, 4.0), (0.0, 19.0, 4.0)]);
        assert_eq!(
            warnings(&layout),
            [
                "catalogue `thesis` has no curve of 91.9092° with a radius of 4000 mm, as P3 needs; \
                 expected a multiple of 2.5°, found 91.9092°",
                "catalogue `thesis` has no curve of 88.0908° with a radius of 4000 mm, as P4 needs; \
                 expected a multiple of 2.5°, found 88.0908°",
            ]
        );
    }
}
