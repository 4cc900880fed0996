//! The optimisation problem of a layout, without a solver: variables, rows, regions to keep out of, objective
//! (thesis Eq. 3.1). Every row knows the line of source it comes from.
//!
//! Variables are the thesis' three a vertex, x, y and R. Clearance rows are not listed: there is one for every local
//! minimum of the distance between track and region, which depends on where the track runs, so they are made
//! from [`Keepout`]s when the problem is evaluated.

mod affine;
mod aim;
mod clearance;
#[cfg(test)]
mod derivatives;
mod evaluate;
mod expansion;
mod formula;
mod formulate;
mod jet;
pub mod measures;
pub mod mps;
pub mod nl;
mod perturb;
mod print;

pub use aim::{Aim, HARMONICS, Wave, Waves};
pub use evaluate::{Evaluation, RowKey, RowValue};
pub use expansion::Expansion;
pub use formula::nearest;
pub use perturb::{moved, perturbed};
pub use print::{print, relation};

use crate::geometry::clearance::Region;
use crate::geometry::{Piece, Track, self_crossings};
use crate::model::{self, Constraint, ConstraintKind, Formula, Heights, Interval, Layout, Required, Unit};
use crate::source::Span;
use serde::Serialize;
use std::collections::BTreeSet;

/// What a stage takes into account (thesis §3.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scope {
    /// Stage 1: user constraints and the building.
    Building,
    /// Stage 2: obstacles too.
    Obstacles,
}

/// A layout's optimisation problem.
#[derive(Clone, Debug, Serialize)]
pub struct Problem {
    pub layout: String,
    /// What is minimised.
    #[serde(skip)]
    pub aim: Aim,
    /// The same of the source's objective, in words.
    #[serde(skip)]
    pub minimises: &'static str,
    /// Vertex names, in driving order.
    pub vertices: Vec<String>,
    /// Written turn directions, +1 left and -1 right, which no solver may flip.
    pub signs: Vec<f64>,
    /// x, y, R of each vertex as written.
    pub start: Vec<f64>,
    /// Limits of each variable; fixed where both are alike.
    pub bounds: Vec<Interval>,
    pub rows: Vec<ConstraintRow>,
    /// Sections whose heading a `fix` holds.
    pub rotations: Vec<usize>,
    #[serde(skip)]
    pub keepouts: Vec<Keepout>,
    /// `None` when the track's length is minimised.
    #[serde(skip)]
    pub elastic: Option<Elastic>,
    /// Whether headings and lengths of sections are variables of their own, as [`measures::lift`] has them.
    #[serde(skip)]
    pub lifted: bool,
    /// Half the track's width, m.
    pub half_width: f64,
    /// Heights, and by how much one piece has to be above another to pass over it, m.
    #[serde(skip)]
    pub heights: Heights,
    #[serde(skip)]
    pub headroom: f64,
    pub places: formula::Places,
}

/// `low <= function <= high`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ConstraintRow {
    pub function: Function,
    pub low: f64,
    pub high: f64,
    pub unit: Unit,
    /// `None` for a hard row; otherwise what a unit of violation costs (m a unit), and the row is a penalty.
    pub weight: Option<f64>,
    /// `turn at P3`, `fix length P4..P5`.
    pub label: String,
    pub span: Span,
    /// The user's words.
    pub reason: Option<String>,
}

impl ConstraintRow {
    /// The `require` that a row is, in words; `None` for any other row.
    pub fn required(&self, layout: &Layout) -> Option<Required> {
        let is_own = |constraint: &&Constraint| {
            let ConstraintKind::Require { formula, .. } = &constraint.kind else { return false };
            constraint.span == self.span && matches!(&self.function, Function::Formula(own) if own == formula)
        };
        model::required(layout.constraints.iter().find(is_own)?, layout)
    }

    /// A hard row of lengths.
    pub fn hard(function: Function, (low, high): (f64, f64), label: String, span: Span) -> Self {
        ConstraintRow { function, low, high, unit: Unit::Metre, weight: None, label, span, reason: None }
    }
}

/// What a row measures. All are m but turns and formulas of angles, which are rad.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Function {
    /// Turn at a vertex in its written direction.
    Turn(usize),
    /// Length of a section between vertices.
    Section(usize),
    /// Length of the straight between a section's tangent points.
    Straight(usize),
    /// Σ k·variable.
    Linear(Vec<(usize, f64)>),
    /// Coordinate of the midpoint of a section's straight along a unit direction.
    StraightMiddle {
        section: usize,
        direction: crate::geometry::Point,
    },
    /// Coordinate of the begin or the end of a section's straight along a unit direction.
    StraightEnd {
        section: usize,
        end: bool,
        direction: crate::geometry::Point,
    },
    Formula(Formula),
}

impl Function {
    /// How far vertex j lies from vertex i along a direction.
    pub fn advance(i: usize, j: usize, along: crate::geometry::Point) -> Function {
        use measures::{x, y};
        Function::Linear(vec![(x(i), -along.x), (y(i), -along.y), (x(j), along.x), (y(j), along.y)])
    }
}

/// Limits that give way by one amount s, which is minimised in place of the track's length (Chinneck 2008, ch. 6). It
/// is the last variable, after those of the vertices. Rows of angles give way by s / [`LEVER`].
#[derive(Clone, Debug, Default)]
pub struct Elastic {
    /// Indices into `Problem::rows`; these rows have one limit each.
    pub rows: BTreeSet<usize>,
    /// Indices into `Problem::keepouts`.
    pub keepouts: BTreeSet<usize>,
}

/// The length at whose end an angle is worth a shift, m: a typical straight.
pub const LEVER: f64 = 10.0;

/// A region that the centre line keeps a distance from.
#[derive(Clone, Debug)]
pub struct Keepout {
    /// The obstacle's name, or `building`.
    pub name: String,
    pub region: Region,
    /// Half the track's width plus the clearance, m.
    pub distance: f64,
    pub span: Span,
}

impl Problem {
    /// The catalogue's radii within the limits of a vertex, m; a radius that the layout fixes is the user's own choice.
    pub fn radii(&self, layout: &Layout, vertex: usize) -> Vec<f64> {
        // Rounding of limits that come from text, m.
        const SLACK: f64 = 1e-9;
        let limits = self.bounds[measures::radius(vertex)];
        if limits.low == limits.high {
            return vec![limits.low];
        }
        let within = |r: &f64| *r >= limits.low - SLACK && *r <= limits.high + SLACK;
        layout.catalog.curve.radii.iter().copied().filter(within).collect()
    }

    /// Pairs of pieces that cross or touch, and where neither passes over the other.
    pub fn crossings(&self, track: &Track) -> Vec<(usize, usize)> {
        let mut found = self_crossings(track);
        found.retain(|&(i, j)| !self.passes(&track.pieces[i], &track.pieces[j]));
        found
    }

    /// Whether two pieces may cross in the plan: one passes over the other.
    pub fn passes(&self, a: &Piece, b: &Piece) -> bool {
        let apart = self.heights.apart(a, b);
        apart > 0.0 && apart >= self.headroom - 1e-9
    }

    /// The variables that may move.
    pub fn free(&self) -> Vec<usize> {
        (0..self.bounds.len()).filter(|&k| self.bounds[k].low < self.bounds[k].high).collect()
    }

    /// Whether a section's heading cannot change: both ends are fixed, or its rotation.
    pub fn holds_heading(&self, section: usize) -> bool {
        let next = (section + 1) % self.vertices.len();
        let ends = [measures::x(section), measures::y(section), measures::x(next), measures::y(next)];
        let fixed = |k: usize| self.bounds[k].low == self.bounds[k].high;
        ends.into_iter().all(fixed) || self.rotations.contains(&section)
    }

    /// The same problem with headings and lengths of sections as variables of their own, tied to the vertices by rows
    /// (lifting, Albersmeyer and Diehl 2010). Turns are linear in them, and straights nearly so, however short
    /// sections are; by coordinates of vertices both bend the more the shorter they are.
    pub fn lift(&self) -> Problem {
        let (free, length) = ((f64::NEG_INFINITY, f64::INFINITY), (0.0, f64::INFINITY));
        let limits = self.vertices.iter().flat_map(|_| [free, length]).map(|(low, high)| Interval { low, high });
        let bounds = self.bounds.iter().copied().chain(limits).collect();
        Problem { bounds, start: measures::lift(&self.start), lifted: true, ..self.clone() }
    }

    /// Adds a penalty: `price` (m a unit) for each unit that `function` is off `aim`.
    pub fn soft(&mut self, function: Function, aim: f64, price: f64) {
        let unit = if matches!(function, Function::Turn(_)) { Unit::Radian } else { Unit::Metre };
        let (label, span) = ("penalty".to_owned(), crate::source::Span::new(crate::source::FileId(0), 0, 0));
        let weight = Some(price);
        self.rows.push(ConstraintRow { function, low: aim, high: aim, unit, weight, label, span, reason: None });
    }

    /// `P3.x`
    pub fn variable_name(&self, k: usize) -> String {
        format!("{}.{}", self.vertices[k / 3], ["x", "y", "R"][k % 3])
    }
}
