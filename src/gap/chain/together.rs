//! Strengths of effects fitted together with the parameters of each run: what the nominal model lacks pulls its
//! parameters to where slopes no longer reach, and strengths that are fitted there are too small. In turns each run is
//! fitted with the effects, and strengths step by what of the residual parameters cannot take, as the columns of
//! effects are without what parameters reach (variable projection: Golub and Pereyra 1973).

use super::nominal::{Known, fitted_with};
use super::{Chains, FittedRun, at_a_time, frame};
use crate::base::parallel;
use crate::chain_input::DeclaredEffect;
use crate::effects::{deviations_of, named};
use crate::gap::hypothesis::{norm_squared, room_near, stepped};
use crate::gap::ids::{List, PerRun, RunId};
use crate::gap::observation::Observation;
use crate::gap::screen::explain;
use crate::gap::settings::Settings;
use crate::identify::model::Plan;
use crate::identify::study::Subject;
use nalgebra::DVector;

/// One of the strengths, in one of the effects.
struct Strength {
    effect: usize,
    name: &'static str,
    low: f64,
    high: f64,
}

impl Chains {
    /// Where the parameters of each run are, and its noise, with effects whose strengths are fitted with them; and the
    /// effects. `None` where runs cannot be fitted with them. Parameters are known to be near to where they are given.
    pub(super) fn together(
        &self,
        subjects: &[Subject],
        (mut effects, near): (Vec<DeclaredEffect>, &[Known]),
        settings: &Settings,
        tell: &(dyn Fn(&str) + Sync),
    ) -> Option<(Vec<Known>, Vec<DeclaredEffect>)> {
        let ensembles = &self.settings.ensembles;
        let strengths = strengths(&effects);
        let bounds: Vec<(f64, f64)> = strengths.iter().map(|own| (own.low, own.high)).collect();
        let mut best: Option<(f64, Vec<Known>, Vec<DeclaredEffect>)> = None;
        let mut near = near.to_vec();
        for round in 0..ensembles.together {
            let (runs, known) = self.fitted_with(subjects, &effects, Some(&near), tell)?;
            let observations: PerRun<Observation> = subjects
                .iter()
                .zip(&runs)
                .map(|(s, run)| Observation::new(&frame::frame(&s.name, run), &[], settings))
                .collect();
            let left: PerRun<DVector<f64>> = observations.iter().map(|o| o.residual.clone()).collect();
            let square = norm_squared(&left);
            if best.as_ref().is_none_or(|(least, ..)| square < *least) {
                best = Some((square, known.clone(), effects.clone()));
            }
            if round + 1 == ensembles.together {
                break;
            }
            let columns = self.columns(&runs, &observations, (&effects, &strengths), settings.gauss_newton.share)?;
            let at: Vec<f64> = strengths.iter().map(|own| effects[own.effect].strengths[own.name]).collect();
            let room = room_near(&bounds, &at, settings.gauss_newton.far);
            let step = explain(&left, &columns.iter().collect::<Vec<_>>(), &room, None).strengths;
            let short = |(x, step): (&f64, &f64)| step.abs() < ensembles.together_near * x.abs();
            if at.iter().zip(&step).all(short) {
                break;
            }
            for (own, x) in strengths.iter().zip(stepped(&at, &step, &bounds)) {
                effects[own.effect].strengths.insert(own.name.to_owned(), x);
            }
            near = known;
        }
        best.map(|(_, known, effects)| (known, effects))
    }

    /// Each run, fitted with effects.
    pub(super) fn fitted_with(
        &self,
        subjects: &[Subject],
        effects: &[DeclaredEffect],
        near: Option<&[Known]>,
        tell: &(dyn Fn(&str) + Sync),
    ) -> Option<(PerRun<FittedRun>, Vec<Known>)> {
        let numbered: Vec<(usize, &Subject)> = subjects.iter().enumerate().collect();
        let fitted = parallel::map(&numbered, at_a_time(self.threads), |&(k, subject)| {
            let near = near.and_then(|near| near.get(k));
            let found = fitted_with(subject, &self.fit, &self.settings, self.width, effects, near);
            tell(&subject.name);
            found.ok()
        });
        let (mut runs, mut known) = (List::default(), Vec::new());
        for one in fitted {
            let (run, own) = one?;
            runs.push(run);
            known.push(own);
        }
        Some((runs, known))
    }

    /// What one more of each strength changes in each run, without what parameters reach: between a share less and as
    /// much more of it.
    fn columns(
        &self,
        runs: &PerRun<FittedRun>,
        observations: &PerRun<Observation>,
        (effects, strengths): (&[DeclaredEffect], &[Strength]),
        share: f64,
    ) -> Option<Vec<PerRun<DVector<f64>>>> {
        let moved = |own: &Strength, by: f64| -> (f64, Vec<DeclaredEffect>) {
            let mut effects = effects.to_vec();
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

    /// Features of a run with effects instead of those it was fitted with.
    pub(super) fn features_with(
        &self,
        runs: &PerRun<FittedRun>,
        run: RunId,
        effects: &[DeclaredEffect],
    ) -> Option<Vec<f64>> {
        let fitted = &runs[run];
        let mut model = fitted.model.clone();
        model.simulation.effects = self.runs[run].with(effects.to_vec()).simulation.effects;
        let settled = &fitted.landing.centre.ensemble.settled;
        let plan = Plan { passes: self.settings.ensembles.passes, from: Some(settled), ..Plan::default() };
        let deviations = deviations_of(&model.simulation).ok()?.1;
        let ensemble = model.run_ensemble(&fitted.landing.at, &plan)?;
        Some(fitted.features(&model, &ensemble, &deviations, false, fitted.landing.at))
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
