//! `lss runs`: a campaign at a glance.

mod table;

use super::{MessageFormat, Outcome, OutputFormat, could_not, read, report};
use crate::base::number::{fixed, trimmed};
use crate::chain_input::Simulation;
use crate::emit::Files;
use crate::identify::cases::named_layout;
use crate::report::campaign as pages;
use crate::signal::health::{Health, health};
use crate::signal::measures::Statistics;
use crate::signal::{Campaign, Entry, Run, RunError};
use crate::source::shown;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Show a campaign of runs at a glance: laps, lost samples, levels, speeds, and channels that look wrong.
///
/// FOLDER holds a campaign.toml, or data files with their sidecars. Laps, speeds and sides need the layout of a run:
/// its simulation.json is read, its .lss is built. A run that cannot be read does not hide the others; the exit code is
/// 1 then.
#[derive(Debug, clap::Args)]
pub struct Runs {
    /// Folder of a campaign, its campaign.toml, or a single data file.
    folder: PathBuf,
    /// Layout of all runs, .lss or simulation.json, instead of those that campaign and sidecars name.
    #[arg(long, value_name = "FILE")]
    layout: Option<PathBuf>,
    /// Folder for runs.html: levels of every run, and all runs along the track; created if it is missing.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// How the runs are written to standard output.
    #[arg(long, value_enum, default_value_t)]
    format: OutputFormat,
}

/// The campaign in JSON.
#[derive(Serialize)]
struct Report {
    runs: Vec<Glance>,
    refused: Vec<Refused>,
}

/// A run at a glance.
#[derive(Serialize)]
struct Glance {
    name: String,
    file: String,
    layout: String,
    samples: usize,
    rate_hz: f64,
    duration_s: f64,
    laps: Option<f64>,
    edges: usize,
    lost: usize,
    bridged: usize,
    masked: usize,
    speed_trigger: Option<f64>,
    speed_wheels: Option<f64>,
    channels: BTreeMap<&'static str, Level>,
    warnings: Vec<String>,
}

#[derive(Serialize)]
struct Level {
    mean: f64,
    sd: f64,
    min: f64,
    max: f64,
}

/// A run that cannot be read.
#[derive(Serialize)]
struct Refused {
    name: String,
    file: String,
    error: String,
}

impl Runs {
    pub fn run(&self) -> Outcome {
        let (campaign, refused) = match Campaign::read_each(&self.folder) {
            Ok(found) => found,
            Err(error) => {
                report::error(&error.to_string());
                return if error.is_unreadable() { Outcome::CouldNotRun } else { Outcome::Problems };
            }
        };
        let mut refused: Vec<Refused> = refused.iter().map(|r| Refused::new(&r.name, &r.file, &r.error)).collect();
        let (mut runs, mut pictured) = (Vec::new(), Vec::new());
        let mut layouts = Layouts::default();
        for entry in &campaign.runs {
            match entry.run() {
                Ok(run) => {
                    let path = self.layout.as_deref().unwrap_or(&entry.layout);
                    let (layout, trouble) = layouts.get(path, self.layout.is_none().then_some(entry));
                    let mut health = health(&run, layout);
                    health.lacks.extend(trouble);
                    if self.output.is_some() {
                        pictured.push(picture(entry, &run, layout, &health, campaign.runs.len()));
                    }
                    runs.push(Glance::new(entry, path, health));
                }
                Err(error) => refused.push(Refused::new(&entry.name, &entry.file, &error)),
            }
        }
        for refused in &refused {
            report::error(&refused.error);
        }
        let outcome = if refused.is_empty() && !layouts.broken { Outcome::Clean } else { Outcome::Problems };
        if let Some(folder) = &self.output {
            let refused: Vec<(String, String)> = refused.iter().map(|r| (r.name.clone(), r.error.clone())).collect();
            let title = self.folder.file_name().map_or_else(|| "runs".into(), |n| n.to_string_lossy().into_owned());
            let mut files = Files::default();
            files.push("runs.html", pages::page(&title, &pictured, &refused));
            if let Err(error) = files.write_set(folder, "runs") {
                return could_not("write", &error.path, &error.reason);
            }
        }
        let report = Report { runs, refused };
        report::print(&match self.format {
            OutputFormat::Text => table::text(&report) + &report::written_to(self.output.as_deref()),
            OutputFormat::Json => serde_json::to_string(&report).unwrap_or_default() + "\n",
        });
        outcome
    }
}

/// What the page shows of a run.
fn picture(entry: &Entry, run: &Run, layout: Option<&Simulation>, health: &Health, runs: usize) -> pages::Glance {
    let lap = layout.map_or(0.0, |layout| layout.chain.track_length_m);
    let laps = health.laps.map_or_else(String::new, |laps| format!(", {} laps", fixed(laps, 2)));
    let speed = health.speed_trigger.map_or_else(String::new, |v| format!(", {} m/s", fixed(v, 3)));
    pages::Glance {
        name: entry.name.clone(),
        about: format!("{} s at {} Hz{laps}{speed}", fixed(health.duration, 1), trimmed(health.rate, 2)),
        tension: entry.tension.or(run.sidecar.tension_setpoint),
        speed: health.speed_trigger.or(Some(run.sidecar.speed_setpoint)).filter(|speed| *speed > 0.0),
        channels: health.channels.clone(),
        along: pages::along(run, lap, runs),
        lap,
        warnings: health.warnings(),
    }
}

/// The layouts that were read, each once.
#[derive(Default)]
struct Layouts {
    read: BTreeMap<PathBuf, Result<Simulation, String>>,
    /// Whether one that is there is wrong.
    broken: bool,
}

impl Layouts {
    /// The layout at a path, or what cannot be told without it. It is confined to the root of the run that names it.
    fn get(&mut self, path: &Path, named_by: Option<&Entry>) -> (Option<&Simulation>, Option<String>) {
        if !self.read.contains_key(path) {
            let place = match named_by {
                Some(entry) => named_layout(entry),
                None if path.is_file() => Ok(path.to_owned()),
                None => Err(format!("the layout {} is not there", shown(path))),
            };
            let read = place.and_then(|path| {
                read::simulation(&path, None, MessageFormat::Text).map_err(|_| {
                    self.broken = true;
                    format!("the layout {} cannot be used", shown(&path))
                })
            });
            self.read.insert(path.to_owned(), read);
        }
        match self.read.get(path) {
            Some(Ok(layout)) => (Some(layout), None),
            Some(Err(why)) => {
                (None, Some(format!("{why}: laps, speeds and sides cannot be told; give it with --layout")))
            }
            None => (None, None),
        }
    }
}

impl Glance {
    fn new(entry: &Entry, layout: &Path, health: Health) -> Self {
        Glance {
            name: entry.name.clone(),
            file: entry.file.display().to_string(),
            layout: layout.display().to_string(),
            samples: health.samples,
            rate_hz: health.rate,
            duration_s: health.duration,
            laps: health.laps,
            edges: health.edges,
            lost: health.lost,
            bridged: health.bridged,
            masked: health.masked,
            speed_trigger: health.speed_trigger,
            speed_wheels: health.speed_wheels,
            channels: health.channels.iter().map(|(c, level)| (c.name(), Level::new(level))).collect(),
            warnings: health.warnings(),
        }
    }
}

impl Level {
    fn new(of: &Statistics) -> Self {
        Level { mean: of.mean, sd: of.sd, min: of.min, max: of.max }
    }
}

impl Refused {
    fn new(name: &str, file: &Path, error: &RunError) -> Self {
        Refused { name: name.to_owned(), file: file.display().to_string(), error: error.to_string() }
    }
}
