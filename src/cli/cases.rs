//! The runs of a campaign with the layouts they name.

use super::{MessageFormat, Outcome, read, report};
use crate::base::number::fixed;
use crate::chain_input::Simulation;
use crate::identify::Measured;
use crate::identify::groups::SetPoint;
use crate::identify::study::Subject;
use crate::signal::{self, Entry};
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

/// The runs that can be read, and whether some cannot.
pub fn cases(folder: &Path, layout: Option<&Path>) -> Result<(Vec<Case>, bool), Outcome> {
    let (campaign, refused) = signal::Campaign::read_each(folder).map_err(|error| {
        report::error(&error.to_string());
        if error.is_unreadable() { Outcome::CouldNotRun } else { Outcome::Problems }
    })?;
    let mut broken = !refused.is_empty();
    refused.iter().for_each(|r| report::error(&r.error.to_string()));
    let mut layouts: BTreeMap<PathBuf, Simulation> = BTreeMap::new();
    let mut cases = Vec::new();
    for entry in &campaign.runs {
        let path = match layout.map_or_else(|| named_layout(entry), |given| Ok(given.to_owned())) {
            Ok(path) => path,
            Err(why) => {
                report::error(&format!("{}: {why}\n  help: give it with --layout", entry.name));
                broken = true;
                continue;
            }
        };
        let run = match entry.run() {
            Ok(run) => run,
            Err(error) => {
                report::error(&error.to_string());
                broken = true;
                continue;
            }
        };
        if !layouts.contains_key(&path) {
            layouts.insert(path.clone(), read::simulation(&path, None, MessageFormat::Text)?);
        }
        let Some(known) = layouts.get(&path) else { continue };
        let mut simulation = known.clone();
        if let Some(tension) = entry.tension {
            simulation.chain.tension_n = tension;
        }
        let mut warnings = run.warnings(None);
        // The wheels may know the speed where the sidecar's is off.
        match Measured::new(&run, &simulation, simulation.chain.track_length_m) {
            Ok(measured) if measured.laps < WHOLE_LAP => warnings.push(format!(
                "it covers {} of a lap: of the rest of the track nothing can be told",
                fixed(measured.laps, 2)
            )),
            _ => {}
        }
        for warning in warnings {
            report::warning(&format!("{}: {warning}", entry.name));
        }
        let set_point = SetPoint {
            run: entry.name.clone(),
            layout: path.display().to_string(),
            speed: entry.speed.unwrap_or(run.sidecar.speed_setpoint),
            tension: simulation.chain.tension_n,
        };
        let subject = Subject { name: entry.name.clone(), run, simulation };
        cases.push(Case { subject, layout: path, set_point });
    }
    Ok((cases, broken))
}

/// The file of the layout that a run's campaign or sidecar names, or why there is none to read.
pub fn named_layout(entry: &Entry) -> Result<PathBuf, String> {
    let name = shown(&entry.layout);
    match entry.layout() {
        Ok(path) if path.is_file() => Ok(path.to_owned()),
        Ok(_) | Err(InputError::Missing(_)) => Err(format!("the layout {name} is not there")),
        Err(why) => Err(format!("the layout {name} is not read: {why}")),
    }
}
