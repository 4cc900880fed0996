//! What the search of one layout tells while it goes on: nodes, and how far from the best it may still be.

use crate::solve::options::{Progress, Tell};
use std::cell::Cell;

/// How far all searches of one layout are together.
pub struct Told<'a> {
    watch: Tell<'a>,
    most: usize,
    /// What a unit of the tariff is: so many m or EUR.
    unit: (f64, &'static str),
    nodes: Cell<usize>,
    /// The gap of what the present search is only a part of.
    whole: Cell<Option<f64>>,
}

impl<'a> Told<'a> {
    pub fn new(watch: Tell<'a>, most: usize, unit: (f64, &'static str)) -> Self {
        Told { watch, most, unit, nodes: Cell::new(0), whole: Cell::new(None) }
    }

    /// Searches from here on are parts of one that leaves this open, in the tariff's units.
    pub fn part_of(&self, gap: f64) {
        self.whole.set(Some(gap));
    }

    /// One more node, and what the search leaves open, in the tariff's units; infinite where that is not known.
    pub fn node(&self, gap: f64) {
        let nodes = self.nodes.get() + 1;
        self.nodes.set(nodes);
        let (scale, unit) = self.unit;
        let gap = self.whole.get().unwrap_or(gap);
        let gap = gap.is_finite().then_some(gap.max(0.0) * scale);
        (self.watch)(Progress::Node { nodes, most: self.most.max(nodes), gap, unit });
    }
}
