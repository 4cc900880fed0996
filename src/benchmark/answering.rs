//! Answers first, the key afterwards: each case is diagnosed on a copy that stands alone, and its answer is kept.

use super::key::{Answer, Facts, Key};
use super::score::{Score, score};
use super::{CHALLENGE, KEY, seal};
use crate::base;
use crate::base::digest::sha256;
use crate::signal::read::DATA_LIMIT;
use crate::source::disk::{Scratch, replace};
use crate::source::input::JSON_LIMIT;
use crate::source::{InputError, Root, root, shown};
use std::collections::BTreeMap;
use std::fmt;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Folder of the answers in that of a challenge.
pub const ANSWERS: &str = "answers";

/// What a diagnosis leaves, why it left nothing, and a hash of what its answer comes from.
const ANSWER: &str = "gap.json";
const FAILURE: &str = "failure.txt";
const ORIGIN: &str = "origin.txt";

/// Why a challenge could not be scored.
#[derive(Debug)]
pub enum Trouble {
    /// A file that could not be read or written.
    File(PathBuf, io::Error),
    /// One that does not say what it should.
    Content(PathBuf, String),
    /// Stopped from outside.
    Stopped,
}

impl fmt::Display for Trouble {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Trouble::File(path, why) => write!(f, "{}: {why}", shown(path)),
            Trouble::Content(path, why) => write!(f, "{}: {why}", shown(path)),
            Trouble::Stopped => f.write_str("stopped; what is answered is kept"),
        }
    }
}

impl std::error::Error for Trouble {}

/// How far it is.
#[derive(Clone, Debug, PartialEq)]
pub struct AnsweringStep<'a> {
    pub case: &'a str,
    /// From 0.
    pub number: usize,
    pub of: usize,
    pub before: Before,
}

/// What is known of a case before it is diagnosed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Before {
    Nothing,
    /// An answer of the same diagnosis to the same files: it is kept.
    Kept,
    /// An answer that came from something else.
    OfOthers,
    /// A kept answer that was asked again, and came out otherwise: no kept answer is used.
    Contradicted,
}

/// Answers what is not answered yet: `diagnose` takes a case's folder and where `gap.json` shall be, and says why there
/// is none. An answer is kept for as long as `program`, which stands for the diagnosis, and the case's files are the
/// same; where some are kept and some lack, the first that is kept is asked again. Returns SHA-256 over all answers.
///
/// # Errors
///
/// [`Trouble`]; a case that cannot be diagnosed is none, but an answer that lacks.
pub fn answer(
    folder: &Path,
    program: &str,
    diagnose: &dyn Fn(&Path, &Path) -> Result<(), String>,
    watch: &mut dyn FnMut(AnsweringStep) -> bool,
) -> Result<String, Trouble> {
    let facts = facts(folder)?;
    // Beside nothing that belongs to the challenge.
    let scratch = Scratch::new().map_err(|why| Trouble::File(std::env::temp_dir(), why))?;
    Asked { folder, scratch: scratch.path(), program, diagnose }.all(&facts, watch)?;
    let mut all = Vec::new();
    for case in &facts.cases {
        all.extend_from_slice(case.as_bytes());
        all.extend(read(folder, &Path::new(ANSWERS).join(case).join(ANSWER)).unwrap_or_default());
    }
    Ok(sha256(&all))
}

/// Of a diagnosis: what it answers, or why it does not.
type Answered = Result<Vec<u8>, String>;

/// A challenge that is being answered.
struct Asked<'a> {
    folder: &'a Path,
    scratch: &'a Path,
    program: &'a str,
    diagnose: &'a dyn Fn(&Path, &Path) -> Result<(), String>,
}

impl Asked<'_> {
    fn all(&self, facts: &Facts, watch: &mut dyn FnMut(AnsweringStep) -> bool) -> Result<(), Trouble> {
        let of = facts.cases.len();
        let mut before: Vec<Before> = facts.cases.iter().map(|case| self.before(case)).collect::<Result<_, _>>()?;
        let mut checked = before.iter().all(|b| *b == Before::Kept);
        for (number, case) in facts.cases.iter().enumerate() {
            if !watch(AnsweringStep { case, number, of, before: before[number] }) {
                return Err(Trouble::Stopped);
            }
            if before[number] == Before::Kept {
                if checked || self.is_confirmed(case)? {
                    checked = true;
                    continue;
                }
                before.iter_mut().filter(|b| **b == Before::Kept).for_each(|b| *b = Before::Contradicted);
                watch(AnsweringStep { case, number, of, before: before[number] });
            }
            self.keep(case, &self.answered(case)?)?;
        }
        Ok(())
    }

    fn kept(&self, case: &str, name: &str) -> PathBuf {
        self.folder.join(ANSWERS).join(case).join(name)
    }

    fn before(&self, case: &str) -> Result<Before, Trouble> {
        let Ok(answer) = fs::read(self.kept(case, ANSWER)) else { return Ok(Before::Nothing) };
        let origin = fs::read_to_string(self.kept(case, ORIGIN)).unwrap_or_default();
        Ok(if origin == self.origin(case, &answer)? { Before::Kept } else { Before::OfOthers })
    }

    /// Of the diagnosis, the case's files and the answer itself.
    fn origin(&self, case: &str, answer: &[u8]) -> Result<String, Trouble> {
        let mut all = format!("{} {}\n", self.program, sha256(answer));
        for path in files(&self.folder.join(case))? {
            let bytes = fs::read(&path).map_err(|why| Trouble::File(path.clone(), why))?;
            all.push_str(&format!("{:?} {}\n", path.file_name().unwrap_or_default(), sha256(&bytes)));
        }
        Ok(sha256(all.as_bytes()) + "\n")
    }

    /// Whether the diagnosis says the same again.
    fn is_confirmed(&self, case: &str) -> Result<bool, Trouble> {
        let kept = fs::read(self.kept(case, ANSWER)).ok();
        Ok(self.answered(case)?.ok() == kept)
    }

    /// Diagnoses a copy that stands alone.
    fn answered(&self, case: &str) -> Result<Answered, Trouble> {
        let (copy, out) = (self.scratch.join(case), self.scratch.join("out").join(case));
        copied(self.folder, case, &copy)?;
        fs::create_dir_all(&out).map_err(|why| Trouble::File(out.clone(), why))?;
        let outcome = (self.diagnose)(&copy, &out);
        let answer = fs::read(out.join(ANSWER)).map_err(|why| format!("no {ANSWER}: {why}\n"));
        // What stays behind there goes with the whole.
        let _ = fs::remove_dir_all(&copy);
        let _ = fs::remove_dir_all(&out);
        // Where the copy stood means nothing afterwards.
        Ok(outcome.and(answer).map_err(|why| why.replace(&*copy.to_string_lossy(), case)))
    }

    fn keep(&self, case: &str, answered: &Answered) -> Result<(), Trouble> {
        let folder = self.folder.join(ANSWERS).join(case);
        root::below(self.folder, &folder).map_err(|why| Trouble::File(folder.clone(), io::Error::other(why)))?;
        fs::create_dir_all(&folder).map_err(|why| Trouble::File(folder, why))?;
        let write = |name: &str, bytes: &[u8]| {
            let path = self.kept(case, name);
            replace(&path, bytes).map_err(|error| Trouble::File(path, error.reason))
        };
        match answered {
            Ok(answer) => {
                write(ANSWER, answer)?;
                // Last, so that an answer without it is asked again.
                write(ORIGIN, self.origin(case, answer)?.as_bytes())?;
                let _ = fs::remove_file(self.kept(case, FAILURE));
            }
            Err(why) => {
                // The answer of something else would be scored.
                let _ = fs::remove_file(self.kept(case, ANSWER));
                write(FAILURE, why.as_bytes())?;
            }
        }
        Ok(())
    }
}

/// The files of a folder, by name.
fn files(folder: &Path) -> Result<Vec<PathBuf>, Trouble> {
    let trouble = |why| Trouble::File(folder.to_owned(), why);
    let entries = fs::read_dir(folder).map_err(trouble)?.collect::<Result<Vec<_>, _>>().map_err(trouble)?;
    let mut files: Vec<PathBuf> = entries.iter().map(fs::DirEntry::path).filter(|path| path.is_file()).collect();
    files.sort();
    Ok(files)
}

/// Copies the files of a case. A copy of what a link leads to would look like the case's own, so none leads out of the
/// challenge.
fn copied(folder: &Path, case: &str, to: &Path) -> Result<(), Trouble> {
    let trouble = |path: &Path| {
        let path = path.to_owned();
        move |why| Trouble::File(path, why)
    };
    let from = folder.join(case);
    fs::create_dir_all(to).map_err(trouble(to))?;
    for file in files(&from)? {
        if let Some(name) = file.file_name() {
            let bytes = read_up_to(folder, &Path::new(case).join(name), DATA_LIMIT).map_err(trouble(&file))?;
            fs::write(to.join(name), bytes).map_err(trouble(&file))?;
        }
    }
    Ok(())
}

/// Reads a file of a challenge, which lies within its folder.
fn read(folder: &Path, path: &Path) -> io::Result<Vec<u8>> {
    read_up_to(folder, path, JSON_LIMIT)
}

fn read_up_to(folder: &Path, path: &Path, limit: u64) -> io::Result<Vec<u8>> {
    Root::only(folder).read(&folder.join(path), limit).map_err(|why| match why {
        InputError::Missing(_) => io::ErrorKind::NotFound.into(),
        other => io::Error::other(other),
    })
}

/// The public facts of a challenge.
///
/// # Errors
///
/// [`Trouble`] when there are none.
pub fn facts(folder: &Path) -> Result<Facts, Trouble> {
    let path = folder.join(CHALLENGE);
    let bytes = read(folder, Path::new(CHALLENGE)).map_err(|why| Trouble::File(path.clone(), why))?;
    let facts: Facts = serde_json::from_slice(&bytes).map_err(|why| Trouble::Content(path.clone(), why.to_string()))?;
    // Names become paths.
    let plain =
        |name: &String| !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_');
    match facts.cases.iter().find(|name| !plain(name)) {
        Some(name) => Err(Trouble::Content(path, format!("`{name}` is no name of a case"))),
        None => Ok(facts),
    }
}

/// Opens the key and holds the answers against it.
///
/// # Errors
///
/// [`Trouble`] when the key is not the one that was published.
pub fn score_folder(folder: &Path) -> Result<Score, Trouble> {
    let facts = facts(folder)?;
    let mut answers = BTreeMap::new();
    for case in &facts.cases {
        let path = folder.join(ANSWERS).join(case).join(ANSWER);
        match read(folder, &Path::new(ANSWERS).join(case).join(ANSWER)) {
            Ok(bytes) => {
                let answer: Answer =
                    serde_json::from_slice(&bytes).map_err(|why| Trouble::Content(path, why.to_string()))?;
                answers.insert(case.clone(), answer);
            }
            Err(why) if why.kind() == io::ErrorKind::NotFound => {}
            Err(why) => return Err(Trouble::File(path, why)),
        }
    }
    let path = folder.join(KEY);
    let sealed = read(folder, Path::new(KEY)).map_err(|why| Trouble::File(path.clone(), why))?;
    let key = seal::open(&sealed, &facts.key_sha256).map_err(|why| Trouble::Content(path.clone(), why.to_string()))?;
    let key: Key = serde_json::from_slice(&key).map_err(|why| Trouble::Content(path, why.to_string()))?;
    Ok(score(&key.cases, &answers))
}

/// Diagnoses with this program as a child process.
pub fn child(case: &Path, out: &Path) -> Result<(), String> {
    let program = base::installed().map_err(|why| format!("this program cannot be found: {why}"))?;
    let outcome = Command::new(program)
        .args(["gap", "diagnose"])
        .arg(case)
        .arg("-o")
        .arg(out)
        .args(["--format", "json"])
        .current_dir(case)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .output()
        .map_err(|why| format!("the diagnosis did not start: {why}"))?;
    if outcome.status.success() || out.join(ANSWER).exists() {
        return Ok(());
    }
    Err(format!("the diagnosis ended with {}:\n{}", outcome.status, String::from_utf8_lossy(&outcome.stderr)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::benchmark::key::{Case, CaseKind, StrengthLevel, Truth};
    use std::cell::RefCell;

    fn challenge(folder: &Path) {
        let truth = Truth {
            effect: "rail_step".into(),
            strengths: [("height".to_owned(), 1e-3)].into(),
            fixed: BTreeMap::new(),
            place: None,
        };
        let case = |name: &str| Case {
            name: name.into(),
            kind: CaseKind::One,
            truth: vec![truth.clone()],
            strength_over_floor: 5.0,
            level: Some(StrengthLevel::Medium),
            oracle: None,
            about: String::new(),
        };
        let key = Key { seed: 3, cases: vec![case("case-1"), case("case-2"), case("case-3")] };
        let sealed = seal::seal(&serde_json::to_vec(&key).unwrap(), 3);
        let facts = Facts {
            key_sha256: sealed.hash.clone(),
            cases: key.cases.iter().map(|c| c.name.clone()).collect(),
            mix: String::new(),
        };
        fs::write(folder.join(CHALLENGE), serde_json::to_vec(&facts).unwrap()).unwrap();
        fs::write(folder.join(KEY), &sealed.bytes).unwrap();
        for case in &facts.cases {
            fs::create_dir_all(folder.join(case)).unwrap();
            fs::write(folder.join(case).join("campaign.toml"), case).unwrap();
        }
    }

    #[test]
    fn answers_are_kept_and_the_key_is_opened_last() {
        let folder = tempfile::tempdir().unwrap();
        challenge(folder.path());
        let seen = RefCell::new(Vec::new());
        let diagnose = |case: &Path, out: &Path| {
            // Neither the key nor another case is near.
            assert!(!case.join("..").join(KEY).exists() && !case.join("..").join(CHALLENGE).exists());
            let name = fs::read_to_string(case.join("campaign.toml")).unwrap();
            seen.borrow_mut().push(name.clone());
            if name == "case-3" {
                return Err("no idea".to_owned());
            }
            let answer = r#"{"verdict":"effect","effects":[{"name":"rail_step","group":"","probability":0.9,
                "strength":{"height":{"value":1e-3,"low":null,"high":2e-3,"unit":"m"}}}],"other":[null]}"#;
            fs::write(out.join(ANSWER), answer).map_err(|e| e.to_string())
        };
        let stopped = answer(folder.path(), "1", &diagnose, &mut |step| step.number < 1);
        assert!(matches!(stopped, Err(Trouble::Stopped)));
        let first = answer(folder.path(), "1", &diagnose, &mut |_| true).unwrap();
        let again = answer(folder.path(), "1", &diagnose, &mut |_| true).unwrap();
        assert_eq!(first, again);
        // The one that is kept is asked again where others are asked for the first time.
        assert_eq!(*seen.borrow(), ["case-1", "case-1", "case-2", "case-3", "case-1", "case-3"]);
        let score = score_folder(folder.path()).unwrap();
        assert_eq!((score.cases, score.failed), (3, 1));
        assert_eq!((score.headline.top_1.hits, score.headline.top_1.of), (2, 3));
        // An interval without a lower end holds nothing.
        assert_eq!((score.coverage.hits, score.coverage.of), (0, 2));
    }

    #[test]
    fn answers_of_another_program_or_to_other_files_are_not_kept() {
        let folder = tempfile::tempdir().unwrap();
        challenge(folder.path());
        let asked = |program: &str, text: &str| {
            let seen = RefCell::new(Vec::new());
            let diagnose = |case: &Path, out: &Path| {
                seen.borrow_mut().push(case.file_name().unwrap().to_string_lossy().into_owned());
                fs::write(out.join(ANSWER), text).map_err(|e| e.to_string())
            };
            let mut said = Vec::new();
            let watch = &mut |step: AnsweringStep| {
                said.push(step.before);
                true
            };
            answer(folder.path(), program, &diagnose, watch).unwrap();
            (seen.into_inner().join(" "), said)
        };
        use Before::{Contradicted, Kept, Nothing, OfOthers};
        let all = || "case-1 case-2 case-3".to_owned();
        assert_eq!(asked("1", "a"), (all(), vec![Nothing; 3]));
        assert_eq!(asked("1", "b"), (String::new(), vec![Kept; 3]));
        assert_eq!(asked("2", "b"), (all(), vec![OfOthers; 3]));
        // Another run of a case; the others' answers are asked about once.
        fs::write(folder.path().join("case-3/campaign.toml"), "changed").unwrap();
        assert_eq!(asked("2", "b"), ("case-1 case-3".to_owned(), vec![Kept, Kept, OfOthers]));
        // An answer that was changed by hand is none of the diagnosis'.
        fs::write(folder.path().join("answers/case-2/gap.json"), "c").unwrap();
        assert_eq!(asked("2", "b"), ("case-1 case-2".to_owned(), vec![Kept, OfOthers, Kept]));
        // The same program by all that is known of it, and yet it answers otherwise.
        fs::write(folder.path().join("case-3/campaign.toml"), "once more").unwrap();
        let expected = vec![Kept, Contradicted, Contradicted, OfOthers];
        assert_eq!(asked("2", "d"), (format!("case-1 {}", all()), expected));
    }

    #[test]
    fn a_key_that_was_exchanged_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        challenge(folder.path());
        fs::write(folder.path().join(KEY), seal::seal(b"{}", 3).bytes).unwrap();
        let said = score_folder(folder.path()).unwrap_err().to_string();
        assert!(said.contains("not the one that was published"), "{said}");
    }

    #[test]
    fn a_case_is_no_path() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(CHALLENGE), r#"{"key_sha256":"","cases":["../x"],"mix":""}"#).unwrap();
        assert!(facts(folder.path()).is_err());
    }
}
