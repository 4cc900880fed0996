//! A set of files, written whole or not at all.

use std::fmt;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Names and contents, in the order they are reported.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Files {
    list: Vec<(String, Vec<u8>)>,
}

/// Why a set of files could not be written. Nothing has changed on the disk then.
#[derive(Debug)]
pub struct WriteError {
    pub path: PathBuf,
    pub reason: io::Error,
}

impl fmt::Display for WriteError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "cannot write {}: {}", self.path.display(), self.reason)
    }
}

impl std::error::Error for WriteError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(&self.reason)
    }
}

impl Files {
    /// Adds a file by its plain name, without folders. A name that is there already gets the new content.
    pub fn push(&mut self, name: impl Into<String>, content: impl Into<Vec<u8>>) {
        let (name, content) = (name.into(), content.into());
        match self.list.iter_mut().find(|(n, _)| *n == name) {
            Some(slot) => slot.1 = content,
            None => self.list.push((name, content)),
        }
    }

    pub fn iter(&self) -> impl Iterator<Item = (&str, &[u8])> {
        self.list.iter().map(|(name, content)| (name.as_str(), content.as_slice()))
    }

    /// Writes all files into `folder`, which is made if need be.
    ///
    /// Every content goes to a temporary name beside its target first; only when all are on the disk do they take their
    /// places, and what stood there is kept until the last has. On failure, everything is put back.
    ///
    /// # Errors
    ///
    /// The first path that could not be written, with the reason.
    pub fn write(&self, folder: &Path) -> Result<(), WriteError> {
        let made = make_folder(folder)?;
        let mut swap = Swap { entries: self.list.iter().map(|(name, _)| Entry::new(folder, name)).collect() };
        let done = swap.stage(&self.list).and_then(|()| swap.replace());
        if done.is_err() {
            swap.restore();
            for folder in made.iter().rev() {
                // Somebody else may have put a file there meanwhile.
                let _ = fs::remove_dir(folder);
            }
        } else {
            swap.forget();
        }
        done
    }
}

impl Extend<(String, Vec<u8>)> for Files {
    fn extend<I: IntoIterator<Item = (String, Vec<u8>)>>(&mut self, files: I) {
        for (name, content) in files {
            self.push(name, content);
        }
    }
}

impl FromIterator<(String, Vec<u8>)> for Files {
    fn from_iter<I: IntoIterator<Item = (String, Vec<u8>)>>(files: I) -> Self {
        let mut set = Files::default();
        set.extend(files);
        set
    }
}

/// The folders that had to be made, outermost first.
fn make_folder(folder: &Path) -> Result<Vec<PathBuf>, WriteError> {
    let missing = |p: &&Path| !p.as_os_str().is_empty() && !p.exists();
    let mut made: Vec<PathBuf> = folder.ancestors().take_while(missing).map(Path::to_owned).collect();
    made.reverse();
    match fs::create_dir_all(folder) {
        Ok(()) => Ok(made),
        Err(reason) => {
            for folder in made.iter().rev() {
                let _ = fs::remove_dir(folder);
            }
            Err(WriteError { path: folder.to_owned(), reason })
        }
    }
}

struct Swap {
    entries: Vec<Entry>,
}

/// One file on its way.
struct Entry {
    target: PathBuf,
    fresh: PathBuf,
    former: PathBuf,
    /// Which of the steps are done, for undoing them.
    written: bool,
    set_aside: bool,
    placed: bool,
}

impl Entry {
    fn new(folder: &Path, name: &str) -> Self {
        let beside = |state: &str| folder.join(format!(".{name}.{}.{state}", std::process::id()));
        Entry {
            target: folder.join(name),
            fresh: beside("new"),
            former: beside("old"),
            written: false,
            set_aside: false,
            placed: false,
        }
    }
}

impl Swap {
    fn stage(&mut self, list: &[(String, Vec<u8>)]) -> Result<(), WriteError> {
        for (entry, (_, content)) in self.entries.iter_mut().zip(list) {
            if entry.target.is_dir() {
                let reason = io::Error::new(io::ErrorKind::IsADirectory, "a folder has this name");
                return Err(WriteError { path: entry.target.clone(), reason });
            }
            // A file that could be written only in part has to be removed as well.
            entry.written = true;
            fs::write(&entry.fresh, content).map_err(|reason| WriteError { path: entry.target.clone(), reason })?;
        }
        Ok(())
    }

    fn replace(&mut self) -> Result<(), WriteError> {
        for entry in &mut self.entries {
            let failed = |reason| WriteError { path: entry.target.clone(), reason };
            match fs::rename(&entry.target, &entry.former) {
                Ok(()) => entry.set_aside = true,
                Err(reason) if reason.kind() == io::ErrorKind::NotFound => {}
                Err(reason) => return Err(failed(reason)),
            }
            fs::rename(&entry.fresh, &entry.target).map_err(failed)?;
            entry.placed = true;
        }
        Ok(())
    }

    /// Puts everything back. There is nobody left to tell if even that fails.
    fn restore(&self) {
        for entry in self.entries.iter().rev() {
            if entry.set_aside {
                let _ = fs::rename(&entry.former, &entry.target);
            } else if entry.placed {
                let _ = fs::remove_file(&entry.target);
            }
            if entry.written && !entry.placed {
                let _ = fs::remove_file(&entry.fresh);
            }
        }
    }

    fn forget(&self) {
        for entry in self.entries.iter().filter(|e| e.set_aside) {
            let _ = fs::remove_file(&entry.former);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn files(list: &[(&str, &str)]) -> Files {
        list.iter().map(|(name, text)| ((*name).to_owned(), text.as_bytes().to_vec())).collect()
    }

    /// Names and texts in a folder, sorted; folders have no text.
    fn content(folder: &Path) -> Vec<(String, String)> {
        let mut list: Vec<_> = fs::read_dir(folder)
            .unwrap()
            .map(|e| e.unwrap())
            .map(|e| (e.file_name().into_string().unwrap(), fs::read_to_string(e.path()).unwrap_or_default()))
            .collect();
        list.sort();
        list
    }

    fn pairs(list: &[(&str, &str)]) -> Vec<(String, String)> {
        list.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect()
    }

    #[test]
    fn files_replace_those_before_and_leave_others() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("a/b");
        files(&[("one", "1"), ("two", "2")]).write(&out).unwrap();
        fs::write(out.join("mine"), "kept").unwrap();
        files(&[("two", "22"), ("three", "3")]).write(&out).unwrap();
        assert_eq!(content(&out), pairs(&[("mine", "kept"), ("one", "1"), ("three", "3"), ("two", "22")]));
    }

    #[test]
    fn a_failure_leaves_everything_as_it_was() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("one"), "before").unwrap();
        fs::create_dir(folder.path().join("two")).unwrap();
        let error = files(&[("one", "1"), ("two", "2")]).write(folder.path()).unwrap_err();
        assert_eq!(error.path, folder.path().join("two"));
        assert_eq!(content(folder.path()), pairs(&[("one", "before"), ("two", "")]));
    }

    #[test]
    fn files_already_in_place_are_taken_back() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("one"), "before").unwrap();
        let set = files(&[("one", "1"), ("two", "2"), ("three", "3")]);
        let mut swap = Swap { entries: set.iter().map(|(name, _)| Entry::new(folder.path(), name)).collect() };
        swap.stage(&set.list).unwrap();
        // The third one's content gets lost between the two steps.
        fs::remove_file(&swap.entries[2].fresh).unwrap();
        assert_eq!(swap.replace().unwrap_err().path, folder.path().join("three"));
        swap.restore();
        assert_eq!(content(folder.path()), pairs(&[("one", "before")]));
    }

    #[test]
    fn a_folder_that_cannot_be_is_not_half_made() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("file"), "").unwrap();
        assert!(files(&[("one", "1")]).write(&folder.path().join("file/out")).is_err());
        let out = folder.path().join("new/out");
        assert!(files(&[("no/such", "1")]).write(&out).is_err());
        assert_eq!(content(folder.path()), pairs(&[("file", "")]));
    }

    #[test]
    fn a_name_stands_once() {
        let set = files(&[("a", "1"), ("b", "2"), ("a", "3")]);
        assert_eq!(set.iter().collect::<Vec<_>>(), [("a", &b"3"[..]), ("b", &b"2"[..])]);
    }
}
