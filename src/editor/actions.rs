//! Quick fixes: every diagnostic that knows its fix.

use super::client::Client;
use super::diagnostics;
use super::workspace::Workspace;
use crate::diagnostic::Diagnostic;
use crate::semantics::{Checked, Home};
use lsp_types::{CodeAction, CodeActionKind, Range, TextEdit, Uri, WorkspaceEdit};
use std::collections::HashMap;

/// The fixes of diagnostics of the main file that touch a range.
pub fn actions(workspace: &Workspace, client: &Client, checked: &Checked, range: Range) -> Vec<CodeAction> {
    let lines = workspace.lines_of(checked, checked.main);
    let (from, to) = (lines.offset(range.start) as u32, lines.offset(range.end) as u32);
    let touched = |d: &&Diagnostic| {
        let span = d.label.span;
        span.file == checked.main && span.start <= to.max(from) && from.min(to) <= span.end
    };
    let fixable = checked.diagnostics.iter().filter(touched);
    fixable.filter_map(|d| action(workspace, client, checked, d)).collect()
}

fn action(workspace: &Workspace, client: &Client, checked: &Checked, diagnostic: &Diagnostic) -> Option<CodeAction> {
    let fix = diagnostic.fix.as_ref()?;
    let home = checked.home(fix.span.file).filter(|home| matches!(home, Home::Disk(_)))?;
    let lines = workspace.lines_of(checked, fix.span.file);
    let edit = TextEdit::new(lines.of_span(fix.span), fix.replacement.clone());
    // A URI is a key by its text alone, which nothing changes.
    #[allow(clippy::mutable_key_type)]
    let changes: HashMap<Uri, Vec<TextEdit>> = [(workspace.uri(home)?, vec![edit])].into();
    Some(CodeAction {
        title: title(checked, diagnostic)?,
        kind: Some(CodeActionKind::QUICKFIX),
        diagnostics: Some(vec![diagnostics::of(workspace, client, checked, diagnostic)]),
        edit: Some(WorkspaceEdit { changes: Some(changes), ..WorkspaceEdit::default() }),
        is_preferred: Some(true),
        ..CodeAction::default()
    })
}

/// What the fix does, in a few words.
fn title(checked: &Checked, diagnostic: &Diagnostic) -> Option<String> {
    let fix = diagnostic.fix.as_ref()?;
    let (old, new) = (checked.sources.text(fix.span), fix.replacement.trim());
    let shown = |text: &str| match text.trim().split_once('\n') {
        Some((first, _)) => format!("`{} …`", first.trim_end()),
        None => format!("`{}`", text.trim()),
    };
    Some(match (old.trim().is_empty(), new.is_empty()) {
        (true, _) => format!("Insert {}", shown(new)),
        (false, true) => format!("Remove {}", shown(old)),
        (false, false) => format!("Replace {} by {}", shown(old), shown(new)),
    })
}
