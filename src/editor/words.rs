//! What the language's words mean, from the tables of its page: what stands there is shown while typing.

use crate::syntax::tree::{Axis, DeclarationKind, FixKind, Goal, SideWord, TitleField};
use crate::syntax::{Context, Next, continuations};
use std::collections::BTreeSet;
use std::sync::OnceLock;

const PAGE: &str = include_str!("../../docs/language.md");
/// Headings of the tables that are read.
const TABLES: [&str; 2] = ["## Files", "## Statements of a layout"];
/// An outline for `[...]` in an example.
const OUTLINE: &str = "[(0 m, 0 m), (9 m, 0 m), (9 m, 4 m)]";

/// A row: forms of a statement, and what they mean.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// As written in the first column: `vertex P1 (2 m, 1.5 m) radius 4 m`.
    pub forms: Vec<String>,
    /// In Markdown; empty where the forms say it.
    pub meaning: String,
}

fn rows() -> &'static [Row] {
    static ROWS: OnceLock<Vec<Row>> = OnceLock::new();
    ROWS.get_or_init(|| {
        let tables = TABLES.iter().filter_map(|heading| {
            let (_, rest) = PAGE.split_once(&format!("{heading}\n"))?;
            Some(rest.split("\n## ").next().unwrap_or(rest))
        });
        tables.flat_map(|table| table.lines().filter_map(row)).collect()
    })
}

/// `| forms | meaning |`
fn row(line: &str) -> Option<Row> {
    let line = line.strip_prefix("| `")?.strip_suffix('|')?;
    let (forms, meaning) = line.split_once(" |")?;
    let forms = format!("`{forms}");
    let forms = forms.split('`').skip(1).step_by(2).map(str::to_owned).collect();
    Some(Row { forms, meaning: without_links(meaning.trim()) })
}

/// `[text](target)` as `text`: targets are relative to the page.
fn without_links(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some((before, linked)) = rest.split_once('[') {
        match linked.split_once("](").and_then(|(shown, behind)| Some((shown, behind.split_once(')')?.1))) {
            Some((shown, behind)) if !shown.contains('[') && !before.ends_with('`') => {
                out += before;
                out += shown;
                rest = behind;
            }
            _ => {
                out += before;
                out.push('[');
                rest = linked;
            }
        }
    }
    out + rest
}

/// The first word of a form.
fn head(form: &str) -> &str {
    form.split(|c: char| !super::text::in_name(c)).next().unwrap_or_default()
}

/// The rows that have forms of a word, in order, each with those forms first.
pub fn about(word: &str) -> Vec<(&'static Row, Vec<&'static str>)> {
    let word = if word == "optimize" { "optimise" } else { word };
    let of = |row: &'static Row| {
        let own: Vec<&str> = row.forms.iter().map(String::as_str).filter(|form| head(form) == word).collect();
        (!own.is_empty()).then_some((row, own))
    };
    rows().iter().filter_map(of).collect()
}

/// What a word that begins a line means, in Markdown.
pub fn meaning(word: &str) -> Option<String> {
    let all = about(word);
    let shown = all.iter().map(|(row, forms)| {
        let forms = forms.join("\n");
        let code = format!("```lss\n{forms}\n```");
        if row.meaning.is_empty() { code } else { format!("{code}\n\n{}", row.meaning) }
    });
    (!all.is_empty()).then(|| shown.collect::<Vec<_>>().join("\n\n"))
}

/// The first form of a word as a snippet, in which numbers and names are places to fill in.
pub fn snippet(word: &str) -> String {
    let form = about(word).into_iter().flat_map(|(_, forms)| forms).next().unwrap_or(word);
    let form = form.replace("[...]", OUTLINE).replace("[(0 m, 0 m), ...]", OUTLINE);
    let form = form.trim_end_matches("...").trim_end();
    let form = if form == word { format!("{word} ") } else { form.to_owned() };
    to_snippet(&form)
}

/// Every keyword there is.
fn keywords() -> &'static BTreeSet<String> {
    static WORDS: OnceLock<BTreeSet<String>> = OnceLock::new();
    WORDS.get_or_init(|| {
        let mut all: BTreeSet<String> = crate::syntax::keywords().map(str::to_owned).collect();
        all.extend(DeclarationKind::ALL.map(|k| k.word().to_owned()));
        all.extend(FixKind::ALL.map(|k| k.word().to_owned()));
        all.extend(Goal::ALL.map(|g| g.word().to_owned()));
        all.extend(SideWord::ALL.map(|s| s.word().to_owned()));
        all.extend(TitleField::ALL.map(|f| f.word().to_owned()));
        all.extend([Axis::X, Axis::Y].map(|a| a.word().to_owned()));
        all.extend(crate::semantics::vocabulary::functions().map(|f| f.name.to_owned()));
        all.insert("std".to_owned());
        all
    })
}

/// Whether a word is one of the language's.
pub fn is_keyword(word: &str) -> bool {
    keywords().contains(word)
}

/// Numbers, texts and names of an example as `${1:...}`.
pub fn to_snippet(form: &str) -> String {
    let mut out = String::new();
    let mut count = 0;
    let mut place = |out: &mut String, text: &str| {
        count += 1;
        out.push_str(&format!("${{{count}:{}}}", escaped(text)));
    };
    let mut rest = form;
    let mut after_number = false;
    while let Some(c) = rest.chars().next() {
        let taken = |inside: &dyn Fn(char) -> bool| rest.find(|c| !inside(c)).unwrap_or(rest.len());
        let width = match c {
            '[' if rest.starts_with(OUTLINE) => {
                place(&mut out, OUTLINE);
                OUTLINE.len()
            }
            '"' => {
                let end = rest[1..].find('"').map_or(rest.len(), |end| end + 2);
                out.push('"');
                place(&mut out, rest[1..end].trim_end_matches('"'));
                out.push('"');
                end
            }
            '0'..='9' => {
                let mut end = taken(&|c| c.is_ascii_digit() || c == '.');
                end = rest[..end].find("..").unwrap_or(end);
                place(&mut out, rest[..end].trim_end_matches('.'));
                after_number = true;
                out.push_str(&rest[rest[..end].trim_end_matches('.').len()..end]);
                rest = &rest[end..];
                continue;
            }
            // A unit goes on behind its signs: `m/s`.
            _ if after_number && c.is_ascii_alphabetic() => {
                let end = taken(&|c| super::text::in_name(c) || matches!(c, '/' | '*' | '^'));
                out.push_str(&escaped(&rest[..end]));
                end
            }
            _ if c.is_ascii_alphabetic() || c == '_' => {
                let end = taken(&super::text::in_name);
                let word = &rest[..end];
                if is_keyword(word) {
                    out.push_str(&escaped(word))
                } else {
                    place(&mut out, word)
                }
                end
            }
            _ => {
                out.push_str(&escaped(&rest[..c.len_utf8()]));
                rest = &rest[c.len_utf8()..];
                after_number &= c == ' ';
                continue;
            }
        };
        after_number = false;
        rest = &rest[width..];
    }
    out
}

/// A text within a snippet.
pub fn escaped(text: &str) -> String {
    text.replace('\\', "\\\\").replace('$', "\\$").replace('}', "\\}")
}

/// The words that may begin a line.
pub fn beginnings(context: Context) -> Vec<String> {
    let words = continuations(context, "").into_iter();
    words.filter_map(|next| if let Next::Word(word) = next { Some(word) } else { None }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_of_the_language_says_what_every_statement_means() {
        for context in [Context::Statement, Context::Item] {
            for word in beginnings(context) {
                let parts_of_a_cart = context == Context::Item && matches!(word.as_str(), "wheel" | "joint");
                assert!(parts_of_a_cart || meaning(&word).is_some(), "docs/language.md has no row for `{word}`");
            }
        }
        let vertex = meaning("vertex").unwrap();
        assert!(vertex.contains("vertex P1 (2 m, 1.5 m) radius 4 m") && vertex.contains("in driving order"));
        // No link is left that leads nowhere.
        assert!(rows().iter().all(|row| !row.meaning.contains("](")));
    }

    #[test]
    fn examples_become_snippets() {
        assert_eq!(snippet("vertex"), "vertex ${1:P1} (${2:2} m, ${3:1.5} m) radius ${4:4} m");
        assert_eq!(snippet("turns"), "turns ${1:5} deg .. ${2:90} deg");
        assert_eq!(snippet("speed"), "speed ${1:2.0} m/s");
        assert_eq!(snippet("pass"), "pass ${1:column} left");
        assert_eq!(snippet("motor"), "motor ");
        assert!(snippet("building").starts_with("building ${1:[(0 m, 0 m)"));
        assert_eq!(snippet("drawing"), "drawing origin (${1:2} m, ${2:1} m)");
    }
}
