//! `lss import`: a DXF drawing to a layout.

use super::build::length;
use super::{MessageFormat, Outcome, OutputFormat, could_not, read, report};
use crate::base::number::{significant, trimmed};
use crate::base::trig;
use crate::emit::Files;
use crate::import::{self, LengthUnit, Options, Plan, as_name};
use crate::semantics::analyse;
use crate::source::{self, DRAWING_LIMIT, InputError, LoadError, Loader, SourceMap, shown};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Make a layout of a plan from CAD, a DXF drawing.
///
/// The centre line of lines, arcs and polylines becomes vertices with radii; the outlines on the other layers become
/// building and obstacles. The layout compiles to the drawn line as it is (`optimise nothing`). Gaps and bends within
/// the tolerance are healed and reported. What `lss build` draws comes back.
#[derive(Debug, clap::Args)]
pub struct Import {
    /// DXF file, as ASCII text.
    drawing: PathBuf,
    /// Layout file to write.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Overwrite the layout file if it exists.
    #[arg(long)]
    force: bool,
    /// Layer of the centre line.
    #[arg(long, value_name = "LAYER", default_value = "TRACK_CENTRE")]
    centre_line: String,
    /// Layer of the building's outline.
    #[arg(long, value_name = "LAYER", default_value = "BUILDING")]
    building: String,
    /// Layer of the obstacles' outlines; may be given several times.
    #[arg(long, value_name = "LAYER", default_value = "OBSTACLES")]
    obstacles: Vec<String>,
    /// Unit of the drawing, such as mm, m or in, instead of the one that the file states.
    #[arg(long, value_name = "UNIT", value_parser = LengthUnit::parse)]
    unit: Option<LengthUnit>,
    /// Largest gap that is closed, and farthest that the line may be moved.
    #[arg(long, value_name = "LENGTH", default_value = "1mm", value_parser = positive)]
    tolerance: f64,
    /// Drive against the order in which the centre line is drawn.
    #[arg(long)]
    reverse: bool,
    /// Radius for corners that are drawn without a curve.
    #[arg(long, value_name = "LENGTH", value_parser = positive)]
    radius: Option<f64>,
    /// Width of the track [default: that of the drawn sides, else 1.2m].
    #[arg(long, value_name = "LENGTH", value_parser = positive)]
    width: Option<f64>,
    /// How the summary is written to standard output.
    #[arg(long, value_enum, default_value_t)]
    format: OutputFormat,
    /// How diagnostics are written to standard error.
    #[arg(long, value_enum, default_value_t)]
    message_format: MessageFormat,
}

/// What was read, in JSON.
#[derive(Serialize)]
struct Summary<'a> {
    layout: &'a str,
    written_to: String,
    unit: &'a str,
    vertices: usize,
    length_m: f64,
    width_m: f64,
    building: bool,
    obstacles: usize,
    healed: Healed,
}

#[derive(Serialize)]
struct Healed {
    gaps: usize,
    largest_gap_m: f64,
    largest_bend_deg: f64,
    largest_shift_m: f64,
    dropped_pieces: usize,
}

impl Import {
    pub fn run(&self) -> Outcome {
        // Said before any work, and seen to again when writing.
        if self.output.exists() && !self.force {
            report::error(&format!(
                "{} exists already; nothing was changed (--force overwrites it)",
                shown(&self.output)
            ));
            return Outcome::CouldNotRun;
        }
        let Some(file) = self.output.file_name().map(|name| name.to_string_lossy().into_owned()) else {
            report::error("give the layout file a name");
            return Outcome::CouldNotRun;
        };
        let mut sources = SourceMap::default();
        let drawing = match source::drawing(&mut sources, &self.drawing) {
            Ok(drawing) => drawing,
            Err(why) => return could_not("read", &self.drawing, reason(&why)),
        };
        let (plan, said) = import::read(&sources, drawing, &self.options());
        let outcome = read::tell(&sources, &said, self.message_format);
        let Some(plan) = plan else { return outcome };

        let stem = Path::new(&file).file_stem().unwrap_or_default().to_string_lossy();
        let name = as_name(&stem, "layout");
        let text = import::write(&plan, &name, &self.origin(&plan));
        let mut files = Files::default();
        files.push(&file, text.clone());
        let folder = self.output.parent().filter(|f| !f.as_os_str().is_empty()).unwrap_or(Path::new("."));
        if let Err(error) = files.write(folder) {
            return could_not("write", &self.output, error);
        }
        self.summarise(&plan, &name);
        self.check(&text)
    }

    fn options(&self) -> Options {
        Options {
            centre_line: self.centre_line.clone(),
            building: self.building.clone(),
            obstacles: self.obstacles.clone(),
            unit: self.unit,
            tolerance: self.tolerance,
            reverse: self.reverse,
            radius: self.radius,
            width: self.width,
        }
    }

    /// The first line of the layout file.
    fn origin(&self, plan: &Plan) -> String {
        let drawing = self.drawing.file_name().unwrap_or_default().to_string_lossy();
        let tolerance = millimetres(self.tolerance);
        format!("Imported from {drawing}, drawn in {}, with a tolerance of {tolerance}.", plan.unit.symbol())
    }

    /// What the compiler says of the layout, so that the user need not ask.
    fn check(&self, text: &str) -> Outcome {
        let mut sources = SourceMap::default();
        let name = self.output.to_string_lossy();
        let Ok((mut loader, main)) = Loader::memory(&mut sources, &[(&name, text.as_bytes())]) else {
            return Outcome::Clean;
        };
        let found = analyse(&mut sources, &mut loader, main, None).diagnostics;
        read::tell(&sources, &found, self.message_format)
    }

    fn summarise(&self, plan: &Plan, name: &str) {
        let healed = &plan.healed;
        let text = match self.format {
            OutputFormat::Json => {
                let summary = Summary {
                    layout: name,
                    written_to: self.output.to_string_lossy().into_owned(),
                    unit: plan.unit.symbol(),
                    vertices: plan.vertices.len(),
                    length_m: plan.length,
                    width_m: plan.width,
                    building: plan.building.is_some(),
                    obstacles: plan.obstacles.len(),
                    healed: Healed {
                        gaps: healed.gaps,
                        largest_gap_m: healed.largest_gap,
                        largest_bend_deg: healed.largest_bend * 180.0 / trig::PI,
                        largest_shift_m: healed.largest_shift,
                        dropped_pieces: healed.dropped,
                    },
                };
                serde_json::to_string(&summary).unwrap_or_default() + "\n"
            }
            OutputFormat::Text => {
                let building = if plan.building.is_some() { "a building" } else { "no building" };
                let obstacles = match plan.obstacles.len() {
                    1 => "1 obstacle".to_string(),
                    count => format!("{count} obstacles"),
                };
                format!(
                    "{name}\n  {} vertices, {} m, {building}, {obstacles}; within {} of the drawing\n  written to {}\n",
                    plan.vertices.len(),
                    trimmed(plan.length, 6),
                    millimetres(healed.largest_shift.max(1e-9)),
                    shown(&self.output)
                )
            }
        };
        report::print(&text);
    }
}

fn millimetres(length: f64) -> String {
    format!("{} mm", significant(length * 1e3, 2))
}

fn positive(text: &str) -> Result<f64, String> {
    length(text).and_then(|l| if l > 0.0 { Ok(l) } else { Err(format!("{text} is no length above zero")) })
}

pub(super) fn reason(error: &LoadError) -> String {
    match error {
        LoadError::Unreadable(why) => why.clone(),
        LoadError::TooLarge(bytes) => {
            format!("{} MiB are more than the {} MiB of a drawing", bytes >> 20, DRAWING_LIMIT >> 20)
        }
        LoadError::OutsideRoot(root) => InputError::OutsideRoot(root.clone()).to_string(),
        other => format!("{other:?}"),
    }
}
