//! Temporary files: names that cannot be guessed, a lock while somebody needs them, and the removal of those that
//! nobody does.

use crate::base::unique;
use std::ffi::OsStr;
use std::fs::{self, File, Metadata, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

const PREFIX: &str = ".lss-";
const SUFFIX: &str = ".tmp";
/// Attempts to find a name that is free and is not swept at once.
const ATTEMPTS: usize = 16;

/// A file that is removed unless it takes a target's place. It is locked as long as this process needs it, which is how
/// [`sweep`] tells it from one that a dead process left.
#[derive(Debug)]
pub struct Temporary {
    path: PathBuf,
    /// `None` for one that could not be opened for its lock.
    file: Option<File>,
    placed: bool,
}

impl Temporary {
    /// An empty file in `folder`, with the permissions of the file that it is to replace.
    ///
    /// # Errors
    ///
    /// The folder's, or that of the source of random numbers.
    pub fn new(folder: &Path, like: Option<&Metadata>) -> io::Result<Temporary> {
        for _ in 0..ATTEMPTS {
            let path = folder.join(name()?);
            match options(like).open(&path) {
                Ok(file) => {
                    let temporary = Temporary { path, file: Some(file), placed: false };
                    if temporary.locked() {
                        temporary.become_like(like)?;
                        return Ok(temporary);
                    }
                }
                Err(why) if why.kind() == io::ErrorKind::AlreadyExists => {}
                Err(why) => return Err(why),
            }
        }
        Err(io::Error::new(io::ErrorKind::AlreadyExists, "no free name for a temporary file"))
    }

    /// A second name of a file, so that its content outlives a replacement.
    ///
    /// # Errors
    ///
    /// Where the file system has no hard links, among others.
    pub fn second_name(of: &Path) -> io::Result<Temporary> {
        let path = folder_of(of).join(name()?);
        fs::hard_link(of, &path)?;
        // Shared, as another process may do the same. Without a lock the name may be swept, which loses only the way
        // back.
        let file = File::open(&path).ok().filter(|file| file.try_lock_shared().is_ok());
        Ok(Temporary { path, file, placed: false })
    }

    /// Writes all of the content, onto the disk.
    ///
    /// # Errors
    ///
    /// That of the file.
    pub fn fill(&mut self, content: &[u8]) -> io::Result<()> {
        let Some(file) = &mut self.file else { return Err(io::ErrorKind::NotFound.into()) };
        file.write_all(content)?;
        file.sync_all()
    }

    /// Takes the target's name; what had it is gone. The file stays open, for more to be appended.
    ///
    /// # Errors
    ///
    /// That of the rename.
    pub fn place(mut self, target: &Path) -> io::Result<Option<File>> {
        fs::rename(&self.path, target)?;
        self.placed = true;
        Ok(self.file.take())
    }

    /// Whether it is this process's now: a sweep may have been faster than the lock.
    fn locked(&self) -> bool {
        let Some(file) = &self.file else { return false };
        // Where files cannot be locked none is swept either.
        let _ = file.lock();
        self.path.symlink_metadata().is_ok()
    }

    #[cfg(unix)]
    fn become_like(&self, like: Option<&Metadata>) -> io::Result<()> {
        use std::os::unix::fs::MetadataExt;
        let (Some(file), Some(like)) = (&self.file, like) else { return Ok(()) };
        let own = file.metadata()?;
        if (own.uid(), own.gid()) != (like.uid(), like.gid()) {
            // Only root may give files away.
            let _ = std::os::unix::fs::fchown(file, Some(like.uid()), Some(like.gid()));
        }
        file.set_permissions(like.permissions())
    }

    #[cfg(not(unix))]
    fn become_like(&self, _: Option<&Metadata>) -> io::Result<()> {
        Ok(())
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if !self.placed {
            // There is nobody left to tell, and the next run sweeps.
            let _ = fs::remove_file(&self.path);
        }
    }
}

/// Never an existing file, nor what a link points to.
fn options(like: Option<&Metadata>) -> OpenOptions {
    let mut options = File::options();
    options.write(true).create_new(true);
    #[cfg(unix)]
    if let Some(like) = like {
        use std::os::unix::fs::{MetadataExt, OpenOptionsExt};
        // A private file's content is private from the beginning.
        options.mode(like.mode() & 0o777);
    }
    #[cfg(not(unix))]
    let _ = like;
    options
}

fn name() -> io::Result<String> {
    Ok(format!("{PREFIX}{}{SUFFIX}", unique::random()?))
}

/// Whether a name has the form that [`unique::random`] gives it between a prefix and a suffix.
pub(super) fn has_form(name: &OsStr, prefix: &str, suffix: &str) -> bool {
    let digits = name.to_str().and_then(|n| n.strip_prefix(prefix)?.strip_suffix(suffix));
    digits.is_some_and(unique::has_form)
}

/// The folder of a file; of a plain name the present one.
pub(super) fn folder_of(file: &Path) -> &Path {
    file.parent().filter(|f| !f.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Removes the temporary files of dead processes from a folder. What cannot be removed stays.
pub fn sweep(folder: &Path) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.filter_map(Result::ok) {
        if has_form(&entry.file_name(), PREFIX, SUFFIX) && entry.file_type().is_ok_and(|t| t.is_file()) {
            remove_abandoned(&entry.path());
        }
    }
}

fn remove_abandoned(path: &Path) {
    // The lock is held until the file is gone, so that nobody takes it for theirs meanwhile.
    if let Ok(file) = File::open(path)
        && file.try_lock().is_ok()
    {
        let _ = fs::remove_file(path);
    }
}

/// Brings the names in a folder onto the disk, where the system can do that.
///
/// # Errors
///
/// That of the disk.
pub fn sync_folder(folder: &Path) -> io::Result<()> {
    if !cfg!(unix) {
        return Ok(());
    }
    match File::open(folder)?.sync_all() {
        Err(why) if matches!(why.kind(), io::ErrorKind::InvalidInput | io::ErrorKind::Unsupported) => Ok(()),
        done => done,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leftovers_of_dead_processes_are_swept_and_live_ones_are_not() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let live = Temporary::new(folder.path(), None).unwrap();
        fs::write(at("kept"), "user's").unwrap();
        let held = Temporary::second_name(&at("kept")).unwrap();
        let dead = at(".lss-0123456789abcdef0123456789abcdef.tmp");
        fs::write(&dead, "half").unwrap();
        for other in [".lss-0123.tmp", ".lss-0123456789abcdef0123456789abcdeg.tmp", ".lss-manifest.json"] {
            fs::write(at(other), "not ours").unwrap();
        }
        sweep(folder.path());
        assert!(!dead.exists());
        assert!(live.path.exists() && held.path.exists());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 6);
        drop((live, held));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 4);
    }

    #[test]
    fn names_are_never_the_same() {
        let names: std::collections::BTreeSet<String> = (0..100).map(|_| name().unwrap()).collect();
        assert_eq!(names.len(), 100);
        assert!(names.iter().all(|n| has_form(OsStr::new(n), PREFIX, SUFFIX)));
    }

    #[cfg(unix)]
    #[test]
    fn a_link_of_our_form_is_neither_opened_nor_followed() {
        let folder = tempfile::tempdir().unwrap();
        let (secret, link) =
            (folder.path().join("secret"), folder.path().join(".lss-0123456789abcdef0123456789abcdef.tmp"));
        fs::write(&secret, "s").unwrap();
        std::os::unix::fs::symlink(&secret, &link).unwrap();
        assert!(options(None).open(&link).is_err());
        sweep(folder.path());
        assert_eq!(fs::read_to_string(&secret).unwrap(), "s");
    }
}
