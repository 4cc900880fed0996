//! The runs of a campaign with the layouts they name.

use super::Measured;
use super::groups::SetPoint;
use super::study::Subject;
use crate::base::number::fixed;
use crate::chain_input::{Simulation, Track};
use crate::signal::health::{Implausible, health};
use crate::signal::{self, Channel, Entry, Run, RunError};
use crate::source::{InputError, shown};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Laps from which a run is taken to go once around: its ends are not known to the sample.
const WHOLE_LAP: f64 = 0.98;

/// A run and the layout it names.
pub struct Case {
    pub subject: Subject,
    /// The layout's file.
    pub layout: PathBuf,
    /// As the campaign has it, else the sidecar and the layout.
    pub set_point: SetPoint,
}

/// What there is to say of a campaign's runs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Said {
    /// A run is left out.
    Error(String),
    Warning(String),
}

/// Why there are no cases.
pub enum NoCases<E> {
    /// The campaign cannot be read.
    Campaign(RunError),
    /// A layout cannot be.
    Layout(E),
}

impl Case {
    /// A run on a chain, and what there is to warn of. `layout` is what the layout is called; `speed` (m/s) and
    /// `tension` (N) are the campaign's; else the sidecar's count, and of the tension then the layout's.
    pub fn new(
        name: &str,
        mut run: Run,
        mut simulation: Simulation,
        layout: &Path,
        (speed, tension): (Option<f64>, Option<f64>),
    ) -> (Case, Vec<String>) {
        if let Some(tension) = tension.or(run.sidecar.tension_setpoint) {
            simulation.chain.tension_n = tension;
        }
        let found = health(&run, Some(&simulation));
        // How much of the lap it covers, the wheels may know better.
        let mut warnings = [run.warnings(None), found.suspicions].concat();
        for (channel, spikes) in &found.spikes {
            let Some(samples) = run.channels.get_mut(channel) else { continue };
            spikes.iter().for_each(|k| samples[*k] = f64::NAN);
        }
        if let Some(place) = found.trigger_position {
            warnings.push(format!("trigger_position is taken to be {} m", fixed(place, 1)));
            run.sidecar.trigger_position = place;
        }
        let (zeroed, implausible): (Vec<_>, Vec<_>) = found.implausible.into_iter().partition(|found| found.zeroed);
        let channels = |found: Vec<Implausible>| found.into_iter().flat_map(|found| found.channels).collect();
        let implausible: Vec<Channel> = channels(implausible);
        let names = |channels: &[Channel]| channels.iter().map(|c| c.name()).collect::<Vec<_>>().join(", ");
        if !implausible.is_empty() {
            warnings.push(format!("left out: {}", names(&implausible)));
            run.channels.retain(|channel, _| !implausible.contains(channel));
        }
        let mut zeroed: Vec<Channel> = channels(zeroed);
        zeroed.retain(|channel| !run.sidecar.zeroed.contains(channel));
        if !zeroed.is_empty() {
            warnings.push(format!("compared without their means: {}", names(&zeroed)));
            run.sidecar.zeroed.extend(zeroed);
        }
        let duration = run.duration();
        if let Ok(measured) = Measured::new(&run, &simulation, simulation.chain.track_length_m) {
            if measured.unsteady > 0.0 {
                warnings.push(format!(
                    "{} s of {} s are left out, as the chain's speed changed or swung from a change before",
                    fixed(measured.unsteady, 1),
                    fixed(duration, 1)
                ));
            }
            if measured.laps < WHOLE_LAP {
                warnings.push(format!(
                    "it covers {} of a lap: of the rest of the track nothing can be told",
                    fixed(measured.laps, 2)
                ));
            }
        }
        let set_point = SetPoint {
            run: name.to_owned(),
            layout: layout.display().to_string(),
            speed: speed.unwrap_or(run.sidecar.speed_setpoint),
            tension: simulation.chain.tension_n,
        };
        let subject = Subject { name: name.to_owned(), run, simulation };
        (Case { subject, layout: layout.to_owned(), set_point }, warnings)
    }
}

/// The runs of a campaign that can be read, and whether some cannot. `layout` is that of all runs instead of those that
/// they name; `simulation` reads a layout.
///
/// # Errors
///
/// [`NoCases`]; the first layout that cannot be read ends it.
pub fn cases<E>(
    folder: &Path,
    layout: Option<&Path>,
    simulation: &mut dyn FnMut(&Path) -> Result<Simulation, E>,
    tell: &mut dyn FnMut(Said),
) -> Result<(Vec<Case>, bool), NoCases<E>> {
    let (campaign, refused) = signal::Campaign::read_each(folder).map_err(NoCases::Campaign)?;
    let mut broken = !refused.is_empty();
    refused.iter().for_each(|r| tell(Said::Error(r.error.to_string())));
    let mut layouts: BTreeMap<PathBuf, Simulation> = BTreeMap::new();
    let mut cases = Vec::new();
    for entry in &campaign.runs {
        let path = match layout.map_or_else(|| named_layout(entry), |given| Ok(given.to_owned())) {
            Ok(path) => path,
            Err(why) => {
                tell(Said::Error(format!("{}: {why}\n  help: give it with --layout", entry.name)));
                broken = true;
                continue;
            }
        };
        let run = match entry.run() {
            Ok(run) => run,
            Err(error) => {
                tell(Said::Error(error.to_string()));
                broken = true;
                continue;
            }
        };
        if !layouts.contains_key(&path) {
            layouts.insert(path.clone(), simulation(&path).map_err(NoCases::Layout)?);
        }
        let Some(known) = layouts.get(&path) else { continue };
        let (case, warnings) = Case::new(&entry.name, run, known.clone(), &path, (entry.speed, entry.tension));
        warnings.into_iter().for_each(|warning| tell(Said::Warning(format!("{}: {warning}", entry.name))));
        cases.push(case);
    }
    Ok((cases, broken))
}

/// The track of all runs, where they have one.
pub fn common_track(cases: &[Case]) -> Option<&Track> {
    let (first, rest) = cases.split_first()?;
    let track = &first.subject.simulation.track;
    rest.iter().all(|case| case.subject.simulation.track == *track).then_some(track)
}

/// The file of the layout that a run's campaign or sidecar names, or why there is none to read.
///
/// # Errors
///
/// In words.
pub fn named_layout(entry: &Entry) -> Result<PathBuf, String> {
    let name = shown(&entry.layout);
    match entry.layout() {
        Ok(path) if path.is_file() => Ok(path.to_owned()),
        Ok(_) | Err(InputError::Missing(_)) => Err(format!("the layout {name} is not there")),
        Err(why) => Err(format!("the layout {name} is not read: {why}")),
    }
}
