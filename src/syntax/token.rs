//! Tokens and words of a text that does not parse, for messages about it.

/// The token that starts at a position; empty at the end of the text.
pub fn token_at(text: &str, at: usize) -> &str {
    let rest = &text[at..];
    let Some(first) = rest.chars().next() else { return "" };
    let run = |inside: fn(char) -> bool| &rest[..rest.find(|c| !inside(c)).unwrap_or(rest.len())];
    match first {
        _ if is_letter(first) => run(|c| is_letter(c) || c.is_ascii_digit()),
        _ if first.is_ascii_digit() => run(|c| c.is_ascii_digit() || c == '_' || c == '.').trim_end_matches('.'),
        '"' => {
            let line = rest.lines().next().unwrap_or(rest);
            line.get(1..).and_then(|inner| inner.find('"')).map_or(line, |end| &line[..end + 2])
        }
        _ => ["...", "..", "//", "<=", ">=", "==", "!=", ":=", "->", "\r\n"]
            .into_iter()
            .find(|sign| rest.starts_with(sign))
            .map_or(&rest[..first.len_utf8()], |sign| &rest[..sign.len()]),
    }
}

pub fn first_word(text: &str) -> &str {
    let text = text.trim_start();
    &text[..text.find(|c: char| !is_letter(c) && !c.is_ascii_digit()).unwrap_or(text.len())]
}

pub fn last_word(text: &str) -> &str {
    let start = text.rfind(|c: char| !is_letter(c) && !c.is_ascii_digit());
    &text[start.and_then(|at| text[at..].chars().next().map(|c| at + c.len_utf8())).unwrap_or(0)..]
}

pub fn is_letter(c: char) -> bool {
    c.is_alphabetic() || c == '_'
}

pub fn is_bracket(token: &str) -> bool {
    matches!(token, "(" | ")" | "[" | "]" | "{" | "}")
}

/// Characters that no token starts with.
pub fn is_foreign(c: char) -> bool {
    if c.is_ascii() {
        matches!(c, '@' | '#' | '$' | '&' | '?' | '`' | '\'' | '~' | '|' | '\\' | '!' | ';' | '^')
    } else {
        !is_letter(c) && !"°µμΩ€²³·≤≥".contains(c)
    }
}

/// What a word processor or another keyboard made of a sign.
pub fn lookalike(c: char) -> Option<&'static str> {
    Some(match c {
        '−' | '–' | '—' => "-",
        '×' | '·' => "*",
        '÷' | '∕' => "/",
        '…' => "..",
        '；' | '，' => ",",
        '（' => "(",
        '）' => ")",
        '＝' => "=",
        '：' => ":",
        _ => return None,
    })
}
