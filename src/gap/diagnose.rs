//! The diagnosis: screen, re-fit, score.

use super::chance::Chance;
use super::checked::Checked;
use super::comparison::{Comparison, overall_mean_square};
use super::diagnosis::Diagnosis;
use super::hypothesis::{Fitted, Hypothesis};
use super::ids::{CandidateId, PerRun, RunId};
use super::observation::Observation;
use super::refit::refit;
use super::repeatability::repeatabilities;
use super::report::report;
use super::scored::{self, Explanation, Scored};
use super::screen;
use super::settings::Settings;
use super::signature::Signature;
use super::simulator::{Context, Simulator};
use nalgebra::DVector;
use std::collections::{BTreeMap, BTreeSet};

/// How far a diagnosis is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stage {
    Screening {
        done: usize,
        of: usize,
    },
    /// Signatures are taken again at the strengths that were found.
    Relinearising {
        done: usize,
        of: usize,
    },
    Fitting {
        done: usize,
        of: usize,
    },
    /// The repeatability that an effect has of its own.
    Replicating,
    /// Differences between carts by chance, and effects beside them.
    ByChance,
}

impl Stage {
    /// As the cost of a diagnosis has it.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Screening { .. } => "screening",
            Stage::Relinearising { .. } => "relinearisation",
            Stage::Fitting { .. } => "refits",
            Stage::Replicating => "replicates",
            Stage::ByChance => "by_chance",
        }
    }
}

/// Diagnoses the gap between a model and its runs.
pub fn diagnose(simulator: &dyn Simulator, settings: &Settings, tell: &mut dyn FnMut(Stage)) -> Diagnosis {
    diagnose_and_explain(simulator, settings, tell).0
}

/// The same, with how the likeliest hypotheses came to their scores.
pub fn diagnose_and_explain(
    simulator: &dyn Simulator,
    settings: &Settings,
    tell: &mut dyn FnMut(Stage),
) -> (Diagnosis, Vec<Explanation>) {
    let checked = Checked::new(simulator, &settings.checks);
    let simulator: &dyn Simulator = &checked;
    let context = Context { simulator, settings };
    let frames = simulator.frames();
    let observations: PerRun<Observation> = frames.iter().map(|f| Observation::new(f, &[], settings)).collect();
    let candidates = simulator.candidates();
    let left: PerRun<DVector<f64>> = observations.iter().map(|o| o.residual.clone()).collect();
    let mut told = |done, of| tell(Stage::Screening { done, of });
    let mut signatures = screen::signatures(context, &observations, &left, |_| true, &mut told);
    // What every built machine has of the effects is no gap, once their signatures are known.
    let as_built = |run: RunId| -> Vec<Vec<f64>> {
        let strength = |s: &Signature| candidates[s.candidate].strengths[s.strength].as_built;
        let some = signatures.iter().filter(|s| strength(s) > 0.0);
        some.map(|s| s.change[run].iter().map(|x| x * strength(s)).collect()).collect()
    };
    let as_built: PerRun<Vec<Vec<f64>>> = frames.ids().map(as_built).collect();
    let observations: PerRun<Observation> =
        frames.iter().zip(&as_built).map(|(f, as_built)| Observation::new(f, as_built, settings)).collect();
    for signature in &mut signatures {
        signature.columns = observations.iter().zip(&signature.change).map(|(o, c)| o.column(c)).collect();
    }
    let screened = Comparison::new(context, observations, signatures);

    // Where there is no gap there is nothing to relinearise; one that only scores tell of is too small to be
    // fitted by simulation.
    let gap = screened.mean_square > 1.0;
    let significant =
        gap || screened.singles().iter().any(|j| screened.score_test(&j.fitted).z() > settings.selection.significant);
    let comparison = if significant {
        screened.relinearised(gap, &mut |done, of| tell(Stage::Relinearising { done, of }))
    } else {
        screened
    };
    let singles = comparison.singles();
    let pairs = comparison.pairs(&singles);
    let (mut chosen, mut rest) = comparison.shortlist(singles, pairs);
    if !gap {
        rest.append(&mut chosen);
    }
    let (mut comparison, turned) = comparison.turned(&chosen);
    let chosen = chosen.into_iter().map(|j| j.fitted).chain(turned).collect();
    let fitted = refit(context, &comparison.observations, &comparison.signatures, chosen, &mut |done, of| {
        tell(Stage::Fitting { done, of });
    });
    tell(Stage::ByChance);
    let scattered = if gap { comparison.chance(&as_built).hypotheses() } else { Vec::new() };
    tell(Stage::Replicating);
    let mut scored = comparison.with_own_repeatability(fitted, &as_built);
    scored.extend(scattered.into_iter().map(|(fitted, repeatability)| comparison.score(fitted, repeatability)));
    let unsettled = |scored: &[Scored]| scored.iter().all(|j| j.mean_square > settings.selection.unsettled);
    let mut met = Vec::new();
    if gap && let Some(begun) = comparison.begun() {
        met.push(begun.hypothesis.clone());
        scored.extend(comparison.with_own_repeatability(vec![begun], &as_built));
    }
    if gap && unsettled(&scored) {
        comparison.fit_on(&mut scored, &mut met, &as_built, tell);
    }
    if gap && unsettled(&scored) {
        scored.extend(comparison.refitted(comparison.seconds(&scored), &as_built, tell));
    }
    if gap && unsettled(&scored) {
        scored.extend(comparison.refitted(comparison.at_other_strengths(&scored), &as_built, tell));
        comparison.fit_on(&mut scored, &mut met, &as_built, tell);
    }
    for _ in 1..settings.selection.places {
        let more = if gap && unsettled(&scored) { comparison.one_place_more(&scored) } else { None };
        let Some((more, before)) = more else { break };
        let more = comparison.refitted(more, &as_built, tell);
        let better = more.iter().any(|j| j.mean_square < before);
        scored.extend(more);
        comparison.fit_on(&mut scored, &mut met, &as_built, tell);
        if !better {
            break;
        }
    }
    if gap && unsettled(&scored) {
        comparison.reshape(&mut scored, &as_built, tell);
    }
    if gap {
        comparison.fit_on(&mut scored, &mut met, &as_built, tell);
    }
    tell(Stage::ByChance);
    if unsettled(&scored) {
        let both = comparison
            .companion(&scored)
            .map(|other| comparison.chance(&as_built).with_another(other, &comparison.by_chance(&scored, other)));
        let there = both.into_iter().flatten().filter(|(fitted, _)| fitted.all_there(&comparison.signatures));
        let both: Vec<Scored> = there.map(|(fitted, repeatability)| comparison.score(fitted, repeatability)).collect();
        scored.extend(both);
    }
    scored.extend(rest);
    let compared = comparison.compared(scored);
    let explained = compared.explained();
    (report(compared, checked.lost()), explained)
}

impl Comparison<'_> {
    /// What differs by chance in these runs.
    fn chance<'b>(&'b self, as_built: &'b PerRun<Vec<Vec<f64>>>) -> Chance<'b> {
        let Comparison { simulator, settings, observations, signatures, .. } = self;
        Chance { simulator: *simulator, settings, nominal: observations, as_built, signatures }
    }

    /// Pairs of other effects with the best single ones, the likeliest first.
    fn pairs(&self, singles: &[Scored]) -> Vec<Scored> {
        let first = |scored: &Scored| scored.fitted.hypothesis.members[0];
        let mut pairs: Vec<Hypothesis> = Vec::new();
        // Each candidate once, in whichever way it is likeliest: a pair has some of its strengths, or all.
        let mut met = BTreeSet::new();
        let leading: Vec<&Scored> = singles.iter().filter(|j| met.insert(first(j))).collect();
        for (rank, a) in leading.iter().enumerate().take(self.settings.selection.paired) {
            for b in &leading[rank + 1..] {
                let (x, y) = (first(a), first(b));
                if self.candidates()[x].effect != self.candidates()[y].effect {
                    let ways =
                        |c: CandidateId| singles.iter().filter(move |j| first(j) == c).map(|j| &j.fitted.hypothesis);
                    for one in ways(x) {
                        pairs.extend(ways(y).map(|two| one.with(two)));
                    }
                }
            }
        }
        self.likeliest(&pairs)
    }

    /// The effect that leaves least of those that differ by nothing and explain something.
    fn companion<'b>(&self, scored: &'b [Scored]) -> Option<&'b Fitted> {
        let alone = |j: &&Scored| {
            let members = &j.fitted.hypothesis.members;
            members.len() == 1 && self.candidates()[members[0]].random_effect.is_none() && j.fitted.simulated()
        };
        let explains = scored.iter().filter(alone).filter(|j| self.explains(j.mean_square));
        explains.min_by(|a, b| a.mean_square.total_cmp(&b.mean_square)).map(|j| &j.fitted)
    }

    /// What differs by chance and leaves least, of other effects than one beside which no re-fit has it.
    fn by_chance<'b>(&self, scored: &'b [Scored], other: &Fitted) -> Vec<&'b Fitted> {
        let beside = other.hypothesis.members[0];
        let fitted = |c: CandidateId| scored.iter().any(|j| j.fitted.hypothesis.members == [beside, c]);
        let alone = |j: &&Scored| {
            let [own] = j.fitted.hypothesis.members[..] else { return false };
            let (candidate, beside) = (&self.candidates()[own], &self.candidates()[beside]);
            let random_effect =
                candidate.random_effect.is_some() && candidate.strengths.len() == 1 && j.repeatability.is_some();
            random_effect && candidate.effect != beside.effect && !fitted(own)
        };
        let mut found: Vec<&Scored> = scored.iter().filter(alone).collect();
        found.sort_by(|a, b| a.mean_square.total_cmp(&b.mean_square));
        let mut met = BTreeSet::new();
        found.retain(|j| met.insert(j.fitted.hypothesis.members[0]));
        found.into_iter().take(self.settings.selection.random_beside).map(|j| &j.fitted).collect()
    }

    /// Each of several places of an effect in the shape that fits beside the others, re-fitted as long as one gains.
    fn reshape(&mut self, scored: &mut Vec<Scored>, as_built: &PerRun<Vec<Vec<f64>>>, tell: &mut dyn FnMut(Stage)) {
        for _ in 0..self.settings.selection.reshapings {
            let mut gained = false;
            let members = self.several_places(scored).map_or(0, |j| j.fitted.hypothesis.members.len());
            for member in 0..members {
                let Some(Scored { fitted, mean_square, .. }) = self.several_places(scored) else { return };
                let before = *mean_square;
                let Some(other) = self.reshaped(&fitted.clone(), member) else { continue };
                let other = self.refitted(vec![other], as_built, tell);
                gained |= other.iter().any(|j| j.mean_square < before);
                scored.extend(other);
            }
            if !gained {
                return;
            }
        }
    }

    /// Fits on those that leave least, in whose stead they are then.
    fn fit_on(
        &self,
        scored: &mut Vec<Scored>,
        met: &mut Vec<Hypothesis>,
        as_built: &PerRun<Vec<Vec<f64>>>,
        tell: &mut dyn FnMut(Stage),
    ) {
        let on = self.fitted_on(scored, met);
        tell(Stage::Replicating);
        for on in self.with_own_repeatability(on, as_built) {
            let before = |j: &Scored| j.fitted.hypothesis == on.fitted.hypothesis && j.mean_square > on.mean_square;
            if scored.iter().any(before) {
                scored.retain(|j| !before(j));
                scored.push(on);
            }
        }
    }

    /// Hypotheses re-fitted, before the repeatabilities that they make themselves.
    fn refitted(
        &self,
        hypotheses: Vec<Fitted>,
        as_built: &PerRun<Vec<Vec<f64>>>,
        tell: &mut dyn FnMut(Stage),
    ) -> Vec<Scored> {
        let fitted = refit(self.context(), &self.observations, &self.signatures, hypotheses, &mut |done, of| {
            tell(Stage::Fitting { done, of });
        });
        tell(Stage::Replicating);
        self.with_own_repeatability(fitted, as_built)
    }

    /// What was fitted before the repeatabilities that it makes itself. A pair of which one does nothing is the other
    /// one alone.
    fn with_own_repeatability(&self, fitted: Vec<Fitted>, as_built: &PerRun<Vec<Vec<f64>>>) -> Vec<Scored> {
        let asked = self.worth_own_repeatability(&fitted);
        let some: Vec<&Fitted> = fitted.iter().zip(&asked).filter(|(_, asked)| **asked).map(|(f, _)| f).collect();
        let mut own =
            repeatabilities(self.context(), &self.observations, as_built, &self.signatures, &some).into_iter();
        let with = fitted.into_iter().zip(asked);
        let with: Vec<_> = with.map(|(f, asked)| (f, if asked { own.next().flatten() } else { None })).collect();
        let there = with.into_iter().filter(|(fitted, _)| fitted.all_there(&self.signatures));
        there.map(|(fitted, repeatability)| self.score(fitted, repeatability)).collect()
    }

    /// Whether what leaves this mean square explains something of the gap.
    pub fn explains(&self, mean_square: f64) -> bool {
        let gap = (self.mean_square - 1.0).max(0.0);
        self.mean_square - mean_square > self.settings.selection.own_repeatability_worth * gap
    }

    /// Which fitted hypotheses are held against the repeatability that they make themselves: the best of those that
    /// explain something.
    fn worth_own_repeatability(&self, fitted: &[Fitted]) -> Vec<bool> {
        let mean_square: Vec<f64> =
            fitted.iter().map(|f| overall_mean_square(&self.observations, &f.residuals)).collect();
        let mut order: Vec<usize> = (0..fitted.len()).collect();
        order.sort_by(|a, b| mean_square[*a].total_cmp(&mean_square[*b]));
        let worth = |k: &usize| fitted[*k].simulated() && self.explains(mean_square[*k]);
        let best: BTreeSet<usize> =
            order.into_iter().filter(worth).take(self.settings.selection.own_repeatabilities).collect();
        (0..fitted.len()).map(|k| best.contains(&k)).collect()
    }

    /// What is re-fitted: the best single effects, each at its best place, and the best of all; and the rest.
    fn shortlist(&self, singles: Vec<Scored>, pairs: Vec<Scored>) -> (Vec<Scored>, Vec<Scored>) {
        let settings = &self.settings.selection;
        let (mut chosen, mut rest) = (Vec::new(), Vec::new());
        let mut seen: BTreeMap<Vec<&str>, usize> = BTreeMap::new();
        let mut all: Vec<Scored> = singles.into_iter().chain(pairs).collect();
        scored::sort(&mut all);
        let mut single = 0;
        for scored in all {
            let members = &scored.fitted.hypothesis.members;
            let mut names: Vec<&str> = members.iter().map(|c| self.candidates()[*c].effect.as_str()).collect();
            names.sort_unstable();
            let alone = members.len() == 1;
            let room = if alone {
                single < settings.refitted_singles || chosen.len() < settings.refitted
            } else {
                chosen.len() + settings.refitted_singles.saturating_sub(single) < settings.refitted
            };
            let known = seen.entry(names).or_default();
            if room && *known == 0 && scored.fitted.strengths.iter().any(|x| *x != 0.0) {
                *known += 1;
                single += usize::from(alone);
                chosen.push(scored);
            } else {
                rest.push(scored);
            }
        }
        (chosen, rest)
    }
}
