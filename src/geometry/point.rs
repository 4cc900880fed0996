//! Points and vectors in the plane, metres.

use serde::{Deserialize, Serialize};
use std::ops::{Add, Mul, Neg, Sub};

use crate::base::trig;

/// A point or a vector, m.
#[derive(Clone, Copy, Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Point {
    pub x: f64,
    pub y: f64,
}

impl Point {
    pub const fn new(x: f64, y: f64) -> Self {
        Point { x, y }
    }

    /// The unit vector at `heading` (rad from +x).
    pub fn unit(heading: f64) -> Self {
        let (sin, cos) = trig::sin_cos(heading);
        Point::new(cos, sin)
    }

    pub fn dot(self, other: Point) -> f64 {
        self.x * other.x + self.y * other.y
    }

    /// z of the cross product; positive when `other` lies to the left of `self`.
    pub fn cross(self, other: Point) -> f64 {
        self.x * other.y - self.y * other.x
    }

    pub fn norm(self) -> f64 {
        trig::hypot(self.x, self.y)
    }

    pub fn distance(self, other: Point) -> f64 {
        (other - self).norm()
    }

    /// Direction of the vector, rad in (-π, π].
    pub fn heading(self) -> f64 {
        trig::atan2(self.y, self.x)
    }

    /// The vector turned left by a right angle.
    pub fn left(self) -> Point {
        Point::new(-self.y, self.x)
    }

    pub fn lerp(self, other: Point, t: f64) -> Point {
        self + (other - self) * t
    }
}

impl Add for Point {
    type Output = Point;
    fn add(self, o: Point) -> Point {
        Point::new(self.x + o.x, self.y + o.y)
    }
}

impl Sub for Point {
    type Output = Point;
    fn sub(self, o: Point) -> Point {
        Point::new(self.x - o.x, self.y - o.y)
    }
}

impl Mul<f64> for Point {
    type Output = Point;
    fn mul(self, k: f64) -> Point {
        Point::new(self.x * k, self.y * k)
    }
}

impl Neg for Point {
    type Output = Point;
    fn neg(self) -> Point {
        Point::new(-self.x, -self.y)
    }
}
