//! All uses of a thing, in open documents and in the other layouts of the project.

use super::workspace::Workspace;
use crate::semantics::names::{NameKind, Occurrence};
use crate::semantics::{Checked, Home};
use crate::source::{self, Overlay, SIZE_LIMIT, Span, root};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A thing with a name, whatever check it is seen from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Symbol {
    pub home: Home,
    /// Where its first declaration names it, bytes.
    pub start: u32,
    pub end: u32,
    pub name: String,
    pub kind: NameKind,
}

impl Symbol {
    pub fn of(checked: &Checked, name: &Occurrence) -> Option<Symbol> {
        let span = name.symbol?;
        let home = checked.home(span.file)?.clone();
        let (text, kind) = (checked.sources.text(span).to_owned(), name.kind.clone());
        Some(Symbol { home, start: span.start, end: span.end, name: text, kind })
    }

    /// Its span in a check, if the check has it.
    pub fn span(&self, checked: &Checked) -> Option<Span> {
        let file = checked.sources.ids().find(|id| checked.home(*id) == Some(&self.home))?;
        Some(Span { file, start: self.start, end: self.end })
    }

    /// Its uses in a check.
    pub fn uses<'c>(&self, checked: &'c Checked) -> Vec<&'c Occurrence> {
        let span = self.span(checked);
        checked.occurrences().iter().filter(|o| span.is_some() && o.symbol == span && o.kind == self.kind).collect()
    }
}

/// The checks that may use a thing: of open documents, and of the project's other layouts that mention its name.
pub fn checks(workspace: &mut Workspace, symbol: &Symbol, seen_from: &Path) -> Vec<(PathBuf, Arc<Checked>)> {
    let open = workspace.places();
    let mut all: Vec<(PathBuf, Arc<Checked>)> =
        open.iter().filter_map(|place| Some((place.clone(), workspace.checked(place)?))).collect();
    let folder = match &symbol.home {
        Home::Disk(place) => place.parent(),
        Home::Standard(_) => seen_from.parent(),
    };
    let Some(folder) = folder.filter(|folder| folder.is_absolute()) else { return all };
    for place in source::layouts(folder) {
        let place = super::place::canonical(&place);
        if !workspace.is_open(&place) && mentions(&place, &symbol.name) {
            let checked = Checked::new(&place, workspace.texts());
            all.push((place, Arc::new(checked)));
        }
    }
    all
}

fn mentions(place: &Path, name: &str) -> bool {
    let bytes = root::read_given(place, SIZE_LIMIT).unwrap_or_default();
    String::from_utf8_lossy(&bytes).split(|c: char| !super::text::in_name(c)).any(|word| word == name)
}

/// Places of uses by file, each once, with the file's text.
pub type Places = BTreeMap<Home, (String, BTreeSet<(usize, usize)>)>;

/// Where a thing is used.
pub fn places(checks: &[(PathBuf, Arc<Checked>)], symbol: &Symbol) -> Places {
    let mut found = Places::new();
    for (_, checked) in checks {
        for name in symbol.uses(checked) {
            let Some(home) = checked.home(name.span.file) else { continue };
            let entry = found.entry(home.clone());
            let (_, places) = entry.or_insert_with(|| (checked.text(name.span.file).to_owned(), BTreeSet::new()));
            places.insert((name.span.start as usize, name.span.end as usize));
        }
    }
    found
}

/// The open texts after every place got another text.
pub fn replaced(texts: &Arc<Overlay>, places: &Places, with: &str) -> Arc<Overlay> {
    let mut texts = texts.clone();
    for (home, (text, spans)) in places {
        let Home::Disk(place) = home else { continue };
        let mut text = text.clone();
        for (start, end) in spans.iter().rev() {
            text.replace_range(*start..*end, with);
        }
        Arc::make_mut(&mut texts).insert(place.clone(), text);
    }
    texts
}
