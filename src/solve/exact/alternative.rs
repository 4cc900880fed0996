//! What a layout that a bound left too much to could do instead, and what was decided that way.

use super::row::GridRow;

/// How an arc passes a corner, once that is decided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Way {
    /// The corner is beside the arc on its inner side.
    Inner,
    /// On its outer side, between these fractions of the turn.
    Outer(f64, f64),
}

/// Where a straight begins (end of the arc before it) or ends, by stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StraightEnd {
    Begin(usize),
    End(usize),
}

/// What something was decided about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum About {
    /// A corner of a region.
    Corner { keepout: usize, corner: usize },
    /// A listed row.
    Row(usize),
}

/// What was decided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum What {
    /// How the arc at a vertex stage passes it.
    Arc(usize, Way),
    /// It lies before (or else behind) the normal of the track at a joint. On the normal itself it is beside both
    /// pieces, so a piece that it may be beside need not offer the other side again: that would let it slip between the
    /// two.
    Before(StraightEnd, bool),
    /// In which directions a vertex is away from what it keeps a distance from: from one angle to another, rad.
    Away(f64, f64),
}

/// A decision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decided {
    pub about: About,
    pub what: What,
}

impl Decided {
    /// Whether this replaces another one.
    pub fn replaces(&self, other: &Decided) -> bool {
        let same = match (self.what, other.what) {
            (What::Arc(a, _), What::Arc(b, _)) => a == b,
            (What::Before(a, _), What::Before(b, _)) => a == b,
            (What::Away(..), What::Away(..)) => true,
            _ => false,
        };
        same && self.about == other.about
    }
}

/// One alternative.
#[derive(Clone, Debug)]
pub struct Alternative {
    pub rows: Vec<GridRow>,
    /// Least and most heading that it leaves to stages.
    pub headings: Vec<(usize, f64, f64)>,
    pub decided: Option<Decided>,
}

impl Alternative {
    /// A row alone.
    pub fn row(row: GridRow) -> Alternative {
        Alternative { rows: vec![row], headings: Vec::new(), decided: None }
    }
}

/// What to do about a layout that violates a row of its problem.
pub enum Remedy {
    /// Choose the heading of this stage first.
    Settle(usize),
    /// Halve the headings of this stage, those below from the others.
    Halve(usize, i32),
    Split(Vec<Alternative>),
}
