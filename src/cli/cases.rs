//! The runs of a campaign with the layouts they name, for verbs that go over them.

use super::{MessageFormat, Outcome, read, report};
use crate::identify::cases::{Case, NoCases, Said};
use std::path::Path;

/// The runs that can be read, and whether some cannot; that is reported here.
pub fn cases(folder: &Path, layout: Option<&Path>) -> Result<(Vec<Case>, bool), Outcome> {
    let mut simulation = |path: &Path| read::simulation(path, None, MessageFormat::Text);
    let mut tell = |said: Said| match said {
        Said::Error(words) => report::error(&words),
        Said::Warning(words) => report::warning(&words),
    };
    crate::identify::cases::cases(folder, layout, &mut simulation, &mut tell).map_err(|why| match why {
        NoCases::Layout(outcome) => outcome,
        NoCases::Campaign(error) => {
            report::error(&error.to_string());
            if error.is_unreadable() { Outcome::CouldNotRun } else { Outcome::Problems }
        }
    })
}
