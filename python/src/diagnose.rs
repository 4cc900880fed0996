//! The gap between runs and the simulation of their layouts.

use super::build::text;
use super::identify::{Given, Runs};
use super::raise::Failure;
use super::simulate::Simulation;
use super::work::{Board, flag, threads, work};
use lss::base::json::to_json;
use lss::dynamics::Width;
use lss::gap::chain::{Chains, Work};
use lss::gap::{Answer, Costs, Settings, Simulator, Stage, diagnose_and_explain, diagnose_runs};
use lss::identify::study::Subject;
use lss::report::gap;
use lss::solve::Stop;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

/// What was found.
struct Found {
    /// `gap.json`
    json: Vec<u8>,
    page: String,
    cost: String,
    warnings: Vec<String>,
}

/// Diagnoses runs. `gap.json`, `gap.html`, what it cost, and warnings.
#[pyfunction]
#[pyo3(signature = (folder, given, layout, title, seed, threads_asked, progress))]
#[allow(clippy::too_many_arguments, clippy::type_complexity)]
pub fn diagnose<'py>(
    py: Python<'py>,
    folder: Option<PathBuf>,
    given: Vec<Given<'py>>,
    layout: Option<Simulation>,
    title: String,
    seed: u64,
    threads_asked: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Bound<'py, PyBytes>, String, String, Vec<String>)> {
    let (runs, ended) = (Runs::new(py, folder, given, layout)?, flag());
    let threads = threads(threads_asked);
    let found = work(py, progress, ended, move |board| diagnosed(runs, &title, seed, threads, ended, board))?;
    let found = found.map_err(|why| why.raised(py, None))?;
    Ok((PyBytes::new(py, &found.json), found.page, found.cost, found.warnings))
}

fn diagnosed(
    runs: Runs,
    title: &str,
    seed: u64,
    threads: usize,
    ended: &'static AtomicBool,
    board: &Board,
) -> Result<Found, Failure> {
    let (cases, warnings) = runs.cases(threads, ended, board)?;
    let subjects: Vec<Subject> = cases.into_iter().map(|case| case.subject).collect();
    let settings = Settings::default();
    let work = Work { seed, threads, width: Width::used(), stop: Stop::when(ended) };
    let tell = |run: &str| board.tell(0.0, None, format!("fitted {run}"));
    board.tell(0.0, None, "fitting the nominal model to each run".into());
    let mut costs = Costs::new("nominal_fits");
    let mut diagnose = |chains: &Chains, _: usize| {
        costs.enter("nominal_fits", chains.effort());
        let (found, explained) = diagnose_and_explain(chains, &settings, &mut |stage| {
            costs.enter(stage.name(), chains.effort());
            let (done, total, words) = match stage {
                Stage::Screening { done, of } => (done, Some(of), "screening effects"),
                Stage::Relinearising { done, of } => (done, Some(of), "looking again"),
                Stage::Fitting { done, of } => (done, Some(of), "fitting what is left"),
                Stage::Replicating => (0, None, "simulating replicates"),
                Stage::ByChance => (0, None, "trying differences by chance"),
            };
            board.tell(done as f64, total.map(|of| of as f64), words.into());
        });
        let cost = costs.clone().finish(chains.effort());
        costs.enter("nominal_fits", chains.effort());
        Answer { found, explained, cost }
    };
    let (_, answer) = diagnose_runs(&subjects, &settings, work, &tell, &mut diagnose)
        .map_err(|(run, why)| Failure::Run(format!("{run}: {why}\n  help: leave the run out")))?;
    // One map is drawn of runs on one layout.
    let track = subjects.first().map(|first| &first.simulation.track);
    let track = track.filter(|track| subjects.iter().all(|s| s.simulation.track == **track));
    Ok(Found {
        json: to_json(&answer.found),
        page: gap::page(&answer.found, track, title),
        cost: text(&answer.cost),
        warnings,
    })
}
