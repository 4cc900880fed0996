//! The centre line as the wheels read it: segments that turn by at most 60° about one axis, each with the frame at its
//! middle, so that the nearest point of a line or an arc is one formula without branches or trigonometry.
//!
//! With a, b the point's coordinates along the tangent and towards the curvature κ at the middle, q = 2b − κ(a² + b²)
//! and w = √(1 − κq): the offset towards the curvature is q/(1 + w), the tangent has turned by ψ with sin ψ = κa/w and
//! cos ψ = (1 − κb)/w. For κ = 0 this is the straight line.

mod foot;
mod handover;

pub use foot::{Foot, Local, foot};
pub use handover::{Handover, feet};

use super::lanes::{Lane, Lane3};
use super::series::NEAR;
use super::state::{PACK, PackRow};
use crate::geometry::{CentreLine, Form};
use foot::scalar;
use nalgebra::Vector3;
use pulp::Scalar;

/// Largest turn of a segment, rad.
const LARGEST: f64 = 1.05;

/// How far past its end a segment still serves, m: so that rounding cannot send a point back and forth.
const SLACK: f64 = 1e-9;

/// A part of the centre line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// The middle, m.
    pub origin: Vector3<f64>,
    /// Unit tangent there.
    pub along: Vector3<f64>,
    /// Unit vector across it in the plane of curvature: n, or u of a vertical arc.
    pub inward: Vector3<f64>,
    /// Signed, towards `inward`, 1/m.
    pub curvature: f64,
    /// Largest |sin ψ|/κ, m; negative for a spiral, whose nearest point takes iteration.
    pub reach: f64,
    /// Arc length of the middle, m.
    pub s: f64,
    pub vertical: bool,
    /// Index of the piece of the centre line it belongs to.
    pub stretch: usize,
}

impl Segment {
    /// Curvature in plan, left positive, 1/m.
    pub fn turning(&self) -> f64 {
        if self.vertical { 0.0 } else { self.curvature }
    }

    /// Level unit vector to the left of the track at an arc length, m, as its middle's turned by κ(s − s₀).
    pub fn normal_at(&self, s: f64) -> Vector3<f64> {
        let left = Vector3::new(-self.along.y, self.along.x, 0.0).normalize();
        // Where the lap begins, s jumps; a segment does not reach half around.
        let ahead = s - self.s;
        let angle = if ahead.abs() * self.curvature.abs() < 3.2 { self.turning() * ahead } else { 0.0 };
        let (sin, cos) = (crate::base::trig::sin(angle), crate::base::trig::cos(angle));
        Vector3::new(cos * left.x - sin * left.y, sin * left.x + cos * left.y, 0.0)
    }
}

/// Where the points of a pack's carts that look at the centre line are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Homes {
    pub front: Home,
    /// Running wheels: left, right.
    pub running: [Home; 2],
    /// Where motors act; kept for carts over motors only, and sought from the front joint's when they come over one.
    pub motor: Home,
}

impl Homes {
    /// Sends all points of a cart to a segment.
    pub fn set(&mut self, lane: usize, index: usize, segment: &Segment) {
        let [left, right] = &mut self.running;
        for home in [&mut self.front, left, right, &mut self.motor] {
            home.set(lane, index, segment);
        }
    }
}

/// The segment of a point of each cart, by pack.
#[repr(C, align(64))]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Home {
    origin: [PackRow; 3],
    along: [PackRow; 3],
    inward: [PackRow; 3],
    curvature: PackRow,
    reach: PackRow,
    s: PackRow,
    /// 1 where the plane of curvature is vertical, else 0.
    vertical: PackRow,
    pub segment: [u32; PACK],
}

impl Home {
    /// Sends a cart's point to a segment.
    pub fn set(&mut self, lane: usize, index: usize, segment: &Segment) {
        for k in 0..3 {
            self.origin[k][lane] = segment.origin[k];
            self.along[k][lane] = segment.along[k];
            self.inward[k][lane] = segment.inward[k];
        }
        self.curvature[lane] = segment.curvature;
        self.reach[lane] = segment.reach;
        self.s[lane] = segment.s;
        self.vertical[lane] = f64::from(u8::from(segment.vertical));
        self.segment[lane] = index as u32;
    }
}

/// A foot in plain numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footing {
    pub segment: usize,
    /// Arc length, m.
    pub s: f64,
    pub tangent: [f64; 3],
    pub normal: [f64; 3],
    pub up: [f64; 3],
    pub y: f64,
    pub z: f64,
}

/// The whole centre line.
#[derive(Clone, Debug)]
pub struct Segments {
    pub list: Vec<Segment>,
    pub line: CentreLine,
    pub level: bool,
    /// Whether points can be so far from a curve's centre line that roots must be taken exactly.
    pub sharp: bool,
}

impl Segments {
    /// For points up to `widest` from the centre line, m.
    pub fn new(line: CentreLine, widest: f64) -> Self {
        let mut list = Vec::new();
        for (index, stretch) in line.stretches.iter().enumerate() {
            let (turn, curvature, vertical) = match stretch.form {
                Form::Straight { .. } => (0.0, 0.0, false),
                Form::Arc { radius, turn } => (turn.abs(), turn.signum() / radius, false),
                Form::Vertical { radius, slope_from, slope_to } => {
                    (stretch.length / radius, (slope_to - slope_from).signum() / radius, true)
                }
                Form::Spiral { .. } => (0.0, 0.0, false),
            };
            let spiral = matches!(stretch.form, Form::Spiral { .. });
            let parts = (turn / LARGEST).ceil().max(1.0) as usize;
            let half = stretch.length / parts as f64 / 2.0;
            for part in 0..parts {
                let d = (2 * part + 1) as f64 * half;
                let frame = stretch.at(d);
                let reach = if curvature == 0.0 {
                    half
                } else {
                    crate::base::trig::sin(half * curvature.abs()) / curvature.abs()
                };
                list.push(Segment {
                    origin: frame.position,
                    along: frame.tangent,
                    inward: if vertical { frame.up } else { frame.normal },
                    curvature,
                    reach: if spiral { -1.0 } else { reach + SLACK },
                    s: stretch.s + d,
                    vertical,
                    stretch: index,
                });
            }
        }
        let sharp = list.iter().any(|segment| segment.curvature.abs() * widest > NEAR);
        Segments { level: line.is_level(), list, line, sharp }
    }

    /// The segment that holds arc length `s`, taken modulo the length.
    pub fn at(&self, s: f64) -> usize {
        let s = s.rem_euclid(self.line.length);
        let stretch = self.line.stretch_at(s);
        let of = |segment: &&Segment| segment.stretch == stretch;
        let first = self.list.partition_point(|x| x.stretch < stretch);
        let count = self.list[first..].iter().take_while(of).count();
        let whole = &self.line.stretches[stretch];
        let part = ((s - whole.s) / whole.length * count as f64) as usize;
        first + part.min(count - 1)
    }

    /// The foot of a point, sought from segment `from` onwards or backwards.
    #[inline(always)]
    pub fn footing(&self, point: [f64; 3], from: usize) -> Footing {
        let n = self.list.len();
        let mut i = from % n;
        let mut forward = false;
        for _ in 0..=n {
            let segment = &self.list[i];
            let side = if segment.reach < 0.0 {
                let stretch = &self.line.stretches[segment.stretch];
                let d = stretch.project(&Vector3::from(point));
                if d > stretch.length + SLACK {
                    1
                } else if d < -SLACK {
                    -1
                } else {
                    return spiral_footing(stretch, i, point, d);
                }
            } else {
                let local = Local::of(segment);
                let foot = foot::<Scalar, false>(&local, scalar(point));
                let sigma = foot.sigma.number();
                if sigma > segment.reach {
                    1
                } else if sigma < -segment.reach {
                    -1
                } else {
                    return plain(&foot, &local, i);
                }
            };
            // A step back after one forward would only be rounding at a joint: stay there.
            if side > 0 {
                i = (i + 1) % n;
                forward = true;
            } else if forward {
                break;
            } else {
                i = (i + n - 1) % n;
            }
        }
        // Lost: the nearest point of the last segment tried, for the caller's check of offsets to find.
        let segment = &self.list[i];
        let stretch = &self.line.stretches[segment.stretch];
        let d = stretch.project(&Vector3::from(point)).clamp(0.0, stretch.length);
        spiral_footing(stretch, i, point, d)
    }
}

/// The foot at distance `d` along a piece.
fn spiral_footing(stretch: &crate::geometry::Stretch, index: usize, point: [f64; 3], d: f64) -> Footing {
    let frame = stretch.at(d);
    let away = Vector3::from(point) - frame.position;
    Footing {
        segment: index,
        s: stretch.s + d,
        tangent: frame.tangent.into(),
        normal: frame.normal.into(),
        up: frame.up.into(),
        y: away.dot(&frame.normal),
        z: away.dot(&frame.up),
    }
}

#[inline(always)]
fn plain(foot: &Foot<Scalar>, local: &Local<Scalar>, segment: usize) -> Footing {
    let number = Lane::<Scalar>::number;
    let vector = |v: Lane3<Scalar>| [number(v.x), number(v.y), number(v.z)];
    Footing {
        segment,
        s: number(foot.station(local)),
        tangent: vector(foot.tangent),
        normal: vector(foot.normal),
        up: vector(foot.up),
        y: number(foot.y),
        z: number(foot.z),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn line() -> CentreLine {
        CentreLine::new(
            [3.0, -2.0, 1.0, 0.7],
            &[
                Form::Straight { length: 6.0, slope: 0.0 },
                Form::Vertical { radius: 10.0, slope_from: 0.0, slope_to: 0.14 },
                Form::Straight { length: 5.0, slope: 0.14 },
                Form::Spiral { radius: 4.0, turn: -2.0, rise: 1.12 },
                Form::Vertical { radius: 8.0, slope_from: 0.14, slope_to: 0.0 },
                Form::Arc { radius: 3.0, turn: 2.5 },
            ],
        )
    }

    proptest! {
        /// Against the centre line's own projection, which knows nothing of segments.
        #[test]
        fn feet_are_the_nearest_points(share in 0.01..0.99f64, y in -0.3..0.3f64, z in -0.3..0.3f64) {
            let segments = Segments::new(line(), 0.5);
            let s = share * segments.line.length;
            let frame = segments.line.at(s);
            let point = frame.position + frame.normal * y + frame.up * z;
            let foot = segments.footing(point.into(), segments.at(s));
            prop_assert!((foot.s - s).abs() < 1e-8, "{} {s}", foot.s);
            prop_assert!((foot.y - y).abs() < 1e-9 && (foot.z - z).abs() < 1e-9);
            prop_assert!((Vector3::from(foot.tangent) - frame.tangent).norm() < 1e-8);
            prop_assert!((Vector3::from(foot.normal) - frame.normal).norm() < 1e-8);
            prop_assert!((Vector3::from(foot.up) - frame.up).norm() < 1e-8);
        }
    }
}
