//! Arithmetic on several carts at once: a [`Lane`] holds one number for each of as many carts as the processor's
//! vectors are wide.
//!
//! Every width gives the same bits: multiply-add is fused in all of them, and there is no operation here that mixes
//! carts. Closures are missing, too: only functions that are always inlined are compiled for the chosen instructions.
//! `min` and `max` are missing on purpose, because processors differ in the sign of zero; [`Lane::select`] does not.

use super::state::PackRow;
use pulp::Simd;
use std::ops::{Add, Mul, Neg, Sub};

/// One number a cart.
#[derive(Clone, Copy)]
pub struct Lane<S: Simd> {
    simd: S,
    value: S::f64s,
}

/// Constants for every cart.
#[derive(Clone, Copy)]
pub struct Splat<S: Simd>(pub S);

impl<S: Simd> Splat<S> {
    #[inline(always)]
    pub fn of(self, value: f64) -> Lane<S> {
        Lane::splat(self.0, value)
    }
}

/// One truth a cart.
#[derive(Clone, Copy)]
pub struct Mask<S: Simd> {
    simd: S,
    value: S::m64s,
}

impl<S: Simd> Lane<S> {
    /// The same number for every cart.
    #[inline(always)]
    pub fn splat(simd: S, value: f64) -> Self {
        Lane { simd, value: simd.splat_f64s(value) }
    }

    /// From the first numbers of a slice, which has at least as many as there are lanes.
    #[inline(always)]
    pub fn load(simd: S, from: &[f64]) -> Self {
        Lane { simd, value: S::as_simd_f64s(&from[..S::F64_LANES]).0[0] }
    }

    /// From a row of a pack: its part number `part`.
    #[inline(always)]
    pub fn of(simd: S, row: &PackRow, part: usize) -> Self {
        Lane { simd, value: S::as_simd_f64s(row).0[part] }
    }

    /// Into a row of a pack.
    #[inline(always)]
    pub fn put(self, row: &mut PackRow, part: usize) {
        S::as_mut_simd_f64s(row).0[part] = self.value;
    }

    #[inline(always)]
    pub fn store(self, to: &mut [f64]) {
        S::as_mut_simd_f64s(&mut to[..S::F64_LANES]).0[0] = self.value;
    }

    #[inline(always)]
    pub fn simd(self) -> S {
        self.simd
    }

    /// Constants beside this one.
    #[inline(always)]
    pub fn splat_like(self) -> Splat<S> {
        Splat(self.simd)
    }

    /// The same number, for constants beside this one.
    #[inline(always)]
    pub fn constant(self, value: f64) -> Self {
        Lane::splat(self.simd, value)
    }

    /// self · b + c, rounded once.
    #[inline(always)]
    pub fn mul_add(self, b: Self, c: Self) -> Self {
        Lane { simd: self.simd, value: self.simd.mul_add_f64s(self.value, b.value, c.value) }
    }

    /// c − self · b, rounded once.
    #[inline(always)]
    pub fn neg_mul_add(self, b: Self, c: Self) -> Self {
        Lane { simd: self.simd, value: self.simd.negate_mul_add_f64s(self.value, b.value, c.value) }
    }

    #[inline(always)]
    pub fn over(self, b: Self) -> Self {
        Lane { simd: self.simd, value: self.simd.div_f64s(self.value, b.value) }
    }

    #[inline(always)]
    pub fn sqrt(self) -> Self {
        Lane { simd: self.simd, value: self.simd.sqrt_f64s(self.value) }
    }

    #[inline(always)]
    pub fn abs(self) -> Self {
        Lane { simd: self.simd, value: self.simd.abs_f64s(self.value) }
    }

    /// Less where the other is less than zero: times the sign of the other.
    #[inline(always)]
    pub fn times_sign_of(self, other: Self) -> Self {
        let sign = self.simd.and_f64s(other.value, self.simd.splat_f64s(-0.0));
        Lane { simd: self.simd, value: self.simd.xor_f64s(self.value, sign) }
    }

    #[inline(always)]
    pub fn less(self, b: Self) -> Mask<S> {
        Mask { simd: self.simd, value: self.simd.less_than_f64s(self.value, b.value) }
    }

    /// `self` where true, `other` elsewhere.
    #[inline(always)]
    pub fn select(self, mask: Mask<S>, other: Self) -> Self {
        Lane { simd: self.simd, value: self.simd.select_f64s(mask.value, self.value, other.value) }
    }

    /// A function of single numbers, lane by lane: for what is rare.
    #[cold]
    #[inline(never)]
    pub fn map(self, function: impl Fn(f64) -> f64) -> Self {
        let mut value = self.value;
        for x in pulp::bytemuck::cast_slice_mut::<S::f64s, f64>(std::slice::from_mut(&mut value)) {
            *x = function(*x);
        }
        Lane { simd: self.simd, value }
    }
}

impl Lane<pulp::Scalar> {
    /// A single number.
    #[inline(always)]
    pub fn one(value: f64) -> Self {
        Lane { simd: pulp::Scalar::new(), value }
    }

    #[inline(always)]
    pub fn number(self) -> f64 {
        self.value
    }
}

impl<S: Simd> Mask<S> {
    #[inline(always)]
    pub fn any(self) -> bool {
        // Masks are a bit a lane or a whole number a lane: either way, all zero where nothing is true.
        pulp::bytemuck::bytes_of(&self.value).iter().fold(0, |all, byte| all | byte) != 0
    }

    #[inline(always)]
    pub fn all(self) -> bool {
        !Mask { simd: self.simd, value: self.simd.not_m64s(self.value) }.any()
    }

    #[inline(always)]
    pub fn or(self, other: Self) -> Self {
        Mask { simd: self.simd, value: self.simd.or_m64s(self.value, other.value) }
    }

    #[inline(always)]
    pub fn and(self, other: Self) -> Self {
        Mask { simd: self.simd, value: self.simd.and_m64s(self.value, other.value) }
    }
}

impl<S: Simd> Add for Lane<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Lane { simd: self.simd, value: self.simd.add_f64s(self.value, b.value) }
    }
}

impl<S: Simd> Sub for Lane<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Lane { simd: self.simd, value: self.simd.sub_f64s(self.value, b.value) }
    }
}

impl<S: Simd> Mul for Lane<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        Lane { simd: self.simd, value: self.simd.mul_f64s(self.value, b.value) }
    }
}

impl<S: Simd> Neg for Lane<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Lane { simd: self.simd, value: self.simd.neg_f64s(self.value) }
    }
}

/// A vector a cart.
#[derive(Clone, Copy)]
pub struct Lane3<S: Simd> {
    pub x: Lane<S>,
    pub y: Lane<S>,
    pub z: Lane<S>,
}

impl<S: Simd> Lane3<S> {
    #[inline(always)]
    pub fn new(x: Lane<S>, y: Lane<S>, z: Lane<S>) -> Self {
        Lane3 { x, y, z }
    }

    /// From three rows of a pack.
    #[inline(always)]
    pub fn of(simd: S, rows: &[PackRow; 3], part: usize) -> Self {
        Lane3 {
            x: Lane::of(simd, &rows[0], part),
            y: Lane::of(simd, &rows[1], part),
            z: Lane::of(simd, &rows[2], part),
        }
    }

    /// Into three rows of a pack.
    #[inline(always)]
    pub fn put(self, rows: &mut [PackRow; 3], part: usize) {
        self.x.put(&mut rows[0], part);
        self.y.put(&mut rows[1], part);
        self.z.put(&mut rows[2], part);
    }

    /// `self` where true, `other` elsewhere.
    #[inline(always)]
    pub fn select(self, mask: Mask<S>, other: Self) -> Self {
        Lane3 { x: self.x.select(mask, other.x), y: self.y.select(mask, other.y), z: self.z.select(mask, other.z) }
    }

    #[inline(always)]
    pub fn dot(self, b: Self) -> Lane<S> {
        self.x.mul_add(b.x, self.y.mul_add(b.y, self.z * b.z))
    }

    #[inline(always)]
    pub fn cross(self, b: Self) -> Self {
        Lane3 {
            x: self.z.neg_mul_add(b.y, self.y * b.z),
            y: self.x.neg_mul_add(b.z, self.z * b.x),
            z: self.y.neg_mul_add(b.x, self.x * b.y),
        }
    }

    /// self · factor + c.
    #[inline(always)]
    pub fn scale_add(self, factor: Lane<S>, c: Self) -> Self {
        Lane3 { x: self.x.mul_add(factor, c.x), y: self.y.mul_add(factor, c.y), z: self.z.mul_add(factor, c.z) }
    }

    /// Component by component.
    #[inline(always)]
    pub fn times(self, b: Self) -> Self {
        Lane3 { x: self.x * b.x, y: self.y * b.y, z: self.z * b.z }
    }

    #[inline(always)]
    pub fn scale(self, factor: Lane<S>) -> Self {
        Lane3 { x: self.x * factor, y: self.y * factor, z: self.z * factor }
    }
}

impl<S: Simd> Neg for Lane3<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Lane3 { x: -self.x, y: -self.y, z: -self.z }
    }
}

impl<S: Simd> Add for Lane3<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Lane3 { x: self.x + b.x, y: self.y + b.y, z: self.z + b.z }
    }
}

impl<S: Simd> Sub for Lane3<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Lane3 { x: self.x - b.x, y: self.y - b.y, z: self.z - b.z }
    }
}

/// The axes of a cart in the world: a rotation matrix by its columns.
#[derive(Clone, Copy)]
pub struct Axes<S: Simd> {
    pub xi: Lane3<S>,
    pub eta: Lane3<S>,
    pub zeta: Lane3<S>,
}

impl<S: Simd> Axes<S> {
    /// Of a unit quaternion w + xi + yj + zk.
    #[inline(always)]
    pub fn of(w: Lane<S>, x: Lane<S>, y: Lane<S>, z: Lane<S>) -> Self {
        let one = w.constant(1.0);
        let (x2, y2, z2) = (x + x, y + y, z + z);
        let (xx, yy, zz) = (x * x2, y * y2, z * z2);
        let (xy, xz, yz) = (x * y2, x * z2, y * z2);
        let (wx, wy, wz) = (w * x2, w * y2, w * z2);
        Axes {
            xi: Lane3::new(one - (yy + zz), xy + wz, xz - wy),
            eta: Lane3::new(xy - wz, one - (xx + zz), yz + wx),
            zeta: Lane3::new(xz + wy, yz - wx, one - (xx + yy)),
        }
    }

    /// Of quaternions in four rows of a pack.
    #[inline(always)]
    pub fn of_attitude(simd: S, rows: &[PackRow; 4], part: usize) -> Self {
        Axes::of(
            Lane::of(simd, &rows[0], part),
            Lane::of(simd, &rows[1], part),
            Lane::of(simd, &rows[2], part),
            Lane::of(simd, &rows[3], part),
        )
    }

    /// From nine rows of a pack, column by column.
    #[inline(always)]
    pub fn of_rows(simd: S, rows: &[[PackRow; 3]; 3], part: usize) -> Self {
        Axes {
            xi: Lane3::of(simd, &rows[0], part),
            eta: Lane3::of(simd, &rows[1], part),
            zeta: Lane3::of(simd, &rows[2], part),
        }
    }

    #[inline(always)]
    pub fn put(&self, rows: &mut [[PackRow; 3]; 3], part: usize) {
        self.xi.put(&mut rows[0], part);
        self.eta.put(&mut rows[1], part);
        self.zeta.put(&mut rows[2], part);
    }

    /// Cart to world.
    #[inline(always)]
    pub fn turn(&self, v: Lane3<S>) -> Lane3<S> {
        self.xi.scale_add(v.x, self.eta.scale_add(v.y, self.zeta.scale(v.z)))
    }

    /// World to cart.
    #[inline(always)]
    pub fn turn_back(&self, v: Lane3<S>) -> Lane3<S> {
        Lane3::new(self.xi.dot(v), self.eta.dot(v), self.zeta.dot(v))
    }
}
