//! `lss study run`, with all cores of this machine, and `lss study task`, which others call.

use super::list::Known;
use super::{Builds, Studied, always, tasks};
use crate::cli::progress::Line;
use crate::cli::{Outcome, limits, report};
use crate::source::{one_line, shown};
use crate::study::run::{Did, LookedAt, Runner};
use crate::study::{Place, Plan, State, Task, process};
use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// Do all open tasks here.
///
/// Stopped and started again it goes on where it was; several of them, also on several hosts with one folder, share the
/// tasks. A task that fails does not stop the others; the exit code is 1 then.
#[derive(Debug, clap::Args)]
pub struct Run {
    #[command(flatten)]
    studied: Studied,
    /// Tasks at a time; as many as there are cores (or --threads) when not given.
    #[arg(long, value_name = "N", value_parser = limits::count)]
    jobs: Option<NonZeroUsize>,
    /// Try tasks again that failed before.
    #[arg(long)]
    retry_failed: bool,
}

/// Do some tasks of a planned study, one after another: what Slurm, Dask and Ray call.
///
/// A task that is done is not done again, and one that somebody else is at is waited for.
#[derive(Debug, clap::Args)]
pub struct Chosen {
    /// Hashes of the tasks, as `lss study plan` lists them.
    #[arg(required = true, value_name = "HASH")]
    tasks: Vec<String>,
    /// Folder of the results, where `plan`, `run` or `submit` left plan.jsonl.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    #[command(flatten)]
    builds: Builds,
    /// Try tasks again that failed before.
    #[arg(long)]
    retry_failed: bool,
}

impl Run {
    pub fn run(&self) -> Outcome {
        let (plan, place) = match self.studied.planned() {
            Ok(planned) => planned,
            Err(outcome) => return outcome,
        };
        let known = Known::new(&plan, Some(&place));
        if let Some(note) = known.note() {
            report::note(&note);
        }
        let threads = limits::threads();
        let jobs = self.jobs.map_or(threads, NonZeroUsize::get);
        let runner = Runner {
            plan: &plan,
            place: &place,
            threads: (threads / jobs).max(1),
            retry_failed: self.retry_failed,
            always: always(),
            start: &process::start,
            looked_at: LookedAt::default(),
        };
        let line = Line::resumed(plan.unique().len() as u64, known.count(State::Done) as u64, "tasks");
        let all = runner.all(jobs, &|task, did| told(&line, task, did));
        line.finish();
        let outcome = summary(&plan, &place, &all);
        let (study, folder) = (shown(&self.studied.study), shown(&self.studied.output));
        report::note(&format!("`lss study collect {study} -o {folder}` makes a table and a page of what is there"));
        outcome
    }
}

/// What came of a task; what was done before is where the line began.
fn told(line: &Line, task: &Task, did: &Did) {
    let say = |what: &str, why: &str| {
        let words = format!("{} {what}: {}\n  {}", task.hash, one_line(why), one_line(&task.words()));
        line.beside(|| report::error(&words));
    };
    match did {
        Did::Failed(why) => say("failed", why),
        Did::Open(why) => say("is open", why),
        _ => {}
    }
    if *did != Did::Known {
        line.step(|| task.hash.clone());
    }
}

/// What came of all tasks, in a line, and the exit code.
fn summary(plan: &Plan, place: &Place, all: &BTreeMap<String, Did>) -> Outcome {
    let count = |is: &dyn Fn(&Did) -> bool| all.values().filter(|did| is(did)).count();
    let done = count(&|did| matches!(did, Did::Done | Did::Known));
    let failed = count(&|did| matches!(did, Did::Failed(_) | Did::FailedBefore(_)));
    let before = count(&|did| matches!(did, Did::FailedBefore(_)));
    let mut words = vec![format!("{done} done")];
    words.extend((failed > 0).then(|| format!("{failed} failed")));
    words.extend((done + failed < all.len()).then(|| format!("{} open", all.len() - done - failed)));
    report::print(&format!(
        "{}: {}, {}\n  written to {}\n",
        plan.name,
        tasks(all.len()),
        words.join(", "),
        shown(place.folder())
    ));
    if before > 0 {
        let were = if before == 1 { "1 task had" } else { &format!("{before} tasks had") };
        report::note(&format!("{were} failed before; --retry-failed tries again"));
    }
    if done == all.len() { Outcome::Clean } else { Outcome::Problems }
}

impl Chosen {
    pub fn run(&self) -> Outcome {
        let help = "`lss study plan STUDY -o DIR` makes it, where the folder is there";
        let (plan, place) = match self.builds.kept(&self.output, help) {
            Ok(kept) => kept,
            Err(outcome) => return outcome,
        };
        let mut wanted: Vec<&Task> = Vec::new();
        for hash in &self.tasks {
            match plan.find(hash) {
                Some(task) => wanted.push(task),
                None => {
                    report::error(&format!("the study has no task {}", one_line(hash)));
                    report::note("  help: `lss study plan` lists them; was the study planned anew?");
                    return Outcome::CouldNotRun;
                }
            }
        }
        let runner = Runner {
            plan: &plan,
            place: &place,
            threads: limits::threads(),
            retry_failed: self.retry_failed,
            always: always(),
            start: &process::start,
            looked_at: LookedAt::default(),
        };
        let mut outcome = Outcome::Clean;
        for task in wanted {
            let did = runner.task(task, true);
            match &did {
                Did::Done | Did::Known => report::note(&format!("{} done", task.hash)),
                Did::Failed(why) | Did::FailedBefore(why) => {
                    outcome = Outcome::Problems;
                    report::error(&format!("{} failed: {}", task.hash, one_line(why)));
                }
                Did::Claimed | Did::Open(_) => {
                    let why = if let Did::Open(why) = &did { why.as_str() } else { "somebody else is at it" };
                    report::error(&format!("{} is open: {}", task.hash, one_line(why)));
                    return Outcome::CouldNotRun;
                }
            }
        }
        outcome
    }
}
