//! Simulations, and their input.

use super::build::{Layout, simulation_of};
use super::raise::Failure;
use super::runs::Sidecar;
use super::work::{flag, threads, work};
use lss::base::json::to_json;
use lss::chain_input;
use lss::cli::simulate::report;
use lss::dynamics::{End, Method, Outcome, Plan, Width, parameters};
use lss::effects;
use lss::source::{input, root};
use numpy::{IntoPyArray, PyArray1};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Instant;

/// The input of a simulation.
#[pyclass(frozen, from_py_object, module = "lss._lss")]
#[derive(Clone)]
pub struct Simulation(pub Arc<chain_input::Simulation>);

/// Reads a `simulation.json`.
pub fn read(path: &Path) -> Result<chain_input::Simulation, Failure> {
    let bytes = root::read_given(path, input::JSON_LIMIT).map_err(|why| Failure::file("read", path, why))?;
    chain_input::Simulation::read(&bytes).map_err(|why| Failure::Value(format!("{}{why}", path.display())))
}

#[pymethods]
impl Simulation {
    /// That of a file: a simulation.json, or what a layout builds.
    #[staticmethod]
    #[pyo3(signature = (path, layout, threads_asked, progress))]
    fn of_file(
        py: Python,
        path: PathBuf,
        layout: Option<String>,
        threads_asked: Option<usize>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Simulation> {
        let (ended, threads) = (flag(), threads(threads_asked));
        let found =
            work(py, progress, ended, move |board| simulation_of(&path, layout.as_deref(), threads, ended, board))?;
        Ok(Simulation(Arc::new(found.map_err(|why| why.raised(py, None))?)))
    }

    /// That of a layout.
    #[staticmethod]
    fn of_layout(layout: &Layout) -> Simulation {
        Simulation(Arc::new(chain_input::Simulation::new(&layout.0.compiled)))
    }

    /// From `simulation.json`'s bytes.
    #[staticmethod]
    fn of_json(py: Python, bytes: &[u8]) -> PyResult<Simulation> {
        match chain_input::Simulation::read(bytes) {
            Ok(simulation) => Ok(Simulation(Arc::new(simulation))),
            Err(why) => Err(Failure::Value(format!("the simulation input{why}")).raised(py, None)),
        }
    }

    /// `simulation.json`
    fn json<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        PyBytes::new(py, &to_json(&*self.0))
    }

    /// Each number of the model, by name.
    fn parameters(&self) -> Vec<(String, String)> {
        parameters::parameters(&self.0)
    }

    /// With other numbers, in turn.
    fn with_set(&self, py: Python, sets: Vec<(String, String)>) -> PyResult<Simulation> {
        match parameters::set(&self.0, &sets) {
            Ok(changed) => Ok(Simulation(Arc::new(changed))),
            Err(why) => {
                let why = format!("{why}; `.parameters` has all with their values");
                Err(Failure::Value(why).raised(py, None))
            }
        }
    }

    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }
}

/// Simulates. Time, channels by name, what goes into the sidecar, the summary as JSON, and why it ended early.
#[pyfunction]
#[pyo3(signature = (simulation, laps, settle, step, integrator, supports, progress))]
#[allow(clippy::too_many_arguments, clippy::type_complexity)]
pub fn simulate<'py>(
    py: Python<'py>,
    simulation: &Simulation,
    laps: usize,
    settle: f64,
    step: Option<f64>,
    integrator: &str,
    supports: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Bound<'py, PyArray1<f64>>, Bound<'py, PyDict>, Sidecar, String, Option<String>)> {
    let method = match integrator {
        "verlet" => Method::Verlet,
        "cash_karp" => Method::CashKarp,
        other => {
            let why = format!("integrator is {other:?}; it is \"verlet\" or \"cash_karp\"");
            return Err(Failure::Value(why).raised(py, None));
        }
    };
    let plan = Plan { laps, settle, step, method, supports, ..Plan::default() };
    let (input, ended) = (simulation.0.clone(), flag());
    let begin = Instant::now();
    let outcome = work(py, progress, ended, move |board| {
        effects::simulate(&input, &plan, Width::used(), &mut |progress| {
            let doing = if progress.laps > 0.0 { "recording" } else { "settling" };
            let words = format!("{doing}, {:.1} s, lap {:.2}", progress.time, progress.laps);
            board.tell(progress.done, Some(1.0), words);
            !ended.load(Ordering::Relaxed)
        })
    })?;
    let outcome = outcome.map_err(|why| Failure::Value(why.to_string()).raised(py, None))?;
    let summary = report::json(&simulation.0, &outcome, begin.elapsed().as_secs_f64());
    let Outcome { end, run, supports, .. } = outcome;
    let trouble = match end {
        End::Trouble(trouble) => Some(format!("the simulation stopped: {trouble}\n  help: {}", trouble.advice())),
        End::Complete | End::Interrupted => None,
    };
    let channels = PyDict::new(py);
    for (channel, samples) in run.channels {
        channels.set_item(channel.name(), samples.into_pyarray(py))?;
    }
    let sidecar = Sidecar { own: run.sidecar, supports: Arc::new(supports) };
    Ok((run.time.into_pyarray(py), channels, sidecar, summary, trouble))
}
