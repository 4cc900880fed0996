//! The word that was probably meant.

/// The candidate closest to `word`, if one is close enough to be a slip of the keyboard: at most a third of the letters
/// changed, added, left out or swapped with their neighbour. Case counts for nothing; the first of equals wins.
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let letters: Vec<char> = word.chars().flat_map(char::to_lowercase).take(65).collect();
    if letters.len() > 64 {
        return None;
    }
    let allowed = (letters.len() / 3).max(1);
    let mut best: Option<(usize, &str)> = None;
    for candidate in candidates {
        let other: Vec<char> = candidate.chars().flat_map(char::to_lowercase).collect();
        if other.len().abs_diff(letters.len()) > allowed || other.len() <= allowed {
            continue;
        }
        let distance = distance(&letters, &other);
        if distance <= allowed && best.is_none_or(|(least, _)| distance < least) {
            best = Some((distance, candidate));
        }
    }
    best.map(|(_, candidate)| candidate)
}

/// The candidates, the most like `word` first, however far they are; equals keep their order.
pub fn by_likeness<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Vec<&'a str> {
    let letters: Vec<char> = word.chars().flat_map(char::to_lowercase).take(64).collect();
    let mut sorted: Vec<&str> = candidates.into_iter().collect();
    sorted.sort_by_cached_key(|other| {
        let other: Vec<char> = other.chars().flat_map(char::to_lowercase).collect();
        distance(&letters, &other)
    });
    sorted
}

/// Optimal string alignment distance (Damerau 1964).
fn distance(a: &[char], b: &[char]) -> usize {
    let mut before: Vec<usize> = Vec::new();
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.iter().enumerate() {
        let mut row = vec![i + 1];
        for (j, y) in b.iter().enumerate() {
            let mut cost = (last[j] + usize::from(x != y)).min(last[j + 1] + 1).min(row[j] + 1);
            if i > 0 && j > 0 && *x == b[j - 1] && a[i - 1] == *y {
                cost = cost.min(before[j - 1] + 1);
            }
            row.push(cost);
        }
        before = std::mem::replace(&mut last, row);
    }
    last[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_are_recognised_and_other_words_are_not() {
        let words = ["vertex", "obstacle", "radius", "radii", "at", "on"];
        assert_eq!(nearest("vertx", words), Some("vertex"));
        assert_eq!(nearest("vretex", words), Some("vertex"));
        assert_eq!(nearest("Obstacel", words), Some("obstacle"));
        assert_eq!(nearest("radi", words), Some("radii"));
        assert_eq!(nearest("VERTEX", words), Some("vertex"));
        assert_eq!(nearest("pillar", words), None);
        assert_eq!(nearest("x", words), None);
        assert_eq!(nearest(&"v".repeat(1_000_000), words), None);
    }
}
