//! What things are, in Markdown: for hovers and beside proposals.

use super::text::Lines;
use super::words;
use crate::base::number::shortest;
use crate::base::words::with_article;
use crate::model::effect_definitions::{EFFECTS, EffectDefinition, PlaceKind};
use crate::semantics::Checked;
use crate::semantics::dimension::parse_unit;
use crate::semantics::names::NameKind;
use crate::semantics::vocabulary;
use crate::source::Span;
use crate::syntax::tree::{DeclarationKind, Item, Node, Statement};

/// A line of the language.
pub fn code(text: &str) -> String {
    format!("```lss\n{text}\n```")
}

/// What a name is, where it is declared.
pub fn name(checked: &Checked, kind: &NameKind, text: &str, definition: Option<Span>) -> String {
    match kind {
        NameKind::Field(owner, path) => field(*owner, path),
        NameKind::Function => function(text),
        NameKind::Effect => effect(text),
        NameKind::EffectArgument(owner) => effect_argument(owner, text),
        NameKind::Building => "the walls of the `building`".to_owned(),
        NameKind::Module => module(text),
        _ => definition.map_or_else(|| kind.word().to_owned(), |span| declared(checked, kind, text, span)),
    }
}

fn declared(checked: &Checked, kind: &NameKind, text: &str, definition: Span) -> String {
    let mut parts = vec![code(&line_of(checked, definition))];
    let value = checked.study.as_ref().and_then(|study| study.values.get(&definition));
    match (kind, value) {
        (NameKind::Value, Some(value)) => parts.push(format!("`{text}` is {value}")),
        (NameKind::Parameter, _) => parts.push(format!("a parameter of {}", owner(checked, definition))),
        _ => {}
    }
    parts.extend(comment(checked, definition));
    if definition.file != checked.main {
        parts.push(format!("from `{}`", checked.sources.file(definition.file).name));
    }
    parts.join("\n\n")
}

/// The line that declares something, without a block.
fn line_of(checked: &Checked, span: Span) -> String {
    let text = checked.text(span.file);
    let (start, end) = (span.start as usize, span.end as usize);
    let begin = text[..start].rfind('\n').map_or(0, |at| at + 1);
    let line = text[end..].find('\n').map_or(text.len(), |at| end + at);
    let written = text[begin..line].split("//").next().unwrap_or_default();
    written.trim().trim_end_matches('{').trim_end().to_owned()
}

/// `cart tilt_tray`
fn owner(checked: &Checked, inside: Span) -> String {
    let named = node_at(checked, inside).and_then(|node| match &node.value {
        Item::Declaration(d) => Some(format!("`{} {}`", d.kind.word(), d.name.text)),
        Item::Layout(layout) => Some(format!("`layout {}`", layout.name.text)),
        Item::Use(_) | Item::Let(_) | Item::Bad => None,
    });
    named.unwrap_or_else(|| "this".to_owned())
}

fn node_at(checked: &Checked, inside: Span) -> Option<&Node<Item>> {
    let holds = |span: Span| span.start <= inside.start && inside.end <= span.end;
    checked.tree(inside.file)?.items.nodes.iter().find(|node| holds(node.span))
}

/// The comment that belongs to the line of a declaration.
fn comment(checked: &Checked, definition: Span) -> Option<String> {
    let holds = |span: Span| span.start <= definition.start && definition.end <= span.end;
    let node = node_at(checked, definition)?;
    let inner = match &node.value {
        Item::Layout(layout) => layout.body.nodes.iter().find(|n: &&Node<Statement>| holds(n.span)),
        _ => None,
    };
    let (above, beside) = match inner {
        Some(inner) => (&inner.above, &inner.beside),
        None => (&node.above, &node.beside),
    };
    // What a blank line parts from the declaration is about the file.
    let own = above.iter().rposition(String::is_empty).map_or(0, |at| at + 1);
    let lines = above[own..].iter().chain(beside).map(|c| c.trim_start_matches('/').trim());
    let text = lines.collect::<Vec<_>>().join(" ");
    (!text.is_empty()).then_some(text)
}

/// `a cart`; equipment is not counted.
fn one_of(kind: DeclarationKind) -> String {
    match kind {
        DeclarationKind::Equipment => kind.word().to_owned(),
        _ => with_article(kind.word()),
    }
}

/// A field or a group of fields.
pub fn field(owner: DeclarationKind, path: &str) -> String {
    let group = format!("{path}.");
    match vocabulary::fields(owner).find(|f| f.path == path) {
        Some(field) => {
            let needed = if field.required { "required" } else { "may be left out" };
            let bounds = field.bounds.map(|b| format!(", {b}")).unwrap_or_default();
            format!("`{path}` of {}: {}\n\n{}{bounds}; {needed}", one_of(owner), field.about, field.form)
        }
        None => {
            let inside: Vec<String> = vocabulary::fields(owner)
                .filter_map(|f| Some(format!("- `{}`: {}", f.path.strip_prefix(&group)?, f.about)))
                .collect();
            format!("fields `{path}` of {}:\n\n{}", one_of(owner), inside.join("\n"))
        }
    }
}

pub fn function(name: &str) -> String {
    if name == "straight" {
        return "`straight(P1..P2)`: what remains of a section between its curves".to_owned();
    }
    let Some(function) = vocabulary::functions().find(|f| f.name == name) else { return String::new() };
    let usage = function.usage.replace(" or ", "` or `");
    match function.geometric {
        true => format!("`{usage}`\n\nof the layout's geometry, in `require` and `equal`"),
        false => format!("`{usage}`"),
    }
}

fn arguments(effect: &EffectDefinition) -> impl Iterator<Item = (&'static str, String)> {
    let strengths = effect.strengths.iter().map(|s| {
        let unit = if s.unit.is_empty() { String::new() } else { format!(" {}", s.unit) };
        (s.name, format!("{}, {} to {}{unit}", s.about, shortest(s.low), shortest(s.high)))
    });
    let places = effect.places.iter().map(|p| {
        let about = if p.about.is_empty() { p.name } else { p.about };
        let unit = if p.kind == PlaceKind::Length { " m" } else { "" };
        (p.name, format!("{about}; {}{unit} when not given", shortest(p.default)))
    });
    strengths.chain(places)
}

pub fn effect(name: &str) -> String {
    let Some(effect) = EFFECTS.iter().find(|e| e.name == name) else { return String::new() };
    let arguments: Vec<String> = arguments(effect).map(|(name, about)| format!("- `{name}`: {about}")).collect();
    format!("effect `{name}`: {}\n\n{}", effect.about, arguments.join("\n"))
}

pub fn effect_argument(effect: &str, name: &str) -> String {
    let effect = EFFECTS.iter().find(|e| e.name == effect);
    let found = effect.and_then(|effect| arguments(effect).find(|(own, _)| *own == name));
    found.map(|(name, about)| format!("`{name}`: {about}")).unwrap_or_default()
}

/// The names of an effect's arguments, with what they are.
pub fn effect_arguments(effect: &str) -> Vec<(&'static str, String)> {
    EFFECTS.iter().find(|e| e.name == effect).map(|e| arguments(e).collect()).unwrap_or_default()
}

pub fn module(name: &str) -> String {
    let text = crate::source::STDLIB.iter().find(|(module, _)| *module == name).map_or("", |(_, text)| text);
    let head: Vec<&str> = text.lines().map_while(|line| line.strip_prefix("//")).map(str::trim).collect();
    format!("`std.{name}`, of the standard library\n\n{}", head.join(" "))
}

pub fn unit(symbol: &str) -> Option<String> {
    let unit = parse_unit(symbol).ok()?;
    let measures = vocabulary::measures(symbol)?;
    let si = unit.dimension.spelled();
    let value =
        if unit.offset == 0.0 { format!("1 {symbol} = {} {si}", shortest(unit.factor)) } else { symbol.to_owned() };
    Some(format!("`{symbol}`: {measures}; {value}"))
}

/// The unit that touches a byte, behind its number.
pub fn unit_at(lines: &Lines, offset: usize) -> Option<(usize, usize)> {
    let text = lines.text();
    let inside = |c: char| c.is_alphanumeric() || matches!(c, '%' | '°' | '/' | '*' | '^' | '.' | '_');
    let start = text.get(..offset)?.trim_end_matches(inside).len();
    let end = text.len() - text.get(offset..)?.trim_start_matches(inside).len();
    let found = &text[start..end];
    // A number may stand before it without a space.
    let digits = found.len() - found.trim_start_matches(|c: char| c.is_ascii_digit() || c == '.' || c == '_').len();
    let symbol = found[digits..].trim_end_matches(['.', '/', '*']);
    let number = digits > 0 || text[..start].trim_end_matches(' ').ends_with(|c: char| c.is_ascii_digit());
    let place = start + digits..start + digits + symbol.len();
    (number && !symbol.is_empty() && (place.start..=place.end).contains(&offset) && parse_unit(symbol).is_ok())
        .then_some((place.start, place.end))
}

/// What a keyword means, by the word that begins its line.
pub fn keyword(text: &str, offset: usize) -> Option<String> {
    let (start, word) = super::text::word_at(text, offset);
    if word.is_empty() || !words::is_keyword(word) {
        return None;
    }
    let begin = text[..start].rfind(['\n', '{']).map_or(0, |at| at + 1);
    let first = text[begin..].trim_start().split(|c: char| !super::text::in_name(c)).next().unwrap_or_default();
    words::meaning(first)
}
