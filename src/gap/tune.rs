//! Effects that cost no simulation are asked for as often as it takes: what a shift does to a narrow channel's distribution is in proportion
//! to nothing, and a strength that is a little off leaves more than another sensor's effect does.

use super::evidence::Evidence;
use super::refit::{Hypothesis, norm_squared};
use super::screen::{Signature, explain};
use super::simulator::{Band, Request, Simulator};
use nalgebra::DVector;

/// Steps at most, and the share of the squares that another one is worth.
const STEPS: usize = 8;
const ENOUGH: f64 = 0.005;

/// Differences are taken over so much of a strength, and of its trial at least.
const APART: f64 = 0.02;
const LEAST: f64 = 0.1;

/// Strengths at which something was simulated, nuisances where the nominal model has them.
#[derive(Clone)]
pub struct Tuned {
    pub strengths: Vec<f64>,
    /// What is left of each run, projected.
    pub residuals: Vec<DVector<f64>>,
    /// What the effects change in each run's features, and that projected.
    pub changes: Vec<Vec<f64>>,
    pub found: Vec<DVector<f64>>,
    /// What one more of each strength changes there.
    pub columns: Vec<Vec<DVector<f64>>>,
}

/// Whether all members of a hypothesis cost no simulation.
pub fn is_cheap(simulator: &dyn Simulator, hypothesis: &Hypothesis) -> bool {
    simulator.hears() && hypothesis.members.iter().all(|c| simulator.candidates()[*c].sensor)
}

/// Strengths that fit best near those from which it starts, or near those that the means along the track ask for, which most sensors' effects
/// change in proportion. `None` where nothing can be simulated.
pub fn tuned(
    simulator: &dyn Simulator,
    evidence: &[Evidence],
    signatures: &[Signature],
    hypothesis: &Hypothesis,
    start: &[f64],
) -> Option<Tuned> {
    let from = |start: &[f64]| descended(simulator, evidence, signatures, hypothesis, start);
    let found = [from(start), from(&by_means(simulator, signatures, hypothesis))];
    found.into_iter().flatten().min_by(|a, b| norm_squared(&a.residuals).total_cmp(&norm_squared(&b.residuals)))
}

/// Strengths by the means along the track alone, nuisances held.
fn by_means(simulator: &dyn Simulator, signatures: &[Signature], hypothesis: &Hypothesis) -> Vec<f64> {
    let rows = |of: &dyn Fn(usize) -> Vec<f64>| -> Vec<DVector<f64>> {
        let each = simulator.frames().iter().enumerate().map(|(run, frame)| {
            let off = frame.residual(&frame.nominal);
            let used = |k: &usize| frame.labels[*k].band == Band::Track && off[*k].is_finite();
            let values = of(run);
            let rows = (0..off.len()).filter(used).map(|k| values[k] / frame.laps.variance[k].sqrt());
            DVector::from_vec(rows.collect())
        });
        each.collect()
    };
    let off = rows(&|run| simulator.frames()[run].residual(&simulator.frames()[run].nominal));
    let columns: Vec<Vec<DVector<f64>>> =
        hypothesis.signatures.iter().map(|k| rows(&|run| signatures[*k].change[run].clone())).collect();
    let columns: Vec<&[DVector<f64>]> = columns.iter().map(|c| &c[..]).collect();
    explain(&off, &columns, &hypothesis.bounds(simulator.candidates(), signatures), None).strengths
}

/// Gauss and Newton's steps on differences.
fn descended(
    simulator: &dyn Simulator,
    evidence: &[Evidence],
    signatures: &[Signature],
    hypothesis: &Hypothesis,
    start: &[f64],
) -> Option<Tuned> {
    let bounds = hypothesis.bounds(simulator.candidates(), signatures);
    let held = |at: f64, k: usize| at.clamp(bounds[k].0, bounds[k].1);
    let (mut at, mut best): (Vec<f64>, Option<Tuned>) = (start.to_vec(), None);
    for _ in 0..STEPS {
        let here = differences(simulator, evidence, signatures, hypothesis, &at)?;
        let square = norm_squared(&here.residuals);
        if let Some(before) = best.as_ref().filter(|best| square >= norm_squared(&best.residuals)) {
            at.iter_mut().zip(&before.strengths).for_each(|(x, y)| *x = 0.5 * (*x + y));
            continue;
        }
        let by: Vec<&[DVector<f64>]> = here.columns.iter().map(|c| &c[..]).collect();
        let room: Vec<(f64, f64)> = bounds.iter().zip(&at).map(|((low, high), x)| (low - x, high - x)).collect();
        let step = explain(&here.residuals, &by, &room, None);
        let gained = square - norm_squared(&step.residuals);
        at = at.iter().zip(&step.strengths).enumerate().map(|(k, (x, more))| held(x + more, k)).collect();
        best = Some(here);
        if gained < ENOUGH * square {
            break;
        }
    }
    best
}

/// What strengths leave, and what a little more of each changes.
pub fn differences(
    simulator: &dyn Simulator,
    evidence: &[Evidence],
    signatures: &[Signature],
    hypothesis: &Hypothesis,
    at: &[f64],
) -> Option<Tuned> {
    let candidates = simulator.candidates();
    let bounds = hypothesis.bounds(candidates, signatures);
    let apart = hypothesis.signatures.iter().zip(at).zip(&bounds).map(|((k, x), (_, high))| {
        let Signature { candidate, strength, .. } = signatures[*k];
        let apart = (APART * x.abs()).max(LEAST * candidates[candidate].strengths[strength].trial.abs());
        if x + apart > *high { -apart } else { apart }
    });
    let apart: Vec<f64> = apart.collect();
    let beside = |k: usize| {
        let mut beside = at.to_vec();
        beside[k] += apart[k];
        beside
    };
    let points: Vec<Vec<f64>> = [at.to_vec()].into_iter().chain((0..at.len()).map(beside)).collect();
    let runs = evidence.len();
    let with = |point: &Vec<f64>| {
        let effects = hypothesis.applied(candidates, signatures, point);
        (0..runs).map(move |run| Request { run, step: Vec::new(), effects: effects.clone() })
    };
    let requests: Vec<Request> = points.iter().flat_map(with).collect();
    let answers: Vec<Vec<f64>> = simulator.simulate_all(&requests).into_iter().collect::<Option<_>>()?;
    let change = |point: usize| -> Vec<Vec<f64>> {
        let answers = answers[point * runs..(point + 1) * runs].iter().zip(simulator.frames());
        answers.map(|(answer, frame)| answer.iter().zip(&frame.nominal).map(|(a, n)| a - n).collect()).collect()
    };
    let projected = |changes: &[Vec<f64>]| -> Vec<DVector<f64>> {
        evidence.iter().zip(changes).map(|(e, c)| e.column(c)).collect()
    };
    let changes = change(0);
    let found = projected(&changes);
    let columns = (0..at.len()).map(|k| {
        let there = projected(&change(k + 1));
        there.iter().zip(&found).map(|(there, here)| (there - here) / apart[k]).collect()
    });
    Some(Tuned {
        strengths: at.to_vec(),
        residuals: evidence.iter().zip(&found).map(|(e, c)| &e.residual - c).collect(),
        columns: columns.collect(),
        changes,
        found,
    })
}
