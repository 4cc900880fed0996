//! Renaming: everywhere at once, or not at all.

use super::describe;
use super::reference;
use super::text::is_name;
use super::uses::{self, Places, Symbol};
use super::words;
use super::workspace::Workspace;
use crate::diagnostic::Code;
use crate::semantics::names::{NameKind, Occurrence};
use crate::semantics::{Checked, Home};
use crate::syntax::tree::{Item, Statement};
use lsp_types::{Range, TextEdit, Uri, WorkspaceEdit};
use std::collections::{BTreeMap, HashMap};
use std::path::Path;

/// The name at a byte that can be renamed, or why there is none.
fn renamable<'c>(workspace: &Workspace, checked: &'c Checked, offset: usize) -> Result<&'c Occurrence, String> {
    let text = checked.text(checked.main);
    let Some(name) = checked.names_at(offset).first() else {
        let (_, word) = super::text::word_at(text, offset);
        return Err(match word {
            _ if describe::unit_at(&workspace.lines(text), offset).is_some() => "a unit cannot be renamed".to_owned(),
            word if words::is_keyword(word) => format!("`{word}` is a word of the language"),
            _ => "nothing here has a name that can be changed".to_owned(),
        });
    };
    let written = checked.sources.text(name.span);
    let Some(definition) = name.symbol else {
        return Err(format!("`{written}` is a word of the language: {}", with_article(&name.kind)));
    };
    match checked.home(definition.file) {
        Some(Home::Disk(place)) if !reference::holds(place) => Ok(name),
        _ => Err(format!("`{written}` belongs to the standard library")),
    }
}

fn with_article(kind: &NameKind) -> String {
    let word = kind.word();
    format!("{} {word}", if word.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" })
}

/// What would be renamed at a byte, and its name as it is.
pub fn prepare(workspace: &Workspace, checked: &Checked, offset: usize) -> Result<(Range, String), String> {
    let name = renamable(workspace, checked, offset)?;
    let range = workspace.lines_of(checked, checked.main).of_span(name.span);
    Ok((range, checked.sources.text(name.span).to_owned()))
}

/// The edits that rename what is at a byte. They are tried before they are given: where the new name means another thing
/// already, or a line that does not parse may use the old one, there are none.
pub fn rename(
    workspace: &mut Workspace,
    place: &Path,
    checked: &Checked,
    offset: usize,
    new: &str,
) -> Result<WorkspaceEdit, String> {
    let name = renamable(workspace, checked, offset)?;
    if !is_name(new) {
        return Err(format!("`{new}` is no name: letters, digits and `_`, not beginning with a digit"));
    }
    let symbol = Symbol::of(checked, name).ok_or("nothing here has a name that can be changed")?;
    let checks = uses::checks(workspace, &symbol, place);
    for (_, checked) in &checks {
        if let Some(place) = unread(checked, &symbol) {
            return Err(format!("{place} does not parse and may use `{}`: correct it first", symbol.name));
        }
    }
    let places = uses::places(&checks, &symbol);
    let texts = uses::replaced(workspace.texts(), &places, new);
    let renamed = moved(&symbol, &places, new);
    for (place, before) in &checks {
        let after = Checked::new(place, &texts);
        if let Some(message) = new_mistake(before, &after) {
            return Err(format!("with the name `{new}`: {message}"));
        }
        if symbol.uses(before).len() != renamed.uses(&after).len() {
            return Err(format!("`{new}` means another thing already"));
        }
    }
    let mut changes: HashMap<String, (Uri, Vec<TextEdit>)> = HashMap::new();
    for (home, (text, spans)) in &places {
        let Some(uri) = workspace.uri(home) else { continue };
        let lines = workspace.lines(text);
        let edits = spans.iter().map(|(start, end)| TextEdit::new(lines.range(*start, *end), new.to_owned()));
        changes.insert(uri.as_str().to_owned(), (uri, edits.collect()));
    }
    // A URI is a key by its text alone, which nothing changes.
    #[allow(clippy::mutable_key_type)]
    let changes: HashMap<Uri, Vec<TextEdit>> = changes.into_values().collect();
    Ok(WorkspaceEdit { changes: Some(changes), ..WorkspaceEdit::default() })
}

/// The thing after its places got another name.
fn moved(symbol: &Symbol, places: &Places, new: &str) -> Symbol {
    let before = places
        .get(&symbol.home)
        .map_or(0, |(_, spans)| spans.iter().filter(|(start, _)| *start < symbol.start as usize).count());
    let grown = new.len() as i64 - symbol.name.len() as i64;
    let start = (i64::from(symbol.start) + before as i64 * grown) as u32;
    Symbol { start, end: start + new.len() as u32, name: new.to_owned(), ..symbol.clone() }
}

/// The message of a code that there is more of.
fn new_mistake(before: &Checked, after: &Checked) -> Option<String> {
    let count = |checked: &Checked| {
        let mut all: BTreeMap<Code, usize> = BTreeMap::new();
        checked.diagnostics.iter().for_each(|d| *all.entry(d.code).or_default() += 1);
        all
    };
    let (before, counted) = (count(before), count(after));
    let more = counted.into_iter().find(|(code, n)| *n > before.get(code).copied().unwrap_or(0))?.0;
    after.diagnostics.iter().find(|d| d.code == more).map(|d| d.message.clone())
}

/// A line that did not parse and mentions a thing's name.
fn unread(checked: &Checked, symbol: &Symbol) -> Option<String> {
    let study = checked.study.as_ref()?;
    symbol.span(checked)?;
    let bad = study.files.iter().flat_map(|file| &file.tree.items.nodes).flat_map(|node| match &node.value {
        Item::Bad => vec![node.span],
        Item::Layout(layout) => {
            let nodes = layout.body.nodes.iter();
            nodes.filter(|n| matches!(n.value, Statement::Bad)).map(|n| n.span).collect()
        }
        _ => Vec::new(),
    });
    let mut words = bad.filter(|span| {
        checked.sources.text(*span).split(|c: char| !super::text::in_name(c)).any(|word| word == symbol.name)
    });
    words.next().map(|span| checked.sources.place(span))
}
