//! Between which values a formula can lie, by interval arithmetic (Moore 1966): wide, but never too narrow.

use std::collections::BTreeMap;

use super::Limits;
use crate::base::trig;
use crate::geometry::Track;
use crate::model::{Building, Formula, Interval, Obstacle, Target, Vertex};
use crate::source::Span;

const ALL: Interval = Interval { low: f64::NEG_INFINITY, high: f64::INFINITY };
const NOT_NEGATIVE: Interval = Interval { low: 0.0, high: f64::INFINITY };

/// What is known about the layout's variables.
pub(super) struct Known<'a> {
    pub vertices: &'a [Vertex],
    pub track: &'a Track,
    pub obstacles: &'a [Obstacle],
    pub building: Option<&'a Building>,
    pub limits: Limits,
    /// Nothing is free.
    pub as_written: bool,
    /// What `fix` holds at its written value, with the statement.
    pub fixed_vertices: BTreeMap<usize, Span>,
    pub fixed_radii: BTreeMap<usize, Span>,
    pub fixed_lengths: BTreeMap<(usize, bool), Span>,
    pub fixed_headings: BTreeMap<usize, Span>,
}

impl Known<'_> {
    /// The range of a formula; `holds` collects the statements that it rests on.
    pub fn range(&self, formula: &Formula, holds: &mut Vec<Span>) -> Interval {
        let mut of = |f: &Formula| self.range(f, holds);
        let range = match formula {
            Formula::Constant(value) => point(*value),
            Formula::Sum(terms) => terms.iter().fold(point(0.0), |a, t| {
                let b = of(t);
                Interval { low: a.low + b.low, high: a.high + b.high }
            }),
            Formula::Product(factors) => factors.iter().fold(point(1.0), |a, f| times(a, of(f))),
            Formula::Negative(inner) => {
                let a = of(inner);
                Interval { low: -a.high, high: -a.low }
            }
            Formula::Reciprocal(inner) => {
                let a = of(inner);
                match a.low > 0.0 || a.high < 0.0 {
                    true => Interval { low: 1.0 / a.high, high: 1.0 / a.low },
                    false => ALL,
                }
            }
            Formula::Absolute(inner) => {
                let a = of(inner);
                let high = a.low.abs().max(a.high.abs());
                let low = if a.contains(0.0) { 0.0 } else { a.low.abs().min(a.high.abs()) };
                Interval { low, high }
            }
            Formula::SquareRoot(inner) => {
                let a = of(inner);
                Interval { low: libm::sqrt(a.low.max(0.0)), high: libm::sqrt(a.high.max(0.0)) }
            }
            Formula::Smallest(items) => items
                .iter()
                .map(of)
                .reduce(|a, b| Interval { low: a.low.min(b.low), high: a.high.min(b.high) })
                .unwrap_or(ALL),
            Formula::Largest(items) => items
                .iter()
                .map(of)
                .reduce(|a, b| Interval { low: a.low.max(b.low), high: a.high.max(b.high) })
                .unwrap_or(ALL),
            atom => self.atom(atom, holds),
        };
        if range.low.is_nan() || range.high.is_nan() { ALL } else { range }
    }

    /// The range of a quantity of the geometry.
    fn atom(&self, atom: &Formula, holds: &mut Vec<Span>) -> Interval {
        let fixed: Option<Span> = match atom {
            Formula::X(i) | Formula::Y(i) => self.fixed_vertices.get(i).copied(),
            Formula::Radius(i) => self.fixed_radii.get(i).copied(),
            Formula::Length(t) => self.fixed_lengths.get(&(t.from, t.straight)).copied(),
            Formula::Heading(i) => self.fixed_headings.get(i).copied(),
            _ => None,
        };
        if fixed.is_some() || self.as_written {
            holds.extend(fixed);
            return point(self.written(atom));
        }
        match atom {
            Formula::Radius(_) => self.limits.radii.value,
            Formula::Heading(_) => Interval { low: -trig::PI, high: trig::PI },
            // The optimiser never flips a turn.
            Formula::Angle(i) if self.track.fillets[*i].turn < 0.0 => {
                Interval { low: -self.limits.turns.value.high, high: -self.limits.turns.value.low }
            }
            Formula::Angle(_) => self.limits.turns.value,
            Formula::Length(_)
            | Formula::DistanceVertices(..)
            | Formula::DistanceObstacle(..)
            | Formula::DistanceBuilding(_) => NOT_NEGATIVE,
            _ => ALL,
        }
    }

    /// Its value in the written layout.
    fn written(&self, atom: &Formula) -> f64 {
        let at = |i: &usize| self.vertices[*i].point;
        match atom {
            Formula::X(i) => at(i).x,
            Formula::Y(i) => at(i).y,
            Formula::Radius(i) => self.vertices[*i].radius.value,
            Formula::Length(Target { from, straight: true }) => self.track.straight(*from).length,
            Formula::Length(Target { from, .. }) => at(from).distance(at(&((from + 1) % self.vertices.len()))),
            Formula::Heading(i) => self.track.straight(*i).heading,
            Formula::Angle(i) => self.track.fillets[*i].turn,
            Formula::DistanceVertices(a, b) => at(a).distance(at(b)),
            Formula::DistanceObstacle(i, o) => match self.obstacles.get(*o).map(|o| &o.polygon) {
                Some(polygon) if !polygon.contains(at(i)) => polygon.distance_to_outline(at(i)),
                _ => 0.0,
            },
            Formula::DistanceBuilding(i) => self.building.map_or(0.0, |b| b.polygon.distance_to_outline(at(i))),
            _ => f64::NAN,
        }
    }
}

fn point(value: f64) -> Interval {
    Interval { low: value, high: value }
}

fn times(a: Interval, b: Interval) -> Interval {
    let product = |x: f64, y: f64| if x == 0.0 || y == 0.0 { 0.0 } else { x * y };
    let all = [product(a.low, b.low), product(a.low, b.high), product(a.high, b.low), product(a.high, b.high)];
    Interval {
        low: all.iter().copied().fold(f64::INFINITY, f64::min),
        high: all.iter().copied().fold(f64::NEG_INFINITY, f64::max),
    }
}
