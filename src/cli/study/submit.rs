//! `lss study submit`: a cluster does it.

use super::list::Known;
use super::{Studied, always, tasks};
use crate::base;
use crate::base::number::duration;
use crate::cli::{Outcome, could_not, limits, report};
use crate::source::{one_line, shown};
use crate::study::run::{Did, LookedAt, Runner};
use crate::study::slurm::{Array, Arrays, Wishes, chunks};
use crate::study::{Place, Plan, State, Task, process};
use clap::ValueEnum;
use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::time::Duration;

/// Write job arrays of about a minute a job, and submit them.
///
/// How long a task takes is measured on those that are done; where none of a sweep is, two of its open ones are done
/// here first. Tasks that are in the queue already are left out, so that it can be called again at any time: after tasks
/// were lost, or after the study got more of them.
#[derive(Debug, clap::Args)]
pub struct Submit {
    #[command(flatten)]
    studied: Studied,
    /// What does the tasks.
    #[arg(long, value_enum)]
    engine: Engine,
    /// Time that a job takes.
    #[arg(long, value_name = "TIME", default_value = "1min", value_parser = limits::time)]
    chunk: Duration,
    /// Take this as the time of each task, instead of measuring.
    #[arg(long, value_name = "TIME", value_parser = limits::time)]
    each: Option<Duration>,
    /// Jobs of an array at most; the cluster's MaxArraySize.
    #[arg(long, value_name = "N", default_value = "1000")]
    array_size: NonZeroUsize,
    /// Partition of the cluster.
    #[arg(long, value_name = "NAME")]
    partition: Option<String>,
    /// Account to charge.
    #[arg(long, value_name = "NAME")]
    account: Option<String>,
    /// Limit of time of a job, in Slurm's words: 10 or 0:10:00. The partition's when not given.
    #[arg(long, value_name = "TIME")]
    time: Option<String>,
    /// Memory of a job, in Slurm's words: 2G.
    #[arg(long, value_name = "SIZE")]
    memory: Option<String>,
    /// Processors of a job.
    #[arg(long, value_name = "N", default_value = "1")]
    cpus: NonZeroUsize,
    /// A further option of sbatch: --sbatch=--qos=low. May be repeated.
    #[arg(long = "sbatch", value_name = "OPTION", allow_hyphen_values = true)]
    more: Vec<String>,
    /// Only write the scripts.
    #[arg(long)]
    dry_run: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Engine {
    Slurm,
}

/// Tasks of a sweep that are done here to measure their time.
const TRIED: usize = 2;

impl Submit {
    pub fn run(&self) -> Outcome {
        let (plan, place) = match self.studied.planned() {
            Ok(planned) => planned,
            Err(outcome) => return outcome,
        };
        let Engine::Slurm = self.engine;
        if self.each.is_none() {
            self.try_some(&plan, &place);
        }
        let program = match base::installed() {
            Ok(program) => program,
            Err(why) => return could_not("find", "this program".as_ref(), why),
        };
        let arrays = Arrays { place: &place, program: &program };
        let queued = arrays.queued().unwrap_or_default();
        let known = Known::new(&plan, Some(&place));
        let seconds = |task: &Task| match self.each {
            Some(each) => each.as_secs_f64(),
            None => known.estimate(task).unwrap_or(self.chunk.as_secs_f64()),
        };
        let open: Vec<(&str, f64)> = plan
            .unique()
            .into_iter()
            .filter(|task| known.state(task) == State::Open && !queued.tasks.contains(&task.hash))
            .map(|task| (task.hash.as_str(), seconds(task)))
            .collect();
        if open.is_empty() {
            let waiting = queued.tasks.len();
            report::print(&format!(
                "{}: {}, {}; nothing to submit{}\n",
                plan.name,
                tasks(plan.unique().len()),
                known.counts(),
                if waiting > 0 { format!(", {waiting} in the queue") } else { String::new() }
            ));
            return Outcome::Clean;
        }
        let jobs = chunks(&open, self.chunk.as_secs_f64());
        let written = match arrays.write(&jobs, self.array_size.get(), &self.wishes()) {
            Ok(written) => written,
            Err(why) => {
                report::error(&why);
                return Outcome::CouldNotRun;
            }
        };
        let mean = open.iter().map(|(_, seconds)| seconds).sum::<f64>() / open.len() as f64;
        report::print(&format!(
            "{}: {} of {} each in {} of about {}\n",
            plan.name,
            tasks(open.len()),
            duration(mean),
            if jobs.len() == 1 { "1 job".to_owned() } else { format!("{} jobs", jobs.len()) },
            duration(open.iter().map(|(_, seconds)| seconds).sum::<f64>() / jobs.len() as f64),
        ));
        written
            .iter()
            .map(|array| self.submitted(&arrays, array))
            .find(|o| *o != Outcome::Clean)
            .unwrap_or(Outcome::Clean)
    }

    fn submitted(&self, arrays: &Arrays, array: &Array) -> Outcome {
        if self.dry_run {
            report::print(&format!("  {}\n", shown(&array.script)));
            return Outcome::Clean;
        }
        match arrays.submit(array) {
            Ok(job) => {
                report::print(&format!("  job {job}: {}\n", shown(&array.script)));
                Outcome::Clean
            }
            Err(why) => {
                report::error(&one_line(&why));
                report::note(&format!("  the script is {}", shown(&array.script)));
                Outcome::CouldNotRun
            }
        }
    }

    fn wishes(&self) -> Wishes {
        Wishes {
            partition: self.partition.clone(),
            account: self.account.clone(),
            time: self.time.clone(),
            memory: self.memory.clone(),
            cpus: self.cpus.get(),
            more: self.more.clone(),
        }
    }

    /// Does some tasks of each sweep of which none is done. One that fails is told by `status` and `collect`.
    fn try_some(&self, plan: &Plan, place: &Place) {
        let known = Known::new(plan, Some(place));
        let mut of_sweep: BTreeMap<&str, Vec<&Task>> = BTreeMap::new();
        for task in plan.unique() {
            if known.estimate(task).is_none() && known.state(task) == State::Open {
                of_sweep.entry(&task.sweep).or_default().push(task);
            }
        }
        let runner = Runner {
            plan,
            place,
            threads: self.cpus.get(),
            retry_failed: false,
            always: always(),
            start: &process::start,
            looked_at: LookedAt::default(),
        };
        for (sweep, tasks) in of_sweep {
            report::note(&format!("measuring how long tasks of `{}` take", one_line(sweep)));
            let mut done = 0;
            for task in tasks.into_iter().take(2 * TRIED) {
                done += usize::from(runner.task(task, true) == Did::Done);
                if done == TRIED {
                    break;
                }
            }
        }
    }
}
