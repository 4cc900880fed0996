//! A rough start made on purpose: `--perturb 1.5m --seed K`.

use crate::base::trig;
use crate::geometry::Track;
use crate::model::Layout;
use crate::problem::Problem;
use crate::problem::measures::to_corners;

/// SplitMix64 (Steele, Lea and Flood 2014): a stream that stays the same for ever, which snapshots rely on.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Random(seed)
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Standard normal (Box and Muller 1958).
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * libm::log(1.0 - self.uniform())).sqrt();
        radius * trig::cos(trig::TAU * self.uniform())
    }
}

/// How many draws a start may take before the written layout is used instead.
const DRAWS: usize = 10_000;
/// Turns of a start stay below this, rad.
const STEEPEST: f64 = 2.6;

/// The written variables with normal noise of `sigma` (m) on the coordinates that are free, and radii uniform within
/// their limits. Draws that flip a turn are drawn again; fixed values stay.
pub fn perturbed(layout: &Layout, problem: &Problem, sigma: f64, seed: u64) -> Vec<f64> {
    let mut random = Random::new(seed);
    for _ in 0..DRAWS {
        let mut x = problem.start.clone();
        for (k, value) in x.iter_mut().enumerate() {
            let bound = problem.bounds[k];
            if bound.low == bound.high {
                continue;
            }
            if k % 3 == 2 {
                let limits = layout.radii.value;
                *value = limits.low + (limits.high - limits.low) * random.uniform();
            } else {
                *value += sigma * random.normal();
            }
        }
        let track = Track::new(&to_corners(&x));
        if track.fillets.iter().zip(&problem.signs).all(|(f, s)| f.turn * s > 0.0 && f.turn * s < STEEPEST) {
            return x;
        }
    }
    problem.start.clone()
}
