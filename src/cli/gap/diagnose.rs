//! `lss gap diagnose`.

use super::{apply, text};
use crate::cli::cases::cases;
use crate::cli::{Outcome, OutputFormat, could_not, report};
use crate::dynamics::Width;
use crate::emit::{Files, json};
use crate::gap::chain::Chains;
use crate::gap::{Stage, diagnose};
use crate::identify::study::Subject;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::path::PathBuf;
use std::time::Duration;

/// Diagnose the gap between a campaign of measured runs and the simulation of their layouts.
///
/// Fits the nominal model to each run, maps what is left over the floor of two honest laps, asks every effect of the library
/// whether it explains that, and tells how much of the gap each closes on runs left out. Writes gap.json and gap.html.
#[derive(Debug, clap::Args)]
pub struct Diagnose {
    /// Folder of a campaign, its campaign.toml, or a single data file.
    campaign: PathBuf,
    /// Folder for the outputs; created if it is missing.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Layout of all runs, .lss or simulation.json, instead of those that campaign and sidecars name.
    #[arg(long, value_name = "FILE")]
    layout: Option<PathBuf>,
    /// Also write a layout with the verdict's effects added, for `lss simulate`.
    #[arg(long)]
    apply: bool,
    /// Which noise simulations get: another seed, another honest answer.
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// How the result is written to standard output.
    #[arg(long, value_enum, default_value_t)]
    format: OutputFormat,
}

impl Diagnose {
    pub fn run(&self) -> Outcome {
        let (cases, broken) = match cases(&self.campaign, self.layout.as_deref()) {
            Ok(found) => found,
            Err(outcome) => return outcome,
        };
        if cases.is_empty() {
            report::error("no run is left to diagnose");
            return Outcome::Problems;
        }
        let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
        let bar = Progress::new();
        let subjects: Vec<Subject> = cases.iter().map(|c| c.subject.clone()).collect();
        bar.say("fitting the nominal model to each run");
        let chains =
            match Chains::new(&subjects, self.seed, threads, Width::widest(), &|run| bar.say(&format!("fitted {run}")))
            {
                Ok(chains) => chains,
                Err((run, why)) => {
                    bar.clear();
                    report::error(&format!("{run}: {why}\n  help: leave the run out of campaign.toml"));
                    return Outcome::Problems;
                }
            };
        let mut found = diagnose(&chains, &mut |stage| match stage {
            Stage::Screening { done, of } => bar.say(&format!("screening effects: {done} of {of} strengths")),
            Stage::Fitting { done, of } => bar.say(&format!("fitting what is left: round {} of {of}", done + 1)),
        });
        bar.clear();
        found.lost = chains.lost();
        let mut files = Files::default();
        files.push("gap.json", json::to_json(&found));
        if self.apply {
            match apply::files(&cases, &chains, &found, &self.output) {
                Ok(more) => files.extend(more),
                Err(outcome) => return outcome,
            }
        }
        if let Err(error) = files.write(&self.output) {
            return could_not("write", &error.path, &error.reason);
        }
        report::print(&match self.format {
            OutputFormat::Json => serde_json::to_string(&found).unwrap_or_default() + "\n",
            OutputFormat::Text => format!("{}written to {}\n", text::text(&found), self.output.display()),
        });
        if broken { Outcome::Problems } else { Outcome::Clean }
    }
}

/// A line on the terminal that says what is going on.
struct Progress(Option<ProgressBar>);

impl Progress {
    fn new() -> Self {
        Progress(std::io::stderr().is_terminal().then(|| {
            let style = ProgressStyle::with_template("{spinner} {msg}, {elapsed}");
            let bar = ProgressBar::new_spinner().with_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
            bar.enable_steady_tick(Duration::from_millis(200));
            bar
        }))
    }

    fn say(&self, what: &str) {
        if let Some(bar) = &self.0 {
            bar.set_message(what.to_owned());
        }
    }

    fn clear(&self) {
        if let Some(bar) = &self.0 {
            bar.finish_and_clear();
        }
    }
}
