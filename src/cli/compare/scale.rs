//! Where lap length and cart pitch come from.

use crate::base::number::fixed;
use crate::chain_input::Simulation;
use crate::cli::{MessageFormat, Outcome, read};
use crate::identify::cases::named_layout;
use crate::signal::compare::Scale;
use crate::signal::{Entry, Run, position};
use crate::source::shown;
use std::path::{Path, PathBuf};

/// By what share a lap's speed may be off its set point: a layout for which it is further is another track's.
const FAR: f64 = 0.1;

/// Lap and pitch in metres, each with where it was found.
pub struct Known {
    pub lap: Option<(f64, String)>,
    pub pitch: Option<(f64, String)>,
    /// The layout that they come from, where it is one.
    pub simulation: Option<Simulation>,
    pub warnings: Vec<String>,
}

impl Known {
    /// What was told on the command line goes first, then `layout`, which is said to be that of both, then the layouts
    /// that campaign and sidecars name, then the runs themselves. What is wrong with `layout` is told, and an error.
    pub fn new(
        lap: Option<f64>,
        pitch: Option<f64>,
        layout: Option<&Path>,
        sides: &[(&Entry, &Run); 2],
    ) -> Result<Self, Outcome> {
        let mut warnings = Vec::new();
        let mut layouts = Vec::new();
        let mut take = |path: &Path, layout: Simulation| {
            layouts.push((layout.chain.track_length_m, layout.chain.pitch_m, shown(path), layout));
        };
        if let Some(path) = layout {
            take(path, read::simulation(path, None, MessageFormat::Text)?);
        } else {
            // Runs of one campaign have one layout, which is built once.
            let paths = sides.map(|(entry, _)| entry.layout.as_path());
            let found = simulation_of(sides[0].0);
            let other = if paths[0] == paths[1] { found.clone() } else { simulation_of(sides[1].0) };
            for (path, read) in [found, other].into_iter().flatten() {
                match read {
                    Ok(layout) => take(&path, layout),
                    Err(why) => {
                        let warning = format!("{} is not taken into account: {why}", shown(&path));
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
        for (entry, run) in sides {
            if let Some((length, .., name, _)) = layouts.first()
                && let Some(time) = position::lap_time(run)
                && (length / time / run.sidecar.speed_setpoint - 1.0).abs() > FAR
            {
                warnings.push(format!(
                    "{}: {length_text} m of {name} in {} s between triggers is {} m/s, and it was set to {} m/s: is it of this track?",
                    shown(&entry.file),
                    fixed(time, 2),
                    fixed(length / time, 3),
                    fixed(run.sidecar.speed_setpoint, 3),
                    length_text = fixed(*length, 3),
                ));
            }
        }
        let told = |value: Option<f64>, option: &str| value.map(|v| (v, option.to_owned()));
        let lap_of = |(_, run): &(&Entry, &Run)| {
            let lap = position::lap_time(run)? * run.sidecar.speed_setpoint;
            Some((lap, "the trigger's lap time and the nominal speed".to_owned()))
        };
        let found = layouts.first();
        // Another lap than that of the layout is another track.
        let as_built = |l: &&(f64, f64, String, Simulation)| lap.is_none_or(|lap| (lap - l.0).abs() < 1e-3 * l.0);
        Ok(Known {
            simulation: found.filter(as_built).map(|l| l.3.clone()),
            lap: told(lap, "--lap")
                .or_else(|| found.map(|l| (l.0, l.2.clone())))
                .or_else(|| sides.iter().find_map(lap_of)),
            pitch: told(pitch, "--pitch").or_else(|| found.map(|l| (l.1, l.2.clone()))),
            warnings,
        })
    }

    pub fn lap(&self) -> Option<f64> {
        self.lap.as_ref().map(|l| l.0)
    }

    pub fn scale(&self, exponent: f64) -> Scale {
        Scale { lap: self.lap(), pitch: self.pitch.as_ref().map(|p| p.0), exponent }
    }
}

/// The layout that a run's campaign or sidecar names, as the input of its simulation: its file, and what it says or why
/// it cannot be used. A `.lss` that is not there is none: runs are handed on without it.
pub fn simulation_of(entry: &Entry) -> Option<(PathBuf, Result<Simulation, String>)> {
    let path = match named_layout(entry) {
        Ok(path) => path,
        Err(_) if !read::is_json(&entry.layout) => return None,
        Err(why) => return Some((entry.layout.clone(), Err(why))),
    };
    let read = read::simulation_quietly(&path).map_err(|_| "it cannot be used".to_owned());
    Some((path, read))
}
