//! A set of files, written whole or not at all.

use super::manifest::Manifest;
use super::temporary::{Temporary, folder_of, sweep, sync_folder};
use crate::source::{Root, root, shown};
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
        write!(f, "cannot write {}: {}", shown(&self.path), self.reason)
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
    /// Every content is on the disk under a temporary name before the first takes its place. On failure, everything is
    /// put back.
    ///
    /// # Errors
    ///
    /// The first path that could not be written, with the reason.
    pub fn write(&self, folder: &Path) -> Result<(), WriteError> {
        self.commit(folder, None)
    }

    /// The same, with a manifest: it says first what is about to be replaced, and last that all of it was.
    /// [`super::inspect`] reads it.
    ///
    /// # Errors
    ///
    /// As [`Files::write`].
    pub fn write_set(&self, folder: &Path, set: &str) -> Result<(), WriteError> {
        self.commit(folder, Some(set))
    }

    fn commit(&self, folder: &Path, set: Option<&str>) -> Result<(), WriteError> {
        root::given_output(folder)
            .map_err(|why| WriteError { path: folder.to_owned(), reason: io::Error::other(why) })?;
        let made = Made::folder(folder)?;
        sweep(folder);
        let list = self.list.iter().map(|(name, content)| (folder.join(name), content.as_slice()));
        let done = match set {
            None => Swap::staged(list),
            Some(set) => {
                let manifest = Manifest::of(set, folder, self.iter());
                let (path, begun, complete) = (manifest.path(folder), manifest.begun(), manifest.complete());
                let first = std::iter::once((path.clone(), begun.as_slice()));
                Swap::staged(first.chain(list).chain([(path, complete.as_slice())]))
            }
        };
        done.and_then(Swap::replace)?;
        made.keep();
        Ok(())
    }
}

/// Replaces one file, whole.
///
/// # Errors
///
/// The path with the reason; the file is as it was then.
pub fn replace(path: &Path, content: &[u8]) -> Result<(), WriteError> {
    root::given_output(folder_of(path))
        .map_err(|why| WriteError { path: path.to_owned(), reason: io::Error::other(why) })?;
    sweep(folder_of(path));
    Swap::staged([(path.to_owned(), content)]).and_then(Swap::replace)
}

/// Replaces the text of an input, whole. A link stays a link, and may not lead out of its project.
///
/// # Errors
///
/// The reason in words; the file is as it was then.
pub fn rewrite(path: &Path, text: &str) -> Result<(), String> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let place = if path.is_symlink() { Root::of_layout(folder).place(path) } else { root::given(path) };
    let place = place.map_err(|why| format!("{why}; {}", why.help()))?;
    replace(&place, text.as_bytes()).map_err(|e| e.reason.to_string())
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

/// Folders that had to be made, outermost first; removed again unless they are kept.
struct Made(Vec<PathBuf>);

impl Made {
    fn folder(folder: &Path) -> Result<Made, WriteError> {
        let missing = |p: &&Path| !p.as_os_str().is_empty() && !p.exists();
        let mut made: Vec<PathBuf> = folder.ancestors().take_while(missing).map(Path::to_owned).collect();
        made.reverse();
        let made = Made(made);
        let failed = |reason| WriteError { path: folder.to_owned(), reason };
        fs::create_dir_all(folder).map_err(failed)?;
        made.0.iter().try_for_each(|new| sync_folder(folder_of(new))).map_err(failed)?;
        Ok(made)
    }

    fn keep(mut self) {
        self.0.clear();
    }
}

impl Drop for Made {
    fn drop(&mut self) {
        for folder in self.0.iter().rev() {
            // Somebody else may have put a file there meanwhile.
            let _ = fs::remove_dir(folder);
        }
    }
}

/// Files on their way, in the order in which they take their places. A target may come twice.
struct Swap {
    entries: Vec<Entry>,
}

struct Entry {
    target: PathBuf,
    /// The new content, until it is in its place.
    fresh: Option<Temporary>,
    /// What is put back on a failure, once the new content is in its place.
    former: Option<Former>,
}

/// What had a target's name.
enum Former {
    Absent,
    File(Temporary),
    Link(PathBuf),
}

impl Entry {
    fn failed(&self, reason: io::Error) -> WriteError {
        WriteError { path: self.target.clone(), reason }
    }
}

impl Swap {
    /// Brings all contents onto the disk; nothing is replaced yet.
    fn staged<'a>(list: impl IntoIterator<Item = (PathBuf, &'a [u8])>) -> Result<Swap, WriteError> {
        let mut swap = Swap { entries: Vec::new() };
        for (target, content) in list {
            let fresh = staged(&target, content).map_err(|reason| WriteError { path: target.clone(), reason })?;
            swap.entries.push(Entry { target, fresh: Some(fresh), former: None });
        }
        Ok(swap)
    }

    fn replace(mut self) -> Result<(), WriteError> {
        let done = self.place();
        if done.is_err() {
            self.restore();
        }
        done
    }

    fn place(&mut self) -> Result<(), WriteError> {
        let several = self.entries.len() > 1;
        for k in 0..self.entries.len() {
            let entry = &mut self.entries[k];
            // A single rename happens or does not.
            if several {
                entry.former = Some(former(&entry.target).map_err(|reason| entry.failed(reason))?);
            }
            if let Some(fresh) = entry.fresh.take()
                && let Err(reason) = fresh.place(&entry.target)
            {
                entry.former = None;
                return Err(entry.failed(reason));
            }
            // The manifest's beginning is on the disk before, and its end after all others.
            let last = self.entries.len() - 1;
            if (k == 0 || k + 1 >= last)
                && let Err(reason) = sync_folder(folder_of(&self.entries[k].target))
            {
                return Err(self.entries[k].failed(reason));
            }
        }
        Ok(())
    }

    /// Puts back what was replaced. There is nobody left to tell if even that fails.
    fn restore(&mut self) {
        for Entry { target, former, .. } in self.entries.iter_mut().rev() {
            let _ = match former.take() {
                None => Ok(()),
                Some(Former::Absent) => fs::remove_file(target),
                Some(Former::File(kept)) => kept.place(target).map(drop),
                Some(Former::Link(to)) => linked(&to, target),
            };
        }
    }
}

fn staged(target: &Path, content: &[u8]) -> io::Result<Temporary> {
    let like = target.symlink_metadata().ok();
    if like.as_ref().is_some_and(fs::Metadata::is_dir) {
        return Err(io::Error::new(io::ErrorKind::IsADirectory, "a folder has this name"));
    }
    let mut fresh = Temporary::new(folder_of(target), like.as_ref().filter(|m| m.is_file()))?;
    fresh.fill(content)?;
    Ok(fresh)
}

/// Keeps what has a name now; the name stays in its place.
fn former(target: &Path) -> io::Result<Former> {
    let about = match target.symlink_metadata() {
        Ok(about) => about,
        Err(why) if why.kind() == io::ErrorKind::NotFound => return Ok(Former::Absent),
        Err(why) => return Err(why),
    };
    if about.is_symlink() {
        return fs::read_link(target).map(Former::Link);
    }
    if let Ok(kept) = Temporary::second_name(target) {
        return Ok(Former::File(kept));
    }
    // No hard links here.
    let mut copy = Temporary::new(folder_of(target), Some(&about))?;
    copy.fill(&fs::read(target)?)?;
    Ok(Former::File(copy))
}

/// Puts a link back.
#[cfg(unix)]
fn linked(to: &Path, target: &Path) -> io::Result<()> {
    fs::remove_file(target)?;
    std::os::unix::fs::symlink(to, target)
}

#[cfg(not(unix))]
fn linked(_: &Path, target: &Path) -> io::Result<()> {
    fs::remove_file(target)
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
        let at = |name: &str| folder.path().join(name);
        fs::write(at("one"), "before").unwrap();
        #[cfg(unix)]
        std::os::unix::fs::symlink("elsewhere", at("link")).unwrap();
        let set = files(&[("one", "1"), ("link", "1"), ("two", "2"), ("three", "3")]);
        let swap = Swap::staged(set.iter().map(|(name, content)| (at(name), content))).unwrap();
        // The last one cannot take its place.
        fs::create_dir(at("three")).unwrap();
        assert_eq!(swap.replace().unwrap_err().path, at("three"));
        fs::remove_dir(at("three")).unwrap();
        #[cfg(unix)]
        assert_eq!(fs::read_link(at("link")).unwrap(), Path::new("elsewhere"));
        let _ = fs::remove_file(at("link"));
        assert_eq!(content(folder.path()), pairs(&[("one", "before")]));
    }

    #[cfg(unix)]
    #[test]
    fn a_link_is_replaced_and_what_it_points_to_stays() {
        let folder = tempfile::tempdir().unwrap();
        let (secret, out) = (folder.path().join("secret"), folder.path().join("out"));
        fs::write(&secret, "mine").unwrap();
        fs::create_dir(&out).unwrap();
        std::os::unix::fs::symlink(&secret, out.join("one")).unwrap();
        files(&[("one", "1"), ("two", "2")]).write(&out).unwrap();
        assert_eq!(fs::read_to_string(&secret).unwrap(), "mine");
        assert_eq!(content(&out), pairs(&[("one", "1"), ("two", "2")]));
        assert!(out.join("one").symlink_metadata().unwrap().is_file());
    }

    #[cfg(unix)]
    #[test]
    fn permissions_stay() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("one");
        let mode = || fs::metadata(&path).unwrap().permissions().mode() & 0o777;
        for expected in [0o600, 0o666, 0o755] {
            fs::write(&path, "before").unwrap();
            fs::set_permissions(&path, fs::Permissions::from_mode(expected)).unwrap();
            replace(&path, b"after").unwrap();
            assert_eq!((mode(), fs::read_to_string(&path).unwrap().as_str()), (expected, "after"));
        }
    }

    #[test]
    fn leftovers_are_swept_by_the_next_writing() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join(".lss-0123456789abcdef0123456789abcdef.tmp"), "half").unwrap();
        files(&[("one", "1")]).write(folder.path()).unwrap();
        assert_eq!(content(folder.path()), pairs(&[("one", "1")]));
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
