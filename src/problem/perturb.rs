//! A rough start made on purpose: `--perturb 1.5m --seed K`.

use crate::base::random::Random;
use crate::geometry::Track;
use crate::model::Layout;
use crate::problem::Problem;
use crate::problem::measures::to_corners;

/// How many draws a start may take before the written layout is used instead.
const DRAWS: usize = 10_000;
/// Turns of a start stay below this, rad.
const STEEPEST: f64 = 2.6;

/// The written variables with normal noise of `sigma` (m) on the coordinates that are free, and radii uniform within
/// their limits. Draws that flip a turn are drawn again; fixed values stay.
pub fn perturbed(layout: &Layout, problem: &Problem, sigma: f64, seed: u64) -> Vec<f64> {
    moved(layout, problem, &problem.start, sigma, seed).unwrap_or_else(|| problem.start.clone())
}

/// Variables with noise as in [`perturbed`]; `None` where every draw flips a turn.
pub fn moved(layout: &Layout, problem: &Problem, from: &[f64], sigma: f64, seed: u64) -> Option<Vec<f64>> {
    let mut random = Random::new(seed);
    for _ in 0..DRAWS {
        let mut x = from.to_vec();
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
            return Some(x);
        }
    }
    None
}
