//! `lss polygon`: how evenly a layout lets its chain run, and why.

mod sweep;
mod verify;

use super::{MessageFormat, Outcome, OutputFormat, could_not, limits, read, report};
use crate::base::json;
use crate::chain_input::Simulation;
use crate::emit::{DrawError, Files, png, svg};
use crate::geometry::CentreLine;
use crate::kinematics::polygon::{PolygonObjective, Unsuited};
use crate::report::polygon;
use crate::report::polygon::{Names, PolygonReport};
use crate::source::shown;
use std::path::PathBuf;
use std::time::Duration;

/// Show the polygon action of a layout: how much its chain leads and lags on each straight, and which curves cancel.
///
/// FILE is a layout, which is built first, or the simulation.json of one. With --output it writes polygon.html, which
/// answers the hand, polygon.json, polygon.svg and polygon.png.
#[derive(Debug, clap::Args)]
pub struct Polygon {
    /// A layout, .lss, or a simulation input, .json.
    file: PathBuf,
    /// Folder for the outputs; created if it is missing.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Which layout, when the file has several.
    #[arg(long, value_name = "NAME")]
    layout: Option<String>,
    /// What counts: every straight from every start, those behind the first three curves, or the last cart.
    #[arg(long, value_enum, default_value_t)]
    objective: PolygonObjective,
    /// Try the product line's values of a parameter instead: cart.length, 500 to 1250 mm.
    #[arg(long, value_name = "PARAMETER", value_parser = ["cart.length"])]
    sweep: Option<String>,
    /// Optimise the layout for each objective instead, and run it before and after in the dynamic model.
    #[arg(long, conflicts_with_all = ["sweep", "objective"])]
    verify: bool,
    /// End searches after this time (30, 30s, 2min) with the best layout so far.
    #[arg(long, value_name = "TIME", value_parser = limits::time)]
    time_limit: Option<Duration>,
    /// How the result is written to standard output.
    #[arg(long, value_enum, default_value_t)]
    format: OutputFormat,
    /// How diagnostics are written to standard error.
    #[arg(long, value_enum, default_value_t)]
    message_format: MessageFormat,
}

/// A layout to look at.
struct Subject {
    name: String,
    simulation: Simulation,
    line: CentreLine,
    /// m
    pitch: f64,
    names: Names,
}

impl Polygon {
    pub fn run(&self) -> Outcome {
        limits::set_time(self.time_limit);
        if self.verify {
            return self.verify();
        }
        let subject = match self.subject() {
            Ok(subject) => subject,
            Err(outcome) => return outcome,
        };
        if self.sweep.is_some() {
            return self.sweep(&subject);
        }
        let found = PolygonReport::new(&subject.name, &subject.line, subject.pitch, self.objective, &subject.names);
        let report = match found {
            Ok(report) => report,
            Err(unsuited) => return self.unsuited(unsuited),
        };
        if let Some(folder) = &self.output {
            let files = match files(&report, &subject, self.objective) {
                Ok(files) => files,
                Err(why) => return could_not("draw", &self.file, why),
            };
            if let Err(error) = files.write_set(folder, "polygon") {
                return could_not("write", &error.path, &error.reason);
            }
        }
        report::print(&match self.format {
            OutputFormat::Json => report.short_json(),
            OutputFormat::Text => polygon::text(&report) + &report::written_to(self.output.as_deref()),
        });
        Outcome::Clean
    }

    fn subject(&self) -> Result<Subject, Outcome> {
        let name = self.layout.as_deref();
        let (simulation, names) = if read::is_json(&self.file) {
            (read::simulation(&self.file, name, self.message_format)?, Names::default())
        } else {
            let compiled = read::built(&self.file, name, self.message_format)?;
            (Simulation::new(&compiled), Names::of(&compiled))
        };
        let (line, pitch) = (simulation.track.centre_line(), simulation.chain.pitch_m);
        Ok(Subject { name: simulation.name.clone(), simulation, line, pitch, names })
    }

    fn unsuited(&self, why: Unsuited) -> Outcome {
        report::error(&format!("{}: {why}", shown(&self.file)));
        Outcome::Problems
    }
}

fn files(report: &PolygonReport, subject: &Subject, objective: PolygonObjective) -> Result<Files, DrawError> {
    let line = &subject.line;
    let mut files = Files::default();
    files.push("polygon.html", polygon::page(report, &subject.simulation, objective));
    files.push("polygon.json", json::to_json(report));
    files.push("polygon.svg", polygon::drawing(report, line, svg::Theme::Adaptive)?);
    files.push("polygon.png", png::render(&polygon::drawing(report, line, svg::Theme::Light)?)?);
    Ok(files)
}
