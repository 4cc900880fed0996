//! The structure of a document: symbols, folding, and what a selection grows to.

use super::text::Lines;
use super::workspace::Workspace;
use crate::semantics::{Checked, Home};
use crate::source::{self, Span};
use crate::syntax::tree::{Block, Field, Item, Name, Node, Statement, StationWord};
use lsp_types::{
    DocumentSymbol, FoldingRange, FoldingRangeKind, Location, Position, SelectionRange, SymbolInformation, SymbolKind,
};
use std::path::PathBuf;

/// The symbols of a document, nested.
pub fn symbols(lines: &Lines, checked: &Checked) -> Vec<DocumentSymbol> {
    let Some(tree) = checked.tree(checked.main) else { return Vec::new() };
    tree.items.nodes.iter().filter_map(|node| item(lines, node)).collect()
}

fn item(lines: &Lines, node: &Node<Item>) -> Option<DocumentSymbol> {
    match &node.value {
        Item::Let(item) => Some(symbol(lines, &item.name, node.span, "value", SymbolKind::CONSTANT, Vec::new())),
        Item::Declaration(item) => {
            let inner = fields(lines, &item.fields);
            Some(symbol(lines, &item.name, node.span, item.kind.word(), SymbolKind::CLASS, inner))
        }
        Item::Layout(layout) => {
            let inner = layout.body.nodes.iter().filter_map(|node| statement(lines, node)).collect();
            Some(symbol(lines, &layout.name, node.span, "layout", SymbolKind::MODULE, inner))
        }
        Item::Use(_) | Item::Bad => None,
    }
}

fn fields(lines: &Lines, block: &Block<Field>) -> Vec<DocumentSymbol> {
    let one = |node: &Node<Field>| match &node.value {
        Field::Value { name, .. } => Some(symbol(lines, name, node.span, "", SymbolKind::FIELD, Vec::new())),
        Field::Group { name, fields: inner } => {
            Some(symbol(lines, name, node.span, "", SymbolKind::OBJECT, fields(lines, inner)))
        }
        Field::Bad => None,
    };
    block.nodes.iter().filter_map(one).collect()
}

fn statement(lines: &Lines, node: &Node<Statement>) -> Option<DocumentSymbol> {
    let of = |name: &Name, what: &str, kind| Some(symbol(lines, name, node.span, what, kind, Vec::new()));
    match &node.value {
        Statement::Let(item) => of(&item.name, "value", SymbolKind::CONSTANT),
        Statement::Vertex { name, .. } => of(name, "vertex", SymbolKind::VARIABLE),
        Statement::Obstacle { name, .. } => of(name, "obstacle", SymbolKind::OBJECT),
        Statement::Section(section) => of(&section.name, "section", SymbolKind::VARIABLE),
        Statement::Induction { name, .. } => of(name, "induction", SymbolKind::EVENT),
        Statement::Chutes { name, .. } => of(name, "chutes", SymbolKind::ARRAY),
        Statement::Equipped(equipped) => {
            let kind = if equipped.word == StationWord::Chutes { SymbolKind::ARRAY } else { SymbolKind::EVENT };
            of(&equipped.name, equipped.word.word(), kind)
        }
        Statement::Component { kind, reference } => of(&reference.name, kind.word(), SymbolKind::PROPERTY),
        _ => None,
    }
}

#[allow(deprecated)] // The field `deprecated` itself is.
fn symbol(
    lines: &Lines,
    name: &Name,
    span: Span,
    detail: &str,
    kind: SymbolKind,
    children: Vec<DocumentSymbol>,
) -> DocumentSymbol {
    DocumentSymbol {
        name: name.text.clone(),
        detail: (!detail.is_empty()).then(|| detail.to_owned()),
        kind,
        tags: None,
        deprecated: None,
        range: lines.of_span(span.to(name.span)),
        selection_range: lines.of_span(name.span),
        children: (!children.is_empty()).then_some(children),
    }
}

/// Symbols without nesting, for clients that take no other.
pub fn flat(symbols: Vec<DocumentSymbol>, location: &dyn Fn(&DocumentSymbol) -> Location) -> Vec<SymbolInformation> {
    let mut all = Vec::new();
    for symbol in symbols {
        all.push(information(&symbol, location(&symbol), None));
        let container = symbol.name.clone();
        for inner in symbol.children.into_iter().flatten() {
            all.push(information(&inner, location(&inner), Some(container.clone())));
        }
    }
    all
}

#[allow(deprecated)]
fn information(symbol: &DocumentSymbol, location: Location, container_name: Option<String>) -> SymbolInformation {
    SymbolInformation {
        name: symbol.name.clone(),
        kind: symbol.kind,
        tags: None,
        deprecated: None,
        location,
        container_name,
    }
}

/// Symbols of the project whose names have the letters of the query in their order.
pub fn of_project(workspace: &mut Workspace, query: &str) -> Vec<SymbolInformation> {
    let open = workspace.places();
    let mut all: Vec<PathBuf> = open.clone();
    for folder in open.iter().filter_map(|place| place.parent()).filter(|folder| folder.is_absolute()) {
        let listed = source::layouts(folder).into_iter().map(|place| super::place::canonical(&place));
        all.extend(listed);
    }
    all.sort();
    all.dedup();
    let mut found = Vec::new();
    for place in all.into_iter().take(MOST_FILES) {
        let checked = workspace.checked(&place);
        let checked = checked.unwrap_or_else(|| Checked::new(&place, workspace.texts()).into());
        let Some(uri) = workspace.uri(&Home::Disk(place)) else { continue };
        let lines = workspace.lines_of(&checked, checked.main);
        let named = flat(symbols(&lines, &checked), &|s| Location::new(uri.clone(), s.selection_range));
        found.extend(named.into_iter().filter(|symbol| has_letters(&symbol.name, query)));
        if found.len() >= MOST_SYMBOLS {
            break;
        }
    }
    found.truncate(MOST_SYMBOLS);
    found
}

const MOST_FILES: usize = 200;
const MOST_SYMBOLS: usize = 500;

fn has_letters(name: &str, query: &str) -> bool {
    let mut letters = name.chars().flat_map(char::to_lowercase);
    query.chars().flat_map(char::to_lowercase).all(|wanted| letters.any(|c| c == wanted))
}

/// Blocks, lists over several lines, imports and comments.
pub fn folds(lines: &Lines, checked: &Checked) -> Vec<FoldingRange> {
    let Some(tree) = checked.tree(checked.main) else { return Vec::new() };
    let mut found: Vec<(u32, u32, Option<FoldingRangeKind>)> = Vec::new();
    let mut add = |span: Span, kind: Option<FoldingRangeKind>| {
        let range = lines.of_span(span);
        if range.end.line > range.start.line {
            found.push((range.start.line, range.end.line, kind));
        }
    };
    for node in &tree.items.nodes {
        add(node.span, None);
        match &node.value {
            Item::Layout(layout) => layout.body.nodes.iter().for_each(|node| add(node.span, None)),
            Item::Declaration(d) => d.fields.nodes.iter().for_each(|node| add(node.span, None)),
            _ => {}
        }
    }
    let uses = tree.items.nodes.iter().filter(|node| matches!(node.value, Item::Use(_))).map(|node| node.span);
    if let Some(all) = uses.reduce(Span::to) {
        add(all, Some(FoldingRangeKind::Imports));
    }
    let mut begun = None;
    for number in 0..=lines.count() {
        let comment = lines.line(number).is_some_and(|(_, line)| line.trim_start().starts_with("//"));
        match (comment, begun) {
            (true, None) => begun = Some(number),
            (false, Some(first)) => {
                if number - first > 1 {
                    found.push((first as u32, number as u32 - 1, Some(FoldingRangeKind::Comment)));
                }
                begun = None;
            }
            _ => {}
        }
    }
    found.sort_by_key(|(start, end, _)| (*start, *end));
    found.dedup_by_key(|(start, ..)| *start);
    let fold = |(start_line, end_line, kind)| FoldingRange { start_line, end_line, kind, ..FoldingRange::default() };
    found.into_iter().map(fold).collect()
}

/// What a selection at a position grows to: the word, brackets around it, the line, the block, the file.
pub fn selection(lines: &Lines, checked: &Checked, position: Position) -> SelectionRange {
    let text = lines.text();
    let offset = lines.offset(position);
    let (start, word) = super::text::word_at(text, offset);
    let mut ranges: Vec<(usize, usize)> = vec![(start, start + word.len())];
    ranges.extend(brackets(text, offset));
    if let Some((begin, line)) = lines.line(lines.position(offset).line as usize) {
        let trimmed = line.trim_start();
        ranges.push((begin + line.len() - trimmed.len(), begin + line.trim_end().len()));
    }
    if let Some(tree) = checked.tree(checked.main) {
        for node in &tree.items.nodes {
            ranges.push((node.span.start as usize, node.span.end as usize));
            if let Item::Layout(layout) = &node.value {
                ranges.extend(layout.body.nodes.iter().map(|n| (n.span.start as usize, n.span.end as usize)));
            }
        }
    }
    ranges.push((0, text.len()));
    ranges.retain(|(a, b)| a <= b && (*a..=*b).contains(&offset));
    ranges.sort_by_key(|(a, b)| b - a);
    // Each one holds the one before.
    let mut nested: Vec<(usize, usize)> = Vec::new();
    for (a, b) in ranges {
        if nested.last().is_none_or(|(c, d)| a <= *c && *d <= b && (a, b) != (*c, *d)) {
            nested.push((a, b));
        }
    }
    let mut grown: Option<SelectionRange> = None;
    for (a, b) in nested.into_iter().rev() {
        grown = Some(SelectionRange { range: lines.range(a, b), parent: grown.map(Box::new) });
    }
    grown.unwrap_or(SelectionRange { range: lines.range(offset, offset), parent: None })
}

/// Brackets around a byte, with what is in them.
fn brackets(text: &str, offset: usize) -> Vec<(usize, usize)> {
    let mut open: Vec<usize> = Vec::new();
    let mut found = Vec::new();
    let bytes = text.as_bytes();
    let mut at = 0;
    while at < bytes.len() {
        match bytes[at] {
            b'/' if bytes.get(at + 1) == Some(&b'/') => at += text[at..].find('\n').unwrap_or(text.len() - at),
            b'"' => at += text[at + 1..].find(['"', '\n']).map_or(0, |end| end + 1),
            b'(' | b'[' | b'{' => open.push(at),
            b')' | b']' | b'}' => {
                if let Some(begin) = open.pop()
                    && begin < offset
                    && offset <= at
                {
                    found.extend([(begin + 1, at), (begin, at + 1)]);
                }
            }
            _ => {}
        }
        at += 1;
    }
    found
}
