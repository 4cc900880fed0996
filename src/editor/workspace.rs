//! What a client has open, and what is known about it. Every open document is checked as `lss check` checks a file, with
//! the open texts in the place of those on the disk.

use super::text::{self, Encoding, Lines};
use super::{place, reference};
use crate::semantics::{Checked, Home};
use crate::source::{FileId, Overlay, Span};
use lsp_types::{Location, Position, TextDocumentContentChangeEvent, Uri};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

#[derive(Debug)]
struct Open {
    uri: Uri,
    version: i32,
    checked: Option<Arc<Checked>>,
}

/// The documents of a client.
#[derive(Debug)]
pub struct Workspace {
    pub encoding: Encoding,
    open: BTreeMap<PathBuf, Open>,
    texts: Arc<Overlay>,
}

impl Workspace {
    pub fn new(encoding: Encoding) -> Self {
        Workspace { encoding, open: BTreeMap::new(), texts: Arc::default() }
    }

    pub fn open(&mut self, uri: Uri, version: i32, text: String) {
        let place = place::of_uri(&uri);
        Arc::make_mut(&mut self.texts).insert(place.clone(), text);
        self.open.insert(place, Open { uri, version, checked: None });
        // An import that was not there may be now.
        self.forget_all();
    }

    /// Does edits; of a document that is not open nothing is known.
    pub fn edit(&mut self, uri: &Uri, version: i32, changes: Vec<TextDocumentContentChangeEvent>) {
        let place = place::of_uri(uri);
        let Some(open) = self.open.get_mut(&place) else { return };
        open.version = version;
        if let Some(text) = Arc::make_mut(&mut self.texts).get_mut(&place) {
            text::edit(text, changes, self.encoding);
        }
        for (own, open) in &mut self.open {
            if *own == place || open.checked.as_ref().is_some_and(|checked| checked.places().any(|p| p == place)) {
                open.checked = None;
            }
        }
    }

    pub fn close(&mut self, uri: &Uri) {
        let place = place::of_uri(uri);
        Arc::make_mut(&mut self.texts).remove(&place);
        self.open.remove(&place);
        self.forget_all();
    }

    /// Everything is checked again: files changed on the disk.
    pub fn forget_all(&mut self) {
        self.open.values_mut().for_each(|open| open.checked = None);
    }

    /// The open texts, by their places.
    pub fn texts(&self) -> &Arc<Overlay> {
        &self.texts
    }

    pub fn text(&self, place: &Path) -> Option<&str> {
        self.texts.get(place).map(String::as_str)
    }

    pub fn is_open(&self, place: &Path) -> bool {
        self.open.contains_key(place)
    }

    pub fn places(&self) -> Vec<PathBuf> {
        self.open.keys().cloned().collect()
    }

    pub fn version(&self, place: &Path) -> Option<i32> {
        self.open.get(place).map(|open| open.version)
    }

    /// An open document as it is now, checked.
    pub fn checked(&mut self, place: &Path) -> Option<Arc<Checked>> {
        let texts = &self.texts;
        let open = self.open.get_mut(place)?;
        Some(open.checked.get_or_insert_with(|| Arc::new(Checked::new(place, texts))).clone())
    }

    pub fn lines<'a>(&self, text: &'a str) -> Lines<'a> {
        Lines::new(text, self.encoding)
    }

    /// A file of a check with its lines.
    pub fn lines_of<'a>(&self, checked: &'a Checked, file: FileId) -> Lines<'a> {
        Lines::of_file(checked.sources.file(file), self.encoding)
    }

    /// How the client calls a file of a check; one of the standard library is made where it can be shown.
    pub fn uri(&self, home: &Home) -> Option<Uri> {
        match home {
            Home::Disk(place) => self.open.get(place).map(|o| o.uri.clone()).or_else(|| place::to_uri(place)),
            Home::Standard(module) => reference::module(module),
        }
    }

    /// A span of a check as the client knows it.
    pub fn location(&self, checked: &Checked, span: Span) -> Option<Location> {
        let uri = self.uri(checked.home(span.file)?)?;
        Some(Location::new(uri, self.lines_of(checked, span.file).of_span(span)))
    }

    /// The document that a request is about, checked, and the byte that it asks for.
    pub fn at(&mut self, uri: &Uri, position: Position) -> Option<(Arc<Checked>, usize)> {
        let checked = self.checked(&place::of_uri(uri))?;
        let offset = self.lines_of(&checked, checked.main).offset(position);
        Some((checked, offset))
    }
}
