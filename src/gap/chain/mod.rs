//! The chain of carts as a model of the diagnosis: runs fitted by identification, effects of the library at their
//! sites.

mod anew;
mod drift;
mod features;
mod fitted_with;
mod force_slope;
mod frame;
mod impacts;
mod laps;
mod noise;
mod nominal;
mod outline;
mod pass_times;
mod shapes;
mod together;
mod warming;

use super::ids::{CandidateId, PerRun, RunId};
use super::settings::{self, Settings};
use super::simulator::{Applied, Band, Candidate, Candidates, Frame, Laps, Outline, Request, Simulator, Strength};
use crate::base::parallel;
use crate::chain_input as input;
use crate::chain_input::Simulation;
use crate::dynamics::{Ensemble, Width};
use crate::effects::sites::Site;
use crate::effects::{
    AS_BUILT, Effect, LIBRARY, Sites, Start, StrengthSearch, deviations_of, named, stiffness_temperature,
};
use crate::identify::fit::Landing;
use crate::identify::model::{Coordinates, Plan};
use crate::identify::noise::{ChannelNoise, Noise, channel_noise};
use crate::identify::repeatability::RAN_BEFORE;
use crate::identify::study::Subject;
use crate::identify::{Counter, Effort, FitSettings, Model, Parameter};
use crate::model::effect_definitions::{PlaceKind, StrengthDefinition};
use crate::signal::{Channel, FORCES};
use crate::solve::Stop;
use force_slope::{Impact, Profile};
use impacts::{HighFrequencyPower, Suspect};
use laps::observed;
use noise::OfPasses;
use nominal::{Known, fitted, set_tops};
use pass_times::PassTimes;
use std::collections::BTreeMap;

/// How many runs are fitted at a time: more than threads, so that none is left to a single one in the end.
fn at_a_time(threads: usize) -> usize {
    if threads > 1 { 2 * threads } else { 1 }
}

/// How a campaign's runs are worked on.
#[derive(Clone, Copy)]
pub struct Work {
    /// Which noise simulations get.
    pub seed: u64,
    /// No answer depends on them.
    pub threads: usize,
    pub width: Width,
    /// When nothing more is simulated.
    pub stop: Stop,
}

/// A campaign's runs on chains.
pub struct Chains {
    runs: PerRun<FittedRun>,
    frames: PerRun<Frame>,
    candidates: Candidates,
    /// What runs were fitted with, where they were fitted with something.
    begin: Vec<Applied>,
    settings: settings::Chain,
    fit: FitSettings,
    of_passes: OfPasses,
    width: Width,
    threads: usize,
    /// Of what was simulated before the runs were fitted.
    counter: Counter,
}

/// A run, fitted.
struct FittedRun {
    model: Model,
    landing: Landing,
    laps: f64,
    /// When it passed each place.
    pass_times: PassTimes,
    /// What a channel that does not clip has as its largest force, N, if one that does ends where the measured does.
    tops: [f64; FORCES],
    /// High forces of each channel, measured and simulated, N.
    highs: [(f64, f64); FORCES],
    /// Of each channel.
    high_frequency_power: Vec<HighFrequencyPower>,
    /// What was measured in each part of the lap, of each channel.
    profiles: Vec<Profile>,
    /// Impacts on the rails.
    impacts: Vec<Impact>,
    settings: settings::Chain,
    /// Which channels were measured.
    measured: [bool; FORCES],
    /// How fast each channel's offset drifts, where places are passed again.
    drifts: [Option<drift::Rate>; FORCES],
    /// What turns at each order whose power is compared.
    orders: Vec<Band>,
    seed: u64,
}

/// How runs are fitted, and which effects are offered.
struct Fitting<'a> {
    fit: FitSettings,
    of_passes: OfPasses,
    /// Of each run's sensors, where it is known.
    correlated: Vec<[Noise; FORCES]>,
    settings: &'a settings::Chain,
    threads: usize,
    width: Width,
    /// Where the parameters of each run are known to be; none where they are to be found.
    known: Option<&'a [Known]>,
    offered: &'a dyn Fn(&Effect) -> bool,
    counter: Counter,
}

impl Chains {
    /// Fits the nominal model to each run. `tell` is told which are done.
    ///
    /// # Errors
    ///
    /// The run and why it cannot be used, or that the work was stopped.
    pub fn new(
        subjects: &[Subject],
        settings: &Settings,
        work: Work,
        tell: &(dyn Fn(&str) + Sync),
    ) -> Result<Chains, (String, String)> {
        let Work { seed, threads, width, stop } = work;
        let settings = &settings.chain;
        let steps = settings.ensembles.nominal_steps;
        let counter = Counter::default();
        let of_passes = OfPasses::new(subjects, threads, (width, stop), &counter);
        let fit = FitSettings { seed, steps, threads: 1, stop, ..FitSettings::default() };
        let correlated = of_passes.with_nominal(subjects, (&fit, width, threads), &counter);
        let (known, offered) = (None, &|_: &Effect| true);
        let fitting = Fitting { fit, of_passes, correlated, settings, threads, width, known, offered, counter };
        Chains::fitted(subjects, fitting, tell)
    }

    /// Fits runs, and offers effects at their sites.
    fn fitted(
        subjects: &[Subject],
        fitting: Fitting,
        tell: &(dyn Fn(&str) + Sync),
    ) -> Result<Chains, (String, String)> {
        let Fitting { fit, of_passes, correlated, settings, threads, width, known, offered, counter } = fitting;
        let known = |k: usize| known.and_then(|known| known.get(k));
        let numbered: Vec<(usize, &Subject)> = subjects.iter().enumerate().collect();
        let fitted = parallel::map(&numbered, at_a_time(threads), |&(k, subject)| {
            let fit = fit.knowing(correlated.get(k).copied());
            let found = fitted(subject, &fit, settings, width, known(k)).map_err(|why| (subject.name.clone(), why));
            tell(&subject.name);
            found
        });
        let mut runs = fitted.into_iter().collect::<Result<PerRun<FittedRun>, _>>()?;
        set_tops(&mut runs);
        let mut frames: PerRun<Frame> = subjects.iter().zip(&runs).map(|(s, run)| frame::frame(&s.name, run)).collect();
        let suspects = impacts::suspects(&frames, &runs);
        for (frame, run) in frames.iter_mut().zip(&mut runs) {
            run.impacts = Impact::all(&suspects, run);
            force_slope::extend(frame, run);
        }
        let (candidates, begin, settings) = (Candidates::default(), Vec::new(), settings.clone());
        let mut out = Chains { frames, runs, candidates, begin, settings, fit, of_passes, width, threads, counter };
        out.draw_as_built(threads);
        for effect in LIBRARY.into_iter().filter(|effect| offered(effect)) {
            for (site, known) in out.sites(effect, &suspects) {
                let around = (effect.alternatives)(&site, known);
                let first = out.offer(effect, site, None);
                for (site, further) in around {
                    let second = out.offer(effect, site, Some(first));
                    for site in further {
                        out.offer(effect, site, Some(second));
                    }
                }
            }
        }
        Ok(out)
    }

    /// How a run is fitted again.
    fn fit_of(&self, run: RunId) -> FitSettings {
        self.fit.knowing(Some(*self.runs[run].model.spec.noise()))
    }

    /// Draws chains as they are built.
    fn draw_as_built(&mut self, threads: usize) {
        let asked: Vec<(RunId, usize)> = self
            .runs
            .ids()
            .flat_map(|run| (0..self.settings.ensembles.as_built_draws).map(move |k| (run, k)))
            .collect();
        let answers = parallel::map(&asked, threads, |&(run, draw)| {
            let effect = |effect: &Effect| {
                let as_built = effect.strengths().map(|(s, fitted)| (s.name.to_owned(), fitted.as_built));
                let strengths = as_built.chain([("draw".to_owned(), draw as f64 + 1.0)]).collect();
                input::DeclaredEffect { name: effect.name().to_owned(), strengths }
            };
            self.simulated(run, &[], AS_BUILT.map(effect).to_vec(), false)
        });
        for ((run, _), features) in asked.into_iter().zip(answers) {
            let frame = &mut self.frames[run];
            let change = features.map(|f| f.iter().zip(&frame.nominal).map(|(f, n)| f - n).collect());
            frame.built.extend(change);
        }
    }

    /// Length over which means are taken, m.
    fn cell(&self) -> f64 {
        self.runs.first().map_or(1.0, |run| run.model.spec.places.lap / run.model.spec.places.cells as f64)
    }

    fn offer(&mut self, effect: &'static Effect, site: Site, alternative_to: Option<CandidateId>) -> CandidateId {
        let strength = |(s, fitted): (&StrengthDefinition, &StrengthSearch)| Strength {
            name: s.name.to_owned(),
            unit: s.unit.to_owned(),
            trial: fitted.trial,
            as_built: fitted.as_built,
            beside: fitted.beside,
            low: s.low,
            high: s.high,
            shares: if fitted.by_run { self.drift_shares(&site) } else { PerRun::default() },
        };
        let random_effect = effect.random_at(&site);
        let strengths = effect.strengths().filter(|(s, _)| (effect.has)(&site, s.name)).map(strength).collect();
        self.candidates.push(Candidate {
            effect: effect.name().to_owned(),
            place: site.words,
            fixed: site.fixed.iter().map(|(n, x)| ((*n).to_owned(), *x)).collect(),
            strengths,
            sensor: effect.is_sensor(),
            random_effect,
            discrepancy: effect.discrepancy,
            several: effect.several,
            alternative_to,
        })
    }

    /// Which share of a channel's drift each run has.
    fn drift_shares(&self, site: &Site) -> PerRun<f64> {
        let channel = site.of("channel").map_or(0, |channel| channel as usize);
        let rates = self.runs.map(|run| run.drifts.get(channel.wrapping_sub(1)).copied().flatten());
        drift::shares(&rates)
    }

    /// Where an effect may sit, and how well each place is known, m: on what was measured, and steps of the rail where
    /// the gap is largest.
    fn sites(&self, effect: &Effect, suspects: &[Suspect]) -> Vec<(Site, f64)> {
        let Some(first) = self.runs.first() else { return Vec::new() };
        let Sites::Listed(listed) = effect.sites else {
            let known = |suspect: &Suspect| if suspect.struck { self.settings.impacts.part } else { self.cell() };
            return suspects.iter().map(|suspect| (suspect.site(), known(suspect))).collect();
        };
        let places = effect.definition.places;
        let channel = |name: &str| places.iter().any(|p| p.name == name && p.kind == PlaceKind::ForceChannel);
        let measured = |site: &Site| {
            let known = |x: f64| self.runs.iter().all(|r| r.measured.get(x as usize - 1).copied().unwrap_or(false));
            site.fixed.iter().all(|(name, x)| !channel(name) || known(*x))
        };
        let known = listed(&first.model.simulation).into_iter().filter(measured);
        known.map(|site| (site, self.cell())).collect()
    }

    /// The effect of a candidate in a run, as a simulation input has it.
    fn effect(&self, applied: &Applied, run: RunId) -> input::DeclaredEffect {
        let candidate = &self.candidates[applied.candidate];
        let fitted = candidate.strengths.iter().zip(&applied.strengths);
        let fitted = fitted.map(|(s, x)| (s.name.clone(), s.in_run(*x, run)));
        input::DeclaredEffect {
            name: candidate.effect.clone(),
            strengths: fitted.chain(candidate.fixed.iter().cloned()).collect(),
        }
    }

    /// Features of a run with nuisances moved and effects added; `sensor` says whether one is a sensor's.
    fn simulated(
        &self,
        run: RunId,
        step: &[f64],
        effects: Vec<input::DeclaredEffect>,
        sensor: bool,
    ) -> Option<Vec<f64>> {
        if let Some(warming) = effects.iter().find_map(stiffness_temperature::warming) {
            let (cold, warm) = [0.0, 1.0].map(|share| stiffness_temperature::at_rest(&effects, |_| share)).into();
            let alone = step.is_empty() && effects.len() == 1;
            let frame = &self.frames[run];
            let cold = if alone { frame.nominal.clone() } else { self.simulated(run, step, cold, sensor)? };
            let warm = self.simulated(run, step, warm, sensor)?;
            return Some(self.runs[run].warming(frame, warming, &cold, &warm));
        }
        let settings = &self.settings.ensembles;
        let passes = if step.is_empty() { settings.signature_passes } else { settings.passes };
        let fitted = &self.runs[run];
        let chain = fitted.with(effects.clone()).simulation;
        let (deviations, carts) = (deviations_of(&chain).ok()?.1, chain.chain.carts);
        // Where few carts are like the one with the sensors, more have to pass.
        let like = observed(&chain, &deviations, carts);
        let all = laps::passing(&like, passes);
        let like = like.iter().filter(|like| **like).count() as f64 / carts as f64;
        let (model, at, ensemble) = self.run_ensemble(run, step, effects, all)?;
        let features = fitted.features(&model, &ensemble, &deviations, sensor, at);
        // Of what differs, chaos' share is taken out, block by block.
        Some(fitted.calmed(&self.frames[run], &features, all * like))
    }

    /// A run's chain with nuisances moved and effects added, as its carts pass each place so often.
    fn run_ensemble(
        &self,
        run: RunId,
        step: &[f64],
        effects: Vec<input::DeclaredEffect>,
        passes: f64,
    ) -> Option<(Model, Coordinates, Ensemble)> {
        let fitted = &self.runs[run];
        let mut at = fitted.landing.at;
        let settle = step.is_empty().then_some(self.settings.ensembles.signature_settle);
        let mut plan = Plan { passes, settle, from: Some(&fitted.landing.centre.ensemble.settled), ..Plan::default() };
        for (k, moved) in step.iter().enumerate() {
            match Parameter::ALL.get(k) {
                Some(p) => {
                    let (low, high) = fitted.model.range(*p);
                    at[p.index()] = (at[p.index()] + moved * p.reach()).clamp(low, high);
                }
                None => plan.approach_floor = moved * crate::identify::FLOOR_SCALE,
            }
        }
        let starts: Vec<Start> = effects.iter().filter_map(|e| Some((named(&e.name)?.start)(&e.strengths))).collect();
        for start in &starts {
            let Start::Unsettled(imitating) = start else { continue };
            (plan.from, plan.settle) = (None, Some(RAN_BEFORE));
            for p in imitating.iter().filter_map(|name| Parameter::from_name(name)) {
                let planned = fitted.model.coordinate(p, fitted.model.nominal[p.index()]);
                at[p.index()] += planned - fitted.landing.at[p.index()];
            }
        }
        let effects = stiffness_temperature::at_rest(&effects, |warming| warming.mean_share(fitted.duration()));
        let model = fitted.with(effects);
        let mut ensemble = model.run_ensemble(&at, &plan);
        // An impact may ask for shorter steps than the chain does.
        for _ in 0..self.settings.ensembles.halvings {
            if ensemble.is_none() {
                plan.step = Some(0.5 * plan.step.or_else(|| model.step(&at))?);
                ensemble = model.run_ensemble(&at, &plan);
            }
        }
        Some((model, at, ensemble?))
    }

    /// What the runs lack, and what it costs.
    pub fn lost(&self) -> Vec<String> {
        let mut lost = Vec::new();
        for (run, frame) in self.runs.iter().zip(&self.frames) {
            let missing: Vec<&str> =
                (0..FORCES).filter(|k| !run.measured[*k]).map(|k| Channel::FORCES[k].name()).collect();
            if !missing.is_empty() {
                lost.push(format!(
                    "{} lacks {}: effects that show only there cannot be seen",
                    frame.run,
                    missing.join(", ")
                ));
            }
            if run.laps < 0.98 {
                let share = crate::base::number::fixed(100.0 * run.laps, 0);
                lost.push(format!(
                    "{} covers {share} % of a lap: of the rest of the track nothing can be told",
                    frame.run
                ));
            }
            if run.landing.speed.is_none() {
                lost.push(format!("{} does not tell the chain's speed: drag and delay are hard to see", frame.run));
            }
        }
        if self.runs.len() < 2 {
            lost.push("one run only: nothing could be left out, so closures are not known".to_owned());
        }
        lost
    }

    /// The layout of a run with effects, for `--apply`.
    pub fn simulation(&self, run: RunId) -> &Simulation {
        &self.runs[run].model.simulation
    }
}

impl Simulator for Chains {
    fn candidates(&self) -> &Candidates {
        &self.candidates
    }

    fn frames(&self) -> &PerRun<Frame> {
        &self.frames
    }

    fn simulate(&self, run: RunId, step: &[f64], effects: &[Applied]) -> Option<Vec<f64>> {
        let sensor = effects.iter().any(|e| self.candidates[e.candidate].sensor);
        let machine = effects.iter().any(|e| !self.candidates[e.candidate].sensor);
        let effects = effects.iter().map(|e| self.effect(e, run)).collect();
        if !machine && step.iter().all(|x| *x == 0.0) {
            let fitted = &self.runs[run];
            return Some(fitted.sensed_features(&fitted.with(effects), &self.frames[run].nominal));
        }
        self.simulated(run, step, effects, sensor)
    }

    fn begin(&self) -> &[Applied] {
        &self.begin
    }

    fn threads(&self) -> usize {
        self.threads
    }

    fn effort(&self) -> Effort {
        self.runs.iter().map(|run| run.model.counter.effort()).fold(self.counter.effort(), Effort::plus)
    }

    fn outline(&self, applied: &Applied, at: Option<&[f64]>) -> Option<Outline> {
        self.outline_of(applied, at)
    }

    fn noise(&self) -> BTreeMap<String, BTreeMap<String, ChannelNoise>> {
        let of = |(frame, run): (&Frame, &FittedRun)| {
            (
                frame.run.clone(),
                channel_noise(run.model.spec.noise(), &run.model.spec.recorder.steps(), |k| run.measured[k]),
            )
        };
        self.frames.iter().zip(&self.runs).map(of).collect()
    }

    fn applies_sensor_models(&self) -> bool {
        true
    }

    fn laps_all(&self, requests: &[Request]) -> Vec<Option<Laps>> {
        parallel::map(requests, self.threads, |r| self.laps(r))
    }

    fn simulate_all(&self, requests: &[Request]) -> Vec<Option<Vec<f64>>> {
        parallel::map(requests, self.threads, |r| self.simulate(r.run, &r.step, &r.effects))
    }
}
