//! Where things are declared and used.

use super::uses::{self, Symbol};
use super::workspace::Workspace;
use crate::semantics::Checked;
use crate::source::Span;
use crate::syntax::tree::{Item, Use};
use lsp_types::{DocumentHighlight, DocumentHighlightKind, Location, Range};
use std::path::Path;

/// Where what stands at a byte is declared. Several places where one name brings several things.
pub fn definition(workspace: &Workspace, checked: &Checked, offset: usize) -> Vec<Location> {
    let names = checked.names_at(offset).iter();
    let found: Vec<Location> = names.filter_map(|name| workspace.location(checked, name.definition?)).collect();
    if found.is_empty() { imported(workspace, checked, offset).into_iter().collect() } else { found }
}

/// The file of an import with quotes.
fn imported(workspace: &Workspace, checked: &Checked, offset: usize) -> Option<Location> {
    let study = checked.study.as_ref()?;
    let tree = checked.tree(checked.main)?;
    let at = |span: Span| span.start as usize <= offset && offset <= span.end as usize;
    let path = tree.items.iter().find_map(|item| match item {
        Item::Use(Use::File { path, span }) if at(*span) => Some(path),
        _ => None,
    })?;
    let folder = checked.home(checked.main).and_then(|home| match home {
        crate::semantics::Home::Disk(place) => place.parent(),
        crate::semantics::Home::Standard(_) => None,
    })?;
    let wanted = super::place::canonical(&folder.join(path));
    let file = checked.file_at(&wanted)?;
    study
        .files
        .iter()
        .any(|own| own.tree.file == file)
        .then(|| Span::new(file, 0, 0))
        .and_then(|span| workspace.location(checked, span))
}

/// All uses of what stands at a byte.
pub fn references(
    workspace: &mut Workspace,
    place: &Path,
    checked: &Checked,
    offset: usize,
    with_declaration: bool,
) -> Vec<Location> {
    let Some(symbol) = checked.names_at(offset).iter().find_map(|name| Symbol::of(checked, name)) else {
        return Vec::new();
    };
    let checks = uses::checks(workspace, &symbol, place);
    let mut found = Vec::new();
    for (home, (text, spans)) in uses::places(&checks, &symbol) {
        let Some(uri) = workspace.uri(&home) else { continue };
        let lines = workspace.lines(&text);
        let own = |start: usize| home == symbol.home && start == symbol.start as usize;
        let spans = spans.into_iter().filter(|(start, _)| with_declaration || !own(*start));
        found.extend(spans.map(|(start, end)| Location::new(uri.clone(), lines.range(start, end))));
    }
    found
}

/// The uses in the same file.
pub fn highlights(workspace: &Workspace, checked: &Checked, offset: usize) -> Vec<DocumentHighlight> {
    let Some(name) = checked.names_at(offset).first() else { return Vec::new() };
    let lines = workspace.lines_of(checked, checked.main);
    let written = checked.sources.text(name.span);
    let same = |other: &&crate::semantics::names::Occurrence| match name.symbol {
        Some(_) => other.symbol == name.symbol,
        None => other.kind == name.kind && checked.sources.text(other.span) == written,
    };
    let own = checked.occurrences().iter().filter(|o| o.span.file == checked.main).filter(same);
    let mut found: Vec<(Range, bool)> = own.map(|o| (lines.of_span(o.span), o.declares())).collect();
    found.dedup();
    let kind = |declares| if declares { DocumentHighlightKind::WRITE } else { DocumentHighlightKind::READ };
    found.into_iter().map(|(range, declares)| DocumentHighlight { range, kind: Some(kind(declares)) }).collect()
}
