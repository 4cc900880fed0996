//! Diagnostics for people: the excerpt with its labels, what was expected and found, and a way out.

use std::fmt::{self, Display, Write};

use miette::{GraphicalReportHandler, GraphicalTheme, LabeledSpan};

use super::excerpt::Excerpt;
use super::{Diagnostic, Label, Severity};
use crate::source::{FileId, SourceMap, one_line, visible};

/// Width of a report, columns.
const WIDTH: usize = 100;
/// Related places shown with an excerpt; a count stands for the rest.
const MOST_RELATED: usize = 8;

/// Colours for a terminal, or none for files, pipes and snapshots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    Plain,
    Colour,
}

/// One diagnostic with its excerpts; ends with a line break.
pub fn render(sources: &SourceMap, diagnostic: &Diagnostic, style: Style) -> String {
    let theme = match style {
        Style::Plain => GraphicalTheme::unicode_nocolor(),
        Style::Colour => GraphicalTheme::unicode(),
    };
    let handler = GraphicalReportHandler::new_themed(theme).with_width(WIDTH).without_syntax_highlighting();
    let mut out = String::new();
    for report in Report::of(sources, diagnostic) {
        // Writing to a string cannot fail; miette fails only on a span outside the excerpt.
        if handler.render_report(&mut out, &report).is_err() {
            let _ = writeln!(out, "{report}");
        }
    }
    out
}

/// `3 errors, 1 warning`; `None` when there is nothing to count.
pub fn summary(diagnostics: &[Diagnostic]) -> Option<String> {
    let errors = diagnostics.iter().filter(|d| d.is_error()).count();
    let counted = |n: usize, word: &str| (n > 0).then(|| format!("{n} {word}{}", if n == 1 { "" } else { "s" }));
    let parts: Vec<String> =
        [counted(errors, "error"), counted(diagnostics.len() - errors, "warning")].into_iter().flatten().collect();
    (!parts.is_empty()).then(|| parts.join(", "))
}

/// What miette renders: the diagnostic, or its places in one other file.
#[derive(Debug)]
struct Report {
    code: Option<String>,
    severity: miette::Severity,
    message: String,
    excerpt: Excerpt,
    labels: Vec<LabeledSpan>,
    help: Option<String>,
}

impl Report {
    /// The report itself, then one for each other file that takes part.
    fn of(sources: &SourceMap, diagnostic: &Diagnostic) -> Vec<Report> {
        let home = diagnostic.label.span.file;
        let shown: Vec<&Label> = diagnostic.others().take(MOST_RELATED).collect();
        let mut labels = vec![&diagnostic.label];
        labels.extend(shown.iter().filter(|l| l.span.file == home));
        let mut reports = vec![Report {
            code: Some(format!("{} {}", diagnostic.code.as_str(), diagnostic.code.name())),
            severity: match diagnostic.severity() {
                Severity::Error => miette::Severity::Error,
                Severity::Warning => miette::Severity::Warning,
            },
            message: one_line(&diagnostic.message).into_owned(),
            help: help(sources, diagnostic).map(|help| visible(&help).into_owned()),
            ..Report::excerpt(sources, home, &labels, true)
        }];
        let mut others: Vec<FileId> = shown.iter().map(|l| l.span.file).filter(|f| *f != home).collect();
        others.sort();
        others.dedup();
        for file in others {
            let labels: Vec<&Label> = shown.iter().copied().filter(|l| l.span.file == file).collect();
            reports.push(Report {
                message: format!("in {}", one_line(&sources.file(file).name)),
                ..Report::excerpt(sources, file, &labels, false)
            });
        }
        reports
    }

    fn excerpt(sources: &SourceMap, file: FileId, labels: &[&Label], primary_first: bool) -> Report {
        let spans: Vec<_> = labels.iter().map(|l| l.span).collect();
        let (excerpt, places) = Excerpt::new(sources.file(file), &spans);
        let labels = labels.iter().zip(places).enumerate().map(|(i, (label, place))| {
            let text = (!label.text.is_empty()).then(|| one_line(&label.text).into_owned());
            if i == 0 && primary_first {
                LabeledSpan::new_primary_with_span(text, place)
            } else {
                LabeledSpan::new_with_span(text, place)
            }
        });
        Report {
            code: None,
            severity: miette::Severity::Advice,
            message: String::new(),
            labels: labels.collect(),
            excerpt,
            help: None,
        }
    }
}

fn help(sources: &SourceMap, diagnostic: &Diagnostic) -> Option<String> {
    let mut lines = Vec::new();
    match (&diagnostic.expected, &diagnostic.found) {
        (Some(expected), Some(found)) => lines.push(format!("expected {expected}, found {found}")),
        (Some(expected), None) => lines.push(format!("expected {expected}")),
        (None, Some(found)) => lines.push(format!("found {found}")),
        (None, None) => {}
    }
    lines.extend(diagnostic.help.clone());
    if let Some(fix) = &diagnostic.fix {
        let quoted = format!("`{}`", fix.replacement);
        let said = |help: &String| help.contains(&quoted) || fix.replacement.is_empty();
        if !diagnostic.help.as_ref().is_some_and(said) && !fix.replacement.contains('\n') {
            lines.push(match sources.text(fix.span) {
                "" => format!("insert {quoted}"),
                _ if fix.replacement.is_empty() => "remove it".to_string(),
                _ => format!("write {quoted}"),
            });
        }
    }
    let others = diagnostic.others().count();
    if others > MOST_RELATED {
        lines.push(format!("{} more places take part", others - MOST_RELATED));
    }
    (!lines.is_empty()).then(|| lines.join("\n"))
}

impl Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Report {}

impl miette::Diagnostic for Report {
    fn code<'a>(&'a self) -> Option<Box<dyn Display + 'a>> {
        self.code.as_ref().map(|c| Box::new(c) as _)
    }

    fn severity(&self) -> Option<miette::Severity> {
        Some(self.severity)
    }

    fn help<'a>(&'a self) -> Option<Box<dyn Display + 'a>> {
        self.help.as_ref().map(|h| Box::new(h) as _)
    }

    fn source_code(&self) -> Option<&dyn miette::SourceCode> {
        Some(&self.excerpt)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        Some(Box::new(self.labels.iter().cloned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnostic::Code;
    use crate::source::Span;

    fn example() -> (SourceMap, Diagnostic) {
        let mut sources = SourceMap::default();
        let main = sources.add("main.lss", "speed 2\nwidth 1.2 m\nvertex P1 (1 m, 2 m)\n");
        let other = sources.add("lib/a.lss", "let a = 1 m\nlet b = 2 m\n");
        let diagnostic = Diagnostic::new(Code::ALL[0], "speed has no unit", Span::new(main, 6, 7), "a bare number")
            .expected("a speed", "a bare number")
            .related(Span::new(main, 8, 13), "in the same layout")
            .related(Span::new(other, 4, 5), "first said here")
            .fix(Span::new(main, 6, 7), "2 m/s");
        (sources, diagnostic)
    }

    #[test]
    fn names_places_and_the_way_out() {
        let (sources, diagnostic) = example();
        let text = render(&sources, &diagnostic, Style::Plain);
        for part in ["main.lss:1:7", "lib/a.lss:1:5", "first said here", "expected a speed", "write `2 m/s`"] {
            assert!(text.contains(part), "{part} in\n{text}");
        }
        assert!(!text.contains('\u{1b}'));
        assert!(render(&sources, &diagnostic, Style::Colour).contains('\u{1b}'));
    }

    #[test]
    fn a_line_of_a_megabyte_is_shortened() {
        let mut sources = SourceMap::default();
        let text = format!("{}ZZZ{}", "å ".repeat(400_000), " x".repeat(400_000));
        let at = text.find("ZZZ").unwrap();
        let file = sources.add("long.lss", text);
        let diagnostic = Diagnostic::new(Code::ALL[0], "odd", Span::new(file, at, at + 3), "here");
        let report = render(&sources, &diagnostic, Style::Plain);
        assert!(report.contains("ZZZ") && report.contains("long.lss:1:800001"), "{report}");
        assert!(report.lines().all(|l| l.chars().count() < 200), "{report}");
    }

    #[test]
    fn counts() {
        let (_, diagnostic) = example();
        assert_eq!(summary(&[]), None);
        assert_eq!(summary(std::slice::from_ref(&diagnostic)).unwrap(), "1 error");
        assert_eq!(summary(&[diagnostic.clone(), diagnostic]).unwrap(), "2 errors");
    }
}
