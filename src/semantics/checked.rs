//! A checked file with everything that it imports, for who shows it: its texts, trees and names, and where they are from.

use super::names::Occurrence;
use super::{Study, study, unreadable};
use crate::diagnostic::Diagnostic;
use crate::source::{FileId, LoadError, Loader, Overlay, SourceMap};
use crate::syntax::tree::Tree;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Where a file of a check comes from.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Home {
    /// Its place on the disk, or the name of a document that has none.
    Disk(PathBuf),
    Standard(&'static str),
}

/// A checked document with everything that it imports.
#[derive(Debug)]
pub struct Checked {
    pub sources: SourceMap,
    pub main: FileId,
    /// `None` of a text that is too large.
    pub study: Option<Study>,
    pub diagnostics: Vec<Diagnostic>,
    /// Why the file itself could not be read.
    pub unread: Option<LoadError>,
    homes: BTreeMap<FileId, Home>,
}

impl Checked {
    /// Checks the file at a place.
    pub fn new(place: &Path, overlay: &Arc<Overlay>) -> Checked {
        let mut sources = SourceMap::default();
        match Loader::open_over(&mut sources, place, overlay.clone()) {
            Ok((mut loader, main)) => {
                let study = study(&mut sources, &mut loader, main);
                let home = |file: &FileId| {
                    let standard = loader.standard_module(*file).map(Home::Standard);
                    standard.or_else(|| Some(Home::Disk(loader.place(*file)?.to_owned())))
                };
                let homes = sources.ids().filter_map(|id| Some((id, home(&id)?))).collect();
                let diagnostics = study.analysis.diagnostics.clone();
                Checked { sources, main, study: Some(study), diagnostics, unread: None, homes }
            }
            Err(error) => {
                let diagnostics = unreadable(&mut sources, &error, &place.to_string_lossy());
                let main = sources.ids().next().unwrap_or_else(|| sources.add(place.to_string_lossy(), ""));
                let homes = [(main, Home::Disk(place.to_owned()))].into();
                Checked {
                    sources,
                    main,
                    study: None,
                    diagnostics: diagnostics.into_iter().collect(),
                    unread: Some(error),
                    homes,
                }
            }
        }
    }

    pub fn home(&self, file: FileId) -> Option<&Home> {
        self.homes.get(&file)
    }

    /// The file that was read from a place.
    pub fn file_at(&self, place: &Path) -> Option<FileId> {
        self.homes.iter().find(|(_, home)| matches!(home, Home::Disk(own) if own == place)).map(|(id, _)| *id)
    }

    /// Places on the disk that were read.
    pub fn places(&self) -> impl Iterator<Item = &Path> {
        self.homes.values().filter_map(|home| if let Home::Disk(place) = home { Some(place.as_path()) } else { None })
    }

    pub fn text(&self, file: FileId) -> &str {
        &self.sources.file(file).text
    }

    /// The tree of a file.
    pub fn tree(&self, file: FileId) -> Option<&Tree> {
        let files = self.study.iter().flat_map(|study| &study.files);
        files.map(|file| &file.tree).find(|tree| tree.file == file)
    }

    /// The names that touch a byte of the main file.
    pub fn names_at(&self, offset: usize) -> &[Occurrence] {
        self.study.as_ref().map_or(&[], |study| study.names.at(self.main, offset as u32))
    }

    pub fn occurrences(&self) -> &[Occurrence] {
        self.study.as_ref().map_or(&[], |study| &study.names.occurrences)
    }
}
