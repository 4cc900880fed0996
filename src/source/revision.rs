//! Layouts as they are in a revision of the git repository that they lie in. `git` itself reads them.

use super::loader::SIZE_LIMIT;
use std::fmt;
use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Why a revision's layouts cannot be had.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RevisionError {
    /// There is no `git` to run; the system's reason.
    NoGit(String),
    /// The file lies in no repository.
    NoRepository(PathBuf),
    /// The repository has no such revision.
    NoRevision(String),
    /// The revision has no such file.
    NoFile { revision: String, path: String },
    /// What git said.
    Failed(String),
}

impl RevisionError {
    /// Whether the revision is there, and the file is not in it.
    pub fn is_absent(&self) -> bool {
        matches!(self, RevisionError::NoFile { .. })
    }
}

impl fmt::Display for RevisionError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            RevisionError::NoGit(why) => write!(f, "cannot run git: {why}"),
            RevisionError::NoRepository(folder) => {
                write!(f, "{} lies in no git repository: compare two files instead", super::shown(folder))
            }
            RevisionError::NoRevision(revision) => write!(
                f,
                "the repository has no revision {revision}: `git log` lists commits, `git branch --all` branches; a \
                 shallow clone lacks most (`git fetch --unshallow`)"
            ),
            RevisionError::NoFile { revision, path } => write!(f, "{revision} has no {path}: nothing to compare with"),
            RevisionError::Failed(why) => write!(f, "git: {why}"),
        }
    }
}

impl std::error::Error for RevisionError {}

/// A layout as it is in a revision (a commit, branch or tag), and all others of the repository, which it may import:
/// paths from the repository's top, and contents. The layout itself comes first; it need not be there any more.
///
/// # Errors
/// Where git does not find it.
pub fn layouts(file: &Path, revision: &str) -> Result<Vec<(String, Vec<u8>)>, RevisionError> {
    let folder = match file.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    let name = file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let no_repository = |_| RevisionError::NoRepository(folder.to_owned());
    let prefix = git(folder, &["rev-parse", "--show-prefix"])?.map_err(no_repository)?;
    let path = format!("{}{name}", text(&prefix).trim_end_matches(['\n', '\r']));
    let commit = format!("{revision}^{{commit}}");
    let commit = git(folder, &["rev-parse", "--verify", "--quiet", "--end-of-options", &commit])?
        .map_err(|_| RevisionError::NoRevision(revision.to_owned()))?;
    let commit = text(&commit).trim().to_owned();
    let listed =
        git(folder, &["ls-tree", "-r", "-z", "--full-tree", "--name-only", &commit])?.map_err(RevisionError::Failed)?;
    let mut paths: Vec<String> = text(&listed)
        .split('\0')
        .filter(|path| path.ends_with(".lss") && !path.contains('\n'))
        .map(str::to_owned)
        .collect();
    let Some(own) = paths.iter().position(|own| *own == path) else {
        return Err(RevisionError::NoFile { revision: revision.to_owned(), path });
    };
    paths.swap(0, own);
    contents(folder, &commit, paths)
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// What git writes, or what it says where it fails.
fn git(folder: &Path, arguments: &[&str]) -> Result<Result<Vec<u8>, String>, RevisionError> {
    let output = command(folder).args(arguments).output().map_err(|why| RevisionError::NoGit(why.to_string()))?;
    let said = || text(&output.stderr).trim().to_owned();
    Ok(if output.status.success() { Ok(output.stdout.clone()) } else { Err(said()) })
}

/// Git without anything of the repository's own that it could run.
fn command(folder: &Path) -> Command {
    let mut command = Command::new("git");
    command.arg("-C").arg(folder).args(["-c", "core.fsmonitor=false", "-c", "core.hooksPath=/dev/null"]);
    command.env("GIT_OPTIONAL_LOCKS", "0").env("GIT_TERMINAL_PROMPT", "0").stdin(Stdio::null());
    command
}

/// The contents of files, in this order, from one process.
fn contents(folder: &Path, commit: &str, paths: Vec<String>) -> Result<Vec<(String, Vec<u8>)>, RevisionError> {
    let failed = |why: std::io::Error| RevisionError::Failed(why.to_string());
    let mut child = command(folder)
        .args(["cat-file", "--batch"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .map_err(|why| RevisionError::NoGit(why.to_string()))?;
    let (Some(mut input), Some(output)) = (child.stdin.take(), child.stdout.take()) else {
        return Err(RevisionError::Failed("no pipes".to_owned()));
    };
    let asked: String = paths.iter().map(|path| format!("{commit}:{path}\n")).collect();
    // Written beside the reading: either pipe may fill up.
    let writer = std::thread::spawn(move || input.write_all(asked.as_bytes()));
    let mut output = BufReader::new(output);
    let mut files = Vec::new();
    for path in paths {
        let mut head = String::new();
        output.read_line(&mut head).map_err(failed)?;
        let size: Option<u64> = head.split_whitespace().nth(2).and_then(|size| size.parse().ok());
        let size = size.ok_or_else(|| RevisionError::Failed(format!("{path}: {}", head.trim())))?;
        // One byte more than is allowed is enough to be refused.
        let mut bytes = Vec::new();
        (&mut output).take(size.min(SIZE_LIMIT + 1)).read_to_end(&mut bytes).map_err(failed)?;
        std::io::copy(&mut (&mut output).take(size - bytes.len() as u64 + 1), &mut std::io::sink()).map_err(failed)?;
        files.push((path, bytes));
    }
    drop(output);
    let _ = writer.join();
    let _ = child.wait();
    Ok(files)
}
