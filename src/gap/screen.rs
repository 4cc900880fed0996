//! The fast screen: what each effect's signature explains, alone and in pairs, with the nuisances projected out.

use super::evidence::Evidence;
use super::simulator::{Applied, Candidate, Frame, Request, Simulator};
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;

/// A signature is taken where it is at least so many times the floor in the feature that it changes most.
const CLEAR: f64 = 4.0;

/// Sizes at which a signature is taken at most, each at most so many times the one before, or as small a part of it.
const ROUNDS: usize = 3;
const MOST_MORE: f64 = 12.0;

/// What a strength of a candidate changes, over all runs.
#[derive(Clone)]
pub struct Signature {
    pub candidate: usize,
    pub strength: usize,
    /// The strength it was taken at.
    pub size: f64,
    /// Of each run, of one unit of the strength; all 0 where the run could not be simulated.
    pub change: Vec<Vec<f64>>,
    /// The same whitened and projected.
    pub columns: Vec<DVector<f64>>,
}

/// A strength of a candidate at a size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trial {
    pub candidate: usize,
    pub strength: usize,
    pub size: f64,
}

/// Signatures of all strengths of the candidates that stand for themselves, at a size at which they are clear.
pub fn signatures(
    simulator: &dyn Simulator,
    evidence: &[Evidence],
    tell: &mut dyn FnMut(usize, usize),
) -> Vec<Signature> {
    let candidates = simulator.candidates();
    let alone = (0..candidates.len()).filter(|c| candidates[*c].beside.is_none());
    let mut trials: Vec<Trial> = alone
        .flat_map(|candidate| {
            let strengths = candidates[candidate].strengths.iter().enumerate();
            strengths.map(move |(strength, s)| Trial { candidate, strength, size: s.trial })
        })
        .collect();
    let all = trials.len();
    let gap = evidence.iter().any(|e| e.excess(&e.residual) > 1.0);
    let mut found: BTreeMap<(usize, usize), Signature> = BTreeMap::new();
    for round in 0..ROUNDS {
        let mut again = Vec::new();
        let before = all - trials.len();
        let taken = take(simulator, evidence, &trials, &mut |done| tell(before + done, all));
        for (trial, (signature, whole)) in trials.iter().zip(taken) {
            let strength = &candidates[trial.candidate].strengths[trial.strength];
            let asked = asked(&signature, evidence, (strength.low, strength.high));
            if gap && round + 1 < ROUNDS && whole && !(0.5..2.0).contains(&(asked / trial.size)) {
                again.push(Trial { size: asked, ..*trial });
            }
            if whole || round == 0 {
                found.insert((trial.candidate, trial.strength), signature);
            }
        }
        trials = again;
    }
    // A blow at a place has no sign as long as the place is not known.
    let signed = |s: &&Signature| {
        let placed = candidates.iter().any(|c| c.beside == Some(s.candidate));
        gap && placed && candidates[s.candidate].strengths[s.strength].low < 0.0
    };
    let mut found: Vec<Signature> = found.into_values().collect();
    let others: Vec<Trial> = found.iter().filter(signed).map(|s| s.trial().other()).collect();
    for (signature, whole) in take(simulator, evidence, &others, &mut |_| tell(all, all)) {
        if whole {
            keep(&mut found, signature, evidence);
        }
    }
    found
}

/// Keeps a signature, unless one that was taken with the other sign explains more.
pub fn keep(found: &mut Vec<Signature>, signature: Signature, evidence: &[Evidence]) {
    let same = |s: &&mut Signature| (s.candidate, s.strength) == (signature.candidate, signature.strength);
    match found.iter_mut().find(same) {
        Some(known) => {
            let turned = known.size * signature.size < 0.0;
            if !turned || known.explains(evidence) < signature.explains(evidence) {
                *known = signature;
            }
        }
        None => found.push(signature),
    }
}

impl Signature {
    fn trial(&self) -> Trial {
        Trial { candidate: self.candidate, strength: self.strength, size: self.size }
    }

    /// How much of the squares of what is left it explains, with its own sign.
    fn explains(&self, evidence: &[Evidence]) -> f64 {
        let (mut own, mut along) = (0.0, 0.0);
        for (column, evidence) in self.columns.iter().zip(evidence) {
            own += column.norm_squared();
            along += column.dot(&evidence.residual);
        }
        let along = (along * self.size.signum()).max(0.0);
        along * along / own.max(1e-300)
    }
}

impl Trial {
    /// With the other sign.
    pub fn other(self) -> Trial {
        Trial { size: -self.size, ..self }
    }
}

/// The strength at which an effect does as much as there is to explain, and is clear: few effects are linear, and power grows
/// with the square at first.
fn asked(signature: &Signature, evidence: &[Evidence], (low, high): (f64, f64)) -> f64 {
    let (mut own, mut gap, mut along) = (0.0, 0.0, 0.0);
    let mut largest: f64 = 0.0;
    for (column, evidence) in signature.columns.iter().zip(evidence) {
        own += column.norm_squared();
        gap += evidence.residual.norm_squared() - evidence.honest * evidence.features() as f64;
        along += column.dot(&evidence.residual);
        largest = largest.max(column.amax());
    }
    let size = (gap.max(0.0) / own.max(1e-300)).sqrt().max(1.5 * CLEAR / largest.max(1e-300));
    let now = signature.size.abs();
    let size = size.clamp(now / MOST_MORE, now * MOST_MORE);
    if along < 0.0 && low < 0.0 { -size.min(-0.5 * low) } else { size.min(0.5 * high) }
}

/// The signature of each trial, and whether every run could be simulated with it.
pub fn take(
    simulator: &dyn Simulator,
    evidence: &[Evidence],
    trials: &[Trial],
    tell: &mut dyn FnMut(usize),
) -> Vec<(Signature, bool)> {
    let (candidates, frames) = (simulator.candidates(), simulator.frames());
    let mut found = Vec::with_capacity(trials.len());
    for part in trials.chunks(8) {
        tell(found.len() + part.len());
        let with = |trial: &Trial| {
            let effects = vec![applied(candidates, trial)];
            (0..evidence.len()).map(move |run| Request { run, step: Vec::new(), effects: effects.clone() })
        };
        let requests: Vec<Request> = part.iter().flat_map(with).collect();
        let answers = simulator.simulate_all(&requests);
        for (trial, answers) in part.iter().zip(answers.chunks(evidence.len().max(1))) {
            let one = |(answer, frame): (&Option<Vec<f64>>, &Frame)| match answer {
                Some(answer) => answer.iter().zip(&frame.nominal).map(|(a, b)| (a - b) / trial.size).collect(),
                None => vec![0.0; frame.nominal.len()],
            };
            let change: Vec<Vec<f64>> = answers.iter().zip(frames).map(one).collect();
            let columns = evidence.iter().zip(&change).map(|(e, c)| e.column(c)).collect();
            let Trial { candidate, strength, size } = *trial;
            let whole = answers.iter().all(Option::is_some);
            found.push((Signature { candidate, strength, size, change, columns }, whole));
        }
    }
    found
}

/// A candidate with one of its strengths.
fn applied(candidates: &[Candidate], trial: &Trial) -> Applied {
    let mut strengths = vec![0.0; candidates[trial.candidate].strengths.len()];
    strengths[trial.strength] = trial.size;
    Applied { candidate: trial.candidate, strengths }
}

/// Strengths that explain most together, linearly, and what is left of each run.
#[derive(Clone, Debug)]
pub struct Explained {
    pub strengths: Vec<f64>,
    /// Of the strengths, in units of the floor of honest laps.
    pub covariance: DMatrix<f64>,
    pub residuals: Vec<DVector<f64>>,
}

/// Fits strengths to residuals of the runs, leaving one out where `without` says so. Strengths keep to bounds.
pub fn explain(
    residuals: &[DVector<f64>],
    columns: &[&[DVector<f64>]],
    bounds: &[(f64, f64)],
    without: Option<usize>,
) -> Explained {
    let count = columns.len();
    let mut matrix: DMatrix<f64> = DMatrix::zeros(count, count);
    let mut right: DVector<f64> = DVector::zeros(count);
    for (run, residual) in residuals.iter().enumerate().filter(|(run, _)| Some(*run) != without) {
        for i in 0..count {
            right[i] += columns[i][run].dot(residual);
            for j in 0..count {
                matrix[(i, j)] += columns[i][run].dot(&columns[j][run]);
            }
        }
    }
    // Strengths as far as their bounds are believed before.
    for i in 0..count {
        let wide = (bounds[i].1 - bounds[i].0).max(1e-300);
        matrix[(i, i)] += 1.0 / (wide * wide);
    }
    let inverse = matrix.clone().try_inverse().unwrap_or_else(|| DMatrix::zeros(count, count));
    let mut found = &inverse * &right;
    for i in 0..count {
        let held = found[i].clamp(bounds[i].0, bounds[i].1);
        if held != found[i] && count == 2 {
            // The other one alone, with this one at its bound.
            let other = 1 - i;
            found[i] = held;
            found[other] = ((right[other] - matrix[(other, i)] * held) / matrix[(other, other)])
                .clamp(bounds[other].0, bounds[other].1);
            break;
        }
        found[i] = held;
    }
    let left = residuals.iter().enumerate().map(|(run, residual)| {
        let mut left = residual.clone();
        for (x, column) in found.iter().zip(columns) {
            left -= &column[run] * *x;
        }
        left
    });
    Explained { residuals: left.collect(), strengths: found.iter().copied().collect(), covariance: inverse }
}
