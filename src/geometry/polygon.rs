//! Simple polygons: obstacles and buildings.

use serde::Serialize;

use super::Point;

/// A simple polygon, counter-clockwise, at least three points, no two neighbours alike.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(transparent)]
pub struct Polygon {
    points: Vec<Point>,
}

/// Why a list of points is not a simple polygon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NotSimple {
    TooFewPoints,
    /// Points `i` and `i + 1` coincide.
    Repeated(usize),
    /// The edges that begin at these points cross or touch.
    Crossing(usize, usize),
    /// All points lie on one line.
    Flat,
}

impl Polygon {
    /// Checks that the outline is simple and orders it counter-clockwise.
    pub fn new(mut points: Vec<Point>) -> Result<Self, NotSimple> {
        let n = points.len();
        if n < 3 {
            return Err(NotSimple::TooFewPoints);
        }
        if let Some(i) = (0..n).find(|&i| points[i].distance(points[(i + 1) % n]) < 1e-9) {
            return Err(NotSimple::Repeated(i));
        }
        for i in 0..n {
            let (a, b) = (points[i], points[(i + 1) % n]);
            // Neighbours may only share their common point: no spike back along the edge.
            let c = points[(i + 2) % n];
            if (b - a).cross(c - b).abs() < 1e-12 && (b - a).dot(c - b) < 0.0 {
                return Err(NotSimple::Crossing(i, (i + 1) % n));
            }
            for j in i + 2..n {
                if (j + 1) % n != i && segments_meet(a, b, points[j], points[(j + 1) % n]) {
                    return Err(NotSimple::Crossing(i, j));
                }
            }
        }
        let area = signed_area(&points);
        if area.abs() < 1e-9 {
            return Err(NotSimple::Flat);
        }
        if area < 0.0 {
            points.reverse();
        }
        Ok(Polygon { points })
    }

    /// Counter-clockwise.
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// Edges in counter-clockwise order; the inside lies to the left of each.
    pub fn edges(&self) -> impl Iterator<Item = (Point, Point)> + '_ {
        let n = self.points.len();
        (0..n).map(move |i| (self.points[i], self.points[(i + 1) % n]))
    }

    /// m²
    pub fn area(&self) -> f64 {
        signed_area(&self.points)
    }

    /// Whether the point lies inside (even-odd rule; undecided on the outline).
    pub fn contains(&self, p: Point) -> bool {
        let mut inside = false;
        for (a, b) in self.edges() {
            if (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x) {
                inside = !inside;
            }
        }
        inside
    }

    /// Distance to the outline, m, ≥ 0.
    pub fn distance_to_outline(&self, p: Point) -> f64 {
        self.edges().map(|(a, b)| distance_to_segment(p, a, b)).fold(f64::INFINITY, f64::min)
    }

    /// Smallest and largest coordinates.
    pub fn bounds(&self) -> (Point, Point) {
        bounds(self.points.iter().copied())
    }

    /// Whether the corner at point `i` is convex seen from the inside.
    pub fn is_convex_at(&self, i: usize) -> bool {
        let n = self.points.len();
        let (a, b, c) = (self.points[(i + n - 1) % n], self.points[i], self.points[(i + 1) % n]);
        (b - a).cross(c - b) > 0.0
    }
}

/// Smallest and largest coordinates of some points.
pub fn bounds(points: impl Iterator<Item = Point>) -> (Point, Point) {
    let mut low = Point::new(f64::INFINITY, f64::INFINITY);
    let mut high = Point::new(f64::NEG_INFINITY, f64::NEG_INFINITY);
    for p in points {
        low = Point::new(low.x.min(p.x), low.y.min(p.y));
        high = Point::new(high.x.max(p.x), high.y.max(p.y));
    }
    (low, high)
}

/// Distance from `p` to the segment `a`..`b`, m.
pub fn distance_to_segment(p: Point, a: Point, b: Point) -> f64 {
    let d = b - a;
    let t = ((p - a).dot(d) / d.dot(d)).clamp(0.0, 1.0);
    p.distance(a.lerp(b, t))
}

fn signed_area(points: &[Point]) -> f64 {
    let n = points.len();
    (0..n).map(|i| points[i].cross(points[(i + 1) % n])).sum::<f64>() / 2.0
}

/// Whether two closed segments have a point in common.
pub(crate) fn segments_meet(a: Point, b: Point, c: Point, d: Point) -> bool {
    let side = |p: Point, q: Point, r: Point| (q - p).cross(r - p);
    let (d1, d2) = (side(a, b, c), side(a, b, d));
    let (d3, d4) = (side(c, d, a), side(c, d, b));
    if d1 * d2 < 0.0 && d3 * d4 < 0.0 {
        return true;
    }
    let on = |p: Point, q: Point, r: Point, s: f64| s == 0.0 && (r - p).dot(r - q) <= 0.0;
    on(a, b, c, d1) || on(a, b, d, d2) || on(c, d, a, d3) || on(c, d, b, d4)
}
