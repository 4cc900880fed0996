//! What was measured: the runs of a campaign that declares its own channels, whole or in parts.

use super::Error;
use crate::base::digest::sha256_of;
use crate::signal::{Campaign, DataProblem, Entry, RunError, csv, parquet, read};
use crate::source::shown;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::path::Path;

/// A stretch of time of a run.
#[derive(Clone, Debug)]
pub(super) struct RunPart {
    /// The run's name, and behind it which part this is.
    pub name: String,
    /// The run's own name.
    pub run: String,
    /// Absolute path of the data.
    pub file: String,
    /// SHA-256 of the data's file.
    pub content: String,
    /// Numbers of the campaign's entry.
    pub settings: BTreeMap<String, f64>,
    /// s, increasing; at least two.
    pub time: Vec<f64>,
    /// A row a channel, in order of their names; NaN is lost.
    pub channels: Vec<Vec<f64>>,
}

/// Reads a campaign: its channels with their units, and its runs. A single run is cut into so many parts of equal
/// length, so that some can be left out.
pub(super) fn read(campaign: &Path, parts: usize) -> Result<(BTreeMap<String, String>, Vec<RunPart>), Error> {
    let campaign = Campaign::read(campaign)?;
    if campaign.channels.is_empty() {
        return Err(Error::NoChannels);
    }
    let runs = campaign.runs.iter().map(|entry| part(entry, &campaign.channels)).collect::<Result<Vec<_>, _>>()?;
    let runs = match <[RunPart; 1]>::try_from(runs) {
        Ok([whole]) => whole.cut(parts),
        Err(several) => several,
    };
    Ok((campaign.channels, runs))
}

/// A whole run.
fn part(entry: &Entry, declared: &BTreeMap<String, String>) -> Result<RunPart, Error> {
    let path = &entry.file;
    let unreadable = |why| Error::Run(RunError::unreadable(path, why));
    let absolute = std::path::absolute(path).map_err(|why| unreadable(why.into()))?;
    let data = entry.open().map_err(unreadable)?;
    let seen = RefCell::new(Vec::new());
    let pick = |name: &str, taken: &[String]| {
        seen.borrow_mut().push(name.to_owned());
        match declared.contains_key(name) {
            true if taken.iter().any(|t| t == name) => Err(DataProblem::DuplicateColumn),
            true => Ok(Some(name.to_owned())),
            false => Ok(None),
        }
    };
    let is_parquet = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("parquet"));
    let (time, mut columns) = if is_parquet {
        parquet::read_as(data, path, &pick)?
    } else {
        csv::read_as(read::bounded(data, path)?, path, &pick)?
    };
    let mut channels = Vec::with_capacity(declared.len());
    for name in declared.keys() {
        let missing =
            || Error::NoSuchChannel { file: shown(path), channel: name.clone(), columns: seen.borrow().clone() };
        channels.push(columns.remove(name).ok_or_else(missing)?);
    }
    let mut settings = entry.settings.clone();
    let nominal = [("speed", entry.speed), ("tension", entry.tension)];
    settings.extend(nominal.into_iter().filter_map(|(name, value)| Some((name.to_owned(), value?))));
    let content = entry.open().map_err(unreadable)?;
    let content = sha256_of(&mut &content).map_err(|why| unreadable(why.into()))?;
    Ok(RunPart {
        content,
        name: entry.name.clone(),
        run: entry.name.clone(),
        file: absolute.to_string_lossy().into_owned(),
        settings,
        time,
        channels,
    })
}

impl RunPart {
    /// First and last time, s.
    pub fn ends(&self) -> (f64, f64) {
        let end = |t: Option<&f64>| t.copied().unwrap_or_default();
        (end(self.time.first()), end(self.time.last()))
    }

    /// The first share of it in time, of two samples at least.
    pub fn first(&self, share: f64) -> RunPart {
        let (from, to) = self.ends();
        let count = self.time.partition_point(|t| *t <= from + share * (to - from)).max(2).min(self.time.len());
        RunPart {
            time: self.time[..count].to_vec(),
            channels: self.channels.iter().map(|x| x[..count].to_vec()).collect(),
            ..self.clone()
        }
    }

    /// Consecutive stretches of equal length that hold two samples or more.
    fn cut(self, parts: usize) -> Vec<RunPart> {
        let (from, to) = self.ends();
        let end = |k: usize| from + (to - from) * k as f64 / parts.max(1) as f64;
        let mut all = Vec::with_capacity(parts);
        let mut begin = 0;
        for k in 1..=parts {
            let stop = if k == parts { self.time.len() } else { self.time.partition_point(|t| *t < end(k)) };
            if stop >= begin + 2 {
                all.push(RunPart {
                    name: format!("{} part {k}", self.run),
                    time: self.time[begin..stop].to_vec(),
                    channels: self.channels.iter().map(|x| x[begin..stop].to_vec()).collect(),
                    ..self.clone()
                });
            }
            begin = stop;
        }
        if parts <= 1 { vec![self] } else { all }
    }
}
