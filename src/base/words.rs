//! Words in a row and counted, as a sentence has them.

/// `a`, `a and b`, `a, b and c` with the word `and`; empty for none.
pub fn list(words: &[impl AsRef<str>], and: &str) -> String {
    let words: Vec<&str> = words.iter().map(AsRef::as_ref).collect();
    match words[..] {
        [] => String::new(),
        [one] => one.to_owned(),
        [ref first @ .., last] => format!("{} {and} {last}", first.join(", ")),
    }
}

/// `a chute`, `an induction`: words with their article.
pub fn with_article(words: &str) -> String {
    let an = words.starts_with(['a', 'e', 'i', 'o', 'u']);
    format!("{} {words}", if an { "an" } else { "a" })
}

/// `1 motor`, `2 motors`: a count with a word that takes an `s`.
pub fn counted(count: usize, word: &str) -> String {
    format!("{count} {word}{}", if count == 1 { "" } else { "s" })
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

    #[test]
    fn a_vowel_takes_an() {
        assert_eq!(["induction", "row of chutes"].map(with_article), ["an induction", "a row of chutes"]);
    }

    #[test]
    fn one_is_not_many() {
        assert_eq!([0, 1, 2].map(|n| counted(n, "motor")), ["0 motors", "1 motor", "2 motors"]);
    }
}
