//! Tasks, done here.

use super::FORMAT;
use super::content::hash;
use super::place::{Claim, Failed, Place, Values};
use super::plan::{Plan, Step, Task};
use super::process::{Call, Ended, Start};
use super::values::values;
use super::verb::Verb;
use crate::base::{parallel, program};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Mutex;
use std::time::{Duration, Instant, SystemTime};

/// What became of a task.
#[derive(Clone, Debug, PartialEq)]
pub enum Did {
    Done,
    /// It was done before.
    Known,
    /// In a line, why.
    Failed(String),
    /// It had failed before, and was not tried again.
    FailedBefore(String),
    /// Somebody else is at it.
    Claimed,
    /// It was not done, for a reason that is none of its own: a file that it works on has changed, the disk is full,
    /// or it was stopped.
    Open(String),
}

/// How tasks are done.
pub struct Runner<'a> {
    pub plan: &'a Plan,
    pub place: &'a Place,
    /// Threads of each task.
    pub threads: usize,
    /// Whether tasks that failed are tried again.
    pub retry_failed: bool,
    /// What is told to every process, such as `--root=DIR`.
    pub always: Vec<String>,
    pub start: Start<'a>,
    /// Hashes of files that were looked at, as long as the files seem the same.
    pub looked_at: LookedAt,
}

/// By file: when it was changed last, its size, and its SHA-256.
#[derive(Debug, Default)]
pub struct LookedAt(Mutex<BTreeMap<PathBuf, (SystemTime, u64, String)>>);

/// Signals that ask a process to end: SIGHUP, SIGINT, SIGTERM. Who asks asks this process, too, but perhaps later.
const ASKED_TO_END: [i32; 3] = [1, 2, 15];

/// SIGKILL: the system's answer to a process that takes too much memory, and what a node is cleared with.
const KILLED: i32 = 9;

/// As long after a process was killed it is not yet sure that it alone was meant.
const GRACE: Duration = Duration::from_secs(2);

impl Runner<'_> {
    /// Does all that is open, so many at a time, and waits for what others are at. `told` hears of each task that is
    /// settled.
    pub fn all(&self, jobs: usize, told: &(dyn Fn(&Task, &Did) + Sync)) -> BTreeMap<String, Did> {
        let tasks = self.plan.unique();
        let work = |wait: bool| {
            move |task: &&Task| {
                let did = self.task(task, wait);
                if did != Did::Claimed {
                    told(task, &did);
                }
                did
            }
        };
        let mut all: BTreeMap<String, Did> = BTreeMap::new();
        let first = parallel::map(&tasks, jobs, work(false));
        let left: Vec<&Task> =
            tasks.iter().zip(&first).filter(|(_, did)| **did == Did::Claimed).map(|(task, _)| *task).collect();
        all.extend(tasks.iter().zip(first).map(|(task, did)| (task.hash.clone(), did)));
        let rest = parallel::map(&left, jobs, work(true));
        all.extend(left.iter().zip(rest).map(|(task, did)| (task.hash.clone(), did)));
        all
    }

    /// Does a task, unless it is done. `wait`: where somebody else is at it, until nobody is.
    pub fn task(&self, task: &Task, wait: bool) -> Did {
        if let Some(known) = self.known(task) {
            return known;
        }
        let claim = match self.place.claim(&task.hash, wait) {
            Ok(Some(claim)) => claim,
            Ok(None) => return Did::Claimed,
            Err(why) => return Did::Open(format!("{}: {why}", self.place.task(&task.hash).display())),
        };
        // Somebody may have done it meanwhile.
        if let Some(known) = self.known(task) {
            return known;
        }
        self.claimed(task, &claim).unwrap_or_else(Did::Open)
    }

    /// What is there already.
    fn known(&self, task: &Task) -> Option<Did> {
        if self.place.found(&task.hash).is_some() {
            // Who found it may have been stopped before.
            self.clear(task);
            return Some(Did::Known);
        }
        let failed = self.place.failed(&task.hash).filter(|_| !self.retry_failed)?;
        Some(Did::FailedBefore(failed.line()))
    }

    fn clear(&self, task: &Task) {
        if !task.keep {
            self.place.clear(&task.hash, task.steps.iter().map(|step| step.verb.name()));
        }
    }

    fn claimed(&self, task: &Task, claim: &Claim) -> Result<Did, String> {
        self.unchanged(task)?;
        let clock = Instant::now();
        let mut all = Values::new();
        for (k, step) in task.steps.iter().enumerate() {
            let name = step.verb.name();
            let last = k + 1 == task.steps.len();
            let kept = self.place.step(&task.hash, name);
            let found = match kept {
                Some(kept) => Ok(kept),
                None => self.step(task, step, last, claim)?,
            };
            match found {
                Ok(values) => {
                    if !last {
                        self.place.keep_step(&task.hash, name, &values).map_err(|why| why.to_string())?;
                    }
                    all.extend(values);
                }
                Err(failed) => {
                    self.unchanged(task)?;
                    self.place.keep_failed(&failed).map_err(|why| why.to_string())?;
                    return Ok(Did::Failed(failed.line()));
                }
            }
        }
        // What was changed while it was read was perhaps read in halves.
        self.unchanged(task)?;
        self.place.keep(&task.hash, &all, clock.elapsed().as_secs_f64()).map_err(|why| why.to_string())?;
        self.clear(task);
        Ok(Did::Done)
    }

    /// That the files are those that were planned with.
    fn unchanged(&self, task: &Task) -> Result<(), String> {
        for digest in &task.contents {
            let files = self.plan.contents.get(digest).map(|content| content.files.as_slice()).unwrap_or_default();
            for (path, known) in files {
                if self.looked_at.hash(path)? != *known {
                    return Err(format!(
                        "{} has changed since the study was planned: plan it again",
                        crate::source::shown(path)
                    ));
                }
            }
        }
        Ok(())
    }

    /// What a step found, or how it failed.
    ///
    /// # Errors
    ///
    /// Why it is neither.
    fn step(&self, task: &Task, step: &Step, last: bool, claim: &Claim) -> Result<Result<Values, Failed>, String> {
        let folder = self.place.task(&task.hash);
        let out = folder.join(step.verb.name());
        let mut said = String::new();
        let mut printed = String::new();
        for arguments in self.commands(task, step) {
            let call = Call { arguments: &arguments, folder: &self.plan.folder, held: claim.shared() };
            let ended = (self.start)(call).map_err(|why| format!("a process could not be started: {why}"))?;
            said.push_str(&ended.said);
            printed = ended.out.clone();
            // No layout meets the constraints: an answer, where nobody asks for more.
            let answer = serde_json::from_str::<serde_json::Value>(&ended.out).unwrap_or_default();
            let infeasible = step.verb == Verb::Build && last && answer["feasible"] == false;
            if ended.code == Some(0) || (infeasible && ended.code == Some(1)) {
                continue;
            }
            return self.ended(task, step, arguments, &ended, &said).map(Err);
        }
        match values(step.verb, &printed, &out) {
            Ok(values) => Ok(Ok(values)),
            Err(why) => {
                let commands = self.commands(task, step).pop().unwrap_or_default();
                let ended = format!("ended with a result that cannot be read: {why}");
                Ok(Err(self.failure(task, step, commands, ended, &said)))
            }
        }
    }

    fn ended(
        &self,
        task: &Task,
        step: &Step,
        command: Vec<String>,
        ended: &Ended,
        said: &str,
    ) -> Result<Failed, String> {
        let how = match (ended.code, ended.signal) {
            (Some(code), _) => format!("exit code {code}"),
            (None, Some(signal)) if ASKED_TO_END.contains(&signal) => {
                return Err(format!("stopped by signal {signal}"));
            }
            (None, Some(KILLED)) => {
                std::thread::sleep(GRACE);
                "killed by signal 9: was there too little memory?".to_owned()
            }
            (None, signal) => format!("ended by signal {}", signal.unwrap_or_default()),
        };
        Ok(self.failure(task, step, command, how, said))
    }

    fn failure(&self, task: &Task, step: &Step, command: Vec<String>, ended: String, said: &str) -> Failed {
        /// Lines that are kept, the last ones.
        const LINES: usize = 200;
        let lines: Vec<&str> = said.lines().collect();
        let from = lines.len().saturating_sub(LINES);
        Failed {
            format: FORMAT,
            hash: task.hash.clone(),
            program: program().to_owned(),
            step: step.verb.name().to_owned(),
            command: std::iter::once("lss".to_owned()).chain(command).collect(),
            ended,
            said: lines[from..].iter().map(|line| (*line).to_owned()).collect(),
        }
    }

    /// What is started for a step, one after another: words behind the program's name.
    pub fn commands(&self, task: &Task, step: &Step) -> Vec<Vec<String>> {
        let out = self.place.task(&task.hash).join(step.verb.name()).to_string_lossy().into_owned();
        let on = match (&step.made, &step.file) {
            (Some(made), _) => Some(self.place.task(&task.hash).join(made).to_string_lossy().into_owned()),
            (None, file) => file.clone(),
        };
        let words = step.verb.words().iter().map(|word| (*word).to_owned());
        let mut words: Vec<String> = words.chain([format!("--threads={}", self.threads)]).collect();
        words.extend(self.always.iter().cloned());
        words.extend(step.options.iter().cloned());
        words.push(format!("--output={out}"));
        if step.verb != Verb::Challenge {
            words.push("--format=json".to_owned());
            words.extend(on.into_iter().flat_map(|on| ["--".to_owned(), on]));
            return vec![words];
        }
        words.extend(on.map(|on| format!("--layout={on}")));
        let score = ["gap", "challenge", "score", "--format=json", "--", out.as_str()].map(str::to_owned).to_vec();
        // One that is made is not made again; it may have been answered in part.
        match self.place.task(&task.hash).join("challenge").join("challenge.json").exists() {
            true => vec![score],
            false => vec![words, score],
        }
    }
}

impl LookedAt {
    fn hash(&self, path: &PathBuf) -> Result<String, String> {
        let told = |why: std::io::Error| format!("{}: {why}", crate::source::shown(path));
        let about = std::fs::metadata(path).map_err(told)?;
        let (when, size) = (about.modified().map_err(told)?, about.len());
        if let Ok(known) = self.0.lock()
            && let Some((at, bytes, hash)) = known.get(path)
            && (*at, *bytes) == (when, size)
        {
            return Ok(hash.clone());
        }
        let hash = hash(path)?;
        if let Ok(mut known) = self.0.lock() {
            known.insert(path.clone(), (when, size, hash.clone()));
        }
        Ok(hash)
    }
}
