//! Diagnostics and plain messages on the terminal.

use super::MessageFormat;
use crate::diagnostic::text::Style;
use crate::diagnostic::{Diagnostic, json, text};
use crate::source::{SourceMap, shown, visible};
use std::io::{IsTerminal, Write};
use std::path::Path;

/// Writes diagnostics to a stream. Text is coloured on a terminal, unless NO_COLOR is set.
pub fn diagnostics(out: &mut dyn Write, sources: &SourceMap, diagnostics: &[Diagnostic], format: MessageFormat) {
    let style = if colour(&std::io::stderr()) { Style::Colour } else { Style::Plain };
    let mut said = String::new();
    for diagnostic in diagnostics {
        match format {
            MessageFormat::Text => said.push_str(&text::render(sources, diagnostic, style)),
            MessageFormat::Json => {
                said.push_str(&visible(&json::line(sources, diagnostic)));
                said.push('\n');
            }
        }
    }
    if let (MessageFormat::Text, Some(summary)) = (format, text::summary(diagnostics)) {
        said.push_str(&summary);
        said.push('\n');
    }
    // A reader that went away (`lss check | head`) is no error of ours.
    let _ = out.write_all(said.as_bytes());
}

/// Where files went, as a line under a report; nothing where none were written.
pub fn written_to(folder: Option<&Path>) -> String {
    folder.map_or_else(String::new, |folder| format!("  written to {}\n", shown(folder)))
}

/// A one-line error without a place in a source.
pub fn error(message: &str) {
    eprintln!("error: {}", visible(message));
}

/// A one-line warning without a place in a source.
pub fn warning(message: &str) {
    eprintln!("warning: {}", visible(message));
}

/// A line that is neither.
pub fn note(message: &str) {
    eprintln!("{}", visible(message));
}

/// Whether a stream is a terminal that wants colour (<https://no-color.org>).
pub fn colour(stream: &impl IsTerminal) -> bool {
    stream.is_terminal() && std::env::var_os("NO_COLOR").is_none_or(|v| v.is_empty())
}

/// Writes a text or JSON to standard output. What would steer a terminal is escaped, as names and texts in it come from
/// files.
pub fn print(text: &str) {
    let _ = std::io::stdout().write_all(visible(text).as_bytes());
}

/// Writes a source's own text to standard output: byte for byte, unless somebody looks.
pub fn print_source(text: &str) {
    match std::io::stdout().is_terminal() {
        true => print(text),
        false => drop(std::io::stdout().write_all(text.as_bytes())),
    }
}
