//! Tests of the stage as a whole: trees, messages, the formatter, and hostile or damaged input.

mod formatting;
mod limits;
mod mistakes;
mod properties;
mod trees;

use super::tree::Tree;
use super::{format, parse};
use crate::diagnostic::Diagnostic;
use crate::source::{FileId, SourceMap};

/// A file with every statement and a comment at every place.
const EVERYTHING: &str = include_str!("corpus/everything.lss");
/// The sample of the language guide, written without regard to the formatter.
const TERMINAL: &str = include_str!("corpus/terminal.lss");

fn read(text: &str) -> (Tree, Vec<Diagnostic>) {
    parse(FileId(0), text)
}

/// Parses a text that has to be free of mistakes.
fn clean(text: &str) -> Tree {
    let (tree, problems) = read(text);
    assert!(problems.is_empty(), "{}", shown(text, &problems));
    tree
}

fn formatted(text: &str) -> String {
    format(&clean(text), text)
}

/// A tree without spans and without what the formatter may change: blank lines and the spreading of lists.
fn bare(tree: &Tree) -> String {
    let mut out = String::new();
    let mut skip = None;
    for line in format!("{:#?}", tree.items).lines() {
        let indent = line.len() - line.trim_start().len();
        match skip {
            Some(depth) if indent > depth => continue,
            Some(_) => {
                skip = None;
                continue;
            }
            None => {}
        }
        let word = line.trim_start();
        if word.ends_with("Span {") {
            skip = Some(indent);
        } else if !word.starts_with("multiline:") && !word.starts_with("blank_before:") && word != "\"\"," {
            out.push_str(line);
            out.push('\n');
        }
    }
    out
}

/// Messages as a reader sees them, each with what it points at.
fn shown(text: &str, problems: &[Diagnostic]) -> String {
    let mut sources = SourceMap::default();
    let file = sources.add("test.lss", text);
    let mut out = String::new();
    for problem in problems {
        let span = problem.label.span;
        let (line, column) = sources.file(file).line_column(span.start);
        let at = sources.text(span);
        out.push_str(&format!("{line}:{column} {} {}\n", problem.code.as_str(), problem.message));
        out.push_str(&format!("    `{at}`: {}\n", problem.label.text));
        for label in &problem.related {
            let (line, column) = sources.file(file).line_column(label.span.start);
            out.push_str(&format!("    {line}:{column} `{}`: {}\n", sources.text(label.span), label.text));
        }
        if let Some(help) = &problem.help {
            out.push_str(&format!("    help: {help}\n"));
        }
        if let Some(fix) = &problem.fix {
            out.push_str(&format!("    fix: `{}` -> `{}`\n", sources.text(fix.span), fix.replacement.escape_debug()));
        }
    }
    out
}
