//! What may be written at a place. The grammar says which words, names and values may follow; the checked text says
//! which names there are.

mod cursor;
mod names;

use super::client::Client;
use super::describe;
use super::words;
use super::workspace::Workspace;
use crate::model::SCANNERS;
use crate::semantics::Checked;
use crate::semantics::names::NameKind;
use crate::semantics::vocabulary;
use crate::syntax::tree::DeclarationKind;
use crate::syntax::{Context, Next, continuations, value_example};
use cursor::Cursor;
use lsp_types::{
    CompletionItem, CompletionItemKind, CompletionTextEdit, Documentation, InsertTextFormat, MarkupContent, MarkupKind,
    Range, TextEdit,
};
use names::Known;
use std::path::Path;

/// What begins a line, and what may be written in it.
pub(super) struct Proposals<'a> {
    client: &'a Client,
    /// What a proposal replaces.
    range: Range,
    pub items: Vec<CompletionItem>,
}

impl Proposals<'_> {
    fn push(
        &mut self,
        label: &str,
        kind: CompletionItemKind,
        detail: &str,
        about: Option<String>,
    ) -> &mut CompletionItem {
        let rank = format!("{:04}", self.items.len());
        let format = if self.client.markdown { MarkupKind::Markdown } else { MarkupKind::PlainText };
        self.items.push(CompletionItem {
            label: label.to_owned(),
            kind: Some(kind),
            detail: (!detail.is_empty()).then(|| detail.to_owned()),
            documentation: about
                .filter(|text| !text.is_empty())
                .map(|value| Documentation::MarkupContent(MarkupContent { kind: format, value })),
            sort_text: Some(rank),
            text_edit: Some(CompletionTextEdit::Edit(TextEdit::new(self.range, label.to_owned()))),
            ..CompletionItem::default()
        });
        let last = self.items.len() - 1;
        &mut self.items[last]
    }

    /// A proposal with places to fill in, where the client has such.
    fn snippet(&mut self, label: &str, kind: CompletionItemKind, detail: &str, about: Option<String>, snippet: &str) {
        let (snippets, range) = (self.client.snippets, self.range);
        let item = self.push(label, kind, detail, about);
        if snippets && snippet != label {
            item.text_edit = Some(CompletionTextEdit::Edit(TextEdit::new(range, snippet.to_owned())));
            item.insert_text_format = Some(InsertTextFormat::SNIPPET);
        }
    }

    /// A word that begins a line.
    fn beginning(&mut self, word: &str, snippet: &str) {
        self.snippet(word, CompletionItemKind::KEYWORD, "", words::meaning(word), snippet);
    }

    fn units(&mut self, like: &str) {
        let first = vocabulary::units_like(like);
        let rest: Vec<&str> = vocabulary::units().filter(|unit| !first.contains(unit)).collect();
        for unit in first.into_iter().chain(rest) {
            let measures = vocabulary::measures(unit).unwrap_or_default();
            self.push(unit, CompletionItemKind::UNIT, &measures, describe::unit(unit));
        }
    }
}

/// What may be written at a byte of a document.
pub fn complete(
    workspace: &Workspace,
    client: &Client,
    place: &Path,
    checked: &Checked,
    offset: usize,
) -> Vec<CompletionItem> {
    let text = checked.text(checked.main);
    let Some(cursor) = Cursor::new(text, offset) else { return Vec::new() };
    let range = workspace.lines(text).range(offset - cursor.partial.len(), offset);
    let mut out = Proposals { client, range, items: Vec::new() };
    let known = Known { checked, offset, workspace };
    if let Some(quoted) = cursor.quoted {
        if cursor.begun.trim() == "use" {
            known.files(&mut out, place, quoted);
        }
        return out.items;
    }
    let head = cursor.blocks.first().map(|head| first_word(head));
    let kind = head.and_then(|head| DeclarationKind::ALL.into_iter().find(|kind| kind.word() == head));
    match (head, kind) {
        (None, _) => item(&mut out, &known, &cursor),
        (Some("layout"), _) => statement(&mut out, &known, &cursor),
        (Some(_), Some(kind)) => field(&mut out, &known, &cursor, kind),
        _ => {}
    }
    out.items
}

/// The last word of a text that ends with a space.
fn last_word(text: &str) -> &str {
    text.trim_end().rsplit(' ').next().unwrap_or("")
}

fn first_word(text: &str) -> &str {
    text.trim_start().split(|c: char| !super::text::in_name(c)).next().unwrap_or_default()
}

fn item(out: &mut Proposals, known: &Known, cursor: &Cursor) {
    let begun = cursor.begun;
    if begun.is_empty() {
        for word in words::beginnings(Context::Item) {
            let snippet = match word.as_str() {
                "layout" => "layout ${1:name} {\n  $0\n}".to_owned(),
                "use" => "use std.".to_owned(),
                "let" => words::snippet("let"),
                kind => format!("{kind} ${{1:name}} from ${{2:base}} {{\n  $0\n}}"),
            };
            out.beginning(&word, &snippet);
        }
        return;
    }
    if let Some(path) = begun.strip_prefix("use ") {
        return known.library(out, path.trim());
    }
    let word = first_word(begun);
    if let Some(call) = Call::around(begun) {
        let kind = DeclarationKind::ALL.into_iter().find(|kind| kind.word() == word);
        let space = kind.map_or(NameKind::Layout, NameKind::Component);
        // Behind `from` it is a call; before, these are parameters with their defaults.
        if begun.contains(" from ") && call.wants_name() {
            return known.parameters(out, &space, call.name);
        }
        return rest(out, known, Context::Item, cursor);
    }
    if begun.trim_end().ends_with(" from") {
        let kind = DeclarationKind::ALL.into_iter().find(|kind| kind.word() == word);
        return known.named(out, &kind.map_or(NameKind::Layout, NameKind::Component));
    }
    rest(out, known, Context::Item, cursor);
}

fn field(out: &mut Proposals, known: &Known, cursor: &Cursor, kind: DeclarationKind) {
    let prefix: String = cursor.blocks[1..].iter().map(|group| format!("{}.", first_word(group))).collect();
    let written = first_word(cursor.begun);
    let path = format!("{prefix}{written}");
    if cursor.begun.is_empty() {
        return known.fields(out, kind, &prefix);
    }
    let spec = vocabulary::fields(kind).find(|f| f.path == path);
    if let Some(call) = Call::around(cursor.begun)
        && let Some(names) = spec.as_ref().and_then(|f| f.names)
    {
        if call.wants_name() {
            known.parameters(out, &NameKind::Component(names), call.name);
        }
        return;
    }
    for next in continuations(Context::Field, cursor.begun) {
        match (next, &spec) {
            (Next::Unit, Some(spec)) => out.units(if spec.unit.is_empty() { "m" } else { spec.unit }),
            (Next::Unit, None) => out.units("m"),
            (Next::Value, Some(spec)) if !spec.words.is_empty() => {
                for word in spec.words {
                    out.push(word, CompletionItemKind::KEYWORD, "", None);
                }
            }
            (Next::Value, Some(spec)) => match spec.names {
                Some(kind) => known.named(out, &NameKind::Component(kind)),
                None => known.values(out, false),
            },
            (Next::Word(word), _) => {
                out.push(&word, CompletionItemKind::KEYWORD, "", None);
            }
            _ => {}
        }
    }
}

fn statement(out: &mut Proposals, known: &Known, cursor: &Cursor) {
    let begun = cursor.begun;
    if begun.is_empty() {
        for word in words::beginnings(Context::Statement) {
            out.beginning(&word, &words::snippet(&word));
        }
        return;
    }
    let word = first_word(begun);
    let component = DeclarationKind::ALL.into_iter().find(|kind| kind.word() == word);
    if let Some(call) = Call::around(begun) {
        if let Some(kind) = component {
            return match call.wants_name() {
                true => known.parameters(out, &NameKind::Component(kind), call.name),
                false => rest(out, known, Context::Statement, cursor),
            };
        }
        if word == "effect" {
            return match call.wants_name() {
                true => known.effect_arguments(out, call.name),
                false => rest(out, known, Context::Statement, cursor),
            };
        }
        let geometric = vocabulary::functions().any(|f| f.geometric && f.name == call.name);
        if geometric || call.name == "straight" {
            known.parts(out, &[NameKind::Vertex]);
            match call.name {
                "distance" => {
                    known.parts(out, &[NameKind::Obstacle]);
                    out.push("building", CompletionItemKind::KEYWORD, "the walls", None);
                }
                "length" => known.function(out, "straight"),
                _ => {}
            }
            return;
        }
    }
    if let Some(kind) = chosen(begun) {
        return known.named(out, &NameKind::Component(kind));
    }
    let bare = begun.trim_end() == word;
    match word {
        "effect" if bare => known.effects(out),
        "pass" if bare => known.parts(out, &[NameKind::Obstacle]),
        "feed" if bare => known.parts(out, &[NameKind::Induction]),
        "storage" if bare => known.parts(out, &[NameKind::Chutes]),
        "fails" if bare => {
            known.parts(out, &[NameKind::Induction, NameKind::Chutes]);
            out.push(SCANNERS, CompletionItemKind::KEYWORD, "each scanner for itself", None);
        }
        "wave" | "feed" if names_row(begun) => known.parts(out, &[NameKind::Chutes]),
        "route" if bare || begun.trim_end().ends_with(',') => known.parts(out, &[NameKind::Section]),
        _ if component.is_some() && bare => component.iter().for_each(|k| known.named(out, &NameKind::Component(*k))),
        // A new name is the writer's own.
        "vertex" | "obstacle" | "induction" | "chutes" | "gate" | "lift" | "section" | "wave" | "let" if bare => {}
        "induction" | "chutes" | "scanner" | "gate" | "lift" if begun.trim_end().ends_with(" of") => {
            known.equipment(out, if word == "chutes" { "chute" } else { word });
        }
        _ if matches!(last_word(begun), "after" | "before") => {
            known.parts(out, &[NameKind::Induction, NameKind::Chutes, NameKind::Station]);
        }
        _ => rest(out, known, Context::Statement, cursor),
    }
}

/// Whether a row of chutes with its share comes next: behind `to`, but not `up to`, or behind a comma.
fn names_row(begun: &str) -> bool {
    let begun = begun.trim_end();
    begun.ends_with(',') || last_word(begun) == "to" && !begun.ends_with("up to")
}

/// The kind of component that is named next behind `choose cart`, the like, or a comma there.
fn chosen(begun: &str) -> Option<DeclarationKind> {
    let named = begun.strip_prefix("choose ")?.trim_start();
    let free = [DeclarationKind::Cart, DeclarationKind::Motor, DeclarationKind::Sensor, DeclarationKind::TakeUp];
    let kind = free.into_iter().find(|kind| first_word(named) == kind.word())?;
    let behind = named[kind.word().len()..].trim();
    (behind.is_empty() || behind.ends_with(',')).then_some(kind)
}

/// What the grammar takes next.
fn rest(out: &mut Proposals, known: &Known, context: Context, cursor: &Cursor) {
    let begun = cursor.begun;
    let word = first_word(begun);
    let all = continuations(context, begun);
    for next in &all {
        match next {
            Next::Word(next) => {
                let about = words::meaning(word);
                match next.as_str() {
                    "straight" => known.function(out, "straight"),
                    next => {
                        out.push(next, CompletionItemKind::KEYWORD, "", about);
                    }
                }
            }
            Next::Unit => out.units(vocabulary_unit(begun)),
            Next::Section | Next::Name if context == Context::Statement => known.parts(out, &[NameKind::Vertex]),
            Next::Value => known.values(out, matches!(word, "require" | "equal")),
            Next::Section | Next::Name | Next::Text | Next::End => {}
        }
    }
}

/// The unit of the value that a line asks for.
fn vocabulary_unit(begun: &str) -> &'static str {
    // Without the number itself: what stands before it says what it is.
    let number = |c: char| c.is_ascii_digit() || matches!(c, '.' | '_' | ' ' | '-');
    let example = value_example(begun.trim_end_matches(number));
    let unit = example.trim_start_matches(|c: char| c.is_ascii_digit() || matches!(c, '.' | ' '));
    if unit.is_empty() || unit.contains('(') { "m" } else { unit }
}

/// The innermost call that a line is in.
struct Call<'a> {
    name: &'a str,
    /// What is written of it.
    inside: &'a str,
}

impl<'a> Call<'a> {
    fn around(begun: &'a str) -> Option<Call<'a>> {
        let mut depth = 0;
        for (at, c) in begun.char_indices().rev() {
            match c {
                ')' | ']' => depth += 1,
                '[' if depth == 0 => return None,
                '(' if depth == 0 => {
                    let before = &begun[..at];
                    let name = &before[before.trim_end_matches(super::text::in_name).len()..];
                    return (!name.is_empty()).then(|| Call { name, inside: &begun[at + 1..] });
                }
                '(' | '[' => depth -= 1,
                _ => {}
            }
        }
        None
    }

    /// Whether the name of an argument comes next, and not its value.
    fn wants_name(&self) -> bool {
        let inside = self.inside.trim_end();
        inside.is_empty() || inside.ends_with(',')
    }
}
