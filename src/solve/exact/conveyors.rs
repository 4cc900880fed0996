//! Conveyors as a part of what a layout costs: with its heading chosen, the length is a convex function of where a section
//! lies ([`Nearest`]).
//!
//! A search knows each by a variable t, its length, and by half-spaces that touch it (Kelley 1960): rows t − pull·V >= low,
//! which come as its layouts miss them, once one heading of the section is left. In the dual, the multipliers of a conveyor's
//! rows are no more in all than its price.

use super::choice::Choice;
use super::grid::Grid;
use super::node::Node;
use super::row::GridRow;
use super::tariff::{Aim, unit};
use crate::geometry::{Point, Track};
use crate::model::Layout;
use crate::placement::{HalfSpace, Nearest, nearest};
use std::rc::Rc;

/// All of a layout; none where length is minimised.
#[derive(Clone, Debug, Default)]
pub struct Conveyors {
    all: Vec<Nearest>,
    /// EUR
    unit: f64,
    /// By how much they may be shorter than they are here, m.
    shorter: f64,
}

impl Conveyors {
    pub fn new(layout: &Layout, written: &Track) -> Self {
        let aim = Aim::of(layout);
        if aim == Aim::Length {
            return Conveyors::default();
        }
        Conveyors { all: nearest(layout, written), unit: unit(layout, aim), shorter: 0.0 }
    }

    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Indices among what the layout declares.
    pub fn declared(&self) -> impl Iterator<Item = usize> {
        self.all.iter().map(|conveyor| conveyor.declared)
    }

    /// What they cost at least on a track, EUR.
    pub fn price(&self, track: &Track) -> f64 {
        self.all.iter().map(|conveyor| conveyor.price * conveyor.least(track)).sum()
    }

    /// What a metre of each costs, in the tariff's units.
    pub fn prices(&self) -> Vec<f64> {
        self.all.iter().map(|conveyor| conveyor.price / self.unit).collect()
    }

    /// As they are at least where a loop is turned within an angle, rad, so that no point of it moves by more than `by`, m.
    pub fn relaxed(&self, by: f64, within: f64) -> Self {
        let edge = self.all.iter().flat_map(|of| [of.across.0.abs(), of.across.1.abs()]).fold(0.0, f64::max);
        Conveyors { shorter: by + within * edge, ..self.clone() }
    }

    /// What they then may cost less, in the tariff's units.
    pub fn given_away(&self) -> f64 {
        self.shorter * self.prices().iter().sum::<f64>()
    }

    /// What a mix of choices misses by more than `least`, in the tariff's units.
    pub fn missed(
        &self,
        (grid, fixed): (&Grid, &[(usize, Point)]),
        node: &Node,
        mix: &[(Rc<Choice>, f64)],
        least: f64,
    ) -> Missed {
        let total: f64 = mix.iter().map(|(_, weight)| weight).sum();
        let mut missed = Missed::default();
        for (index, conveyor) in self.all.iter().enumerate().filter(|_| !mix.is_empty()) {
            let k = grid.stage(conveyor.section);
            let next = (k + 1) % grid.len();
            let heading = grid.unit(mix[0].0.headings[k]);
            let is_open = node.open.headings[k].len() > 1;
            if is_open && mix.len() > 1 {
                continue;
            }
            let (mut begin, mut end) = (Point::default(), Point::default());
            let mut known = vec![0.0; node.rows.len()];
            for (choice, weight) in mix {
                let (vertices, weight) = (choice.vertices(grid), weight / total);
                begin = begin + (vertices[k] + heading * choice.tangent(grid, k)) * weight;
                end = end + (vertices[next] - heading * choice.tangent(grid, next)) * weight;
                let own = |(_, row): &(usize, &GridRow)| row.relief == Some(index);
                for (at, row) in node.rows.iter().enumerate().filter(own) {
                    known[at] += weight * (row.low - choice.value(grid, row, &vertices));
                }
            }
            let way = conveyor.way(begin, heading, (end - begin).dot(heading));
            let length = known.into_iter().fold(0.0, f64::max);
            if (way.length() - self.shorter - length) * conveyor.price / self.unit <= least {
                continue;
            }
            if is_open {
                missed.open = missed.open.or(Some(k));
            } else if let Some(of) = conveyor.half_space(way, heading) {
                let mut row = row(index, (k, next), HalfSpace { low: of.low - self.shorter, ..of });
                row.low -= row.anchor(fixed);
                missed.rows.push(row);
            }
        }
        missed
    }
}

/// What there is to do about what a layout misses.
#[derive(Clone, Debug, Default)]
pub struct Missed {
    /// Rows that touch where it lies.
    pub rows: Vec<GridRow>,
    /// The first section, by stage, whose heading has to be chosen before.
    pub open: Option<usize>,
}

/// The row of the conveyor to a section, from the vertex at the first stage to that at the second.
fn row(conveyor: usize, (from, to): (usize, usize), HalfSpace { pull, of_end, low }: HalfSpace) -> GridRow {
    let row = match of_end {
        false => GridRow { at: vec![(from, -pull)], out: vec![(from, -pull)], ..GridRow::default() },
        true => GridRow { at: vec![(to, -pull)], into: vec![(to, pull)], ..GridRow::default() },
    };
    GridRow { low, relief: Some(conveyor), ..row }
}
