//! The runs fitted again once the cause is nearly known: what the nominal model lacks pulls its parameters to where they
//! imitate it and counts in part as noise, and slopes reach no farther than they were taken.

use super::fitted_with::{Campaign, FittedWith};
use super::{Chains, Fitting};
use crate::chain_input::DeclaredEffect;
use crate::effects::stiffness_temperature;
use crate::gap::diagnosis::{Diagnosis, Finding, Verdict};
use crate::gap::settings::Settings;
use crate::gap::simulator::{Applied, Candidate, Candidates, Simulator};
use crate::identify::Counter;
use crate::identify::study::Subject;
use std::collections::BTreeSet;

impl Chains {
    /// The same runs, with parameters and noise as a model has them that lacks nothing of what a diagnosis named or, where
    /// it named nothing, of the best that it knew. `None` where that is no effect of the machine, or leaves no run far
    /// over its limit, or runs cannot be fitted with it. Offered are the likeliest effects of the machine, and all of
    /// sensors.
    pub fn anew(
        &self,
        subjects: &[Subject],
        found: &Diagnosis,
        settings: &Settings,
        tell: &(dyn Fn(&str) + Sync),
    ) -> Option<Chains> {
        if found.verdict == Verdict::None || found.left() < self.settings.ensembles.left_anew {
            return None;
        }
        let mut best = found.with();
        best.retain(|finding| !finding.may_be_absent());
        let by_chance = |finding: &&Finding| {
            let own = self.candidates.iter().filter(|c| c.effect == finding.name && c.place == finding.place);
            own.into_iter().any(|c| c.random_effect.is_some())
        };
        if best.iter().any(by_chance) {
            return None;
        }
        let of_machine = |finding: &&&Finding| {
            self.candidates.iter().any(|candidate| candidate.effect == finding.name && !candidate.sensor)
        };
        // What comes up in a run is no part of a model whose carts are laps.
        let steady = |effect: &DeclaredEffect| stiffness_temperature::warming(effect).is_none();
        let about = best.iter().filter(of_machine).flat_map(|f| f.declared()).filter(steady);
        let about: Vec<DeclaredEffect> = about.collect();
        if about.is_empty() {
            return None;
        }
        let campaign = Campaign { subjects, settings, tell };
        let FittedWith { mut known, effects, runs, .. } = self.together(campaign, self.in_shape(campaign, about)?)?;
        // What runs do not share of a gap counts as noise until they are fitted with it.
        let correlated = self.of_passes.with_fitted(subjects, &runs).unwrap_or_default();
        known.iter_mut().zip(&correlated).for_each(|(own, correlated)| own.quieter(correlated));
        let likeliest: BTreeSet<&str> =
            found.effects.iter().take(self.settings.ensembles.offered_anew).map(|f| f.name.as_str()).collect();
        let fitting = Fitting {
            fit: self.fit,
            of_passes: self.of_passes.clone(),
            correlated: Vec::new(),
            settings: &self.settings,
            threads: self.threads,
            width: self.width,
            known: Some(&known),
            offered: &|effect| effect.is_sensor() || likeliest.contains(effect.name()),
            counter: Counter::after(self.effort()),
        };
        let mut next = Chains::fitted(subjects, fitting, tell).ok()?;
        let begin = effects.iter().filter_map(|effect| next.offered_as(effect, &self.candidates)).collect();
        next.begin = begin;
        Some(next)
    }

    /// An effect as one of the candidates with its strengths. Where the gap no longer points to its place, the candidate
    /// that it was before is one of these, too.
    fn offered_as(&mut self, effect: &DeclaredEffect, before: &Candidates) -> Option<Applied> {
        let known = self.candidates.with_ids().find(|(_, candidate)| candidate.is(effect)).map(|(id, _)| id);
        let candidate = match known {
            Some(id) => id,
            None => {
                let own = before.iter().find(|candidate| candidate.is(effect))?.clone();
                self.candidates.push(Candidate { alternative_to: None, ..own })
            }
        };
        let own = self.candidates[candidate].strengths.iter();
        let strengths = own.map(|s| effect.strengths.get(&s.name).copied().unwrap_or_default()).collect();
        Some(Applied { candidate, strengths })
    }
}
