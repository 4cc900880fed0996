//! Text from outside, as it may stand on a terminal.

use std::borrow::Cow;
use std::fmt::Write;
use std::path::Path;

/// Whether a character steers a terminal rather than being shown: the control characters C0, DEL and C1, and those that
/// turn the direction of the text around them (Unicode Standard Annex 9).
pub fn steers(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Text of several lines, with `\u001b` for what would steer a terminal. Line breaks and tabs stay. This is JSON's own
/// way to write them, so JSON stays what it says.
pub fn visible(text: &str) -> Cow<'_, str> {
    escaped(text, |c| steers(c) && c != '\n' && c != '\t')
}

/// As [`visible`], but one line: so that no name can look like the program's next message.
pub fn one_line(text: &str) -> Cow<'_, str> {
    escaped(text, steers)
}

/// A path as messages show it.
pub fn shown(path: impl AsRef<Path>) -> String {
    one_line(&path.as_ref().to_string_lossy()).into_owned()
}

fn escaped(text: &str, hidden: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&hidden) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        if hidden(c) {
            // All of them have four digits.
            let _ = write!(out, "\\u{:04x}", u32::from(c));
        } else {
            out.push(c);
        }
    }
    Cow::Owned(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_steers_a_terminal_is_escaped_and_the_rest_stays() {
        assert_eq!(visible("a\tb\nö ∂ 漢"), "a\tb\nö ∂ 漢");
        assert_eq!(visible("\u{1b}[2J\r\u{7f}\u{9b}"), "\\u001b[2J\\u000d\\u007f\\u009b");
        assert_eq!(visible("\u{202e}\u{2066}\u{200f}\u{61c}"), "\\u202e\\u2066\\u200f\\u061c");
        assert_eq!(one_line("a\nerror: b\t"), "a\\u000aerror: b\\u0009");
        assert_eq!(shown(Path::new("x\u{1b}.lss")), "x\\u001b.lss");
    }

    #[test]
    fn json_keeps_its_meaning() {
        let text = "\u{9b}31m \u{202e} \u{7f} \u{1b} \n";
        let json = serde_json::to_string(text).unwrap();
        assert_eq!(serde_json::from_str::<String>(&visible(&json)).unwrap(), text);
        assert!(!visible(&json).contains(steers));
    }
}
