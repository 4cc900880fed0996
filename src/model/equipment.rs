//! What stands along the track, and the chain on it.

use super::Article;
use crate::geometry::Point;
use crate::source::{Span, Spanned};
use serde::Serialize;

/// A place on the straight of a section, measured from the tangent point where the straight begins.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct StraightPlace {
    /// Index of the section's first vertex.
    pub section: usize,
    /// m
    pub at: f64,
    pub span: Span,
}

/// Places at equal distances on one straight.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PlaceRow {
    /// The first one.
    pub place: StraightPlace,
    /// m
    pub every: f64,
    pub count: usize,
}

#[derive(Clone, Debug, Serialize)]
pub struct Equipment {
    /// Where arc length is 0; `None`: the first vertex' outgoing tangent point.
    pub start: Option<StraightPlace>,
    pub photocell: Option<StraightPlace>,
    pub inductions: Vec<Induction>,
    pub chutes: Vec<Chutes>,
    pub motors: Motors,
    /// Distance between supports, m.
    pub supports: Option<Spanned<f64>>,
    /// One-based number of the cart that carries the sensors.
    pub sensor_cart: usize,
    /// Equipment of a declared kind, placed by the layout or free. Where it stands is worked out for a track
    /// ([`crate::placement`]); inductions and chutes are then added to those above, in this order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub declared: Vec<Declared>,
}

impl Equipment {
    /// What an induction is called: of several of one name, by number.
    pub fn induction_name(&self, index: usize) -> String {
        let name = &self.inductions[index].name;
        let alike = |some: &[Induction]| some.iter().filter(|other| other.name == *name).count();
        match alike(&self.inductions) {
            1 => name.clone(),
            _ => format!("{name} {}", alike(&self.inductions[..=index])),
        }
    }

    /// Names of all that stands along the track: of inductions, rows of chutes, and equipment of declared kinds.
    pub fn all_names(&self) -> impl Iterator<Item = &str> {
        let own = self.inductions.iter().map(|induction| induction.name.as_str());
        let own = own.chain(self.chutes.iter().map(|row| row.name.as_str()));
        own.chain(self.declared.iter().map(|declared| declared.name.as_str()))
    }

    /// Names of inductions, and of rows of chutes, by the index that feeds and storages have.
    pub fn names(&self, kind: EquipmentKind) -> Vec<&str> {
        let own: Vec<&str> = match kind {
            EquipmentKind::Induction => self.inductions.iter().map(|i| i.name.as_str()).collect(),
            EquipmentKind::Chute => self.chutes.iter().map(|c| c.name.as_str()).collect(),
            _ => Vec::new(),
        };
        let declared = self.declared.iter().filter(|d| d.of.kind == kind).map(|d| d.name.as_str());
        let declared: Vec<&str> = declared.filter(|name| !own.contains(name)).collect();
        own.into_iter().chain(declared).collect()
    }
}

#[derive(Clone, Debug, Serialize)]
pub struct Induction {
    pub name: String,
    pub place: StraightPlace,
}

#[derive(Clone, Debug, Serialize)]
pub struct Chutes {
    pub name: String,
    pub row: PlaceRow,
    /// Where the row goes on: chutes that were placed freely seldom stand at equal distances.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub more: Vec<PlaceRow>,
}

impl Chutes {
    pub fn rows(&self) -> impl Iterator<Item = &PlaceRow> {
        std::iter::once(&self.row).chain(&self.more)
    }

    pub fn count(&self) -> usize {
        self.rows().map(|row| row.count).sum()
    }
}

#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Motors {
    /// Motor j of N covers from (j + 1/2) S / N on.
    Evenly {
        count: usize,
    },
    Rows(Vec<PlaceRow>),
}

/// Height of the track over a run of sections.
#[derive(Clone, Debug, Serialize)]
pub struct Level {
    /// First and last vertex of the run; the same twice is the whole loop.
    pub from: usize,
    pub to: usize,
    /// m
    pub height: f64,
    pub span: Span,
}

/// Where and how the level changes.
#[derive(Clone, Debug, Serialize)]
pub struct Ramp {
    /// The section it begins on.
    pub section: usize,
    /// The section it ends on: the same for a ramp on one straight; curves between become spirals.
    pub last: usize,
    /// Distance from the tangent point where the straight begins, m.
    pub from: Option<f64>,
    /// Rise over run, unsigned.
    pub slope: Option<f64>,
    /// Radius of the vertical curves, m.
    pub radius: Option<f64>,
    pub span: Span,
}

#[derive(Clone, Debug, Serialize)]
pub struct ChainDeclaration {
    /// T₀, N
    pub tension: f64,
    /// Whether the layout says it; else it is the cart's.
    pub tension_is_said: bool,
    /// Largest left-over that a whole number of carts may have, m; `None`: only reported.
    pub closes_within: Option<Spanned<f64>>,
}

/// An effect that the layout's simulations include.
#[derive(Clone, Debug, Serialize)]
pub struct DeclaredEffect {
    pub name: String,
    /// Strengths by name, SI.
    pub strengths: Vec<(String, f64)>,
    pub span: Span,
}

/// What a declared kind of equipment is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum EquipmentKind {
    Induction,
    Chute,
    Scanner,
    Gate,
    Lift,
}

impl EquipmentKind {
    pub const ALL: [EquipmentKind; 5] = [
        EquipmentKind::Induction,
        EquipmentKind::Chute,
        EquipmentKind::Scanner,
        EquipmentKind::Gate,
        EquipmentKind::Lift,
    ];

    pub fn word(self) -> &'static str {
        match self {
            EquipmentKind::Induction => "induction",
            EquipmentKind::Chute => "chute",
            EquipmentKind::Scanner => "scanner",
            EquipmentKind::Gate => "gate",
            EquipmentKind::Lift => "lift",
        }
    }
}

/// Which side of the track equipment stands on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum EquipmentSide {
    /// Of travel.
    Left,
    Right,
    /// Of the loop.
    Outer,
    Inner,
    /// Either of them.
    Either,
    /// Both at once.
    Both,
}

impl EquipmentSide {
    pub const ALL: [EquipmentSide; 6] = [
        EquipmentSide::Left,
        EquipmentSide::Right,
        EquipmentSide::Outer,
        EquipmentSide::Inner,
        EquipmentSide::Either,
        EquipmentSide::Both,
    ];

    pub fn word(self) -> &'static str {
        match self {
            EquipmentSide::Left => "left",
            EquipmentSide::Right => "right",
            EquipmentSide::Outer => "outer",
            EquipmentSide::Inner => "inner",
            EquipmentSide::Either => "either",
            EquipmentSide::Both => "both",
        }
    }
}

/// A kind of equipment: a rectangle beside the track's band, with room around it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EquipmentType {
    pub name: String,
    pub kind: EquipmentKind,
    /// Along the track, m.
    pub stretch: f64,
    /// Across it, from the band's edge, m.
    pub depth: f64,
    pub side: EquipmentSide,
    /// Least distance from the curves at both ends of the straight, m.
    pub from_curve: f64,
    /// Room behind it, m. Two of them may share it.
    pub aisle: f64,
    /// Room at either end of it, m. Two of them may share it.
    pub service: f64,
    /// A metre of the conveyor that feeds it, EUR/m.
    pub conveyor: f64,
    pub article: Article,
}

/// Equipment of a declared kind in a layout.
#[derive(Clone, Debug, Serialize)]
pub struct Declared {
    pub name: String,
    pub of: EquipmentType,
    pub stands: Stands,
    /// Where the conveyor that feeds it begins.
    pub fed: Option<Point>,
    pub span: Span,
}

#[derive(Clone, Debug, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stands {
    /// Its middle is there.
    At(StraightPlace),
    Row(PlaceRow),
    /// Wherever there is room.
    Free {
        count: usize,
        /// Sections; none: all of them.
        on: Vec<usize>,
        /// What it comes after and before, counted from the layout's start in driving direction.
        after: Vec<String>,
        before: Vec<String>,
    },
}

impl Declared {
    /// Where a conveyor begins that has a price.
    pub fn priced_from(&self) -> Option<Point> {
        self.fed.filter(|_| self.of.conveyor > 0.0)
    }

    pub fn count(&self) -> usize {
        match &self.stands {
            Stands::At(_) => 1,
            Stands::Row(row) => row.count,
            Stands::Free { count, .. } => *count,
        }
    }

    /// The places that the layout gives.
    pub fn given(&self) -> Vec<StraightPlace> {
        match &self.stands {
            Stands::At(place) => vec![*place],
            Stands::Row(row) => row.places().collect(),
            Stands::Free { .. } => Vec::new(),
        }
    }

    /// What the n-th is called, from 0.
    pub fn one(&self, n: usize) -> String {
        match self.of.kind == EquipmentKind::Chute || self.count() > 1 {
            true => format!("{} {}", self.name, n + 1),
            false => self.name.clone(),
        }
    }
}

impl PlaceRow {
    pub fn places(&self) -> impl Iterator<Item = StraightPlace> + '_ {
        (0..self.count).map(|i| StraightPlace { at: self.place.at + self.every * i as f64, ..self.place })
    }
}
