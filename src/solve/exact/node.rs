//! A node of the search: some of the choices, in the order in which they are looked at.

use super::alternative::Decided;
use super::master::Pool;
use super::open::Open;
use super::row::{self, GridRow};
use std::cmp::Ordering;

/// Some of the choices, with rows that hold for them.
pub struct Node {
    pub bound: f64,
    /// Order of creation.
    pub id: usize,
    pub open: Open,
    pub rows: Vec<GridRow>,
    pub decided: Vec<Decided>,
    pub pool: Pool,
}

impl Node {
    /// What straights lie between, m, by stage: within these limits, as far as rows of a single straight say.
    pub fn straights(&self, limits: &[(f64, f64)]) -> Vec<(f64, f64)> {
        row::straights(&self.rows, limits)
    }
}

impl Ord for Node {
    /// The least bound is the greatest; of equal ones the latest, which is the deepest.
    fn cmp(&self, other: &Self) -> Ordering {
        other.bound.total_cmp(&self.bound).then(self.id.cmp(&other.id))
    }
}

impl PartialOrd for Node {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Node {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Node {}
