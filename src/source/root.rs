//! How far a file may name other files: the project's root.
//!
//! Whoever starts a program is trusted, what it reads is not. A path on the command line may lead anywhere; a path that
//! stands in a file has to stay within the [`Root`], also through symbolic links.

use super::input::{self, InputError};
use super::visible::shown;
use std::fs::File;
use std::io;
use std::path::{Component, Path, PathBuf};
use std::sync::OnceLock;

/// The root that the command line says, canonical.
static GIVEN: OnceLock<PathBuf> = OnceLock::new();

/// The folders that files may name files in.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Root {
    /// Canonical.
    folders: Vec<PathBuf>,
}

impl Root {
    /// Says which folder is the root of everything that is read from now on. The first call counts.
    ///
    /// # Errors
    ///
    /// The folder is not there, or is none.
    pub fn give(folder: &Path) -> io::Result<()> {
        let place = folder.canonicalize()?;
        if !place.is_dir() {
            return Err(io::ErrorKind::NotADirectory.into());
        }
        GIVEN.get_or_init(|| place);
        Ok(())
    }

    /// The root of a layout in this folder: the one given, else the nearest folder upwards that holds `.git` or
    /// `lss.toml`, else the folder itself.
    pub fn of_layout(folder: &Path) -> Root {
        let folder = canonical(folder);
        let root = found(&folder).unwrap_or(folder);
        Root { folders: vec![root] }
    }

    /// The root of a campaign in this folder: as that of a layout, but without a marked folder also the one above, so
    /// that `campaigns/a` may name `../track.lss`. The file system's own root is never taken for that.
    pub fn of_campaign(folder: &Path) -> Root {
        let folder = canonical(folder);
        if let Some(root) = found(&folder) {
            return Root { folders: vec![root] };
        }
        let above = folder.parent().filter(|above| above.parent().is_some()).map(Path::to_owned);
        Root { folders: above.into_iter().chain([folder]).collect() }
    }

    /// A folder and nothing above it.
    pub fn only(folder: &Path) -> Root {
        Root { folders: vec![canonical(folder)] }
    }

    /// The root, and one more file: what the command line names is trusted, wherever a link of that name leads.
    #[must_use]
    pub fn and(mut self, file: &Path) -> Root {
        self.folders.extend(file.canonicalize());
        self
    }

    /// Where a file is that another file names, canonical.
    ///
    /// # Errors
    ///
    /// [`InputError::OutsideRoot`], whether or not the file is there: of what lies outside, not even that is told; and
    /// [`InputError::Missing`], [`InputError::Unreadable`].
    pub fn place(&self, named: &Path) -> Result<PathBuf, InputError> {
        match named.canonicalize() {
            Ok(place) if self.holds(&place) => Ok(place),
            Ok(_) => Err(self.outside()),
            Err(why) => {
                let there = named.ancestors().find(|a| a.symlink_metadata().is_ok()).unwrap_or(Path::new("."));
                match there.canonicalize() {
                    Ok(place) if self.holds(&place) => Err(why.into()),
                    _ => Err(self.outside()),
                }
            }
        }
    }

    /// Reads a file that another file names.
    ///
    /// # Errors
    ///
    /// As [`Root::place`]; [`InputError::TooLarge`] beyond `limit` bytes.
    pub fn read(&self, named: &Path, limit: u64) -> Result<Vec<u8>, InputError> {
        input::read(&self.place(named)?, limit)
    }

    /// Opens a file that another file names.
    ///
    /// # Errors
    ///
    /// As [`Root::place`].
    pub fn open(&self, named: &Path) -> Result<File, InputError> {
        input::open(&self.place(named)?)
    }

    /// Its folders, canonical.
    pub fn folders(&self) -> impl Iterator<Item = &Path> {
        self.folders.iter().map(PathBuf::as_path)
    }

    /// Whether it is the root that is given, or a folder that a project marks.
    pub fn is_marked(&self) -> bool {
        self.folders.iter().all(|folder| GIVEN.get() == Some(folder) || is_marked(folder))
    }

    pub(super) fn holds(&self, place: &Path) -> bool {
        self.folders.iter().any(|folder| place.starts_with(folder))
    }

    pub(super) fn outside(&self) -> InputError {
        InputError::OutsideRoot(self.shown())
    }

    /// The root's name as messages show it.
    fn shown(&self) -> String {
        let name = self.folders.first().and_then(|f| f.file_name());
        name.map_or_else(|| "the project".into(), |n| format!("`{}`", shown(n)))
    }
}

/// Where a path of the command line leads, canonical. It is trusted and may be anywhere; but a symbolic link that
/// stands in a marked project does not lead out of it, as it came with the project: `lss check layouts/*.lss` names
/// what somebody else put there.
///
/// # Errors
///
/// [`InputError::OutsideRoot`] of such a link; the file is not there.
pub fn given(path: &Path) -> Result<PathBuf, InputError> {
    let place = path.canonicalize()?;
    inside(path, &place)?;
    Ok(place)
}

/// That a folder of outputs, which need not exist yet, is not led out of the project it stands in by a symbolic link.
///
/// # Errors
///
/// [`InputError::OutsideRoot`]
pub fn given_output(folder: &Path) -> Result<(), InputError> {
    let there = folder.ancestors().find(|a| a.symlink_metadata().is_ok());
    let there = there.filter(|a| !a.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match there.canonicalize() {
        Ok(place) => inside(folder, &place),
        // A link that leads nowhere: what is made there would be made elsewhere.
        Err(why) => Err(why.into()),
    }
}

/// That a folder below one of outputs, which both need not exist yet, is not led out of it by a symbolic link.
///
/// # Errors
///
/// [`InputError::OutsideRoot`]
pub fn below(output: &Path, folder: &Path) -> Result<(), InputError> {
    if output.symlink_metadata().is_err() {
        return Ok(());
    }
    match Root::only(output).place(folder) {
        Err(why @ InputError::OutsideRoot(_)) => Err(why),
        _ => Ok(()),
    }
}

/// That the canonical `place` of a `path` lies in the marked folder that the path stands in by name, if there is one.
fn inside(path: &Path, place: &Path) -> Result<(), InputError> {
    let Some(path) = std::path::absolute(path).ok().and_then(|path| normalise(&path)) else { return Ok(()) };
    let chosen = GIVEN.get();
    if chosen.is_some_and(|root| place.starts_with(root)) {
        return Ok(());
    }
    let by_name = path.ancestors().skip(1).find(|f| chosen.is_some_and(|c| c == f) || is_marked(f) && !f.is_symlink());
    match by_name.and_then(|root| root.canonicalize().ok()) {
        Some(root) if !place.starts_with(&root) => Err(Root { folders: vec![root] }.outside()),
        _ => Ok(()),
    }
}

fn canonical(folder: &Path) -> PathBuf {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    folder.canonicalize().unwrap_or_else(|_| folder.to_owned())
}

/// The root that is given or marked.
fn found(folder: &Path) -> Option<PathBuf> {
    GIVEN.get().cloned().or_else(|| folder.ancestors().find(|f| is_marked(f)).map(Path::to_owned))
}

/// Whether a folder is a project's root. In work trees and submodules, `.git` is a file.
pub fn is_marked(folder: &Path) -> bool {
    folder.join("lss.toml").exists() || folder.join(".git").exists()
}

/// Resolves `.` and `..` by name alone; `None` when that leads above the beginning.
pub(super) fn normalise(path: &Path) -> Option<PathBuf> {
    let mut out = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => {
                if !out.pop() {
                    return None;
                }
            }
            other => out.push(other),
        }
    }
    Some(out)
}

/// The root that the command line says, canonical.
pub fn chosen() -> Option<&'static Path> {
    GIVEN.get().map(PathBuf::as_path)
}

/// Reads a file that the command line names.
///
/// # Errors
///
/// As [`given`] and [`input::read`].
pub fn read_given(path: &Path, limit: u64) -> Result<Vec<u8>, InputError> {
    input::read(&given(path)?, limit)
}

/// Opens a file that the command line names.
///
/// # Errors
///
/// As [`given`] and [`input::open`].
pub fn open_given(path: &Path) -> Result<File, InputError> {
    input::open(&given(path)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn tree(files: &[&str]) -> tempfile::TempDir {
        let at = tempfile::tempdir().unwrap();
        for name in files {
            let path = at.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, name).unwrap();
        }
        at
    }

    fn outside<T: std::fmt::Debug>(found: Result<T, InputError>) -> bool {
        matches!(found, Err(InputError::OutsideRoot(_)))
    }

    #[test]
    fn an_unmarked_campaign_reaches_one_folder_up() {
        let at = tree(&["p/a/run.csv", "p/track.lss", "p/b/other.lss", "secret"]);
        let folder = at.path().join("p/a");
        let root = Root::of_campaign(&folder);
        for named in ["../track.lss", "run.csv", "../b/other.lss", "../../p/track.lss"] {
            assert!(root.read(&folder.join(named), 100).is_ok(), "{named}");
        }
        // Whether a file outside is there makes no difference.
        for named in ["../../secret", "../../missing", "/etc/hostname", "/no/such/file", "../../p/../secret"] {
            assert!(outside(root.read(&folder.join(named), 100)), "{named}");
        }
        assert!(matches!(root.read(&folder.join("../missing.lss"), 100), Err(InputError::Missing(_))));
        assert!(outside(Root::of_layout(&folder).read(&folder.join("../track.lss"), 100)));
    }

    #[test]
    fn the_file_system_is_no_campaigns_parent() {
        assert!(outside(Root::of_campaign(Path::new("/usr")).place(Path::new("/etc"))));
    }

    #[test]
    fn a_marked_folder_is_the_root_and_git_may_be_a_file() {
        for mark in ["p/lss.toml", "p/.git", "p/.git/HEAD"] {
            let at = tree(&[mark, "p/a/b/run.csv", "p/track.lss", "secret"]);
            let folder = at.path().join("p/a/b");
            let root = Root::of_campaign(&folder);
            assert!(root.read(&folder.join("../../track.lss"), 100).is_ok(), "{mark}");
            assert!(outside(root.read(&folder.join("../../../secret"), 100)), "{mark}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn links_lead_no_file_and_no_output_out_of_a_marked_project() {
        use std::os::unix::fs::symlink;
        let at = tree(&["p/lss.toml", "p/in.lss", "secret/a.lss", "free/in.lss"]);
        let path = |name: &str| at.path().join(name);
        symlink(path("secret/a.lss"), path("p/out.lss")).unwrap();
        symlink(path("secret"), path("p/folder")).unwrap();
        symlink(path("nowhere"), path("p/dangling")).unwrap();
        symlink("in.lss", path("p/in-link.lss")).unwrap();
        symlink(path("secret/a.lss"), path("free/link.lss")).unwrap();
        let root = Root::of_campaign(&path("p"));
        for name in ["p/out.lss", "p/folder/a.lss", "p/folder/missing", "p/dangling"] {
            assert!(outside(root.place(&path(name))), "{name}");
        }
        for name in ["p/out.lss", "p/folder/a.lss"] {
            assert!(outside(given(&path(name))), "{name}");
        }
        for name in ["p/in-link.lss", "free/link.lss", "secret/a.lss"] {
            assert!(given(&path(name)).is_ok(), "{name}");
        }
        for (name, is_inside) in [("p/out", true), ("p/folder", false), ("p/folder/new/er", false), ("secret/x", true)]
        {
            assert_eq!(given_output(&path(name)).is_ok(), is_inside, "{name}");
        }
        assert!(given_output(&path("p/dangling")).is_err());
    }
}
