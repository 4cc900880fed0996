//! Where in a text a cursor stands: in which blocks, behind what of a line. The text is half written, so that no tree
//! knows; brackets, texts and comments are all that is looked at.

use crate::editor::text::in_name;

/// A place between two characters of a text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cursor<'a> {
    /// The beginnings of the lines whose blocks it stands in, the outermost first: `layout plant `.
    pub blocks: Vec<&'a str>,
    /// The line up to the word that is being written.
    pub begun: &'a str,
    /// That word as far as it is there.
    pub partial: &'a str,
    /// What stands in quotes up to it, within a text.
    pub quoted: Option<&'a str>,
}

#[derive(Clone, Copy, PartialEq)]
enum Open<'a> {
    Block(&'a str),
    Bracket,
}

impl<'a> Cursor<'a> {
    /// `None` within a comment.
    pub fn new(text: &'a str, offset: usize) -> Option<Self> {
        let before = text.get(..offset)?;
        let bytes = before.as_bytes();
        let mut open: Vec<Open<'a>> = Vec::new();
        let mut line = 0;
        // The last character that is no space, for lists that go on in the next line.
        let mut last = b'\n';
        let mut at = 0;
        while at < bytes.len() {
            let byte = bytes[at];
            match byte {
                b'"' => {
                    let rest = &before[at + 1..];
                    let Some(end) = closing_quote(rest) else {
                        if rest.contains('\n') {
                            at += rest.find('\n').unwrap_or(0) + 1;
                            continue;
                        }
                        let begun = &before[line..at];
                        return Some(Cursor {
                            blocks: blocks(&open),
                            begun: begun.trim_start(),
                            partial: rest,
                            quoted: Some(rest),
                        });
                    };
                    at += end;
                }
                b'/' if bytes.get(at + 1) == Some(&b'/') => match before[at..].find('\n') {
                    Some(end) => {
                        at += end;
                        continue;
                    }
                    None => return None,
                },
                b'{' => {
                    open.retain(|o| *o != Open::Bracket);
                    open.push(Open::Block(before[line..at].trim()));
                    line = at + 1;
                }
                b'}' => {
                    while open.pop().is_some_and(|o| o == Open::Bracket) {}
                    line = at + 1;
                }
                b'(' | b'[' => open.push(Open::Bracket),
                b')' | b']' if open.last() == Some(&Open::Bracket) => {
                    open.pop();
                }
                b'\n' => {
                    let goes_on = open.last() == Some(&Open::Bracket)
                        && (matches!(last, b'(' | b'[' | b',') || text[at..].trim_start().starts_with([')', ']']));
                    if !goes_on {
                        open.retain(|o| *o != Open::Bracket);
                        // A brace may stand on the line behind.
                        if !text[at..].trim_start().starts_with('{') || last == b'\n' {
                            line = at + 1;
                        }
                    }
                }
                _ => {}
            }
            if !byte.is_ascii_whitespace() || byte == b'\n' && line == at + 1 {
                last = byte;
            }
            at += 1;
        }
        let begun = before[line..].trim_start();
        let partial = &begun[begun.trim_end_matches(in_name).len()..];
        // `1250m`: a unit is being written.
        let digits = partial.len() - partial.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        let partial = &partial[digits..];
        Some(Cursor { blocks: blocks(&open), begun: &begun[..begun.len() - partial.len()], partial, quoted: None })
    }
}

fn blocks<'a>(open: &[Open<'a>]) -> Vec<&'a str> {
    open.iter().filter_map(|o| if let Open::Block(head) = o { Some(*head) } else { None }).collect()
}

/// The closing quote of a text on its line.
fn closing_quote(rest: &str) -> Option<usize> {
    let mut escaped = false;
    for (at, c) in rest.char_indices() {
        match c {
            '\n' => return None,
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            '"' => return Some(at + 1),
            _ => {}
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(marked: &str) -> Option<(Vec<String>, String, String)> {
        let offset = marked.find('|').unwrap();
        let text = marked.replace('|', "");
        let cursor = Cursor::new(&text, offset)?;
        let blocks = cursor.blocks.iter().map(|b| (*b).to_owned()).collect();
        Some((blocks, cursor.begun.to_owned(), cursor.partial.to_owned()))
    }

    fn own(blocks: &[&str], begun: &str, partial: &str) -> Option<(Vec<String>, String, String)> {
        Some((blocks.iter().map(|b| (*b).to_owned()).collect(), begun.to_owned(), partial.to_owned()))
    }

    #[test]
    fn a_cursor_knows_its_block_and_its_line() {
        assert_eq!(at("lay|"), own(&[], "", "lay"));
        assert_eq!(at("layout a {\n  speed 2 m/s\n  ver|\n}"), own(&["layout a"], "", "ver"));
        assert_eq!(at("layout a {\n  fix length P1..P|\n"), own(&["layout a"], "fix length P1..", "P"));
        assert_eq!(
            at("catalog c from s {\n straight { stock = |"),
            own(&["catalog c from s", "straight"], "stock = ", "")
        );
        assert_eq!(at("let a = 1 m\n// layout b {\n|"), own(&[], "", ""));
        assert_eq!(at("cart c(length: 1250m|"), own(&[], "cart c(length: 1250", "m"));
        assert_eq!(at("layout a\n{\n  |"), own(&["layout a"], "", ""));
        assert_eq!(at("// a|"), None);
        assert_eq!(at("layout a {\n  drawing project \"x\"\n  spe|\n}"), own(&["layout a"], "", "spe"));
        assert_eq!(
            at("layout a {\n  require length(A..B) >= 1 m \"room\"|"),
            own(&["layout a"], "require length(A..B) >= 1 m \"room\"", "")
        );
    }

    #[test]
    fn lists_go_on_over_lines_and_forgotten_brackets_do_not() {
        let (blocks, begun, _) = at("layout a {\n  building [\n    (0 m, 0 m),\n    (9 m, |").unwrap();
        assert_eq!((blocks.len(), begun.starts_with("building [")), (1, true));
        assert_eq!(at("layout a {\n  vertex P1 (2 m\n  ver|\n}"), own(&["layout a"], "", "ver"));
        assert_eq!(at("layout a {\n  axis \"A\n  ver|\n}").map(|c| c.2), Some("ver".to_owned()));
        assert_eq!(at("use \"sha|").map(|c| c.1), Some("use ".to_owned()));
    }
}
