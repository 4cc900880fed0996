//! Files and spans: the only door to the disk for inputs, and the way outputs are written whole.
//!
//! A [`SourceMap`] owns every text that a compilation has read. A [`Span`] names a byte range in one of them
//! and is what every later stage carries so that a message can point at the line it came from.

pub mod disk;
pub mod input;
mod listing;
mod loader;
pub mod revision;
pub mod root;
mod stamp;
mod visible;

pub use input::InputError;
pub use listing::{layouts, layouts_in};
pub use loader::{DRAWING_LIMIT, LoadError, Loader, Overlay, SIZE_LIMIT, STDLIB, drawing};
pub use root::Root;
pub use stamp::Stamp;
pub use visible::{one_line, shown, steers, visible};

use serde::Serialize;

/// Index of a file in its [`SourceMap`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub struct FileId(pub u32);

/// A byte range `start..end` in one file. Always on character boundaries.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
pub struct Span {
    pub file: FileId,
    pub start: u32,
    pub end: u32,
}

impl Span {
    pub fn new(file: FileId, start: usize, end: usize) -> Self {
        Span { file, start: start as u32, end: end as u32 }
    }

    /// The smallest span that covers both; both must lie in one file.
    pub fn to(self, other: Span) -> Span {
        Span { file: self.file, start: self.start.min(other.start), end: self.end.max(other.end) }
    }
}

/// A value together with the place it was written.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spanned<T> {
    pub value: T,
    pub span: Span,
}

impl<T> Spanned<T> {
    pub fn new(value: T, span: Span) -> Self {
        Spanned { value, span }
    }
}

/// One text with the name that messages show for it.
#[derive(Clone, Debug)]
pub struct SourceFile {
    /// As shown to the user: the path as it was given, or `std/tracks.lss` for the embedded library.
    pub name: String,
    pub text: String,
    /// Byte offset at which each line starts.
    line_starts: Vec<u32>,
}

impl SourceFile {
    fn new(name: String, text: String) -> Self {
        let line_starts = std::iter::once(0).chain(text.match_indices('\n').map(|(i, _)| i as u32 + 1)).collect();
        SourceFile { name, text, line_starts }
    }

    /// Byte offset at which each line starts.
    pub fn line_starts(&self) -> &[u32] {
        &self.line_starts
    }

    /// Number of lines, at least one.
    pub fn line_count(&self) -> usize {
        self.line_starts.len()
    }

    /// Byte offset where a line (zero-based) begins, and its text without the line break.
    pub fn line(&self, index: usize) -> Option<(u32, &str)> {
        let start = *self.line_starts.get(index)?;
        let end = self.line_starts.get(index + 1).map_or(self.text.len(), |next| *next as usize);
        Some((start, self.text[start as usize..end].trim_end_matches(['\n', '\r'])))
    }

    /// One-based line and column (in characters) of a byte offset.
    pub fn line_column(&self, offset: u32) -> (usize, usize) {
        let line = self.line_starts.partition_point(|&start| start <= offset) - 1;
        let start = self.line_starts[line] as usize;
        let end = (offset as usize).min(self.text.len());
        (line + 1, self.text[start..end].chars().count() + 1)
    }
}

/// Every text that a compilation has read.
#[derive(Clone, Debug, Default)]
pub struct SourceMap {
    files: Vec<SourceFile>,
}

impl SourceMap {
    pub fn add(&mut self, name: impl Into<String>, text: impl Into<String>) -> FileId {
        self.files.push(SourceFile::new(name.into(), text.into()));
        FileId(self.files.len() as u32 - 1)
    }

    /// Every file, in the order in which they were read.
    pub fn ids(&self) -> impl Iterator<Item = FileId> + use<> {
        (0..self.files.len() as u32).map(FileId)
    }

    pub fn file(&self, id: FileId) -> &SourceFile {
        &self.files[id.0 as usize]
    }

    pub fn text(&self, span: Span) -> &str {
        &self.file(span.file).text[span.start as usize..span.end as usize]
    }

    /// `file:line`, as the problem printer and reports cite a row.
    pub fn place(&self, span: Span) -> String {
        let file = self.file(span.file);
        format!("{}:{}", file.name, file.line_column(span.start).0)
    }
}
