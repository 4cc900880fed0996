//! `lss simulate`: the chain in motion, and what its sensor cart would bring home.

mod length;
mod progress;
pub mod report;

use super::{MessageFormat, Outcome, OutputFormat, could_not, read};
use crate::base::json;
use crate::chain_input::{ContactLaw, Simulation};
use crate::dynamics::{self, End, Method, Plan, Width, parameters};
use crate::effects;
use crate::emit::Files;
use crate::report::lap;
use crate::semantics::dimension::{Dimension, quantity};
use crate::semantics::given::GivenLet;
use crate::signal::{csv, parquet};
use clap::ValueEnum;
use std::path::PathBuf;
use std::time::Instant;

/// Simulate the chain of carts and record what a sensor cart would measure.
///
/// FILE is a layout, which is built first, or the simulation.json of one. Writes run-01.csv and run-01.toml, the
/// simulation.json that was run, and lap.html. An interrupted or troubled run keeps what it recorded.
#[derive(Debug, clap::Args)]
pub struct Simulate {
    /// A layout, .lss, or a simulation input, .json.
    file: PathBuf,
    /// Folder for the outputs; created if it is missing.
    #[arg(short, long, value_name = "DIR", required_unless_present = "list_parameters")]
    output: Option<PathBuf>,
    /// Which layout, when the file has several.
    #[arg(long, value_name = "NAME")]
    layout: Option<String>,
    /// Give a `let` of the layout another value: --let aisle=3m. May be repeated.
    #[arg(long = "let", value_name = "NAME=VALUE", value_parser = read::given_let)]
    lets: Vec<GivenLet>,
    /// Laps of the sensor cart to record.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..=10_000))]
    laps: u64,
    /// Time before recording: 30s.
    #[arg(long, value_name = "TIME", default_value = "30s", value_parser = amount::<'s'>)]
    settle: f64,
    /// Speed of the chain: 2.0m/s.
    #[arg(long, value_name = "SPEED", value_parser = amount::<'v'>)]
    speed: Option<f64>,
    /// Tension of the chain on its centre line: 500N.
    #[arg(long, value_name = "FORCE", allow_hyphen_values = true, value_parser = amount::<'N'>)]
    tension: Option<f64>,
    /// Damping law of every contact.
    #[arg(long, value_enum, value_name = "NAME")]
    law: Option<ContactLaw>,
    /// Largest time step: 0.5ms. As the joints' damping bounds it when not given.
    #[arg(long, value_name = "TIME", value_parser = amount::<'s'>)]
    step: Option<f64>,
    /// Time integration.
    #[arg(long, value_enum, value_name = "NAME", default_value_t)]
    integrator: Method,
    /// Number of the cart that carries the sensors.
    #[arg(long, value_name = "K")]
    sensor_cart: Option<usize>,
    /// Add what each of the track's supports carries to lap.html.
    #[arg(long)]
    supports: bool,
    /// Set any number of the model, in SI units: --set cart.mass_kg=45. May be repeated.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = assignment)]
    sets: Vec<(String, String)>,
    /// Print every parameter that --set knows, with its value, instead of simulating.
    #[arg(long)]
    list_parameters: bool,
    /// Format of the run's data file.
    #[arg(long, value_enum, default_value_t)]
    run_format: RunFormat,
    /// How the summary is written to standard output.
    #[arg(long, value_enum, default_value_t)]
    format: OutputFormat,
    /// How diagnostics are written to standard error.
    #[arg(long, value_enum, default_value_t)]
    message_format: MessageFormat,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum)]
enum RunFormat {
    #[default]
    Csv,
    Parquet,
}

impl Simulate {
    pub fn run(&self) -> Outcome {
        let simulation =
            match read::simulation_with(&self.file, self.layout.as_deref(), &self.lets, self.message_format)
                .and_then(|input| self.changed(&input))
            {
                Ok(simulation) => simulation,
                Err(outcome) => return outcome,
            };
        if self.list_parameters {
            super::report::print(&report::parameters(&simulation));
            return Outcome::Clean;
        }
        let plan = Plan {
            laps: self.laps as usize,
            settle: self.settle,
            step: self.step,
            method: self.integrator,
            supports: self.supports,
            ..Plan::default()
        };
        let watch = progress::Watch::new();
        let clock = Instant::now();
        let result = effects::simulate(&simulation, &plan, Width::used(), &mut |p| watch.show(p));
        watch.finish();
        let wall = clock.elapsed().as_secs_f64();
        let outcome = match result {
            Ok(outcome) => outcome,
            Err(unfit) => {
                super::report::error(&format!("{unfit}"));
                return Outcome::Problems;
            }
        };
        if let (Some(folder), false) = (&self.output, outcome.run.time.is_empty()) {
            let files = match self.files(&simulation, &outcome) {
                Ok(files) => files,
                Err(why) => return could_not("write", folder, why),
            };
            if let Err(error) = files.write_set(folder, "simulate") {
                return could_not("write", &error.path, &error.reason);
            }
        }
        super::report::print(&match self.format {
            OutputFormat::Json => report::json(&simulation, &outcome, wall),
            OutputFormat::Text => report::text(&simulation, &outcome, wall, self.output.as_deref()),
        });
        match &outcome.end {
            End::Complete => Outcome::Clean,
            End::Interrupted => {
                super::report::warning(&format!(
                    "interrupted after {:.2} s; what was recorded is kept",
                    outcome.simulated
                ));
                Outcome::Problems
            }
            End::Trouble(trouble) => {
                let kept = outcome.run.time.len();
                super::report::error(&format!("the simulation stopped: {trouble}"));
                super::report::note(&format!("  help: {}", trouble.advice()));
                super::report::note(&format!("  {kept} samples recorded before are kept"));
                Outcome::Problems
            }
        }
    }

    /// The input with what the command line sets.
    fn changed(&self, input: &Simulation) -> Result<Simulation, Outcome> {
        let mut sets = Vec::new();
        let mut also = |name: &str, value: Option<String>| sets.extend(value.map(|v| (name.to_owned(), v)));
        also("chain.speed_m_s", self.speed.map(|x| x.to_string()));
        also("chain.tension_n", self.tension.map(|x| x.to_string()));
        also("sensor.cart", self.sensor_cart.map(|x| x.to_string()));
        sets.extend(self.sets.iter().cloned());
        let mut changed = parameters::set(input, &sets).map_err(|unset| {
            super::report::error(&format!("--set {unset}\n  help: --list-parameters lists all with their values"));
            Outcome::CouldNotRun
        })?;
        if let Some(law) = self.law {
            changed.contact_law = law;
        }
        Ok(changed)
    }

    fn files(&self, simulation: &Simulation, outcome: &dynamics::Outcome) -> Result<Files, String> {
        let mut files = Files::default();
        let (name, bytes) = match self.run_format {
            RunFormat::Csv => ("run-01.csv", csv::write(&outcome.run)),
            RunFormat::Parquet => ("run-01.parquet", parquet::write(&outcome.run).map_err(|why| why.to_string())?),
        };
        files.push(name, bytes);
        files.push("run-01.toml", outcome.run.sidecar.write());
        files.push("simulation.json", json::to_json(simulation));
        files.push("lap.html", lap::page(simulation, &outcome.run, &outcome.supports));
        Ok(files)
    }
}

/// A number with an optional unit of the language: of time (`s`), speed (`v`) or force (`N`), to SI.
fn amount<const KIND: char>(text: &str) -> Result<f64, String> {
    let (asked, example) = match KIND {
        's' => (Dimension::TIME, "30s"),
        'v' => (Dimension::SPEED, "2.0m/s"),
        _ => (Dimension::FORCE, "500N"),
    };
    // What a keyboard has for a unit of the language.
    let micro = text.trim().strip_suffix("us").filter(|_| KIND == 's').map(|digits| format!("{digits}µs"));
    let least = if KIND == 'N' { f64::NEG_INFINITY } else { 0.0 };
    match quantity(micro.as_deref().unwrap_or(text)) {
        Some((value, dimension)) if value >= least && (dimension == asked || dimension == Dimension::NONE) => Ok(value),
        _ => Err(format!("{text} is not a quantity such as {example}")),
    }
}

/// `key=value`
fn assignment(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) if !key.trim().is_empty() && !value.trim().is_empty() => {
            Ok((key.trim().to_owned(), value.trim().to_owned()))
        }
        _ => Err(format!("{text} is not KEY=VALUE, such as cart.mass_kg=45")),
    }
}
