//! Reads runs from files.

use super::{DataProblem, Run, RunError, Sidecar, SidecarDefaults, csv, mdf4, parquet};
use crate::source::{InputError, Root, input, root};
use std::fs::File;
use std::path::Path;

impl Run {
    /// Reads `path`, which ends in `.csv`, `.parquet` or `.mf4`, and the `.toml` beside it. The path is the command
    /// line's; the sidecar has to lie within the root of its folder.
    ///
    /// # Errors
    ///
    /// What [`DataProblem`] lists, with file, row and column.
    pub fn read(path: &Path) -> Result<Run, RunError> {
        let root = Root::of_campaign(path.parent().unwrap_or(Path::new("")));
        Run::read_as(path, root::open_given(path), &root, &SidecarDefaults::default())
    }

    /// As [`Run::read`], of a path that another file names: it has to lie within the root. What the sidecar does not say
    /// of the recorder, `defaults` may.
    ///
    /// # Errors
    ///
    /// Those of [`Run::read`].
    pub fn read_within(path: &Path, root: &Root, defaults: &SidecarDefaults) -> Result<Run, RunError> {
        Run::read_as(path, root.open(path), root, defaults)
    }

    fn read_as(
        path: &Path,
        data: Result<File, InputError>,
        root: &Root,
        defaults: &SidecarDefaults,
    ) -> Result<Run, RunError> {
        let error = |problem| RunError::new(path, problem);
        let unreadable = |why: InputError| RunError::unreadable(path, why);
        let ending = ending(path);
        if !matches!(ending.as_deref(), Some("csv" | "mf4" | "parquet")) {
            return Err(error(DataProblem::foreign(path).unwrap_or(DataProblem::UnknownFormat)));
        }
        let data = data.map_err(unreadable)?;
        let (sidecar, mapping) = Sidecar::beside(path, root, defaults)?;
        let (time, channels) = match ending.as_deref() {
            Some("csv") => csv::read_mapped(bounded(data, path)?, path, &mapping)?,
            Some("mf4") => mdf4::read_mapped(bounded(data, path)?, path, &mapping)?,
            _ => parquet::read_mapped(data, path, &mapping)?,
        };
        if let Some(name) = mapping.unused() {
            return Err(error(DataProblem::NoSuchColumn).column(&name));
        }
        let run = Run { time, channels, sidecar };
        let (rate_hz, lowpass_hz) = (run.rate(), run.sidecar.lowpass);
        // Times are decimal numbers, so a rate of exactly twice the low-pass may come out a bit lower.
        if rate_hz < 2.0 * lowpass_hz * (1.0 - 1e-9) {
            return Err(error(DataProblem::Undersampled { rate_hz, lowpass_hz }));
        }
        Ok(run)
    }
}

/// Largest data file, bytes.
pub const DATA_LIMIT: u64 = 4 << 30;

/// An open data file that is read piece by piece.
pub(crate) fn bounded(data: File, path: &Path) -> Result<File, RunError> {
    input::within(&data, DATA_LIMIT).map_err(|why| RunError::unreadable(path, why))?;
    Ok(data)
}

/// Whether a path ends as data files do.
pub(super) fn is_data(path: &Path) -> bool {
    ending(path).is_some_and(|e| ["csv", "parquet", "mf4"].contains(&&*e))
}

/// How a path ends, in small letters: measuring systems write `.MF4`.
fn ending(path: &Path) -> Option<String> {
    path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase)
}
