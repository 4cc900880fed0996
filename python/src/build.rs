//! Layouts: read, solved, drawn and written.

use super::raise::{Failure, Said};
use super::work::{Board, flag, threads, work};
use lss::base::json::to_json;
use lss::cli::build::routed::Routed;
use lss::cli::build::summary::Summary;
use lss::cli::check::{Opened, open};
use lss::cli::progress::words;
use lss::compiled::Compiled;
use lss::diagnostic::Diagnostic;
use lss::emit::{self, Files, OwnNumbers, bom, svg};
use lss::model;
use lss::route;
use lss::semantics::given::{GivenLet, given};
use lss::semantics::{analyse, unreadable};
use lss::solve::{self, Effort, Options, Progress, Solver, Stop, unsupported};
use lss::source::{FileId, Loader, Overlay, SourceMap};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// A layout to build.
#[derive(Clone)]
pub struct Source {
    /// The file, or what the text is called.
    pub path: PathBuf,
    pub text: Option<String>,
    /// Which layout of the file.
    pub layout: Option<String>,
    /// Values for its `let`s.
    pub lets: Vec<GivenLet>,
}

/// How hard it is tried.
#[derive(Clone, Copy)]
pub struct Limits {
    pub nodes: usize,
    pub gap: f64,
    pub time: Option<Duration>,
    pub threads: usize,
}

/// A layout that was built.
pub struct Built {
    pub compiled: Compiled,
    said: Said,
    /// What `lss build --format json` prints.
    summary: String,
    /// `layout.lss`, where the vertices were found.
    text: Option<String>,
    /// Whether there are errors.
    pub fails: bool,
}

fn opened(sources: &mut SourceMap, source: &Source) -> Result<(Loader, FileId), Failure> {
    let (mut loader, main) = as_written(sources, source)?;
    if source.lets.is_empty() {
        return Ok((loader, main));
    }
    let given = given(sources, &mut loader, main, &source.lets)
        .map_err(|why| Failure::Value(format!("let: {why}\n  help: {}", why.help())))?;
    // A text that stands in for no file stays one.
    let mut overlay: Overlay = source.text.iter().map(|text| (source.path.clone(), text.clone())).collect();
    overlay.extend(given);
    *sources = SourceMap::default();
    Loader::open_over(sources, &source.path, Arc::new(overlay))
        .map_err(|why| Failure::file("read", &source.path, format!("{why:?}")))
}

/// Opens the file, or the text in its stead.
fn as_written(sources: &mut SourceMap, source: &Source) -> Result<(Loader, FileId), Failure> {
    let path = &source.path;
    match &source.text {
        None => open(sources, path).map_err(|why| match why {
            Opened::Unreadable(why) => Failure::file("read", path, why),
            Opened::Problem(diagnostic) => Failure::Layout(Said::new(sources, &[*diagnostic])),
        }),
        Some(text) => {
            let overlay = Arc::new(Overlay::from([(path.clone(), text.clone())]));
            Loader::open_over(sources, path, overlay).map_err(|why| {
                match unreadable(sources, &why, &path.to_string_lossy()) {
                    Some(diagnostic) => Failure::Layout(Said::new(sources, &[diagnostic])),
                    None => Failure::file("read", path, format!("{why:?}")),
                }
            })
        }
    }
}

/// Reads and checks a layout: it, and what is said of it.
pub fn analysed(sources: &mut SourceMap, source: &Source) -> Result<(model::Layout, Vec<Diagnostic>), Failure> {
    let (mut loader, main) = opened(sources, source)?;
    let analysis = analyse(sources, &mut loader, main, source.layout.as_deref());
    let mut said = analysis.diagnostics.clone();
    match analysis.chosen() {
        Ok(Some(layout)) if !analysis.has_errors() => Ok((layout.clone(), said)),
        Ok(_) => Err(Failure::Layout(Said::new(sources, &said))),
        Err(unclear) => {
            if !said.contains(&unclear) {
                said.push(*unclear);
            }
            Err(Failure::Layout(Said::new(sources, &said)))
        }
    }
}

impl Built {
    /// Reads, checks and solves a layout, as `lss build` does.
    pub fn new(source: &Source, limits: Limits, ended: &'static AtomicBool, board: &Board) -> Result<Built, Failure> {
        let mut sources = SourceMap::default();
        let (layout, mut said) = analysed(&mut sources, source)?;
        let layout = &layout;
        said.extend(unsupported(layout));
        if said.iter().any(Diagnostic::is_error) {
            return Err(Failure::Layout(Said::new(&sources, &said)));
        }
        let stop = limits.time.map_or_else(|| Stop::when(ended), |time| Stop::after_or(time, ended));
        let effort = Effort { gap: limits.gap, nodes: limits.nodes, ..Effort::default() };
        let options = Options { solver: Solver::Sqp, perturb: None, threads: limits.threads, effort, stop };
        let tell = |progress: Progress| {
            let (done, total) = match progress {
                Progress::Iteration { iteration, .. } => (iteration as f64, None),
                Progress::Node { nodes, most, .. } => (nodes as f64, Some(most as f64)),
            };
            board.tell(done, total, words(progress));
        };
        let (compiled, routed) = match layout.route {
            None => (Compiled::new(layout.clone(), solve::solve(layout, &options, &tell)), None),
            Some(_) => match route::find(layout, &options, &tell) {
                Ok(found) => {
                    let routed = Routed::new(&sources, layout, found);
                    (routed.compiled.clone(), Some(routed))
                }
                Err(why) => {
                    said.extend(why);
                    return Err(Failure::Layout(Said::new(&sources, &said)));
                }
            },
        };
        compiled.tell(&mut said);
        if compiled.heights.iter().any(Diagnostic::is_error) {
            return Err(Failure::Layout(Said::new(&sources, &said)));
        }
        if !compiled.failed() {
            said.extend(solve::implied(&compiled.layout, &compiled.stages));
        }
        let summary = Summary::new(&compiled, None, routed.as_ref());
        let summary = serde_json::to_string(&summary).unwrap_or_default();
        Ok(Built {
            fails: said.iter().any(Diagnostic::is_error),
            said: Said::new(&sources, &said),
            text: routed.and_then(|routed| routed.text),
            compiled,
            summary,
        })
    }

    /// The same without the build's words: the input of a simulation. Nothing is simulated of a layout with errors.
    pub fn simulation(self) -> Result<lss::chain_input::Simulation, Failure> {
        match self.fails {
            true => Err(Failure::Layout(self.said)),
            false => Ok(lss::chain_input::Simulation::new(&self.compiled)),
        }
    }
}

/// A layout that was built.
#[pyclass(frozen, module = "lss._lss")]
pub struct Layout(pub Arc<Built>);

#[pymethods]
impl Layout {
    #[getter]
    fn name(&self) -> &str {
        &self.0.compiled.layout.name
    }

    /// What is proven, and the sums, as JSON.
    #[getter]
    fn summary(&self) -> &str {
        &self.0.summary
    }

    /// `layout.json`
    fn layout_json<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &emit::layout::json(&self.0.compiled))
    }

    /// `bom.json`
    fn bom_json<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &bom::json(&self.0.compiled, &OwnNumbers::default()))
    }

    /// The drawing as SVG.
    fn svg(&self, py: Python) -> PyResult<String> {
        let built = self.0.clone();
        let drawn = py.detach(move || svg::drawing(&built.compiled, svg::Theme::Adaptive));
        drawn.map_err(|why| Failure::Run(why.to_string()).raised(py, None))
    }

    /// Diagnostics as a terminal shows them, and as JSON.
    #[getter]
    fn said(&self) -> (String, Vec<String>) {
        (self.0.said.text.clone(), self.0.said.json.clone())
    }

    /// The layout with the vertices that were found; `None` where they were written.
    #[getter]
    fn text(&self) -> Option<&str> {
        self.0.text.as_deref()
    }

    fn simulation(&self) -> super::simulate::Simulation {
        super::simulate::Simulation(Arc::new(lss::chain_input::Simulation::new(&self.0.compiled)))
    }

    /// Writes the files of `lss build`, all of them or none.
    #[pyo3(signature = (folder, more))]
    fn write(&self, py: Python, folder: PathBuf, more: Vec<String>) -> PyResult<()> {
        let built = self.0.clone();
        let written = py.detach(move || {
            let files = files(&built, &more).map_err(Failure::Run)?;
            files.write_set(&folder, "build").map_err(|why| Failure::file("write", &why.path, &why.reason))
        });
        written.map_err(|why| why.raised(py, None))
    }
}

/// The files of a build with more of them: `stages`, `pdf`, `report`, `xlsx`, `gltf`.
fn files(built: &Built, more: &[String]) -> Result<Files, String> {
    let (compiled, own) = (&built.compiled, OwnNumbers::default());
    let words = |why: emit::DrawError| why.to_string();
    let asked = |name: &str| more.iter().any(|own| own == name);
    let mut files = Files::default();
    files.extend(emit::data_files(compiled, &own));
    files.extend(emit::drawing_files(compiled).map_err(words)?);
    if asked("stages") {
        let written = compiled.layout.corners();
        files.push("stages.svg", emit::stages_svg(compiled, &written).map_err(words)?);
        files.push("stages.png", emit::stages_png(compiled, &written).map_err(words)?);
    }
    if asked("pdf") {
        files.push("drawing.pdf", emit::drawing_pdf(compiled).map_err(words)?);
    }
    if asked("report") {
        files.push("report.pdf", emit::report_pdf(compiled, &own).map_err(words)?);
    }
    if asked("xlsx") {
        files.push("bom.xlsx", emit::xlsx::bill(compiled, &own).map_err(words)?);
    }
    if asked("gltf") {
        files.push("track.glb", emit::gltf::scene(compiled));
    }
    if let Some(text) = &built.text {
        files.push("layout.lss", text.as_str());
    }
    Ok(files)
}

/// Builds a layout. `text` stands in for the file where it is given.
#[pyfunction]
#[pyo3(signature = (path, text, layout, lets, nodes, gap, time_limit, threads_asked, progress))]
#[allow(clippy::too_many_arguments)]
pub fn build(
    py: Python,
    path: PathBuf,
    text: Option<String>,
    layout: Option<String>,
    lets: Vec<(String, String)>,
    nodes: usize,
    gap: f64,
    time_limit: Option<f64>,
    threads_asked: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Layout> {
    let time = time_limit.map(Duration::try_from_secs_f64).transpose();
    let time = time.map_err(|why| Failure::Value(format!("time_limit: {why}")).raised(py, None))?;
    let limits = Limits { nodes, gap, time, threads: threads(threads_asked) };
    let (source, ended) = (Source { path, text, layout, lets }, flag());
    let built = work(py, progress, ended, move |board| Built::new(&source, limits, ended, board))?;
    let built = Arc::new(built.map_err(|why| why.raised(py, None))?);
    if built.fails {
        let failure = Failure::Layout(built.said.clone());
        let found = Py::new(py, Layout(built))?.into_any();
        return Err(failure.raised(py, Some(found)));
    }
    Ok(Layout(built))
}

/// The simulation input of a file: a `.json`, or what a `.lss` builds.
pub fn simulation_of(
    path: &Path,
    layout: Option<&str>,
    threads: usize,
    ended: &'static AtomicBool,
    board: &Board,
) -> Result<lss::chain_input::Simulation, Failure> {
    if path.extension().is_some_and(|ending| ending == "json") {
        return super::simulate::read(path);
    }
    let source = Source { path: path.to_owned(), text: None, layout: layout.map(str::to_owned), lets: Vec::new() };
    let Effort { gap, nodes, .. } = Effort::default();
    Built::new(&source, Limits { nodes, gap, time: None, threads }, ended, board)?.simulation()
}

/// A document as JSON.
pub fn text<T: serde::Serialize>(document: &T) -> String {
    String::from_utf8_lossy(&to_json(document)).into_owned()
}
