//! The correlated noise of the sensors of a campaign's runs: by the passes of one place, and, of runs that pass few
//! places again, by what they do not share with the others. An effect that runs do not share counts as noise until they
//! are fitted with it.

use super::nominal::{ready, without_sensors_effects};
use super::{FittedRun, at_a_time};
use crate::base::parallel;
use crate::dynamics::Width;
use crate::gap::ids::PerRun;
use crate::identify::excess::Excess;
use crate::identify::fit::{excess, land, residuals};
use crate::identify::noise::Noise;
use crate::identify::repeatability::Repeatability;
use crate::identify::study::Subject;
use crate::identify::unshared::{Residuals, unshared};
use crate::identify::{Counter, FitSettings, Measured, Model, Parameter};
use crate::signal::FORCES;
use crate::solve::Stop;

/// Share of a lap that has to be passed again for a run to tell its noise by that alone.
const REPEATED: f64 = 0.1;

/// What passes of one place tell of the noise in each run.
#[derive(Clone, Default)]
pub struct OfPasses {
    excess: Vec<Excess>,
    /// Which runs pass few places again.
    few: Vec<bool>,
}

impl OfPasses {
    pub fn new(subjects: &[Subject], threads: usize, (width, stop): (Width, Stop), counter: &Counter) -> OfPasses {
        let excess: Vec<Excess> =
            parallel::map(subjects, threads, |subject| repeated(subject, width, stop, counter).unwrap_or_default());
        let lap =
            |subject: &Subject| subject.simulation.track.centre_line().length / subject.simulation.chain.speed_m_s;
        let few = excess.iter().zip(subjects).map(|(own, subject)| own.length() < REPEATED * lap(subject)).collect();
        OfPasses { excess, few }
    }

    /// The noise of each run, by what nominal models fitted to runs leave, too.
    pub fn with_nominal(
        &self,
        subjects: &[Subject],
        (fit, width, threads): (&FitSettings, Width, usize),
        counter: &Counter,
    ) -> Vec<[Noise; FORCES]> {
        let alone = Excess::noise(&self.excess);
        if !self.few.contains(&true) {
            return alone;
        }
        let numbered: Vec<(&Subject, [Noise; FORCES])> = subjects.iter().zip(alone.iter().copied()).collect();
        let left = parallel::map(&numbered, at_a_time(threads), |&(subject, correlated)| {
            let (measured, mut model) = ready(subject, width).ok()?;
            model.counter = counter.clone();
            let landing = land(&mut model, &measured, None, &fit.knowing(Some(correlated))).ok()?.1;
            Some(residuals(&model, &measured, &landing.at, &landing.centre.ensemble))
        });
        left.into_iter().collect::<Option<Vec<_>>>().map_or(alone, |left| self.with(&left))
    }

    /// The noise of each run, by what models leave that runs are fitted with; `None` where passes tell it alone.
    pub fn with_fitted(&self, subjects: &[Subject], runs: &PerRun<FittedRun>) -> Option<Vec<[Noise; FORCES]>> {
        if !self.few.contains(&true) {
            return None;
        }
        let left = |(subject, run): (&Subject, &FittedRun)| {
            let lap = subject.simulation.track.centre_line().length;
            let measured = Measured::new(&subject.run, &subject.simulation, lap).ok()?;
            Some(residuals(&run.model, &measured, &run.landing.at, &run.landing.centre.ensemble))
        };
        let left = subjects.iter().zip(runs).map(left).collect::<Option<Vec<_>>>()?;
        Some(self.with(&left))
    }

    /// The noise of each run, where runs that pass few places again have more than what all share.
    fn with(&self, left: &[Residuals]) -> Vec<[Noise; FORCES]> {
        let mut all = self.excess.clone();
        let each = all.iter_mut().zip(unshared(left)).zip(&self.few);
        each.filter(|(_, few)| **few).for_each(|((own, unshared), _)| own.add(unshared));
        Excess::noise(&all)
    }
}

/// What a run's passes of the same places differ by beyond simulated ones, where it has some.
fn repeated(subject: &Subject, width: Width, stop: Stop, counter: &Counter) -> Option<Excess> {
    let lap = subject.simulation.track.centre_line().length;
    let measured = Measured::new(&subject.run, &subject.simulation, lap).ok().filter(|run| run.laps > 1.0)?;
    let simulation = without_sensors_effects(&subject.simulation);
    let mut model = Model::new(&simulation, simulation.contact_law, &measured, width);
    (model.counter, model.stop) = (counter.clone(), stop);
    let at = Parameter::ALL.map(|p| model.coordinate(p, model.nominal[p.index()]));
    let ensemble = Repeatability::run_ensemble(&model, &at, None)?;
    Some(excess(&model, &measured, &at, &ensemble))
}
