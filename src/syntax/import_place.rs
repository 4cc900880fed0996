//! Where a line that imports something is added to a file.

use super::tree::{Item, Tree};
use crate::source::Span;

/// Where a file takes another import.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImportPlace {
    /// Empty.
    pub span: Span,
    /// Whether it is behind an import, and not before everything.
    behind: bool,
}

impl ImportPlace {
    /// What is written there to import `path`, such as `std.carts.tilt_tray`.
    pub fn text(&self, path: &str) -> String {
        if self.behind { format!("\nuse {path}") } else { format!("use {path}\n\n") }
    }
}

impl Tree {
    /// Behind the last import, or before everything else where there is none.
    pub fn import_place(&self) -> ImportPlace {
        let last = self.items.nodes.iter().rev().find(|node| matches!(node.value, Item::Use(_)));
        // Not between a comment at the head of the file and what it may be about.
        let first = self.items.nodes.first().filter(|node| node.above.is_empty()).map_or(0, |node| node.span.start);
        let end = last.map_or(first, |node| node.span.end);
        ImportPlace { span: Span { file: self.file, start: end, end }, behind: last.is_some() }
    }
}
