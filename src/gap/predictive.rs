//! Posterior predictive check of a hypothesis: whether laps of its own model leave as much as the measured run (Rubin
//! 1984; Gelman, Meng and Stern 1996). Probabilities compare hypotheses with each other; the likeliest of them may still
//! be one that no lap of its model looks like.
//!
//! The discrepancy is the normalised mean-square residual at its least, once nuisances and strengths are fitted. Each
//! cart of a simulation with the effects is a draw, fitted in the same way, so that where the strengths are drawn from
//! makes no difference as far as the model is linear in them.
//!
//! A run of the right model is one more draw: among n it leaves more than all others once in n + 1 times.

use super::comparison::Comparison;
use super::diagnosis::{CheckedRun, PredictiveCheck};
use super::hypothesis::room;
use super::ids::{PerRun, RunId};
use super::observation::Observation;
use super::scored::Scored;
use super::signature::explain;
use super::simulator::Frame;
use nalgebra::DVector;

/// The check of a hypothesis, and of no gap; `None` where too few laps are known.
pub fn predictive_check(comparison: &Comparison, shown: Option<&Scored>) -> Option<PredictiveCheck> {
    let nominal = checked(comparison, &comparison.observations, &comparison.residuals(), |laps| laps)?;
    let runs = match shown {
        None => nominal.clone(),
        Some(scored) => {
            let bounds = scored.fitted.hypothesis.bounds(comparison.candidates(), &comparison.signatures);
            let bounds = room(&bounds, &scored.fitted.strengths);
            let columns: Vec<&PerRun<DVector<f64>>> = scored.columns().iter().collect();
            let fitted = |laps| explain(&laps, &columns, &bounds, None).residuals;
            checked(comparison, scored.observations(&comparison.observations), scored.residuals(), fitted)?
        }
    };
    Some(PredictiveCheck { passed: runs.iter().all(|run| run.leave_as_much > 0), runs, no_gap: nominal })
}

/// Of each run, how many draws leave as much. A draw is a lap of the same cart in every run.
fn checked(
    comparison: &Comparison,
    observations: &PerRun<Observation>,
    left: &PerRun<DVector<f64>>,
    fitted: impl Fn(PerRun<DVector<f64>>) -> PerRun<DVector<f64>>,
) -> Option<Vec<CheckedRun>> {
    let draws = observations.iter().map(|o| o.laps().len()).min().unwrap_or(0);
    if draws < comparison.settings.checks.draws {
        return None;
    }
    let mut counts = observations.map(|_| 0);
    for draw in 0..draws {
        let laps = fitted(observations.map(|o| o.laps()[draw].clone()));
        for (run, observation) in observations.with_ids() {
            let lap = observation.mean_square_of_lap(&laps[run]);
            counts[run] += usize::from(lap >= observation.mean_square(&left[run]));
        }
    }
    let one = |(run, frame): (RunId, &Frame)| CheckedRun { run: frame.run.clone(), draws, leave_as_much: counts[run] };
    Some(comparison.simulator.frames().with_ids().map(one).collect())
}
