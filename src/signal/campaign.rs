//! Campaigns: runs that belong together, listed in a `campaign.toml` or simply in one folder.
//!
//! ```toml
//! layout = "reference.lss"      # of every run that names none
//! zeroed = ["run_left"]         # of every run whose sidecar says none; so may [columns]
//!
//! [[run]]
//! file = "run-01.csv"
//! speed = 2.05                  # nominal, m/s
//! tension = 1000                # nominal, N
//! ```

use super::keys::{self, Reader, Table, Text};
use super::{DataPlace, DataProblem, Run, RunError, Sidecar, SidecarDefaults, read, sidecar_path};
use crate::source::{InputError, Root, SIZE_LIMIT, one_line, root, steers};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Component, Path, PathBuf};
use toml::{Spanned, Value};

/// Runs that belong together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Campaign {
    pub folder: PathBuf,
    /// How far its files may name files.
    pub root: Root,
    /// As `campaign.toml` lists them; without it, by name.
    pub runs: Vec<Entry>,
    /// Channels that another machine declares for itself, name to unit. Such a campaign needs no layout.
    pub channels: BTreeMap<String, String>,
    /// Of all runs whose sidecars say nothing else.
    pub defaults: SidecarDefaults,
}

/// A run of a campaign.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// The data file's name without its ending, and without control characters; no other run of the campaign has it.
    pub name: String,
    /// The data file.
    pub file: PathBuf,
    /// How far the run's files may name files.
    pub root: Root,
    /// A `.lss` or a `simulation.json`, which need not exist: the entry's, else the campaign's, else that of the run's
    /// sidecar. Empty in a campaign that declares its own channels and names no layout. It may lie anywhere: see
    /// [`Entry::layout`].
    pub layout: PathBuf,
    /// Nominal, to group runs by, m/s.
    pub speed: Option<f64>,
    /// Nominal, to group runs by, N.
    pub tension: Option<f64>,
    /// Further numbers of a run in a campaign that declares its own channels: settings of its machine.
    pub settings: BTreeMap<String, f64>,
    /// The campaign's, for what the sidecar does not say.
    pub defaults: SidecarDefaults,
}

/// A run of a campaign that cannot be read, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct Refused {
    pub name: String,
    pub file: PathBuf,
    pub error: RunError,
}

const KEYS: &[&str] = &["layout", "run", "channels", "fmu", "columns", "zeroed"];
const RUN_KEYS: &[&str] = &["file", "layout", "speed", "tension"];

/// The tables of a `campaign.toml`, read for the lines of their keys.
#[derive(Deserialize)]
struct Tables {
    #[serde(default)]
    run: Vec<Spanned<Table>>,
    #[serde(default)]
    channels: Table,
}

/// A run as it is listed.
struct Listed {
    file: PathBuf,
    layout: Option<PathBuf>,
    speed: Option<f64>,
    tension: Option<f64>,
    settings: BTreeMap<String, f64>,
    /// Where it is listed.
    place: DataPlace,
}

impl Campaign {
    /// The name of the file that lists a campaign's runs.
    pub const FILE: &str = "campaign.toml";

    /// Reads the folder of a campaign, or its `campaign.toml`. A folder without one is a campaign of all data files
    /// that have a sidecar, and a single data file is a campaign of one run, as the `campaign.toml` beside it lists it
    /// where it does.
    ///
    /// # Errors
    ///
    /// [`DataProblem::UnknownKey`], [`DataProblem::MissingKey`] and [`DataProblem::WrongValue`] with the key and its
    /// line; [`DataProblem::MissingRun`], [`DataProblem::DuplicateRun`], [`DataProblem::NoRuns`]; and what
    /// [`Sidecar::read`] says when the layout has to be found there.
    pub fn read(path: &Path) -> Result<Campaign, RunError> {
        let (campaign, refused) = Campaign::read_each(path)?;
        match refused.into_iter().next() {
            Some(refused) => Err(refused.error),
            None => Ok(campaign),
        }
    }

    /// As [`Campaign::read`], but a run whose files are missing or whose sidecar is wrong does not hide the others.
    ///
    /// # Errors
    ///
    /// Those of [`Campaign::read`] that concern the campaign as a whole.
    pub fn read_each(path: &Path) -> Result<(Campaign, Vec<Refused>), RunError> {
        let unreadable = |why: InputError| RunError::unreadable(path, why);
        let (folder, list, root) = if root::given(path).map_err(unreadable)?.is_dir() {
            (path.to_owned(), path.join(Campaign::FILE), Root::of_campaign(path))
        } else {
            let folder = path.parent().unwrap_or(Path::new("")).to_owned();
            let root = Root::of_campaign(&folder).and(path);
            (folder, path.to_owned(), root)
        };
        if let Some(foreign) = DataProblem::foreign(&list) {
            return Err(RunError::new(&list, foreign));
        }
        let mut campaign = Campaign { folder, root, ..Campaign::default() };
        let listed = if read::is_data(&list) {
            vec![campaign.single(&list)?]
        } else {
            match campaign.root.read(&list, SIZE_LIMIT) {
                Ok(bytes) => campaign.listed(&bytes, &list)?,
                Err(InputError::Missing(_)) => found(&campaign.folder).map_err(|why| unreadable(why.into()))?,
                Err(why) => return Err(RunError::unreadable(&list, why)),
            }
        };
        if listed.is_empty() {
            if !list.exists()
                && let Some(alone) = without_sidecar(&campaign.folder).map_err(|why| unreadable(why.into()))?
            {
                let missing = DataProblem::MissingSidecar { path: sidecar_path(&alone), keys: &Sidecar::KEYS };
                return Err(RunError::new(&alone, missing));
            }
            return Err(RunError::new(if list.exists() { &list } else { path }, DataProblem::NoRuns));
        }
        let mut refused = Vec::new();
        let mut names: BTreeMap<String, PathBuf> = BTreeMap::new();
        for run in listed {
            let name = one_line(&run.file.file_stem().unwrap_or_default().to_string_lossy()).into_owned();
            if let Some(other) = names.insert(name.clone(), run.file.clone()) {
                return Err(RunError { place: run.place, problem: DataProblem::DuplicateRun(other) });
            }
            let file = run.file.clone();
            match run.entry(&name, !campaign.channels.is_empty(), &campaign.root, &campaign.defaults) {
                Ok(entry) => campaign.runs.push(entry),
                Err(error) => refused.push(Refused { name, file, error: *error }),
            }
        }
        Ok((campaign, refused))
    }

    /// The data files that a `campaign.toml` lists, seen from its folder, without looking for them; `file` is named in
    /// errors.
    ///
    /// # Errors
    ///
    /// Those of [`Campaign::read`] that concern the text.
    pub fn files(bytes: &[u8], file: &Path) -> Result<Vec<PathBuf>, RunError> {
        Ok(Campaign::default().listed(bytes, file)?.into_iter().map(|run| run.file).collect())
    }

    /// The runs of a `campaign.toml`; its channels are kept.
    fn listed(&mut self, bytes: &[u8], file: &Path) -> Result<Vec<Listed>, RunError> {
        let text = Text::new(bytes, file)?;
        let mut reader = text.reader(text.parse()?);
        let layout = reader.optional("layout", "a path", keys::text)?.map(|l| self.folder.join(l));
        reader.optional("run", "tables, each headed by [[run]]", |value| {
            value.as_array().filter(|runs| runs.iter().all(Value::is_table)).map(|_| ())
        })?;
        reader.optional("channels", "a table headed by [channels]", |value| value.as_table().map(|_| ()))?;
        // What the unit of another machine is asked for is read by what runs it.
        reader.optional("fmu", "a table headed by [fmu]", |value| value.as_table().map(|_| ()))?;
        self.defaults = SidecarDefaults::take(&mut reader, file)?;
        reader.finish(KEYS)?;
        let Tables { run, channels } = text.parse()?;
        let names: Vec<String> = channels.keys().cloned().collect();
        let mut reader = text.reader(channels);
        for name in names {
            if name.contains(steers) {
                let problem = DataProblem::Malformed("the name of a channel holds a control character".to_owned());
                return Err(RunError::new(file, problem).column(&name));
            }
            let unit = |v: &Value| v.as_str().filter(|unit| !unit.contains(steers)).map(str::to_owned);
            let unit = reader.take(&name, "a unit in quotes", unit)?;
            self.channels.insert(name, unit);
        }
        let runs = run.into_iter().map(|table| {
            let begin = text.line(table.span().start);
            self.entry(text.reader(table.into_inner()), file, begin, layout.as_deref())
        });
        runs.collect()
    }

    /// A single data file, as the `campaign.toml` beside it lists it, or on its own.
    fn single(&mut self, data: &Path) -> Result<Listed, RunError> {
        let list = self.folder.join(Campaign::FILE);
        let bytes = match self.root.read(&list, SIZE_LIMIT) {
            Ok(bytes) => bytes,
            Err(InputError::Missing(_)) => return Ok(Listed::found(data.to_owned())),
            Err(why) => return Err(RunError::unreadable(&list, why)),
        };
        let mut beside = Campaign { folder: self.folder.clone(), root: self.root.clone(), ..Campaign::default() };
        let listed = beside.listed(&bytes, &list)?.into_iter().find(|run| is_same(&run.file, data));
        Ok(match listed {
            Some(run) => {
                *self = beside;
                run
            }
            None => Listed::found(data.to_owned()),
        })
    }

    /// One `[[run]]`, which begins on the line `begin`.
    fn entry(&self, mut keys: Reader, list: &Path, begin: usize, layout: Option<&Path>) -> Result<Listed, RunError> {
        let line = keys.line("file").unwrap_or(begin);
        let place = DataPlace { file: list.to_owned(), row: Some(line), column: Some("file".to_owned()) };
        let told = |error: RunError| if error.place.row.is_some() { error } else { error.row(begin) };
        let mut listed = Listed {
            file: self.folder.join(keys.take("file", "a path", keys::text).map_err(told)?),
            layout: keys
                .optional("layout", "a path", keys::text)?
                .map(|l| self.folder.join(l))
                .or_else(|| layout.map(Path::to_owned)),
            speed: keys.optional("speed", "a speed above 0", keys::positive)?,
            tension: keys.optional("tension", "a force from 0", |v| keys::number(v).filter(|&x| x >= 0.0))?,
            settings: BTreeMap::new(),
            place,
        };
        if !self.channels.is_empty() {
            for name in keys.names() {
                listed
                    .settings
                    .insert(name.clone(), keys.take(&name, "a number, a setting of the machine", keys::number)?);
            }
        }
        keys.finish(RUN_KEYS)?;
        Ok(listed)
    }
}

impl Listed {
    /// A run that no `campaign.toml` lists.
    fn found(file: PathBuf) -> Self {
        let place = DataPlace { file: file.clone(), ..DataPlace::default() };
        Listed { file, layout: None, speed: None, tension: None, settings: BTreeMap::new(), place }
    }

    /// The run, when its files are there and a layout is named.
    fn entry(self, name: &str, foreign: bool, root: &Root, defaults: &SidecarDefaults) -> Result<Entry, Box<RunError>> {
        let Listed { file, layout, speed, tension, settings, place } = self;
        match root.place(&file) {
            Ok(there) if there.is_file() => {}
            Ok(_) | Err(InputError::Missing(_)) => {
                return Err(Box::new(RunError { place, problem: DataProblem::MissingRun(file) }));
            }
            Err(why) => return Err(Box::new(RunError { place, problem: why.into() })),
        }
        let layout = match layout {
            Some(layout) => layout,
            None if foreign => PathBuf::new(),
            None => {
                let beside = sidecar_path(&file);
                beside.parent().unwrap_or(Path::new("")).join(Sidecar::beside(&file, root, defaults)?.0.layout)
            }
        };
        let (name, root, defaults) = (name.to_owned(), root.clone(), defaults.clone());
        Ok(Entry { name, file, root, layout, speed, tension, settings, defaults })
    }
}

impl Entry {
    /// Reads the run of a single data file, as the `campaign.toml` beside it lists it where it does.
    ///
    /// # Errors
    ///
    /// Those of [`Entry::of`] and [`Entry::run`].
    pub fn read(data: &Path) -> Result<(Entry, Run), RunError> {
        let entry = Entry::of(data)?;
        let run = entry.run()?;
        Ok((entry, run))
    }

    /// The run of a single data file, as [`Entry::read`] has it, without its samples.
    ///
    /// # Errors
    ///
    /// Those of [`Campaign::read`], and [`DataProblem::UnknownFormat`].
    fn of(data: &Path) -> Result<Entry, RunError> {
        let no_data = || RunError::new(data, DataProblem::foreign(data).unwrap_or(DataProblem::UnknownFormat));
        let runs = if read::is_data(data) { Campaign::read(data)?.runs } else { Vec::new() };
        runs.into_iter().next().ok_or_else(no_data)
    }

    /// Reads the run.
    ///
    /// # Errors
    ///
    /// As [`Run::read`].
    pub fn run(&self) -> Result<Run, RunError> {
        Run::read_within(&self.file, &self.root, &self.defaults)
    }

    /// The file of the layout that the campaign or the sidecar names, if it is there.
    ///
    /// # Errors
    ///
    /// [`InputError::OutsideRoot`], which is no reason to look there; [`InputError::Missing`].
    pub fn layout(&self) -> Result<&Path, InputError> {
        self.root.place(&self.layout).map(|_| self.layout.as_path())
    }

    /// The data file, opened.
    ///
    /// # Errors
    ///
    /// As [`Root::open`].
    pub fn open(&self) -> Result<fs::File, InputError> {
        self.root.open(&self.file)
    }
}

/// Whether two paths are written alike but for `./`.
fn is_same(a: &Path, b: &Path) -> bool {
    let parts = |path: &'_ Path| path.components().filter(|part| *part != Component::CurDir).collect::<PathBuf>();
    parts(a) == parts(b)
}

/// The first data file of a folder that has no sidecar, by name; runs before other tables.
fn without_sidecar(folder: &Path) -> std::io::Result<Option<PathBuf>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if read::is_data(&path) && !sidecar_path(&path).is_file() {
            files.push(path);
        }
    }
    files.sort_by_key(|path| {
        let run = path.file_stem().is_some_and(|stem| stem.to_string_lossy().starts_with("run"));
        (!run, path.clone())
    });
    Ok(files.into_iter().next())
}

/// The data files of a folder that have a sidecar, by name.
fn found(folder: &Path) -> std::io::Result<Vec<Listed>> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if read::is_data(&path) && sidecar_path(&path).is_file() {
            files.push(path);
        }
    }
    files.sort();
    Ok(files.into_iter().map(Listed::found).collect())
}

#[cfg(test)]
mod tests;
