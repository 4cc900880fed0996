//! A second effect beside the best one, looked for in what that one leaves where it was really fitted. What its
//! signature leaves may be several times as much, in which a second one drowns.

use super::comparison::Comparison;
use super::ids::CandidateId;
use super::relinearisation::{at_alternatives, turned};
use super::scored::{self, Scored};
use super::screen::{self, Runs, Signature, explain};
use crate::base::parallel;
use crate::gap::hypothesis::{Fitted, Hypothesis, room, stepped};
use std::collections::BTreeSet;

impl Comparison<'_> {
    /// The single effect that leaves least of those that were simulated and lead, with the likeliest others beside it
    /// that no re-fit has there.
    pub fn seconds(&self, scored: &[Scored]) -> Vec<Fitted> {
        let alone = |j: &&Scored| j.fitted.hypothesis.members.len() == 1 && j.fitted.simulated() && self.leads(j);
        let first = scored.iter().filter(alone).min_by(|a, b| a.mean_square.total_cmp(&b.mean_square));
        let Some(Scored { fitted: first, .. }) = first else { return Vec::new() };
        let names = |h: &Hypothesis| -> BTreeSet<&str> { self.effects(h).into_iter().collect() };
        let simulated = scored.iter().filter(|j| j.fitted.simulated());
        let mut met: BTreeSet<BTreeSet<&str>> = simulated.map(|j| names(&j.fitted.hypothesis)).collect();
        let mut both = self.beside(first, |_| true);
        both.retain(|j| met.insert(names(&j.fitted.hypothesis)));
        both.into_iter().take(self.settings.selection.seconds).map(|j| j.fitted).collect()
    }

    /// The effect that leaves least of those that were simulated alone and may be at several places, at one place more,
    /// where it explains something; and what it leaves without it, as a mean square. Where it strikes, with the other
    /// sign and other shapes of that place, too: the known signatures are those that tell more of the nominal model's
    /// residual, in which the other places drown it.
    pub fn one_place_more(&mut self, scored: &[Scored]) -> Option<(Vec<Fitted>, f64)> {
        let candidates = self.candidates();
        let alone = |j: &&Scored| {
            let hypothesis = &j.fitted.hypothesis;
            let several = candidates[hypothesis.members[0]].several && self.effects(hypothesis).len() == 1;
            several && j.fitted.simulated() && self.explains(j.mean_square)
        };
        let first = scored.iter().filter(alone).min_by(|a, b| a.mean_square.total_cmp(&b.mean_square))?;
        let own = &candidates[first.fitted.hypothesis.members[0]].effect;
        let more = self.beside(&first.fitted, |c| candidates[c].effect == *own).into_iter().next()?.fitted;
        let otherwise = self.last_otherwise(&first.fitted, &more);
        Some(([more].into_iter().chain(otherwise).collect(), first.mean_square))
    }

    /// A hypothesis whose last member was added to a first one, with that member's strength of the other sign, and with
    /// its alternatives, by signatures of their own: those that explain most of what the first leaves. None where it
    /// does not strike.
    fn last_otherwise(&mut self, first: &Fitted, more: &Fitted) -> Vec<Fitted> {
        let (Some(own), Some(&size)) = (more.hypothesis.signatures.last(), more.strengths.last()) else {
            return Vec::new();
        };
        let signature = &self.signatures[*own];
        if size == 0.0 || !self.strikes(signature) {
            return Vec::new();
        }
        let mut trials = at_alternatives(self.context(), signature, size);
        trials.push(turned(self.context(), signature, size));
        let taken = screen::take(self.context(), &self.observations, &trials, Runs::All, &mut |_| {});
        let mut taken: Vec<Signature> =
            taken.into_iter().filter(|(_, whole)| *whole).map(|(signature, _)| signature).collect();
        taken.sort_by(|a, b| b.explains(&first.residuals).total_cmp(&a.explains(&first.residuals)));
        // The others are not kept: scores count how many signatures there are.
        taken.truncate(self.settings.selection.place_shapes);
        let joined = taken.into_iter().map(|signature| {
            let members = vec![signature.candidate];
            let signatures = vec![self.signatures.push(signature)];
            self.joined(first, &Hypothesis { members, signatures })
        });
        let found: Vec<Fitted> = joined.collect();
        found.into_iter().filter(|fitted| fitted.all_there(&self.signatures)).collect()
    }

    /// What was simulated with others beside it, at other places, the likeliest first.
    fn beside(&self, first: &Fitted, which: impl Fn(CandidateId) -> bool) -> Vec<Scored> {
        let taken: BTreeSet<CandidateId> = first.hypothesis.members.iter().map(|c| self.place(*c)).collect();
        let member = |j: &Scored| j.fitted.hypothesis.members[0];
        let mut others = self.singles();
        others.retain(|j| which(member(j)) && !taken.contains(&self.place(member(j))));
        let both = parallel::map(&others, self.simulator.threads(), |j| {
            self.score(self.joined(first, &j.fitted.hypothesis), None)
        });
        let mut both: Vec<Scored> = both.into_iter().filter(|j| j.fitted.all_there(&self.signatures)).collect();
        scored::sort(&mut both);
        both
    }

    /// What was simulated with another effect beside it, by that one's signatures.
    fn joined(&self, first: &Fitted, second: &Hypothesis) -> Fitted {
        let hypothesis = first.hypothesis.with(second);
        let own = second.signatures.iter().map(|k| self.signatures[*k].columns.clone());
        let columns: Vec<_> = first.columns.iter().cloned().chain(own).collect();
        let mut strengths = first.strengths.clone();
        strengths.resize(columns.len(), 0.0);
        let bounds = hypothesis.bounds(self.candidates(), &self.signatures);
        let by: Vec<_> = columns.iter().collect();
        let step = explain(&first.residuals, &by, &room(&bounds, &strengths), None);
        let strengths = stepped(&strengths, &step.strengths, &bounds);
        let changes = hypothesis.changed_further(&self.signatures, &first.changes, &step.strengths);
        let nuisance_offsets =
            self.observations.iter().zip(&changes).map(|(o, change)| o.nuisance_offsets(change)).collect();
        let (covariance, residuals) = (step.covariance, step.residuals);
        Fitted { hypothesis, strengths, covariance, residuals, columns, changes, nuisance_offsets, features: None }
    }
}
