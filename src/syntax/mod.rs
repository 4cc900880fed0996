//! Text to tree (pest, grammar in `grammar/lss.pest`) and tree to text (the formatter).
//!
//! [`parse`] never fails: it gives a tree with everything that could be read and a diagnostic for each independent
//! mistake. It goes through three steps: `guard` looks at characters and brackets, pest parses, `build` makes the tree
//! from pest's pairs and hands what did not parse to `recover`, which finds the message and, if the mistake can be
//! fixed, the statement that was meant.

mod build;
mod continuation;
mod expected;
mod expression;
mod format;
mod guard;
mod hints;
mod import_place;
mod nearest;
mod origin;
mod recover;
mod statement;
mod token;
pub mod tree;
mod words;

#[cfg(test)]
mod tests;

pub use continuation::{Next, continuations};
pub use expected::{Context, keywords, value_example};
pub use format::format;
pub use guard::{MAX_BYTES, MAX_DEPTH};
pub use nearest::{by_likeness, nearest};

use crate::diagnostic::{Code, Diagnostic};
use crate::source::{FileId, Span};
use build::Builder;
use origin::Origin;
use pest::Parser;
use tree::{Block, Tree};

/// As many mistakes as are reported for one file.
pub const MAX_REPORTS: usize = 50;

// pest_derive makes these public and without documentation.
#[allow(missing_docs)]
mod grammar {
    #[derive(pest_derive::Parser)]
    #[grammar = "grammar/lss.pest"]
    pub struct Grammar;
}
use grammar::{Grammar, Rule};

/// Parses a file. The tree has everything that could be read; what could not is `Bad` in it and in the diagnostics.
pub fn parse(file: FileId, text: &str) -> (Tree, Vec<Diagnostic>) {
    let verdict = guard::check(file, text);
    let mut report = Report::new(file, &verdict);
    let items = if verdict.fatal {
        None
    } else if verdict.edits.is_empty() {
        items(file, text, &Origin::default(), &mut report)
    } else {
        let mut origin = Origin::default();
        let fixed = origin.edit(text, verdict.edits);
        // Fixing must leave nothing to fix: the grammar relies on it.
        let balanced = guard::check(file, &fixed).edits.is_empty();
        if balanced { items(file, &fixed, &origin, &mut report) } else { None }
    };
    let items = items.unwrap_or_else(|| Block::absent(Span::new(file, 0, 0)));
    (Tree { file, items }, report.finish())
}

fn items(file: FileId, text: &str, origin: &Origin, report: &mut Report) -> Option<Block<tree::Item>> {
    match Grammar::parse(Rule::file, text) {
        Ok(mut pairs) => {
            let pair = pairs.next()?;
            Some(Builder { file, text, origin, report }.items(pair))
        }
        Err(error) => {
            let failure = expected::Failure::new(text, &error);
            report.add(failure.diagnostic(expected::Context::Item, text, |from, to| {
                Span::new(file, origin.back(from), origin.back(to))
            }));
            None
        }
    }
}

/// The diagnostics of one parse.
struct Report {
    file: FileId,
    diagnostics: Vec<Diagnostic>,
    /// Where the guard fixed the text: what does not parse there has been reported.
    fixed: Vec<usize>,
    /// Mistakes that were not looked at any more.
    dropped: usize,
    /// Whether a statement outside of a layout has been reported; one such message is enough.
    outside: bool,
    /// How many bad lines are being looked into, one inside the other.
    nested: usize,
}

impl Report {
    fn new(file: FileId, verdict: &guard::Verdict) -> Self {
        let mut fixed: Vec<usize> = verdict.edits.iter().map(|edit| edit.at).collect();
        fixed.sort_unstable();
        let diagnostics = verdict.diagnostics.clone();
        Report { file, diagnostics, fixed, dropped: verdict.dropped, outside: false, nested: 0 }
    }

    fn is_full(&self) -> bool {
        self.diagnostics.len() >= MAX_REPORTS
    }

    fn add(&mut self, diagnostic: Diagnostic) {
        if self.is_full() {
            self.dropped += 1;
        } else {
            self.diagnostics.push(diagnostic);
        }
    }

    /// Adds the message that a statement stands outside of a layout, once.
    fn add_outside(&mut self, diagnostic: Diagnostic) {
        if !std::mem::replace(&mut self.outside, true) {
            self.add(diagnostic);
        }
    }

    /// Whether the guard has already reported something in this range of the user's text.
    fn covers(&self, start: usize, end: usize) -> bool {
        let first = self.fixed.partition_point(|&at| at < start);
        self.fixed.get(first).is_some_and(|&at| at <= end)
    }

    fn finish(mut self) -> Vec<Diagnostic> {
        self.diagnostics.sort_by_key(|diagnostic| (diagnostic.label.span.start, diagnostic.code));
        if self.dropped > 0 {
            let last = self.diagnostics.last().map_or(Span::new(self.file, 0, 0), |last| last.label.span);
            let message = format!("only the first {MAX_REPORTS} mistakes are shown");
            self.diagnostics.push(
                Diagnostic::new(Code::E0112, message, last, "the last one shown")
                    .help(format!("{} more wait; fix these first", self.dropped)),
            );
        }
        self.diagnostics
    }
}
