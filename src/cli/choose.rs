//! `lss choose`: which carts, speed, motors and radii do what a layout requires for the least money.

use super::progress::Line;
use super::{MessageFormat, Outcome, OutputFormat, could_not, limits, read, report};
use crate::base::json::to_json;
use crate::choose::{self, Measure, Settings, Told, refused, write};
use crate::diagnostic::Diagnostic;
use crate::dynamics::Width;
use crate::emit::Files;
use crate::model::Layout;
use crate::report::choice::{self as page, Found};
use crate::semantics::given::GivenLet;
use crate::solve::{Options, unsupported};
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

/// Choose carts, speed, motors and radii that do what a layout requires, at the least price with energy.
///
/// `choose` lines of the layout say what is free. Every candidate is worked out: carts that close the loop, items an hour,
/// thrust to run, start and stop, motors and room for them, price and energy. Of the cheapest, the capacity that is required
/// is simulated, and forces in the dynamic model; where it takes too little, or its joints or wheels carry too much, the next
/// one is looked at. Prints the lines that say the choice; with --output it writes
/// choice.json, choice.html, candidates.csv, and the layout with the choice as layout.lss.
#[derive(Debug, clap::Args)]
pub struct Choose {
    /// Layout file.
    file: PathBuf,
    /// Which layout, when the file has several.
    #[arg(long, value_name = "NAME")]
    layout: Option<String>,
    /// Give a `let` of the layout another value: --let aisle=3m. May be repeated.
    #[arg(long = "let", value_name = "NAME=VALUE", value_parser = read::given_let)]
    lets: Vec<GivenLet>,
    /// Show the candidates that no other one beats in two or three measures: --pareto price,capacity.
    #[arg(long, value_enum, value_name = "MEASURES", value_delimiter = ',')]
    pareto: Vec<Measure>,
    /// Candidates that are checked in the dynamic model until one passes, at most, not counting those whose sensor alone
    /// measures too little; 0 leaves this check and that of the simulated capacity out.
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(0..=1000))]
    checks: u32,
    /// Search tracks no longer than this, all together: 30, 30s, 2min. What is not proven by then is the best that was
    /// found, and on another machine it may be another.
    #[arg(long, value_name = "TIME", value_parser = limits::time)]
    time_limit: Option<Duration>,
    /// Folder for the outputs; created if it is missing.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// How the result is written to standard output.
    #[arg(long, value_enum, default_value_t)]
    format: OutputFormat,
    /// How diagnostics are written to standard error.
    #[arg(long, value_enum, default_value_t)]
    message_format: MessageFormat,
}

impl Choose {
    pub fn run(&self) -> Outcome {
        if let Some(wrong) = Measure::wrong(&self.pareto).filter(|_| !self.pareto.is_empty()) {
            report::error(&wrong);
            return Outcome::CouldNotRun;
        }
        let read = match read::read_with(&self.file, self.layout.as_deref(), &self.lets, self.message_format) {
            Ok(read) => read,
            Err(outcome) => return outcome,
        };
        let (sources, layout, mut said) = (read.sources, read.layout, read.said);
        said.extend(unsupported(&layout));
        if said.iter().any(Diagnostic::is_error) {
            return read::tell(&sources, &said, self.message_format);
        }
        if lacks_energy(&layout, &self.pareto) {
            return Outcome::CouldNotRun;
        }
        let options = Options { threads: limits::threads(), stop: limits::stop(), ..Options::default() };
        let (checks, tracks_within) = (self.checks as usize, self.time_limit);
        let settings = Settings { options, width: Width::used(), checks, tracks_within };
        let line = Line::open(self.message_format);
        let (tracks, checks) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let one_more = |count: &AtomicUsize| count.fetch_add(1, Ordering::Relaxed) + 1;
        let chosen = choose::choose(&layout, &settings, &|told| match told {
            Told::Track => {
                let solved = one_more(&tracks);
                line.say(|| format!("{solved} tracks solved"));
            }
            Told::Capacity => line.say(|| "capacity of a candidate".to_owned()),
            Told::Check => {
                let check = one_more(&checks);
                line.say(|| format!("candidate {check} in the dynamic model"));
            }
        });
        line.finish();
        let chosen = match chosen {
            Ok(chosen) => chosen,
            Err(too_many) => {
                report::error(&too_many.to_string());
                return Outcome::Problems;
            }
        };
        said.extend(refused(&chosen));
        let trade = (!self.pareto.is_empty()).then(|| choose::undominated(&chosen, &self.pareto));
        let found = Found::new(&chosen, &self.pareto, trade.as_deref());
        if let Some(folder) = &self.output {
            let mut files = Files::default();
            files.push("choice.json", to_json(&found));
            match page::table(&chosen) {
                Ok(table) => files.push("candidates.csv", table),
                Err(why) => return could_not("write", folder, why),
            }
            let winner = chosen.winner.map(|k| &chosen.candidates[k]);
            if let Some(text) = winner.and_then(|candidate| write::text(&sources, &chosen, candidate)) {
                files.push("layout.lss", text);
            }
            files.push("choice.html", page::page(&chosen, &self.pareto, trade.as_deref()));
            if let Err(error) = files.write_set(folder, "choose") {
                return could_not("write", &error.path, &error.reason);
            }
        }
        report::print(&match self.format {
            OutputFormat::Json => serde_json::to_string(&found).unwrap_or_default() + "\n",
            OutputFormat::Text => found.text(&chosen) + &report::written_to(self.output.as_deref()),
        });
        read::tell(&sources, &said, self.message_format)
    }
}

/// Whether energy is asked for of a layout that does not say how long it runs, which is told.
pub(super) fn lacks_energy(layout: &Layout, measures: &[Measure]) -> bool {
    let lacks = measures.contains(&Measure::Energy) && layout.choice.energy.is_none();
    if lacks {
        report::error("--pareto energy needs to know how long the sorter runs");
        report::note("  help: say it with a line such as `energy 0.22 EUR/kWh for 6000 h per year over 10 years`");
    }
    lacks
}
