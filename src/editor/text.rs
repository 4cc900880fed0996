//! Places in a text as the protocol counts them, and edits of a text.

use crate::source::{SourceFile, Span};
use lsp_types::{Position, PositionEncodingKind, Range, TextDocumentContentChangeEvent};
use std::borrow::Cow;

/// What characters of a line are counted in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    Utf8,
    Utf16,
}

impl Encoding {
    /// Bytes where the client can count them, else the protocol's own UTF-16.
    pub fn of(offered: Option<&[PositionEncodingKind]>) -> Encoding {
        match offered.is_some_and(|all| all.contains(&PositionEncodingKind::UTF8)) {
            true => Encoding::Utf8,
            false => Encoding::Utf16,
        }
    }

    pub fn kind(self) -> PositionEncodingKind {
        match self {
            Encoding::Utf8 => PositionEncodingKind::UTF8,
            Encoding::Utf16 => PositionEncodingKind::UTF16,
        }
    }

    fn width(self, c: char) -> usize {
        match self {
            Encoding::Utf8 => c.len_utf8(),
            Encoding::Utf16 => c.len_utf16(),
        }
    }
}

/// A text with the beginnings of its lines.
#[derive(Clone, Debug)]
pub struct Lines<'a> {
    text: &'a str,
    starts: Cow<'a, [u32]>,
    encoding: Encoding,
}

impl<'a> Lines<'a> {
    pub fn new(text: &'a str, encoding: Encoding) -> Self {
        let breaks = text.match_indices('\n').map(|(at, _)| at as u32 + 1);
        Lines { text, starts: std::iter::once(0).chain(breaks).collect(), encoding }
    }

    /// The same of a file whose lines are known.
    pub fn of_file(file: &'a SourceFile, encoding: Encoding) -> Self {
        Lines { text: &file.text, starts: Cow::Borrowed(file.line_starts()), encoding }
    }

    pub fn text(&self) -> &'a str {
        self.text
    }

    pub fn count(&self) -> usize {
        self.starts.len()
    }

    /// A line without its break, and where it begins.
    pub fn line(&self, number: usize) -> Option<(usize, &'a str)> {
        let start = *self.starts.get(number)? as usize;
        let end = self.starts.get(number + 1).map_or(self.text.len(), |next| *next as usize - 1);
        let line = &self.text[start..end];
        Some((start, line.strip_suffix('\r').unwrap_or(line)))
    }

    /// The byte of a position. One beyond the end of its line is that end, one beyond the last line the text's end, and
    /// one within a character its beginning.
    pub fn offset(&self, position: Position) -> usize {
        let Some((start, line)) = self.line(position.line as usize) else { return self.text.len() };
        let mut left = position.character as usize;
        for (at, c) in line.char_indices() {
            let width = self.encoding.width(c);
            if left < width {
                return start + at;
            }
            left -= width;
        }
        start + line.len()
    }

    pub fn position(&self, offset: usize) -> Position {
        let offset = offset.min(self.text.len());
        let line = self.starts.partition_point(|start| *start as usize <= offset) - 1;
        let before = self.text.get(self.starts[line] as usize..offset).unwrap_or_default();
        let character: usize = before.chars().map(|c| self.encoding.width(c)).sum();
        Position::new(line as u32, character as u32)
    }

    pub fn range(&self, start: usize, end: usize) -> Range {
        Range::new(self.position(start), self.position(end))
    }

    pub fn of_span(&self, span: Span) -> Range {
        self.range(span.start as usize, span.end as usize)
    }
}

/// Does a client's edits one after the other.
pub fn edit(text: &mut String, changes: Vec<TextDocumentContentChangeEvent>, encoding: Encoding) {
    for change in changes {
        let Some(range) = change.range else {
            *text = change.text;
            continue;
        };
        let lines = Lines::new(text, encoding);
        let (a, b) = (lines.offset(range.start), lines.offset(range.end));
        text.replace_range(a.min(b)..a.max(b), &change.text);
    }
}

/// Whether a character can stand in a name.
pub fn in_name(c: char) -> bool {
    c.is_ascii_alphanumeric() || c == '_'
}

/// Whether a text is a name.
pub fn is_name(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') && text.chars().all(in_name)
}

/// The word around a byte, and where it begins.
pub fn word_at(text: &str, offset: usize) -> (usize, &str) {
    let (Some(before), Some(behind)) = (text.get(..offset), text.get(offset..)) else { return (offset, "") };
    let start = before.trim_end_matches(in_name).len();
    let end = text.len() - behind.trim_start_matches(in_name).len();
    (start, &text[start..end])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_count_what_was_agreed() {
        let text = "// ä 🚚\r\nlet a = 1 m\n";
        let utf16 = Lines::new(text, Encoding::Utf16);
        let utf8 = Lines::new(text, Encoding::Utf8);
        let truck = text.find('🚚').unwrap();
        assert_eq!(utf16.position(truck), Position::new(0, 5));
        assert_eq!(utf16.position(truck + 4), Position::new(0, 7));
        assert_eq!(utf8.position(truck), Position::new(0, 6));
        for lines in [&utf16, &utf8] {
            for (at, _) in text.char_indices().filter(|(_, c)| !matches!(c, '\r' | '\n')) {
                assert_eq!(lines.offset(lines.position(at)), at);
            }
        }
        // Within a character, behind a line, behind the text.
        assert_eq!(utf16.offset(Position::new(0, 6)), truck);
        assert_eq!(utf16.offset(Position::new(0, 99)), text.find('\r').unwrap());
        assert_eq!(utf16.offset(Position::new(99, 0)), text.len());
    }

    #[test]
    fn edits_are_done_in_order() {
        let mut text = "let a = 1 m\nlet b = 🚚\n".to_owned();
        let change = |line, from, to, with: &str| TextDocumentContentChangeEvent {
            range: Some(Range::new(Position::new(line, from), Position::new(line, to))),
            range_length: None,
            text: with.to_owned(),
        };
        edit(&mut text, vec![change(1, 8, 10, "2 m"), change(0, 8, 9, "17")], Encoding::Utf16);
        assert_eq!(text, "let a = 17 m\nlet b = 2 m\n");
        let all = TextDocumentContentChangeEvent { range: None, range_length: None, text: "x".to_owned() };
        edit(&mut text, vec![all, change(9, 9, 9, "y")], Encoding::Utf16);
        assert_eq!(text, "xy");
    }

    #[test]
    fn words_are_found_at_both_ends() {
        assert_eq!(word_at("fix P1..P2", 4), (4, "P1"));
        assert_eq!(word_at("fix P1..P2", 6), (4, "P1"));
        assert_eq!(word_at("ä", 1), (1, ""));
    }
}
