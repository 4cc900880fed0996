//! The centre line as the wheels read it: segments that turn by at most 60° about one axis, each with the frame at its
//! middle, so that the nearest point of a line or an arc is one formula without branches or trigonometry.
//!
//! With a, b the point's coordinates along the tangent and towards the curvature κ at the middle, q = 2b − κ(a² + b²)
//! and w = √(1 − κq): the offset towards the curvature is q/(1 + w), the tangent has turned by ψ with sin ψ = κa/w and
//! cos ψ = (1 − κb)/w. For κ = 0 this is the straight line.

mod handover;

pub use handover::{Handover, Rehome};

use super::lanes::{Lane, Lane3, Mask};
use super::state::{PACK, PackRow};
use crate::geometry::{CentreLine, Form};
use nalgebra::Vector3;
use pulp::{Scalar, Simd};

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

/// The segment of each cart's front joint, by pack.
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
    /// Sends a cart to a segment.
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

/// Segments of several carts.
#[derive(Clone, Copy)]
pub struct Local<S: Simd> {
    origin: Lane3<S>,
    along: Lane3<S>,
    inward: Lane3<S>,
    curvature: Lane<S>,
    reach: Lane<S>,
    s: Lane<S>,
    vertical: Lane<S>,
}

impl<S: Simd> Local<S> {
    #[inline(always)]
    pub fn load(simd: S, home: &Home, part: usize) -> Self {
        Local {
            origin: Lane3::of(simd, &home.origin, part),
            along: Lane3::of(simd, &home.along, part),
            inward: Lane3::of(simd, &home.inward, part),
            curvature: Lane::of(simd, &home.curvature, part),
            reach: Lane::of(simd, &home.reach, part),
            s: Lane::of(simd, &home.s, part),
            vertical: Lane::of(simd, &home.vertical, part),
        }
    }
}

impl Local<Scalar> {
    /// One segment.
    #[inline(always)]
    fn of(segment: &Segment) -> Self {
        let lane = Lane::<Scalar>::one;
        Local {
            origin: scalar(segment.origin.into()),
            along: scalar(segment.along.into()),
            inward: scalar(segment.inward.into()),
            curvature: lane(segment.curvature),
            reach: lane(segment.reach),
            s: lane(segment.s),
            vertical: lane(f64::from(u8::from(segment.vertical))),
        }
    }
}

#[inline(always)]
fn scalar([x, y, z]: [f64; 3]) -> Lane3<Scalar> {
    Lane3::new(Lane::one(x), Lane::one(y), Lane::one(z))
}

/// The foot of a point on the centre line: its frame there, and its offsets.
#[derive(Clone, Copy)]
pub struct Foot<S: Simd> {
    pub tangent: Lane3<S>,
    pub normal: Lane3<S>,
    pub up: Lane3<S>,
    /// Along the normal, m.
    pub y: Lane<S>,
    /// Along up, m.
    pub z: Lane<S>,
    /// sin ψ / κ, m.
    sigma: Lane<S>,
    cos: Lane<S>,
}

/// `LEVEL` says that the whole centre line is horizontal.
#[inline(always)]
pub fn foot<S: Simd, const LEVEL: bool>(local: &Local<S>, point: Lane3<S>) -> Foot<S> {
    let r = point - local.origin;
    let (t, i, k) = (local.along, local.inward, local.curvature);
    let one = r.x.constant(1.0);
    if LEVEL {
        let a = r.x.mul_add(t.x, r.y * t.y);
        let b = r.x.mul_add(i.x, r.y * i.y);
        let (sine, cos, sigma, offset) = bent(a, b, k);
        let zero = r.x.constant(0.0);
        let tangent = Lane3::new(t.x.mul_add(cos, i.x * sine), t.y.mul_add(cos, i.y * sine), zero);
        let normal = Lane3::new(-tangent.y, tangent.x, zero);
        Foot { tangent, normal, up: Lane3::new(zero, zero, one), y: offset, z: r.z, sigma, cos }
    } else {
        let (a, b, across) = (r.dot(t), r.dot(i), t.cross(i));
        let c = r.dot(across);
        let (sine, cos, sigma, offset) = bent(a, b, k);
        let tangent = t.scale_add(cos, i.scale(sine));
        let inward = i.scale_add(cos, t.scale(-sine));
        let steep = one.constant(0.5).less(local.vertical);
        let normal = (-across).select(steep, inward);
        let up = inward.select(steep, across);
        Foot { tangent, normal, up, y: (-c).select(steep, offset), z: offset.select(steep, c), sigma, cos }
    }
}

/// Sine and cosine of the turn ψ, sin ψ / κ, and the offset towards the curvature.
#[inline(always)]
fn bent<S: Simd>(a: Lane<S>, b: Lane<S>, k: Lane<S>) -> (Lane<S>, Lane<S>, Lane<S>, Lane<S>) {
    let one = a.constant(1.0);
    let q = k.neg_mul_add(a.mul_add(a, b * b), b + b);
    let root = k.neg_mul_add(q, one).sqrt();
    let inverse = one.over(root);
    let sigma = a * inverse;
    (k * sigma, k.neg_mul_add(b, one) * inverse, sigma, q.over(one + root))
}

impl<S: Simd> Foot<S> {
    /// Where the point lies beyond its segment's ends.
    #[inline(always)]
    pub fn outside(&self, local: &Local<S>) -> Mask<S> {
        local.reach.less(self.sigma.abs())
    }

    /// Arc length of the foot, m: (2/κ) atan(tan(ψ/2)) from the middle.
    #[inline(always)]
    pub fn station(&self, local: &Local<S>) -> Lane<S> {
        let half = self.sigma.over(self.cos + self.cos.constant(1.0));
        let tan = local.curvature * half;
        (half + half).mul_add(atan_over(tan * tan), local.s)
    }
}

/// atan(x)/x for x² ≤ 0.43, to the last digits: Moshier's rational approximation (Cephes, 1984).
#[inline(always)]
fn atan_over<S: Simd>(square: Lane<S>) -> Lane<S> {
    let c = square.splat_like();
    let p = square
        .mul_add(c.of(-0.875_060_860_003_190_4), c.of(-16.157_537_187_333_652))
        .mul_add(square, c.of(-75.008_557_923_147_05))
        .mul_add(square, c.of(-122.886_668_449_013_61))
        .mul_add(square, c.of(-64.850_219_049_420_25));
    let q = (square + c.of(24.858_464_901_423_062))
        .mul_add(square, c.of(165.027_009_831_698_85))
        .mul_add(square, c.of(432.881_060_491_290_27))
        .mul_add(square, c.of(485.390_399_635_913_7))
        .mul_add(square, c.of(194.550_657_148_261_4));
    (square * p).over(q) + c.of(1.0)
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
}

impl Segments {
    pub fn new(line: CentreLine) -> Self {
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
        Segments { level: line.is_level(), list, line }
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

    #[test]
    fn the_arc_tangent_is_exact_to_the_last_digits() {
        for k in 1..=1000 {
            let x = 0.65 * k as f64 / 1000.0;
            assert!((atan_over(Lane::one(x * x)).number() - libm::atan(x) / x).abs() < 4e-16, "{x}");
        }
    }

    proptest! {
        /// Against the centre line's own projection, which knows nothing of segments.
        #[test]
        fn feet_are_the_nearest_points(share in 0.01..0.99f64, y in -0.3..0.3f64, z in -0.3..0.3f64) {
            let segments = Segments::new(line());
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
