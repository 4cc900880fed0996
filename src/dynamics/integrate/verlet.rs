//! Velocity Verlet (Swope et al. 1982), with velocities predicted where forces depend on them: one evaluation a step,
//! of second order.

use super::{Integrator, TooFine};
use crate::dynamics::chain::Chain;

/// Equal steps within each duration.
#[derive(Clone, Debug)]
pub struct Verlet {
    /// Largest step, s.
    pub step: f64,
    /// Whether steps also keep to what damping at the joints leaves stable.
    bounded: bool,
    /// What damping left stable when it was looked at last, s, and after how many steps it will be again.
    stable: f64,
    look: u64,
    taken: u64,
}

impl Verlet {
    /// Steps of at most this size, s, come what may.
    pub fn new(step: f64) -> Self {
        Verlet { step, bounded: false, stable: f64::INFINITY, look: 0, taken: 0 }
    }

    /// Steps of at most this size, s, and shorter ones while joints damp so fast that they need it.
    pub fn bounded(step: f64) -> Self {
        Verlet { bounded: true, ..Verlet::new(step) }
    }
}

impl Integrator for Verlet {
    fn advance(&mut self, chain: &mut Chain, duration: f64) -> Result<(), TooFine> {
        if self.bounded && self.taken >= self.look {
            self.look = self.taken + LOOK;
            self.stable = chain.stable_step().max(MOST_CUT * self.step);
        }
        let largest = self.step.min(self.stable);
        let steps = (duration / largest - 1e-9).ceil().max(1.0);
        let h = duration / steps;
        for _ in 0..steps as usize {
            chain.step(h);
        }
        chain.time += duration;
        self.taken += steps as u64;
        Ok(())
    }

    fn steps(&self) -> u64 {
        self.taken
    }
}

/// After so many steps the damping is looked at again: forces of joints change slowly beside steps.
const LOOK: u64 = 4;

/// Steps are cut to no less than this share: what needs shorter ones is in trouble.
const MOST_CUT: f64 = 0.01;

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
