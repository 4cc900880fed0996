//! Values from outside for a layout's `let`s: `lss build plant.lss --let aisle=3m` and the sweeps of a study.
//!
//! A value takes the written one's place in the text before anything is checked. So it may be whatever could stand
//! there, messages show it where it stands, and the layout means what it would mean with that line.

use super::study;
use crate::source::{FileId, Loader, Overlay, SourceMap, Span};
use crate::syntax::tree::{Item, Statement, Tree};
use crate::syntax::{nearest, parse};
use std::collections::BTreeMap;
use std::fmt;

/// A name of a `let` and what stands behind its `=`.
pub type GivenLet = (String, String);

/// Why a value cannot be given.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NotGiven {
    /// No file of the layout has such a `let`; the names that there are, the nearest first.
    Unknown { name: String, known: Vec<String> },
    /// It could not stand behind a `let`'s `=`.
    NoValue { name: String, value: String },
}

impl fmt::Display for NotGiven {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            NotGiven::Unknown { name, .. } => write!(f, "the layout has no `let {name}`"),
            NotGiven::NoValue { name, value } => write!(f, "`{value}` is no value for `let {name}`"),
        }
    }
}

impl std::error::Error for NotGiven {}

impl NotGiven {
    /// A way out.
    pub fn help(&self) -> String {
        match self {
            NotGiven::Unknown { known, .. } if known.is_empty() => {
                "name what varies: `let NAME = VALUE` in the layout's file, and NAME in the place of the value"
                    .to_owned()
            }
            NotGiven::Unknown { name, known } => match nearest(name, known.iter().map(String::as_str)) {
                Some(near) => format!("did you mean `{near}`?"),
                None => {
                    let listed: Vec<String> = known.iter().take(LISTED).map(|name| format!("`{name}`")).collect();
                    let more = known.len().saturating_sub(LISTED);
                    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
                    format!("there are {}{more}", listed.join(", "))
                }
            },
            NotGiven::NoValue { .. } => "write it as the layout would: 3 m, 2 * 1.2 m, 45 deg".to_owned(),
        }
    }
}

/// Names that a message lists.
const LISTED: usize = 8;

/// The `let`s of the user's files, main file first, each with its name and the place of its value.
pub fn lets(sources: &mut SourceMap, loader: &mut Loader, main: FileId) -> Vec<(String, Span)> {
    let studied = study(sources, loader, main);
    studied.files.iter().filter(|file| file.standard.is_none()).flat_map(|file| lets_of(&file.tree)).collect()
}

fn lets_of(tree: &Tree) -> Vec<(String, Span)> {
    let mut found = Vec::new();
    for node in &tree.items.nodes {
        match &node.value {
            Item::Let(item) => found.push((item.name.text.clone(), item.value.span)),
            Item::Layout(layout) => found.extend(layout.body.nodes.iter().filter_map(|line| match &line.value {
                Statement::Let(item) => Some((item.name.text.clone(), item.value.span)),
                _ => None,
            })),
            _ => {}
        }
    }
    found
}

/// The files' texts with these values, for [`Loader::open_over`]. Every `let` of a name in the main file gets the
/// value; where it has none, every one of the files that it imports.
///
/// # Errors
///
/// The first value that has no place, or is none.
pub fn given(
    sources: &mut SourceMap,
    loader: &mut Loader,
    main: FileId,
    values: &[GivenLet],
) -> Result<Overlay, NotGiven> {
    let known = lets(sources, loader, main);
    let mut edits: BTreeMap<Span, &str> = BTreeMap::new();
    for (name, value) in values {
        if !is_value(value) {
            return Err(NotGiven::NoValue { name: name.clone(), value: value.clone() });
        }
        let all = || known.iter().filter(|(n, _)| n == name).map(|(_, span)| *span);
        let mut places: Vec<Span> = all().filter(|span| span.file == main).collect();
        if places.is_empty() {
            places = all().collect();
        }
        if places.is_empty() {
            return Err(unknown(name, &known));
        }
        edits.extend(places.into_iter().map(|span| (span, value.as_str())));
    }
    let mut overlay = Overlay::new();
    // From the end of each text to its beginning, so that places stay.
    for (span, value) in edits.iter().rev() {
        let Some(place) = loader.place(span.file) else { continue };
        let text = overlay.entry(place.to_owned()).or_insert_with(|| sources.file(span.file).text.clone());
        text.replace_range(span.start as usize..span.end as usize, value.trim());
    }
    Ok(overlay)
}

/// What to say of a name that no `let` has.
pub fn unknown(name: &str, known: &[(String, Span)]) -> NotGiven {
    let mut names: Vec<String> = known.iter().map(|(name, _)| name.clone()).collect();
    names.sort();
    names.dedup();
    NotGiven::Unknown { name: name.to_owned(), known: names }
}

/// Whether a text could stand behind a `let`'s `=`, alone on its line.
pub fn is_value(text: &str) -> bool {
    let mut sources = SourceMap::default();
    let line = format!("let x = {}", text.trim());
    let file = sources.add("", line.clone());
    let (tree, said) = parse(file, &line);
    let whole = |item: &Item| matches!(item, Item::Let(item) if item.value.span.end as usize == line.len());
    !text.contains('\n') && said.is_empty() && tree.items.nodes.len() == 1 && whole(&tree.items.nodes[0].value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::semantics::analyse;
    use std::sync::Arc;

    const MAIN: &str = "use \"shared.lss\"\nuse std.carts.tilt_tray\nuse std.tracks.standard\n\nlet aisle = 2 m // wide\n\
        layout hall {\n  catalog standard\n  cart tilt_tray(length: pitch)\n  speed 2 m/s\n  width 1.2 m\n  let far = 20 m\n  \
        vertex A (0 m, 0 m) radius 4 m\n  vertex B (far, 0 m) radius 4 m\n  vertex C (far, 10 m + aisle) radius 4 m\n  \
        vertex D (0 m, 10 m + aisle) radius 4 m\n  optimise nothing\n}\n";

    fn checked(values: &[(&str, &str)]) -> Result<(Vec<f64>, Vec<String>), NotGiven> {
        let folder = tempfile::tempdir().unwrap();
        let main = folder.path().join("main.lss");
        std::fs::write(&main, MAIN).unwrap();
        std::fs::write(folder.path().join("shared.lss"), "let pitch = 1250 mm\nlet aisle = 7 m\n").unwrap();
        let mut sources = SourceMap::default();
        let (mut loader, id) = Loader::open(&mut sources, &main).unwrap();
        let values: Vec<GivenLet> = values.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect();
        let overlay = given(&mut sources, &mut loader, id, &values)?;
        let mut sources = SourceMap::default();
        let (mut loader, id) = Loader::open_over(&mut sources, &main, Arc::new(overlay)).unwrap();
        let analysis = analyse(&mut sources, &mut loader, id, None);
        let at = |l: &crate::model::Layout| vec![l.vertices[2].point.x, l.vertices[2].point.y, l.cart.length];
        let said = analysis.diagnostics.iter().map(|d| d.message.clone()).collect();
        Ok((analysis.layouts.first().map(at).unwrap_or_default(), said))
    }

    #[test]
    fn values_take_the_place_of_those_written() {
        assert_eq!(checked(&[]).unwrap().0, [20.0, 12.0, 1.25]);
        let values = [("far", "30 m"), ("aisle", " 2 * 1.5 m"), ("pitch", "1100 mm")];
        assert_eq!(checked(&values).unwrap().0, [30.0, 13.0, 1.1], "of a layout, of the file, and of an import");
    }

    #[test]
    fn names_that_are_not_there_and_values_that_are_none_are_told() {
        let told = checked(&[("aisel", "2 m")]).unwrap_err();
        assert_eq!(told.to_string(), "the layout has no `let aisel`");
        assert_eq!(told.help(), "did you mean `aisle`?");
        assert_eq!(checked(&[("width", "2 m")]).unwrap_err().help(), "there are `aisle`, `far`, `pitch`");
        for value in ["", "2 m m", "2 m\nlet y = 3 m", "2 m // x", "2 m }", "(2 m"] {
            assert!(matches!(checked(&[("far", value)]), Err(NotGiven::NoValue { .. })), "{value}");
        }
        let (layouts, said) = checked(&[("far", "20 kg")]).unwrap();
        assert!(layouts.is_empty() && !said.is_empty(), "what it means is checked with the layout: {said:?}");
    }
}
