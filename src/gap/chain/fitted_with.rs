//! Runs fitted with effects that the nominal model lacks.

use super::nominal::{Known, fitted_with};
use super::{Chains, FittedRun, at_a_time, frame};
use crate::base::parallel;
use crate::chain_input::DeclaredEffect;
use crate::effects::deviations_of;
use crate::gap::ids::{List, PerRun, RunId};
use crate::gap::observation::Observation;
use crate::gap::settings::Settings;
use crate::gap::simulator::Frame;
use crate::identify::model::Plan;
use crate::identify::study::Subject;

/// A campaign's runs as they were measured, the settings that they are compared by, and who is told of each fit.
#[derive(Clone, Copy)]
pub(super) struct Campaign<'a> {
    pub subjects: &'a [Subject],
    pub settings: &'a Settings,
    pub tell: &'a (dyn Fn(&str) + Sync),
}

/// Runs that are fitted with effects.
pub(super) struct FittedWith {
    pub effects: Vec<DeclaredEffect>,
    pub known: Vec<Known>,
    pub runs: PerRun<FittedRun>,
    /// What is left of each run.
    pub observations: PerRun<Observation>,
    pub frames: PerRun<Frame>,
}

impl Chains {
    /// All runs, fitted with effects, from where their parameters are known to be nearly. `None` where one cannot be.
    pub(super) fn all_with(
        &self,
        campaign: Campaign,
        effects: Vec<DeclaredEffect>,
        near: Option<&[Known]>,
    ) -> Option<FittedWith> {
        let Campaign { subjects, settings, tell } = campaign;
        let numbered: Vec<(usize, (RunId, &Subject))> = self.runs.ids().zip(subjects).enumerate().collect();
        let fitted = parallel::map(&numbered, at_a_time(self.threads), |&(k, (run, subject))| {
            let near = near.and_then(|near| near.get(k));
            let found = fitted_with(subject, &self.fit_of(run), &self.settings, self.width, &effects, near);
            tell(&subject.name);
            found.ok()
        });
        let (mut runs, mut known) = (List::default(), Vec::new());
        for one in fitted {
            let (run, own) = one?;
            runs.push(run);
            known.push(own);
        }
        let named = subjects.iter().zip(&runs);
        let frames: PerRun<Frame> = named.map(|(subject, run)| frame::frame(&subject.name, run)).collect();
        let observations = frames.map(|frame| Observation::new(frame, &[], settings));
        Some(FittedWith { effects, known, runs, observations, frames })
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
