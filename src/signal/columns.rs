//! Columns of a data file, whatever its format: which there may be, and what holds of all.

use super::{Channel, DataProblem, RunError};
use std::collections::BTreeMap;
use std::fmt::Display;
use std::path::Path;

/// Beyond this no number of another machine's channel is a measurement: its fourth power, over a long run, still is a
/// number.
pub const FARTHEST: f64 = 1e30;

/// Latest time of a sample, s; far beyond one that counts from 1970. And the shortest step between two.
const LATEST: f64 = 1e12;

const SHORTEST: f64 = 1e-9;

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

/// The columns of a data file: time, and the channels over it.
pub type Columns<C = Channel> = (Vec<f64>, BTreeMap<C, Vec<f64>>);

/// Says which channel a column is, given those before it; `None` for one that is passed over, whatever it holds.
pub type Pick<'a, C> = &'a dyn Fn(&str, &[C]) -> Result<Option<C>, DataProblem>;

/// What columns are by their names.
pub struct Names<'a, C> {
    /// Whether a column is the time.
    pub is_time: &'a dyn Fn(&str) -> bool,
    pub pick: Pick<'a, C>,
}

/// Numbers of a run at most, times included: 1.6 GB of memory, 12.5 million rows of 16 columns.
pub const MOST_NUMBERS: usize = 200_000_000;

/// That so many rows of columns are within a limit.
pub(super) fn room(rows: usize, columns: usize, most: usize) -> Result<(), DataProblem> {
    if rows.saturating_mul(columns) <= most { Ok(()) } else { Err(DataProblem::TooLong { limit: most, columns }) }
}

/// The channel of a column, which is not among those `taken`.
pub(super) fn channel(name: &str, taken: &[Channel]) -> Result<Channel, DataProblem> {
    match Channel::from_name(name) {
        Some(channel) if taken.contains(&channel) => Err(DataProblem::DuplicateColumn),
        Some(channel) => Ok(channel),
        None if name == "time" => Err(DataProblem::DuplicateColumn),
        None => Err(DataProblem::UnknownColumn),
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
            return error(DataProblem::LostTime, i, "time");
        }
        if found.is_infinite() {
            return error(DataProblem::NotFinite, i, "time");
        }
        match i.checked_sub(1).and_then(|b| time.get(b)) {
            Some(&before) if found - before < SHORTEST => {
                return error(DataProblem::TimeStandsStill { before, found }, i, "time");
            }
            _ if found.abs() > LATEST => {
                return error(DataProblem::Beyond { found, farthest: LATEST, unit: "s" }, i, "time");
            }
            _ => {}
        }
    }
    for (channel, samples) in channels {
        if samples.len() != time.len() {
            let problem = DataProblem::Length { expected: time.len(), found: samples.len() };
            return Err(RunError::new(file, problem).column(&channel.to_string()));
        }
        for (i, &x) in samples.iter().enumerate() {
            if x.is_infinite() {
                return error(DataProblem::NotFinite, i, &channel.to_string());
            }
            if x.abs() > channel.farthest() {
                let problem = DataProblem::Beyond { found: x, farthest: channel.farthest(), unit: channel.unit() };
                return error(problem, i, &channel.to_string());
            }
        }
    }
    if time.len() < 2 {
        return Err(RunError::new(file, DataProblem::TooFewSamples));
    }
    Ok(())
}

/// That a trigger is 0 or 1. `row` is the number of the first sample's row.
pub(super) fn check_trigger(channels: &BTreeMap<Channel, Vec<f64>>, file: &Path, row: usize) -> Result<(), RunError> {
    let samples = channels.get(&Channel::Trigger).map_or(&[][..], Vec::as_slice);
    match samples.iter().position(|&x| !x.is_nan() && x != 0.0 && x != 1.0) {
        Some(i) => {
            Err(RunError::new(file, DataProblem::NotATrigger(samples[i])).row(row + i).column(Channel::Trigger.name()))
        }
        None => Ok(()),
    }
}
