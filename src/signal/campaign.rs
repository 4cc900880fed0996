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
        let Ok(bytes) = self.root.read(&list, SIZE_LIMIT) else { return Ok(Listed::found(data.to_owned())) };
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
    /// The run of a single data file, as the `campaign.toml` beside it lists it where it does.
    ///
    /// # Errors
    ///
    /// Those of [`Campaign::read`], and [`DataProblem::UnknownFormat`].
    pub fn of(data: &Path) -> Result<Entry, RunError> {
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
mod tests {
    use super::super::mapping::Mapping;
    use super::*;
    use crate::signal::Channel;

    const SIDECAR: &str = "layout = \"lines/b.lss\"\nsensor_cart = 1\nspeed_setpoint = 2\ntrigger_position = 0\n\
                           lowpass = 100\nlaps = 1\n";

    /// A folder with these files.
    fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
        let folder = tempfile::tempdir().expect("a folder");
        for (name, text) in files {
            let path = folder.path().join(name);
            fs::create_dir_all(path.parent().expect("a parent")).expect("a folder");
            fs::write(path, text).expect("written");
        }
        folder
    }

    fn told(folder: &tempfile::TempDir) -> String {
        let error = Campaign::read(folder.path()).expect_err("a mistake").to_string();
        error.replace(&format!("{}{}", folder.path().display(), std::path::MAIN_SEPARATOR), "")
    }

    #[test]
    fn runs_take_their_layout_from_the_entry_the_campaign_or_the_sidecar() {
        let list = "[[run]]\nfile = \"one.csv\"\nlayout = \"a.lss\"\nspeed = 2\ntension = 1e3\n\n[[run]]\n\
                    file = \"sub/two.parquet\"\n";
        let files = [
            ("campaign.toml", list),
            ("one.csv", ""),
            ("sub/two.parquet", ""),
            ("sub/two.toml", SIDECAR),
            ("c.csv", ""),
        ];
        let at = folder(&files);
        let mut campaign = Campaign::read(at.path()).expect("a campaign");
        let entry = |name: &str, file: &str, layout: &str, nominal: Option<(f64, f64)>| Entry {
            name: name.to_owned(),
            file: at.path().join(file),
            root: Root::of_campaign(at.path()),
            layout: at.path().join(layout),
            speed: nominal.map(|n| n.0),
            tension: nominal.map(|n| n.1),
            settings: BTreeMap::new(),
            defaults: SidecarDefaults::default(),
        };
        let one = entry("one", "one.csv", "a.lss", Some((2.0, 1000.0)));
        assert_eq!(campaign.runs, [one.clone(), entry("two", "sub/two.parquet", "sub/lines/b.lss", None)]);
        let named = Campaign::read(&at.path().join("campaign.toml")).expect("a campaign");
        campaign.root.clone_from(&named.root);
        campaign.runs.iter_mut().for_each(|run| run.root.clone_from(&named.root));
        assert_eq!(named, campaign, "the file names its folder");
        fs::write(at.path().join("campaign.toml"), format!("layout = \"d.lss\"\n{list}")).expect("written");
        let campaign = Campaign::read(at.path()).expect("a campaign");
        assert_eq!(campaign.runs, [one, entry("two", "sub/two.parquet", "d.lss", None)]);
    }

    /// What the runs of one recorder have in common is said once; a sidecar that says it has the last word.
    #[test]
    fn a_campaign_says_what_its_recorder_did() {
        let list = "zeroed = [\"run_left\"]\n[columns]\n\"Zug [kN]\" = { channel = \"joint_xi\", factor = 1000 }\n\
                    [[run]]\nfile = \"a.csv\"\n[[run]]\nfile = \"b.csv\"\n";
        let data = "time,trigger,Zug [kN]\n0,0,1\n0.002,1,2\n0.004,0,3\n";
        let own = format!("{SIDECAR}zeroed = []\n[columns]\n\"Zug [kN]\" = {{ channel = \"joint_xi\", factor = 1 }}\n");
        let at =
            folder(&[("campaign.toml", list), ("a.csv", data), ("a.toml", SIDECAR), ("b.csv", data), ("b.toml", &own)]);
        let campaign = Campaign::read(at.path()).expect("a campaign");
        let [a, b] = [0, 1].map(|k| campaign.runs[k].run().expect("a run"));
        let forces = |run: &Run| run.channels[&Channel::JointXi].clone();
        assert_eq!((forces(&a), forces(&b)), (vec![1000.0, 2000.0, 3000.0], vec![1.0, 2.0, 3.0]));
        assert_eq!((a.sidecar.zeroed, b.sidecar.zeroed), (vec![Channel::RunLeft], Vec::new()));
        // A mistake is told where it stands.
        let wrong = list.replace("joint_xi", "joint_x");
        fs::write(at.path().join("campaign.toml"), wrong).expect("written");
        let said = Campaign::read(at.path()).expect_err("no channel").to_string();
        assert!(said.contains("campaign.toml") && said.contains("Zug [kN]") && said.contains(Mapping::ENTRY), "{said}");
    }

    #[test]
    fn a_folder_alone_is_a_campaign_of_the_runs_with_sidecars() {
        let files =
            [("b.csv", ""), ("b.toml", SIDECAR), ("a.MF4", ""), ("a.toml", SIDECAR), ("bill.csv", ""), ("n.txt", "")];
        let at = folder(&files);
        let campaign = Campaign::read(at.path()).expect("a campaign");
        assert_eq!(campaign.runs.iter().map(|r| r.name.as_str()).collect::<Vec<_>>(), ["a", "b"]);
        assert_eq!(campaign.runs[1].layout, at.path().join("lines/b.lss"));
        let mut single = Campaign::read(&at.path().join("b.csv")).expect("a campaign");
        single.runs[0].root.clone_from(&campaign.root);
        assert_eq!(single.runs, campaign.runs[1..]);
    }

    #[test]
    fn a_run_alone_is_as_the_campaign_beside_it_lists_it() {
        let list =
            "layout = \"d.lss\"\nzeroed = [\"run_left\"]\n[[run]]\nfile = \"./a.csv\"\nspeed = 2\ntension = 700\n";
        let data = "time,trigger,run_left\n0,0,1\n0.002,1,2\n0.004,0,3\n";
        let files =
            [("campaign.toml", list), ("a.csv", data), ("a.toml", SIDECAR), ("b.csv", data), ("b.toml", SIDECAR)];
        let at = folder(&files);
        let [a, b] = ["a.csv", "b.csv"].map(|name| Entry::of(&at.path().join(name)).expect("a run"));
        assert_eq!((a.layout.clone(), a.speed, a.tension), (at.path().join("d.lss"), Some(2.0), Some(700.0)));
        assert_eq!(a.run().expect("samples").sidecar.zeroed, [Channel::RunLeft]);
        assert_eq!((b.layout.clone(), b.tension), (at.path().join("lines/b.lss"), None));
        assert_eq!(b.run().expect("samples").sidecar.zeroed, []);
        assert!(matches!(
            Entry::of(&at.path().join("a.toml")).expect_err("no data").problem,
            DataProblem::UnknownFormat
        ));
    }

    #[test]
    fn another_machine_declares_its_channels_and_needs_no_layout() {
        let list = "[[run]]\nfile = \"one.csv\"\npayload = 20\n[channels]\nposition = \"m\"\nforce = \"N\"\n";
        let campaign = Campaign::read(folder(&[("campaign.toml", list), ("one.csv", "")]).path()).expect("a campaign");
        assert_eq!(campaign.channels, [("force", "N"), ("position", "m")].map(|(a, b)| (a.into(), b.into())).into());
        assert_eq!(campaign.runs[0].layout, PathBuf::new());
        assert_eq!(campaign.runs[0].settings, [("payload".to_owned(), 20.0)].into());
    }

    #[test]
    fn mistakes_are_told_with_their_line_and_a_way_out() {
        let run = "[[run]]\nfile = \"one.csv\"\n";
        let cases = [
            (String::new(), "campaign.toml: the campaign has no runs\n  help: add [[run]] with file"),
            (
                format!("# all\nlayuot = \"a\"\n{run}"),
                "campaign.toml, row 2, `layuot`: there is no such key\n  help: did you mean `layout`?",
            ),
            (
                format!("{run}weather = \"dry\""),
                "campaign.toml, row 3, `weather`: there is no such key\n  \
                 help: remove it; keys are file, layout, speed, tension",
            ),
            ("run = 3".into(), "campaign.toml, row 1, `run`: the value is not tables, each headed by [[run]]"),
            ("run = [3]".into(), "campaign.toml, row 1, `run`: the value is not tables, each headed by [[run]]"),
            ("channels = 3".into(), "campaign.toml, row 1, `channels`: the value is not a table headed by [channels]"),
            ("[channels]\nx = 3".into(), "campaign.toml, row 2, `x`: the value is not a unit in quotes"),
            (format!("{run}speed = 0"), "campaign.toml, row 3, `speed`: the value is not a speed above 0"),
            (format!("{run}tension = \"1 kN\""), "campaign.toml, row 3, `tension`: the value is not a force from 0"),
            (
                format!("{run}\n[[run]]\nspeed = 2"),
                "campaign.toml, row 4, `file`: the key is missing\n  help: add file = \"run-01.csv\", the path",
            ),
            (
                format!("{run}layout = \"a.lss\"\n{}", run.replace("one", "none")),
                "campaign.toml, row 5, `file`: there is no file none.csv\n  \
                 help: paths are seen from the campaign's folder",
            ),
            (
                format!("layout = \"a.lss\"\n{run}{run}"),
                "campaign.toml, row 5, `file`: the run has the same name as one.csv\n  \
                 help: a run is known by its file's name",
            ),
            (run.to_owned(), "one.csv: there is no sidecar one.toml\n  help: write it with layout"),
            ("[[run]\n".into(), "campaign.toml, row 1: is malformed: "),
        ];
        for (list, expected) in cases {
            let told = told(&folder(&[("campaign.toml", &list), ("one.csv", "")]));
            assert!(told.starts_with(expected), "{list}\n{told}\n{expected}");
        }
        let twice = folder(&[("one.csv", ""), ("one.parquet", ""), ("one.toml", SIDECAR)]);
        assert!(told(&twice).starts_with("one.parquet: the run has the same name as one.csv"), "{}", told(&twice));
        assert!(told(&folder(&[("note.txt", "")])).contains(": the campaign has no runs"));
        let lonely = told(&folder(&[("bom.csv", ""), ("run-01.csv", "")]));
        assert!(lonely.starts_with("run-01.csv: there is no sidecar run-01.toml"), "{lonely}");
        assert!(Campaign::read(Path::new("no/such/folder")).expect_err("nothing").is_unreadable());
    }

    #[test]
    fn a_bad_run_does_not_hide_the_good_ones() {
        let files = [("a.csv", ""), ("a.toml", "laps = 1"), ("b.csv", ""), ("b.toml", SIDECAR)];
        let (campaign, refused) = Campaign::read_each(folder(&files).path()).expect("a campaign");
        assert_eq!((campaign.runs[0].name.as_str(), refused[0].name.as_str()), ("b", "a"));
        assert_eq!(refused[0].error.problem, DataProblem::MissingKey);
    }
}
