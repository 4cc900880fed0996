//! What may explain a gap: effects at places, with strengths that fit.

use crate::gap::ids::{CandidateId, PerRun, RunId, SignatureId};
use crate::gap::observation::Observation;
use crate::gap::signature::{Explained, Signatures, explain};
use crate::gap::simulator::{Applied, Candidates, Request};
use nalgebra::DMatrix;
use nalgebra::DVector;

/// One effect, at one place or several, or two.
#[derive(Clone, Debug, PartialEq)]
pub struct Hypothesis {
    /// Candidates.
    pub members: Vec<CandidateId>,
    /// Signatures of their strengths.
    pub signatures: Vec<SignatureId>,
}

/// A hypothesis with strengths that fit.
#[derive(Clone, Debug)]
pub struct Fitted {
    pub hypothesis: Hypothesis,
    pub strengths: Vec<f64>,
    pub covariance: DMatrix<f64>,
    /// What is left of each run, projected.
    pub residuals: PerRun<DVector<f64>>,
    /// What one more of each strength changes.
    pub columns: Vec<PerRun<DVector<f64>>>,
    /// What the effects change in each run's features, nuisances held.
    pub changes: PerRun<Vec<f64>>,
    /// Steps of each run's nuisances at which it is simulated.
    pub nuisance_offsets: PerRun<Vec<f64>>,
    /// Features of each run, nuisances at their best; of the nominal model where only the screen was asked.
    pub features: Option<PerRun<Vec<f64>>>,
}

impl Hypothesis {
    /// Bounds of the strengths.
    pub fn bounds(&self, candidates: &Candidates, signatures: &Signatures) -> Vec<(f64, f64)> {
        let of = |k: &SignatureId| {
            let strength = &candidates[signatures[*k].candidate].strengths[signatures[*k].strength];
            (strength.low, strength.high)
        };
        self.signatures.iter().map(of).collect()
    }

    /// Both.
    pub fn with(&self, other: &Hypothesis) -> Hypothesis {
        Hypothesis {
            members: [&self.members[..], &other.members].concat(),
            signatures: [&self.signatures[..], &other.signatures].concat(),
        }
    }

    /// The effects with strengths in the order of `signatures`.
    pub fn applied(&self, candidates: &Candidates, signatures: &Signatures, strengths: &[f64]) -> Vec<Applied> {
        let one = |&candidate: &CandidateId| {
            let mut own = vec![0.0; candidates[candidate].strengths.len()];
            for (k, x) in self.signatures.iter().zip(strengths) {
                if signatures[*k].candidate == candidate {
                    own[signatures[*k].strength] = *x;
                }
            }
            Applied { candidate, strengths: candidates[candidate].bounded(&own) }
        };
        self.members.iter().map(one).collect()
    }

    /// By the signatures alone.
    pub fn screened(
        &self,
        observations: &PerRun<Observation>,
        signatures: &Signatures,
        candidates: &Candidates,
    ) -> Fitted {
        let residuals: PerRun<DVector<f64>> = observations.iter().map(|o| o.residual.clone()).collect();
        let columns: Vec<&PerRun<DVector<f64>>> = self.signatures.iter().map(|k| &signatures[*k].columns).collect();
        let explained = explain(&residuals, &columns, &self.bounds(candidates, signatures), None);
        let columns = columns.into_iter().cloned().collect();
        let changes = observations.ids().map(|run| self.change(signatures, &explained.strengths, run)).collect();
        self.clone().foretold(observations, explained, columns, changes)
    }

    /// With strengths that were fitted by columns, nuisances at their best beside what is changed, and no simulation yet.
    pub fn foretold(
        self,
        observations: &PerRun<Observation>,
        explained: Explained,
        columns: Vec<PerRun<DVector<f64>>>,
        changes: PerRun<Vec<f64>>,
    ) -> Fitted {
        let Explained { strengths, covariance, residuals } = explained;
        let nuisance_offsets =
            observations.iter().zip(&changes).map(|(o, change)| o.nuisance_offsets(change)).collect();
        let (hypothesis, features) = (self, None);
        Fitted { hypothesis, strengths, covariance, residuals, columns, changes, nuisance_offsets, features }
    }

    /// What is changed in each run after a step of the strengths, by the signatures.
    pub fn changed_further(
        &self,
        signatures: &Signatures,
        changes: &PerRun<Vec<f64>>,
        step: &[f64],
    ) -> PerRun<Vec<f64>> {
        let in_run = |(run, change): (RunId, &Vec<f64>)| {
            let more = self.change(signatures, step, run);
            change.iter().zip(more).map(|(c, m)| c + m).collect()
        };
        changes.with_ids().map(in_run).collect()
    }

    /// What strengths change in a run's features, by the signatures.
    pub fn change(&self, signatures: &Signatures, strengths: &[f64], run: RunId) -> Vec<f64> {
        let mut change = Vec::new();
        for (k, x) in self.signatures.iter().zip(strengths) {
            let own = &signatures[*k].change[run];
            change.resize(own.len(), 0.0);
            change.iter_mut().zip(own).for_each(|(sum, d)| *sum += x * d);
        }
        change
    }
}

impl Fitted {
    /// All runs with its strengths, each where its nuisances are.
    pub fn requests(&self, candidates: &Candidates, signatures: &Signatures) -> impl Iterator<Item = Request> {
        let effects = self.hypothesis.applied(candidates, signatures, &self.strengths);
        let each = self.nuisance_offsets.with_ids();
        each.map(move |(run, step)| Request { run, step: step.clone(), effects: effects.clone() })
    }
}

/// How far strengths may go from where they are.
pub fn room(bounds: &[(f64, f64)], at: &[f64]) -> Vec<(f64, f64)> {
    bounds.iter().zip(at).map(|((low, high), x)| (low - x, high - x)).collect()
}

/// The same, and no farther than a share of each.
pub fn room_near(bounds: &[(f64, f64)], at: &[f64], share: f64) -> Vec<(f64, f64)> {
    let room = room(bounds, at).into_iter().zip(at);
    room.map(|((low, high), x)| (low.max(-share * x.abs()), high.min(share * x.abs()))).collect()
}

/// Strengths after a step. A sum may be beyond its bound by rounding.
pub fn stepped(at: &[f64], step: &[f64], bounds: &[(f64, f64)]) -> Vec<f64> {
    at.iter().zip(step).zip(bounds).map(|((x, more), (low, high))| (x + more).clamp(*low, *high)).collect()
}

/// Of all runs together.
pub fn norm_squared(each: &PerRun<DVector<f64>>) -> f64 {
    each.iter().map(DVector::norm_squared).sum()
}
