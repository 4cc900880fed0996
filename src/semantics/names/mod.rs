//! What each name in a program stands for, for who asks by its place: definitions, uses, and the names in scope.
//!
//! The index reads trees and resolved imports alone, no values, so that half of a layout is worth indexing, too. Lines
//! that did not parse have no names in it.

mod index;
mod scopes;

use crate::semantics::program::{Program, Space};
use crate::source::{FileId, Span};
use crate::syntax::tree::DeclarationKind;
use std::collections::BTreeMap;

/// What a name stands for.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum NameKind {
    /// A `let`, of a file or of a layout.
    Value,
    Parameter,
    Component(DeclarationKind),
    Layout,
    Vertex,
    Obstacle,
    /// A straight that a layout has to have.
    Section,
    Induction,
    Chutes,
    /// A scanner, a gate or a lift.
    Station,
    /// A field or a group of fields of such a declaration, with its groups: `curve.radii`.
    Field(DeclarationKind, String),
    Function,
    Effect,
    /// A strength or a place of this effect.
    EffectArgument(String),
    /// The walls, in `distance(P1, building)`.
    Building,
    /// A module of the standard library.
    Module,
}

impl NameKind {
    /// What messages call it: `vertex`.
    pub fn word(&self) -> &'static str {
        match self {
            NameKind::Value => "value",
            NameKind::Parameter => "parameter",
            NameKind::Component(kind) => kind.word(),
            NameKind::Layout => "layout",
            NameKind::Vertex => "vertex",
            NameKind::Obstacle => "obstacle",
            NameKind::Section => "section",
            NameKind::Induction => "induction",
            NameKind::Chutes => "row of chutes",
            NameKind::Station => "station",
            NameKind::Field(..) => "field",
            NameKind::Function => "function",
            NameKind::Effect => "effect",
            NameKind::EffectArgument(_) => "argument",
            NameKind::Building => "building",
            NameKind::Module => "module of the standard library",
        }
    }
}

impl From<Space> for NameKind {
    fn from(space: Space) -> Self {
        match space {
            Space::Component(kind) => NameKind::Component(kind),
            Space::Let => NameKind::Value,
            Space::Layout => NameKind::Layout,
        }
    }
}

/// A name at a place.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Occurrence {
    pub span: Span,
    pub kind: NameKind,
    /// The name in the declaration that is meant: the innermost one. `None` where nothing declares it.
    pub definition: Option<Span>,
    /// The same for all uses of one thing. Where a variant of a layout replaces a vertex it is the first one's
    /// declaration, as the two share a name by meaning and not by chance.
    pub symbol: Option<Span>,
}

impl Occurrence {
    /// Whether it is the declaration itself.
    pub fn declares(&self) -> bool {
        self.definition == Some(self.span)
    }
}

/// A name that can be written somewhere.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Visible {
    pub name: String,
    pub kind: NameKind,
    pub definition: Span,
}

/// What the lines of a layout may name, with what it takes over from the layouts that it extends.
#[derive(Clone, Debug)]
pub struct LayoutNames {
    pub name: String,
    /// The whole declaration.
    pub span: Span,
    /// Vertices in driving order, then the rest.
    pub names: Vec<Visible>,
}

/// Names by place.
#[derive(Clone, Debug, Default)]
pub struct Names {
    /// By file and place; no two overlap, but several may share a place (an import of two items of one name).
    pub occurrences: Vec<Occurrence>,
    pub layouts: Vec<LayoutNames>,
    /// What each file declares and imports.
    pub files: BTreeMap<FileId, Vec<Visible>>,
}

impl Names {
    pub(super) fn of(program: &Program) -> Names {
        index::index(program)
    }

    /// The names that touch an offset of a file. Between two that touch it, the one that begins there.
    pub fn at(&self, file: FileId, offset: u32) -> &[Occurrence] {
        let touched = |o: &Occurrence| o.span.file == file && o.span.start <= offset && offset <= o.span.end;
        let end = self.occurrences.partition_point(|o| (o.span.file, o.span.start) <= (file, offset));
        let Some(last) = self.occurrences[..end].last().filter(|o| touched(o)) else { return &[] };
        let begin = self.occurrences[..end].partition_point(|o| (o.span.file, o.span.start) < (file, last.span.start));
        &self.occurrences[begin..end]
    }

    /// The names of a file.
    pub fn in_file(&self, file: FileId) -> &[Occurrence] {
        let begin = self.occurrences.partition_point(|o| o.span.file < file);
        let end = self.occurrences.partition_point(|o| o.span.file <= file);
        &self.occurrences[begin..end]
    }

    /// All uses of a thing with its declarations.
    pub fn of_symbol(&self, symbol: Span) -> impl Iterator<Item = &Occurrence> {
        self.occurrences.iter().filter(move |o| o.symbol == Some(symbol))
    }

    /// The layout around an offset.
    pub fn layout_at(&self, file: FileId, offset: u32) -> Option<&LayoutNames> {
        self.layouts.iter().find(|l| l.span.file == file && l.span.start <= offset && offset <= l.span.end)
    }
}
