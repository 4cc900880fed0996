//! `lss capacity`: how many items an hour a sorter takes.

use super::{MessageFormat, Outcome, OutputFormat, could_not, limits, read, report};
use crate::base::json::to_json;
use crate::base::number::{duration, trimmed};
use crate::base::stop::Stop;
use crate::capacity::explore::{Cost, by_inductions, by_speed, costs};
use crate::capacity::{Bounds, Mean, Measured, Settings, Sorter, measure};
use crate::chain_input::Simulation;
use crate::compiled::Compiled;
use crate::emit::Files;
use crate::report::capacity::{self as page, CapacityPage, Found};
use std::path::PathBuf;

/// Work out and simulate how many items an hour a layout's sorter takes.
///
/// The closed form says what is used up first: carriers on a stretch, an induction, or a chute. The simulation moves
/// carrier by carrier, with items at random, readings that fail, chutes that are full, failures, waves and stops, as far
/// as the layout says so; its warm-up is found, and means come with intervals of 95 % from replications. With --output it writes
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

/// What is worked out of a layout's sorter.
pub struct Worked {
    layout: String,
    sorter: Sorter,
    bounds: Bounds,
    required: Option<f64>,
    settings: Settings,
    /// With items at every induction at any time.
    always: Measured,
    /// With the items that the layout says come.
    fed: Option<Measured>,
    costs: Vec<Cost>,
}

impl Worked {
    /// # Errors
    ///
    /// In words, where the layout is no sorter, or too little is simulated of its waves.
    pub fn new(compiled: &Compiled, settings: Settings) -> Result<Worked, String> {
        let Some(sorter) = compiled.sorter() else {
            return Err("a capacity needs carts that close the loop, an induction and chutes in the layout".to_owned());
        };
        let Some(bounds) = Bounds::of(&sorter) else {
            return Err("no items come to this layout's inductions".to_owned());
        };
        if let Some(waves) = &sorter.waves {
            let least = 2.0 * waves.cycle() / 3600.0;
            if settings.hours < least {
                return Err(format!(
                    "{} hours are too few: the waves repeat after {}, and means are of whole cycles behind the first; simulate \
                     {} hours or more",
                    settings.hours,
                    duration(waves.cycle()),
                    trimmed((least * 100.0).ceil() / 100.0, 2)
                ));
            }
        }
        let stop = settings.stop;
        let fed = sorter.inductions.iter().any(|i| i.demand.is_some()).then(|| measure(&sorter, &settings));
        let always = measure(&sorter.always_fed(), &settings);
        let costs = costs(&sorter, &always, &settings);
        if stop.now() {
            return Err("it was stopped before all was simulated".to_owned());
        }
        let required = compiled.layout.capacity.required.as_ref().map(|required| required.least.value);
        let layout = compiled.layout.name.clone();
        Ok(Worked { layout, sorter, bounds, required, settings, always, fed, costs })
    }

    /// As `capacity.json` has it.
    pub fn found(&self) -> Found<'_> {
        let measured = (self.fed.as_ref(), &self.always);
        Found::new(&self.layout, &self.sorter, &self.bounds, self.required, measured, &self.costs, &self.settings)
    }

    /// `capacity.html` of the layout, for which other speeds and fewer inductions are simulated.
    pub fn page(&self, compiled: &Compiled, stop: Stop) -> String {
        let (sorter, settings) = (&self.sorter, &Settings { stop, ..self.settings });
        page::page(&CapacityPage {
            layout: &self.layout,
            track: &Simulation::new(compiled).track,
            sorter,
            bounds: &self.bounds,
            required: self.required,
            always: &self.always,
            fed: self.fed.as_ref(),
            costs: &self.costs,
            by_speed: &by_speed(sorter, &SPEEDS, settings),
            by_inductions: &by_inductions(sorter, settings),
        })
    }

    /// Whether the simulation surely does not reach what is required.
    fn short(&self) -> bool {
        let Mean { value, half_width } = self.always.throughput;
        self.required.is_some_and(|required| value + half_width < required)
    }
}

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
        let settings = Settings {
            hours: self.hours,
            replications: self.replications as usize,
            seed: self.seed,
            threads: limits::threads(),
            stop: Stop::NEVER,
        };
        let worked = match Worked::new(&compiled, settings) {
            Ok(worked) => worked,
            Err(why) => {
                report::error(&why);
                return Outcome::Problems;
            }
        };
        let found = worked.found();
        if let Some(folder) = &self.output {
            let mut files = Files::default();
            files.push("capacity.json", to_json(&found));
            files.push("capacity.html", worked.page(&compiled, Stop::NEVER));
            if let Err(error) = files.write_set(folder, "capacity") {
                return could_not("write", &error.path, &error.reason);
            }
        }
        report::print(&match self.format {
            OutputFormat::Json => serde_json::to_string(&found).unwrap_or_default() + "\n",
            OutputFormat::Text => found.text() + &report::written_to(self.output.as_deref()),
        });
        let short = worked.short();
        if short {
            report::warning("the simulation does not reach the capacity that the layout requires");
        }
        if compiled.short_of_capacity().is_some() || short { Outcome::Problems } else { Outcome::Clean }
    }
}
