//! The manifest of a set of files: SHA-256 of each. It is written twice: before the first file is replaced, with the
//! hashes that the files had and will have, and after the last. So a set that was interrupted is told from one that was
//! changed by somebody else.

use crate::base::digest::{sha256, sha256_of};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read;
use std::path::{Component, Path, PathBuf};

/// What is read of a manifest at most, bytes.
const MOST: u64 = 1 << 20;

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Manifest {
    /// Of the verb that writes the files.
    set: String,
    /// Whether all files have taken their places.
    complete: bool,
    files: BTreeMap<String, String>,
    /// Hashes of the files that were there, as long as the set is not complete.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    before: Option<BTreeMap<String, String>>,
}

/// What a folder holds of a set.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Found {
    /// All files as they were written last, or none of them, or no manifest that can be read.
    Whole,
    /// The last writing was stopped between two files.
    Interrupted {
        /// Files of that writing.
        new: Vec<String>,
        /// Files that it had not reached.
        old: Vec<String>,
    },
    /// The last writing was complete, but these files are others now, or gone.
    Changed { changed: Vec<String>, missing: Vec<String> },
}

impl Manifest {
    /// Of files that are about to be written into a folder.
    pub fn of<'a>(set: &str, folder: &Path, files: impl Iterator<Item = (&'a str, &'a [u8])>) -> Manifest {
        let files: BTreeMap<String, String> = files.map(|(name, bytes)| (name.to_owned(), sha256(bytes))).collect();
        let before = files.keys().filter_map(|name| Some((name.clone(), hash(&folder.join(name))?))).collect();
        Manifest { set: set.to_owned(), complete: false, files, before: Some(before) }
    }

    pub fn path(&self, folder: &Path) -> PathBuf {
        path(folder, &self.set)
    }

    /// What stands there while files are replaced.
    pub fn begun(&self) -> Vec<u8> {
        json(self)
    }

    /// What stands there afterwards.
    pub fn complete(&self) -> Vec<u8> {
        json(&Manifest { complete: true, before: None, ..self.clone() })
    }

    fn read(folder: &Path, set: &str) -> Option<Manifest> {
        let mut bytes = Vec::new();
        opened(&path(folder, set))?.take(MOST).read_to_end(&mut bytes).ok()?;
        let manifest: Manifest = serde_json::from_slice(&bytes).ok()?;
        let plain = |name: &String| Path::new(name).components().eq([Component::Normal(name.as_ref())]);
        let safe = |name: &String| plain(name) && !name.chars().any(char::is_control);
        (manifest.set == set && manifest.files.keys().all(safe)).then_some(manifest)
    }
}

fn path(folder: &Path, set: &str) -> PathBuf {
    folder.join(format!(".lss-manifest-{set}.json"))
}

fn json(manifest: &Manifest) -> Vec<u8> {
    // Serialising fails for maps whose keys are no strings: there are none here.
    let mut text = serde_json::to_vec_pretty(manifest).unwrap_or_default();
    text.push(b'\n');
    text
}

/// Compares a folder with its manifest of a set.
pub fn inspect(folder: &Path, set: &str) -> Found {
    let Some(manifest) = Manifest::read(folder, set) else { return Found::Whole };
    let now: BTreeMap<&String, Option<String>> = manifest.files.keys().map(|n| (n, hash(&folder.join(n)))).collect();
    let names = |keep: &dyn Fn(&String) -> bool| -> Vec<String> {
        manifest.files.keys().filter(|name| keep(name)).cloned().collect()
    };
    let is_new = |name: &String| now[name].as_ref() == manifest.files.get(name);
    let gone = |name: &String| now[name].is_none();
    if manifest.complete {
        let missing = names(&gone);
        let changed = names(&|name| !is_new(name) && !gone(name));
        let none = missing.len() == manifest.files.len();
        return if none || missing.is_empty() && changed.is_empty() {
            Found::Whole
        } else {
            Found::Changed { changed, missing }
        };
    }
    let before = manifest.before.as_ref();
    let is_old = |name: &String| now[name].as_ref() == before.and_then(|b| b.get(name));
    match (names(&|name| !is_old(name)), names(&|name| !is_new(name))) {
        (new, old) if new.is_empty() || old.is_empty() => Found::Whole,
        (_, old) => Found::Interrupted { new: names(&is_new), old },
    }
}

/// A plain file, opened; a link is not followed.
fn opened(path: &Path) -> Option<File> {
    path.symlink_metadata().ok().filter(std::fs::Metadata::is_file)?;
    File::open(path).ok()
}

/// SHA-256 of a plain file's content.
fn hash(path: &Path) -> Option<String> {
    sha256_of(&mut opened(path)?).ok()
}

#[cfg(test)]
mod tests {
    use super::super::Files;
    use super::*;
    use std::fs;

    fn set(texts: [&str; 2]) -> Files {
        ["a", "b"].into_iter().zip(texts).map(|(name, text)| (name.to_owned(), text.as_bytes().to_vec())).collect()
    }

    #[test]
    fn what_was_interrupted_is_told_from_what_was_changed() {
        let folder = tempfile::tempdir().unwrap();
        let (at, say) = (folder.path(), || inspect(folder.path(), "build"));
        let write = |name: &str, text: &str| fs::write(at.join(name), text).unwrap();
        assert_eq!(say(), Found::Whole);
        set(["1", "2"]).write_set(at, "build").unwrap();
        assert_eq!(say(), Found::Whole);
        write("b", "mine");
        fs::remove_file(at.join("a")).unwrap();
        assert_eq!(say(), Found::Changed { changed: vec!["b".into()], missing: vec!["a".into()] });
        fs::remove_file(at.join("b")).unwrap();
        assert_eq!(say(), Found::Whole, "an emptied folder");
        // As if it had been stopped at each of its steps.
        set(["1", "2"]).write_set(at, "build").unwrap();
        let later = set(["11", "22"]);
        let manifest = Manifest::of("build", at, later.iter());
        write(".lss-manifest-build.json", &String::from_utf8(manifest.begun()).unwrap());
        assert_eq!(say(), Found::Whole, "all old");
        write("a", "11");
        assert_eq!(say(), Found::Interrupted { new: vec!["a".into()], old: vec!["b".into()] });
        write("b", "22");
        assert_eq!(say(), Found::Whole, "all new");
        later.write_set(at, "build").unwrap();
        assert_eq!(fs::read(at.join(".lss-manifest-build.json")).unwrap(), manifest.complete());
        write("b", "mine");
        assert_eq!(inspect(at, "simulate"), Found::Whole, "each set has its own");
        write(".lss-manifest-build.json", r#"{"set":"build","complete":true,"files":{"../b":""}}"#);
        assert_eq!(say(), Found::Whole, "no names of other folders");
    }
}
