//! What is shown between the lines: values of `let`s, and what sections measure once the layout is solved.

use super::measures::{Measured, Measures, section_at};
use super::solutions::Solutions;
use super::workspace::Workspace;
use crate::base::number::trimmed;
use crate::semantics::Checked;
use crate::semantics::names::NameKind;
use crate::syntax::tree::{Expr, ExprKind, Item, Let, Statement};
use lsp_types::{InlayHint, InlayHintKind, InlayHintLabel, InlayHintTooltip, Range};
use std::path::Path;

/// The hints of a range of a document.
pub fn hints(
    workspace: &Workspace,
    solutions: &Solutions,
    place: &Path,
    checked: &Checked,
    range: Range,
) -> Vec<InlayHint> {
    let Some(study) = &checked.study else { return Vec::new() };
    let lines = workspace.lines_of(checked, checked.main);
    let (from, to) = (lines.offset(range.start), lines.offset(range.end));
    let mut found: Vec<(usize, String, &str)> = Vec::new();
    for item in lets(checked) {
        if let Some(value) = study.values.get(&item.name.span).filter(|_| !is_plain(&item.value)) {
            found.push((item.value.span.end as usize, format!("= {value}"), "the value"));
        }
    }
    for layout in study.names.layouts.iter().filter(|layout| layout.span.file == checked.main) {
        let Some(measures) = Measures::new(solutions, place, checked, layout.span.start as usize) else { continue };
        let own = study.names.in_file(checked.main).iter();
        let own = own.filter(|name| layout.span.start <= name.span.start && name.span.end <= layout.span.end);
        for name in own.filter(|name| name.kind == NameKind::Vertex) {
            // At a declaration, the section that begins there; elsewhere behind a section that is named.
            let (at, section) = if name.declares() {
                let text = checked.sources.text(name.span);
                let Some(next) = next_vertex(&measures, text) else { continue };
                let line = lines.position(name.span.end as usize).line as usize;
                let Some((start, line)) = lines.line(line) else { continue };
                let code = line.split("//").next().unwrap_or(line).trim_end();
                (start + code.len(), (text.to_owned(), next))
            } else {
                match section_at(checked, name) {
                    Some((a, b, (_, end))) if end == name.span.end as usize => (end, (a, b)),
                    _ => continue,
                }
            };
            if let Some((measured, current)) = measures.solved_section(&section.0, &section.1) {
                let tip = if current { SOLVED } else { STALE };
                let towards = if name.declares() { format!("→ {}: ", section.1) } else { String::new() };
                found.push((at, format!("{towards}{}", short(measured, current)), tip));
            }
        }
    }
    found.retain(|(at, ..)| (from..=to).contains(at));
    found.sort_by_key(|(at, ..)| *at);
    let hint = |(at, text, tip): (usize, String, &str)| InlayHint {
        position: lines.position(at),
        label: InlayHintLabel::String(text),
        kind: Some(InlayHintKind::TYPE),
        text_edits: None,
        tooltip: Some(InlayHintTooltip::String(tip.to_owned())),
        padding_left: Some(true),
        padding_right: None,
        data: None,
    };
    found.into_iter().map(hint).collect()
}

const SOLVED: &str = "between the vertices, and heading, as solved";
const STALE: &str = "as solved before the last change; not solved yet since";

fn short(measured: Measured, current: bool) -> String {
    let about = if current { "" } else { "≈ " };
    format!("{about}{} m, {}°", trimmed(measured.length, 3), trimmed(measured.heading, 2))
}

fn next_vertex(measures: &Measures, name: &str) -> Option<String> {
    let (solved, _) = measures.solved()?;
    let vertices = &solved.compiled.layout.vertices;
    let at = vertices.iter().position(|v| v.name == name)?;
    vertices.get((at + 1) % vertices.len()).map(|v| v.name.clone())
}

fn lets(checked: &Checked) -> Vec<&Let> {
    let nodes = checked.tree(checked.main).map_or(&[][..], |tree| &tree.items.nodes);
    let mut all = Vec::new();
    for node in nodes {
        match &node.value {
            Item::Let(item) => all.push(item),
            Item::Layout(layout) => {
                let inner = layout.body.iter();
                all.extend(inner.filter_map(|s| if let Statement::Let(item) = s { Some(item) } else { None }));
            }
            _ => {}
        }
    }
    all
}

/// Whether the text says the value as it is.
fn is_plain(expr: &Expr) -> bool {
    match &expr.kind {
        ExprKind::Number { .. } | ExprKind::Text(_) => true,
        ExprKind::Negative(inner) | ExprKind::Paren(inner) => is_plain(inner),
        ExprKind::Tuple(items) => items.iter().all(is_plain),
        ExprKind::List(items) => items.iter().all(is_plain),
        ExprKind::Range { low, high, step } => {
            is_plain(low) && is_plain(high) && step.as_ref().is_none_or(|step| is_plain(step))
        }
        _ => false,
    }
}
