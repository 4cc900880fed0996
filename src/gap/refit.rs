//! Real re-fits of what the screen left: simulations with the effect, nuisances moved along.

use super::evidence::Evidence;
use super::screen::{Explained, Signature, explain};
use super::simulator::{Applied, Candidate, Request, Simulator};
use nalgebra::{DMatrix, DVector};

/// Simulations of each run.
const ROUNDS: usize = 2;

/// One effect or two, each at one place.
#[derive(Clone, Debug, PartialEq)]
pub struct Hypothesis {
    /// Candidates.
    pub members: Vec<usize>,
    /// Signatures of their strengths.
    pub signatures: Vec<usize>,
}

/// A hypothesis with strengths that fit.
#[derive(Clone, Debug)]
pub struct Fitted {
    pub hypothesis: Hypothesis,
    pub strengths: Vec<f64>,
    pub covariance: DMatrix<f64>,
    /// What is left of each run, projected.
    pub residuals: Vec<DVector<f64>>,
    /// What one more of each strength changes.
    pub columns: Vec<Vec<DVector<f64>>>,
    /// What the effects change in each run's features, nuisances held.
    pub changes: Vec<Vec<f64>>,
    /// Features of each run, nuisances at their best; of the nominal model where only the screen was asked.
    pub features: Option<Vec<Vec<f64>>>,
}

impl Hypothesis {
    /// Bounds of the strengths.
    pub fn bounds(&self, candidates: &[Candidate], signatures: &[Signature]) -> Vec<(f64, f64)> {
        let of = |k: &usize| {
            let strength = &candidates[signatures[*k].candidate].strengths[signatures[*k].strength];
            (strength.low, strength.high)
        };
        self.signatures.iter().map(of).collect()
    }

    /// The effects with strengths in the order of `signatures`.
    fn applied(&self, candidates: &[Candidate], signatures: &[Signature], strengths: &[f64]) -> Vec<Applied> {
        let one = |&candidate: &usize| {
            let mut own = vec![0.0; candidates[candidate].strengths.len()];
            for (k, x) in self.signatures.iter().zip(strengths) {
                if signatures[*k].candidate == candidate {
                    own[signatures[*k].strength] = *x;
                }
            }
            Applied { candidate, strengths: own }
        };
        self.members.iter().map(one).collect()
    }

    /// By the signatures alone.
    pub fn screened(&self, evidence: &[Evidence], signatures: &[Signature], candidates: &[Candidate]) -> Fitted {
        let residuals: Vec<DVector<f64>> = evidence.iter().map(|e| e.residual.clone()).collect();
        let columns: Vec<&[DVector<f64>]> = self.signatures.iter().map(|k| &signatures[*k].columns[..]).collect();
        let Explained { strengths, covariance, residuals } =
            explain(&residuals, &columns, &self.bounds(candidates, signatures), None);
        let columns = columns.iter().map(|c| c.to_vec()).collect();
        let changes = (0..evidence.len()).map(|run| self.change(signatures, &strengths, run)).collect();
        Fitted { hypothesis: self.clone(), strengths, covariance, residuals, columns, changes, features: None }
    }

    /// What strengths change in a run's features, by the signatures.
    fn change(&self, signatures: &[Signature], strengths: &[f64], run: usize) -> Vec<f64> {
        let mut change = Vec::new();
        for (k, x) in self.signatures.iter().zip(strengths) {
            let own = &signatures[*k].change[run];
            change.resize(own.len(), 0.0);
            change.iter_mut().zip(own).for_each(|(sum, d)| *sum += x * d);
        }
        change
    }
}

/// Fits hypotheses by simulation. All requests of a round are made at once.
pub fn refit(
    simulator: &dyn Simulator,
    evidence: &[Evidence],
    signatures: &[Signature],
    screened: Vec<Fitted>,
    tell: &mut dyn FnMut(usize, usize),
) -> Vec<Fitted> {
    let (candidates, frames) = (simulator.candidates(), simulator.frames());
    let mut fitted = screened;
    let runs = evidence.len();
    for round in 0..ROUNDS {
        tell(round, ROUNDS);
        let mut requests = Vec::new();
        for one in &fitted {
            let effects = one.hypothesis.applied(candidates, signatures, &one.strengths);
            for (run, evidence) in evidence.iter().enumerate() {
                let change = one.hypothesis.change(signatures, &one.strengths, run);
                requests.push(Request { run, step: evidence.steps(&change), effects: effects.clone() });
            }
        }
        let answers = simulator.simulate_all(&requests);
        for (k, one) in fitted.iter_mut().enumerate() {
            let rows = k * runs..(k + 1) * runs;
            let answers: Option<Vec<&Vec<f64>>> = answers[rows.clone()].iter().map(Option::as_ref).collect();
            // What cannot be simulated keeps what the screen says.
            let Some(answers) = answers else { continue };
            // The effects' part of each change: nuisances are projected out as their slopes have it.
            one.changes = (0..runs)
                .map(|run| {
                    let frame = &frames[run];
                    let moved = &frame.slopes * DVector::from_vec(requests[rows.start + run].step.clone());
                    let features = answers[run].iter().zip(&frame.nominal).zip(moved.iter());
                    features.map(|((f, n), m)| f - n - m).collect()
                })
                .collect();
            let columns: Vec<DVector<f64>> = evidence.iter().zip(&one.changes).map(|(e, c)| e.column(c)).collect();
            let residuals: Vec<DVector<f64>> = evidence.iter().zip(&columns).map(|(e, c)| &e.residual - c).collect();
            if let [x] = one.strengths[..]
                && x != 0.0
            {
                one.columns = vec![columns.iter().map(|c| c / x).collect()];
            }
            let bounds = one.hypothesis.bounds(candidates, signatures);
            let bounds: Vec<(f64, f64)> =
                bounds.iter().zip(&one.strengths).map(|((low, high), x)| (low - x, high - x)).collect();
            let by: Vec<&[DVector<f64>]> = one.columns.iter().map(|c| &c[..]).collect();
            let step = explain(&residuals, &by, &bounds, None);
            one.strengths.iter_mut().zip(&step.strengths).for_each(|(x, d)| *x += d);
            one.residuals = step.residuals;
            one.covariance = step.covariance;
            one.features = Some(answers.into_iter().cloned().collect());
        }
    }
    fitted
}
