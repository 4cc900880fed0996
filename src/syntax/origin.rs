//! Repaired text, and the way back from a position in it to what was written.
//!
//! The parser goes on after a mistake by fixing a copy: a missing bracket is put in, a misspelt keyword replaced.
//! Spans must still name the user's bytes, so each copy remembers its edits.

/// `removed` bytes at `at` give way to `inserted`.
#[derive(Clone, Debug)]
pub struct Edit {
    pub at: usize,
    pub removed: usize,
    pub inserted: String,
}

/// Edits of one text, in order.
#[derive(Clone, Debug, Default)]
struct Layer {
    /// Position after the edits, before them, and the bytes put in and taken out there.
    places: Vec<(usize, usize, usize, usize)>,
}

impl Layer {
    /// The text with the edits done. Edits are sorted here; where two overlap, the later one loses what is gone.
    fn apply(text: &str, mut edits: Vec<Edit>) -> (String, Layer) {
        edits.sort_by_key(|edit| edit.at);
        let mut fixed = String::with_capacity(text.len() + 2 * edits.len());
        let mut layer = Layer::default();
        let mut done = 0;
        for edit in edits {
            let at = edit.at.max(done);
            let end = (edit.at + edit.removed).max(at);
            fixed.push_str(&text[done..at]);
            layer.places.push((fixed.len(), at, edit.inserted.len(), end - at));
            fixed.push_str(&edit.inserted);
            done = end;
        }
        fixed.push_str(&text[done..]);
        (fixed, layer)
    }

    fn back(&self, position: usize) -> usize {
        let after = self.places.partition_point(|place| place.0 <= position);
        match after.checked_sub(1).and_then(|last| self.places.get(last)) {
            None => position,
            Some(&(new, old, inserted, removed)) => {
                let past = position - new;
                if past >= inserted { old + removed + (past - inserted) } else { old + past.min(removed) }
            }
        }
    }
}

/// Where a text comes from: a slice of another from `base` on, with edits.
#[derive(Clone, Debug, Default)]
pub struct Origin<'a> {
    parent: Option<&'a Origin<'a>>,
    base: usize,
    layers: Vec<Layer>,
}

impl<'a> Origin<'a> {
    /// A slice of the text that `parent` describes.
    pub fn slice(parent: &'a Origin<'a>, base: usize) -> Self {
        Origin { parent: Some(parent), base, layers: Vec::new() }
    }

    /// The text after `edits` (positions in `text`), remembered.
    pub fn edit(&mut self, text: &str, edits: Vec<Edit>) -> String {
        let (fixed, layer) = Layer::apply(text, edits);
        self.layers.push(layer);
        fixed
    }

    /// The position in what the user wrote.
    pub fn back(&self, position: usize) -> usize {
        let position = self.layers.iter().rev().fold(position, |position, layer| layer.back(position)) + self.base;
        self.parent.map_or(position, |parent| parent.back(position))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_lead_back_through_edits_and_slices() {
        let text = "vertx P1 (1 m 2 m)";
        let mut whole = Origin::default();
        let first = whole.edit(text, vec![Edit { at: 0, removed: 5, inserted: "vertex".into() }]);
        let second = whole.edit(&first, vec![Edit { at: 14, removed: 0, inserted: ",".into() }]);
        assert_eq!(second, "vertex P1 (1 m, 2 m)");
        for (fixed, written) in [(0, 0), (6, 5), (7, 6), (14, 13), (15, 13), (16, 14), (20, 18)] {
            assert_eq!(whole.back(fixed), written, "at {fixed}");
        }
        let slice = Origin::slice(&whole, 10);
        assert_eq!(slice.back(0), 9);
        assert_eq!(slice.back(6), 14);
    }

    #[test]
    fn overlapping_edits_do_not_panic() {
        let mut origin = Origin::default();
        let edits = vec![
            Edit { at: 1, removed: 3, inserted: " ".into() },
            Edit { at: 2, removed: 0, inserted: ")".into() },
            Edit { at: 3, removed: 2, inserted: String::new() },
        ];
        assert_eq!(origin.edit("abcdef", edits), "a )f");
    }
}
