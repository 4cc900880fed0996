//! Strengths that are looked for only beside an effect's others. A harmonic alone is the fundamental at a shorter pitch, so
//! that it would stand for another site of its own effect. Their signatures are taken where the others explain something.

use super::comparison::Comparison;
use super::hypothesis::Hypothesis;
use super::ids::{CandidateId, SignatureId};
use super::relinearisation::again;
use super::scored::Scored;
use super::signature::{Runs, Trial, keep, take};
use std::collections::BTreeSet;

impl Comparison<'_> {
    /// Takes signatures of such strengths where the effect's others explain something, at first as large as these, then
    /// at the strength that fits beside them.
    pub fn look_beside(&mut self, tell: &mut dyn FnMut(usize, usize)) {
        let places = self.places_with_strengths_beside();
        for _ in 0..self.settings.relinearisation.rounds {
            let trials: Vec<Trial> = places.iter().flat_map(|(own, size)| self.trials_beside(own, *size)).collect();
            if trials.is_empty() {
                break;
            }
            let of = trials.len();
            let mut told = |done| tell(done, of);
            let taken = take(self.context(), &self.observations, &trials, Runs::All, &mut told);
            let left = self.residuals();
            for (signature, _) in taken.into_iter().filter(|(_, whole)| *whole) {
                keep(&mut self.signatures, signature, &left);
            }
        }
    }

    /// Whether a signature is of a strength that is looked for only beside others.
    pub fn is_beside(&self, signature: SignatureId) -> bool {
        let own = &self.signatures[signature];
        self.candidates()[own.candidate].strengths[own.strength].beside
    }

    /// Effects that have such strengths and are among those that explain most, at the sites where the others explain
    /// most, each site with its alternatives once, and the largest of the others' strengths.
    fn places_with_strengths_beside(&self) -> Vec<(Hypothesis, f64)> {
        let worth = self.settings.relinearisation.worth * (self.mean_square - 1.0).max(0.0);
        let member = |j: &Scored| j.fitted.hypothesis.members[0];
        let has = |c: CandidateId| self.candidates()[c].strengths.iter().any(|s| s.beside);
        let mut met: BTreeSet<CandidateId> = BTreeSet::new();
        let mut effects: BTreeSet<&str> = BTreeSet::new();
        let explaining = self.singles().into_iter().filter(|j| self.mean_square - j.mean_square > worth);
        let first = explaining.take_while(|j| {
            effects.insert(&self.candidates()[member(j)].effect);
            effects.len() <= self.settings.relinearisation.effects
        });
        let explaining = first.filter(|j| has(member(j)) && met.insert(self.place(member(j))));
        let largest = |j: Scored| {
            let size = j.fitted.strengths.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            (j.fitted.hypothesis, size)
        };
        explaining
            .map(largest)
            .filter(|(_, size)| *size > 0.0)
            .take(self.settings.relinearisation.beside_places)
            .collect()
    }

    /// Of each such strength of an effect, beside a hypothesis of its others: the first trial, or another one where
    /// another strength fits than its signature was taken at.
    fn trials_beside(&self, own: &Hypothesis, size: f64) -> Vec<Trial> {
        let candidate = own.members[0];
        let of = |strength: usize| {
            let known = self.signatures.with_ids();
            let mut known = known.filter(|(_, s)| (s.candidate, s.strength) == (candidate, strength));
            let Some((k, signature)) = known.next() else { return Some(Trial { candidate, strength, size }) };
            let members = vec![candidate];
            let signatures = own.signatures.iter().copied().chain([k]).collect();
            let with = Hypothesis { members, signatures };
            let fitted = with.screened(&self.observations, &self.signatures, self.candidates());
            again(self.context(), signature, *fitted.strengths.last()?)
        };
        let strengths = self.candidates()[candidate].strengths.iter().enumerate().filter(|(_, s)| s.beside);
        strengths.filter_map(|(strength, _)| of(strength)).collect()
    }
}
