//! Points, sections, and where on the track something stands.

use super::declaration::Reference;
use super::expression::Expr;
use super::node::Name;
use crate::source::Span;

/// `(28.0 m, 1.5 m)`.
#[derive(Clone, Debug)]
pub struct PointExpr {
    pub x: Expr,
    pub y: Expr,
    pub span: Span,
}

/// `section chutes 40 m within (0 m, 30 m)..(80 m, 30 m) either way on P1..P2`.
#[derive(Clone, Debug)]
pub struct PlacedSection {
    pub name: Name,
    /// With the line that it slides along, else it runs from end to end.
    pub length: Option<Expr>,
    pub from: PointExpr,
    pub to: PointExpr,
    pub either_way: bool,
    pub on: Option<Section>,
}

/// `P4..P5`.
#[derive(Clone, Debug)]
pub struct Section {
    pub from: Name,
    pub to: Name,
    pub span: Span,
}

/// A section between vertices, or the straight between its tangent points.
#[derive(Clone, Debug)]
pub struct Target {
    pub section: Section,
    /// `straight(P4..P5)` rather than `P4..P5`.
    pub straight: bool,
    pub span: Span,
}

/// `on P1..P2 at 6 m`.
#[derive(Clone, Debug)]
pub struct PlaceExpr {
    pub section: Section,
    pub at: Expr,
}

/// `on P7..P8 from 2 m every 1.25 m count 12`.
#[derive(Clone, Debug)]
pub struct RowExpr {
    pub section: Section,
    pub from: Expr,
    pub every: Expr,
    pub count: Expr,
}

/// Equipment of a declared kind.
#[derive(Clone, Debug)]
pub struct EquippedExpr {
    pub word: StationWord,
    pub name: Name,
    pub of: Reference,
    pub place: EquippedPlace,
    /// Where its conveyor begins.
    pub fed: Option<PointExpr>,
}

/// What a statement places.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum StationWord {
    Induction,
    Chutes,
    Scanner,
    Gate,
    Lift,
}

#[derive(Clone, Debug)]
pub enum EquippedPlace {
    /// `on P1..P2 at 6 m`
    At(PlaceExpr),
    /// `on P7..P8 from 2 m every 1.25 m count 12`
    Row(Box<RowExpr>),
    /// `at least 40 on P1..P2, P3..P4 after west before row_b`
    Free {
        /// One where it is not said.
        least: Option<Expr>,
        /// None: `anywhere`, or `on straights`, which is the same.
        on: Vec<Section>,
        straights: bool,
        after: After,
        before: Vec<Name>,
    },
}

/// What comes before a piece of equipment along the loop.
#[derive(Clone, Debug)]
pub enum After {
    Names(Vec<Name>),
    /// `after the last induction of each zone`: one piece for each zone.
    EachZone(Span),
}

impl After {
    /// The names that are said.
    pub fn names(&self) -> &[Name] {
        match self {
            After::Names(names) => names,
            After::EachZone(_) => &[],
        }
    }
}
