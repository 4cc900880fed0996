//! A found loop as the text of a layout: the file that asked for it, with vertices in the place of the route.

use crate::base::number::trimmed;
use crate::geometry::Corner;
use crate::model::{ConstraintKind, Layout, TrackSection};
use crate::source::{FileId, SourceMap, Span};
use crate::syntax;

/// Decimals of coordinates, m: sections hold their heading to 1e-8 rad.
const DECIMALS: usize = 10;

/// The text of the file that asked for a route, with the vertices of a found layout. `asked` is the layout with the
/// route. Where route or sections stand in another layout, which this one extends, they are replaced in this one.
pub fn text(sources: &SourceMap, asked: &Layout, found: &Layout, corners: &[Corner]) -> Option<String> {
    let route = asked.route.as_ref()?;
    let file = asked.span.file;
    let source = &sources.file(file).text;
    let vertices = corners.iter().zip(&found.vertices).map(|(corner, vertex)| {
        let [x, y, radius] = [corner.point.x, corner.point.y, corner.radius].map(|v| trimmed(v, DECIMALS));
        format!("vertex {} ({x} m, {y} m) radius {radius} m", vertex.name)
    });
    let vertices: Vec<String> = vertices.collect();
    let holds = found.constraints.iter().filter_map(|c| match &c.kind {
        ConstraintKind::Holds { section, part } => Some((part, held(sources, part, &found.section_name(*section)))),
        _ => None,
    });
    let body = body_of(source, file, asked)?;
    let within = |span: Span| span.file == file && span.start >= body.start && span.end <= body.end;
    let mut edits: Vec<(Span, String)> = Vec::new();
    let mut added: Vec<String> = Vec::new();
    match within(route.span) {
        true => edits.push((route.span, vertices.join("\n"))),
        false => added.extend(vertices),
    }
    for (part, line) in holds {
        match within(part.span) {
            true => edits.push((part.span, line)),
            false => added.push(line),
        }
    }
    if !added.is_empty() {
        let end = Span { start: body.end - 1, end: body.end - 1, file };
        edits.push((end, format!("\n{}\n", added.join("\n"))));
    }
    edits.sort_by_key(|(span, _)| std::cmp::Reverse(span.start));
    let mut text = source.to_string();
    for (span, new) in edits {
        text.replace_range(span.start as usize..span.end as usize, &new);
    }
    let (tree, said) = syntax::parse(file, &text);
    said.iter().all(|d| !d.is_error()).then(|| syntax::format(&tree, &text))
}

/// The braces of the layout's declaration.
fn body_of(source: &str, file: FileId, asked: &Layout) -> Option<Span> {
    let (tree, _) = syntax::parse(file, source);
    let body = tree.items.iter().find_map(|item| match item {
        syntax::tree::Item::Layout(layout) if layout.name.text == asked.name => Some(layout.body.span),
        _ => None,
    })?;
    (body.end > body.start).then_some(body)
}

/// `section chutes 40 m within (0 m, 30 m)..(80 m, 30 m) on P3..P4`, its ends in driving order and as they are written.
fn held(sources: &SourceMap, part: &TrackSection, on: &str) -> String {
    let length = part.length.map(|length| format!("{} m within ", trimmed(length, 9))).unwrap_or_default();
    let (from, to) = (sources.text(part.from_span), sources.text(part.to_span));
    format!("section {} {length}{from}..{to} on {on}", part.name)
}
