//! A step of velocity Verlet (Swope et al. 1982), with velocities predicted where forces depend on them.
//!
//! v* = v + h a, with which forces are evaluated at x' = x + h (v + h a / 2); what they make of the carts is damped into
//! a' (`forces/implicit.rs`), and v' = v + h (a + a')/2. Orientations turn by the mean angular velocity of the step.

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

/// Changes the accelerations (linear, angular) at the begin of a step, s, into those at its end, and corrects the
/// predicted velocities by them: v' = v* + h (a' − a)/2.
#[inline(always)]
pub fn kick<S: Simd>(
    simd: S,
    bodies: &mut Bodies,
    accelerations: &mut Accelerations,
    [linear, angular]: [Lane3<S>; 2],
    part: usize,
    step: f64,
) {
    let half = Lane::splat(simd, 0.5 * step);
    linear.scale_add(half, Lane3::of(simd, &bodies.velocity, part)).put(&mut bodies.velocity, part);
    angular.scale_add(half, Lane3::of(simd, &bodies.spin, part)).put(&mut bodies.spin, part);
    (Lane3::of(simd, &accelerations.linear, part) + linear).put(&mut accelerations.linear, part);
    (Lane3::of(simd, &accelerations.angular, part) + angular).put(&mut accelerations.angular, part);
}

/// Largest stable step, s, where dampers act at rates up to `rate`, 1/s, and springs at frequencies whose squares are up
/// to `square`, 1/s², in the same modes: with z = hλ, w = hω of the fastest and k = z/(2 + z), a mode with the share q
/// of both is stable where (1 − kq)(1 + (z + w²/4) q) ≤ 2. All shares up to 1 are where w ≤ 2, and z + w²/4 ≤ (3 + 2√2) k
/// if z > √2.
pub fn stable(rate: f64, square: f64) -> f64 {
    let elastic = 2.0 / square.sqrt();
    if rate * elastic <= std::f64::consts::SQRT_2 {
        return elastic;
    }
    // The root of (ω²λ/4) h² + (λ² + ω²/2) h = (1 + 2√2) λ that stays exact where ω is small.
    let (a, b) = (0.25 * square * rate, rate * rate + 0.5 * square);
    let c = (1.0 + 2.0 * std::f64::consts::SQRT_2) * rate;
    2.0 * c / (b + (b * b + 4.0 * a * c).sqrt())
}

#[cfg(test)]
mod tests {
    use super::stable;
    use nalgebra::Matrix3;

    /// One step of an oscillator x″ = −ω² x − λ x′ with h = 1, on (x, v, a), damped by the share `damped` of what f − a
    /// asks for.
    fn grows(square: f64, rate: f64, damped: f64) -> bool {
        let x = [1.0, 1.0, 0.5];
        let velocity = [0.0, 1.0, 1.0];
        let change: [f64; 3] =
            std::array::from_fn(|k| damped * (-square * x[k] - rate * velocity[k] - [0.0, 0.0, 1.0][k]));
        let v: [f64; 3] = std::array::from_fn(|k| velocity[k] + 0.5 * change[k]);
        let a: [f64; 3] = std::array::from_fn(|k| [0.0, 0.0, 1.0][k] + change[k]);
        let step = Matrix3::from_fn(|i, j| [x, v, a][i][j]);
        step.complex_eigenvalues().iter().any(|e| e.norm() > 1.0 + 1e-9)
    }

    #[test]
    fn damped_oscillators_are_stable_to_the_bound_that_steps_keep() {
        for (rate, square) in [(1250.0, 4e5), (830.0, 6.3e5), (3000.0, 1e3), (100.0, 4e5), (900.0, 1.0)] {
            let grown = |h: f64| {
                let (z, w) = (rate * h, square * h * h);
                let k = z / (2.0 + z);
                (1..=400).map(|n| f64::from(n) / 400.0).any(|q| grows(w * q, z * q, 1.0 - k * q))
            };
            let bound = stable(rate, square);
            assert!(!grown(0.999 * bound), "λ = {rate}, ω² = {square}");
            assert!(grown(1.002 * bound), "λ = {rate}, ω² = {square}");
        }
    }
}
