//! Words in a row, as a sentence has them.

/// `a`, `a and b`, `a, b and c` with the word `and`; empty for none.
pub fn list(words: &[impl AsRef<str>], and: &str) -> String {
    let words: Vec<&str> = words.iter().map(AsRef::as_ref).collect();
    match words[..] {
        [] => String::new(),
        [one] => one.to_owned(),
        [ref first @ .., last] => format!("{} {and} {last}", first.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_two_are_joined_by_a_word() {
        let words = ["a", "b", "c"];
        let lists = [list(&words[..0], "or"), list(&words[..1], "or"), list(&words[..2], "or"), list(&words, "and")];
        assert_eq!(lists, ["", "a", "a or b", "a, b and c"]);
    }
}
