//! What a task works on, by content: SHA-256 of each file that is read for it, and one of all of them.
//!
//! Names of files do not count, as a name changes nothing that a task finds; names of runs do, as results have them.

use crate::base::digest::{sha256, sha256_of};
use crate::semantics::given::lets;
use crate::signal::{Campaign, sidecar_path};
use crate::source::{InputError, LoadError, Loader, Root, SourceMap, root, shown};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

/// All that is read of an input.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Content {
    /// SHA-256 over all of it.
    pub digest: String,
    /// Each file, by its canonical place, with its SHA-256.
    pub files: Vec<(PathBuf, String)>,
}

impl Content {
    /// Of files in their order, and of what else counts.
    fn new(files: Vec<(PathBuf, String)>, more: &str) -> Content {
        let all: String = files.iter().map(|(_, hash)| hash.as_str()).chain([more]).collect::<Vec<_>>().join("\n");
        Content { digest: sha256(all.as_bytes()), files }
    }
}

/// Reads inputs, each once.
pub struct Contents {
    root: Root,
    tracks: BTreeMap<PathBuf, (Content, Vec<String>)>,
    runs: BTreeMap<PathBuf, Content>,
}

impl Contents {
    /// What lies within a root.
    pub fn new(root: Root) -> Contents {
        Contents { root, tracks: BTreeMap::new(), runs: BTreeMap::new() }
    }

    /// A layout with what it imports, or a simulation input; and the names of its `let`s.
    ///
    /// # Errors
    ///
    /// In words, where it cannot be read or lies outside the root.
    pub fn track(&mut self, path: &Path) -> Result<(Content, Vec<String>), String> {
        let place = self.place(path)?;
        if let Some(known) = self.tracks.get(&place) {
            return Ok(known.clone());
        }
        let found = if place.extension().is_some_and(|ending| ending == "json") {
            (Content::new(vec![(place.clone(), hash(&place)?)], ""), Vec::new())
        } else {
            layout(&place)?
        };
        self.tracks.insert(place, found.clone());
        Ok(found)
    }

    /// A campaign: its list, its runs, and the layouts that they name.
    ///
    /// # Errors
    ///
    /// As [`Contents::track`]; also of a run that cannot be read, and of a campaign of another machine.
    pub fn runs(&mut self, path: &Path) -> Result<Content, String> {
        let place = self.place(path)?;
        if let Some(known) = self.runs.get(&place) {
            return Ok(known.clone());
        }
        let (campaign, refused) = Campaign::read_each(&place).map_err(|why| why.to_string())?;
        if let Some(first) = refused.first() {
            return Err(first.error.to_string());
        }
        if !campaign.channels.is_empty() {
            return Err("it is of another machine, whose model is a program: a study starts none".to_owned());
        }
        let list = if place.is_dir() { place.join("campaign.toml") } else { place.clone() };
        let mut files = Vec::new();
        if list.is_file() {
            files.push((list.clone(), hash(&list)?));
        }
        let mut names = Vec::new();
        for entry in &campaign.runs {
            names.push(entry.name.as_str());
            let file = campaign.root.place(&entry.file).map_err(|why| why.to_string())?;
            files.push((file.clone(), hash(&file)?));
            let beside = sidecar_path(&entry.file);
            if let Ok(beside) = campaign.root.place(&beside) {
                files.push((beside.clone(), hash(&beside)?));
            }
            // One that is not there may be said by an option.
            if let Ok(named) = entry.layout() {
                let named = campaign.root.place(named).map_err(|why| why.to_string())?;
                let known = self.tracks.get(&named).map(|(content, _)| content.clone());
                let content = match known {
                    Some(content) => content,
                    None if named.extension().is_some_and(|ending| ending == "json") => {
                        Content::new(vec![(named.clone(), hash(&named)?)], "")
                    }
                    None => layout(&named)?.0,
                };
                files.extend(content.files);
            }
        }
        let content = Content::new(files, &names.join("\n"));
        self.runs.insert(place, content.clone());
        Ok(content)
    }

    fn place(&self, path: &Path) -> Result<PathBuf, String> {
        self.root.place(path).map_err(|why| why.to_string())
    }
}

/// SHA-256 of a file.
///
/// # Errors
///
/// In words, with its name.
pub fn hash(place: &Path) -> Result<String, String> {
    let told = |why: io::Error| format!("{}: {why}", shown(place));
    let mut file = root::open_given(place).map_err(|why| format!("{}: {why}", shown(place)))?;
    sha256_of(&mut file).map_err(told)
}

/// A layout and the files that it imports, in the order in which they are read, which follows from their texts.
fn layout(place: &Path) -> Result<(Content, Vec<String>), String> {
    let mut sources = SourceMap::default();
    let (mut loader, main) = Loader::open(&mut sources, place).map_err(|why| told(&why, place))?;
    let mut names: Vec<String> = lets(&mut sources, &mut loader, main).into_iter().map(|(name, _)| name).collect();
    names.sort();
    names.dedup();
    let files = sources.ids().filter_map(|id| {
        let at = loader.place(id)?;
        Some((at.to_owned(), sha256(sources.file(id).text.as_bytes())))
    });
    Ok((Content::new(files.collect(), ""), names))
}

fn told(why: &LoadError, place: &Path) -> String {
    let why = match why {
        LoadError::Unreadable(why) => why.clone(),
        LoadError::OutsideRoot(root) => InputError::OutsideRoot(root.clone()).to_string(),
        LoadError::TooLarge(bytes) => format!("{bytes} bytes are more than are read of a layout"),
        LoadError::NotUtf8 { byte, .. } => format!("byte {byte} is not UTF-8"),
    };
    format!("{}: {why}", shown(place))
}
