//! Why a run cannot be read: where, what, and a way out.

use super::Channel;
use crate::source::{InputError, one_line, shown};
use crate::syntax::nearest;
use std::fmt;
use std::path::{Path, PathBuf};

/// A place in a run's files.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct DataPlace {
    pub file: PathBuf,
    /// In text, the line of the file, with the header as row 1; in Parquet and MDF4, the number of the sample from 1.
    pub row: Option<usize>,
    /// Column of the data, or key of the sidecar.
    pub column: Option<String>,
}

/// Why a run cannot be read.
#[derive(Clone, Debug, PartialEq)]
pub struct RunError {
    pub place: DataPlace,
    pub problem: DataProblem,
}

/// What is wrong with a run.
#[derive(Clone, Debug, PartialEq)]
pub enum DataProblem {
    /// The file cannot be opened; the reason.
    Unreadable(String),
    /// Another file names it, and it lies outside the project's root (as messages show it).
    OutsideRoot(String),
    /// Larger than what is read; the sizes.
    TooLarge(String),
    /// None of `.csv`, `.parquet` and `.mf4`.
    UnknownFormat,
    /// A file that other verbs read: what it is, and which they are.
    Foreign {
        what: &'static str,
        help: &'static str,
    },
    /// Not text in UTF-8, or not Parquet, MDF4 or TOML that can be read; the reason.
    Malformed(String),
    /// The first column is not `time`.
    NoTime,
    UnknownColumn,
    /// The sidecar says what a column is that the file lacks.
    NoSuchColumn,
    DuplicateColumn,
    /// Fewer than two samples.
    TooFewSamples,
    /// More numbers than are read at once.
    TooLong {
        limit: usize,
        columns: usize,
    },
    /// A row or column of another length than the first.
    Length {
        expected: usize,
        found: usize,
    },
    /// Text where a number belongs.
    NotANumber(String),
    /// A number too large, or infinite.
    NotFinite,
    /// A number that no such channel has.
    Beyond {
        found: f64,
        farthest: f64,
        unit: &'static str,
    },
    /// A trigger that is neither 0 nor 1.
    NotATrigger(f64),
    /// A sample without a time.
    LostTime,
    /// A time not after the one before.
    TimeStandsStill {
        before: f64,
        found: f64,
    },
    /// There is no sidecar of this name.
    MissingSidecar {
        path: PathBuf,
        keys: &'static [&'static str],
    },
    /// The sidecar or campaign lacks a key.
    MissingKey,
    /// The value is not what the key takes.
    WrongValue {
        expected: &'static str,
    },
    /// A key that a campaign does not have; those it has.
    UnknownKey {
        known: &'static [&'static str],
    },
    /// A run of the campaign whose data file is not there.
    MissingRun(PathBuf),
    /// A run of the same name as another one, which is this.
    DuplicateRun(PathBuf),
    /// A campaign without runs.
    NoRuns,
    /// A channel of MDF4 that was sampled at other times than the rest.
    OtherTimeBase,
    /// A channel of MDF4 in another unit than this format's.
    OtherUnit {
        expected: &'static str,
        found: String,
    },
    /// Sampled at less than twice the low-pass: what was measured cannot be told from its alias.
    Undersampled {
        rate_hz: f64,
        lowpass_hz: f64,
    },
}

impl DataProblem {
    /// That a file is a layout or the like, by the ending of its name.
    pub(super) fn foreign(file: &Path) -> Option<DataProblem> {
        let (what, help) = match file.extension()?.to_str()? {
            "lss" => {
                ("is a layout", "`lss simulate` makes a run of it (-o DIR); `lss build` and `lss check` read it, too")
            }
            "json" => ("is a JSON file", "`lss simulate` makes a run of a simulation.json (-o DIR)"),
            "dxf" => ("is a drawing", "`lss import` makes a layout of it"),
            _ => return None,
        };
        Some(DataProblem::Foreign { what, help })
    }
}

impl RunError {
    pub(super) fn new(file: &Path, problem: DataProblem) -> Self {
        RunError { place: DataPlace { file: file.to_owned(), row: None, column: None }, problem }
    }

    /// That a file cannot be opened.
    pub(crate) fn unreadable(file: &Path, why: impl Into<InputError>) -> Self {
        RunError::new(file, why.into().into())
    }

    pub(super) fn row(mut self, row: usize) -> Self {
        self.place.row = Some(row);
        self
    }

    pub(super) fn column(mut self, column: &str) -> Self {
        self.place.column = Some(column.to_owned());
        self
    }

    /// Whether the file itself could not be opened, rather than what stands in it being wrong.
    pub fn is_unreadable(&self) -> bool {
        matches!(self.problem, DataProblem::Unreadable(_))
    }

    /// A way out.
    pub fn help(&self) -> String {
        let column = self.place.column.as_deref().unwrap_or_default();
        match &self.problem {
            DataProblem::Unreadable(_) => "check the path and its permissions".to_owned(),
            DataProblem::OutsideRoot(root) => InputError::OutsideRoot(root.clone()).help().to_owned(),
            DataProblem::TooLarge(_) => {
                "split it into several runs, or leave out channels that are not needed".to_owned()
            }
            DataProblem::Foreign { help, .. } => (*help).to_owned(),
            DataProblem::UnknownFormat => "name a data file that ends in .csv, .parquet or .mf4".to_owned(),
            DataProblem::Malformed(_) => match self.place.file.extension().and_then(|e| e.to_str()) {
                Some("toml") => "write it as TOML in UTF-8: lines of key = value, text in quotes".to_owned(),
                Some("mf4" | "MF4") => "export the file again as MDF 4.x, finalised and sorted, or as CSV".to_owned(),
                _ => "write the file again as CSV in UTF-8, or as Parquet with snappy or no compression".to_owned(),
            },
            DataProblem::NoTime => {
                "begin the header with `time`, or say in the sidecar which column it is with `[columns]` and \
                                    `\"NAME\" = \"time\"`; separate columns by commas"
                    .to_owned()
            }
            DataProblem::UnknownColumn => match nearest(column, Channel::ALL.map(Channel::name)) {
                Some(name) => format!("did you mean `{name}`?"),
                None => format!(
                    "say in the sidecar which channel it is, with `[columns]` and `\"{}\" = \"joint_xi\"`, or `= false` for \
                     none; channels are time, {}",
                    one_line(column),
                    Channel::ALL.map(Channel::name).join(", ")
                ),
            },
            DataProblem::NoSuchColumn => "write it as the data file does, or remove it from `[columns]`".to_owned(),
            DataProblem::DuplicateColumn => "keep one of the two".to_owned(),
            DataProblem::TooFewSamples => "a run needs two samples or more".to_owned(),
            DataProblem::TooLong { limit, columns } => format!(
                "split the file into runs of {} rows or fewer, or leave out columns: a run may begin and end anywhere",
                limit / columns.max(&1)
            ),
            DataProblem::Length { .. } => "leave the field of a lost sample empty, but keep its comma".to_owned(),
            DataProblem::NotANumber(text) if text.contains(',') => "write decimals with a point".to_owned(),
            DataProblem::NotANumber(_) | DataProblem::NotFinite => {
                "leave the field of a lost sample empty, or write NaN".to_owned()
            }
            DataProblem::Beyond { .. } => {
                "leave the field of a lost sample empty, and export numbers in SI units".to_owned()
            }
            DataProblem::NotATrigger(_) => "write 1 while the cart passes the photocell, and 0 elsewhere".to_owned(),
            DataProblem::LostTime => "every sample needs its time; remove the row if it is not known".to_owned(),
            DataProblem::TimeStandsStill { .. } => {
                "times increase from row to row; split the file where the recording was started again".to_owned()
            }
            DataProblem::MissingSidecar { keys, .. } => format!("write it with {}", keys.join(", ")),
            DataProblem::MissingKey => match column {
                "layout" => "add layout = \"FILE.lss\", the path of the layout or of its simulation.json".to_owned(),
                "sensor_cart" => "add sensor_cart = K, the number of the cart that carries the sensors".to_owned(),
                "file" => "add file = \"run-01.csv\", the path of the run's data".to_owned(),
                "laps" => "add laps = N, the number of laps that were recorded".to_owned(),
                "lowpass" => "add lowpass = HZ, the corner of the second-order low-pass before sampling".to_owned(),
                "speed_setpoint" => "add speed_setpoint = V, in m/s".to_owned(),
                _ => "add trigger_position = S, the metres along the track from its start to the photocell".to_owned(),
            },
            DataProblem::WrongValue { .. } => "change the value".to_owned(),
            DataProblem::UnknownKey { known } => match nearest(column, known.iter().copied()) {
                Some(name) => format!("did you mean `{name}`?"),
                None => format!("remove it; keys are {}", known.join(", ")),
            },
            DataProblem::MissingRun(_) => "paths are seen from the campaign's folder".to_owned(),
            DataProblem::DuplicateRun(_) => {
                "a run is known by its file's name without the ending: rename one of the two".to_owned()
            }
            DataProblem::NoRuns => {
                "add [[run]] with file = \"run-01.csv\" to campaign.toml, or put data files with their sidecars into \
                 the folder"
                    .to_owned()
            }
            DataProblem::OtherTimeBase => "export all channels with one rate, on one time base".to_owned(),
            DataProblem::OtherUnit { expected, .. } => format!("export it in {expected}"),
            DataProblem::Undersampled { lowpass_hz, .. } => {
                format!("sample at {} Hz or more, or give the low-pass that was used", 2.0 * lowpass_hz)
            }
        }
    }
}

/// Text of a file, cut where it is long.
fn quoted(text: &str) -> String {
    const LONGEST: usize = 80;
    let begin: String = text.chars().take(LONGEST).collect();
    format!("{}{}", one_line(&begin), if begin.len() < text.len() { "..." } else { "" })
}

impl From<InputError> for DataProblem {
    fn from(why: InputError) -> Self {
        match why {
            InputError::OutsideRoot(root) => DataProblem::OutsideRoot(root),
            InputError::TooLarge { .. } => DataProblem::TooLarge(why.to_string()),
            InputError::Missing(why) | InputError::Unreadable(why) => DataProblem::Unreadable(why),
        }
    }
}

impl fmt::Display for DataPlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", shown(&self.file))?;
        if let Some(row) = self.row {
            write!(f, ", row {row}")?;
        }
        if let Some(column) = &self.column {
            write!(f, ", `{}`", quoted(column))?;
        }
        Ok(())
    }
}

impl fmt::Display for DataProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            DataProblem::Unreadable(why) => write!(f, "cannot be read: {why}"),
            DataProblem::OutsideRoot(root) => write!(f, "{}", InputError::OutsideRoot(root.clone())),
            DataProblem::TooLarge(sizes) => write!(f, "is too large: {sizes}"),
            DataProblem::Foreign { what, .. } => write!(f, "{what}, not a run or a campaign"),
            DataProblem::UnknownFormat => write!(f, "is none of CSV, Parquet and MDF4"),
            DataProblem::Malformed(why) => write!(f, "is malformed: {}", one_line(why)),
            DataProblem::NoTime => write!(f, "the first column is not `time`"),
            DataProblem::UnknownColumn => write!(f, "there is no such column"),
            DataProblem::NoSuchColumn => write!(f, "the sidecar says what this is, and the file has no such column"),
            DataProblem::DuplicateColumn => write!(f, "the column is there twice"),
            DataProblem::TooFewSamples => write!(f, "there are fewer than two samples"),
            DataProblem::TooLong { limit, columns } => {
                write!(f, "the run has more than {limit} numbers, in {columns} columns: that is the limit")
            }
            DataProblem::Length { expected, found } => {
                write!(f, "{found} field{} where the first row has {expected}", if *found == 1 { "" } else { "s" })
            }
            DataProblem::NotANumber(text) => write!(f, "`{}` is not a number", quoted(text)),
            DataProblem::NotFinite => write!(f, "the number is not finite"),
            DataProblem::Beyond { found, farthest, unit } => {
                write!(f, "{found:e} is beyond ±{}", format!("{farthest:e} {unit}").trim_end())
            }
            DataProblem::NotATrigger(value) => write!(f, "{value} is neither 0 nor 1"),
            DataProblem::LostTime => write!(f, "the time is missing"),
            DataProblem::TimeStandsStill { before, found } => write!(f, "{found} s does not come after {before} s"),
            DataProblem::MissingSidecar { path, .. } => write!(f, "there is no sidecar {}", shown(path)),
            DataProblem::MissingKey => write!(f, "the key is missing"),
            DataProblem::WrongValue { expected } => write!(f, "the value is not {expected}"),
            DataProblem::UnknownKey { .. } => write!(f, "there is no such key"),
            DataProblem::MissingRun(path) => write!(f, "there is no file {}", shown(path)),
            DataProblem::DuplicateRun(other) => write!(f, "the run has the same name as {}", shown(other)),
            DataProblem::NoRuns => write!(f, "the campaign has no runs"),
            DataProblem::OtherTimeBase => write!(f, "the channel is written in a group with another time base"),
            DataProblem::OtherUnit { expected, found } => write!(f, "the unit is {}, not {expected}", quoted(found)),
            DataProblem::Undersampled { rate_hz, lowpass_hz } => {
                write!(f, "sampled at {rate_hz:.1} Hz, less than twice the low-pass of {lowpass_hz} Hz")
            }
        }
    }
}

/// `run-01.csv, row 3, `steer_left`: `x` is not a number`, and below it the way out.
impl fmt::Display for RunError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}\n  help: {}", self.place, self.problem, self.help())
    }
}

impl std::error::Error for RunError {}
