//! The hall as a centre line sees it: what it keeps away from, and by how much.

use crate::geometry::{Point, Polygon};
use crate::model::Layout;
use crate::source::Span;

/// Rounding of distances, m. A path may come nearer by so much.
const SLACK: f64 = 1e-6;

/// A polygon that the centre line stays out of, or inside of.
#[derive(Clone, Debug)]
pub struct Keepout {
    pub name: String,
    pub polygon: Polygon,
    /// Whether it is the building, which the centre line stays inside of.
    pub inside: bool,
    /// m
    pub distance: f64,
    pub span: Span,
    bounds: (Point, Point),
}

/// A piece of track that others keep away from.
#[derive(Clone, Copy, Debug)]
pub struct Strand {
    pub begin: Point,
    pub end: Point,
    /// m
    pub distance: f64,
}

#[derive(Clone, Debug)]
pub struct Plane {
    pub keepouts: Vec<Keepout>,
    pub strands: Vec<Strand>,
}

impl Plane {
    pub fn new(layout: &Layout) -> Self {
        let half = layout.width.value / 2.0;
        let keepout = |name: &str, polygon: &Polygon, inside, clearance: f64, span| Keepout {
            name: name.to_owned(),
            bounds: polygon.bounds(),
            polygon: polygon.clone(),
            inside,
            distance: half + clearance,
            span,
        };
        let walls = layout.building.iter().map(|b| keepout("building", &b.polygon, true, b.clearance, b.span));
        let obstacles = layout.obstacles.iter().map(|o| keepout(&o.name, &o.polygon, false, o.clearance, o.span));
        Plane { keepouts: walls.chain(obstacles).collect(), strands: Vec::new() }
    }

    /// The same hall without one of its obstacles.
    pub fn without(&self, keepout: usize) -> Plane {
        let mut keepouts = self.keepouts.clone();
        keepouts.remove(keepout);
        Plane { keepouts, strands: self.strands.clone() }
    }

    /// The same hall with track in it.
    pub fn with(&self, strands: &[Strand]) -> Plane {
        Plane { keepouts: self.keepouts.clone(), strands: [&self.strands[..], strands].concat() }
    }

    /// What a straight comes too close to.
    pub fn blocking(&self, a: Point, b: Point) -> Option<&Keepout> {
        self.keepouts.iter().find(|k| k.blocks(a, b))
    }

    pub fn is_clear(&self, a: Point, b: Point) -> bool {
        self.blocking(a, b).is_none() && !self.strands.iter().any(|s| s.blocks(a, b))
    }

    /// Whether a circle's arc is clear, in points that lie no more than about ten degrees apart. `from` and `to` are
    /// the directions of travel, `hand` is 1 for a left turn.
    pub fn arc_is_clear(&self, centre: Point, radius: f64, hand: f64, from: Point, turn: f64) -> bool {
        let count = (turn / 0.17).ceil().max(1.0) as usize;
        let start = from.heading();
        (0..=count).all(|k| {
            let heading = start + hand * turn * k as f64 / count as f64;
            let point = centre - Point::unit(heading).left() * (hand * radius);
            self.is_clear(point, point)
        })
    }

    /// Corners about which a taut line may bend, with the distance that it keeps from them.
    pub fn corners(&self) -> Vec<(Point, f64)> {
        let of = |k: &Keepout| {
            let points = k.polygon.points().to_vec();
            let bends = (0..points.len()).filter(|&i| k.polygon.is_convex_at(i) != k.inside).collect::<Vec<_>>();
            bends.into_iter().map(|i| (points[i], k.distance)).collect::<Vec<_>>()
        };
        let mut corners: Vec<(Point, f64)> = self.keepouts.iter().flat_map(of).collect();
        for end in self.strands.iter().flat_map(|s| [(s.begin, s.distance), (s.end, s.distance)]) {
            // Strands that follow each other have an end in common.
            if corners.last() != Some(&end) {
                corners.push(end);
            }
        }
        corners
    }
}

impl Strand {
    fn blocks(&self, a: Point, b: Point) -> bool {
        between(a, b, self.begin, self.end) < self.distance - SLACK
    }
}

impl Keepout {
    fn blocks(&self, a: Point, b: Point) -> bool {
        let reach = self.distance - SLACK;
        if self.inside {
            return !self.polygon.contains(a) || !self.polygon.contains(b) || self.is_near(a, b, reach);
        }
        let (low, high) = self.bounds;
        let apart = |a: f64, b: f64, low: f64, high: f64| a.max(b) < low - reach || a.min(b) > high + reach;
        if apart(a.x, b.x, low.x, high.x) || apart(a.y, b.y, low.y, high.y) {
            return false;
        }
        self.polygon.contains(a) || self.is_near(a, b, reach)
    }

    fn is_near(&self, a: Point, b: Point, reach: f64) -> bool {
        self.polygon.edges().any(|(c, d)| between(a, b, c, d) < reach)
    }
}

/// Distance between two segments, m; either may be a point.
pub fn between(a: Point, b: Point, c: Point, d: Point) -> f64 {
    let side = |p: Point, q: Point, r: Point| (q - p).cross(r - p);
    if side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0 {
        return 0.0;
    }
    let to = |p: Point, a: Point, b: Point| {
        let along = b - a;
        let square = along.dot(along);
        let t = if square > 0.0 { ((p - a).dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
        p.distance(a.lerp(b, t))
    };
    to(a, c, d).min(to(b, c, d)).min(to(c, a, b)).min(to(d, a, b))
}
