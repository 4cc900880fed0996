//! `lss study`: many tasks that differ in their parameters.

mod collect;
mod list;
mod progress;
mod run;
mod submit;

use super::{Cli, MessageFormat, Outcome, could_not, report};
use crate::source::{SourceMap, root};
use crate::study::plan::NoPlan;
use crate::study::{Place, Plan};
use clap::{Parser, Subcommand};
use std::path::{Path, PathBuf};

/// Do many tasks that differ in their parameters, and collect what they found.
///
/// A study.toml says which layouts, parameters and options are swept. Results are kept in the folder of outputs, each
/// by a hash of all that it depends on: what is done is not done again, and a study that was stopped, however it was,
/// goes on where it was.
#[derive(Debug, clap::Args)]
pub struct Study {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    Plan(list::List),
    Run(run::Run),
    Task(run::Chosen),
    Submit(submit::Submit),
    Status(progress::Status),
    Collect(collect::Collect),
}

impl Study {
    pub fn run(&self) -> Outcome {
        match &self.what {
            What::Plan(verb) => verb.run(),
            What::Run(verb) => verb.run(),
            What::Task(verb) => verb.run(),
            What::Submit(verb) => verb.run(),
            What::Status(verb) => verb.run(),
            What::Collect(verb) => verb.run(),
        }
    }
}

/// A study and the folder of its results.
#[derive(Debug, clap::Args)]
struct Studied {
    /// The study, study.toml.
    study: PathBuf,
    /// Folder of the results; created if it is missing.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    #[command(flatten)]
    builds: Builds,
    /// How diagnostics are written to standard error.
    #[arg(long, value_enum, default_value_t)]
    message_format: MessageFormat,
}

#[derive(Debug, clap::Args)]
struct Builds {
    /// Also count results that another build of lss found.
    #[arg(long)]
    any_build: bool,
}

impl Studied {
    /// What there is to do, kept in the folder, which is made.
    fn planned(&self) -> Result<(Plan, Place), Outcome> {
        let plan = planned(&self.study, self.message_format)?;
        let place = self.builds.place(&self.output)?;
        place.keep_plan(&plan).map_err(|error| could_not("write", &error.path, &error.reason))?;
        Ok((plan, place))
    }
}

impl Builds {
    /// A study's folder and the plan in it; `help` says what makes one.
    fn kept(&self, output: &Path, help: &str) -> Result<(Plan, Place), Outcome> {
        let place = self.place(output)?;
        match place.plan() {
            Ok(plan) => Ok((plan, place)),
            Err(why) => {
                report::error(&why);
                report::note(&format!("  help: {help}"));
                Err(Outcome::CouldNotRun)
            }
        }
    }

    fn place(&self, output: &Path) -> Result<Place, Outcome> {
        Place::new(output, self.any_build).map_err(|why| could_not("write to", output, why))
    }
}

/// Plans a study; what is wrong with it is told here.
fn planned(study: &Path, format: MessageFormat) -> Result<Plan, Outcome> {
    let mut sources = SourceMap::default();
    match Plan::read(&mut sources, study, &is_taken) {
        Ok(plan) => Ok(plan),
        Err(NoPlan::Unreadable(why)) => Err(could_not("read", study, why)),
        Err(NoPlan::Wrong(said)) => {
            report::diagnostics(&mut std::io::stderr(), &sources, &said, format);
            Err(Outcome::Problems)
        }
    }
}

/// Whether the command line takes these words.
fn is_taken(words: &[String]) -> Result<(), String> {
    let words = std::iter::once("lss").chain(words.iter().map(String::as_str));
    Cli::try_parse_from(words).map(drop).map_err(|why| {
        let text = why.to_string();
        let lines = text.lines().take_while(|line| !line.is_empty());
        lines.map(|line| line.trim_start_matches("error: ")).collect::<Vec<_>>().join("\n")
    })
}

/// What every process of a study is told.
fn always() -> Vec<String> {
    root::chosen().map(|root| format!("--root={}", root.to_string_lossy())).into_iter().collect()
}

/// `3 tasks`
fn tasks(count: usize) -> String {
    if count == 1 { "1 task".to_owned() } else { format!("{count} tasks") }
}
