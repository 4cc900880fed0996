//! Any program as a model: it speaks JSON on its standard input and output, and the diagnosis treats it as it does the
//! chain.
//!
//! [`Outside::open`] starts the program, reads a campaign that declares its own channels, and fits the program's
//! nuisances to each run; a campaign of a single run is cut into parts first. Features are means over windows in time,
//! scored by a repeatability that is found in the measurements themselves. `docs/outside-models.md` is what those read
//! who write such programs.

mod data;
mod error;
mod fit;
mod process;
mod protocol;
mod repeatability;
mod windows;

pub use error::Error;

use super::{Applied, Axis, CandidateId, Candidates, Frame, Laps, Lost, PerRun, Request, RunId, Simulator, settings};
use crate::base::parallel;
use crate::identify::{Counter, Effort};
use data::RunPart;
use fit::{FittedPart, Fitter, Rows};
use process::{Blame, Pool, Program};
use protocol::{Description, EffectAsked, Question, RunAsked};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use windows::Windows;

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
        Settings { threads: 2, timeout: Duration::from_secs(600), parts: 4, constants: super::Settings::default() }
    }
}

/// A program that simulates the runs of a campaign.
pub struct Outside {
    pool: Pool,
    description: Description,
    channels: BTreeMap<String, String>,
    names: Vec<String>,
    parts: PerRun<RunPart>,
    windows: PerRun<Windows>,
    /// Of each part the fitted nuisances, from 0 at their lower bounds to 1 at their upper ones.
    fitted: PerRun<Vec<f64>>,
    frames: PerRun<Frame>,
    lost: Vec<String>,
    origin: String,
    failed: Mutex<Failed>,
    /// What the program was asked to simulate.
    counter: Counter,
    settings: settings::Outside,
    /// Share of the features of a run that an answer may leave out.
    may_lack: f64,
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
        let constants = &settings.constants;
        let program = Program::new(command)?;
        // Before it starts: what is changed later is taken for another program.
        let origin = program.origin();
        let pool = Pool::new(program, settings.threads, settings.timeout, &constants.outside.processes);
        let (channels, parts) = data::read(campaign, settings.parts)?;
        let description = pool.ask(&Question::Describe.line(), Blame::Program, protocol::description)?;
        let names: Vec<String> = channels.keys().cloned().collect();
        let stranger = description.accuracy.keys().find(|c| !channels.contains_key(*c));
        if let Some(channel) = stranger {
            let why = format!("accuracy is given of `{channel}`, which the campaign does not declare");
            return Err(Error::Answer { request: "describe", line: String::new(), why });
        }
        let origin = format!("{origin} {description:?} {channels:?}");
        let mut outside = Outside {
            pool,
            description,
            channels,
            names,
            windows: PerRun::default(),
            fitted: PerRun::default(),
            frames: PerRun::default(),
            lost: Vec::new(),
            origin,
            counter: Counter::default(),
            failed: Mutex::default(),
            settings: constants.outside.clone(),
            may_lack: constants.checks.may_lack,
            parts: PerRun::default(),
        };
        for part in parts {
            let needed = constants.outside.windows.samples * constants.outside.windows.needed;
            if part.time.len() < needed {
                let (run, samples) = (part.name.clone(), part.time.len());
                return Err(Error::Short { run, samples, needed });
            }
            let fitted = outside.fit(&part).map_err(|error| error.in_run(&part.name))?;
            outside.keep(part, fitted);
        }
        Ok(outside)
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

    fn fit(&self, part: &RunPart) -> Result<FittedPart, Error> {
        let simulate = |points: &[Vec<f64>]| parallel::map(points, self.pool.most(), |at| self.ask(part, at, &[]));
        let accuracy: Vec<f64> =
            self.names.iter().map(|c| self.description.accuracy.get(c).copied().unwrap_or(0.0)).collect();
        let fitter = Fitter {
            part,
            nuisances: &self.description.nuisances,
            accuracy: &accuracy,
            simulate: &simulate,
            settings: &self.settings,
        };
        fitter.fit(&|at| {
            self.pool.renew();
            self.ask(part, at, &[])
        })
    }

    /// A fitted part becomes a run of the diagnosis.
    fn keep(&mut self, part: RunPart, fitted: FittedPart) {
        let nuisances = &self.description.nuisances;
        let FittedPart { at, windows, measured, nominal, repeatability, slopes } = fitted;
        let lost = measured.iter().filter(|x| !x.is_finite()).count();
        if lost > 0 {
            let all = measured.len();
            self.lost.push(format!("{}: {lost} of {all} windows have too few samples to be compared", part.name));
        }
        let missing = measured.iter().zip(&nominal).filter(|(m, s)| m.is_finite() && !s.is_finite()).count();
        if missing > 0 {
            self.lost.push(format!("{}: of {missing} windows the model says nothing", part.name));
        }
        let deviation = self.settings.fitting.prior;
        let prior = nuisances.iter().zip(&at).map(|(n, at)| (fit::share(n, n.nominal) - at, deviation)).collect();
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
            slopes,
            prior,
            // A nuisance stands between 0 and 1.
            bounds: at.iter().map(|at| (-at, 1.0 - at)).collect(),
            nuisances: nuisances.iter().map(|n| n.name.clone()).collect(),
        });
        self.windows.push(windows);
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
        let (part, windows, fitted) = (self.parts.at(*run)?, self.windows.at(*run)?, self.fitted.at(*run)?);
        let at: Vec<f64> = fitted.iter().enumerate().map(|(k, x)| x + step.get(k).copied().unwrap_or(0.0)).collect();
        let known = |a: &Applied| self.description.effects.at(a.candidate).is_some();
        let numbers = effects.iter().all(|a| known(a) && a.strengths.iter().all(|x| x.is_finite()));
        if !numbers || at.iter().any(|x| x.is_nan()) {
            return None;
        }
        let own = members(request);
        if let Some((_, error)) = silent.iter().find(|(effects, _)| effects.iter().all(|e| own.contains(e))) {
            return Some(Err(error.clone()));
        }
        let finite = |rows: Rows| {
            let features = windows.means(&rows);
            let frame = &self.frames[*run];
            match frame.lacking(&features, self.may_lack) {
                0 => Ok(features),
                lacking => Err(Error::NotFinite { lacking, of: frame.labels.len() }),
            }
        };
        Some(self.ask(part, &at, effects).and_then(finite))
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
