//! Strengths of effects fitted together with the parameters of each run: what the nominal model lacks pulls its
//! parameters to where slopes no longer reach, and strengths that are fitted there are too small. In turns each run is
//! fitted with the effects, and strengths step by what of the residual parameters cannot take, as the columns of
//! effects are without what parameters reach (variable projection: Golub and Pereyra 1973).

use super::Chains;
use super::fitted_with::{Campaign, FittedWith};
use crate::base::parallel;
use crate::chain_input::DeclaredEffect;
use crate::effects::named;
use crate::gap::hypothesis::{norm_squared, room_near, stepped};
use crate::gap::ids::{List, PerRun};
use crate::gap::signature::explain;
use nalgebra::DVector;

/// One of the strengths, in one of the effects.
struct Strength {
    effect: usize,
    name: &'static str,
    low: f64,
    high: f64,
}

impl Chains {
    /// Runs fitted with effects, whose strengths are fitted on with the parameters. `None` where runs cannot be fitted
    /// with them.
    pub(super) fn together(&self, campaign: Campaign, begun: FittedWith) -> Option<FittedWith> {
        let (ensembles, settings) = (&self.settings.ensembles, &campaign.settings.gauss_newton);
        let strengths = strengths(&begun.effects);
        let bounds: Vec<(f64, f64)> = strengths.iter().map(|own| (own.low, own.high)).collect();
        let mut now = begun;
        let mut best: Option<FittedWith> = None;
        for _ in 1..ensembles.together {
            let left = now.observations.map(|own| own.residual.clone());
            let columns = self.columns(&now, &strengths, settings.share)?;
            let at: Vec<f64> = strengths.iter().map(|own| now.effects[own.effect].strengths[own.name]).collect();
            let room = room_near(&bounds, &at, settings.far);
            let step = explain(&left, &columns.iter().collect::<Vec<_>>(), &room, None).strengths;
            let short = |(x, step): (&f64, &f64)| step.abs() < ensembles.together_near * x.abs();
            if at.iter().zip(&step).all(short) {
                break;
            }
            let mut effects = now.effects.clone();
            for (own, x) in strengths.iter().zip(stepped(&at, &step, &bounds)) {
                effects[own.effect].strengths.insert(own.name.to_owned(), x);
            }
            let next = self.all_with(campaign, effects, Some(&now.known))?;
            keep_less(&mut best, std::mem::replace(&mut now, next));
        }
        keep_less(&mut best, now);
        best
    }

    /// What one more of each strength changes in each run, without what parameters reach: between a share less and as
    /// much more of it.
    fn columns(&self, now: &FittedWith, strengths: &[Strength], share: f64) -> Option<Vec<PerRun<DVector<f64>>>> {
        let FittedWith { effects, runs, observations, .. } = now;
        let moved = |own: &Strength, by: f64| -> (f64, Vec<DeclaredEffect>) {
            let mut effects = effects.clone();
            let x = effects[own.effect].strengths.entry(own.name.to_owned()).or_default();
            *x = (*x * by).clamp(own.low, own.high);
            (*x, effects)
        };
        let mut asked = Vec::new();
        for own in strengths {
            for run in runs.ids() {
                asked.push((run, moved(own, 1.0 - share)));
                asked.push((run, moved(own, 1.0 + share)));
            }
        }
        let answers =
            parallel::map(&asked, self.threads, |(run, (_, effects))| self.features_with(runs, *run, effects));
        let mut columns = Vec::new();
        let mut each = asked.iter().zip(answers);
        for _ in strengths {
            let mut column = List::default();
            for run in runs.ids() {
                let (((_, (less, _)), low), ((_, (more, _)), high)) = (each.next()?, each.next()?);
                let (low, high) = (low?, high?);
                let slope = low.iter().zip(&high).map(|(a, b)| (b - a) / (more - less));
                column.push(observations[run].column(&slope.collect::<Vec<f64>>()));
            }
            columns.push(column);
        }
        Some(columns)
    }
}

/// Keeps what leaves less, or what was there first.
fn keep_less(best: &mut Option<FittedWith>, next: FittedWith) {
    let square = |own: &FittedWith| norm_squared(&own.observations.map(|run| run.residual.clone()));
    if best.as_ref().is_none_or(|best| square(&next) < square(best)) {
        *best = Some(next);
    }
}

/// What of effects can be fitted: strengths that are there.
fn strengths(effects: &[DeclaredEffect]) -> Vec<Strength> {
    let mut all = Vec::new();
    for (k, effect) in effects.iter().enumerate() {
        let Some(known) = named(&effect.name) else { continue };
        for own in known.definition.strengths {
            if effect.strengths.get(own.name).is_some_and(|x| *x != 0.0) {
                all.push(Strength { effect: k, name: own.name, low: own.low, high: own.high });
            }
        }
    }
    all
}
