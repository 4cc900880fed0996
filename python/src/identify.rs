//! Parameters of the model from runs.

use super::build::{simulation_of, text};
use super::raise::Failure;
use super::runs::Arrays;
use super::simulate::Simulation;
use super::work::{Board, flag, threads, work};
use lss::base::parallel;
use lss::chain_input::ContactLaw;
use lss::dynamics::Width;
use lss::identify::cases::{Case, NoCases, Said, cases, common_track};
use lss::identify::groups::{RunGroup, SetPoint};
use lss::identify::law_fits::LawFits;
use lss::identify::reports::{LawReport, Study, laws_named};
use lss::identify::share::Shared;
use lss::identify::study::RunFit;
use lss::identify::{Counter, FitSettings, Parameter};
use lss::report::identification;
use lss::signal::Run;
use lss::solve::Stop;
use pyo3::prelude::*;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// A run in memory: its name, samples, and chain.
#[derive(FromPyObject)]
pub struct Given<'py> {
    name: String,
    arrays: Arrays<'py>,
    simulation: Py<Simulation>,
}

/// What is fitted: a campaign on the disk, with the layout of all its runs where that is given, or runs in memory.
pub enum Runs {
    Folder(PathBuf, Option<Simulation>),
    Memory(Vec<(String, Run, Arc<lss::chain_input::Simulation>)>),
}

impl Runs {
    pub fn new(py: Python, folder: Option<PathBuf>, given: Vec<Given>, layout: Option<Simulation>) -> PyResult<Runs> {
        match folder {
            Some(folder) => Ok(Runs::Folder(folder, layout)),
            None => {
                let one = |given: &Given| {
                    let simulation = given.simulation.get().0.clone();
                    Ok((given.name.clone(), given.arrays.run(py)?, simulation))
                };
                given.iter().map(one).collect::<PyResult<_>>().map(Runs::Memory)
            }
        }
    }

    /// The cases, and what there is to warn of; runs that cannot be used are among the warnings.
    pub fn cases(
        self,
        threads: usize,
        ended: &'static AtomicBool,
        board: &Board,
    ) -> Result<(Vec<Case>, Vec<String>), Failure> {
        let mut warnings = Vec::new();
        let found = match self {
            Runs::Memory(runs) => {
                let one = |(name, run, simulation): (String, Run, Arc<lss::chain_input::Simulation>)| {
                    let layout = PathBuf::from(&simulation.name);
                    let (case, said) = Case::new(&name, run, (*simulation).clone(), &layout, (None, None));
                    warnings.extend(said.into_iter().map(|warning| format!("{name}: {warning}")));
                    case
                };
                runs.into_iter().map(one).collect()
            }
            Runs::Folder(folder, layout) => {
                let name = layout.as_ref().map(|layout| PathBuf::from(&layout.0.name));
                let mut read = |path: &Path| match &layout {
                    Some(layout) => Ok((*layout.0).clone()),
                    None => simulation_of(path, None, threads, ended, board),
                };
                let mut tell = |said: Said| match said {
                    Said::Error(words) | Said::Warning(words) => warnings.push(words),
                };
                let found = cases(&folder, name.as_deref(), &mut read, &mut tell).map_err(|why| match why {
                    NoCases::Layout(failure) => failure,
                    NoCases::Campaign(error) if error.is_unreadable() => Failure::File(error.to_string()),
                    NoCases::Campaign(error) => Failure::Run(error.to_string()),
                })?;
                found.0
            }
        };
        if found.is_empty() {
            let why = warnings.join("\n");
            return Err(Failure::Run(format!("no run is left\n{why}").trim().to_owned()));
        }
        Ok((found, warnings))
    }
}

fn parameters(names: &[String]) -> Result<Vec<Parameter>, Failure> {
    let one = |name: &String| {
        Parameter::from_name(name).ok_or_else(|| {
            let known: Vec<&str> = Parameter::ALL.iter().map(|p| p.name()).collect();
            Failure::Value(format!("there is no parameter {name:?}; there are {}", known.join(", ")))
        })
    };
    names.iter().map(one).collect()
}

/// What is to be fitted, and how.
struct Wanted {
    laws: Vec<ContactLaw>,
    free: Vec<Parameter>,
    share: Vec<Parameter>,
    seed: u64,
    threads: usize,
}

/// What was found.
struct Found {
    /// Laws with their runs, the study, units of the parameters, and warnings.
    json: String,
    page: String,
    /// Of each run in the first law, the simulation input with what was fitted.
    fitted: Vec<(String, lss::chain_input::Simulation)>,
}

/// Fits runs. JSON, a page, and simulation inputs with what was fitted.
#[pyfunction]
#[pyo3(signature = (folder, given, layout, law, free, share, seed, threads_asked, progress))]
#[allow(clippy::too_many_arguments, clippy::type_complexity)]
pub fn identify(
    py: Python,
    folder: Option<PathBuf>,
    given: Vec<Given>,
    layout: Option<Simulation>,
    law: &str,
    free: Vec<String>,
    share: Vec<String>,
    seed: u64,
    threads_asked: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(String, String, Vec<(String, Simulation)>)> {
    let raised = |why: Failure| why.raised(py, None);
    let wanted = Wanted {
        laws: laws_named(law).map_err(|why| raised(Failure::Value(why)))?,
        free: parameters(&free).map_err(raised)?,
        share: parameters(&share).map_err(raised)?,
        seed,
        threads: threads(threads_asked),
    };
    if let Some(p) = wanted.share.iter().find(|p| !wanted.free.is_empty() && !wanted.free.contains(p)) {
        return Err(raised(Failure::Value(format!("{p} cannot be shared, as it is not fitted: add it to free"))));
    }
    let (runs, ended) = (Runs::new(py, folder, given, layout)?, flag());
    let found = work(py, progress, ended, move |board| fitted(runs, &wanted, ended, board))?.map_err(raised)?;
    let inputs = found.fitted.into_iter().map(|(run, input)| (run, Simulation(Arc::new(input)))).collect();
    Ok((found.json, found.page, inputs))
}

fn fitted(runs: Runs, wanted: &Wanted, ended: &'static AtomicBool, board: &Board) -> Result<Found, Failure> {
    let threads = wanted.threads;
    let (cases, mut warnings) = runs.cases(threads, ended, board)?;
    let settings = FitSettings {
        free: std::array::from_fn(|k| wanted.free.is_empty() || wanted.free.contains(&Parameter::ALL[k])),
        seed: wanted.seed,
        threads: (threads / cases.len()).max(1),
        stop: Stop::when(ended),
        ..FitSettings::default()
    };
    let all = cases.len() * wanted.laws.len();
    let count = AtomicUsize::new(0);
    board.tell(0.0, Some(all as f64), "fitting".into());
    let mut done: Vec<(ContactLaw, Vec<RunFit>, Vec<Shared>)> = Vec::new();
    for &law in &wanted.laws {
        let first = done.first().map(|(_, fits, _)| fits.clone());
        let width = Width::used();
        let work = LawFits { law, settings, width, first: first.as_deref(), kept_in: None, trusted: false };
        let results = parallel::map(&cases, threads, |case| {
            let fit = work.fit(case, &Counter::default());
            let done = count.fetch_add(1, Ordering::Relaxed) + 1;
            board.tell(done as f64, Some(all as f64), format!("fitted {}", case.subject.name));
            fit
        });
        let mut fits = Vec::new();
        for (case, result) in cases.iter().zip(results) {
            match result {
                Ok(fit) => fits.push(fit),
                Err(why) => warnings.push(format!("{}: {why}", case.subject.name)),
            }
        }
        if fits.is_empty() {
            return Err(Failure::Run(format!("no run could be fitted\n{}", warnings.join("\n"))));
        }
        let shared = work.share(&cases, &mut fits, &wanted.share, threads).map_err(Failure::Run)?;
        done.push((law, fits, shared.into_iter().collect()));
    }
    let points: Vec<SetPoint> = cases.iter().map(|case| case.set_point.clone()).collect();
    let groups = RunGroup::all(&points);
    let reports: Vec<LawReport> = done.iter().map(|(law, fits, shared)| LawReport::new(*law, fits, shared)).collect();
    let study = Study::new(&reports, &groups);
    warnings.extend(study.warnings());
    let pages: Vec<(ContactLaw, &[RunFit])> = done.iter().map(|(law, fits, _)| (*law, fits.as_slice())).collect();
    let units: Vec<(&str, &str)> = Parameter::ALL.iter().map(|p| (p.name(), p.unit())).collect();
    let fitted = done.first().map_or(&[][..], |(_, fits, _)| fits).iter().filter_map(|fit| {
        let case = cases.iter().find(|case| case.subject.name == fit.run)?;
        Some((fit.run.clone(), fit.input(&case.subject)))
    });
    Ok(Found {
        page: identification::page(&pages, &wanted.share, &groups, common_track(&cases)),
        fitted: fitted.collect(),
        json: text(&json!({ "laws": reports, "study": study, "units": units, "warnings": warnings })),
    })
}
