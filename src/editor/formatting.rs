//! The formatter, as edits of the lines that it changes.

use super::text::Lines;
use crate::source::FileId;
use crate::syntax;
use diffy::{DiffOptions, Line};
use lsp_types::{Range, TextEdit};

/// The edits that format a text; `None` of one that does not parse, which `lss fmt` leaves alone, too.
pub fn format(lines: &Lines) -> Option<Vec<TextEdit>> {
    let before = lines.text();
    let (tree, mistakes) = syntax::parse(FileId(0), before);
    if mistakes.iter().any(|mistake| mistake.is_error()) {
        return None;
    }
    Some(edits(lines, &syntax::format(&tree, before)))
}

fn edits(lines: &Lines, after: &str) -> Vec<TextEdit> {
    let mut options = DiffOptions::new();
    options.set_context_len(0);
    let patch = options.create_patch(lines.text(), after);
    let hunk = |hunk: &diffy::Hunk<str>| {
        let old = hunk.old_range();
        // Where nothing is taken out, the line before the insertion is named.
        let first = if old.is_empty() { old.start() } else { old.start() - 1 };
        let start = |line: usize| lines.line(line).map_or(lines.text().len(), |(start, _)| start);
        let range: Range = lines.range(start(first), start(first + old.len()));
        let inserted =
            hunk.lines().iter().filter_map(|line| if let Line::Insert(text) = line { Some(*text) } else { None });
        TextEdit::new(range, inserted.collect())
    };
    patch.hunks().iter().map(hunk).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::editor::text::Encoding;

    fn applied(before: &str) -> (usize, String) {
        let lines = Lines::new(before, Encoding::Utf16);
        let edits = format(&lines).unwrap();
        let mut text = before.to_owned();
        for edit in edits.iter().rev() {
            text.replace_range(lines.offset(edit.range.start)..lines.offset(edit.range.end), &edit.new_text);
        }
        (edits.len(), text)
    }

    #[test]
    fn only_lines_that_change_are_edited() {
        for text in [
            "let a=1 m\nlet b = 2 m // ä 🚚\nlet   c = 3 m",
            "\n\n\nlet a = 1 m\n\n\n\nlet b = 2 m\n\n",
            "let a = 1 m\r\nlet b=2 m\r\n",
            "let a = 1 m\r\nlet b=2 m\r\nlet c = 3 m\n",
            "",
            "// only this",
        ] {
            let (tree, _) = syntax::parse(FileId(0), text);
            assert_eq!(applied(text).1, syntax::format(&tree, text), "{text:?}");
            // Lines keep how they end.
            assert_eq!(applied(text).1.contains('\r'), text.contains('\r'), "{text:?}");
        }
        assert_eq!(applied("let a = 1 m\nlet b=2 m\nlet c = 3 m\n").0, 1);
        assert_eq!(applied("let a = 1 m\n").0, 0);
        assert!(format(&Lines::new("layout {", Encoding::Utf16)).is_none());
    }
}
