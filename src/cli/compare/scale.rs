//! Where lap length and cart pitch come from.

use super::beside;
use crate::base::number::fixed;
use crate::chain_input::Simulation;
use crate::signal::compare::Scale;
use crate::signal::{Run, position};
use crate::source::{Root, input, shown};
use std::path::{Path, PathBuf};

/// Lap and pitch in metres, each with where it was found.
pub struct Known {
    pub lap: Option<(f64, String)>,
    pub pitch: Option<(f64, String)>,
    /// The layout that they come from, where it is one.
    pub simulation: Option<Simulation>,
    pub warnings: Vec<String>,
}

impl Known {
    /// What was told on the command line goes first, then the layouts of the runs' sidecars, then the runs themselves.
    pub fn new(lap: Option<f64>, pitch: Option<f64>, sides: &[(&Path, &Run); 2]) -> Self {
        let mut warnings = Vec::new();
        let mut layouts = Vec::new();
        for (data, run) in sides {
            if let Some((path, read)) = simulation_of(data, run) {
                let name = shown(&path);
                match read {
                    Ok(layout) => layouts.push((layout.chain.track_length_m, layout.chain.pitch_m, name, layout)),
                    Err(why) => {
                        let warning = format!("{name} is not taken into account: {why}");
                        if !warnings.contains(&warning) {
                            warnings.push(warning);
                        }
                    }
                }
            }
        }
        if let [(a, ..), (b, ..)] = layouts[..]
            && (a - b).abs() > 1e-3 * a
        {
            let (a, b) = (fixed(a, 3), fixed(b, 3));
            warnings
                .push(format!("the runs are of different tracks: a lap is {a} m in the first and {b} m in the second"));
        }
        let told = |value: Option<f64>, option: &str| value.map(|v| (v, option.to_owned()));
        let lap_of = |(_, run): &(&Path, &Run)| {
            let lap = position::lap_time(run)? * run.sidecar.speed_setpoint;
            Some((lap, "the trigger's lap time and the nominal speed".to_owned()))
        };
        let found = layouts.first();
        // Another lap than that of the layout is another track.
        let as_built = |l: &&(f64, f64, String, Simulation)| lap.is_none_or(|lap| (lap - l.0).abs() < 1e-3 * l.0);
        Known {
            simulation: found.filter(as_built).map(|l| l.3.clone()),
            lap: told(lap, "--lap")
                .or_else(|| found.map(|l| (l.0, l.2.clone())))
                .or_else(|| sides.iter().find_map(lap_of)),
            pitch: told(pitch, "--pitch").or_else(|| found.map(|l| (l.1, l.2.clone()))),
            warnings,
        }
    }

    pub fn lap(&self) -> Option<f64> {
        self.lap.as_ref().map(|l| l.0)
    }

    pub fn scale(&self, exponent: f64) -> Scale {
        Scale { lap: self.lap(), pitch: self.pitch.as_ref().map(|p| p.0), exponent }
    }
}

/// The input of the simulation that a run's sidecar names, if it names one: its file, and what it says.
pub fn simulation_of(data: &Path, run: &Run) -> Option<(PathBuf, Result<Simulation, String>)> {
    let path = beside(data, &run.sidecar.layout);
    let read = path.extension().is_some_and(|e| e == "json").then(|| read(data, &path))?;
    Some((path, read))
}

/// The layout that the sidecar of some data names.
fn read(data: &Path, path: &Path) -> Result<Simulation, String> {
    let root = Root::of_campaign(data.parent().unwrap_or(Path::new("")));
    let bytes = root.read(path, input::JSON_LIMIT).map_err(|why| why.to_string())?;
    Simulation::read(&bytes).map_err(|why| format!("it{why}"))
}
