//! How surely a signature is in what is left. A mean square over a thousand features hides what lies along one direction in all of them: an
//! effect that does little everywhere may be seen beyond any doubt while the mean square is that of honest laps.
//!
//! The score z = Σ cᵀr / √(Σ cᵀ S c) of a direction c over all runs (Rao 1948), with the scatter S of honest laps and of chains as they are
//! built, drawn rather than derived (White 1982), so that whatever correlation they have is in it.

use super::evidence::Evidence;
use crate::geometry::trig;
use nalgebra::DVector;

/// Degrees of freedom of a score: its scatter is an estimate, and the equations are never those of the machine.
const FREEDOM: f64 = 8.0;

/// Scatter of laps along a direction, as a share of what independent features would have, at least.
const LEAST: f64 = 0.1;

/// What a direction finds in residuals of all runs: how far they lie along it, and what scatters along it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Score {
    pub along: f64,
    pub deviation: f64,
}

impl Score {
    pub fn new(evidence: &[Evidence], residuals: &[DVector<f64>], direction: &[DVector<f64>]) -> Score {
        let (mut along, mut variance) = (0.0, 0.0);
        // A chain is built once for all runs.
        let mut built: [Vec<f64>; 2] = Default::default();
        for ((evidence, residual), direction) in evidence.iter().zip(residuals).zip(direction) {
            let [laps, own @ ..] = evidence.along(direction);
            along += direction.dot(residual);
            let independent = direction.norm_squared();
            let scatter = squares(&laps) / laps.len().max(1) as f64;
            variance += if laps.is_empty() { independent } else { scatter.max(LEAST * independent) };
            for (sum, own) in built.iter_mut().zip(own) {
                sum.resize(own.len().max(sum.len()), 0.0);
                sum.iter_mut().zip(own).for_each(|(sum, x)| *sum += x);
            }
        }
        let [drawn, usual] = &built;
        variance += squares(drawn) / drawn.len().max(1) as f64 + squares(usual);
        Score { along, deviation: variance.sqrt() }
    }

    /// With more that scatters along it.
    pub fn beside(self, others: impl IntoIterator<Item = f64>) -> Score {
        let variance = others.into_iter().map(|x| x * x).sum::<f64>() + self.deviation * self.deviation;
        Score { deviation: variance.sqrt(), ..self }
    }

    /// So many deviations.
    pub fn z(&self) -> f64 {
        if self.deviation > 0.0 { self.along / self.deviation } else { 0.0 }
    }
}

fn squares(each: &[f64]) -> f64 {
    each.iter().map(|x| x * x).sum()
}

/// Logarithm of how much likelier a score is where its direction is in the residuals than where it is not, by Student's distribution.
pub fn support(z: f64) -> f64 {
    0.5 * (FREEDOM + 1.0) * trig::ln(1.0 + z * z / FREEDOM)
}
