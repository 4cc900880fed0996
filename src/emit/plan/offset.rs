//! Outlines at a distance from a polygon: the boundary of its Minkowski sum with a disc, as lines and arcs.
//!
//! Each edge gives a parallel line and each corner that opens away from it an arc about the corner. Cut at every
//! crossing, exactly those parts belong to the outline that are nowhere nearer to the polygon than the distance.

use crate::base::trig;
use crate::geometry::{Point, Polygon};

use super::PlanCurve;

/// Fractions nearer than this to an end are no cut.
const END: f64 = 1e-9;

/// Points outside the polygon at `distance` (m) from it, in counter-clockwise order.
pub fn outset(polygon: &Polygon, distance: f64) -> Vec<PlanCurve> {
    offset(polygon, distance, 1.0)
}

/// Points inside the polygon at `distance` (m) from its outline.
pub fn inset(polygon: &Polygon, distance: f64) -> Vec<PlanCurve> {
    offset(polygon, distance, -1.0)
}

/// `outward` is +1 outside and -1 inside.
fn offset(polygon: &Polygon, distance: f64, outward: f64) -> Vec<PlanCurve> {
    if distance <= 0.0 {
        return Vec::new();
    }
    let raw = raw(polygon, distance, outward);
    let mut kept = Vec::new();
    for (i, curve) in raw.iter().enumerate() {
        let mut cuts = vec![0.0, 1.0];
        for (_, other) in raw.iter().enumerate().filter(|(j, _)| *j != i) {
            cuts.extend(crossings(curve, other).into_iter().filter(|t| *t > END && *t < 1.0 - END));
        }
        cuts.sort_by(f64::total_cmp);
        for pair in cuts.windows(2) {
            let middle = curve.at((pair[0] + pair[1]) / 2.0);
            let free = polygon.distance_to_outline(middle) > distance - 1e-7 * distance.max(1.0);
            if pair[1] - pair[0] > END && free && polygon.contains(middle) == (outward < 0.0) {
                kept.push(curve.part(pair[0], pair[1]));
            }
        }
    }
    kept
}

/// The parallel of each edge, and the arc about each corner on whose side it opens.
fn raw(polygon: &Polygon, distance: f64, outward: f64) -> Vec<PlanCurve> {
    let points = polygon.points();
    let n = points.len();
    let mut curves = Vec::with_capacity(2 * n);
    for (i, (a, b)) in polygon.edges().enumerate() {
        let along = b - a;
        let across = along.left() * (-outward * distance / along.norm());
        curves.push(PlanCurve::Line { begin: a + across, end: b + across });
        let next = points[(i + 2) % n] - b;
        let turn = trig::atan2(along.cross(next), along.dot(next));
        if turn * outward > 0.0 {
            curves.push(PlanCurve::Arc { centre: b, radius: distance, start: across.heading(), sweep: turn });
        }
    }
    curves
}

/// Fractions of `curve` at which it meets `other`.
fn crossings(curve: &PlanCurve, other: &PlanCurve) -> Vec<f64> {
    let points = match (*curve, *other) {
        (PlanCurve::Line { begin: a, end: b }, PlanCurve::Line { begin: c, end: d }) => line_line(a, b, c, d),
        (PlanCurve::Line { begin, end }, PlanCurve::Arc { centre, radius, .. })
        | (PlanCurve::Arc { centre, radius, .. }, PlanCurve::Line { begin, end }) => {
            line_circle(begin, end, centre, radius)
        }
        (PlanCurve::Arc { centre: c, radius: r, .. }, PlanCurve::Arc { centre: d, .. }) => equal_circles(c, d, r),
    };
    points.into_iter().filter_map(|p| fraction(curve, p)).collect()
}

fn line_line(a: Point, b: Point, c: Point, d: Point) -> Vec<Point> {
    let (u, v) = (b - a, d - c);
    let cross = u.cross(v);
    if cross.abs() < 1e-12 * u.norm() * v.norm() {
        return Vec::new();
    }
    vec![a + u * ((c - a).cross(v) / cross)]
}

fn line_circle(a: Point, b: Point, centre: Point, radius: f64) -> Vec<Point> {
    let along = (b - a) * (1.0 / a.distance(b));
    let foot = a + along * (centre - a).dot(along);
    let square = radius * radius - foot.distance(centre) * foot.distance(centre);
    if square < 0.0 {
        return Vec::new();
    }
    vec![foot - along * square.sqrt(), foot + along * square.sqrt()]
}

fn equal_circles(c: Point, d: Point, radius: f64) -> Vec<Point> {
    let between = c.distance(d);
    let square = radius * radius - between * between / 4.0;
    if between < 1e-12 || square < 0.0 {
        return Vec::new();
    }
    let middle = c.lerp(d, 0.5);
    let across = (d - c).left() * (square.sqrt() / between);
    vec![middle + across, middle - across]
}

/// Where on the curve a point of its line or circle lies; `None` when beyond its ends.
pub(super) fn fraction(curve: &PlanCurve, p: Point) -> Option<f64> {
    let t = match *curve {
        PlanCurve::Line { begin, end } => (p - begin).dot(end - begin) / (end - begin).dot(end - begin),
        PlanCurve::Arc { centre, start, sweep, .. } => {
            let ahead = (((p - centre).heading() - start) * sweep.signum()).rem_euclid(trig::TAU);
            ahead / sweep.abs()
        }
    };
    (0.0..=1.0).contains(&t).then_some(t)
}

#[cfg(test)]
mod tests {
    use super::super::samples::polygon;
    use super::*;

    fn length(curves: &[PlanCurve]) -> f64 {
        curves.iter().map(PlanCurve::length).sum()
    }

    #[test]
    fn a_convex_outline_grows_by_the_circle() {
        let square = polygon(&[(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)]);
        let curves = outset(&square, 0.5);
        assert_eq!(curves.len(), 8);
        assert!((length(&curves) - (14.0 + trig::PI)).abs() < 1e-9);
        let inner = inset(&square, 0.5);
        assert!((length(&inner) - 10.0).abs() < 1e-9, "{inner:?}");
    }

    #[test]
    fn a_slot_narrower_than_twice_the_distance_closes() {
        let slot =
            polygon(&[(0.0, 0.0), (5.0, 0.0), (5.0, 4.0), (3.0, 4.0), (3.0, 1.0), (2.0, 1.0), (2.0, 4.0), (0.0, 4.0)]);
        for distance in [0.3, 0.6, 2.0] {
            let curves = outset(&slot, distance);
            for curve in &curves {
                for t in [0.01, 0.5, 0.99] {
                    let p = curve.at(t);
                    assert!((slot.distance_to_outline(p) - distance).abs() < 1e-6, "{distance} {p:?}");
                }
            }
            // A closed chain: every end is another's begin.
            for (i, curve) in curves.iter().enumerate() {
                assert!(curve.end().distance(curves[(i + 1) % curves.len()].begin()) < 1e-6, "{distance}");
            }
        }
        // Two arcs about the slot's mouth meet above its middle.
        let closed = outset(&slot, 0.6);
        assert!(closed.iter().any(|c| c.end().distance(Point::new(2.5, 4.0 + (0.36_f64 - 0.25).sqrt())) < 1e-9));
    }

    #[test]
    fn nothing_is_left_inside_a_room_too_narrow() {
        let room = polygon(&[(0.0, 0.0), (4.0, 0.0), (4.0, 1.0), (0.0, 1.0)]);
        assert!(inset(&room, 0.6).is_empty());
        assert!(outset(&room, 0.0).is_empty());
    }
}
