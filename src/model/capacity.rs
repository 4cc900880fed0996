//! What a layout says of its items: where they come from, how chutes hold them, what goes wrong, and how many an hour the
//! sorter has to take.

use super::StraightPlace;
use crate::source::{Span, Spanned};
use serde::Serialize;

/// Everything that a layout says of its capacity.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Capacity {
    pub scanners: Vec<StraightPlace>,
    pub feeds: Vec<Feed>,
    pub storages: Vec<Storage>,
    pub items: Items,
    pub stops: Option<Stops>,
    pub failures: Vec<Failure>,
    pub waves: Option<Waves>,
    /// In turn, in the order in which they are written.
    pub each_wave: Vec<Wave>,
    pub required: Option<RequiredCapacity>,
}

impl Capacity {
    /// Whether the layout says nothing of it.
    pub fn is_silent(&self) -> bool {
        let Capacity { scanners, feeds, storages, items, stops, failures, waves, each_wave, required } = self;
        let nothing = scanners.is_empty() && feeds.is_empty() && storages.is_empty() && failures.is_empty();
        let still = nothing && waves.is_none() && each_wave.is_empty();
        still && *items == Items::default() && stops.is_none() && required.is_none()
    }
}

/// What comes to an induction.
#[derive(Clone, Debug, Serialize)]
pub struct Feed {
    /// Index into the layout's inductions.
    pub induction: usize,
    /// Items an hour, at random; `None` where there always is one.
    pub rate: Option<f64>,
    /// Most items an hour that the induction can put on carriers; `None` where only carriers limit it.
    pub most: Option<f64>,
    /// Share of free carriers that it uses while there are items.
    pub efficiency: f64,
    /// Indices of rows of chutes, and the share of each whole row of its items; none where they go wherever all do.
    pub shares: Vec<(usize, f64)>,
    pub span: Span,
}

/// How many items each chute of a row holds.
#[derive(Clone, Debug, Serialize)]
pub struct Storage {
    /// Index into the layout's rows of chutes.
    pub chutes: usize,
    pub count: usize,
    /// Time in which one of them is taken away, s; `None` where they stay until the wave's end.
    pub every: Option<f64>,
    pub span: Span,
}

/// What items are like.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Items {
    /// After so many laps in vain an item is given out at the next chute; `None` if never.
    pub laps: Option<usize>,
    /// Share of items that need two carriers.
    pub double: f64,
    /// Share of readings that fail.
    pub unread: f64,
}

impl Default for Items {
    fn default() -> Self {
        Items { laps: None, double: 0.0, unread: 0.0 }
    }
}

/// Stops of the sorter; both times are means, s.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Stops {
    /// Of running between two stops.
    pub every: f64,
    pub duration: f64,
}

/// Failures of an induction, or of each chute of a row or each scanner for itself; both times are means, s.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Failure {
    pub of: FailureOf,
    /// Of work between a repair and the next failure.
    pub every: f64,
    pub duration: f64,
    pub span: Span,
}

/// What fails: an index into the layout's inductions or into its rows of chutes, or each scanner for itself.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum FailureOf {
    Induction(usize),
    Chutes(usize),
    Scanners,
}

/// What `fails` calls all scanners, which have no names.
pub const SCANNERS: &str = "scanners";

/// Items come in waves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Waves {
    /// From the begin of one to that of the next, s.
    pub every: f64,
    /// Time at its begin in which chutes take nothing, s.
    pub changeover: f64,
    /// Coefficient of variation of what the share of each chute is multiplied with, anew in each wave.
    pub spread: f64,
    pub span: Span,
}

/// Where the items of a wave go.
#[derive(Clone, Debug, Serialize)]
pub struct Wave {
    pub name: String,
    /// Indices of rows of chutes, and the share of each whole row; rows that are not in it take nothing.
    pub shares: Vec<(usize, f64)>,
    pub span: Span,
}

/// What the sorter has to take.
#[derive(Clone, Debug, Serialize)]
pub struct RequiredCapacity {
    /// Items an hour.
    pub least: Spanned<f64>,
    pub reason: Option<String>,
}
