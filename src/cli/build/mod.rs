//! `lss build`: a layout to track elements, drawings and a simulation input.

mod emit;
mod pareto;
pub mod routed;
pub mod summary;
mod written;

use super::progress::Solving;
use super::read::{Read, given_let, read_any, tell};
use super::{MessageFormat, Outcome, OutputFormat, could_not, layouts, limits, report};
use crate::choose::Measure;
use crate::compiled::Compiled;
use crate::diagnostic::Diagnostic;
use crate::emit::OwnNumbers;
use crate::emit::freedom::Table;
use crate::model::{self, Layout};
use crate::problem::{self, Problem, Scope};
use crate::semantics::given::GivenLet;
use crate::solve::{self, Effort, Options, Solver, unsupported};
use clap::ValueEnum;
use emit::{Emit, EmitParser};
use routed::Routed;
use std::path::{Path, PathBuf};
use std::time::Duration;
use summary::Summary;
use written::More;

/// Optimise layouts and write their elements, drawings and simulation inputs.
///
/// Writes layout.json, simulation.json, bom.csv, bom.json, drawing.svg, drawing.png and drawing.dxf, all of them or
/// none. When no layout meets the constraints, the best one found is written, marked as not feasible, and the exit code
/// is 1. Of several files each is built, whatever becomes of the others, and the exit code is the worst.
#[derive(Debug, clap::Args)]
pub struct Build {
    /// Layout files.
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Folder for the outputs, out/NAME when not given, NAME being the file's, or out/NAME-LAYOUT with --layout; created
    /// if it is missing. Of several files each has a folder of its name in it.
    ///
    /// With --emit only what it prints is made unless a folder is given; `nl` and `mps` are files in any case.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Which layout, when the file has several.
    #[arg(long, value_name = "NAME")]
    layout: Option<String>,
    /// Give a `let` of the layout another value: --let aisle=3m. May be repeated.
    #[arg(long = "let", value_name = "NAME=VALUE", value_parser = given_let)]
    lets: Vec<GivenLet>,
    /// How the summary is written to standard output.
    #[arg(long, value_enum, default_value_t)]
    format: OutputFormat,
    /// How diagnostics are written to standard error.
    #[arg(long, value_enum, default_value_t)]
    message_format: MessageFormat,
    /// Print a stage of the compiler instead of building (`model`, `problem`), or write more about the result.
    #[arg(long, value_parser = EmitParser, value_name = "WHAT")]
    emit: Option<Emit>,
    /// Trade two or three measures instead of length and cost, as --emit pareto: --pareto price,smoothness. What the layout
    /// leaves free with `choose` is free.
    #[arg(long, value_enum, value_name = "MEASURES", value_delimiter = ',')]
    pareto: Vec<Measure>,
    #[command(flatten)]
    more: More,
    /// Solver of the continuous stages.
    #[arg(long, value_enum, default_value_t)]
    solver: SolverName,
    /// Start from the written layout with normal noise of this size on free vertices, and radii drawn uniformly.
    #[arg(long, value_name = "LENGTH", value_parser = length)]
    perturb: Option<f64>,
    /// Seed of --perturb.
    #[arg(long, value_name = "K", default_value_t = 1)]
    seed: u64,
    /// Stop the search for the best layout on the grid when the proven gap is no larger: 0.1% or 0.001.
    #[arg(long, value_name = "GAP", value_parser = gap, default_value = "0")]
    gap: f64,
    /// Most nodes of that search; then the best layout found is returned with the gap that is left. Layouts of n > 24
    /// vertices take (24/n)^6 as many, as each node takes longer.
    #[arg(long, value_name = "N", default_value_t = Effort::default().nodes as u64)]
    nodes: u64,
    /// End after this time (30, 30s, 2min) with the best layout so far, and with what is proven of it. Of several files
    /// each has so much.
    #[arg(long, value_name = "TIME", value_parser = limits::time)]
    time_limit: Option<Duration>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum)]
enum SolverName {
    /// Sequential quadratic programming.
    #[default]
    Sqp,
    /// Box's complex method, for comparison.
    Complex,
}

impl Build {
    pub fn run(&self) -> Outcome {
        let own = match self.more.own_numbers() {
            Ok(own) => own,
            Err(outcome) => return outcome,
        };
        if let Some(wrong) = self.wrong_measures() {
            report::error(&wrong);
            return Outcome::CouldNotRun;
        }
        let names = layouts::names(self.files.iter().map(PathBuf::as_path), "");
        let mut worst = Outcome::Clean;
        for (file, name) in self.files.iter().filter_map(|file| names.get_key_value(file)) {
            let folder = match (&self.output, self.emit()) {
                (Some(folder), _) if self.files.len() > 1 => Some(folder.join(name)),
                (Some(folder), _) => Some(folder.clone()),
                (None, Some(Emit::Model | Emit::Problem | Emit::Freedom | Emit::Pareto)) if !self.more.any() => None,
                (None, _) => Some(Path::new("out").join(match &self.layout {
                    Some(layout) => format!("{name}-{layout}"),
                    None => name.clone(),
                })),
            };
            worst = worst.max(self.build(file, folder.as_deref(), &own));
        }
        worst
    }

    /// Builds one file, into a folder if there is one.
    fn build(&self, file: &Path, output: Option<&Path>, own: &OwnNumbers) -> Outcome {
        limits::set_time(self.time_limit);
        let Read { sources, layout, mut said, .. } =
            match read_any(file, self.layout.as_deref(), &self.lets, self.message_format) {
                Ok(read) => read,
                Err(outcome) => return outcome,
            };
        let layout = &layout;
        if self.emit() == Some(Emit::Model) {
            report::print(&model::print(layout));
            return tell(&sources, &said, self.message_format);
        }
        said.extend(unsupported(layout));
        if self.emit() == Some(Emit::Pareto)
            && let Some(outcome) = pareto::unready(layout, &self.measures(), &mut said)
        {
            return outcome;
        }
        if said.iter().any(Diagnostic::is_error) {
            return tell(&sources, &said, self.message_format);
        }
        if let (Some(_), Some(Emit::Problem | Emit::Nl | Emit::Mps | Emit::Pareto)) = (&layout.route, self.emit()) {
            report::error("this --emit needs vertices: build the route, and use it on the layout.lss that is written");
            return Outcome::CouldNotRun;
        }
        if self.emit() == Some(Emit::Problem) {
            report::print(&problem::print(&Problem::new(layout, Scope::Obstacles), &sources));
            return tell(&sources, &said, self.message_format);
        }
        let (compiled, routed) = match layout.route {
            None => (self.solve(layout), None),
            Some(_) => match Routed::find(&sources, layout, &routed::options(self.options()), self.message_format) {
                Ok(found) => (found.compiled.clone(), Some(found)),
                Err(why) => {
                    said.extend(why);
                    return tell(&sources, &said, self.message_format);
                }
            },
        };
        let layout = &compiled.layout;
        compiled.tell(&mut said);
        if compiled.heights.iter().any(Diagnostic::is_error) {
            return tell(&sources, &said, self.message_format);
        }
        if output.is_some() && !compiled.failed() {
            said.extend(solve::implied(&compiled.layout, &compiled.stages));
        }
        let freedom =
            (self.emit() == Some(Emit::Freedom) && !compiled.failed()).then(|| Table::new(&compiled, &sources));
        let mut pareto = None;
        if self.emit() == Some(Emit::Pareto) && !compiled.failed() {
            match pareto::trade(layout, &self.measures(), &self.options(), self.message_format) {
                Ok(found) => pareto = Some(found),
                Err(outcome) => return outcome,
            }
        }
        if let Some(folder) = output {
            let files = self.more.files(&compiled, self.emit(), freedom.as_ref(), own).map(|mut files| {
                if let Some(pareto) = &pareto {
                    files.extend([pareto.file()]);
                    files.push("pareto.html", crate::report::pareto::page(pareto));
                }
                if let Some(text) = routed.as_ref().and_then(|r| r.text.clone()) {
                    files.push("layout.lss", text);
                }
                files
            });
            let files = match files {
                Ok(files) => files,
                Err(why) => return could_not("draw", file, why),
            };
            if let Err(outcome) = written::write(&files, folder) {
                return outcome;
            }
            if self.message_format == MessageFormat::Text {
                self.more.tell_missing(&compiled, own);
            }
        }
        match &freedom {
            Some(table) if self.format == OutputFormat::Text => report::print(&table.text),
            _ => self.summarise(Summary::new(&compiled, pareto.as_ref(), routed.as_ref()).of(file, output), output),
        }
        if let (Some(pareto), OutputFormat::Text) = (&pareto, self.format) {
            report::print(&pareto.text());
        }
        tell(&sources, &said, self.message_format)
    }

    /// What is made: a trade of measures is asked for by their names alone, too.
    fn emit(&self) -> Option<Emit> {
        if self.pareto.is_empty() { self.emit } else { Some(Emit::Pareto) }
    }

    fn measures(&self) -> Vec<Measure> {
        if self.pareto.is_empty() { pareto::USUAL.to_vec() } else { self.pareto.clone() }
    }

    fn wrong_measures(&self) -> Option<String> {
        match (self.pareto.is_empty(), self.emit) {
            (true, _) => None,
            (false, None | Some(Emit::Pareto)) => Measure::wrong(&self.pareto),
            (false, Some(_)) => Some("--pareto is an --emit of its own: leave the other one out".to_owned()),
        }
    }

    fn options(&self) -> Options {
        Options {
            solver: match self.solver {
                SolverName::Sqp => Solver::Sqp,
                SolverName::Complex => Solver::Complex,
            },
            perturb: self.perturb.map(|size| (size, self.seed)),
            threads: limits::threads(),
            effort: Effort { gap: self.gap, nodes: self.nodes as usize, ..Effort::default() },
            stop: limits::stop(),
        }
    }

    fn solve(&self, layout: &Layout) -> Compiled {
        let line = Solving::new(self.message_format);
        let stages = solve::solve(layout, &self.options(), &|progress| line.show(progress));
        line.finish();
        Compiled::new(layout.clone(), stages)
    }

    fn summarise(&self, summary: Summary, output: Option<&Path>) {
        let text = match self.format {
            OutputFormat::Json => serde_json::to_string(&summary).unwrap_or_default() + "\n",
            OutputFormat::Text => summary.text(output),
        };
        report::print(&text);
    }
}

/// `0.1%`, `0.1 %`, `0.001`.
fn gap(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let (digits, scale) = text.strip_suffix('%').map_or((text, 1.0), |digits| (digits, 0.01));
    match digits.trim().parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value * scale),
        _ => Err(format!("{text} is not a gap such as 0.1% or 0.001")),
    }
}

/// `1.5m`, `1.5 m`, `300mm`.
pub(super) fn length(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let (digits, scale) = match (text.strip_suffix("mm"), text.strip_suffix('m')) {
        (Some(digits), _) => (digits, 1e-3),
        (None, Some(digits)) => (digits, 1.0),
        _ => return Err("a length needs a unit, such as 1.5m or 300mm".into()),
    };
    match digits.trim().parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value * scale),
        _ => Err(format!("{text} is not a length such as 1.5m")),
    }
}
