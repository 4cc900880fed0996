//! `lss capacity`: how many items an hour a sorter takes.

use super::{MessageFormat, Outcome, OutputFormat, could_not, limits, read, report};
use crate::base::json::to_json;
use crate::base::number::{duration, fixed};
use crate::capacity::explore::{by_inductions, by_speed};
use crate::capacity::{Bound, Mean, Measured, Settings, Sorter, bound, limit_words, measure};
use crate::chain_input::Simulation;
use crate::emit::Files;
use crate::report::capacity::{self as page, CapacityPage};
use serde::Serialize;
use std::fmt::Write;
use std::path::PathBuf;

/// Work out and simulate how many items an hour a layout's sorter takes.
///
/// The closed form says what is used up first: carriers on a stretch, an induction, or a chute. The simulation moves
/// carrier by carrier, with items at random, readings that fail, chutes that are full and stops, as far as the layout says
/// so; its warm-up is found, and means come with intervals of 95 % from replications. With --output it writes
/// capacity.json and capacity.html.
#[derive(Debug, clap::Args)]
pub struct Capacity {
    /// Layout file.
    file: PathBuf,
    /// Which layout, when the file has several.
    #[arg(long, value_name = "NAME")]
    layout: Option<String>,
    /// Simulated hours of each replication.
    #[arg(long, value_name = "H", default_value_t = 8.0, value_parser = hours)]
    hours: f64,
    /// Replications, from the same number on other random items.
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u32).range(2..=10_000))]
    replications: u32,
    /// The same seed gives the same items, to whatever layout they come.
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
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

/// Speeds that the page has a curve over, as shares of the layout's.
const SPEEDS: [f64; 8] = [0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.3];

/// Words of `--hours`.
fn hours(text: &str) -> Result<f64, String> {
    let value = text.parse().ok().filter(|hours: &f64| (0.2..=10_000.0).contains(hours));
    value.ok_or_else(|| format!("{text} is not a number of hours from 0.2 to 10000"))
}

impl Capacity {
    pub fn run(&self) -> Outcome {
        let compiled = match read::built(&self.file, self.layout.as_deref(), self.message_format) {
            Ok(compiled) => compiled,
            Err(outcome) => return outcome,
        };
        let Some(sorter) = compiled.sorter() else {
            report::error("a capacity needs carts that close the loop, an induction and chutes in the layout");
            return Outcome::Problems;
        };
        let Some(bound) = bound(&sorter, &sorter.proportions()) else {
            report::error("no items come to this layout's inductions");
            return Outcome::Problems;
        };
        let settings = Settings {
            hours: self.hours,
            replications: self.replications as usize,
            seed: self.seed,
            threads: limits::threads(),
        };
        let fed = sorter.inductions.iter().any(|i| i.demand.is_some()).then(|| measure(&sorter, &settings));
        let always = measure(&sorter.always_fed(), &settings);
        let required = compiled.layout.capacity.required.as_ref().map(|required| required.least.value);
        let measured = (fed.as_ref(), &always);
        let found = Found::new(&compiled.layout.name, &sorter, &bound, required, measured, &settings);
        if let Some(folder) = &self.output {
            let mut files = Files::default();
            files.push("capacity.json", to_json(&found));
            let simulation = Simulation::new(&compiled);
            let page = CapacityPage {
                layout: &compiled.layout.name,
                track: &simulation.track,
                sorter: &sorter,
                bound: &bound,
                required,
                always: &always,
                fed: fed.as_ref(),
                by_speed: &by_speed(&sorter, &SPEEDS, &settings),
                by_inductions: &by_inductions(&sorter, &settings),
            };
            files.push("capacity.html", page::page(&page));
            if let Err(error) = files.write_set(folder, "capacity") {
                return could_not("write", &error.path, &error.reason);
            }
        }
        report::print(&match self.format {
            OutputFormat::Json => serde_json::to_string(&found).unwrap_or_default() + "\n",
            OutputFormat::Text => found.text() + &report::written_to(self.output.as_deref()),
        });
        let Mean { value, half_width } = always.throughput;
        let short = required.is_some_and(|required| value + half_width < required);
        if short {
            report::warning("the simulation does not reach the capacity that the layout requires");
        }
        if compiled.short_of_capacity().is_some() || short { Outcome::Problems } else { Outcome::Clean }
    }
}

/// What was found, as in `capacity.json`.
#[derive(Serialize)]
struct Found<'a> {
    layout: &'a str,
    carriers: usize,
    /// m
    pitch_m: f64,
    speed_m_s: f64,
    carriers_per_hour: f64,
    /// Closed form, in the proportions in which items come.
    bound_per_hour: f64,
    limited_by: String,
    required_per_hour: Option<f64>,
    hours: f64,
    replications: usize,
    seed: u64,
    /// With items at every induction at any time.
    always_fed: Simulated<'a>,
    /// With the items that the layout says come; absent where it says nothing.
    #[serde(skip_serializing_if = "Option::is_none")]
    as_fed: Option<Simulated<'a>>,
}

/// What replications showed.
#[derive(Serialize)]
struct Simulated<'a> {
    per_hour: Mean,
    warm_up_s: f64,
    time_on_sorter_s: Mean,
    /// Laps in vain an item.
    unread: f64,
    refused: f64,
    misplaced: f64,
    inductions: Vec<InductionRow<'a>>,
    chutes: Vec<ChuteRow<'a>>,
}

#[derive(Serialize)]
struct InductionRow<'a> {
    name: &'a str,
    s_m: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    comes_per_hour: Option<f64>,
    per_hour: f64,
    waits_s: f64,
    /// Items that wait at the end.
    queue: f64,
    /// Carriers in use before and behind it.
    used_before: f64,
    used_behind: f64,
}

#[derive(Serialize)]
struct ChuteRow<'a> {
    name: &'a str,
    s_m: f64,
    per_hour: f64,
    /// Share of the items that came and found it full.
    refused: f64,
}

impl<'a> Simulated<'a> {
    fn new(sorter: &'a Sorter, measured: &Measured) -> Self {
        let inductions = sorter.inductions.iter().enumerate().map(|(i, induction)| InductionRow {
            name: &induction.name,
            s_m: induction.s,
            comes_per_hour: induction.demand,
            per_hour: measured.inductions[i].0,
            waits_s: measured.inductions[i].1,
            queue: measured.queues[i],
            used_before: measured.used[i].0,
            used_behind: measured.used[i].1,
        });
        let chutes = sorter.chutes.iter().zip(&measured.chutes).map(|(chute, (per_hour, refused))| ChuteRow {
            name: &chute.name,
            s_m: chute.s,
            per_hour: *per_hour,
            refused: *refused,
        });
        Simulated {
            per_hour: measured.throughput,
            warm_up_s: measured.warm_up,
            time_on_sorter_s: measured.time,
            unread: measured.unread,
            refused: measured.refused,
            misplaced: measured.misplaced,
            inductions: inductions.collect(),
            chutes: chutes.collect(),
        }
    }

    fn text(&self, how: &str, found: &Found) -> String {
        let Mean { value, half_width } = self.per_hour;
        let mut out = format!(
            "  simulated, {how}: {} ± {} items an hour (95 %, {} × {} h, the first {} left out)\n",
            fixed(value, 0),
            fixed(half_width, 0),
            found.replications,
            found.hours,
            duration(self.warm_up_s)
        );
        let _ = writeln!(
            out,
            "    {} s from coming to being given out; laps in vain an item: {} unread, {} refused; {} % given out elsewhere",
            fixed(self.time_on_sorter_s.value, 1),
            fixed(self.unread, 3),
            fixed(self.refused, 3),
            fixed(100.0 * self.misplaced, 2)
        );
        for row in &self.inductions {
            let waits = match row.comes_per_hour {
                Some(comes) if row.queue > 5.0 && row.queue > 0.01 * comes * found.hours => {
                    format!(
                        ", {} wait at the end: it does not keep up with {} an hour",
                        fixed(row.queue, 0),
                        fixed(comes, 0)
                    )
                }
                Some(_) => format!(", items wait {} s", fixed(row.waits_s, 1)),
                None => String::new(),
            };
            let _ = writeln!(
                out,
                "    induction {}: {} an hour{waits}; carriers in use {} % before it, {} % behind",
                row.name,
                fixed(row.per_hour, 0),
                fixed(100.0 * row.used_before, 0),
                fixed(100.0 * row.used_behind, 0)
            );
        }
        let mut full: Vec<&ChuteRow> = self.chutes.iter().filter(|chute| chute.refused > 0.005).collect();
        full.sort_by(|a, b| b.refused.total_cmp(&a.refused));
        for chute in full.iter().take(5) {
            let share = fixed(100.0 * chute.refused, 1);
            let _ = writeln!(out, "    chute {} is full for {share} % of its items", chute.name);
        }
        if full.len() > 5 {
            let _ = writeln!(out, "    and {} more chutes", full.len() - 5);
        }
        out
    }
}

impl<'a> Found<'a> {
    fn new(
        layout: &'a str,
        sorter: &'a Sorter,
        bound: &Bound,
        required: Option<f64>,
        (fed, always): (Option<&Measured>, &Measured),
        settings: &Settings,
    ) -> Self {
        let mut always_fed = Simulated::new(sorter, always);
        // Nobody waits where there always is an item.
        always_fed.inductions.iter_mut().for_each(|row| row.comes_per_hour = None);
        Found {
            layout,
            carriers: sorter.carriers,
            pitch_m: sorter.pitch,
            speed_m_s: sorter.speed,
            carriers_per_hour: sorter.carriers_per_hour(),
            bound_per_hour: bound.throughput,
            limited_by: limit_words(sorter, bound.limit),
            required_per_hour: required,
            hours: settings.hours,
            replications: settings.replications,
            seed: settings.seed,
            always_fed,
            as_fed: fed.map(|fed| Simulated::new(sorter, fed)),
        }
    }

    fn text(&self) -> String {
        let mut out = format!(
            "{}\n  {} carriers at {} m/s: {} an hour pass a place\n  closed form: at most {} items an hour, limited by {}\n",
            self.layout,
            self.carriers,
            self.speed_m_s,
            fixed(self.carriers_per_hour, 0),
            fixed(self.bound_per_hour, 0),
            self.limited_by
        );
        if let Some(fed) = &self.as_fed {
            let comes: f64 = fed.inductions.iter().filter_map(|row| row.comes_per_hour).sum();
            out += &fed.text(&format!("with the {} an hour that come", fixed(comes, 0)), self);
        }
        out += &self.always_fed.text("with items at every induction at any time", self);
        out
    }
}
