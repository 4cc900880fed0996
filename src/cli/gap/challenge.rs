//! `lss gap challenge`: campaigns whose effects are withheld, and what the diagnosis makes of them.

use crate::base::json::to_json;
use crate::benchmark::answering::{AnsweringStep, Before, answer, child, facts, score_folder};
use crate::benchmark::generate::{Order, generate};
use crate::benchmark::{CaseKind, table};
use crate::cli::progress::Line;
use crate::cli::{MessageFormat, Outcome, OutputFormat, could_not, limits, read, report};
use crate::source::disk::Files;
use crate::source::shown;
use clap::{Subcommand, ValueEnum};
use std::path::PathBuf;

/// Test the diagnosis on campaigns whose effects are withheld.
#[derive(Debug, clap::Args)]
pub struct Challenge {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    New(New),
    Score(Score),
}

/// Make campaigns with effects, and seal what was put in.
///
/// Each case is a campaign of three runs from another simulation than the diagnosis': other steps or another
/// integrator, other contact smoothing, a scatter that every built chain has, noise, trigger jitter and quantisation.
/// 40 in 100 have one effect, 15 a pair, 15 none, 15 one that is not in the library, 15 a sensor's. The key's salted
/// SHA-256 is printed and stored in challenge.json.
#[derive(Debug, clap::Args)]
struct New {
    /// Number of cases.
    #[arg(long, value_name = "N", default_value_t = 120, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    cases: u32,
    /// The same seed makes the same challenge.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// Make all cases of one kind instead of the mix.
    #[arg(long, value_enum, value_name = "KIND")]
    only: Option<Only>,
    /// Drive all cases on this layout, .lss or simulation.json, instead of the five of the library: what would be seen
    /// on your track?
    #[arg(long, value_name = "FILE")]
    layout: Option<PathBuf>,
    /// Folder of the challenge; created if it is missing.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Only {
    One,
    Pair,
    None,
    Unknown,
    Sensor,
}

/// Diagnose every case, then open the key and score the answers.
///
/// Each case is diagnosed by a child process on a copy without key and seed. Answers are kept in DIR/answers, so that a
/// stopped run goes on where it was; only when all are there is the key opened and held against its hash. Writes
/// score.json and score.md.
#[derive(Debug, clap::Args)]
struct Score {
    /// Folder of the challenge.
    folder: PathBuf,
    /// How the score is written to standard output.
    #[arg(long, value_enum, default_value_t)]
    format: OutputFormat,
}

impl Challenge {
    pub fn run(&self) -> Outcome {
        match &self.what {
            What::New(verb) => verb.run(),
            What::Score(verb) => verb.run(),
        }
    }
}

impl New {
    fn run(&self) -> Outcome {
        let only = self.only.map(|only| match only {
            Only::One => CaseKind::One,
            Only::Pair => CaseKind::Pair,
            Only::None => CaseKind::None,
            Only::Unknown => CaseKind::Unknown,
            Only::Sensor => CaseKind::Sensor,
        });
        let threads = limits::threads();
        let layout = match self.layout.as_ref().map(|file| read::simulation(file, None, MessageFormat::Text)) {
            Some(Err(outcome)) => return outcome,
            given => given.and_then(Result::ok),
        };
        let order = Order { cases: self.cases as usize, seed: self.seed, only, layout, threads };
        let line = Line::steps(order.cases as u64, "cases");
        let made = generate(&order, &self.output, &|done| {
            line.at(done as u64, || "made".into());
        });
        line.finish();
        match made {
            Ok(facts) => {
                report::print(&format!("{} cases in {}\n", facts.cases.len(), shown(&self.output)));
                report::print(&format!("key SHA-256 {}\n", facts.key_sha256));
                Outcome::Clean
            }
            Err(why) => could_not("make a challenge in", &self.output, why),
        }
    }
}

impl Score {
    fn run(&self) -> Outcome {
        let cases = match facts(&self.folder) {
            Ok(facts) => facts.cases.len(),
            Err(why) => return could_not("read the challenge", &self.folder, why),
        };
        let line = Line::steps(cases as u64, "cases");
        let mut watch = |step: AnsweringStep| {
            if step.before == Before::Kept {
                line.known();
            } else {
                line.at(step.number as u64, || step.case.to_owned());
                if !line.moves() {
                    report::note(&format!("{} ({} of {})", step.case, step.number + 1, step.of));
                }
            }
            let say = |why: &str| line.beside(|| report::warning(&format!("{}: {why}", step.case)));
            match step.before {
                Before::Nothing | Before::Kept => {}
                Before::OfOthers => say("its answer is of another version of lss or other files, and is asked anew"),
                Before::Contradicted => {
                    say("asked again, the diagnosis gives another answer than before: none is kept")
                }
            }
            true
        };
        let answered = answer(&self.folder, crate::base::program(), &child, &mut watch);
        line.finish();
        match answered {
            Ok(hash) => report::note(&format!("answers SHA-256 {hash}")),
            Err(why) => return could_not("answer the challenge", &self.folder, why),
        }
        let score = match score_folder(&self.folder) {
            Ok(score) => score,
            Err(why) => return could_not("score the challenge", &self.folder, why),
        };
        let json = to_json(&score);
        let mut files = Files::default();
        files.push("score.json", json.clone());
        files.push("score.md", table::markdown(&score));
        if let Err(error) = files.write_set(&self.folder, "score") {
            return could_not("write", &error.path, &error.reason);
        }
        match self.format {
            OutputFormat::Text => report::print(&table::text(&score)),
            OutputFormat::Json => report::print(&String::from_utf8_lossy(&json)),
        }
        if score.failed > 0 {
            let (failed, cases) = (score.failed, score.cases);
            report::warning(&format!("{failed} of {cases} cases have no answer; answers/*/failure.txt says why"));
        }
        Outcome::Clean
    }
}
