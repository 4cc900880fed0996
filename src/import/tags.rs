//! The text of a DXF file as tags: a line with a group code and a line with its value (AutoCAD DXF Reference).

use crate::diagnostic::{Code, Diagnostic};
use crate::source::{FileId, Span};

/// A group code with its value and the value's place.
#[derive(Clone, Copy, Debug)]
pub struct Tag<'a> {
    pub code: i32,
    pub value: &'a str,
    pub span: Span,
}

/// Coordinates beyond this are nonsense in any unit, and would overflow.
const LARGEST: f64 = 1e12;

impl Tag<'_> {
    pub fn is(&self, code: i32, value: &str) -> bool {
        self.code == code && self.value.eq_ignore_ascii_case(value)
    }

    pub fn real(&self) -> Result<f64, Box<Diagnostic>> {
        match self.value.parse::<f64>() {
            Ok(value) if value.abs() <= LARGEST => Ok(value),
            _ => Err(Box::new(broken(self.span, "this should be a number", "a number", self.value))),
        }
    }

    pub fn int(&self) -> Result<i64, Box<Diagnostic>> {
        let number = self.value.parse::<i64>();
        number.map_err(|_| Box::new(broken(self.span, "this should be a whole number", "a whole number", self.value)))
    }
}

/// The tags up to `EOF`, without comments.
pub fn tags(file: FileId, text: &str) -> Result<Vec<Tag<'_>>, Box<Diagnostic>> {
    let mut lines = Lines { text, at: 0 };
    let mut tags = Vec::new();
    loop {
        let Some((start, word)) = lines.next() else {
            return Err(Box::new(cut_off(file, text)));
        };
        let here = Span::new(file, start, start + word.len());
        let Ok(code) = word.parse::<i32>() else {
            // Blank lines after the last tag are common.
            if word.is_empty() && text[start..].trim().is_empty() {
                return Err(Box::new(cut_off(file, text)));
            }
            return Err(Box::new(
                broken(here, "this should be a group code", "a whole number", word)
                    .help("save the drawing as DXF again, as ASCII text"),
            ));
        };
        let Some((start, value)) = lines.next() else {
            return Err(Box::new(cut_off(file, text)));
        };
        let tag = Tag { code, value, span: Span::new(file, start, start + value.len()) };
        if tag.is(0, "EOF") {
            return Ok(tags);
        }
        if code != 999 {
            tags.push(tag);
        }
    }
}

/// Why a file is no DXF text at all, by its first bytes.
pub fn other_format(text: &str) -> Option<&'static str> {
    if text.starts_with("AutoCAD Binary DXF") {
        return Some("a binary DXF file");
    }
    let mut head = text.bytes();
    let signature = head.next() == Some(b'A') && head.next() == Some(b'C') && head.next().is_some_and(|b| b == b'1');
    signature.then_some("a DWG file")
}

fn broken(span: Span, message: &str, expected: &str, found: &str) -> Diagnostic {
    let found: String = found.chars().filter(|c| !c.is_control()).take(40).collect();
    let found = if found.is_empty() { "an empty line".to_string() } else { format!("`{found}`") };
    Diagnostic::new(Code::E0801, message, span, "not readable").expected(expected, found)
}

fn cut_off(file: FileId, text: &str) -> Diagnostic {
    let end = text.trim_end().len();
    let start = text[..end].rfind('\n').map_or(0, |i| i + 1);
    Diagnostic::new(Code::E0801, "the drawing is cut off", Span::new(file, start, end), "the last line")
        .expected("`EOF` at the end", "the end of the file")
        .help("save the drawing as DXF again, as ASCII text")
}

/// Lines without the blanks around them, with the place where they begin.
struct Lines<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Iterator for Lines<'a> {
    type Item = (usize, &'a str);

    fn next(&mut self) -> Option<Self::Item> {
        let rest = self.text.get(self.at..).filter(|rest| !rest.is_empty())?;
        let line = rest.split('\n').next().unwrap_or(rest);
        let start = self.at + (line.len() - line.trim_start().len());
        self.at += line.len() + 1;
        Some((start, line.trim()))
    }
}
