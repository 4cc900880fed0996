//! Diagnostics as the protocol has them.

use super::client::Client;
use super::reference;
use super::workspace::Workspace;
use crate::diagnostic::{Code, Diagnostic, Label, Severity};
use crate::semantics::{Checked, Home};
use crate::source::FileId;
use lsp_types as lsp;
use std::collections::BTreeMap;
use std::path::PathBuf;

/// The diagnostics of each file that was read from the disk, also of those without any.
pub fn by_place(workspace: &Workspace, client: &Client, checked: &Checked) -> BTreeMap<PathBuf, Vec<lsp::Diagnostic>> {
    let mut all: BTreeMap<PathBuf, Vec<lsp::Diagnostic>> =
        checked.places().map(|place| (place.to_owned(), Vec::new())).collect();
    for diagnostic in &checked.diagnostics {
        if let Some(Home::Disk(place)) = checked.home(diagnostic.label.span.file) {
            all.entry(place.clone()).or_default().push(of(workspace, client, checked, diagnostic));
            continue;
        }
        // A file that is no text has no place in an editor: what imports it has.
        let known = |label: &&Label| matches!(checked.home(label.span.file), Some(Home::Disk(_)));
        if let Some(label) = diagnostic.related.iter().find(known)
            && let Some(Home::Disk(place)) = checked.home(label.span.file)
        {
            let moved = Diagnostic { label: label.clone(), related: Vec::new(), fix: None, ..diagnostic.clone() };
            all.entry(place.clone()).or_default().push(of(workspace, client, checked, &moved));
        }
    }
    all
}

/// The diagnostics of one file of a check.
pub fn of_file(workspace: &Workspace, client: &Client, checked: &Checked, file: FileId) -> Vec<lsp::Diagnostic> {
    let own = checked.diagnostics.iter().filter(|d| d.label.span.file == file);
    own.map(|d| of(workspace, client, checked, d)).collect()
}

pub fn of(workspace: &Workspace, client: &Client, checked: &Checked, diagnostic: &Diagnostic) -> lsp::Diagnostic {
    let span = diagnostic.label.span;
    let mut message = said(diagnostic);
    let mut related = Vec::new();
    for label in diagnostic.others() {
        match workspace.location(checked, label.span).filter(|_| client.related) {
            Some(location) => {
                related.push(lsp::DiagnosticRelatedInformation { location, message: label.text.clone() });
            }
            None => message += &format!("\n{}: {}", checked.sources.place(label.span), label.text),
        }
    }
    let page = client.pages.then(|| reference::page(diagnostic.code)).flatten();
    lsp::Diagnostic {
        range: workspace.lines_of(checked, span.file).of_span(span),
        severity: Some(match diagnostic.severity() {
            Severity::Error => lsp::DiagnosticSeverity::ERROR,
            Severity::Warning => lsp::DiagnosticSeverity::WARNING,
        }),
        code: Some(lsp::NumberOrString::String(diagnostic.code.as_str().to_owned())),
        code_description: page.map(|href| lsp::CodeDescription { href }),
        source: Some("lss".to_owned()),
        message,
        related_information: (!related.is_empty()).then_some(related),
        tags: (diagnostic.code == Code::W0701).then(|| vec![lsp::DiagnosticTag::UNNECESSARY]),
        data: None,
    }
}

/// What the terminal says, too: the message, what stands at the place, what was expected, and a way out.
fn said(diagnostic: &Diagnostic) -> String {
    let mut lines = vec![diagnostic.message.clone()];
    if !diagnostic.label.text.is_empty() && !diagnostic.message.contains(&diagnostic.label.text) {
        lines[0] += &format!(" ({})", diagnostic.label.text);
    }
    match (&diagnostic.expected, &diagnostic.found) {
        (Some(expected), Some(found)) => lines.push(format!("expected {expected}, found {found}")),
        (Some(expected), None) => lines.push(format!("expected {expected}")),
        (None, Some(found)) => lines.push(format!("found {found}")),
        (None, None) => {}
    }
    lines.extend(diagnostic.help.clone().map(|help| format!("help: {help}")));
    lines.join("\n")
}
