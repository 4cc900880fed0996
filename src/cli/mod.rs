//! The `lss` command: one file a verb.
//!
//! Exit codes: 0 clean (warnings allowed), 1 problems in the input, 2 could not run.

pub mod build;
pub mod capacity;
mod cases;
pub mod check;
mod choose;
mod compare;
mod diff;
mod explain;
mod fmt;
mod foreign;
mod gap;
mod generate;
mod identify;
mod import;
mod layouts;
mod limits;
mod lsp;
mod new;
mod polygon;
mod preview;
pub mod progress;
mod read;
mod report;
mod runs;
pub mod simulate;
mod study;

use crate::dynamics::{NoWidth, Width};
use crate::source::{Root, one_line, shown, steers};
use clap::{Parser, Subcommand, ValueEnum};
use std::ffi::OsString;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Compile conveyor track layouts: check, optimise, draw and bill them.
#[derive(Debug, Parser)]
#[command(name = "lss", version, arg_required_else_help = true, infer_subcommands = false)]
pub struct Cli {
    /// How far files may name other files: nothing outside DIR is read because a file says so.
    ///
    /// Without it the nearest folder upwards with .git or lss.toml; without one, a layout's own folder, and for runs
    /// theirs and the one above. Paths on the command line may lead anywhere.
    #[arg(long, global = true, value_name = "DIR")]
    root: Option<PathBuf>,
    #[command(subcommand)]
    verb: Verb,
    /// Threads to use; no result depends on it. All cores when not given.
    #[arg(long, global = true, value_name = "N", value_parser = limits::count)]
    threads: Option<NonZeroUsize>,
}

#[derive(Debug, Subcommand)]
enum Verb {
    Build(build::Build),
    Check(check::Check),
    Diff(diff::Diff),
    Capacity(capacity::Capacity),
    Choose(choose::Choose),
    Simulate(simulate::Simulate),
    Compare(compare::Compare),
    Runs(runs::Runs),
    Identify(identify::Identify),
    Gap(gap::Gap),
    Polygon(polygon::Polygon),
    Study(study::Study),
    Fmt(fmt::Fmt),
    Explain(explain::Explain),
    New(new::New),
    Import(import::Import),
    Preview(preview::Preview),
    Lsp(lsp::Lsp),
    Completions(generate::Completions),
    Man(generate::Man),
}

/// How a run ended, the worst last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Outcome {
    Clean,
    Problems,
    CouldNotRun,
}

impl From<Outcome> for ExitCode {
    fn from(outcome: Outcome) -> Self {
        ExitCode::from(outcome.code())
    }
}

impl Outcome {
    /// The exit code.
    pub fn code(self) -> u8 {
        match self {
            Outcome::Clean => 0,
            Outcome::Problems => 1,
            Outcome::CouldNotRun => 2,
        }
    }
}

/// How diagnostics are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum)]
pub enum MessageFormat {
    /// For people, with excerpts.
    #[default]
    Text,
    /// One JSON object a line.
    Json,
}

/// How a verb writes its result to standard output.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum)]
pub enum OutputFormat {
    #[default]
    Text,
    Json,
}

/// Runs the command line.
pub fn main() -> ExitCode {
    run(std::env::args_os().collect()).into()
}

/// Runs a command line, whose first word is the program's name.
pub fn run(words: Vec<OsString>) -> Outcome {
    let cli = match Cli::try_parse_from(&words) {
        Ok(cli) => cli,
        Err(why) => return misused(&why, &words),
    };
    limits::set_threads(cli.threads);
    if let Err(none) = Width::asked() {
        return no_width(&none);
    }
    if let Some(folder) = &cli.root
        && let Err(why) = Root::give(folder)
    {
        return could_not("take as the root", folder, why);
    }
    match cli.verb {
        Verb::Build(verb) => verb.run(),
        Verb::Check(verb) => verb.run(),
        Verb::Diff(verb) => verb.run(),
        Verb::Capacity(verb) => verb.run(),
        Verb::Choose(verb) => verb.run(),
        Verb::Simulate(verb) => verb.run(),
        Verb::Compare(verb) => verb.run(),
        Verb::Runs(verb) => verb.run(),
        Verb::Identify(verb) => verb.run(),
        Verb::Gap(verb) => verb.run(),
        Verb::Polygon(verb) => verb.run(),
        Verb::Study(verb) => verb.run(),
        Verb::Fmt(verb) => verb.run(),
        Verb::Explain(verb) => verb.run(),
        Verb::New(verb) => verb.run(),
        Verb::Import(verb) => verb.run(),
        Verb::Preview(verb) => verb.run(),
        Verb::Lsp(verb) => verb.run(),
        Verb::Completions(verb) => verb.run(),
        Verb::Man(verb) => verb.run(),
    }
}

/// Says what is wrong with the command line, or helps. What is quoted of it may be the name of a file that somebody
/// else made.
fn misused(why: &clap::Error, words: &[OsString]) -> Outcome {
    let words = words.iter().map(|word| word.to_string_lossy().into_owned());
    let hostile: Vec<String> = words.filter(|word| word.contains(steers)).collect();
    if hostile.is_empty() {
        // A reader that went away is no error of ours.
        let _ = why.print();
        return if why.use_stderr() { Outcome::CouldNotRun } else { Outcome::Clean };
    }
    // A line break in a word does not begin a message.
    let quoted = hostile.iter().fold(why.to_string(), |text, word| text.replace(word.as_str(), &one_line(word)));
    report::note(quoted.trim_end());
    Outcome::CouldNotRun
}

/// Says which vector widths there are instead.
fn no_width(none: &NoWidth) -> Outcome {
    let all: Vec<&str> = Width::all().into_iter().map(Width::name).collect();
    report::error(&none.to_string());
    report::note(&format!("  help: this processor has {}; without LSS_SIMD the widest is taken", all.join(", ")));
    Outcome::CouldNotRun
}

/// Says why a run was impossible.
fn could_not(what: &str, path: &Path, why: impl std::fmt::Display) -> Outcome {
    report::error(&format!("could not {what} {}: {why}", shown(path)));
    Outcome::CouldNotRun
}

/// `-` is standard input where a verb reads one text.
fn is_stdin(path: &Path) -> bool {
    path.as_os_str() == "-"
}
