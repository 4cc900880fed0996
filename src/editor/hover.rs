//! What stands at a place: what a name is, its value, and what the solved layout makes of it.

use super::describe;
use super::measures::{Measures, section_at};
use super::solutions::Solutions;
use super::workspace::Workspace;
use crate::semantics::Checked;
use lsp_types::{Hover, HoverContents, MarkupContent, MarkupKind};
use std::path::Path;

/// Where the first name of `P3..P4` ends, if a place is between its dots.
fn before_dots(text: &str, offset: usize) -> usize {
    let end = text.get(..offset).map_or(offset, |before| before.trim_end_matches('.').len());
    if text.get(end..).is_some_and(|rest| rest.starts_with("..")) && offset <= end + 2 { end } else { offset }
}

/// What is to be said of a byte of a document.
pub fn hover(
    workspace: &Workspace,
    solutions: &Solutions,
    place: &Path,
    checked: &Checked,
    offset: usize,
    markdown: bool,
) -> Option<Hover> {
    let text = checked.text(checked.main);
    let lines = workspace.lines(text);
    let names = checked.names_at(before_dots(text, offset));
    let mut parts = Vec::new();
    let mut span = None;
    for name in names {
        let written = checked.sources.text(name.span);
        parts.push(describe::name(checked, &name.kind, written, name.definition));
        span = Some((name.span.start as usize, name.span.end as usize));
    }
    let measures = Measures::new(solutions, place, checked, offset);
    if let (Some(name), Some(measures)) = (names.first(), &measures) {
        match section_at(checked, name) {
            Some((from, to, whole)) => {
                if let Some(measured) = measures.section(&from, &to) {
                    // The section says more than one of its ends.
                    parts = vec![measured];
                    span = Some(whole);
                }
            }
            None => parts.extend(measures.of(name, checked.sources.text(name.span))),
        }
    }
    if parts.is_empty() {
        if let Some((start, end)) = describe::unit_at(&lines, offset) {
            parts.extend(describe::unit(&text[start..end]));
            span = Some((start, end));
        } else {
            let (start, word) = super::text::word_at(text, offset);
            parts.extend(describe::keyword(text, offset));
            span = Some((start, start + word.len()));
            if let ("layout" | "route" | "optimise", Some(measures)) = (word, &measures) {
                parts.push(measures.whole());
            }
        }
    }
    if parts.is_empty() {
        return None;
    }
    let value = parts.join("\n\n");
    let kind = if markdown { MarkupKind::Markdown } else { MarkupKind::PlainText };
    let contents = HoverContents::Markup(MarkupContent { kind, value });
    Some(Hover { contents, range: span.map(|(start, end)| lines.range(start, end)) })
}
