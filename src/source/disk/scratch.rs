//! A private folder for work in between.

use super::temporary::has_form;
use crate::base::unique;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

const PREFIX: &str = "lss-scratch-";
/// Locked while the folder is in use.
const LOCK: &str = ".lock";
const ATTEMPTS: usize = 16;

/// A new folder in the system's one for temporary files, which only this user can enter. It is removed with all that is
/// in it.
#[derive(Debug)]
pub struct Scratch {
    path: PathBuf,
    _lock: File,
}

impl Scratch {
    /// Also removes those that killed processes of this user left.
    ///
    /// # Errors
    ///
    /// Where no folder can be made.
    pub fn new() -> io::Result<Scratch> {
        Scratch::within(&std::env::temp_dir())
    }

    fn within(folder: &Path) -> io::Result<Scratch> {
        sweep(folder);
        for _ in 0..ATTEMPTS {
            let path = folder.join(format!("{PREFIX}{}", unique::random()?));
            match builder().create(&path) {
                Ok(()) => {}
                Err(why) if why.kind() == io::ErrorKind::AlreadyExists => continue,
                Err(why) => return Err(why),
            }
            // Another process may have swept the folder as long as it was not locked.
            let lock = path.join(LOCK);
            let Ok(file) = File::options().write(true).create_new(true).open(&lock) else { continue };
            let _ = file.lock();
            if lock.symlink_metadata().is_ok() {
                return Ok(Scratch { path, _lock: file });
            }
        }
        Err(io::Error::new(io::ErrorKind::AlreadyExists, "no free name for a temporary folder"))
    }

    pub fn path(&self) -> &Path {
        &self.path
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // What stays behind is swept by the next run.
        let _ = fs::remove_dir_all(&self.path);
    }
}

/// Fails where something has the name already, even a link.
fn builder() -> fs::DirBuilder {
    #[cfg_attr(not(unix), allow(unused_mut))]
    let mut builder = fs::DirBuilder::new();
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder
}

fn sweep(folder: &Path) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.filter_map(Result::ok) {
        if !has_form(&entry.file_name(), PREFIX, "") || !entry.file_type().is_ok_and(|t| t.is_dir()) {
            continue;
        }
        let path = entry.path();
        match File::open(path.join(LOCK)) {
            Ok(file) if file.try_lock().is_ok() => drop(fs::remove_dir_all(&path)),
            Ok(_) => {}
            // Killed before it had a lock: it is empty then.
            Err(_) => drop(fs::remove_dir(&path)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scratch_folder_is_private_and_swept_once_its_process_is_dead() {
        let folder = tempfile::tempdir().unwrap();
        let dead = folder.path().join(format!("{PREFIX}0123456789abcdef0123456789abcdef"));
        fs::create_dir(&dead).unwrap();
        fs::write(dead.join(LOCK), "").unwrap();
        fs::write(dead.join("case"), "half").unwrap();
        let live = Scratch::within(folder.path()).unwrap();
        assert!(!dead.exists());
        let second = Scratch::within(folder.path()).unwrap();
        assert!(live.path().exists() && live.path() != second.path());
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            assert_eq!(fs::metadata(live.path()).unwrap().permissions().mode() & 0o777, 0o700);
        }
        drop((live, second));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
