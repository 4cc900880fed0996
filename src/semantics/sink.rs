//! Collects diagnostics: each place says each thing once, however often it is evaluated.

use std::collections::BTreeSet;

use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;

#[derive(Debug, Default)]
pub(super) struct Sink {
    diagnostics: Vec<Diagnostic>,
    said: BTreeSet<(Code, Span)>,
    errors: usize,
}

impl Sink {
    pub fn push(&mut self, diagnostic: Diagnostic) {
        self.errors += usize::from(diagnostic.is_error());
        if self.said.insert((diagnostic.code, diagnostic.label.span)) {
            self.diagnostics.push(diagnostic);
        }
    }

    /// Number of errors so far, each time that one is met.
    pub fn errors(&self) -> usize {
        self.errors
    }

    /// All of them, by place.
    pub fn into_sorted(mut self) -> Vec<Diagnostic> {
        self.diagnostics.sort_by_key(|d| (d.label.span.file, d.label.span.start, d.code, d.label.span.end));
        self.diagnostics
    }
}
