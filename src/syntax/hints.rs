//! What is often meant by a line that fits nothing, beyond single words that are missing or misspelt.

use super::origin::Edit;
use super::token::{first_word, last_word, token_at};

/// What to write instead, where that cannot be put in without knowing more.
pub fn hint(text: &str, at: usize) -> Option<&'static str> {
    let (first, before, token) = (first_word(text), text[..at].trim_end(), token_at(text, at));
    let second = text.split_whitespace().nth(1).unwrap_or_default();
    match (first, second) {
        ("require", "capacity") => {
            Some("a capacity is at least so many items an hour: `require capacity >= 7000 per hour`")
        }
        ("chutes", _) if token == "anywhere" && !before.contains(" at ") => {
            Some("say how many: `at least 10 anywhere`")
        }
        ("chutes", _) if token == "at" && before.contains("at least") => Some(
            "as many as `at least` says are placed: leave `at most` out; a line such as \
             `choose count row_a 8 .. 16 step 4` leaves open how many",
        ),
        _ => None,
    }
}

/// Words of one or several that are taken for others.
pub fn meant(text: &str, at: usize) -> Option<Edit> {
    let (first, before) = (first_word(text), text[..at].trim_end());
    if !matches!(first, "induction" | "chutes" | "scanner" | "gate" | "lift") {
        return None;
    }
    // As many as are asked for are placed, and no more.
    if token_at(text, at) == "most" && last_word(before) == "at" {
        return Some(Edit { at, removed: "most".len(), inserted: "least".to_owned() });
    }
    None
}
