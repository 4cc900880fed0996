//! Effects that could not be simulated. What was never compared with the runs is not ruled out by them: it is held to
//! be as likely as the best of what was compared, so that nobody inherits its share.
//!
//! With ln p its prior, m the number of its strengths and ln L the largest log likelihood of all that was compared
//! (effects, no gap, something unknown), its log posterior is ln p + ln L − m ln(f)/2. An effect that explains
//! everything then has no more than its prior's share against that of the untested one: one half, where both are single
//! effects with one place and one strength.

use super::comparison::Compared;
use super::ids::CandidateId;
use super::likelihood;
use crate::base::trig;
use crate::gap::hypothesis::Hypothesis;
use std::collections::BTreeMap;

/// An effect at a place of which some strengths could not be simulated in all runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Untested {
    pub candidate: CandidateId,
    /// Log prior.
    pub prior: f64,
    /// Log posterior.
    pub log_posterior: f64,
}

impl Compared<'_> {
    /// Candidates with strengths that have no signature, once all others are scored.
    pub fn untested(&self) -> Vec<Untested> {
        let mut known: BTreeMap<CandidateId, Vec<usize>> = BTreeMap::new();
        for signature in &self.comparison.signatures {
            known.entry(signature.candidate).or_default().push(signature.strength);
        }
        let lacks = |c: CandidateId| {
            // What is looked for only beside other strengths is no reason to believe in the effect.
            let strengths = self.comparison.candidates()[c].strengths.iter().enumerate().filter(|(_, s)| !s.beside);
            strengths.filter(|(s, _)| !known.get(&c).is_some_and(|own| own.contains(s))).count()
        };
        let alone =
            self.comparison.candidates().ids().filter(|c| self.comparison.candidates()[*c].alternative_to.is_none());
        let lacking: Vec<(CandidateId, usize)> = alone.map(|c| (c, lacks(c))).filter(|(_, n)| *n > 0).collect();
        if lacking.is_empty() {
            return Vec::new();
        }
        let best = self.best_likelihood();
        let weighed = |(candidate, strengths): (CandidateId, usize)| {
            let alone = Hypothesis { members: vec![candidate], signatures: Vec::new() };
            let prior = self.comparison.prior(&alone);
            let cost = likelihood::cost(strengths as f64, self.comparison.degrees_of_freedom);
            Untested { candidate, prior, log_posterior: prior + best - cost }
        };
        lacking.into_iter().map(weighed).collect()
    }

    /// The largest log likelihood of all that was compared with the runs.
    fn best_likelihood(&self) -> f64 {
        let settings = self.comparison.likelihood();
        let none = settings.log_likelihood(self.comparison.mean_square, self.comparison.degrees_of_freedom);
        let unknown = self.unknown - trig::ln(settings.prior_unknown)
            + likelihood::cost(settings.unknown_strengths, self.comparison.degrees_of_freedom);
        let by_signature = self.scored.iter().map(|j| {
            let strengths = self.comparison.strengths(&j.fitted.hypothesis);
            j.log_posterior() - self.comparison.prior(&j.fitted.hypothesis)
                + likelihood::cost(strengths, self.comparison.degrees_of_freedom)
        });
        by_signature.fold(none.max(unknown), f64::max)
    }
}
