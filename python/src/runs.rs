//! Runs: NumPy arrays to samples and back.

use super::raise::Failure;
use super::simulate::Simulation;
use lss::base::json::to_json;
use lss::emit::Files;
use lss::report::lap;
use lss::signal::position::position as positioned;
use lss::signal::{self, Channel, SupportLoad, csv, parquet};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

/// What is known about a run beside its samples.
#[pyclass(frozen, module = "lss._lss")]
#[derive(Clone)]
pub struct Sidecar {
    pub own: signal::Sidecar,
    /// What the supports carry, for the page of a lap.
    pub supports: Arc<Vec<SupportLoad>>,
}

#[pymethods]
impl Sidecar {
    #[new]
    #[pyo3(signature = (layout, sensor_cart, speed_setpoint, trigger_position, lowpass, laps, tension_setpoint=None, zeroed=Vec::new()))]
    #[expect(clippy::too_many_arguments, reason = "the keys of a sidecar, given by name")]
    fn new(
        layout: String,
        sensor_cart: usize,
        speed_setpoint: f64,
        trigger_position: f64,
        lowpass: f64,
        laps: usize,
        tension_setpoint: Option<f64>,
        zeroed: Vec<String>,
    ) -> PyResult<Sidecar> {
        let zeroed = zeroed.iter().map(|name| channel(name, &Channel::FORCES)).collect::<Result<_, _>>();
        let zeroed = zeroed.map_err(PyValueError::new_err)?;
        let notes = BTreeMap::new();
        let own = signal::Sidecar {
            layout,
            sensor_cart,
            speed_setpoint,
            tension_setpoint,
            trigger_position,
            lowpass,
            laps,
            zeroed,
            notes,
        };
        Ok(Sidecar { own, supports: Arc::default() })
    }

    /// As JSON.
    fn json(&self) -> String {
        serde_json::to_string(&self.own).unwrap_or_default()
    }
}

/// The channel of a name.
fn channel(name: &str, known: &[Channel]) -> Result<Channel, String> {
    Channel::from_name(name).filter(|found| known.contains(found)).ok_or_else(|| {
        let known: Vec<&str> = known.iter().map(|channel| channel.name()).collect();
        format!("there is no channel {name:?}; there are {}", known.join(", "))
    })
}

/// A run of arrays: each is copied once, in memory.
#[derive(FromPyObject)]
pub struct Arrays<'py> {
    time: PyReadonlyArray1<'py, f64>,
    channels: BTreeMap<String, PyReadonlyArray1<'py, f64>>,
    #[pyo3(attribute("_sidecar"))]
    sidecar: Py<Sidecar>,
}

impl Arrays<'_> {
    pub fn run(&self, py: Python) -> PyResult<signal::Run> {
        let wrong = |why: String| Failure::Value(why).raised(py, None);
        let time = self.time.as_array().to_vec();
        if !time.windows(2).all(|two| two[0] < two[1]) || !time.iter().all(|t| t.is_finite()) {
            return Err(wrong("time has to be finite and to increase from sample to sample".into()));
        }
        let mut channels = BTreeMap::new();
        for (name, samples) in &self.channels {
            let channel = channel(name, &Channel::ALL).map_err(wrong)?;
            let samples = samples.as_array().to_vec();
            if samples.len() != time.len() {
                return Err(wrong(format!("{name} has {} samples, time has {}", samples.len(), time.len())));
            }
            if samples.iter().any(|x| x.abs() > channel.farthest()) {
                return Err(wrong(format!("{name} has a sample beyond ±{:e} {}", channel.farthest(), channel.unit())));
            }
            channels.insert(channel, samples);
        }
        let own = self.sidecar.get().own.clone();
        Ok(signal::Run { time, channels, sidecar: own })
    }
}

/// A run as arrays.
type Samples<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyDict>, Sidecar);

/// Reads a run's data file with its sidecar.
#[pyfunction]
pub fn read_run<'py>(py: Python<'py>, path: PathBuf) -> PyResult<Samples<'py>> {
    let read = py.detach(|| signal::Entry::read(&path)).map(|(_, run)| run);
    let run = read.map_err(|why| {
        let words = why.to_string();
        if why.is_unreadable() { Failure::File(words) } else { Failure::Run(words) }.raised(py, None)
    })?;
    let channels = PyDict::new(py);
    for (channel, samples) in run.channels {
        channels.set_item(channel.name(), samples.into_pyarray(py))?;
    }
    Ok((run.time.into_pyarray(py), channels, Sidecar { own: run.sidecar, supports: Arc::default() }))
}

/// Writes the files of `lss simulate`, all of them or none.
#[pyfunction]
pub fn write_run(
    py: Python,
    arrays: Arrays,
    simulation: Option<&Simulation>,
    folder: PathBuf,
    name: String,
    format: &str,
) -> PyResult<()> {
    let run = arrays.run(py)?;
    let mut files = Files::default();
    match format {
        "csv" => files.push(format!("{name}.csv"), csv::write(&run)),
        "parquet" => {
            let bytes = parquet::write(&run).map_err(|why| Failure::Run(why.to_string()).raised(py, None))?;
            files.push(format!("{name}.parquet"), bytes);
        }
        other => {
            let why = format!("format is {other:?}; it is \"csv\" or \"parquet\"");
            return Err(Failure::Value(why).raised(py, None));
        }
    }
    files.push(format!("{name}.toml"), run.sidecar.write());
    if let Some(simulation) = simulation {
        files.push("simulation.json", to_json(&*simulation.0));
        files.push("lap.html", lap::page(&simulation.0, &run, &arrays.sidecar.get().supports));
    }
    let written = py.detach(|| files.write_set(&folder, "simulate"));
    written.map_err(|why| Failure::file("write", &why.path, &why.reason).raised(py, None))
}

/// Arc length travelled at each sample, m; `None` without an edge of the trigger.
#[pyfunction]
pub fn position<'py>(py: Python<'py>, arrays: Arrays, lap: f64) -> PyResult<Option<Bound<'py, PyArray1<f64>>>> {
    let run = arrays.run(py)?;
    Ok(positioned(&run, lap).map(|position| position.s.into_pyarray(py)))
}

/// Name, unit and meaning of every channel.
#[pyfunction]
pub fn channels() -> Vec<(&'static str, &'static str, &'static str)> {
    Channel::ALL.iter().map(|c| (c.name(), c.unit(), c.label())).collect()
}
