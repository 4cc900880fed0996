//! Fitted strengths with their 90 % intervals.

use super::comparison::Comparison;
use super::diagnosis::{Amount, Bound};
use super::hypothesis::norm_squared;
use super::ids::{CandidateId, PerRun, RunId};
use super::scored::Scored;
use super::simulator::Strength;
use crate::base::number::tidy;
use crate::base::trig;
use nalgebra::DVector;
use std::collections::BTreeMap;

/// Deviations of a normal distribution's 90 % interval.
const NINETY: f64 = 1.644_853_627;

/// Strengths of a candidate with their intervals.
pub fn amounts(comparison: &Comparison, told: &Scored, of: CandidateId) -> BTreeMap<String, Amount> {
    let fitted = &told.fitted;
    let settings = comparison.settings;
    let deviation = settings.random_effects.deviation;
    // A gap that is left makes every strength less sure.
    let scale =
        told.mean_square.max(1.0).sqrt() * comparison.observations.first().map_or(1.0, |o| o.replicate.max(0.3)).sqrt();
    // What the effect's equation misses of its own pattern may be as much of its strength.
    let missed = settings.intervals.missed
        * ((told.mean_square - 1.0) / (comparison.mean_square - 1.0).max(1e-9)).clamp(0.0, 1.0).sqrt();
    let mut out = BTreeMap::new();
    for (i, k) in fitted.hypothesis.signatures.iter().enumerate() {
        let signature = &comparison.signatures[*k];
        if signature.candidate != of {
            continue;
        }
        let candidate = &comparison.candidates()[of];
        let strength = &candidate.strengths[signature.strength];
        let value = fitted.strengths[i];
        let own = told.covariance()[(i, i)].max(0.0).sqrt();
        let by_scatter = candidate.random_effect.is_some() && (own - deviation * value.abs()).abs() <= 1e-9 * own;
        let size = value.abs();
        let uncertainty = match by_scatter {
            true => Uncertainty { sum: missed * size, factor: trig::hypot(deviation, candidate.discrepancy) },
            false => {
                let own = (scale * own).max(scattered(comparison, &fitted.columns[i]));
                // Beside another effect it may as a whole be what that one's equation misses; alone it is there.
                let beside = fitted.hypothesis.members.len() > 1;
                let (discrepancy, factor) =
                    if beside { (candidate.discrepancy, 0.0) } else { (0.0, candidate.discrepancy) };
                Uncertainty { sum: trig::hypot(own, trig::hypot(missed, discrepancy) * size), factor }
            }
        };
        let (less, more) = uncertainty.either_way(size);
        let (less, more) = if value < 0.0 { (more, less) } else { (less, more) };
        let amount = Amount {
            value: tidy(value),
            low: tidy((value - less).max(strength.low)),
            high: tidy((value + more).min(strength.high)),
            unit: strength.unit.clone(),
            at_bound: at_bound(strength, value),
            by_run: by_run(comparison, strength, value),
        };
        out.insert(strength.name.clone(), amount);
    }
    out
}

/// What each run has of a strength, where they differ.
fn by_run(comparison: &Comparison, strength: &Strength, value: f64) -> BTreeMap<String, f64> {
    let shares = strength.shares.with_ids();
    let of = |run: RunId| (comparison.simulator.frames()[run].run.clone(), tidy(strength.in_run(value, run)));
    shares.map(|(run, _)| of(run)).collect()
}

/// How far a strength may be off: a deviation, and one of its logarithm.
struct Uncertainty {
    sum: f64,
    factor: f64,
}

impl Uncertainty {
    /// Half widths of the 90 % interval of a size, towards 0 and away from it.
    fn either_way(&self, size: f64) -> (f64, f64) {
        let far = NINETY * self.factor;
        let half = |by_factor: f64| trig::hypot(NINETY * self.sum, size * by_factor);
        (half(1.0 - trig::exp(-far)), half(trig::exp(far) - 1.0))
    }
}

/// Which of its bounds a strength is at, to rounding; 0 is none, as it is no effect, nor is all of a share, as nothing
/// lies beyond it.
fn at_bound(strength: &Strength, value: f64) -> Option<Bound> {
    let all = |bound: f64| strength.name == "share" && bound == 1.0;
    let near = |bound: f64| value != 0.0 && (value - bound).abs() <= 1e-6 * bound.abs() && !all(bound);
    match (near(strength.low), near(strength.high)) {
        (_, true) => Some(Bound::Upper),
        (true, _) => Some(Bound::Lower),
        _ => None,
    }
}

/// How far a strength is off by what scatters along its signature.
fn scattered(comparison: &Comparison, column: &PerRun<DVector<f64>>) -> f64 {
    let square = norm_squared(column);
    comparison.tested(&comparison.residuals(), column).deviation / square.max(1e-300)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_lies_beyond_all_of_a_share() {
        let of = |name: &str, (low, high): (f64, f64), value: f64| {
            let (name, unit, shares) = (name.to_owned(), String::new(), PerRun::default());
            at_bound(&Strength { name, unit, trial: 0.1, as_built: 0.0, beside: false, low, high, shares }, value)
        };
        assert_eq!(of("share", (0.5, 1.0), 1.0), None);
        assert_eq!(of("share", (0.5, 1.0), 0.5), Some(Bound::Lower));
        assert_eq!(of("ratio", (0.0, 0.5), 0.5), Some(Bound::Upper));
        assert_eq!(of("ratio", (0.0, 0.5), 0.0), None);
    }
}
