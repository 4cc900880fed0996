//! Which components are free to be chosen, what the drive has to do, and what energy costs.

use super::{Cart, Motor, Sensor, TakeUp};
use crate::source::{Span, Spanned};
use serde::Serialize;

/// What a layout leaves open of its components. Where nothing is listed, what the layout states is kept.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Choice {
    /// Each family in each of its lengths.
    pub carts: Vec<Free<Cart>>,
    pub motors: Vec<Free<Motor>>,
    /// Take-ups and sensors: what of them serves is known once all else is chosen.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub take_ups: Vec<Free<TakeUp>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sensors: Vec<Free<Sensor>>,
    /// Whether motors may lie on straights only; else they stand evenly along the whole track.
    pub on_straights: bool,
    /// Speeds of the chain, m/s, ascending.
    pub speeds: Vec<f64>,
    /// Least radii of the track, m, ascending: each makes a track of its own.
    pub radii: Vec<f64>,
    /// Numbers of equipment: each choice of them makes a track of its own.
    pub counts: Vec<FreeCount>,
    pub drive: DriveDuty,
    pub energy: Option<EnergyUse>,
    #[serde(skip)]
    pub statements: ChoiceStatements,
}

/// A component that may be chosen.
#[derive(Clone, Debug, Serialize)]
pub struct Free<T> {
    #[serde(flatten)]
    pub item: T,
    /// As a layout names it: `tilt_tray(length: 600 mm)`.
    #[serde(skip)]
    pub written: String,
}

/// How many of some equipment there may be.
#[derive(Clone, Debug, Serialize)]
pub struct FreeCount {
    /// Indices into what the layout declares of equipment: there are as many of each.
    pub declared: Vec<usize>,
    /// Ascending.
    pub counts: Vec<usize>,
    /// Where each one's number stands, or where it would.
    #[serde(skip)]
    pub places: Vec<CountPlace>,
}

/// Where a statement says how many, or would.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CountPlace {
    /// What a number replaces; empty where none is said.
    pub span: Span,
    /// The statement before and behind it.
    pub line: (String, String),
    /// What comes before a number that is put in.
    pub word: &'static str,
}

impl CountPlace {
    /// The statement with a number.
    pub fn line(&self, count: usize) -> String {
        format!("{}{}{count}{}", self.line.0, self.word, self.line.1)
    }
}

impl Choice {
    /// Whether something is free.
    pub fn is_open(&self) -> bool {
        let components = self.carts.is_empty() && self.motors.is_empty() && self.speeds.is_empty();
        let beside = self.take_ups.is_empty() && self.sensors.is_empty();
        !(components && beside && self.radii.is_empty() && self.counts.is_empty())
    }
}

/// What motors have to do.
#[derive(Clone, Debug, Default, Serialize)]
pub struct DriveDuty {
    /// Mass on every carrier, kg.
    pub load: f64,
    /// Longest time from rest to speed, s.
    pub starts: Option<Spanned<f64>>,
    /// Longest time from speed to rest with the motors' thrust reversed, s.
    pub stops: Option<Spanned<f64>>,
    /// Motors that may be out of order at a time.
    pub spare: usize,
}

/// What energy costs, and how long the sorter runs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct EnergyUse {
    /// EUR/J
    pub price: f64,
    /// Of running in a year, s.
    pub running: f64,
    /// Years that price and energy are added up over.
    pub years: f64,
}

/// Where statements stand that a choice replaces.
#[derive(Clone, Debug, Default)]
pub struct ChoiceStatements {
    pub cart: Option<Span>,
    pub speed: Option<Span>,
    pub motor: Option<Span>,
    pub take_up: Option<Span>,
    pub sensor: Option<Span>,
    /// `motors ...`
    pub places: Vec<Span>,
    pub radii: Option<Span>,
    /// `choose ...`
    pub free: Vec<(Freed, Span)>,
}

/// What a statement leaves free.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Freed {
    Cart,
    Speed,
    Motor,
    TakeUp,
    Sensor,
    Radii,
    /// How much there is of some equipment.
    Count,
}

impl Freed {
    /// Whether the capacity depends on it.
    pub fn changes_capacity(self) -> bool {
        matches!(self, Freed::Cart | Freed::Speed | Freed::Count)
    }
}
