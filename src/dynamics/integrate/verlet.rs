//! Velocity Verlet (Swope et al. 1982) with damping linearly implicit: one evaluation a step, of second order.

use super::{Integrator, TooFine};
use crate::dynamics::chain::Chain;

/// Equal steps within each duration.
#[derive(Clone, Debug)]
pub struct Verlet {
    /// Largest step, s.
    pub step: f64,
    /// Whether steps also keep to what damping at the joints leaves stable.
    bounded: bool,
    taken: u64,
}

impl Verlet {
    /// Steps of at most this size, s, come what may.
    pub fn new(step: f64) -> Self {
        Verlet { step, bounded: false, taken: 0 }
    }

    /// Steps of at most this size, s, and shorter ones while joints damp so fast that they need it.
    pub fn bounded(step: f64) -> Self {
        Verlet { bounded: true, ..Verlet::new(step) }
    }
}

impl Integrator for Verlet {
    fn advance(&mut self, chain: &mut Chain, duration: f64) -> Result<(), TooFine> {
        let stable = if self.bounded { chain.stable_step().max(MOST_CUT * self.step) } else { f64::INFINITY };
        let largest = self.step.min(stable);
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

/// Steps are cut to no less than this share: what needs shorter ones is in trouble.
const MOST_CUT: f64 = 0.01;
