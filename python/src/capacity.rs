//! How many items an hour a layout's sorter takes.

use super::build::{Layout, text};
use super::raise::Failure;
use super::work::{flag, threads, work};
use lss::capacity::Settings;
use lss::cli::capacity::Worked;
use lss::solve::Stop;
use pyo3::prelude::*;
use std::sync::Arc;

/// What was worked out.
#[pyclass(frozen, module = "lss._lss")]
pub struct Capacity {
    layout: Arc<super::build::Built>,
    worked: Arc<Worked>,
}

#[pymethods]
impl Capacity {
    /// `capacity.json`
    fn json(&self) -> String {
        text(&self.worked.found())
    }

    /// What `lss capacity` prints.
    fn text(&self) -> String {
        self.worked.found().text()
    }

    /// `capacity.html`, for which other speeds and fewer inductions are simulated.
    #[pyo3(signature = (progress))]
    fn html(&self, py: Python, progress: Option<Py<PyAny>>) -> PyResult<String> {
        let (layout, worked) = (self.layout.clone(), self.worked.clone());
        let ended = flag();
        work(py, progress, ended, move |_| worked.page(&layout.compiled, Stop::when(ended)))
    }
}

/// Works out a layout's capacity.
#[pyfunction]
#[pyo3(signature = (layout, hours, replications, seed, threads_asked, progress))]
pub fn capacity(
    py: Python,
    layout: &Layout,
    hours: f64,
    replications: usize,
    seed: u64,
    threads_asked: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Capacity> {
    let ended = flag();
    let settings = Settings { hours, replications, seed, threads: threads(threads_asked), stop: Stop::when(ended) };
    let built = layout.0.clone();
    let worked = work(py, progress, ended, move |board| {
        board.tell(0.0, None, "simulating items".to_owned());
        Worked::new(&built.compiled, settings)
    })?;
    let worked = Arc::new(worked.map_err(|why| Failure::Run(why).raised(py, None))?);
    Ok(Capacity { layout: layout.0.clone(), worked })
}
