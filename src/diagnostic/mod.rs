//! One type for everything the compiler has to say about an input.
//!
//! Stages collect [`Diagnostic`]s instead of stopping at the first; `text` renders them for people and
//! `json` for machines. Every [`Code`] is stable and has a page, shown by `lss explain`.

mod code;
mod excerpt;
pub mod json;
pub mod text;

pub use code::Code;

use crate::source::Span;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    Error,
    Warning,
}

/// A place and what is to be said about it.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    pub span: Span,
    pub text: String,
}

/// A replacement that would fix the problem.
#[derive(Clone, Debug, PartialEq)]
pub struct Fix {
    pub span: Span,
    pub replacement: String,
}

/// One problem: what is wrong, where, what was expected and found, and a way out.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    pub code: Code,
    /// One sentence, lower case, without a full stop.
    pub message: String,
    /// The place that has to change.
    pub label: Label,
    /// Other places that take part (a first declaration, a contradicting line).
    pub related: Vec<Label>,
    pub expected: Option<String>,
    pub found: Option<String>,
    pub help: Option<String>,
    pub fix: Option<Fix>,
}

impl Diagnostic {
    pub fn new(code: Code, message: impl Into<String>, span: Span, label: impl Into<String>) -> Self {
        Diagnostic {
            code,
            message: message.into(),
            label: Label { span, text: label.into() },
            related: Vec::new(),
            expected: None,
            found: None,
            help: None,
            fix: None,
        }
    }

    pub fn expected(mut self, expected: impl Into<String>, found: impl Into<String>) -> Self {
        self.expected = Some(expected.into());
        self.found = Some(found.into());
        self
    }

    pub fn related(mut self, span: Span, text: impl Into<String>) -> Self {
        self.related.push(Label { span, text: text.into() });
        self
    }

    pub fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    pub fn fix(mut self, span: Span, replacement: impl Into<String>) -> Self {
        self.fix = Some(Fix { span, replacement: replacement.into() });
        self
    }

    /// The other places that take part, without what only says again what is said of the main one.
    pub fn others(&self) -> impl Iterator<Item = &Label> {
        self.related.iter().filter(|label| **label != self.label)
    }

    pub fn severity(&self) -> Severity {
        self.code.severity()
    }

    pub fn is_error(&self) -> bool {
        self.severity() == Severity::Error
    }
}
