//! What there is to say of a text, for a page.

use crate::diagnostic::{Diagnostic, Label};
use crate::source::{SourceMap, Span, one_line, visible};
use maud::{Markup, html};

/// Messages that a page shows; a count stands for the rest.
const MOST: usize = 30;
/// Longest part of a line that is shown, characters.
const LONGEST: usize = 160;

/// Diagnostics, the errors first.
pub fn all(sources: &SourceMap, diagnostics: &[Diagnostic]) -> String {
    let (errors, warnings): (Vec<&Diagnostic>, Vec<&Diagnostic>) = diagnostics.iter().partition(|d| d.is_error());
    let sorted: Vec<&Diagnostic> = errors.into_iter().chain(warnings).collect();
    let left = sorted.len().saturating_sub(MOST);
    let body = html! {
        @for diagnostic in sorted.iter().take(MOST) { (one(sources, diagnostic)) }
        @if left > 0 { p.note { "and " (left) " more, which " code { "lss check" } " shows" } }
    };
    body.into_string()
}

/// A message without a place.
pub fn sentence(words: &str) -> String {
    html! { article.error { p { (visible(words)) } } }.into_string()
}

fn one(sources: &SourceMap, diagnostic: &Diagnostic) -> Markup {
    let severity = diagnostic.severity().as_str();
    html! {
        article class=(severity) {
            p {
                b { (severity) " " code title=(diagnostic.code.name()) { (diagnostic.code.as_str()) } } " "
                (one_line(&diagnostic.message))
            }
            (place(sources, &diagnostic.label))
            @for label in diagnostic.others().take(8) { (place(sources, label)) }
            @if let (Some(expected), Some(found)) = (&diagnostic.expected, &diagnostic.found) {
                p.note { "expected " (visible(expected)) ", found " (visible(found)) }
            }
            @if let Some(help) = &diagnostic.help { p.help { b { "help" } " " (visible(help)) } }
        }
    }
}

/// A line of the source with what is meant marked in it.
fn place(sources: &SourceMap, label: &Label) -> Markup {
    let Span { file, start, end } = label.span;
    let source = sources.file(file);
    let (line, column) = source.line_column(start);
    let Some((begin, text)) = source.line(line - 1) else { return html! {} };
    let from = (start.saturating_sub(begin) as usize).min(text.len());
    let to = (end.saturating_sub(begin) as usize).clamp(from, text.len());
    let (before, marked, after) = (&text[..from], &text[from..to], &text[to..]);
    let short = |text: &str| visible(&text.chars().take(LONGEST).collect::<String>()).into_owned();
    let last = before.char_indices().rev().nth(LONGEST).map_or(0, |(at, _)| at);
    html! {
        div.place {
            button.line data-file=(source.name) data-line=(line) { (one_line(&source.name)) ":" (line) ":" (column) }
            @if !label.text.is_empty() { " " span.label { (visible(&label.text)) } }
            pre { (visible(&before[last..])) mark { (short(marked)) } (short(after)) }
        }
    }
}
