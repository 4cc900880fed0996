//! Shapes of an effect's places, chosen where runs are fitted with it. A wrong shape pulls the parameters of a run to
//! where it fits, and there the right one leaves more by its signature. So each other shape is simulated once the
//! parameters know of all places, and the ones that leave least are fitted together with the parameters.

use super::fitted_with::{Campaign, FittedWith};
use super::nominal::fitted_with;
use super::{Chains, frame};
use crate::base::parallel;
use crate::chain_input::DeclaredEffect;
use crate::gap::hypothesis::norm_squared;
use crate::gap::ids::{CandidateId, Id, PerRun, RunId};
use crate::gap::observation::{Observation, most_off};
use crate::gap::signature::explain;
use crate::gap::simulator::Strength;
use nalgebra::DVector;

/// As a mean square.
fn left(observation: &Observation) -> f64 {
    observation.mean_square(&observation.residual)
}

/// Of all runs together.
fn left_in_all(own: &FittedWith) -> f64 {
    own.observations.iter().map(left).sum()
}

impl Chains {
    /// Effects in the shapes of their places that leave least where runs are fitted with them, and where the parameters
    /// of each run are then. `None` where runs cannot be fitted with effects.
    pub(super) fn in_shape(&self, campaign: Campaign, effects: Vec<DeclaredEffect>) -> Option<FittedWith> {
        let ensembles = &self.settings.ensembles;
        let mut best = self.all_with(campaign, effects, None)?;
        for _ in 0..ensembles.reshaped {
            let run = most_off(&best.observations, best.observations.iter().map(|own| &own.residual));
            let own = &best.observations[run];
            if left(own) <= own.replicate_high / own.replicate {
                break;
            }
            let shapes = self.ranked(&best, run);
            let near = &best.known[run.index()];
            let mut fitted: Vec<(f64, Vec<DeclaredEffect>)> = parallel::map(&shapes, self.threads, |effects| {
                let (fit, settings) = (&self.fit_of(run), &self.settings);
                let subject = &campaign.subjects[run.index()];
                let (fitted, _) = fitted_with(subject, fit, settings, self.width, effects, Some(near)).ok()?;
                let observation = Observation::new(&frame::frame(&subject.name, &fitted), &[], campaign.settings);
                Some((left(&observation), effects.clone()))
            })
            .into_iter()
            .flatten()
            .collect();
            fitted.sort_by(|a, b| a.0.total_cmp(&b.0));
            let least = fitted.first().map_or(f64::INFINITY, |own| own.0);
            if least > (1.0 - ensembles.shape_worth) * left(own) {
                break;
            }
            // One run may not tell two of them apart.
            fitted.retain(|own| own.0 <= (1.0 + ensembles.shape_tie) * least);
            let of_all =
                fitted.into_iter().filter_map(|(_, effects)| self.all_with(campaign, effects, Some(&best.known)));
            let Some(next) = of_all.min_by(|a, b| left_in_all(a).total_cmp(&left_in_all(b))) else { break };
            if left_in_all(&next) > (1.0 - ensembles.shape_worth) * left_in_all(&best) {
                break;
            }
            best = next;
        }
        Some(best)
    }

    /// Effects with another shape or sign of one of them, those that leave least of a run first, as many as are fitted:
    /// each beside the others, whose strengths then change along what each does beside all.
    fn ranked(&self, best: &FittedWith, run: RunId) -> Vec<Vec<DeclaredEffect>> {
        let FittedWith { effects, runs, frames, observations, .. } = best;
        let without = |place: usize| {
            let mut others = effects.clone();
            others.remove(place);
            others
        };
        let with = |place: usize, shape: DeclaredEffect| {
            let mut all = effects.clone();
            all[place] = shape;
            (place, all)
        };
        let places = effects.iter().enumerate();
        let shapes: Vec<(usize, Vec<DeclaredEffect>)> = places
            .flat_map(|(place, effect)| self.other_shapes(effect).into_iter().map(move |shape| with(place, shape)))
            .collect();
        let asked: Vec<Vec<DeclaredEffect>> =
            (0..effects.len()).map(without).chain(shapes.iter().map(|(_, all)| all.clone())).collect();
        let mut answers = parallel::map(&asked, self.threads, |with| self.features_with(runs, run, with)).into_iter();
        let Some(without) = answers.by_ref().take(effects.len()).collect::<Option<Vec<Vec<f64>>>>() else {
            return Vec::new();
        };
        let changed = |from: &[f64], to: &[f64]| {
            let change: Vec<f64> = to.iter().zip(from).map(|(to, from)| to - from).collect();
            observations[run].column(&change)
        };
        let own: Vec<DVector<f64>> = without.iter().map(|without| changed(without, &frames[run].nominal)).collect();
        let most = self.settings.ensembles.shape_grows;
        let mut ranked: Vec<(f64, Vec<DeclaredEffect>)> = Vec::new();
        for ((place, mut all), features) in shapes.into_iter().zip(answers) {
            let Some(features) = features else { continue };
            let gap: PerRun<_> = vec![&observations[run].residual + &own[place]].into();
            let column = |k: usize| if k == place { changed(&without[place], &features) } else { own[k].clone() };
            let columns: Vec<PerRun<_>> = (0..own.len()).map(|k| vec![column(k)].into()).collect();
            let before = |k: usize| if k == place { 0.0 } else { 1.0 };
            let room: Vec<(f64, f64)> = (0..own.len()).map(|k| (-before(k), most - before(k))).collect();
            let explained = explain(&gap, &columns.iter().collect::<Vec<_>>(), &room, None);
            let mut scaled = all.iter_mut().zip(&explained.strengths).enumerate();
            if scaled.all(|(k, (effect, by))| self.scale(effect, before(k) + by)) {
                ranked.push((norm_squared(&explained.residuals), all));
            }
        }
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
        ranked.into_iter().take(self.settings.ensembles.shapes_fitted).map(|(_, effects)| effects).collect()
    }

    /// The candidate that an effect is, and what of it is fitted; none where that is more than one strength.
    fn place_of(&self, effect: &DeclaredEffect) -> Option<(CandidateId, &Strength)> {
        let (id, candidate) = self.candidates.with_ids().find(|(_, candidate)| candidate.is(effect))?;
        match &candidate.strengths[..] {
            [strength] if candidate.several => Some((id, strength)),
            _ => None,
        }
    }

    /// An effect in the other shapes of its place, and with the other sign in each.
    fn other_shapes(&self, effect: &DeclaredEffect) -> Vec<DeclaredEffect> {
        let Some((own, strength)) = self.place_of(effect) else { return Vec::new() };
        let beside = |of: CandidateId| {
            let ids = self.candidates.with_ids();
            ids.filter(move |(id, candidate)| *id == of || candidate.alternative_to == Some(of))
        };
        let middle = if beside(own).count() > 1 { Some(own) } else { self.candidates[own].alternative_to };
        let Some(middle) = middle else { return Vec::new() };
        let size = effect.strengths.get(&strength.name).copied().unwrap_or_default();
        let sizes: &[f64] = if strength.low < 0.0 { &[size, -size] } else { &[size] };
        let mut shapes = Vec::new();
        for (_, candidate) in beside(middle) {
            for size in sizes {
                let strengths = candidate.fixed.iter().cloned().chain([(strength.name.clone(), *size)]).collect();
                shapes.push(DeclaredEffect { name: candidate.effect.clone(), strengths });
            }
        }
        shapes.retain(|shape| shape != effect);
        shapes
    }

    /// Makes an effect so many times as large, if that may be; whether it is there then.
    fn scale(&self, effect: &mut DeclaredEffect, by: f64) -> bool {
        let Some((_, strength)) = self.place_of(effect) else { return true };
        let (low, high) = (strength.low, strength.high);
        let Some(size) = effect.strengths.get_mut(&strength.name) else { return false };
        *size = (*size * by).clamp(low, high);
        *size != 0.0
    }
}
