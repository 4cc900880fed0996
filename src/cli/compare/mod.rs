//! `lss compare`: the measures between two runs.

mod scale;
mod table;

use super::{Outcome, OutputFormat, build, could_not, report};
use crate::base::number::trimmed;
use crate::emit::Files;
use crate::report::comparison::{self, Compared};
use crate::signal::compare::{Deviation, compare};
use crate::signal::measures::Statistics;
use crate::signal::{Channel, Entry, Run};
use crate::source::shown;
use scale::Known;
pub use scale::simulation_of;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// Compare two runs, measured or simulated, channel by channel.
///
/// Lap length and cart pitch come from --lap and --pitch, else from the layout that --layout, the campaign.toml beside a
/// run or its sidecar names, else the lap from the trigger's lap time and the nominal speed. Two replicate simulations of
/// the same lap differ by 0.5 to 3 % (NRMSD), and by 0.0 to 0.3 % in the mean over two carts.
#[derive(Debug, clap::Args)]
pub struct Compare {
    /// The reference: a data file, .csv, .parquet or .mf4, with its sidecar .toml beside it.
    run_a: PathBuf,
    /// The run that is compared with it.
    run_b: PathBuf,
    /// Layout of both runs, .lss or simulation.json, instead of those that campaign and sidecars name.
    #[arg(long, value_name = "FILE")]
    layout: Option<PathBuf>,
    /// Length of a lap: 214m.
    #[arg(long, value_name = "LENGTH", value_parser = length)]
    lap: Option<f64>,
    /// Distance between the joints of a cart: 1250mm.
    #[arg(long, value_name = "LENGTH", value_parser = length)]
    pitch: Option<f64>,
    /// Slope m of the S-N curve for the damage-equivalent load: 3 for welds, 5 for aluminium, 10 for polymers.
    #[arg(long, value_name = "M", default_value_t = 3.0, value_parser = slope)]
    slope: f64,
    /// Folder for compare.html: both runs along the track, their spectra and how far they are apart; created if it is missing.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// How the measures are written to standard output.
    #[arg(long, value_enum, default_value_t)]
    format: OutputFormat,
}

/// The measures in JSON.
#[derive(Serialize)]
struct Report<'a> {
    reference: Side<'a>,
    other: Side<'a>,
    lap_m: Option<f64>,
    lap_from: Option<&'a str>,
    pitch_m: Option<f64>,
    pitch_from: Option<&'a str>,
    slope: f64,
    channels: BTreeMap<&'static str, Measures>,
}

/// One of the two runs.
#[derive(Serialize)]
struct Side<'a> {
    file: &'a str,
    samples: usize,
    duration_s: f64,
    rate_hz: f64,
    /// Laps that the run covers.
    laps: Option<f64>,
}

#[derive(Serialize)]
struct Measures {
    unit: &'static str,
    reference: Moments,
    other: Moments,
    nrmsd: Option<f64>,
    nrmsd_two_carts: Option<f64>,
    spectral_distance_db: Option<f64>,
    damage_ratio: Option<f64>,
    filled: [usize; 2],
    masked: [usize; 2],
}

#[derive(Serialize)]
struct Moments {
    mean: f64,
    sd: f64,
    min: f64,
    max: f64,
}

impl Compare {
    pub fn run(&self) -> Outcome {
        let ((entry_a, a), (entry_b, b)) = match (Entry::read(&self.run_a), Entry::read(&self.run_b)) {
            (Ok(a), Ok(b)) => (a, b),
            (a, b) => {
                let errors: Vec<_> = [a, b].into_iter().filter_map(Result::err).collect();
                errors.iter().for_each(|e| report::error(&e.to_string()));
                let unreadable = errors.iter().any(|e| e.is_unreadable());
                return if unreadable { Outcome::CouldNotRun } else { Outcome::Problems };
            }
        };
        let entries = [(&entry_a, &a), (&entry_b, &b)];
        let known = match Known::new(self.lap, self.pitch, self.layout.as_deref(), &entries) {
            Ok(known) => known,
            Err(outcome) => return outcome,
        };
        known.warnings.iter().for_each(|w| report::warning(w));
        if let Some(differ) = set_points([(&entry_a, &a), (&entry_b, &b)]) {
            report::warning(&differ);
        }
        for (path, run) in [(self.run_a.as_path(), &a), (self.run_b.as_path(), &b)] {
            for warning in run.warnings(known.lap()) {
                report::warning(&format!("{}: {warning}", shown(path)));
            }
        }
        let channels = compare(&a, &b, &known.scale(self.slope));
        if channels.is_empty() {
            report::error("the runs have no channel in common that holds a sample");
            return Outcome::Problems;
        }
        let names = [self.run_a.to_string_lossy(), self.run_b.to_string_lossy()];
        let report = Report::new([(&names[0], &a), (&names[1], &b)], &known, self.slope, &channels);
        if let Some(folder) = &self.output {
            let compared = Compared {
                names: [&names[0], &names[1]],
                runs: [&a, &b],
                channels: &channels,
                lap: known.lap(),
                pitch: known.pitch.as_ref().map(|p| p.0),
                simulation: known.simulation.as_ref(),
            };
            let mut files = Files::default();
            files.push("compare.html", comparison::page(&compared));
            if let Err(error) = files.write_set(folder, "compare") {
                return could_not("write", &error.path, &error.reason);
            }
        }
        report::print(&match self.format {
            OutputFormat::Text => table::text(&report) + &report::written_to(self.output.as_deref()),
            OutputFormat::Json => serde_json::to_string(&report).unwrap_or_default() + "\n",
        });
        Outcome::Clean
    }
}

impl<'a> Report<'a> {
    fn new(sides: [(&'a str, &Run); 2], known: &'a Known, slope: f64, channels: &BTreeMap<Channel, Deviation>) -> Self {
        let [reference, other] = sides.map(|(file, run)| Side::new(file, run, known.lap()));
        Report {
            reference,
            other,
            lap_m: known.lap(),
            lap_from: known.lap.as_ref().map(|l| l.1.as_str()),
            pitch_m: known.pitch.as_ref().map(|p| p.0),
            pitch_from: known.pitch.as_ref().map(|p| p.1.as_str()),
            slope,
            channels: channels.iter().map(|(c, d)| (c.name(), Measures::new(*c, d))).collect(),
        }
    }
}

impl<'a> Side<'a> {
    fn new(file: &'a str, run: &Run, lap: Option<f64>) -> Self {
        Side {
            file,
            samples: run.time.len(),
            duration_s: run.duration(),
            rate_hz: run.rate(),
            laps: lap.and_then(|lap| crate::signal::position::position(run, lap)).map(|p| p.laps()),
        }
    }
}

impl Measures {
    fn new(channel: Channel, deviation: &Deviation) -> Self {
        Measures {
            unit: channel.unit(),
            reference: Moments::new(&deviation.reference),
            other: Moments::new(&deviation.other),
            nrmsd: deviation.nrmsd,
            nrmsd_two_carts: deviation.nrmsd_two_carts,
            spectral_distance_db: deviation.spectral_distance,
            damage_ratio: deviation.damage_ratio,
            filled: deviation.filled,
            masked: deviation.masked,
        }
    }
}

impl Moments {
    fn new(of: &Statistics) -> Self {
        Moments { mean: of.mean, sd: of.sd, min: of.min, max: of.max }
    }
}

/// That the runs were set to other speeds or tensions, which forces differ by.
fn set_points(sides: [(&Entry, &Run); 2]) -> Option<String> {
    let speeds = sides.map(|(entry, run)| Some(entry.speed.unwrap_or(run.sidecar.speed_setpoint)));
    let tensions = sides.map(|(entry, run)| entry.tension.or(run.sidecar.tension_setpoint));
    let differ = |[a, b]: [Option<f64>; 2], what: &str, unit: &str| {
        let (a, b) = a.zip(b)?;
        let far = (a - b).abs() > 5e-3 * a.abs().max(b.abs());
        far.then(|| format!("{what} {} and {} {unit}", trimmed(a, 3), trimmed(b, 3)))
    };
    let told = [differ(speeds, "speeds of", "m/s"), differ(tensions, "tensions of", "N")];
    let told: Vec<String> = told.into_iter().flatten().collect();
    (!told.is_empty()).then(|| format!("the runs were set to {}: forces differ with that", told.join(" and to ")))
}

/// A length above zero.
fn length(text: &str) -> Result<f64, String> {
    build::length(text).and_then(|m| if m > 0.0 { Ok(m) } else { Err("it has to be longer than nothing".into()) })
}

fn slope(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(m) if m.is_finite() && m >= 1.0 => Ok(m),
        _ => Err("the slope of an S-N curve is a number from 1".into()),
    }
}
