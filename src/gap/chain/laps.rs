//! Laps of a run with effects: each cart of a simulation that is like the one with the sensors is one.

use super::{Chains, frame};
use crate::chain_input as input;
use crate::chain_input::{Deviations, Simulation};
use crate::dynamics::Ensemble;
use crate::effects::deviations_of;
use crate::effects::load_distribution::{DRAW, EFFECT as LOAD, Loaded};
use crate::gap::simulator::{Laps, Request};
use crate::identify::{Model, repeatability::Repeatability};
use std::iter;

impl Chains {
    /// Laps of a run with effects, whose variances are those of its frame and what the machine's effects add to them:
    /// each cart of a simulation is a lap. `None` where no effect is the machine's, and where few carts are like the
    /// one with the sensors.
    pub(super) fn laps(&self, request: &Request) -> Option<Laps> {
        let settings = &self.settings.ensembles;
        let machine = request.effects.iter().filter(|e| !self.candidates[e.candidate].sensor);
        let effects: Vec<input::DeclaredEffect> = machine.map(|e| self.effect(e, request.run)).collect();
        if effects.is_empty() {
            return None;
        }
        let (run, frame) = (&self.runs[request.run], &self.frames[request.run]);
        let drawn = |draw: usize| self.like(request, with_draw(&effects, draw));
        let (model, mut ensemble) = drawn(1)?;
        let loaded = effects.iter().any(|e| e.name == LOAD.name());
        for draw in 2..=settings.loadings {
            if loaded && ensemble.carts.len() < settings.loaded_laps {
                ensemble.carts.append(&mut drawn(draw)?.1.carts);
            }
        }
        if ensemble.carts.len() < settings.least_laps {
            return None;
        }
        let repeatability = Repeatability::new(&model, &ensemble, run.seed);
        let (own, nominal) = (&repeatability.deviation, &run.landing.repeatability.deviation);
        let added = |(k, passes): (usize, &f64)| {
            let added = own[k] * own[k] - nominal[k] * nominal[k];
            if added > 0.0 { added / passes } else { 0.0 }
        };
        let added = run.landing.passes.iter().enumerate().map(added).chain(iter::repeat(0.0));
        let variance = frame.laps.variance.iter().zip(added).map(|(v, more)| v + more).collect();
        let every = repeatability.scatter.len().div_ceil(settings.most_laps);
        let some: Vec<Vec<f64>> = repeatability.scatter.into_iter().step_by(every).collect();
        let mut scatter = frame::scatter(run, &some);
        scatter.iter_mut().for_each(|lap| lap.resize(frame.labels.len(), 0.0));
        Some(Laps { variance, scatter })
    }

    /// Carts of a run's chain with effects that are like the one with the sensors.
    fn like(&self, request: &Request, effects: Vec<input::DeclaredEffect>) -> Option<(Model, Ensemble)> {
        let carts = self.runs[request.run].model.simulation.chain.carts as f64;
        let (model, _, mut ensemble) = self.run_ensemble(request.run, &request.step, effects, carts)?;
        let deviations = deviations_of(&model.simulation).ok()?.1;
        let observed = observed(&model.simulation, &deviations, ensemble.carts.len());
        let mut each = observed.iter();
        ensemble.carts.retain(|_| each.next().is_none_or(|observed| *observed));
        model.record(&mut ensemble.carts);
        Some((model, ensemble))
    }
}

/// The same effects with items on other carts.
fn with_draw(effects: &[input::DeclaredEffect], draw: usize) -> Vec<input::DeclaredEffect> {
    let mut effects = effects.to_vec();
    for load in effects.iter_mut().filter(|e| e.name == LOAD.name()) {
        load.strengths.insert(DRAW.name.to_owned(), draw as f64);
    }
    effects
}

/// How many carts have to pass a place, wherever it is, so that so many of those that are like the one with the sensors
/// do; a lap's at most.
pub(super) fn passing(like: &[bool], passes: f64) -> f64 {
    let carts = like.len();
    let each: Vec<usize> = (0..carts).filter(|k| like[*k]).collect();
    if each.len() == carts {
        return passes;
    }
    let n = (passes.ceil() as usize).max(1);
    // From behind one of them to the so manyth behind it.
    let stretch = |k: usize| each[(k + n) % each.len()] + carts * ((k + n) / each.len()) - each[k];
    let longest = (0..each.len()).map(stretch).max().unwrap_or(carts);
    longest.min(carts).max(passes as usize) as f64
}

/// Which carts are like the one with the sensors: all, or where some carry items or have wheels out of round those that
/// are as it is and have such carts beside them.
pub(super) fn observed(simulation: &Simulation, deviations: &Deviations, carts: usize) -> Vec<bool> {
    let loaded = |k: usize| deviations.load.get(k % carts).is_some_and(|x| *x != 0.0);
    let own = Loaded::in_input(simulation);
    let like = |k: usize| {
        let as_loaded =
            |own: Loaded| loaded(k) == own.own && loaded(k + carts - 1) == own.before && loaded(k + 1) == own.after;
        deviations.worn.iter().all(|worn| worn.carts.has(k)) && own.is_none_or(as_loaded)
    };
    let observed: Vec<bool> = (0..carts).map(like).collect();
    if observed.contains(&true) { observed } else { vec![true; carts] }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn enough_carts_pass_that_some_are_like_the_one_with_the_sensors() {
        assert_eq!(passing(&[true; 9], 2.5), 2.5);
        let each_third: Vec<bool> = (0..9).map(|k| k % 3 == 1).collect();
        assert_eq!((passing(&each_third, 1.0), passing(&each_third, 2.0), passing(&each_third, 7.0)), (3.0, 6.0, 9.0));
        let two: Vec<bool> = (0..9).map(|k| k < 2).collect();
        assert_eq!((passing(&two, 1.0), passing(&two, 2.0)), (8.0, 9.0));
    }
}
