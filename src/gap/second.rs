//! A second effect beside the best one, looked for in what that one leaves where it was really fitted. What its
//! signature leaves may be several times as much, in which a second one drowns.

use super::comparison::Comparison;
use super::ids::CandidateId;
use super::scored::{self, Scored};
use super::signature::{Explained, explain};
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

    /// What was simulated with others beside it, at other places, the likeliest first.
    pub fn beside(&self, first: &Fitted, which: impl Fn(CandidateId) -> bool) -> Vec<Scored> {
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
    pub fn joined(&self, first: &Fitted, second: &Hypothesis) -> Fitted {
        let hypothesis = first.hypothesis.with(second);
        let own = second.signatures.iter().map(|k| self.signatures[*k].columns.clone());
        let columns: Vec<_> = first.columns.iter().cloned().chain(own).collect();
        let mut strengths = first.strengths.clone();
        strengths.resize(columns.len(), 0.0);
        let bounds = hypothesis.bounds(self.candidates(), &self.signatures);
        let by: Vec<_> = columns.iter().collect();
        let step = explain(&first.residuals, &by, &room(&bounds, &strengths), None);
        let changes = hypothesis.changed_further(&self.signatures, &first.changes, &step.strengths);
        let explained = Explained { strengths: stepped(&strengths, &step.strengths, &bounds), ..step };
        hypothesis.foretold(&self.observations, explained, columns, changes)
    }
}
