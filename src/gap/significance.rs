//! How surely a signature is in what is left. A mean square over a thousand features hides what lies along one
//! direction in all of them: an effect that does little everywhere may be seen beyond doubt while the mean square is
//! that of replicate laps.
//!
//! The score z = Σ cᵀr / √(Σ cᵀ S c) of a direction c over all runs (Rao 1948), with the scatter S of replicate laps
//! and of chains as they are built, drawn rather than derived (White 1982), so that whatever correlation they have is
//! in it.

use super::ids::PerRun;
use super::observation::Observation;
use super::settings::Significance;
use crate::base::trig;
use nalgebra::DVector;

/// What a direction finds in residuals of all runs: how far they lie along it, and what scatters along it.
#[derive(Clone, Copy, Debug, Default)]
pub struct ScoreTest {
    pub along: f64,
    pub deviation: f64,
}

impl ScoreTest {
    pub fn new(
        settings: &Significance,
        observations: &PerRun<Observation>,
        residuals: &PerRun<DVector<f64>>,
        direction: &PerRun<DVector<f64>>,
    ) -> ScoreTest {
        let (mut along, mut variance) = (0.0, 0.0);
        // A chain is built once for all runs.
        let mut built: [Vec<f64>; 2] = Default::default();
        let mut runs = Vec::new();
        for ((observation, residual), direction) in observations.iter().zip(residuals).zip(direction) {
            let [laps, own @ ..] = observation.along(direction);
            let independent = direction.norm_squared();
            let scatter = squares(&laps) / laps.len().max(1) as f64;
            let run = Run {
                along: direction.dot(residual),
                square: independent,
                variance: if laps.is_empty() { independent } else { scatter.max(settings.least_scatter * independent) },
            };
            (along, variance) = (along + run.along, variance + run.variance);
            runs.push(run);
            for (sum, own) in built.iter_mut().zip(own) {
                sum.resize(own.len().max(sum.len()), 0.0);
                sum.iter_mut().zip(own).for_each(|(sum, x)| *sum += x);
            }
        }
        let [drawn, as_built] = &built;
        variance += squares(drawn) / drawn.len().max(1) as f64 + squares(as_built);
        ScoreTest { along, deviation: (variance * disagreement(&runs, settings.disagreement)).sqrt() }
    }

    /// With more that scatters along it.
    pub fn with_scatter(self, others: impl IntoIterator<Item = f64>) -> ScoreTest {
        let variance = others.into_iter().map(|x| x * x).sum::<f64>() + self.deviation * self.deviation;
        ScoreTest { deviation: variance.sqrt(), ..self }
    }

    /// So many deviations.
    pub fn z(&self) -> f64 {
        if self.deviation > 0.0 { self.along / self.deviation } else { 0.0 }
    }
}

/// What a direction finds in one run.
struct Run {
    along: f64,
    square: f64,
    variance: f64,
}

/// By how much more the strengths that runs ask for scatter than laps explain, as a variance, 1 at least (Birge 1932):
/// what is seen in one run only is not what the direction does.
fn disagreement(runs: &[Run], tolerance: f64) -> f64 {
    let telling: Vec<&Run> = runs.iter().filter(|run| run.square > 0.0 && run.variance > 0.0).collect();
    if telling.len() < 2 {
        return 1.0;
    }
    let information: f64 = telling.iter().map(|run| run.square * run.square / run.variance).sum();
    let strength = telling.iter().map(|run| run.along * run.square / run.variance).sum::<f64>() / information;
    let apart = telling.iter().map(|run| {
        let (left, tolerated) = (run.along - strength * run.square, tolerance * strength * run.square);
        left * left / (run.variance + tolerated * tolerated)
    });
    (apart.sum::<f64>() / (telling.len() - 1) as f64).max(1.0)
}

fn squares(each: &[f64]) -> f64 {
    each.iter().map(|x| x * x).sum()
}

impl Significance {
    /// Logarithm of how much likelier a score is where its direction is in the residuals than where it is not, by
    /// Student's distribution.
    pub fn support(&self, z: f64) -> f64 {
        let k = self.degrees_of_freedom;
        0.5 * (k + 1.0) * trig::ln(1.0 + z * z / k)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::normal;
    use crate::gap::settings::Settings;
    use crate::gap::simulator::Frame;

    /// As few laps for the features as an ensemble has.
    const FEATURES: usize = 400;
    const LAPS: usize = 100;

    /// White noise of unit variance, with `size` of a ramp in it.
    fn frame(size: f64, seed: u64) -> Frame {
        let mut state = seed;
        let mut noise = || (0..FEATURES).map(|_| normal(&mut state)).collect::<Vec<f64>>();
        let measured = noise().into_iter().zip(ramp()).map(|(x, r)| x + size * r).collect();
        Frame::bare(measured, (0..LAPS).map(|_| noise()).collect())
    }

    fn ramp() -> Vec<f64> {
        (0..FEATURES).map(|k| k as f64 / FEATURES as f64).collect()
    }

    fn score_of(size: f64, seed: u64, as_built: &[Vec<f64>]) -> f64 {
        let observations = PerRun::from(vec![Observation::new(&frame(size, seed), as_built, &Settings::default())]);
        let residual = observations.map(|o| o.residual.clone());
        let direction = observations.map(|o| o.column(&ramp()));
        ScoreTest::new(&Significance::default(), &observations, &residual, &direction).z()
    }

    #[test]
    fn a_score_is_a_normal_deviate_where_nothing_is() {
        let scores: Vec<f64> = (0..100).map(|seed| score_of(0.0, 1000 + seed, &[])).collect();
        let square = scores.iter().map(|z| z * z).sum::<f64>() / 100.0;
        // χ² of 100 degrees of freedom over 100 is within 0.6 and 1.5 but once in a thousand.
        assert!((0.6..1.5).contains(&square), "{square}");
    }

    #[test]
    fn a_score_tells_how_many_deviations_there_are() {
        // ‖ramp‖ = √(400/3).
        let expected = (FEATURES as f64 / 3.0).sqrt();
        let mean = (0..40).map(|seed| score_of(1.0, 2000 + seed, &[])).sum::<f64>() / 40.0;
        assert!((mean / expected - 1.0).abs() < 0.1, "{mean} for {expected}");
        // Where so much of it is within the as-built tolerance, it is one deviation and no more.
        let as_built = ramp();
        let mean = (0..40).map(|seed| score_of(1.0, 2000 + seed, std::slice::from_ref(&as_built))).sum::<f64>() / 40.0;
        assert!((0.7..1.1).contains(&mean), "{mean}");
    }

    #[test]
    fn what_is_seen_in_one_run_only_counts_less() {
        let score = |sizes: [f64; 3]| {
            let runs = sizes.iter().zip(5000..);
            let observations: PerRun<Observation> =
                runs.map(|(size, seed)| Observation::new(&frame(*size, seed), &[], &Settings::default())).collect();
            let residuals: PerRun<DVector<f64>> = observations.iter().map(|o| o.residual.clone()).collect();
            let direction: PerRun<DVector<f64>> = observations.iter().map(|o| o.column(&ramp())).collect();
            ScoreTest::new(&Significance::default(), &observations, &residuals, &direction).z()
        };
        let (agreed, alone) = (score([1.0; 3]), score([3.0, 0.0, 0.0]));
        assert!(agreed > 15.0 && alone < 0.3 * agreed, "{agreed} and {alone}");
    }
}
