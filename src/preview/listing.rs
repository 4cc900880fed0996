//! The text of the file, line by line.

use crate::semantics::Checked;
use crate::source::visible;
use maud::html;
use serde_json::{Value, json};

/// Lines that a page shows.
const MOST: usize = 5_000;

/// The part of the board that shows the text.
pub fn part(checked: &Checked) -> (&'static str, Value) {
    let file = checked.sources.file(checked.main);
    let lines: Vec<&str> = (0..file.line_count().min(MOST)).filter_map(|k| Some(file.line(k)?.1)).collect();
    // The last line break ends a line and begins none.
    let shown = if lines.last().is_some_and(|line| line.is_empty()) { &lines[..lines.len() - 1] } else { &lines[..] };
    let body = html! {
        @for (k, line) in shown.iter().enumerate() {
            @let comment = line.find("//").filter(|at| line[..*at].matches('"').count() % 2 == 0).unwrap_or(line.len());
            li data-line=(k + 1) {
                (visible(&line[..comment])) @if comment < line.len() { i { (visible(&line[comment..])) } }
            }
        }
        @if file.line_count() > MOST { li { i { "… " (file.line_count() - MOST) " more lines, which are not shown" } } }
    };
    ("source", json!({ "file": file.name, "html": body.into_string() }))
}
