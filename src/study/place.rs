//! The folder of a study's results.
//!
//! ```text
//! OUT/plan.jsonl                 what there is to do
//! OUT/tasks/HASH/result.json     what a task found: last, and whole
//! OUT/tasks/HASH/failed.json     why it found nothing
//! OUT/tasks/HASH/time.json       how long it took
//! OUT/tasks/HASH/STEP/           outputs of a step
//! OUT/tasks/HASH/STEP.json       what a step found, while later ones are to be done
//! OUT/tasks/HASH/.claim          locked as long as somebody is at it
//! ```
//!
//! A claim is a lock and no note: the system takes it back when the process ends, however it ends. It is handed to the
//! processes that a task starts, so that a task is claimed as long as one of them lives. On a file system without
//! locks nothing is claimed; a task that is done twice then is done to the same result.

use super::FORMAT;
use super::plan::Plan;
use crate::base::json::to_json;
use crate::base::program;
use crate::source::disk::{Files, WriteError, replace};
use crate::source::input::{self, JSON_LIMIT};
use crate::source::{root, shown};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

/// What is known of a task.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum State {
    Open,
    /// Somebody is at it.
    Claimed,
    Failed,
    Done,
}

impl State {
    pub fn name(self) -> &'static str {
        match self {
            State::Open => "open",
            State::Claimed => "running",
            State::Failed => "failed",
            State::Done => "done",
        }
    }
}

/// Numbers, truths and texts that a task found, by name.
pub type Values = BTreeMap<String, Value>;

/// `result.json`, and `STEP.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Found {
    pub format: u32,
    pub hash: String,
    /// SHA-256 of the program that found it.
    pub program: String,
    pub values: Values,
}

/// `failed.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Failed {
    pub format: u32,
    pub hash: String,
    pub program: String,
    pub step: String,
    /// What was started.
    pub command: Vec<String>,
    /// How it ended: `exit code 1`.
    pub ended: String,
    /// What it said.
    pub said: Vec<String>,
}

impl Failed {
    /// What it is about, in a line.
    pub fn line(&self) -> String {
        let about = |line: &&String| line.starts_with("error") || line.trim_start().starts_with('×');
        let line = self.said.iter().find(about).or(self.said.first()).map_or(self.ended.as_str(), String::as_str);
        line.trim_start().trim_start_matches("error: ").trim_start_matches('×').trim().to_owned()
    }
}

/// `time.json`
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Took {
    seconds: f64,
}

/// The folder.
#[derive(Clone, Debug)]
pub struct Place {
    out: PathBuf,
    /// Whether results of other builds of this program count.
    any_build: bool,
}

const PLAN: &str = "plan.jsonl";
const TASKS: &str = "tasks";
const RESULT: &str = "result.json";
const FAILED: &str = "failed.json";
const TIME: &str = "time.json";
const CLAIM: &str = ".claim";

/// What is read of a plan at most, bytes.
const PLAN_LIMIT: u64 = 1 << 30;

impl Place {
    /// A folder that need not be there.
    ///
    /// # Errors
    ///
    /// A link leads out of the project.
    pub fn new(out: &Path, any_build: bool) -> io::Result<Place> {
        root::given_output(out).map_err(io::Error::other)?;
        Ok(Place { out: std::path::absolute(out)?, any_build })
    }

    /// Absolute.
    pub fn folder(&self) -> &Path {
        &self.out
    }

    /// Of a task, absolute.
    pub fn task(&self, hash: &str) -> PathBuf {
        self.out.join(TASKS).join(hash)
    }

    /// Writes what there is to do.
    ///
    /// # Errors
    ///
    /// The file with the reason.
    pub fn keep_plan(&self, plan: &Plan) -> Result<(), WriteError> {
        let lines = plan.lines();
        if fs::read(self.out.join(PLAN)).is_ok_and(|known| known == lines) {
            return Ok(());
        }
        let mut files = Files::default();
        files.push(PLAN, lines);
        files.write(&self.out)
    }

    /// Reads that.
    ///
    /// # Errors
    ///
    /// In words.
    pub fn plan(&self) -> Result<Plan, String> {
        let path = self.out.join(PLAN);
        let bytes = root::read_given(&path, PLAN_LIMIT).map_err(|why| format!("{}: {why}", shown(&path)))?;
        Plan::from_lines(&bytes).map_err(|why| format!("{}: {why}", shown(&path)))
    }

    fn read<T: DeserializeOwned>(&self, path: &Path) -> Option<T> {
        let file = path.symlink_metadata().ok().filter(fs::Metadata::is_file).and_then(|_| File::open(path).ok())?;
        serde_json::from_slice(&input::all(file, JSON_LIMIT).ok()?).ok()
    }

    fn counts(&self, format: u32, hash: &str, of: &str, made: &str) -> bool {
        format == FORMAT && hash == of && (self.any_build || made == program())
    }

    /// What a task found; nothing where it did not, or where another build of this program found it.
    pub fn found(&self, hash: &str) -> Option<Found> {
        let found: Found = self.read(&self.task(hash).join(RESULT))?;
        self.counts(found.format, &found.hash, hash, &found.program).then_some(found)
    }

    /// Why a task failed.
    pub fn failed(&self, hash: &str) -> Option<Failed> {
        let failed: Failed = self.read(&self.task(hash).join(FAILED))?;
        self.counts(failed.format, &failed.hash, hash, &failed.program).then_some(failed)
    }

    /// Whether there is a result that does not count, as another build found it.
    pub fn is_of_another_build(&self, hash: &str) -> bool {
        let found: Option<Found> = self.read(&self.task(hash).join(RESULT));
        found.is_some_and(|found| !self.counts(found.format, &found.hash, hash, &found.program))
    }

    /// How long a task took, s.
    pub fn seconds(&self, hash: &str) -> Option<f64> {
        let took: Took = self.read(&self.task(hash).join(TIME))?;
        (took.seconds.is_finite() && took.seconds >= 0.0).then_some(took.seconds)
    }

    pub fn state(&self, hash: &str) -> State {
        if self.found(hash).is_some() {
            return State::Done;
        }
        let claimed = File::open(self.task(hash).join(CLAIM)).is_ok_and(|file| {
            // Shared, so that looking does not keep others from their work.
            matches!(file.try_lock_shared(), Err(TryLockError::WouldBlock))
        });
        match claimed {
            true => State::Claimed,
            false if self.failed(hash).is_some() => State::Failed,
            false => State::Open,
        }
    }

    /// Claims a task: with the lock that says so, or without where there are no locks. `None` where somebody else has
    /// it; `wait` waits until nobody has.
    ///
    /// # Errors
    ///
    /// The folder cannot be made.
    pub fn claim(&self, hash: &str, wait: bool) -> io::Result<Option<Claim>> {
        let folder = self.task(hash);
        root::below(&self.out, &folder).map_err(io::Error::other)?;
        fs::create_dir_all(&folder)?;
        let file = File::options().write(true).create(true).truncate(false).open(folder.join(CLAIM))?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) if wait => drop(file.lock()),
            Err(TryLockError::WouldBlock) => return Ok(None),
            // Without locks, too.
            _ => {}
        }
        Ok(Some(Claim(file)))
    }

    /// What a step found before.
    pub fn step(&self, hash: &str, step: &str) -> Option<Values> {
        let found: Found = self.read(&self.task(hash).join(format!("{step}.json")))?;
        self.counts(found.format, &found.hash, hash, &found.program).then_some(found.values)
    }

    /// Keeps what a step found.
    ///
    /// # Errors
    ///
    /// The file with the reason.
    pub fn keep_step(&self, hash: &str, step: &str, values: &Values) -> Result<(), WriteError> {
        replace(&self.task(hash).join(format!("{step}.json")), &found(hash, values))
    }

    /// Keeps what a task found, and ends it.
    ///
    /// # Errors
    ///
    /// The file with the reason.
    pub fn keep(&self, hash: &str, values: &Values, seconds: f64) -> Result<(), WriteError> {
        let folder = self.task(hash);
        replace(&folder.join(TIME), &to_json(&Took { seconds }))?;
        replace(&folder.join(RESULT), &found(hash, values))?;
        let _ = fs::remove_file(folder.join(FAILED));
        Ok(())
    }

    /// Keeps why a task failed.
    ///
    /// # Errors
    ///
    /// The file with the reason.
    pub fn keep_failed(&self, failed: &Failed) -> Result<(), WriteError> {
        replace(&self.task(&failed.hash).join(FAILED), &to_json(failed))
    }

    /// Removes what steps left beside the result. What cannot be removed stays.
    pub fn clear<'a>(&self, hash: &str, steps: impl Iterator<Item = &'a str>) {
        let folder = self.task(hash);
        for step in steps {
            let _ = fs::remove_dir_all(folder.join(step));
            let _ = fs::remove_file(folder.join(format!("{step}.json")));
        }
    }
}

fn found(hash: &str, values: &Values) -> Vec<u8> {
    to_json(&Found { format: FORMAT, hash: hash.to_owned(), program: program().to_owned(), values: values.clone() })
}

/// A task that is this process's, until it is dropped or ends, and until the processes end that have it from here.
#[derive(Debug)]
pub struct Claim(File);

impl Claim {
    /// The lock once more, for a process that is started.
    pub fn shared(&self) -> Option<File> {
        self.0.try_clone().ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HASH: &str = "0123456789abcdef";

    fn values(x: f64) -> Values {
        [("build.length_m".to_owned(), Value::from(x))].into()
    }

    #[test]
    fn a_task_is_claimed_once_and_done_when_its_result_is_there() {
        let folder = tempfile::tempdir().unwrap();
        let place = Place::new(&folder.path().join("out"), false).unwrap();
        assert_eq!(place.state(HASH), State::Open);
        let claim = place.claim(HASH, false).unwrap().unwrap();
        assert!(place.claim(HASH, false).unwrap().is_none());
        assert_eq!(place.state(HASH), State::Claimed);
        // The lock stays with who has it from here.
        let shared = claim.shared().unwrap();
        drop(claim);
        assert_eq!(place.state(HASH), State::Claimed);
        drop(shared);
        assert_eq!(place.state(HASH), State::Open);
        place.keep(HASH, &values(3.5), 1.5).unwrap();
        assert_eq!((place.state(HASH), place.seconds(HASH)), (State::Done, Some(1.5)));
        assert_eq!(place.found(HASH).unwrap().values, values(3.5));
    }

    #[test]
    fn results_of_other_builds_count_where_that_is_asked_for() {
        let folder = tempfile::tempdir().unwrap();
        let strict = Place::new(folder.path(), false).unwrap();
        let lenient = Place::new(folder.path(), true).unwrap();
        fs::create_dir_all(strict.task(HASH)).unwrap();
        let write = |found: &Found| fs::write(strict.task(HASH).join(RESULT), to_json(found)).unwrap();
        let other = Found { format: FORMAT, hash: HASH.into(), program: "other".into(), values: values(1.0) };
        write(&other);
        assert_eq!((strict.state(HASH), lenient.state(HASH)), (State::Open, State::Done));
        assert!(strict.is_of_another_build(HASH) && !lenient.is_of_another_build(HASH));
        // Of another format or another task, never.
        write(&Found { format: FORMAT + 1, ..other.clone() });
        assert_eq!(lenient.state(HASH), State::Open);
        write(&Found { hash: "fedcba9876543210".into(), ..other });
        assert_eq!(lenient.state(HASH), State::Open);
        fs::write(strict.task(HASH).join(RESULT), "{\"format\":").unwrap();
        assert_eq!(lenient.state(HASH), State::Open, "half a file is none");
    }

    #[test]
    fn a_failure_is_told_in_a_line() {
        let failed = |said: &[&str]| Failed {
            format: FORMAT,
            hash: HASH.into(),
            program: String::new(),
            step: "build".into(),
            command: Vec::new(),
            ended: "exit code 1".into(),
            said: said.iter().map(|s| (*s).to_owned()).collect(),
        };
        assert_eq!(
            failed(&["E0301 dimension-mismatch", "", "  × a length was expected"]).line(),
            "a length was expected"
        );
        assert_eq!(failed(&["warning: x", "error: the chain broke"]).line(), "the chain broke");
        assert_eq!(failed(&[]).line(), "exit code 1");
    }
}
