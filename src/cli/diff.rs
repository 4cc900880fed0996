//! `lss diff`: what changed between two layouts, or in one since a revision.

use super::compare::simulation_of;
use super::{MessageFormat, Outcome, could_not, limits, read, report};
use crate::base::json;
use crate::chain_input::Simulation;
use crate::compiled::Compiled;
use crate::emit::{DrawError, Files, change_png, change_svg};
use crate::review::{Comparison, Forces};
use crate::signal::Entry;
use crate::source::shown;
use clap::ValueEnum;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Show what changed between two layouts: length, price, chain, bill, what is built where, and what is written.
///
/// Both are solved. With --runs, runs that were simulated of both are compared, too. With --git the layout is compared with
/// what it was in a revision, with the files that it imported then. With --output it writes change.json, change.md, change.svg and change.png, both tracks over each other.
#[derive(Debug, clap::Args)]
pub struct Diff {
    /// The layout before; with --git the layout itself.
    before: PathBuf,
    /// The layout after.
    #[arg(required_unless_present = "git", conflicts_with = "git")]
    after: Option<PathBuf>,
    /// Compare with the layout as it was in this commit, branch or tag.
    #[arg(long, value_name = "REV")]
    git: Option<String>,
    /// Which layout, when the files have several.
    #[arg(long, value_name = "NAME")]
    layout: Option<String>,
    /// End with exit code 1 where this changed.
    #[arg(long, value_name = "WHAT", value_enum)]
    fail_on: Option<FailOn>,
    /// Runs of the layout before and of the layout after, as `lss simulate` writes them: mean, standard deviation and
    /// peak of each channel are told, too.
    #[arg(long, num_args = 2, value_names = ["BEFORE", "AFTER"])]
    runs: Vec<PathBuf>,
    /// Folder for the outputs; created if it is missing.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// End each search after this time (30, 30s, 2min) with the best layout so far.
    #[arg(long, value_name = "TIME", value_parser = limits::time)]
    time_limit: Option<Duration>,
    /// How the result is written to standard output.
    #[arg(long, value_enum, default_value_t)]
    format: DiffFormat,
    /// How diagnostics are written to standard error.
    #[arg(long, value_enum, default_value_t)]
    message_format: MessageFormat,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum FailOn {
    /// Anything, in what is written or in what is built.
    Any,
    /// What is built.
    Built,
    /// The bill: elements of the track, and what is ordered beside it.
    Bill,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum)]
enum DiffFormat {
    #[default]
    Text,
    Json,
    /// For a pull request.
    Markdown,
}

/// A layout's name, what it builds, and whether it can be built.
type Solved = (String, (Compiled, Outcome));

impl Diff {
    pub fn run(&self) -> Outcome {
        let [(before_name, before), (after_name, after)] = match self.both() {
            Ok(both) => both,
            Err(outcome) => return outcome,
        };
        let forces = match self.forces([&before.0, &after.0]) {
            Ok(forces) => forces,
            Err(outcome) => return outcome,
        };
        let comparison = Comparison::new((&before_name, &before.0), (&after_name, &after.0)).with_forces(forces);
        if let Some(folder) = &self.output {
            let files = match files(&comparison, &before.0, &after.0) {
                Ok(files) => files,
                Err(why) => return could_not("draw", Path::new(&after_name), why),
            };
            if let Err(error) = files.write_set(folder, "change") {
                return could_not("write", &error.path, &error.reason);
            }
        }
        report::print(&match self.format {
            DiffFormat::Json => serde_json::to_string(&comparison).unwrap_or_default() + "\n",
            DiffFormat::Markdown => comparison.markdown(),
            DiffFormat::Text => comparison.text() + &report::written_to(self.output.as_deref()),
        });
        let changed = match self.fail_on {
            None => false,
            Some(FailOn::Any) => !comparison.is_same(),
            Some(FailOn::Built) => !comparison.is_built_alike(),
            Some(FailOn::Bill) => !comparison.is_billed_alike(),
        };
        // What is wrong with the layout before is no reason to refuse what comes after it.
        if changed { Outcome::Problems } else { after.1 }
    }

    /// The runs that are given, each of which has to be of its layout's track.
    fn forces(&self, layouts: [&Compiled; 2]) -> Result<Option<Forces>, Outcome> {
        let [before, after] = self.runs.as_slice() else { return Ok(None) };
        let read = |path: &PathBuf, compiled: &Compiled| {
            let (entry, run) = Entry::read(path).map_err(|why| {
                report::error(&why.to_string());
                if why.is_unreadable() { Outcome::CouldNotRun } else { Outcome::Problems }
            })?;
            match simulation_of(&entry) {
                Some((_, Ok(of))) if of.track != Simulation::new(compiled).track => {
                    let name = &compiled.layout.name;
                    report::error(&format!("{} is of another track than that of `{name}`", shown(path)));
                    report::note("  help: simulate the layout as it is now with `lss simulate`, and give that run");
                    return Err(Outcome::Problems);
                }
                Some((_, Ok(_))) => {}
                Some((file, Err(why))) => {
                    let (run, file) = (shown(path), shown(&file));
                    report::warning(&format!("whether {run} is of this track is not known: {file}: {why}"));
                }
                None => report::warning(&format!(
                    "whether {} is of this track is not known: the layout that its sidecar names is not there",
                    shown(path)
                )),
            }
            Ok(run)
        };
        let runs = [read(before, layouts[0])?, read(after, layouts[1])?];
        let names = [before, after].map(|path| shown(path).to_string());
        Ok(Some(Forces::new((&names[0], &runs[0]), (&names[1], &runs[1]))))
    }

    /// Both layouts, solved, with their names and whether they can be built.
    fn both(&self) -> Result<[Solved; 2], Outcome> {
        let (name, format) = (self.layout.as_deref(), self.message_format);
        let read = |file: &Path| Ok::<_, Outcome>((shown(file).to_string(), read::read_any(file, name, &[], format)?));
        let [before, after] = match (&self.git, &self.after) {
            (Some(revision), _) => {
                let file = &self.before;
                let before = read::read_revision(file, revision, name, format)?;
                [(format!("{revision}:{}", shown(file)), before), read(file)?]
            }
            (None, Some(after)) => [read(&self.before)?, read(after)?],
            // Which the command line does not allow.
            (None, None) => return Err(Outcome::CouldNotRun),
        };
        let solve = |(name, read)| {
            // Each has the whole time.
            limits::set_time(self.time_limit);
            Ok::<_, Outcome>((name, read::solved(read, format)?))
        };
        // What the layout before only warns of is no news.
        let before = (before.0, read::Read { mute: true, ..before.1 });
        Ok([solve(before)?, solve(after)?])
    }
}

fn files(comparison: &Comparison, before: &Compiled, after: &Compiled) -> Result<Files, DrawError> {
    let (names, both) = ((comparison.before.source.as_str(), comparison.after.source.as_str()), (before, after));
    let mut files = Files::default();
    files.push("change.json", json::to_json(comparison));
    files.push("change.md", comparison.markdown().into_bytes());
    files.push("change.svg", change_svg(names, both)?.into_bytes());
    files.push("change.png", change_png(names, both)?);
    Ok(files)
}
