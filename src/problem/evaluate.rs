//! A problem at given variables: objective, rows and clearance rows, with exact first and second derivatives.

use super::expansion::Expansion;
use super::measures::{Measures, to_corners};
use super::{Aim, Elastic, Function, LEVER, Problem, aim, clearance, formula};
use crate::base::trig;
use crate::geometry::clearance::{Approach, Feature, NearPiece};
use crate::geometry::proximity::{self, Meeting};
use crate::geometry::{Piece, PieceKind, Track};
use crate::model::Unit;
use crate::source::Span;

/// Identifies a row from one evaluation to the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum RowKey {
    /// Index into `Problem::rows`.
    Listed(usize),
    /// Index into `Problem::keepouts`, and the approach.
    Clearance(usize, Feature, NearPiece),
    /// Vertex of an arc of the track, another part of it, and whether the arc lies to the left of that.
    Own(usize, NearPiece, bool),
    /// A lifted section ends at its vertex: in x, and in y.
    Gap(usize, bool),
}

impl RowKey {
    /// Whether the row is in `Problem::rows`, rather than made where the track runs.
    pub fn is_listed(self) -> bool {
        matches!(self, RowKey::Listed(_))
    }
}

/// A row at some variables.
#[derive(Clone, Debug)]
pub struct RowValue {
    pub key: RowKey,
    pub expansion: Expansion,
    pub low: f64,
    pub high: f64,
}

impl RowValue {
    /// How far outside its limits, in the row's unit.
    pub fn violation(&self) -> f64 {
        (self.low - self.expansion.value).max(self.expansion.value - self.high).max(0.0)
    }
}

/// Everything a solver needs at one point.
#[derive(Clone, Debug)]
pub struct Evaluation {
    pub track: Track,
    /// Terms of the objective, m.
    pub objective: Vec<Expansion>,
    /// Of the track, m.
    pub length: f64,
    pub rows: Vec<RowValue>,
}

impl Evaluation {
    /// The objective, m: the track's length unless the problem aims at something else.
    pub fn value(&self) -> f64 {
        self.objective.iter().map(|e| e.value).sum()
    }
}

impl Problem {
    /// Evaluates at `variables`, with the clearance rows of every approach closer than its limit plus `reach`.
    pub fn evaluate(&self, variables: &[f64], reach: f64) -> Evaluation {
        let track = self.track(variables);
        let keys = self
            .keepouts
            .iter()
            .enumerate()
            .flat_map(|(k, keepout)| {
                let approaches = keepout.region.approaches(&track, keepout.distance + reach);
                approaches.into_iter().map(move |a| RowKey::Clearance(k, a.feature, a.part))
            })
            .chain(self.own_keys(&track, reach))
            .collect::<Vec<_>>();
        self.evaluate_rows(variables, track, keys.into_iter())
    }

    /// Evaluates at `variables` with the clearance rows of an evaluation elsewhere.
    pub fn evaluate_like(&self, variables: &[f64], other: &Evaluation) -> Evaluation {
        let keys = other.rows.iter().map(|r| r.key).filter(|k| !k.is_listed());
        self.evaluate_rows(variables, self.track(variables), keys)
    }

    fn track(&self, variables: &[f64]) -> Track {
        Track::new(&to_corners(&variables[..3 * self.vertices.len()]))
    }

    /// Rows that keep the band off itself.
    fn own_keys(&self, track: &Track, reach: f64) -> impl Iterator<Item = RowKey> {
        let meetings = proximity::meetings(track, 2.0 * self.half_width + reach);
        let piece = |part: NearPiece| match part {
            NearPiece::Straight(vertex) => &track.pieces[2 * vertex],
            NearPiece::Arc(vertex) => &track.pieces[(2 * vertex + track.pieces.len() - 1) % track.pieces.len()],
        };
        let meetings = meetings.into_iter().filter(|m| !self.passes(piece(NearPiece::Arc(m.arc)), piece(m.other)));
        meetings.collect::<Vec<_>>().into_iter().map(|m| RowKey::Own(m.arc, m.other, m.side > 0.0))
    }

    fn evaluate_rows(&self, variables: &[f64], track: Track, clearances: impl Iterator<Item = RowKey>) -> Evaluation {
        let measures = match self.lifted {
            true => Measures::lifted(variables, &self.signs),
            false => Measures::new(variables, &self.signs),
        };
        let listed = self.rows.iter().enumerate().map(|(i, row)| RowValue {
            key: RowKey::Listed(i),
            expansion: self.expand(&row.function, row.low, row.high, variables, &measures),
            low: row.low,
            high: row.high,
        });
        let mut rows: Vec<RowValue> = listed.collect();
        rows.extend(measures.gaps().into_iter().enumerate().map(|(i, expansion)| {
            let key = RowKey::Gap(i / 2, i % 2 == 1);
            RowValue { key, expansion, low: 0.0, high: 0.0 }
        }));
        for key in clearances {
            let Some((form, low)) = self.clearance(key, &track) else { continue };
            let expansion = clearance::distance(&form, &measures, &self.signs);
            rows.push(RowValue { key, expansion, low, high: f64::INFINITY });
        }
        let lengths = measures.track_length();
        let length = lengths.iter().map(|e| e.value).sum();
        let objective = match (&self.elastic, &self.aim) {
            (None, Aim::Length) => lengths,
            (None, Aim::Waves(waves)) => waves.expand(&measures),
            (None, Aim::Near(there)) => aim::near(variables, there),
            (Some(elastic), _) => {
                let slack = variables.len() - 1;
                let give = Expansion::variable(variables[slack], slack);
                rows.iter_mut().for_each(|row| self.give_way(elastic, &give, row));
                vec![give]
            }
        };
        Evaluation { track, objective, length, rows }
    }

    /// Moves an elastic row to its limit's inner side by what the limit gives way.
    fn give_way(&self, elastic: &Elastic, give: &Expansion, row: &mut RowValue) {
        let (gives, unit) = match row.key {
            RowKey::Listed(i) => {
                (elastic.rows.contains(&i), if self.rows[i].unit == Unit::Radian { 1.0 / LEVER } else { 1.0 })
            }
            RowKey::Clearance(k, ..) => (elastic.keepouts.contains(&k), 1.0),
            RowKey::Own(..) | RowKey::Gap(..) => (false, 1.0),
        };
        if gives {
            let towards = if row.low.is_finite() { unit } else { -unit };
            row.expansion = row.expansion.add(&give.scale(towards));
        }
    }

    /// The form of a clearance row where the track runs, and the least distance, m; `None` for listed rows.
    pub(super) fn clearance(&self, key: RowKey, track: &Track) -> Option<(clearance::ClearanceForm, f64)> {
        match key {
            RowKey::Listed(_) | RowKey::Gap(..) => None,
            RowKey::Clearance(k, feature, part) => {
                let keepout = &self.keepouts[k];
                let approach = Approach { feature, part, distance: 0.0 };
                Some((clearance::form(&keepout.region, &approach, track), keepout.distance))
            }
            RowKey::Own(arc, other, left) => {
                let meeting = Meeting { arc, other, side: if left { 1.0 } else { -1.0 }, distance: 0.0 };
                Some((clearance::own_form(&meeting, track, &self.signs), 2.0 * self.half_width))
            }
        }
    }

    fn expand(&self, function: &Function, low: f64, high: f64, variables: &[f64], measures: &Measures) -> Expansion {
        match function {
            Function::Turn(i) => measures.at(*i, |m| m.turn),
            Function::Section(i) => measures.section(*i),
            Function::Straight(i) => measures.straight(*i),
            Function::Linear(terms) => {
                let terms: Vec<_> = terms.iter().map(|&(k, c)| (k, c, variables[k])).collect();
                Expansion::linear(0.0, &terms)
            }
            Function::StraightMiddle { section, direction } => {
                let end = |v: usize, begin: bool| {
                    measures.at(v, |m| {
                        let p = if begin { m.begin } else { m.end };
                        p.x.scale(direction.x) + p.y.scale(direction.y)
                    })
                };
                end(*section, false).add(&end(measures.next(*section), true)).scale(0.5)
            }
            Function::StraightEnd { section, end, direction } => {
                let vertex = if *end { measures.next(*section) } else { *section };
                measures.at(vertex, |m| {
                    let p = if *end { m.begin } else { m.end };
                    p.x.scale(direction.x) + p.y.scale(direction.y)
                })
            }
            Function::Formula(f) => {
                let e = formula::expand(f, measures, &self.signs, &self.places);
                // A heading is known up to full turns: the one nearest to what is asked.
                if !(f.is_heading() && low.is_finite() && high.is_finite()) {
                    return e;
                }
                let aim = (low + high) / 2.0;
                let turned = aim + trig::wrap(e.value - aim) - e.value;
                e.shift(turned)
            }
        }
    }

    /// What a row is called, and its line.
    pub fn describe(&self, key: RowKey) -> (String, Span) {
        match key {
            RowKey::Listed(i) => {
                let row = &self.rows[i];
                let label = match &row.reason {
                    Some(reason) => format!("{} ({reason})", row.label),
                    None => row.label.clone(),
                };
                (label, row.span)
            }
            RowKey::Clearance(k, _, part) => {
                let keepout = &self.keepouts[k];
                (format!("clearance of {} to {}", keepout.name, self.part_name(part)), keepout.span)
            }
            RowKey::Own(arc, other, _) => {
                let (arc_name, other) = (self.part_name(NearPiece::Arc(arc)), self.part_name(other));
                (format!("the track's own width between {arc_name} and {other}"), self.vertex_span(arc))
            }
            RowKey::Gap(section, _) => (format!("end of {}", self.section_name(section)), self.vertex_span(section)),
        }
    }

    /// The straight or curve that a piece is.
    pub fn piece_name(&self, piece: &Piece) -> String {
        match piece.kind {
            PieceKind::Straight => self.part_name(NearPiece::Straight(piece.vertex)),
            PieceKind::Arc { .. } => self.part_name(NearPiece::Arc(piece.vertex)),
        }
    }

    /// Where a vertex is written: rows begin with a turn a vertex.
    pub fn vertex_span(&self, vertex: usize) -> Span {
        self.rows[vertex].span
    }

    fn part_name(&self, part: NearPiece) -> String {
        match part {
            NearPiece::Straight(i) => format!("the straight {}", self.section_name(i)),
            NearPiece::Arc(i) => format!("the curve at {}", self.vertices[i]),
        }
    }

    /// What a row counts in: `m`, `rad`, `m^2`, or nothing for a plain number or another dimension in SI units.
    pub fn unit(&self, key: RowKey) -> &'static str {
        match key {
            RowKey::Listed(i) => self.rows[i].unit.symbol(),
            _ => Unit::Metre.symbol(),
        }
    }
}
