//! A step of velocity Verlet (Swope et al. 1982), with velocities predicted where forces depend on them.
//!
//! v* = v + h a, with which a' is evaluated at x' = x + h (v + h a / 2); then v' = v + h (a + a')/2. Orientations turn
//! by the mean angular velocity of the step.

use super::lanes::{Lane, Lane3, Splat};
use super::state::{Accelerations, Bodies};
use pulp::Simd;

/// Positions to the end of a step, s, velocities predicted there.
#[inline(always)]
pub fn drift<S: Simd>(simd: S, bodies: &mut Bodies, accelerations: &Accelerations, part: usize, step: f64) {
    let (h, half) = (Lane::splat(simd, step), Lane::splat(simd, 0.5 * step));
    let linear = Lane3::of(simd, &accelerations.linear, part);
    let velocity = Lane3::of(simd, &bodies.velocity, part);
    let mean = linear.scale_add(half, velocity);
    mean.scale_add(h, Lane3::of(simd, &bodies.position, part)).put(&mut bodies.position, part);
    linear.scale_add(h, velocity).put(&mut bodies.velocity, part);
    let angular = Lane3::of(simd, &accelerations.angular, part);
    let spin = Lane3::of(simd, &bodies.spin, part);
    let mean = angular.scale_add(half, spin);
    turn(simd, bodies, part, mean.scale(half));
    angular.scale_add(h, spin).put(&mut bodies.spin, part);
}

/// Turns attitudes by the quaternion of half the rotation vector 2 `v`: (cos |v|, v sin |v|/|v|), by their series, and
/// normalises.
#[inline(always)]
fn turn<S: Simd>(simd: S, bodies: &mut Bodies, part: usize, v: Lane3<S>) {
    let c = Splat(simd);
    let square = v.dot(v);
    let cos = square.mul_add(square.mul_add(c.of(1.0 / 24.0), c.of(-0.5)), c.of(1.0));
    let sinc = square.mul_add(square.mul_add(c.of(1.0 / 120.0), c.of(-1.0 / 6.0)), c.of(1.0));
    let (x, y, z) = (v.x * sinc, v.y * sinc, v.z * sinc);
    let attitude = &mut bodies.attitude;
    let w0 = Lane::of(simd, &attitude[0], part);
    let x0 = Lane::of(simd, &attitude[1], part);
    let y0 = Lane::of(simd, &attitude[2], part);
    let z0 = Lane::of(simd, &attitude[3], part);
    let w = x0.neg_mul_add(x, y0.neg_mul_add(y, z0.neg_mul_add(z, w0 * cos)));
    let i = w0.mul_add(x, x0.mul_add(cos, y0.mul_add(z, -(z0 * y))));
    let j = w0.mul_add(y, y0.mul_add(cos, z0.mul_add(x, -(x0 * z))));
    let k = w0.mul_add(z, z0.mul_add(cos, x0.mul_add(y, -(y0 * x))));
    // One Newton step towards unit length from so near is exact.
    let length = w.mul_add(w, i.mul_add(i, j.mul_add(j, k * k)));
    let scale = length.neg_mul_add(c.of(0.5), c.of(1.5));
    (w * scale).put(&mut attitude[0], part);
    (i * scale).put(&mut attitude[1], part);
    (j * scale).put(&mut attitude[2], part);
    (k * scale).put(&mut attitude[3], part);
}

/// Corrects the predicted velocities by the accelerations (linear, angular) at the end of a step, s, from those at its
/// begin: v' = v* + h (a' − a)/2.
#[inline(always)]
pub fn kick<S: Simd>(
    simd: S,
    bodies: &mut Bodies,
    before: &Accelerations,
    [linear, angular]: [Lane3<S>; 2],
    part: usize,
    step: f64,
) {
    let half = Lane::splat(simd, 0.5 * step);
    let velocity = Lane3::of(simd, &bodies.velocity, part);
    let change = linear - Lane3::of(simd, &before.linear, part);
    change.scale_add(half, velocity).put(&mut bodies.velocity, part);
    let spin = Lane3::of(simd, &bodies.spin, part);
    let change = angular - Lane3::of(simd, &before.angular, part);
    change.scale_add(half, spin).put(&mut bodies.spin, part);
}
