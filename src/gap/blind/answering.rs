//! Answers first, the key afterwards: each case is diagnosed on a copy that stands alone, and its answer is kept.

use super::key::{Answer, Facts, Key};
use super::score::{Score, score};
use super::{CHALLENGE, KEY, seal};
use crate::gap::digest::sha256;
use std::collections::BTreeMap;
use std::fmt;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Folder of the answers in that of a challenge.
pub const ANSWERS: &str = "answers";

/// What a diagnosis leaves, and why it left nothing.
const ANSWER: &str = "gap.json";
const FAILURE: &str = "failure.txt";

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
            Trouble::File(path, why) => write!(f, "{}: {why}", path.display()),
            Trouble::Content(path, why) => write!(f, "{}: {why}", path.display()),
            Trouble::Stopped => f.write_str("stopped; what is answered is kept"),
        }
    }
}

impl std::error::Error for Trouble {}

/// How far it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Step<'a> {
    pub case: &'a str,
    /// From 0.
    pub number: usize,
    pub of: usize,
    /// Answered before.
    pub kept: bool,
}

/// Answers what is not answered yet: `diagnose` takes a case's folder and where `gap.json` shall be, and says why there is none.
/// Returns SHA-256 over all answers.
///
/// # Errors
///
/// [`Trouble`]; a case that cannot be diagnosed is none, but an answer that lacks.
pub fn answer(
    folder: &Path,
    diagnose: &dyn Fn(&Path, &Path) -> Result<(), String>,
    watch: &mut dyn FnMut(Step) -> bool,
) -> Result<String, Trouble> {
    let facts = facts(folder)?;
    // Beside nothing that belongs to the challenge.
    let scratch = std::env::temp_dir().join(format!("lss-blind-{}-{}", start(&facts.key_sha256), std::process::id()));
    let done = each(folder, &scratch, &facts, diagnose, watch);
    // What stays behind there is no harm.
    let _ = fs::remove_dir_all(&scratch);
    done?;
    let mut all = Vec::new();
    for case in &facts.cases {
        all.extend_from_slice(case.as_bytes());
        all.extend(fs::read(folder.join(ANSWERS).join(case).join(ANSWER)).unwrap_or_default());
    }
    Ok(sha256(&all))
}

fn start(hash: &str) -> String {
    hash.chars().filter(char::is_ascii_alphanumeric).take(12).collect()
}

fn each(
    folder: &Path,
    scratch: &Path,
    facts: &Facts,
    diagnose: &dyn Fn(&Path, &Path) -> Result<(), String>,
    watch: &mut dyn FnMut(Step) -> bool,
) -> Result<(), Trouble> {
    for (number, case) in facts.cases.iter().enumerate() {
        let kept = folder.join(ANSWERS).join(case);
        let answered = kept.join(ANSWER).exists();
        if !watch(Step { case, number, of: facts.cases.len(), kept: answered }) {
            return Err(Trouble::Stopped);
        }
        if answered {
            continue;
        }
        let (copy, out) = (scratch.join(case), scratch.join("out").join(case));
        copied(&folder.join(case), &copy)?;
        fs::create_dir_all(&out).map_err(|why| Trouble::File(out.clone(), why))?;
        let outcome = diagnose(&copy, &out);
        fs::create_dir_all(&kept).map_err(|why| Trouble::File(kept.clone(), why))?;
        let write = |name: &str, bytes: &[u8]| {
            let (part, whole) = (kept.join(format!("{name}.part")), kept.join(name));
            fs::write(&part, bytes).and_then(|()| fs::rename(&part, &whole)).map_err(|why| Trouble::File(whole, why))
        };
        match (outcome, fs::read(out.join(ANSWER))) {
            (Ok(()), Ok(bytes)) => {
                write(ANSWER, &bytes)?;
                let _ = fs::remove_file(kept.join(FAILURE));
            }
            (Ok(()), Err(why)) => write(FAILURE, format!("no {ANSWER}: {why}\n").as_bytes())?,
            (Err(why), _) => write(FAILURE, why.as_bytes())?,
        }
        let _ = fs::remove_dir_all(&copy);
        let _ = fs::remove_dir_all(&out);
    }
    Ok(())
}

/// Copies the files of a folder.
fn copied(from: &Path, to: &Path) -> Result<(), Trouble> {
    let trouble = |path: &Path| {
        let path = path.to_owned();
        move |why| Trouble::File(path, why)
    };
    fs::create_dir_all(to).map_err(trouble(to))?;
    for entry in fs::read_dir(from).map_err(trouble(from))? {
        let entry = entry.map_err(trouble(from))?.path();
        if let Some(name) = entry.file_name().filter(|_| entry.is_file()) {
            fs::copy(&entry, to.join(name)).map_err(trouble(&entry))?;
        }
    }
    Ok(())
}

/// The public facts of a challenge.
///
/// # Errors
///
/// [`Trouble`] when there are none.
pub fn facts(folder: &Path) -> Result<Facts, Trouble> {
    let path = folder.join(CHALLENGE);
    let bytes = fs::read(&path).map_err(|why| Trouble::File(path.clone(), why))?;
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
pub fn judged(folder: &Path) -> Result<Score, Trouble> {
    let facts = facts(folder)?;
    let mut answers = BTreeMap::new();
    for case in &facts.cases {
        let path = folder.join(ANSWERS).join(case).join(ANSWER);
        match fs::read(&path) {
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
    let sealed = fs::read(&path).map_err(|why| Trouble::File(path.clone(), why))?;
    let key = seal::open(&sealed, &facts.key_sha256).map_err(|why| Trouble::Content(path.clone(), why.to_string()))?;
    let key: Key = serde_json::from_slice(&key).map_err(|why| Trouble::Content(path, why.to_string()))?;
    Ok(score(&key.cases, &answers))
}

/// Diagnoses with this program as a child process.
pub fn child(case: &Path, out: &Path) -> Result<(), String> {
    let program = std::env::current_exe().map_err(|why| format!("this program cannot be found: {why}"))?;
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
    use crate::gap::blind::key::{Case, Kind, Level, Truth};
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
            kind: Kind::One,
            truth: vec![truth.clone()],
            strength_over_floor: 5.0,
            level: Some(Level::Medium),
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
        let stopped = answer(folder.path(), &diagnose, &mut |step| step.number < 1);
        assert!(matches!(stopped, Err(Trouble::Stopped)));
        let first = answer(folder.path(), &diagnose, &mut |_| true).unwrap();
        let again = answer(folder.path(), &diagnose, &mut |_| true).unwrap();
        assert_eq!(first, again);
        assert_eq!(*seen.borrow(), ["case-1", "case-2", "case-3", "case-3"]);
        let score = judged(folder.path()).unwrap();
        assert_eq!((score.cases, score.failed), (3, 1));
        assert_eq!((score.headline.top_1.hits, score.headline.top_1.of), (2, 3));
        // An interval without a lower end holds nothing.
        assert_eq!((score.coverage.hits, score.coverage.of), (0, 2));
    }

    #[test]
    fn a_key_that_was_exchanged_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        challenge(folder.path());
        fs::write(folder.path().join(KEY), seal::seal(b"{}", 3).bytes).unwrap();
        let said = judged(folder.path()).unwrap_err().to_string();
        assert!(said.contains("not the one that was published"), "{said}");
    }

    #[test]
    fn a_case_is_no_path() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(CHALLENGE), r#"{"key_sha256":"","cases":["../x"],"mix":""}"#).unwrap();
        assert!(facts(folder.path()).is_err());
    }
}
