//! The nearest point of the centre line to several points at once: one formula for lines and arcs, without branches.

use super::{Home, Segment};
use crate::dynamics::lanes::{Lane, Lane3, Mask};
use crate::dynamics::series::{asin_over, inverse_of_one_and, inverse_root};
use pulp::{Scalar, Simd, WithSimd};

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
    /// Whether roots and quotients are taken exactly, rather than by series that hold near the centre line.
    exact: bool,
}

impl<S: Simd> Local<S> {
    #[inline(always)]
    pub fn load(simd: S, home: &Home, part: usize, exact: bool) -> Self {
        Local {
            exact,
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
    pub(super) fn of(segment: &Segment) -> Self {
        let lane = Lane::<Scalar>::one;
        Local {
            // The point may be far from it.
            exact: true,
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
pub(super) fn scalar([x, y, z]: [f64; 3]) -> Lane3<Scalar> {
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
    pub(super) sigma: Lane<S>,
    /// sin ψ
    pub(super) sine: Lane<S>,
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
        let Bend { sine, cos, sigma, offset } = bent(a, b, k, local.exact);
        let zero = r.x.constant(0.0);
        let tangent = Lane3::new(t.x.mul_add(cos, i.x * sine), t.y.mul_add(cos, i.y * sine), zero);
        let normal = Lane3::new(-tangent.y, tangent.x, zero);
        Foot { tangent, normal, up: Lane3::new(zero, zero, one), y: offset, z: r.z, sigma, sine }
    } else {
        let (a, b, across) = (r.dot(t), r.dot(i), t.cross(i));
        let c = r.dot(across);
        let Bend { sine, cos, sigma, offset } = bent(a, b, k, local.exact);
        let tangent = t.scale_add(cos, i.scale(sine));
        let inward = i.scale_add(cos, t.scale(-sine));
        let steep = one.constant(0.5).less(local.vertical);
        let normal = (-across).select(steep, inward);
        let up = inward.select(steep, across);
        Foot { tangent, normal, up, y: (-c).select(steep, offset), z: offset.select(steep, c), sigma, sine }
    }
}

/// How the centre line has turned by ψ at a foot.
#[derive(Clone, Copy)]
struct Bend<S: Simd> {
    sine: Lane<S>,
    cos: Lane<S>,
    /// sin ψ / κ, m.
    sigma: Lane<S>,
    /// Towards the curvature, m.
    offset: Lane<S>,
}

#[inline(always)]
fn bent<S: Simd>(a: Lane<S>, b: Lane<S>, k: Lane<S>, exact: bool) -> Bend<S> {
    let one = a.constant(1.0);
    let q = k.neg_mul_add(a.mul_add(a, b * b), b + b);
    let x = k * q;
    let mut inverse = inverse_root(x);
    let root = (one - x) * inverse;
    let mut offset = q * inverse_of_one_and(root);
    if exact {
        let (of_root, across) = x.simd().vectorize(Exact { q, x });
        (inverse, offset) = (of_root, across);
    }
    let sigma = a * inverse;
    Bend { sine: k * sigma, cos: k.neg_mul_add(b, one) * inverse, sigma, offset }
}

/// 1/w and q/(1 + w) with w = √(1 − x), wherever the point is.
struct Exact<S: Simd> {
    q: Lane<S>,
    x: Lane<S>,
}

impl<S: Simd> WithSimd for Exact<S> {
    type Output = (Lane<S>, Lane<S>);

    #[inline(always)]
    fn with_simd<T: Simd>(self, _: T) -> Self::Output {
        let one = self.x.constant(1.0);
        let root = (one - self.x).sqrt();
        (one.over(root), self.q.over(one + root))
    }
}

impl<S: Simd> Foot<S> {
    /// Where the point lies beyond its segment's ends.
    #[inline(always)]
    pub fn outside(&self, local: &Local<S>) -> Mask<S> {
        local.reach.less(self.sigma.abs())
    }

    /// Direction of the rail here.
    #[inline(always)]
    pub fn rail(&self) -> Rail<S> {
        Rail { tangent: self.tangent, up: self.up }
    }

    /// Arc length of the foot, m: asin(sin ψ)/κ from the middle.
    #[inline(always)]
    pub fn station(&self, local: &Local<S>) -> Lane<S> {
        self.sigma.mul_add(asin_over(self.sine * self.sine), local.s)
    }
}

/// Direction of a rail.
#[derive(Clone, Copy)]
pub struct Rail<S: Simd> {
    pub tangent: Lane3<S>,
    pub up: Lane3<S>,
}

impl<S: Simd> Rail<S> {
    /// The part of a vector along the track.
    #[inline(always)]
    pub fn along<const LEVEL: bool>(&self, v: Lane3<S>) -> Lane<S> {
        if LEVEL { self.tangent.x.mul_add(v.x, self.tangent.y * v.y) } else { self.tangent.dot(v) }
    }

    /// The part of a vector upwards from the track.
    #[inline(always)]
    pub fn above<const LEVEL: bool>(&self, v: Lane3<S>) -> Lane<S> {
        if LEVEL { v.z } else { self.up.dot(v) }
    }

    /// A force along the track and upwards from it, in the world, N.
    #[inline(always)]
    pub fn force<const LEVEL: bool>(&self, along: Lane<S>, up: Lane<S>) -> Lane3<S> {
        if LEVEL {
            Lane3::new(self.tangent.x * along, self.tangent.y * along, up)
        } else {
            self.up.scale_add(up, self.tangent.scale(along))
        }
    }
}
