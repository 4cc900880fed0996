//! Any program as a model: it speaks JSON on its standard input and output, and the diagnosis treats it as it does the
//! chain.
//!
//! [`Outside::open`] starts the program, reads a campaign that declares its own channels, and fits the program's
//! nuisances to each run; a campaign of a single run is cut into parts first. Features are means over windows in time,
//! or samples where the channels swing, scored by a repeatability that is found in the measurements themselves:
//! [`Outside::anew`] finds it again by what the best hypothesis leaves. `docs/outside-models.md` is what those read who
//! write such programs.

mod anew;
mod check;
mod data;
mod early;
mod error;
mod fit;
mod grown;
mod model_error;
mod process;
mod protocol;
mod repeatability;
mod shared;
mod told;
mod windows;

pub use check::{Dry, check};
pub use error::Error;

use super::{Applied, Axis, CandidateId, Candidates, Frame, Laps, Lost, PerRun, Request, RunId, Simulator, settings};
use crate::base::parallel;
use crate::identify::{Counter, Effort};
use data::RunPart;
use fit::{Along, FittedPart, Fitter, Reference};
use nalgebra::DMatrix;
use process::{Blame, Pool, Program};
use protocol::{Description, EffectAsked, Question, RunAsked};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use windows::Windows;

/// Rows of samples, a row a channel, on a part's times.
type Rows = Vec<Vec<f64>>;

/// Features of all runs, or why there are none.
type Jointly = Arc<Result<Vec<Vec<f64>>, Error>>;

/// Whether a line answers `describe`; how many effects it has.
///
/// # Errors
///
/// What is wrong with it.
pub fn description(line: &str) -> Result<usize, Error> {
    protocol::description(line).map(|description| description.effects.len())
}

/// Whether a line answers `simulate` of these channels from one time to another, s. The channels at some times between
/// them.
///
/// # Errors
///
/// What is wrong with it.
pub fn series(line: &str, channels: &[String], from: f64, to: f64) -> Result<Vec<Vec<f64>>, Error> {
    Ok(protocol::series(line, channels, from, to)?.at(&[from, 0.5 * from + 0.5 * to, to]))
}

/// How a program is used.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Processes at once. The answer does not depend on it.
    pub threads: usize,
    /// A program that answers nothing for so long is stopped.
    pub timeout: Duration,
    /// Parts into which a campaign's only run is cut.
    pub parts: usize,
    /// Constants of the comparison.
    pub constants: super::Settings,
}

impl Default for Settings {
    fn default() -> Self {
        let mut constants = super::Settings::default();
        constants.refitting.rounds = constants.outside.fitting.rounds;
        constants.likelihood.unknown_most = constants.outside.comparison.unknown_most;
        Settings { threads: 2, timeout: Duration::from_secs(600), parts: 4, constants }
    }
}

/// A program that simulates the runs of a campaign.
pub struct Outside {
    pool: Arc<Pool>,
    description: Description,
    channels: BTreeMap<String, String>,
    names: Vec<String>,
    parts: PerRun<RunPart>,
    windows: PerRun<Windows>,
    /// Of each part the fitted nuisances, from 0 at their lower bounds to 1 at their upper ones.
    fitted: PerRun<Vec<f64>>,
    frames: PerRun<Frame>,
    /// Samples of the nominal model.
    rows: PerRun<Rows>,
    lost: Vec<String>,
    origin: String,
    failed: Mutex<Failed>,
    /// What the program was asked to simulate.
    counter: Counter,
    settings: settings::Outside,
    /// Share of the features of a run that an answer may leave out.
    may_lack: f64,
    /// What the accuracies that were given, or taken, are multiplied by.
    accuracy: f64,
    /// Of each part, samples of the best hypothesis, by which the noise was found again.
    references: Vec<Rows>,
    /// Nuisances that are not fitted to single runs, as all runs share them.
    held: Vec<bool>,
    /// By effects, features of all runs with shared nuisances fitted.
    joint: Mutex<BTreeMap<String, Jointly>>,
    /// Of each run, slopes of the nominal model's weighted features, where nuisances are shared.
    slopes: Mutex<Option<Vec<DMatrix<f64>>>>,
    /// What its answers showed at the start, in sentences.
    remarks: Vec<String>,
    /// Whether it answers differently when asked again, by less than the measurements' noise.
    random: bool,
}

/// What the program did not answer.
#[derive(Default)]
struct Failed {
    /// By request.
    reasons: BTreeMap<String, Error>,
    /// Effects with which it was silent: each time costs as long as it is waited for, so these are not asked together
    /// again.
    silent: BTreeMap<Vec<CandidateId>, Error>,
}

impl Outside {
    /// Starts the command, which is split into words as by a shell, and fits it to the campaign.
    ///
    /// # Errors
    ///
    /// [`Error`]: the command does not start, does not keep to the protocol or refuses a run at nominal values; the
    /// campaign or one of its runs cannot be read or is too short.
    pub fn open(command: &str, campaign: &Path, settings: &Settings) -> Result<Outside, Error> {
        let (mut outside, parts) = Outside::begun(command, campaign, settings)?;
        let start = outside.nominal_start();
        let mut all = Vec::with_capacity(parts.len());
        for part in parts {
            let told = |error: Error| error.in_run(&part.name);
            let rows = outside.ask(&part, &start, &[]).map_err(told)?;
            outside.is_the_same(&part, &start, &rows).map_err(told)?;
            if all.is_empty() {
                outside.ignored(&part, &start, &rows);
            }
            let fitted = outside.fit(&part, &[], None, None).map_err(told)?;
            all.push((part, fitted));
        }
        let starts = outside.starts(all.iter().map(|(_, fitted)| &fitted.at));
        for (part, fitted) in all {
            let fitted = outside.restarted(&part, &[], fitted, &starts);
            let fitted = outside.grown(&part, &[], fitted);
            outside.keep(part, fitted);
        }
        if outside.has_shared() { outside.with_shared() } else { Ok(outside) }
    }

    /// The program started and described, and the runs read.
    fn begun(command: &str, campaign: &Path, settings: &Settings) -> Result<(Outside, Vec<RunPart>), Error> {
        let constants = &settings.constants;
        let program = Program::new(command)?;
        // Before it starts: what is changed later is taken for another program.
        let origin = program.origin();
        let pool = Arc::new(Pool::new(program, settings.threads, settings.timeout, &constants.outside.processes));
        let (channels, parts) = data::read(campaign, settings.parts)?;
        let describe = || pool.ask(&Question::Describe.line(), Blame::Program, protocol::description);
        let description = describe()?;
        let names: Vec<String> = channels.keys().cloned().collect();
        let stranger = description.accuracy.keys().find(|c| !channels.contains_key(*c));
        if let Some(channel) = stranger {
            let why = format!("accuracy is given of `{channel}`, which the campaign does not declare");
            return Err(Error::Answer { request: "describe", line: String::new(), why });
        }
        let origin = format!("{origin} {description:?} {channels:?}");
        // Each run by itself at first.
        let held = vec![false; description.nuisances.len()];
        let outside = Outside {
            pool,
            description,
            channels,
            names,
            windows: PerRun::default(),
            fitted: PerRun::default(),
            frames: PerRun::default(),
            rows: PerRun::default(),
            lost: Vec::new(),
            origin,
            counter: Counter::default(),
            failed: Mutex::default(),
            settings: constants.outside.clone(),
            held,
            joint: Mutex::default(),
            slopes: Mutex::default(),
            accuracy: 1.0,
            references: Vec::new(),
            remarks: Vec::new(),
            random: false,
            may_lack: constants.checks.may_lack,
            parts: PerRun::default(),
        };
        let needed = constants.outside.windows.samples * constants.outside.windows.needed;
        if let Some(short) = parts.iter().find(|part| part.time.len() < needed) {
            return Err(Error::Short { run: short.name.clone(), samples: short.time.len(), needed });
        }
        Ok((outside, parts))
    }

    /// Units of the channels that are compared.
    pub fn channels(&self) -> &BTreeMap<String, String> {
        &self.channels
    }

    /// All that the answers come from: the program's files, the campaign and the runs with their inputs, and the
    /// nuisances as fitted.
    pub fn origin(&self) -> String {
        let mut origin = format!("{} {}", crate::base::program(), self.origin);
        for (part, at) in self.parts.iter().zip(&self.fitted) {
            origin.push_str(&format!(" {} {} {:?} {:?} {at:?}", part.name, part.content, part.settings, part.ends()));
        }
        origin
    }

    /// What the data lacked, in sentences.
    pub fn lost(&self) -> Vec<Lost> {
        self.lost.iter().map(Lost::data).collect()
    }

    /// The nuisances as fitted to a run, by name.
    pub fn nuisances(&self, run: RunId) -> BTreeMap<String, f64> {
        let at = self.fitted.at(run).map_or(&[][..], Vec::as_slice);
        let each = self.description.nuisances.iter().zip(at);
        each.map(|(n, &share)| (n.name.clone(), fit::value(n, share))).collect()
    }

    fn failed(&self) -> MutexGuard<'_, Failed> {
        self.failed.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Fits the nuisances to a part, with effects added, from where the search begins; scored by the noise of the best
    /// hypothesis where that is known.
    fn fit(
        &self,
        part: &RunPart,
        effects: &[Applied],
        begin: Option<&[f64]>,
        reference: Option<&Reference>,
    ) -> Result<FittedPart, Error> {
        let simulate = |points: &[Vec<f64>]| parallel::map(points, self.pool.most(), |at| self.ask(part, at, effects));
        let accuracy: Vec<f64> =
            self.names.iter().map(|c| self.description.accuracy.get(c).copied().unwrap_or(0.0)).collect();
        let fitter = Fitter {
            part,
            nuisances: &self.description.nuisances,
            accuracy: &accuracy,
            simulate: &simulate,
            settings: &self.settings,
            random: self.random,
            accuracy_factor: self.accuracy,
            held: &self.held,
            begin,
            reference,
        };
        fitter.fit(&|at| {
            self.pool.renew();
            self.ask(part, at, effects)
        })
    }

    /// The same fit, or one from the best of other starts, if much is left and that leaves less.
    fn restarted(&self, part: &RunPart, effects: &[Applied], fitted: FittedPart, starts: &[Vec<f64>]) -> FittedPart {
        let settings = &self.settings.fitting;
        if fitted.mean_square() < settings.restart {
            return fitted;
        }
        let far = |start: &&Vec<f64>| fit::is_far(&fitted.at, start, settings.other_start);
        let error = |start: &Vec<f64>| Some((fit::error(part, &self.ask(part, start, effects).ok()?), start.clone()));
        let other = starts.iter().filter(far).filter_map(error).min_by(|a, b| a.0.total_cmp(&b.0));
        let other = other.and_then(|(_, start)| self.fit(part, effects, Some(&start), None).ok());
        fitted.or(other, part)
    }

    /// Where a fit may begin again: at the nominal values, and where other runs are; of those that are near to each
    /// other the first.
    fn starts<'a>(&self, fitted: impl Iterator<Item = &'a Vec<f64>>) -> Vec<Vec<f64>> {
        let settings = &self.settings.fitting;
        let mut starts = vec![self.nominal_start()];
        for at in fitted {
            if starts.len() < settings.starts && starts.iter().all(|s| fit::is_far(s, at, settings.other_start)) {
                starts.push(at.clone());
            }
        }
        starts
    }

    /// A fitted part becomes a run of the diagnosis.
    fn keep(&mut self, part: RunPart, fitted: FittedPart) {
        let nuisances = &self.description.nuisances;
        let FittedPart { at, windows, measured, nominal, repeatability, slopes, rows } = fitted;
        let lost = measured.iter().filter(|x| !x.is_finite()).count();
        if lost > 0 {
            let all = measured.len();
            self.lost.push(format!(
                "{}: {lost} of {all} {} were not measured, or too few samples of them",
                part.name,
                windows.kind.words()
            ));
        }
        let missing = measured.iter().zip(&nominal).filter(|(m, s)| m.is_finite() && !s.is_finite()).count();
        if missing > 0 {
            self.lost.push(format!("{}: of {missing} {} the model says nothing", part.name, windows.kind.words()));
        }
        let deviation = self.settings.fitting.prior;
        let free = self.free();
        let prior =
            free.iter().map(|k| (fit::share(&nuisances[*k], nuisances[*k].nominal) - at[*k], deviation)).collect();
        self.frames.push(Frame {
            run: part.name.clone(),
            labels: windows.labels(self.names.iter()),
            measured,
            nominal,
            laps: Laps {
                variance: repeatability.variance.iter().map(|v| if *v > 0.0 { *v } else { f64::INFINITY }).collect(),
                scatter: repeatability.scatter,
            },
            discrepancies: repeatability.discrepancies,
            built: Vec::new(),
            slopes: slopes.select_columns(&free),
            prior,
            // A nuisance stands between 0 and 1.
            bounds: free.iter().map(|k| (-at[*k], 1.0 - at[*k])).collect(),
            nuisances: free.iter().map(|k| nuisances[*k].name.clone()).collect(),
        });
        self.windows.push(windows);
        self.rows.push(rows);
        self.fitted.push(at);
        self.parts.push(part);
    }

    /// Simulates a part, with strengths that keep to their bounds: rows of samples on its own times, a row a channel.
    fn ask(&self, part: &RunPart, at: &[f64], effects: &[Applied]) -> Result<Rows, Error> {
        let named = self.description.nuisances.iter().zip(at);
        let effect = |applied: &Applied| {
            let candidate = self.description.effects.at(applied.candidate)?;
            let strengths = candidate.strengths.iter().zip(candidate.bounded(&applied.strengths));
            Some(EffectAsked {
                name: &candidate.effect,
                place: &candidate.place,
                strengths: strengths.map(|(s, x)| (s.name.as_str(), x)).collect(),
            })
        };
        let (from, to) = part.ends();
        let question = Question::Simulate {
            run: RunAsked { name: &part.run, file: &part.file, from, to, settings: &part.settings },
            nuisances: named.map(|(n, share)| (n.name.as_str(), fit::value(n, *share))).collect(),
            effects: effects.iter().filter_map(effect).collect(),
        };
        self.counter.add(to - from);
        let blame = if effects.is_empty() { Blame::Program } else { Blame::Effects };
        let series = self.pool.ask(&question.line(), blame, |line| protocol::series(line, &self.names, from, to))?;
        Ok(series.at(&part.time))
    }
}

impl Simulator for Outside {
    fn candidates(&self) -> &Candidates {
        &self.description.effects
    }

    fn frames(&self) -> &PerRun<Frame> {
        &self.frames
    }

    fn axis(&self) -> Axis {
        Axis::Time
    }

    fn effort(&self) -> Effort {
        self.counter.effort()
    }

    fn reason(&self, request: &Request) -> Option<String> {
        self.failed().reasons.get(&key(request)).map(Error::to_string)
    }

    fn simulate_all(&self, requests: &[Request]) -> Vec<Option<Vec<f64>>> {
        // Known before all requests of a batch, so that answers do not depend on which is asked first.
        let silent = self.failed().silent.clone();
        if self.has_shared() {
            // Each hypothesis once for all its runs, which are simulated at once.
            let fitted = requests.iter().filter(|r| !r.effects.is_empty());
            fitted.for_each(|r| drop(self.answer(r, &silent)));
        }
        let answers = parallel::map(requests, self.pool.most(), |r| self.answer(r, &silent));
        let cause = answers.iter().flatten().find_map(|answer| answer.as_ref().err());
        if let (Some(error), false) = (cause, answers.iter().flatten().any(Result::is_ok)) {
            self.still_alive(error);
        }
        let kept = requests.iter().zip(answers).map(|(request, answer)| match answer? {
            Ok(features) => Some(features),
            Err(error) => {
                self.failed().keep(request, error);
                None
            }
        });
        kept.collect()
    }
}

impl Outside {
    /// Features of a request; `None` where it makes no sense.
    fn answer(&self, request: &Request, silent: &BTreeMap<Vec<CandidateId>, Error>) -> Option<Result<Vec<f64>, Error>> {
        let Request { run, step, effects } = request;
        let fitted = self.fitted.at(*run)?;
        let mut at = fitted.clone();
        self.free().into_iter().zip(step).for_each(|(k, by)| at[k] += by);
        let known = |a: &Applied| self.description.effects.at(a.candidate).is_some();
        let numbers = effects.iter().all(|a| known(a) && a.strengths.iter().all(|x| x.is_finite()));
        if !numbers || at.iter().any(|x| x.is_nan()) {
            return None;
        }
        let own = members(request);
        if let Some((_, error)) = silent.iter().find(|(effects, _)| effects.iter().all(|e| own.contains(e))) {
            return Some(Err(error.clone()));
        }
        let frame = &self.frames[*run];
        let simulate = |at: &[f64]| self.features_at(*run, at, effects);
        // Steps come with hypotheses that are fitted; what is screened stays where the nominal model is.
        let fitted_along = !step.is_empty() && !effects.is_empty();
        if !effects.is_empty() && self.has_shared() {
            // Screened, too: no run alone can say what the others leave of a shared nuisance.
            return Some(self.jointly(*run, effects));
        }
        let starts = if fitted_along { self.starts(self.fitted.iter()) } else { Vec::new() };
        let along = Along { frame, settings: &self.settings.fitting, simulate: &simulate, starts: &starts };
        Some(if fitted_along { along.fit(&at) } else { simulate(&at) })
    }

    /// Asks for a run as it was fitted when all requests failed with effects: a program that has ended for good fails
    /// without them, too, and is not asked any more.
    fn still_alive(&self, cause: &Error) {
        if matches!(cause, Error::Refused(_) | Error::NotFinite { .. }) {
            return;
        }
        if let (Some(part), Some(at)) = (self.parts.first(), self.fitted.first())
            && let Err(error) = self.ask(part, at, &[])
        {
            self.pool.give_up(error);
        }
    }
}

impl Failed {
    fn keep(&mut self, request: &Request, error: Error) {
        if let Error::Silent { .. } = error {
            self.silent.entry(members(request)).or_insert_with(|| error.clone());
        }
        self.reasons.insert(key(request), error);
    }
}

fn members(request: &Request) -> Vec<CandidateId> {
    request.effects.iter().map(|e| e.candidate).collect()
}

fn key(request: &Request) -> String {
    format!("{request:?}")
}
