//! A run: samples in columns over time, and its sidecar.

use super::{Channel, Problem, RunError, Sidecar, csv, mdf4, parquet, position};
use crate::base::number;
use crate::source::{InputError, Root, input};
use std::collections::BTreeMap;
use std::fmt::Display;
use std::fs::File;
use std::path::{Path, PathBuf};

/// Beyond this no number of another machine's channel is a measurement: its fourth power, over a long run, still is a number.
pub const FARTHEST: f64 = 1e30;

/// Latest time of a sample, s; far beyond one that counts from 1970. And the shortest step between two.
const LATEST: f64 = 1e12;
const SHORTEST: f64 = 1e-9;

/// Largest data file, bytes.
pub const DATA_LIMIT: u64 = 4 << 30;

/// What is measured in a column of a data file.
pub trait Column: Ord + Display {
    /// The largest number that is no mistake, in the column's unit.
    fn farthest(&self) -> f64 {
        FARTHEST
    }

    /// Empty where it is not known.
    fn unit(&self) -> &'static str {
        ""
    }
}

impl Column for String {}

impl Column for Channel {
    fn farthest(&self) -> f64 {
        Channel::farthest(*self)
    }

    fn unit(&self) -> &'static str {
        Channel::unit(*self)
    }
}

/// What a sensor cart brought home, or a simulation wrote in its stead.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Run {
    /// s, strictly increasing.
    pub time: Vec<f64>,
    /// As long as `time`; NaN is a lost sample. A channel that is not there was not fitted.
    pub channels: BTreeMap<Channel, Vec<f64>>,
    pub sidecar: Sidecar,
}

impl Run {
    /// Reads `path`, which ends in `.csv`, `.parquet` or `.mf4`, and the `.toml` beside it. The path is the command line's; the
    /// sidecar has to lie within the root of its folder.
    ///
    /// # Errors
    ///
    /// What [`Problem`] lists, with file, row and column.
    pub fn read(path: &Path) -> Result<Run, RunError> {
        let root = Root::of_campaign(path.parent().unwrap_or(Path::new("")));
        Run::read_as(path, input::open_given(path), &root)
    }

    /// As [`Run::read`], of a path that another file names: it has to lie within the root.
    ///
    /// # Errors
    ///
    /// Those of [`Run::read`].
    pub fn read_within(path: &Path, root: &Root) -> Result<Run, RunError> {
        Run::read_as(path, root.open(path), root)
    }

    fn read_as(path: &Path, data: Result<File, InputError>, root: &Root) -> Result<Run, RunError> {
        let error = |problem| RunError::new(path, problem);
        let unreadable = |why: InputError| RunError::unreadable(path, why);
        let (time, channels) = match ending(path).as_deref() {
            Some("csv") => csv::read_from(bounded(data.map_err(unreadable)?, path)?, path)?,
            Some("mf4") => mdf4::read(bounded(data.map_err(unreadable)?, path)?, path)?,
            Some("parquet") => parquet::read(data.map_err(unreadable)?, path)?,
            _ => return Err(error(Problem::foreign(path).unwrap_or(Problem::UnknownFormat))),
        };
        let run = Run { time, channels, sidecar: Sidecar::beside(path, root)? };
        let (rate_hz, lowpass_hz) = (run.rate(), run.sidecar.lowpass);
        // Times are decimal numbers, so a rate of exactly twice the low-pass may come out a bit lower.
        if rate_hz < 2.0 * lowpass_hz * (1.0 - 1e-9) {
            return Err(error(Problem::Undersampled { rate_hz, lowpass_hz }));
        }
        Ok(run)
    }

    /// Samples a second: one over the median step of time, to a µHz, as the differences of decimal times are noisy in their last
    /// digits, Hz. 0 for fewer than two samples.
    pub fn rate(&self) -> f64 {
        let mut steps: Vec<f64> = self.time.windows(2).map(|w| w[1] - w[0]).collect();
        if steps.is_empty() {
            return 0.0;
        }
        let middle = steps.len() / 2;
        let (_, median, _) = steps.select_nth_unstable_by(middle, f64::total_cmp);
        (1e6 / *median).round() / 1e6
    }

    /// From the first sample to the end of the last one's step, s.
    pub fn duration(&self) -> f64 {
        match (self.time.first(), self.time.last()) {
            (Some(first), Some(last)) if last > first => last - first + 1.0 / self.rate(),
            _ => 0.0,
        }
    }

    /// What cannot be told from this run, as sentences. The lap's length, when known, in m.
    pub fn warnings(&self, lap_length: Option<f64>) -> Vec<String> {
        let mut said = Vec::new();
        let place = lap_length.and_then(|lap| position::position(self, lap));
        if let (Some(lap), None) = (lap_length, &place) {
            let travelled = self.duration() * self.sidecar.speed_setpoint;
            said.push(format!(
                "the trigger never rises: places on the track and laps cannot be told{}",
                if travelled < lap { ", and the run seems shorter than a lap" } else { "" }
            ));
        }
        if let (Some(lap), Some(place)) = (lap_length, &place) {
            let travelled = place.laps() * lap;
            // The speed is a mean, so a lap that was recorded to the sample may seem a little short.
            if travelled < 0.995 * lap {
                said.push(format!(
                    "the run covers {} of the lap's {} m: nothing can be told of the rest of the track, nor how laps differ",
                    number::fixed(travelled, 1),
                    number::fixed(lap, 1)
                ));
            }
        }
        let step = 1.0 / self.rate();
        let jumps = self.time.windows(2).filter(|w| w[1] - w[0] > 1.5 * step).count();
        if jumps > 0 {
            said.push(format!("rows are missing: time jumps {jumps} times by more than one step of {step} s"));
        }
        said
    }
}

/// An open data file that is read piece by piece.
pub(crate) fn bounded(data: File, path: &Path) -> Result<File, RunError> {
    input::within(&data, DATA_LIMIT).map_err(|why| RunError::unreadable(path, why))?;
    Ok(data)
}

/// Numbers of a run at most, times included: 1.6 GB of memory, 12.5 million rows of 16 columns.
pub const MOST_NUMBERS: usize = 200_000_000;

/// That so many rows of columns are within a limit.
pub(super) fn room(rows: usize, columns: usize, most: usize) -> Result<(), Problem> {
    if rows.saturating_mul(columns) <= most { Ok(()) } else { Err(Problem::TooLong { limit: most, columns }) }
}

/// The sidecar beside a data file: `run-01.toml` for `run-01.csv`.
pub fn sidecar_path(data: &Path) -> PathBuf {
    data.with_extension("toml")
}

/// Whether a path ends as data files do.
pub(super) fn is_data(path: &Path) -> bool {
    ending(path).is_some_and(|e| ["csv", "parquet", "mf4"].contains(&&*e))
}

/// How a path ends, in small letters: measuring systems write `.MF4`.
fn ending(path: &Path) -> Option<String> {
    path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase)
}

/// The channel of a column, which is not among those `taken`.
pub(super) fn channel(name: &str, taken: &[Channel]) -> Result<Channel, Problem> {
    match Channel::from_name(name) {
        Some(channel) if taken.contains(&channel) => Err(Problem::DuplicateColumn),
        Some(channel) => Ok(channel),
        None if name == "time" => Err(Problem::DuplicateColumn),
        None => Err(Problem::UnknownColumn),
    }
}

/// What holds of every run's columns, whatever the format: times increase, nothing is infinite.
/// `row` is the number of the first sample's row.
pub(super) fn check<C: Column>(
    time: &[f64],
    channels: &BTreeMap<C, Vec<f64>>,
    file: &Path,
    row: usize,
) -> Result<(), RunError> {
    let error = |problem, i: usize, column: &str| Err(RunError::new(file, problem).row(row + i).column(column));
    for (i, &found) in time.iter().enumerate() {
        if found.is_nan() {
            return error(Problem::LostTime, i, "time");
        }
        if found.is_infinite() {
            return error(Problem::NotFinite, i, "time");
        }
        match i.checked_sub(1).and_then(|b| time.get(b)) {
            Some(&before) if found - before < SHORTEST => {
                return error(Problem::TimeStandsStill { before, found }, i, "time");
            }
            _ if found.abs() > LATEST => {
                return error(Problem::Beyond { found, farthest: LATEST, unit: "s" }, i, "time");
            }
            _ => {}
        }
    }
    for (channel, samples) in channels {
        if samples.len() != time.len() {
            let problem = Problem::Length { expected: time.len(), found: samples.len() };
            return Err(RunError::new(file, problem).column(&channel.to_string()));
        }
        for (i, &x) in samples.iter().enumerate() {
            if x.is_infinite() {
                return error(Problem::NotFinite, i, &channel.to_string());
            }
            if x.abs() > channel.farthest() {
                let problem = Problem::Beyond { found: x, farthest: channel.farthest(), unit: channel.unit() };
                return error(problem, i, &channel.to_string());
            }
        }
    }
    if time.len() < 2 {
        return Err(RunError::new(file, Problem::TooFewSamples));
    }
    Ok(())
}

/// That a trigger is 0 or 1. `row` is the number of the first sample's row.
pub(super) fn check_trigger(channels: &BTreeMap<Channel, Vec<f64>>, file: &Path, row: usize) -> Result<(), RunError> {
    let samples = channels.get(&Channel::Trigger).map_or(&[][..], Vec::as_slice);
    match samples.iter().position(|&x| !x.is_nan() && x != 0.0 && x != 1.0) {
        Some(i) => {
            Err(RunError::new(file, Problem::NotATrigger(samples[i])).row(row + i).column(Channel::Trigger.name()))
        }
        None => Ok(()),
    }
}
