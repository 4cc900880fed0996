//! `lss study status`: how far a study is, wherever it runs.

use super::list::Known;
use super::{Builds, tasks};
use crate::base;
use crate::cli::{Outcome, limits, report};
use crate::source::one_line;
use crate::study::slurm::Arrays;
use crate::study::{Place, Plan, State};
use std::io::{IsTerminal, Write};
use std::path::PathBuf;
use std::time::Duration;

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
        let (plan, place) = match self.builds.kept(&self.output, "`lss study run` or `submit` makes it") {
            Ok(kept) => kept,
            Err(outcome) => return outcome,
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
