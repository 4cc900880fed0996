//! Velocity Verlet (Swope et al. 1982), with velocities predicted where forces depend on them: one evaluation a step,
//! of second order.
//!
//! v* = v + h a, with which a' is evaluated at x' = x + h (v + h a / 2); then v' = v + h (a + a')/2. Orientations turn
//! by the mean angular velocity of the step.

use super::{Integrator, TooFine};
use crate::dynamics::chain::Chain;
use crate::dynamics::lanes::{Lane, Lane3, Splat};
use crate::dynamics::state::{Accelerations, Bodies, PACK};
use pulp::{Simd, WithSimd};

/// Equal steps within each duration.
#[derive(Clone, Debug)]
pub struct Verlet {
    /// Largest step, s.
    pub step: f64,
    /// Whether steps also keep to what damping at the joints leaves stable.
    bounded: bool,
    before: Vec<Accelerations>,
    taken: u64,
}

impl Verlet {
    /// Steps of at most this size, s, come what may.
    pub fn new(step: f64) -> Self {
        Verlet { step, bounded: false, before: Vec::new(), taken: 0 }
    }

    /// Steps of at most this size, s, and shorter ones while joints damp so fast that they need it.
    pub fn bounded(step: f64) -> Self {
        Verlet { bounded: true, ..Verlet::new(step) }
    }
}

impl Integrator for Verlet {
    fn advance(&mut self, chain: &mut Chain, duration: f64) -> Result<(), TooFine> {
        let largest =
            if self.bounded { self.step.min(chain.stable_step()).max(MOST_CUT * self.step) } else { self.step };
        let steps = (duration / largest - 1e-9).ceil().max(1.0);
        let h = duration / steps;
        for _ in 0..steps as usize {
            chain.width.run(Drift { bodies: &mut chain.state.bodies, accelerations: &chain.accelerations, h });
            // The evaluation overwrites whatever it is given.
            self.before.resize(chain.accelerations.len(), Accelerations::default());
            std::mem::swap(&mut self.before, &mut chain.accelerations);
            chain.evaluate(true);
            let (before, after) = (&self.before, &chain.accelerations);
            chain.width.run(Kick { bodies: &mut chain.state.bodies, before, after, h });
        }
        chain.time += duration;
        self.taken += steps as u64;
        Ok(())
    }

    fn steps(&self) -> u64 {
        self.taken
    }
}

/// Steps are cut to no less than this share: what needs shorter ones is in trouble.
const MOST_CUT: f64 = 0.01;

/// Positions to the end of the step, velocities predicted there.
struct Drift<'a> {
    bodies: &'a mut [Bodies],
    accelerations: &'a [Accelerations],
    h: f64,
}

impl WithSimd for Drift<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let h = Lane::splat(simd, self.h);
        let half = Lane::splat(simd, 0.5 * self.h);
        for (bodies, accelerations) in self.bodies.iter_mut().zip(self.accelerations) {
            for part in 0..PACK / S::F64_LANES {
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
        }
    }
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

/// Corrects the predicted velocities: v' = v* + h (a' − a)/2.
struct Kick<'a> {
    bodies: &'a mut [Bodies],
    before: &'a [Accelerations],
    after: &'a [Accelerations],
    h: f64,
}

impl WithSimd for Kick<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let half = Lane::splat(simd, 0.5 * self.h);
        for ((bodies, before), after) in self.bodies.iter_mut().zip(self.before).zip(self.after) {
            for part in 0..PACK / S::F64_LANES {
                let linear = Lane3::of(simd, &after.linear, part) - Lane3::of(simd, &before.linear, part);
                let velocity = Lane3::of(simd, &bodies.velocity, part);
                linear.scale_add(half, velocity).put(&mut bodies.velocity, part);
                let angular = Lane3::of(simd, &after.angular, part) - Lane3::of(simd, &before.angular, part);
                let spin = Lane3::of(simd, &bodies.spin, part);
                angular.scale_add(half, spin).put(&mut bodies.spin, part);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix3;

    /// One step of an oscillator x″ = −ω² x − λ x′ with h = 1, on (x, v, a).
    fn grows(frequency: f64, damping: f64) -> bool {
        let x = [1.0, 1.0, 0.5];
        let a: [f64; 3] = std::array::from_fn(|k| -frequency * frequency * x[k] - damping * [0.0, 1.0, 1.0][k]);
        let v: [f64; 3] = std::array::from_fn(|k| [0.0, 1.0, 0.5][k] + 0.5 * a[k]);
        let step = Matrix3::from_fn(|i, j| [x, v, a][i][j]);
        step.complex_eigenvalues().iter().any(|e| e.norm() > 1.0 + 1e-9)
    }

    #[test]
    fn damped_oscillators_are_stable_to_the_bound_that_steps_keep() {
        for frequency in [0.05, 0.3, 0.7, 1.1, 1.6] {
            let bound = 1.0 - 0.25 * frequency * frequency;
            assert!(!grows(frequency, 0.999 * bound), "ω h = {frequency}");
            assert!(grows(frequency, 1.001 * bound), "ω h = {frequency}");
        }
    }
}
