//! Points on paper, which are no points of the hall: `y` points down, and the unit is the drawing's own. What lies in
//! the hall gets there through a [`Projection`] and in no other way.

use std::ops::{Add, Mul, Neg, Sub};

use crate::base::trig;
use crate::geometry::Point;

/// A point or a vector on paper, y down: mm on a sheet, px on a page.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct PaperPoint {
    pub x: f64,
    pub y: f64,
}

impl PaperPoint {
    pub const fn new(x: f64, y: f64) -> Self {
        PaperPoint { x, y }
    }

    /// The unit vector at `angle` (rad from +x, clockwise as one looks at the paper).
    pub fn unit(angle: f64) -> Self {
        let (sin, cos) = trig::sin_cos(angle);
        PaperPoint::new(cos, sin)
    }

    pub fn dot(self, other: PaperPoint) -> f64 {
        self.x * other.x + self.y * other.y
    }

    pub fn norm(self) -> f64 {
        trig::hypot(self.x, self.y)
    }

    pub fn distance(self, other: PaperPoint) -> f64 {
        (other - self).norm()
    }

    /// The vector turned by a right angle, clockwise as one looks at the paper.
    pub fn across(self) -> PaperPoint {
        PaperPoint::new(-self.y, self.x)
    }

    pub fn lerp(self, other: PaperPoint, t: f64) -> PaperPoint {
        self + (other - self) * t
    }
}

impl Add for PaperPoint {
    type Output = PaperPoint;
    fn add(self, o: PaperPoint) -> PaperPoint {
        PaperPoint::new(self.x + o.x, self.y + o.y)
    }
}

impl Sub for PaperPoint {
    type Output = PaperPoint;
    fn sub(self, o: PaperPoint) -> PaperPoint {
        PaperPoint::new(self.x - o.x, self.y - o.y)
    }
}

impl Mul<f64> for PaperPoint {
    type Output = PaperPoint;
    fn mul(self, k: f64) -> PaperPoint {
        PaperPoint::new(self.x * k, self.y * k)
    }
}

impl Neg for PaperPoint {
    type Output = PaperPoint;
    fn neg(self) -> PaperPoint {
        PaperPoint::new(-self.x, -self.y)
    }
}

/// Smallest and largest coordinates of some points.
pub fn bounds(points: impl Iterator<Item = PaperPoint>) -> (PaperPoint, PaperPoint) {
    let infinite = PaperPoint::new(f64::INFINITY, f64::INFINITY);
    points.fold((infinite, -infinite), |(low, high), p| {
        (PaperPoint::new(low.x.min(p.x), low.y.min(p.y)), PaperPoint::new(high.x.max(p.x), high.y.max(p.y)))
    })
}

/// The way from the hall, seen from above, to paper.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    /// A point of the hall, m, and where it lies on paper.
    pub floor: Point,
    pub paper: PaperPoint,
    /// Units of the paper a metre.
    pub scale: f64,
}

impl Projection {
    /// A point of the hall on paper.
    pub fn at(&self, p: Point) -> PaperPoint {
        self.paper + Projection::turned(p - self.floor) * self.scale
    }

    /// The point of the hall that lies here on paper.
    pub fn floor_at(&self, p: PaperPoint) -> Point {
        let vector = (p - self.paper) * (1.0 / self.scale);
        self.floor + Point::new(vector.x, -vector.y)
    }

    /// A vector in the hall as a vector on paper, of the same length.
    pub fn turned(vector: Point) -> PaperPoint {
        PaperPoint::new(vector.x, -vector.y)
    }

    /// The unit vector on paper of a heading (rad) in the hall.
    pub fn direction(heading: f64) -> PaperPoint {
        Projection::turned(Point::unit(heading))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hall_is_scaled_and_y_points_down() {
        let projection = Projection { floor: Point::new(1.0, 2.0), paper: PaperPoint::new(10.0, 20.0), scale: 5.0 };
        assert_eq!(projection.at(Point::new(1.0, 2.0)), PaperPoint::new(10.0, 20.0));
        assert_eq!(projection.at(Point::new(3.0, 3.0)), PaperPoint::new(20.0, 15.0));
        assert_eq!(projection.floor_at(projection.at(Point::new(3.0, 3.0))), Point::new(3.0, 3.0));
        let left = Projection::direction(trig::FRAC_PI_2);
        assert!(left.distance(PaperPoint::new(0.0, -1.0)) < 1e-15);
        assert!(left.distance(Projection::direction(0.0).across() * -1.0) < 1e-15, "left is against the clock");
    }

    #[test]
    fn bounds_hold_every_point() {
        let points = [(1.0, 5.0), (-2.0, 7.0), (3.0, 6.0)].map(|(x, y)| PaperPoint::new(x, y));
        assert_eq!(bounds(points.into_iter()), (PaperPoint::new(-2.0, 5.0), PaperPoint::new(3.0, 7.0)));
    }
}
