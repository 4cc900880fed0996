//! Carts, speed, motors and radii that do what a layout requires for the least money.

use super::build::{Source, analysed, text};
use super::raise::{Failure, Said};
use super::work::{Board, flag, threads, work};
use lss::choose::{Measure, Settings, Told, refused, undominated, write};
use lss::diagnostic::Diagnostic;
use lss::dynamics::Width;
use lss::report::choice::{self as page, Found};
use lss::semantics::given::GivenLet;
use lss::solve::{Options, Stop, unsupported};
use lss::source::SourceMap;
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// `choice.json`, `choice.html`, `candidates.csv`, and the layout with the choice.
type Files = (String, String, Vec<u8>, Option<String>);

fn chosen(
    source: &Source,
    measures: &[Measure],
    (checks, threads): (usize, usize),
    ended: &'static AtomicBool,
    board: &Board,
) -> Result<Files, Failure> {
    let mut sources = SourceMap::default();
    let (layout, mut said) = analysed(&mut sources, source)?;
    said.extend(unsupported(&layout));
    if said.iter().any(Diagnostic::is_error) {
        return Err(Failure::Layout(Said::new(&sources, &said)));
    }
    if measures.contains(&Measure::Energy) && layout.choice.energy.is_none() {
        let why = "pareto: energy needs to know how long the sorter runs\n  help: say it with a line such as `energy 0.22 \
                   EUR/kWh for 6000 h per year over 10 years`";
        return Err(Failure::Value(why.to_owned()));
    }
    let options = Options { threads, stop: Stop::when(ended), ..Options::default() };
    let settings = Settings { options, width: Width::used(), checks, tracks_within: None };
    let (tracks, simulated, checked) = (AtomicUsize::new(0), AtomicUsize::new(0), AtomicUsize::new(0));
    let one_more = |count: &AtomicUsize| count.fetch_add(1, Ordering::Relaxed) + 1;
    let chosen = lss::choose::choose(&layout, &settings, &|told| {
        let (done, words) = match told {
            Told::Track => (one_more(&tracks), "tracks solved"),
            Told::Capacity => (one_more(&simulated), "candidates with their capacity simulated"),
            Told::Check => (one_more(&checked), "candidates in the dynamic model"),
        };
        board.tell(done as f64, None, words.to_owned());
    });
    let chosen = chosen.map_err(|too_many| Failure::Run(too_many.to_string()))?;
    said.extend(refused(&chosen));
    if said.iter().any(Diagnostic::is_error) {
        return Err(Failure::Layout(Said::new(&sources, &said)));
    }
    let trade = (!measures.is_empty()).then(|| undominated(&chosen, measures));
    let winner = chosen.winner.map(|k| &chosen.candidates[k]);
    Ok((
        text(&Found::new(&chosen, measures, trade.as_deref())),
        page::page(&chosen, measures, trade.as_deref()),
        page::table(&chosen).map_err(Failure::Run)?,
        winner.and_then(|candidate| write::text(&sources, &chosen, candidate)),
    ))
}

/// Chooses. `text` stands in for the file where it is given.
#[pyfunction]
#[pyo3(signature = (path, text, layout, lets, pareto, checks, threads_asked, progress))]
#[allow(clippy::too_many_arguments)]
pub fn choose(
    py: Python,
    path: PathBuf,
    text: Option<String>,
    layout: Option<String>,
    lets: Vec<GivenLet>,
    pareto: Vec<String>,
    checks: usize,
    threads_asked: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Files> {
    let mut measures = Vec::new();
    for name in &pareto {
        let known = Measure::ALL.into_iter().find(|measure| measure.words().0 == name && !measures.contains(measure));
        let Some(measure) = known else {
            let all = Measure::ALL.map(|measure| measure.words().0).join(", ");
            let why = format!("pareto: {name:?} is no measure, or one that is named twice; there are {all}");
            return Err(Failure::Value(why).raised(py, None));
        };
        measures.push(measure);
    }
    if !matches!(measures.len(), 0 | 2 | 3) {
        let why = format!("pareto takes two or three measures, such as price and capacity, and not {}", measures.len());
        return Err(Failure::Value(why).raised(py, None));
    }
    let (source, ended, threads) = (Source { path, text, layout, lets }, flag(), threads(threads_asked));
    let found = work(py, progress, ended, move |board| chosen(&source, &measures, (checks, threads), ended, board))?;
    found.map_err(|why| why.raised(py, None))
}
