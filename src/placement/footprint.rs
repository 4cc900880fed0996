//! Rectangles beside a straight: what a piece of equipment covers, and the room that it needs around it.

use crate::geometry::{Piece, Point};
use crate::model::EquipmentType;

/// Rectangles that overlap by less than this touch, m.
pub const TOUCH: f64 = 1e-6;

/// A straight of the track, seen along it.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    /// Where it begins.
    pub begin: Point,
    /// Unit vector of travel.
    pub along: Point,
    /// m
    pub length: f64,
}

impl Line {
    pub fn of(piece: &Piece) -> Line {
        Line { begin: piece.begin, along: Point::unit(piece.heading), length: piece.length }
    }

    /// The point so far along and to the left of it, m.
    pub fn at(&self, along: f64, left: f64) -> Point {
        self.begin + self.along * along + self.along.left() * left
    }

    /// How far along and to the left of it a point lies, m.
    pub fn local(&self, p: Point) -> Point {
        let d = p - self.begin;
        Point::new(d.dot(self.along), d.dot(self.along.left()))
    }
}

/// A rectangle with its corners in order.
pub type Rectangle = [Point; 4];

/// The rectangle from `a.0` to `b.0` along a straight and from `a.1` to `b.1` beside it, m.
pub fn rectangle(line: &Line, along: (f64, f64), left: (f64, f64)) -> Rectangle {
    [line.at(along.0, left.0), line.at(along.1, left.0), line.at(along.1, left.1), line.at(along.0, left.1)]
}

/// Whether two convex polygons overlap by more than a touch: no edge of either separates them.
pub fn overlap(a: &[Point], b: &[Point]) -> bool {
    let separates = |of: &[Point], other: &[Point]| {
        (0..of.len()).any(|i| {
            let edge = of[(i + 1) % of.len()] - of[i];
            let length = edge.norm();
            if length < 1e-9 {
                return false;
            }
            let normal = edge.left() * (1.0 / length);
            let range = |points: &[Point]| {
                points
                    .iter()
                    .map(|p| normal.dot(*p))
                    .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), d| (low.min(d), high.max(d)))
            };
            let ((la, ha), (lb, hb)) = (range(of), range(other));
            ha.min(hb) - la.max(lb) <= TOUCH
        })
    };
    // What has no area covers nothing.
    let flat = |points: &[Point]| area(points).abs() < TOUCH;
    !flat(a) && !flat(b) && !separates(a, b) && !separates(b, a)
}

fn area(points: &[Point]) -> f64 {
    let n = points.len();
    (0..n).map(|i| points[i].cross(points[(i + 1) % n])).sum::<f64>() / 2.0
}

/// One piece of equipment at its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Footprint {
    /// What it covers: one rectangle a side that it stands on.
    pub covers: Vec<Rectangle>,
    /// These with the room around them.
    pub room: Vec<Rectangle>,
}

impl Footprint {
    /// Of a kind whose stretch begins so far along a straight. Sides are +1 to the left of travel and -1 to the right; the
    /// band's half width in m.
    pub fn new(of: &EquipmentType, line: &Line, begin: f64, sides: &[f64], half: f64) -> Footprint {
        let end = begin + of.stretch;
        let strip = |side: f64, beyond: f64| (side * half, side * (half + of.depth + beyond));
        let covers = sides.iter().map(|side| rectangle(line, (begin, end), strip(*side, 0.0)));
        let around = (begin - of.service, end + of.service);
        let room = sides.iter().map(|side| rectangle(line, around, strip(*side, of.aisle)));
        Footprint { covers: covers.collect(), room: room.collect() }
    }

    /// Where a conveyor from a point ends: in the middle of the outer edge, of two sides on the nearer one.
    pub fn conveyor_end(&self, from: Point) -> Option<Point> {
        // The rectangles' third and fourth corners are the outer ones.
        let ends = self.covers.iter().map(|r| r[2].lerp(r[3], 0.5));
        ends.min_by(|a, b| a.distance(from).total_cmp(&b.distance(from)))
    }

    /// Whether one of the two stands in the other or in the room that the other needs.
    pub fn meets(&self, other: &Footprint) -> bool {
        let any = |a: &[Rectangle], b: &[Rectangle]| a.iter().any(|a| b.iter().any(|b| overlap(a, b)));
        any(&self.covers, &other.room) || any(&self.room, &other.covers)
    }
}

/// The length of the conveyor that feeds a piece of equipment, m: to [`Footprint::conveyor_end`].
pub fn conveyor(of: &EquipmentType, line: &Line, begin: f64, sides: &[f64], half: f64, from: Point) -> f64 {
    let middle = begin + 0.5 * of.stretch;
    let ends = sides.iter().map(|side| line.at(middle, side * (half + of.depth)));
    ends.map(|end| end.distance(from)).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rectangles_that_touch_do_not_overlap() {
        let square = |x: f64, y: f64| -> Rectangle {
            [Point::new(x, y), Point::new(x + 1.0, y), Point::new(x + 1.0, y + 1.0), Point::new(x, y + 1.0)]
        };
        assert!(overlap(&square(0.0, 0.0), &square(0.9, 0.9)));
        assert!(!overlap(&square(0.0, 0.0), &square(1.0, 0.0)));
        assert!(!overlap(&square(0.0, 0.0), &square(1.0, 1.0)));
        // A square on its corner reaches less far than its bounds.
        let turned = [Point::new(2.0, 1.0), Point::new(3.0, 2.0), Point::new(2.0, 3.0), Point::new(1.0, 2.0)];
        assert!(!overlap(&square(0.4, 0.4), &turned));
        assert!(overlap(&square(0.6, 0.6), &turned));
    }
}
