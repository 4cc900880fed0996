//! From the course to the pieces in driving order.

use super::course::{Course, CourseRun, SNAP};
use super::{Cover, Element, Sequence, Shape, cover};
use crate::base::{number, trig};
use crate::geometry::Track;
use crate::model::{Catalog, Layout};

/// Covers the centre line with standard elements of the layout's catalogue, in driving order from vertex 0's outgoing
/// tangent point.
///
/// Turns and radii within 1e-6 of the catalogue's grid are put on it, and straights then change by as much as the
/// solver's tolerance let them, so that walking the elements closes to 1e-9 m and 1e-9 rad. What the catalogue does not
/// have is a special piece, with [`Element::in_catalog`] unset; see [`super::lacking`].
pub fn sequence(track: &Track, layout: &Layout) -> Sequence {
    let course = Course::new(track, layout);
    let wanted = Cover::of(layout);
    let (mut position, mut heading, mut s) = (course.begin, trig::wrap(course.heading), 0.0);
    let begin = (position, heading);
    let mut elements = Vec::new();
    for run in &course.runs {
        let (shapes, in_catalog) = pieces(run, &layout.catalog, wanted);
        for shape in shapes {
            let article = article(&shape, in_catalog, &layout.catalog);
            let (length, vertex) = (shape.length(), run.vertex);
            elements.push(Element { shape, article, position, heading, s, length, vertex, in_catalog });
            (position, heading) = shape.advance(position, heading);
            s += length;
        }
    }
    Sequence { elements, closure: position.distance(begin.0), closure_heading: trig::wrap(heading - begin.1).abs() }
}

/// The pieces of a run, and whether the catalogue has them.
fn pieces(run: &CourseRun, catalog: &Catalog, wanted: Cover) -> (Vec<Shape>, bool) {
    match run.shape {
        Shape::Straight { length, .. } if length <= 0.0 => (Vec::new(), true),
        Shape::Straight { length, .. } => match cover::straight(length, &catalog.straight, wanted) {
            Some(parts) => {
                (parts.into_iter().map(|p| Shape::Straight { length: p.length, cut: p.cut }).collect(), true)
            }
            None => (vec![Shape::Straight { length, cut: true }], false),
        },
        Shape::Curve { radius, turn } => {
            let largest = ((catalog.curve.largest + SNAP) / catalog.curve.angle_step).floor() as usize;
            let on_grid = run.steps.and_then(|steps| cover::turn(steps, largest));
            match (on_grid, run.steps) {
                (Some(parts), Some(steps)) => {
                    let step = turn / steps as f64;
                    let shapes = parts.into_iter().map(|k| Shape::Curve { radius, turn: step * k as f64 });
                    (shapes.collect(), run.listed)
                }
                _ => (vec![run.shape], false),
            }
        }
    }
}

/// The article number: `ST-3000` is the straight of 3000 mm, cut or not; `CU-4000-45` the curve with a radius of
/// 4000 mm and a turn of 45°. Turned end for end, a left curve is a right one, so both hands are one article. A special
/// piece, which the catalogue does not have, is `X-CU-4100-45`.
fn article(shape: &Shape, in_catalog: bool, catalog: &Catalog) -> String {
    let special = if in_catalog { "" } else { "X-" };
    match *shape {
        Shape::Straight { length, .. } => format!("{special}{}-{}", catalog.straight.article, millimetres(length)),
        Shape::Curve { radius, turn } => {
            format!("{special}{}-{}-{}", catalog.curve.article, millimetres(radius), degrees(turn))
        }
    }
}

/// To the micrometre: nobody saws finer.
pub fn millimetres(length: f64) -> String {
    number::trimmed(length * 1000.0, 3)
}

/// Size of an angle to 0.0001° (14 µm on a radius of 8 m).
pub fn degrees(angle: f64) -> String {
    number::trimmed(angle.abs().to_degrees(), 4)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Point;
    use crate::model::{fixture, instances::thesis10};
    use crate::solve;
    use proptest::prelude::*;

    fn build(layout: &Layout) -> Sequence {
        sequence(&Track::new(&layout.corners()), layout)
    }

    fn articles(sequence: &Sequence) -> Vec<&str> {
        sequence.elements.iter().map(|e| e.article.as_str()).collect()
    }

    #[test]
    fn a_rectangle_in_pieces() {
        let sequence = build(&fixture::rectangle(20.0, 10.5, 4.0));
        let long = ["ST-3000", "ST-3000", "ST-3000", "ST-3000", "CU-4000-45", "CU-4000-45"];
        let short = ["ST-2500", "CU-4000-45", "CU-4000-45"];
        assert_eq!(articles(&sequence), [&long[..], &short, &long, &short].concat());
        assert!(sequence.elements.iter().all(|e| e.in_catalog));
        // The second curve ends at (20, 4): the first begins at (16, 0), and half of it lies at 45°.
        let half = &sequence.elements[5];
        let diagonal = 4.0 * std::f64::consts::FRAC_1_SQRT_2;
        assert!(half.position.distance(Point::new(16.0 + diagonal, 4.0 - diagonal)) < 1e-12);
        assert!((half.heading - trig::PI / 4.0).abs() < 1e-15);
        assert!((half.s - (12.0 + trig::PI)).abs() < 1e-12);
        assert!(sequence.closure < 1e-12 && sequence.closure_heading < 1e-12);
        assert!((sequence.length() - (2.0 * 14.5 + 8.0 * trig::PI)).abs() < 1e-12);
    }

    #[test]
    fn a_right_curve_is_the_same_article() {
        // An L-shaped loop: five left curves, one right.
        let corners =
            [(0.0, 0.0), (30.0, 0.0), (30.0, 12.0), (15.0, 12.0), (15.0, 25.0), (0.0, 25.0)].map(|(x, y)| (x, y, 4.0));
        let layout = fixture::loop_through("l", &corners);
        let sequence = build(&layout);
        let turns: Vec<f64> = sequence
            .elements
            .iter()
            .filter(|e| e.article == "CU-4000-45")
            .map(|e| if let Shape::Curve { turn, .. } = e.shape { turn.to_degrees().round() } else { 0.0 })
            .collect();
        assert_eq!(turns.iter().filter(|t| **t == 45.0).count(), 10);
        assert_eq!(turns.iter().filter(|t| **t == -45.0).count(), 2);
        assert!(sequence.closure < 1e-12);
    }

    #[test]
    fn what_the_catalogue_lacks_is_one_special_piece() {
        let mut layout = fixture::rectangle(20.0, 10.5, 4.0);
        layout.vertices[2].radius.value = 4.2;
        layout.catalog.straight.cut = None;
        let sequence = build(&layout);
        let special: Vec<_> = sequence.elements.iter().filter(|e| !e.in_catalog).map(|e| e.article.as_str()).collect();
        assert_eq!(special, ["X-ST-2300", "X-CU-4200-45", "X-CU-4200-45", "X-ST-11800", "X-ST-2500"]);
        assert!(sequence.closure < 1e-12);
    }

    /// As written, none of the thesis instance's turns is on the grid.
    #[test]
    fn the_thesis_layout_closes_as_written() {
        let sequence = build(&thesis10());
        assert!(sequence.closure < 1e-9 && sequence.closure_heading < 1e-9);
        assert!((sequence.length() - 213.999_233_438_034_1).abs() < 1e-9);
        let special = sequence.elements.iter().filter(|e| !e.in_catalog);
        assert!(special.clone().all(|e| matches!(e.shape, Shape::Curve { .. })));
        assert_eq!(special.count(), 10);
    }

    /// What the third stage leaves can be ordered, and hardly differs from what it was.
    #[test]
    fn the_solved_thesis_layout_is_covered() {
        let layout = thesis10();
        let stages = solve::solve(&layout, &solve::Options::default(), &|_| ());
        let track = Track::new(&stages.last().unwrap().corners);
        let sequence = sequence(&track, &layout);
        assert!(sequence.elements.iter().all(|e| e.in_catalog));
        assert!(sequence.closure < 1e-9 && sequence.closure_heading < 1e-9);
        assert!((sequence.length() - track.length).abs() < 1e-5);
        for element in &sequence.elements {
            let drawn = track.at(element.s).0;
            assert!(element.position.distance(drawn) < 1e-5, "{} {drawn:?}", element.article);
        }
    }

    proptest! {
        /// A solver's result: a loop on the grid, disturbed by less than its tolerance.
        #[test]
        fn disturbed_loops_close(
            width in 10.0..80.0f64,
            height in 10.0..80.0f64,
            radius in 3u32..=5,
            shifts in prop::collection::vec(-1e-6..1e-6f64, 12),
        ) {
            let mut layout = fixture::rectangle(width, height, f64::from(radius));
            for (vertex, shift) in layout.vertices.iter_mut().zip(shifts.chunks(3)) {
                vertex.point = vertex.point + Point::new(shift[0], shift[1]);
                vertex.radius.value += shift[2];
            }
            let track = Track::new(&layout.corners());
            let sequence = sequence(&track, &layout);
            prop_assert!(sequence.closure < 1e-9, "{}", sequence.closure);
            prop_assert!(sequence.closure_heading < 1e-9);
            prop_assert!(sequence.elements.iter().all(|e| e.in_catalog));
            for piece in &track.pieces {
                let kind = matches!(piece.kind, crate::geometry::PieceKind::Straight);
                let covered: f64 = sequence
                    .elements
                    .iter()
                    .filter(|e| e.vertex == piece.vertex && matches!(e.shape, Shape::Straight { .. }) == kind)
                    .map(|e| e.length)
                    .sum();
                prop_assert!((covered - piece.length).abs() < 1e-4, "{covered} {}", piece.length);
            }
        }
    }
}
