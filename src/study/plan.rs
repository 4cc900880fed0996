//! The tasks of a study, each with a hash of all that its result depends on.

use super::FORMAT;
use super::axis::{self, Axis, AxisValue};
use super::content::{Content, Contents};
use super::file::{self, StudyFile, Sweep};
use super::verb::{OptionKind, Verb, Works};
use crate::base::digest::sha256;
use crate::diagnostic::{Code, Diagnostic};
use crate::semantics::given::{NotGiven, is_value};
use crate::source::{InputError, Root, SIZE_LIMIT, SourceMap, root, shown};
use crate::syntax::nearest;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Digits of a task's hash: of 100 000 tasks two are the same once in four thousand million studies.
const DIGITS: usize = 16;

/// What there is to do.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    pub name: String,
    /// Of the `study.toml`, canonical: paths in it are seen from here.
    pub folder: PathBuf,
    /// What tasks work on, by digest.
    pub contents: BTreeMap<String, Content>,
    /// A row of the table each. Two rows may be the same task.
    pub tasks: Vec<Task>,
}

/// One row: what is done, and what is told of it in the table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Task {
    pub hash: String,
    pub sweep: String,
    /// Its parameters, as `study.toml` has them.
    pub parameters: Vec<(String, String)>,
    pub steps: Vec<Step>,
    /// Digests of the contents that it works on.
    pub contents: Vec<String>,
    /// Whether outputs stay beside the result.
    pub keep: bool,
}

/// One verb of a task.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Step {
    pub verb: Verb,
    /// As on the command line, `--speed=2 m/s`.
    pub options: Vec<String>,
    /// A file of the study, seen from its folder.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// What a step before it made, seen from the task's folder.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub made: Option<String>,
}

/// Why there is no plan.
#[derive(Debug)]
pub enum NoPlan {
    /// The file itself could not be read.
    Unreadable(String),
    /// What is wrong with it.
    Wrong(Vec<Diagnostic>),
}

/// Whether the command line takes these words; in words, why not.
pub type Checks<'a> = &'a dyn Fn(&[String]) -> Result<(), String>;

impl Plan {
    /// Reads a study and makes its tasks.
    ///
    /// # Errors
    ///
    /// [`NoPlan`], with everything that is wrong.
    pub fn read(sources: &mut SourceMap, path: &Path, checks: Checks) -> Result<Plan, NoPlan> {
        let unreadable = |why: InputError| NoPlan::Unreadable(why.to_string());
        let bytes = root::read_given(path, SIZE_LIMIT).map_err(unreadable)?;
        let place = root::given(path).map_err(unreadable)?;
        let folder = place.parent().unwrap_or(Path::new("/")).to_owned();
        let text = String::from_utf8(bytes)
            .map_err(|why| NoPlan::Unreadable(format!("byte {} is not UTF-8", why.utf8_error().valid_up_to())))?;
        let name = path.file_stem().map_or_else(|| "study".into(), |stem| stem.to_string_lossy().into_owned());
        let main = sources.add(path.to_string_lossy(), text.clone());
        let (study, said) = file::read(main, &text);
        if !said.is_empty() {
            return Err(NoPlan::Wrong(said));
        }
        let title = study.name.clone().unwrap_or(name);
        let mut planner = Planner {
            contents: Contents::new(Root::of_layout(&folder)),
            plan: Plan { name: title, folder, contents: BTreeMap::new(), tasks: Vec::new() },
            said: Vec::new(),
            checks,
        };
        planner.study(&study);
        if planner.said.is_empty() { Ok(planner.plan) } else { Err(NoPlan::Wrong(planner.said)) }
    }

    /// Each task once, in the order of the rows.
    pub fn unique(&self) -> Vec<&Task> {
        let mut seen = BTreeSet::new();
        self.tasks.iter().filter(|task| seen.insert(task.hash.as_str())).collect()
    }

    pub fn find(&self, hash: &str) -> Option<&Task> {
        self.tasks.iter().find(|task| task.hash == hash)
    }

    /// A line for the study and one for each row, as `plan.jsonl` has them.
    pub fn lines(&self) -> Vec<u8> {
        let head = Head {
            format: FORMAT,
            name: self.name.clone(),
            folder: self.folder.clone(),
            contents: self.contents.clone(),
        };
        let mut out = serde_json::to_vec(&head).unwrap_or_default();
        for task in &self.tasks {
            out.push(b'\n');
            out.extend(serde_json::to_vec(task).unwrap_or_default());
        }
        out.push(b'\n');
        out
    }

    /// Reads such lines.
    ///
    /// # Errors
    ///
    /// In words, what is wrong with them.
    pub fn from_lines(bytes: &[u8]) -> Result<Plan, String> {
        let mut lines = bytes.split(|b| *b == b'\n').filter(|line| !line.is_empty());
        let head: Head = lines
            .next()
            .ok_or("it is empty")
            .and_then(|line| serde_json::from_slice(line).map_err(|_| "its first line is of another program"))?;
        if head.format != FORMAT {
            return Err(format!("it is of another version of lss: its format is {}, not {FORMAT}", head.format));
        }
        let tasks = lines.map(serde_json::from_slice).collect::<Result<Vec<Task>, _>>();
        let tasks = tasks.map_err(|why| format!("a line of it is no task: {why}"))?;
        // Hashes become names of folders.
        let plain = |task: &&Task| task.hash.len() != DIGITS || !task.hash.bytes().all(|b| b.is_ascii_hexdigit());
        if let Some(task) = tasks.iter().find(plain) {
            return Err(format!("`{}` is no hash of a task", task.hash));
        }
        Ok(Plan { name: head.name, folder: head.folder, contents: head.contents, tasks })
    }
}

#[derive(Serialize, Deserialize)]
struct Head {
    format: u32,
    name: String,
    folder: PathBuf,
    contents: BTreeMap<String, Content>,
}

impl Task {
    /// Of a column, its value.
    pub fn parameter(&self, key: &str) -> Option<&str> {
        self.parameters.iter().find(|(name, _)| name == key).map(|(_, value)| value.as_str())
    }

    /// Its parameters in one line: `file=hub.lss simulate.speed=2 m/s`.
    pub fn words(&self) -> String {
        let all: Vec<String> = self.parameters.iter().map(|(key, value)| format!("{key}={value}")).collect();
        all.join(" ")
    }
}

struct Planner<'a> {
    contents: Contents,
    plan: Plan,
    said: Vec<Diagnostic>,
    checks: Checks<'a>,
}

/// What is known of a file that a sweep names.
struct Named {
    digest: String,
}

impl Planner<'_> {
    fn study(&mut self, study: &StudyFile) {
        for sweep in &study.sweeps {
            let before = self.said.len();
            let named = self.named(sweep);
            self.values(sweep);
            if self.said.len() == before {
                for row in axis::rows(&sweep.axes, &sweep.groups) {
                    let task = self.task(sweep, &row, &named);
                    self.plan.tasks.push(task);
                }
            }
        }
    }

    /// The files that a sweep names, by their names, with a look at what is set in them.
    fn named(&mut self, sweep: &Sweep) -> BTreeMap<String, Named> {
        let mut named = BTreeMap::new();
        for axis in sweep.axes.iter().filter(|axis| kind(axis) == OptionKind::File) {
            let on_runs = axis.key == "file" && works(sweep) == Works::OnRuns;
            for value in &axis.values {
                if named.contains_key(&value.text) {
                    continue;
                }
                let path = self.plan.folder.join(&value.text);
                let found = match on_runs {
                    true => self.contents.runs(&path).map(|content| (content, Vec::new())),
                    false => self.contents.track(&path),
                };
                match found {
                    Ok((content, lets)) => {
                        if axis.key == "file" {
                            self.lets(sweep, &value.text, &lets);
                        }
                        named.insert(value.text.clone(), Named { digest: content.digest.clone() });
                        self.plan.contents.insert(content.digest.clone(), content);
                    }
                    Err(why) => self.unread(value, &why),
                }
            }
        }
        named
    }

    fn unread(&mut self, value: &AxisValue, why: &str) {
        let mut lines = why.lines();
        let message = format!("cannot read `{}`", shown(Path::new(&value.text)));
        let label = lines.next().unwrap_or_default().to_owned();
        let more: Vec<&str> = lines.collect();
        let diagnostic = Diagnostic::new(Code::E0904, message, value.span, label);
        let help = "paths are seen from the study's folder, and stay within the project, whose root is the nearest folder \
                    upwards with an `lss.toml` or `.git`, else the study's own folder: an empty `lss.toml` further up \
                    widens it, and `--root DIR` says another";
        self.said.push(diagnostic.help([more.join("\n").as_str(), help].join("\n").trim().to_owned()));
    }

    /// That every `let` that is set is one of the file's.
    fn lets(&mut self, sweep: &Sweep, file: &str, known: &[String]) {
        for axis in &sweep.axes {
            let Some(name) = axis.key.strip_prefix("let.") else { continue };
            if known.iter().any(|k| k == name) || self.said.iter().any(|d| d.label.span == axis.span) {
                continue;
            }
            if file.ends_with(".json") {
                let message = format!("`{file}` is a simulation input and has no `let {name}`");
                let diagnostic = Diagnostic::new(Code::E0905, message, axis.span, "set here");
                self.said
                    .push(diagnostic.help("name the .lss that it was built from, or set numbers with simulate.set"));
                continue;
            }
            let why = NotGiven::Unknown { name: name.to_owned(), known: known.to_vec() };
            let message = format!("`{file}` has no `let {name}`");
            let mut diagnostic = Diagnostic::new(Code::E0905, message, axis.span, "set here").help(why.help());
            if let Some(near) = nearest(name, known.iter().map(String::as_str)) {
                diagnostic = diagnostic.fix(axis.span, near);
            }
            self.said.push(diagnostic);
        }
    }

    /// That the command line takes each value.
    fn values(&mut self, sweep: &Sweep) {
        let lets = sweep.axes.iter().find(|axis| axis.key.starts_with("let."));
        if let (Some(axis), Some(Verb::Challenge | Verb::Identify | Verb::Diagnose)) = (lets, sweep.steps.first()) {
            let message = "no step of this sweep reads a layout's `let`s";
            let diagnostic = Diagnostic::new(Code::E0905, message, axis.span, "set here");
            self.said.push(diagnostic.help("put build or simulate before it"));
        }
        for axis in &sweep.axes {
            for value in &axis.values {
                let wrong = match axis.key.strip_prefix("let.") {
                    Some(name) if !is_value(&value.text) => {
                        let why = NotGiven::NoValue { name: name.to_owned(), value: value.text.clone() };
                        Some((why.to_string(), why.help()))
                    }
                    _ => self.refused(axis, value).map(|why| (format!("`{}` cannot be that", axis.key), why)),
                };
                if let Some((message, help)) = wrong {
                    let diagnostic = Diagnostic::new(Code::E0903, message, value.span, "this value");
                    self.said.push(diagnostic.help(help));
                    // The next values are likely to be wrong in the same way.
                    break;
                }
            }
        }
    }

    /// Why the command line does not take a value.
    fn refused(&self, axis: &Axis, value: &AxisValue) -> Option<String> {
        let (verb, _) = option_of(&axis.key)?;
        if kind(axis) == OptionKind::Flag && !["true", "false"].contains(&value.text.as_str()) {
            return Some("write true or false".to_owned());
        }
        let mut words: Vec<String> = verb.words().iter().map(|word| (*word).to_owned()).collect();
        words.extend(["-o".to_owned(), "x".to_owned()]);
        words.extend(told(axis, &value.text));
        if verb != Verb::Challenge {
            words.extend(["--".to_owned(), "x.lss".to_owned()]);
        }
        (self.checks)(&words).err()
    }

    fn task(&self, sweep: &Sweep, row: &[&AxisValue], named: &BTreeMap<String, Named>) -> Task {
        let set: Vec<(&Axis, &str)> = sweep.axes.iter().zip(row.iter().map(|value| value.text.as_str())).collect();
        let file = set.iter().find(|(axis, _)| axis.key == "file").map(|(_, text)| (*text).to_owned());
        let mut contents = BTreeSet::new();
        let mut digest = |name: &str| {
            let digest = named.get(name).map_or("", |named| named.digest.as_str());
            contents.insert(digest.to_owned());
            digest.to_owned()
        };
        let mut steps = Vec::new();
        // What the hash is of: the steps, with content in the place of names.
        let mut key: Vec<(Verb, Vec<String>, String)> = Vec::new();
        let mut reads_lets = true;
        for verb in &sweep.steps {
            let made = verb.takes_from().filter(|(from, _)| sweep.steps.contains(from));
            let made = made.map(|(from, name)| [from.name(), name].join("/").trim_end_matches('/').to_owned());
            let file = file.clone().filter(|_| made.is_none());
            let mut options = Vec::new();
            let mut counted = Vec::new();
            for (axis, text) in &set {
                if option_of(&axis.key).is_some_and(|(of, _)| of == *verb) {
                    options.extend(told(axis, text));
                    let by_content = if kind(axis) == OptionKind::File { digest(text) } else { (*text).to_owned() };
                    counted.extend(told(axis, &by_content));
                }
            }
            if reads_lets && file.is_some() {
                let lets = set.iter().filter_map(|(axis, text)| Some((axis.key.strip_prefix("let.")?, text)));
                let lets: Vec<String> = lets.map(|(name, text)| format!("--let={name}={text}")).collect();
                options.extend(lets.iter().cloned());
                counted.extend(lets);
                reads_lets = false;
            }
            let on = file.as_deref().map(&mut digest).or(made.clone()).unwrap_or_default();
            key.push((*verb, counted, on));
            steps.push(Step { verb: *verb, options, file, made });
        }
        let text = serde_json::to_string(&(FORMAT, key)).unwrap_or_default();
        Task {
            hash: sha256(text.as_bytes()).chars().take(DIGITS).collect(),
            sweep: sweep.name.clone(),
            parameters: set.iter().map(|(axis, text)| (axis.key.clone(), (*text).to_owned())).collect(),
            steps,
            contents: contents.into_iter().collect(),
            keep: sweep.keep,
        }
    }
}

/// What the file of a sweep is.
fn works(sweep: &Sweep) -> Works {
    sweep.steps.first().map_or(Works::OnTrack, |verb| verb.works())
}

/// The verb and the option that a parameter is of.
fn option_of(key: &str) -> Option<(Verb, &str)> {
    let (verb, option) = key.split_once('.')?;
    Some((Verb::find(verb)?, option))
}

fn kind(axis: &Axis) -> OptionKind {
    if axis.key == "file" {
        return OptionKind::File;
    }
    let Some((verb, option)) = option_of(&axis.key) else { return OptionKind::Value };
    let option = option.split('.').next().unwrap_or_default();
    verb.option(option).map_or(OptionKind::Value, |option| option.kind)
}

/// An option with a value, as on the command line.
fn told(axis: &Axis, text: &str) -> Option<String> {
    let (verb, name) = option_of(&axis.key)?;
    let (name, inner) = name.split_once('.').map_or((name, None), |(name, inner)| (name, Some(inner)));
    let option = verb.option(name)?;
    match (option.kind, inner) {
        (OptionKind::Table, Some(inner)) => Some(format!("{}={inner}={text}", option.flag())),
        (OptionKind::Flag, _) => (text == "true").then(|| option.flag()),
        _ => Some(format!("{}={text}", option.flag())),
    }
}
