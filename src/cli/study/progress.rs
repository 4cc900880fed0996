//! How far a study is: a bar while it runs here, and `lss study status` for what runs anywhere.

use super::list::Known;
use super::{Builds, tasks};
use crate::base;
use crate::cli::{Outcome, limits, report};
use crate::source::one_line;
use crate::study::run::Did;
use crate::study::slurm::Arrays;
use crate::study::{Place, Plan, State, Task};
use indicatif::{ProgressBar, ProgressStyle};
use std::io::{IsTerminal, Write};
use std::path::PathBuf;
use std::time::Duration;

/// A bar where somebody looks; lines of failures elsewhere, too.
pub struct Bar(Option<ProgressBar>);

impl Bar {
    pub fn new(tasks: usize, done: usize) -> Bar {
        Bar(std::io::stderr().is_terminal().then(|| {
            let style = ProgressStyle::with_template("[{bar:24}] {pos} of {len} tasks, {elapsed}, {eta} left {msg}")
                .unwrap_or_else(|_| ProgressStyle::default_bar())
                .progress_chars("=> ");
            let bar = ProgressBar::new(tasks as u64).with_style(style).with_position(done as u64);
            bar.reset_eta();
            bar.enable_steady_tick(Duration::from_millis(500));
            bar
        }))
    }

    pub fn told(&self, task: &Task, did: &Did) {
        let say = |what: &str, why: &str| {
            let line = format!("{} {what}: {}\n  {}", task.hash, one_line(why), one_line(&task.words()));
            match &self.0 {
                Some(bar) => bar.suspend(|| report::error(&line)),
                None => report::error(&line),
            }
        };
        match did {
            Did::Failed(why) => say("failed", why),
            Did::Open(why) => say("is open", why),
            _ => {}
        }
        // What was done before is where the bar began.
        if let (Some(bar), false) = (&self.0, *did == Did::Known) {
            bar.inc(1);
        }
    }

    pub fn clear(&self) {
        if let Some(bar) = &self.0 {
            bar.finish_and_clear();
        }
    }
}

/// Say how far a study is, wherever its tasks are done.
///
/// What is done is read from the folder of the results; where arrays were submitted, Slurm is asked how many of their
/// jobs run and wait. The exit code is 1 where a task failed.
#[derive(Debug, clap::Args)]
pub struct Status {
    /// Folder of the results.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    #[command(flatten)]
    builds: Builds,
    /// Say it again and again until nothing is open.
    #[arg(long)]
    watch: bool,
}

/// How often --watch looks.
const EVERY: Duration = Duration::from_secs(2);

impl Status {
    pub fn run(&self) -> Outcome {
        let place = match self.builds.place(&self.output) {
            Ok(place) => place,
            Err(outcome) => return outcome,
        };
        let plan = match place.plan() {
            Ok(plan) => plan,
            Err(why) => {
                report::error(&why);
                report::note("  help: `lss study run` or `submit` makes it");
                return Outcome::CouldNotRun;
            }
        };
        let terminal = std::io::stdout().is_terminal();
        let mut before = String::new();
        loop {
            let known = Known::new(&plan, Some(&place));
            let line = line(&plan, &place, &known);
            let left = known.count(State::Open) + known.count(State::Claimed);
            let last = !self.watch || left == 0;
            if last || (!terminal && line != before) {
                let clear = if terminal && self.watch { "\r\u{1b}[K" } else { "" };
                let _ = std::io::stdout().write_all(clear.as_bytes());
                report::print(&format!("{line}\n"));
            } else if terminal {
                let _ = std::io::stdout().write_all(format!("\r\u{1b}[K{line}").as_bytes());
            }
            let _ = std::io::stdout().flush();
            if last {
                if let Some(note) = known.note() {
                    report::note(&note);
                }
                return if known.count(State::Failed) > 0 { Outcome::Problems } else { Outcome::Clean };
            }
            before = line;
            std::thread::sleep(EVERY);
        }
    }
}

fn line(plan: &Plan, place: &Place, known: &Known) -> String {
    let mut line = format!("{}: {}, {}", one_line(&plan.name), tasks(plan.unique().len()), known.counts());
    let program = base::installed().unwrap_or_default();
    let queue = Arrays { place, program: &program }.queued();
    let cores = match &queue {
        Some(queue) => {
            line += &format!("; Slurm: {} jobs running, {} waiting", queue.running, queue.waiting);
            queue.running
        }
        None => limits::threads(),
    };
    if let Some(left) = known.left(plan, cores.max(1)) {
        line += &format!(", {left}");
    }
    line
}
