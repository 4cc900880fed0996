//! `lss build`: a layout to track elements, drawings and a simulation input.

use super::progress::ProgressLine;
use super::read::{Read, read_any, tell};
use super::routed::{self, RouteSummary, Routed};
use super::{MessageFormat, Outcome, OutputFormat, could_not, limits, report};
use crate::cli::read::loose;
use crate::compiled::Compiled;
use crate::diagnostic::Diagnostic;
use crate::emit::pareto::Pareto;
use crate::emit::{DrawError, Files};
use crate::kinematics::Fit;
use crate::model::{self, Layout};
use crate::problem::{self, Problem, Scope};
use crate::solve::{self, Certificate, Counted, Effort, Options, Part, Solver, unsupported};
use crate::source::disk::{Found, inspect};
use crate::source::shown;
use crate::{elements, emit};
use clap::ValueEnum;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Optimise a layout and write its elements, drawings and simulation input.
///
/// Writes layout.json, simulation.json, bom.csv, bom.json, drawing.svg, drawing.png and drawing.dxf, all of them or
/// none. When no layout meets the constraints, the best one found is written, marked as not feasible, and the exit code
/// is 1.
#[derive(Debug, clap::Args)]
pub struct Build {
    /// Layout file.
    file: PathBuf,
    /// Folder for the outputs; created if it is missing.
    #[arg(short, long, value_name = "DIR", required_unless_present = "emit")]
    output: Option<PathBuf>,
    /// Which layout, when the file has several.
    #[arg(long, value_name = "NAME")]
    layout: Option<String>,
    /// How the summary is written to standard output.
    #[arg(long, value_enum, default_value_t)]
    format: OutputFormat,
    /// How diagnostics are written to standard error.
    #[arg(long, value_enum, default_value_t)]
    message_format: MessageFormat,
    /// Print a stage of the compiler instead of building (`model`, `problem`), or write more about the result.
    #[arg(long, value_enum, value_name = "WHAT")]
    emit: Option<Emit>,
    /// Draw start and stages over each other, too: stages.svg and stages.png.
    #[arg(long)]
    stages: bool,
    /// Write the drawing as PDF, too: drawing.pdf, on a page of the sheet's size; with --stages also stages.pdf.
    #[arg(long, requires = "output")]
    pdf: bool,
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
    /// Most nodes of that search; then the best layout found is returned with the gap that is left.
    #[arg(long, value_name = "N", default_value_t = Effort::default().nodes as u64)]
    nodes: u64,
    /// End after this time (30, 30s, 2min) with the best layout so far, and with what is proven of it.
    #[arg(long, value_name = "TIME", value_parser = limits::time)]
    time_limit: Option<Duration>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Emit {
    /// The checked layout with every default filled in.
    Model,
    /// The optimisation problem, each row with its source line.
    Problem,
    /// What the layout is still free to do, and what each row at its limit costs; with -o freedom.txt and freedom.json.
    Freedom,
    /// Length against cost: layouts that are best for one price of a metre or another; with -o pareto.json.
    Pareto,
    /// The continuous stages for other solvers, with the build: stage1.nl, stage2.nl, names in .row and .col.
    Nl,
    /// The discrete stage without building and obstacles for other solvers, with the build: stage3.mps.
    Mps,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum)]
enum SolverName {
    /// Sequential quadratic programming.
    #[default]
    Sqp,
    /// Box's complex method, for comparison.
    Complex,
}

/// The summary in JSON.
#[derive(Serialize)]
struct Summary<'a> {
    layout: &'a str,
    stages: Vec<StageSummary<'a>>,
    length_m: f64,
    footprint_m2: f64,
    element_count: usize,
    closure_m: f64,
    closure_rad: f64,
    price_eur: f64,
    mass_kg: f64,
    feasible: bool,
    /// What ended the search before it was done.
    #[serde(skip_serializing_if = "Option::is_none")]
    cut: Option<solve::Cut>,
    certificate: Option<CertificateSummary<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    route: Option<RouteSummary<'a>>,
    chain: Option<ChainSummary>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pareto: Option<&'a Pareto>,
}

/// What is proven of the last stage's layout.
#[derive(Serialize)]
struct CertificateSummary<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    lower_bound_m: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    lower_bound_eur: Option<f64>,
    /// Before the price of each piece is rounded to the cent.
    #[serde(skip_serializing_if = "Option::is_none")]
    value_eur: Option<f64>,
    /// What each metre counts beside the price.
    #[serde(skip_serializing_if = "Option::is_none")]
    eur_per_metre: Option<f64>,
    gap: f64,
    proven: bool,
    nodes: usize,
    seconds: f64,
    parts: &'a [Part],
    assumed: &'a [String],
    /// What only layouts within a budget were compared by.
    #[serde(skip_serializing_if = "Option::is_none")]
    budget: Option<&'a str>,
}

/// How a whole number of carts fits.
#[derive(Serialize)]
struct ChainSummary {
    carts: usize,
    left_over_mm: f64,
    take_up_mm: f64,
}

#[derive(Serialize)]
struct StageSummary<'a> {
    name: &'a str,
    length_m: f64,
    max_violation_m: f64,
    iterations: usize,
    #[serde(skip_serializing_if = "is_one")]
    starts: usize,
    seconds: f64,
    status: solve::Status,
}

fn is_one(count: &usize) -> bool {
    *count == 1
}

impl Build {
    pub fn run(&self) -> Outcome {
        limits::set_time(self.time_limit);
        let Read { sources, layout, mut said } = match read_any(&self.file, self.layout.as_deref(), self.message_format)
        {
            Ok(read) => read,
            Err(outcome) => return outcome,
        };
        let layout = &layout;
        if self.emit == Some(Emit::Model) {
            report::print(&model::print(layout));
            return tell(&sources, &said, self.message_format);
        }
        said.extend(unsupported(layout));
        if self.emit == Some(Emit::Pareto) {
            if layout.catalog.unpriced().next().is_some() {
                report::error("--emit pareto needs a catalogue in which straights and curves cost something");
                return Outcome::CouldNotRun;
            }
            // What may be built of length may not be of cost.
            let priced = Layout { objective: solve::objective(layout, Some(0.0)), ..layout.clone() };
            said.extend(unsupported(&priced).into_iter().filter(|d| !said.contains(d)).collect::<Vec<_>>());
        }
        if said.iter().any(Diagnostic::is_error) {
            return tell(&sources, &said, self.message_format);
        }
        if let (Some(_), Some(Emit::Problem | Emit::Nl | Emit::Mps | Emit::Pareto)) = (&layout.route, self.emit) {
            report::error("this --emit needs vertices: build the route, and use it on the layout.lss that is written");
            return Outcome::CouldNotRun;
        }
        if self.emit == Some(Emit::Problem) {
            report::print(&problem::print(&Problem::new(layout, Scope::Obstacles), &sources));
            return tell(&sources, &said, self.message_format);
        }
        if matches!(self.emit, Some(Emit::Nl | Emit::Mps)) && self.output.is_none() {
            report::error("--emit nl and --emit mps write files: say where with -o DIR");
            return Outcome::CouldNotRun;
        }
        let (compiled, routed) = match layout.route {
            None => (self.solve(layout), None),
            Some(_) => match Routed::find(&sources, layout, &routed::options(self.options())) {
                Ok(found) => (found.compiled.clone(), Some(found)),
                Err(why) => {
                    said.extend(why);
                    return tell(&sources, &said, self.message_format);
                }
            },
        };
        let layout = &compiled.layout;
        said.extend(solve::diagnose(&compiled.layout, &compiled.stages));
        if !compiled.failed() {
            let unclosed = solve::unclosed(layout, &compiled.track, &compiled.space.line);
            said.extend(unclosed.or_else(|| loose(&compiled)));
        }
        said.extend(compiled.heights.iter().cloned());
        if compiled.heights.iter().any(Diagnostic::is_error) {
            return tell(&sources, &said, self.message_format);
        }
        // What checking said about a written value need not be said again about its element, and nobody orders a
        // layout that is not feasible.
        let lacking = if compiled.failed() { Vec::new() } else { elements::lacking(&compiled.sequence, layout) };
        let new = |d: &Diagnostic| !said.iter().any(|s| s.label.span == d.label.span && !s.is_error());
        let lacking: Vec<Diagnostic> = lacking.into_iter().filter(new).collect();
        said.extend(lacking);
        if self.output.is_some() && !compiled.failed() {
            said.extend(solve::implied(&compiled.layout, &compiled.stages));
        }
        let freedom = (self.emit == Some(Emit::Freedom) && !compiled.failed())
            .then(|| emit::freedom::Table::new(&compiled, &sources));
        let pareto = (self.emit == Some(Emit::Pareto) && !compiled.failed()).then(|| {
            let line = ProgressLine::new();
            let trades = solve::pareto(layout, &self.options(), &|progress| line.show(progress));
            line.finish();
            Pareto::new(layout, &trades)
        });
        if let Some(folder) = &self.output {
            let files = self.files(&compiled, freedom.as_ref()).map(|mut files| {
                files.extend(pareto.iter().map(Pareto::file));
                if let Some(text) = routed.as_ref().and_then(|r| r.text.clone()) {
                    files.push("layout.lss", text);
                }
                files
            });
            let files = match files {
                Ok(files) => files,
                Err(why) => return could_not("draw", &self.file, why),
            };
            told_of(&inspect(folder, SET), folder);
            if let Err(error) = files.write_set(folder, SET) {
                return could_not("write", &error.path, &error.reason);
            }
        }
        match &freedom {
            Some(table) if self.format == OutputFormat::Text => report::print(&table.text),
            _ => self.summarise(&compiled, pareto.as_ref(), routed.as_ref()),
        }
        if let (Some(pareto), OutputFormat::Text) = (&pareto, self.format) {
            report::print(&pareto.text());
        }
        tell(&sources, &said, self.message_format)
    }

    fn options(&self) -> Options {
        Options {
            solver: match self.solver {
                SolverName::Sqp => Solver::Sqp,
                SolverName::Complex => Solver::Complex,
            },
            perturb: self.perturb.map(|size| (size, self.seed)),
            threads: limits::threads(),
            effort: Effort { gap: self.gap, nodes: self.nodes as usize },
            stop: limits::stop(),
        }
    }

    fn solve(&self, layout: &Layout) -> Compiled {
        let line = ProgressLine::new();
        let stages = solve::solve(layout, &self.options(), &|progress| line.show(progress));
        line.finish();
        Compiled::new(layout.clone(), stages)
    }

    fn files(&self, compiled: &Compiled, freedom: Option<&emit::freedom::Table>) -> Result<Files, DrawError> {
        let mut files: Files = emit::data_files(compiled).into_iter().chain(emit::drawing_files(compiled)?).collect();
        if self.stages {
            let written = compiled.layout.corners();
            files.push("stages.svg", emit::stages_svg(compiled, &written)?);
            files.push("stages.png", emit::stages_png(compiled, &written)?);
            if self.pdf {
                files.push("stages.pdf", emit::stages_pdf(compiled, &written)?);
            }
        }
        if self.pdf {
            files.push("drawing.pdf", emit::drawing_pdf(compiled)?);
        }
        match self.emit {
            Some(Emit::Nl) => files.extend(emit::outside::nl_files(compiled)),
            Some(Emit::Mps) => files.extend(emit::outside::mps_files(compiled)),
            _ => files.extend(freedom.into_iter().flat_map(|table| table.files())),
        }
        Ok(files)
    }

    fn summarise(&self, compiled: &Compiled, pareto: Option<&Pareto>, routed: Option<&Routed>) {
        let stage = |s: &'_ solve::Stage| StageSummary {
            name: s.name,
            length_m: s.length,
            max_violation_m: s.max_violation,
            iterations: s.iterations,
            starts: s.starts,
            seconds: s.seconds,
            status: s.status,
        };
        let summary = Summary {
            layout: &compiled.layout.name,
            stages: compiled.stages.iter().map(stage).collect(),
            length_m: compiled.length(),
            footprint_m2: compiled.footprint,
            element_count: compiled.bill.count,
            closure_m: compiled.sequence.closure,
            closure_rad: compiled.sequence.closure_heading,
            price_eur: compiled.bill.price,
            mass_kg: compiled.bill.mass,
            feasible: !compiled.failed(),
            cut: compiled.stages.last().and_then(|s| s.cut),
            certificate: compiled.stages.last().and_then(|s| s.certificate.as_ref()).map(certificate),
            route: routed.map(Routed::summary),
            chain: compiled.chain.map(|fit| chain(fit, &compiled.layout)),
            pareto,
        };
        let text = match self.format {
            OutputFormat::Json => serde_json::to_string(&summary).unwrap_or_default() + "\n",
            OutputFormat::Text => text(&summary, compiled.raised(), self.output.as_ref()),
        };
        report::print(&text);
    }
}

/// Of the manifest in the folder of the outputs.
const SET: &str = "build";

/// Says where the files of an earlier build are no whole set. All of them are written anew.
fn told_of(found: &Found, folder: &Path) {
    let folder = folder.display();
    match found {
        Found::Whole => {}
        Found::Interrupted { new, old } => report::warning(&format!(
            "{folder} holds parts of two builds, as a build was stopped while it wrote: {} {} new, {} {} not; all are \
             written anew",
            new.join(", "),
            if new.len() == 1 { "is" } else { "are" },
            old.join(", "),
            if old.len() == 1 { "is" } else { "are" },
        )),
        Found::Changed { changed, missing } => {
            if !changed.is_empty() {
                let what = if changed.len() == 1 { "is not what" } else { "are not what" };
                report::warning(&format!(
                    "{} in {folder} {what} the last build wrote there; written anew",
                    changed.join(", ")
                ));
            }
            if !missing.is_empty() {
                let what = if missing.len() == 1 { "is" } else { "are" };
                report::warning(&format!(
                    "{} of the last build {what} gone from {folder}; written anew",
                    missing.join(", ")
                ));
            }
        }
    }
}

fn certificate(c: &Certificate) -> CertificateSummary<'_> {
    let price = match c.counted {
        Counted::Length => None,
        Counted::Price { metre } => Some(metre),
    };
    CertificateSummary {
        lower_bound_m: price.is_none().then_some(c.lower_bound),
        lower_bound_eur: price.map(|_| c.lower_bound),
        value_eur: price.map(|_| c.value),
        eur_per_metre: price.filter(|metre| *metre > 0.0),
        gap: c.gap,
        proven: c.proven,
        nodes: c.nodes,
        seconds: c.seconds,
        parts: &c.parts,
        assumed: &c.assumed,
        budget: c.budget.as_deref(),
    }
}

fn chain(fit: Fit, layout: &Layout) -> ChainSummary {
    let millimetres = |metres: f64| (metres * 1e6).round() / 1e3 + 0.0;
    ChainSummary {
        carts: fit.carts,
        left_over_mm: millimetres(fit.left_over),
        take_up_mm: millimetres(layout.catalog.take_up),
    }
}

/// The summary for people.
fn text(summary: &Summary, raised: bool, output: Option<&PathBuf>) -> String {
    let mut out = format!("{}\n", summary.layout);
    for stage in &summary.stages {
        let state = match stage.status {
            solve::Status::Local => "local optimum",
            solve::Status::BestFound => "best found",
            solve::Status::Proven => "proven",
            solve::Status::Feasible if summary.cut.is_some() => "feasible, not optimal",
            solve::Status::Feasible => "feasible, but out of iterations before it was a local optimum",
            solve::Status::Infeasible => "NOT FEASIBLE",
            solve::Status::AsWritten => "as written",
        };
        let starts = if stage.starts > 1 { format!(" from {} starts", stage.starts) } else { String::new() };
        out += &format!(
            "  {:<8} {:>12.5} m  {state}{starts}, violation {:.1e}, {} iterations, {:.3} s\n",
            stage.name, stage.length_m, stage.max_violation_m, stage.iterations, stage.seconds
        );
    }
    if summary.cut == Some(solve::Cut::Time) {
        out += "  cut: time; this is the best layout so far, and more time may find a better one or prove more\n";
    }
    if let Some(c) = &summary.certificate {
        let nodes = if c.nodes == 1 { "1 node".to_owned() } else { format!("{} nodes", c.nodes) };
        let least = match (c.lower_bound_eur, c.eur_per_metre) {
            (Some(eur), None) => format!("cheaper than {eur:.3} EUR"),
            (Some(eur), Some(metre)) => format!("better than {eur:.3} EUR, a metre counted as {metre} EUR"),
            (None, _) => format!("shorter than {:.6} m", c.lower_bound_m.unwrap_or(0.0)),
        };
        let best = match (c.lower_bound_eur, c.eur_per_metre) {
            (None, _) => "shortest",
            (Some(_), None) => "cheapest",
            (Some(_), Some(_)) => "best",
        };
        let these =
            if c.budget.is_some() { "no layout on this grid and within the budget" } else { "no layout on this grid" };
        out += &if c.lower_bound_m.or(c.lower_bound_eur) == Some(0.0) && !c.proven {
            format!("  no bound was found for layouts on this grid ({nodes}); more time or --nodes may give one\n")
        } else if c.proven {
            format!("  proven {best}: {these} is {least} ({nodes})\n")
        } else {
            format!("  {these} is {least} (gap {:.3} %, {nodes})\n", 100.0 * c.gap)
        };
        if let Some(budget) = c.budget {
            out += &format!("  budget: {budget}\n");
        }
    }
    if let Some(route) = &summary.route {
        out += &route.text();
    }
    if let Some(chain) = &summary.chain {
        let beyond = if chain.left_over_mm.abs() > chain.take_up_mm + 0.01 {
            format!(", beyond the take-up of {} mm", chain.take_up_mm)
        } else {
            String::new()
        };
        out += &format!("  {} carts, {:.1} mm left over{beyond}\n", chain.carts, chain.left_over_mm);
    }
    out += &format!(
        "  {} elements, {:.2} EUR, {:.1} kg, footprint {:.2} m², closes to {:.1e} m\n",
        summary.element_count, summary.price_eur, summary.mass_kg, summary.footprint_m2, summary.closure_m
    );
    if raised {
        out += &format!("  {:.5} m along the slope; stages count the plan\n", summary.length_m);
    }
    if let Some(folder) = output {
        out += &format!("  written to {}\n", shown(folder));
    }
    out
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
