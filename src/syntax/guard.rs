//! What is checked before the grammar sees a text: size, stray characters, quotes and brackets.
//!
//! One linear pass. Whatever is unbalanced is reported at its opener and fixed by an [`Edit`], so that the grammar
//! always works on balanced text of bounded nesting: its recursion is safe, and one forgotten bracket does not hide
//! the rest of the file.

use super::MAX_REPORTS;
use super::expected::STATEMENT_WORDS;
use super::origin::Edit;
use crate::diagnostic::{Code, Diagnostic};
use crate::source::{FileId, Span};

/// The largest source, in bytes.
pub const MAX_BYTES: usize = 8 << 20;
/// How deep brackets may nest.
pub const MAX_DEPTH: usize = 64;

/// What the guard found.
#[derive(Debug, Default)]
pub struct Verdict {
    pub diagnostics: Vec<Diagnostic>,
    /// Problems beyond those that are reported one by one.
    pub dropped: usize,
    /// Repairs that balance the text.
    pub edits: Vec<Edit>,
    /// The text cannot be parsed at all.
    pub fatal: bool,
}

/// Checks a text.
pub fn check(file: FileId, text: &str) -> Verdict {
    if text.len() > MAX_BYTES {
        let message = format!("the file has {} MiB; at most {} MiB are read", text.len() >> 20, MAX_BYTES >> 20);
        let problem = Diagnostic::new(Code::E0106, message, Span::new(file, 0, 0), "this file")
            .help("split it into several files and import them with `use`");
        return Verdict { diagnostics: vec![problem], fatal: true, ..Verdict::default() };
    }
    let mut guard = Guard {
        file,
        text,
        verdict: Verdict::default(),
        open: Vec::new(),
        significant: 0,
        line_start: true,
        line_has_code: false,
    };
    guard.run();
    guard.verdict
}

/// An opening bracket that waits for its closer.
struct Open {
    at: usize,
    bracket: u8,
    /// Where the closer belongs if none is found: the end of the first line that does not go on.
    belongs: Option<usize>,
}

struct Guard<'a> {
    file: FileId,
    text: &'a str,
    verdict: Verdict,
    open: Vec<Open>,
    /// End of the last byte that is neither blank nor comment.
    significant: usize,
    line_start: bool,
    line_has_code: bool,
}

impl Guard<'_> {
    fn run(&mut self) {
        let bytes = self.text.as_bytes();
        let mut at = if self.text.starts_with('\u{FEFF}') { '\u{FEFF}'.len_utf8() } else { 0 };
        while let Some(&byte) = bytes.get(at) {
            if self.verdict.fatal {
                return;
            }
            if self.line_start && byte.is_ascii_alphabetic() && !self.open.is_empty() {
                self.new_line(at);
            }
            self.line_start = byte == b'\n' || (self.line_start && matches!(byte, b' ' | b'\t'));
            at = match byte {
                b'\n' => {
                    self.end_of_line();
                    at + 1
                }
                b' ' | b'\t' => at + 1,
                b'\r' if bytes.get(at + 1) == Some(&b'\n') => at + 1,
                b'/' if bytes.get(at + 1) == Some(&b'/') => self.comment(at),
                b'"' => self.text(at),
                _ => {
                    let after = self.plain(at, byte);
                    if self.significant == after {
                        self.line_has_code = true;
                    }
                    after
                }
            };
        }
        self.end_of_line();
        self.close_down_to(0, self.text.len(), None);
    }

    /// A byte outside comments and quotes; returns the position after its character.
    fn plain(&mut self, at: usize, byte: u8) -> usize {
        if byte.is_ascii_graphic() {
            self.significant = at + 1;
            match byte {
                b'(' | b'[' | b'{' => self.opener(at, byte),
                b')' | b']' | b'}' => self.closer(at, byte),
                _ => {}
            }
            return at + 1;
        }
        let stray = self.stray_run(at, is_stray);
        if stray > at {
            return stray;
        }
        let width = self.text[at..].chars().next().map_or(1, char::len_utf8);
        self.significant = at + width;
        at + width
    }

    /// Skips a comment, up to its newline.
    fn comment(&mut self, at: usize) -> usize {
        self.inside(at, |c| c == '\n')
    }

    /// Skips a text in quotes; one that is not closed on its line is reported and closed.
    fn text(&mut self, at: usize) -> usize {
        let mut escaped = false;
        let end = self.inside(at + 1, |c| match c {
            '\n' => true,
            '"' if !escaped => true,
            _ => {
                escaped = c == '\\' && !escaped;
                false
            }
        });
        self.line_has_code = true;
        if self.text.as_bytes().get(end) == Some(&b'"') {
            self.significant = end + 1;
            return end + 1;
        }
        let written = self.text[at..end].trim_end();
        let end_of_text = at + written.len();
        let opener = self.span(at, at + 1);
        let problem = Diagnostic::new(Code::E0104, "a text in quotes is not closed", opener, "starts here")
            .help("a text ends on the line it starts on, with `\"`")
            .fix(self.span(end_of_text, end_of_text), "\"");
        self.report(problem);
        // A backslash at the end would escape the quote that is put in.
        let inserted = if escaped { "\\\"" } else { "\"" };
        self.edit(end_of_text, 0, inserted);
        self.significant = end_of_text;
        end
    }

    /// Goes over comment or quoted text until `stop`, where only control characters are out of place.
    fn inside(&mut self, from: usize, mut stop: impl FnMut(char) -> bool) -> usize {
        let mut at = from;
        while let Some(c) = self.text[at..].chars().next() {
            if stop(c) {
                break;
            }
            if is_control(c) && !self.text[at..].starts_with("\r\n") {
                at = self.stray_run(at, is_control);
            } else {
                at += c.len_utf8();
            }
        }
        at
    }

    /// Reports a run of stray characters as one and takes it out.
    fn stray_run(&mut self, at: usize, stray: fn(char) -> bool) -> usize {
        let mut end = at;
        for c in self.text[at..].chars() {
            if !stray(c) || self.text[end..].starts_with("\r\n") {
                break;
            }
            end += c.len_utf8();
        }
        let Some(first) = self.text[at..end].chars().next() else { return at };
        let space = first == '\r' || (first.is_whitespace() && !is_control(first));
        let what = match first {
            '\0' => "a NUL byte".to_string(),
            '\r' => "a carriage return without a line feed".to_string(),
            '\u{FEFF}' => "a byte order mark inside the file".to_string(),
            _ if space => format!("an unusual space (U+{:04X})", u32::from(first)),
            _ => format!("an invisible character (U+{:04X})", u32::from(first)),
        };
        let replacement = if space { " " } else { "" };
        let span = self.span(at, end);
        self.report(
            Diagnostic::new(Code::E0107, format!("the text holds {what}"), span, "here").fix(span, replacement),
        );
        self.edit(at, end - at, replacement);
        end
    }

    fn opener(&mut self, at: usize, bracket: u8) {
        self.open.push(Open { at, bracket, belongs: None });
        if self.open.len() > MAX_DEPTH {
            let message = format!("brackets nest more than {MAX_DEPTH} deep");
            let problem = Diagnostic::new(Code::E0105, message, self.span(at, at + 1), "one too many")
                .help("name the inner parts with `let`");
            self.report(problem);
            self.verdict.fatal = true;
        }
    }

    fn closer(&mut self, at: usize, bracket: u8) {
        let wanted = opening(bracket);
        match self.open.iter().rposition(|open| open.bracket == wanted) {
            Some(depth) => {
                self.close_down_to(depth + 1, at, Some(at));
                self.open.pop();
            }
            None => {
                let message = format!("`{}` closes nothing", char::from(bracket));
                let span = self.span(at, at + 1);
                self.report(Diagnostic::new(Code::E0109, message, span, "no bracket is open here").fix(span, ""));
                self.edit(at, 1, " ");
            }
        }
    }

    /// Takes every bracket above `depth` for forgotten: reports it and closes it where it belongs, at `at` at the
    /// latest.
    fn close_down_to(&mut self, depth: usize, at: usize, instead: Option<usize>) {
        let mut belongs = None;
        while self.open.len() > depth {
            let Some(open) = self.open.pop() else { return };
            let end = if open.bracket == b'{' { at } else { self.significant.clamp(open.at + 1, at) };
            let here = open.belongs.or(belongs).unwrap_or(end);
            belongs = Some(here);
            let closing = closing(open.bracket);
            let message = format!("`{}` is never closed", char::from(open.bracket));
            // A list that ends with its line is not still open at what comes below.
            let instead = instead.filter(|_| open.belongs.is_none());
            let found = match instead {
                Some(instead) => self.found(instead),
                None if open.belongs.is_some() => "the end of the line".to_string(),
                None => "the end of the file".to_string(),
            };
            let opener = self.span(open.at, open.at + 1);
            let mut problem =
                Diagnostic::new(Code::E0103, message, opener, "opened here").expected(format!("`{closing}`"), found);
            if let Some(instead) = instead {
                let width = self.word(instead).len().max(1);
                problem = problem.related(self.span(instead, instead + width), "still open here");
            }
            if open.bracket == b'{' {
                self.edit(here, 0, "\n}\n");
            } else {
                problem = problem.fix(self.span(here, here), closing.to_string());
                self.edit(here, 0, &closing.to_string());
            }
            self.report(problem);
        }
    }

    /// Notes where an open list ends if its closer never comes: it goes on only after a comma or an opener.
    fn end_of_line(&mut self) {
        let goes_on = matches!(self.text.as_bytes().get(self.significant.wrapping_sub(1)), Some(b',' | b'(' | b'['));
        if let Some(open) = self.open.last_mut()
            && self.line_has_code
            && open.bracket != b'{'
            && open.belongs.is_none()
            && !goes_on
        {
            open.belongs = Some(self.significant.max(open.at + 1));
        }
        self.line_has_code = false;
    }

    /// What starts here cannot stand inside of brackets that are still open: these were forgotten.
    fn new_line(&mut self, at: usize) {
        let word = self.word(at);
        let rest = &self.text[at + word.len()..];
        let next = rest.trim_start_matches([' ', '\t']);
        let name = next.len() < rest.len() && next.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
        let unindented = at == 0 || self.text.as_bytes().get(at - 1) == Some(&b'\n');
        let declaration = match word {
            "layout" => name,
            "use" => name || next.starts_with('"'),
            _ => false,
        };
        if unindented && declaration {
            self.close_down_to(0, at, Some(at));
            return;
        }
        // A word, a blank and another word or number: no element of a list looks like that, but statements do.
        let statement = STATEMENT_WORDS.contains(&word)
            && next.len() < rest.len()
            && next.starts_with(|c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '[' | '.'));
        let field = next.starts_with('=') && !next.starts_with("==");
        // With less to go by, the list must have ended on a line before.
        let ended = self.open.last().is_some_and(|open| open.belongs.is_some());
        let bare = STATEMENT_WORDS.contains(&word) && next.starts_with(['\r', '\n', '(', '-']);
        if statement || ((field || bare) && ended) {
            let depth = self.open.iter().rposition(|open| open.bracket == b'{').map_or(0, |brace| brace + 1);
            self.close_down_to(depth, at, Some(at));
        }
    }

    fn found(&self, at: usize) -> String {
        match self.word(at) {
            "" => format!("`{}`", self.text[at..].chars().next().unwrap_or(' ')),
            word => format!("`{word}`"),
        }
    }

    fn word(&self, at: usize) -> &str {
        let rest = &self.text[at..];
        &rest[..rest.bytes().take_while(|b| b.is_ascii_alphanumeric() || *b == b'_').count()]
    }

    fn edit(&mut self, at: usize, removed: usize, inserted: &str) {
        self.verdict.edits.push(Edit { at, removed, inserted: inserted.to_string() });
    }

    fn report(&mut self, problem: Diagnostic) {
        if self.verdict.diagnostics.len() < MAX_REPORTS || self.verdict.fatal {
            self.verdict.diagnostics.push(problem);
        } else {
            self.verdict.dropped += 1;
        }
    }

    fn span(&self, start: usize, end: usize) -> Span {
        Span::new(self.file, start, end)
    }
}

fn opening(closer: u8) -> u8 {
    match closer {
        b')' => b'(',
        b']' => b'[',
        _ => b'{',
    }
}

fn closing(opener: u8) -> char {
    match opener {
        b'(' => ')',
        b'[' => ']',
        _ => '}',
    }
}

/// Characters that show nothing and do not belong anywhere, not even into a comment: controls and what turns the
/// direction of writing.
fn is_control(c: char) -> bool {
    (c.is_control() && !matches!(c, '\n' | '\t')) || matches!(c, '\u{202A}'..='\u{202E}' | '\u{2066}'..='\u{2069}')
}

/// Characters that look like a space, or like nothing, between tokens.
fn is_stray(c: char) -> bool {
    is_control(c)
        || matches!(c, '\u{200B}'..='\u{200F}' | '\u{2060}' | '\u{FEFF}')
        || (c.is_whitespace() && !matches!(c, ' ' | '\t' | '\n'))
}
