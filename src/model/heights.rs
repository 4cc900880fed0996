//! How high the centre line is, as far as a layout's levels say without its lengths.

use super::Level;
use crate::geometry::{Piece, PieceKind};

/// Lowest and highest that each section and each fillet may be, m.
///
/// A section with a level lies on it, and so does the fillet at either end of it: vertical curves lie on straights.
/// What is between two levels climbs from one to the other somewhere, and may be at any height between.
#[derive(Clone, Debug, PartialEq)]
pub struct Heights {
    sections: Vec<(f64, f64)>,
    fillets: Vec<(f64, f64)>,
}

impl Heights {
    /// Of a loop of `n` vertices. Without levels everything lies on the floor.
    pub fn new(n: usize, levels: &[Level]) -> Self {
        let mut given: Vec<Option<f64>> = vec![None; n];
        for level in levels {
            let mut i = level.from;
            // From a vertex to itself is the whole loop.
            loop {
                given[i] = Some(level.height);
                i = (i + 1) % n;
                if i == level.to {
                    break;
                }
            }
        }
        let near = |i: usize, step: usize| (1..n).find_map(|d| given[(i + d * step) % n]);
        let sections: Vec<(f64, f64)> = (0..n)
            .map(|i| match given[i] {
                Some(height) => (height, height),
                None => {
                    let (a, b) = (near(i, n - 1).unwrap_or(0.0), near(i, 1).unwrap_or(0.0));
                    (a.min(b), a.max(b))
                }
            })
            .collect();
        let fillets = (0..n)
            .map(|i| {
                let before = (i + n - 1) % n;
                match (given[before], given[i]) {
                    (Some(a), Some(b)) => (a.min(b), a.max(b)),
                    (Some(height), None) | (None, Some(height)) => (height, height),
                    (None, None) => sections[i],
                }
            })
            .collect();
        Heights { sections, fillets }
    }

    /// Whether everything lies at one height.
    pub fn is_flat(&self) -> bool {
        let mut all = self.sections.iter().chain(&self.fillets);
        all.next().is_none_or(|first| first.0 == first.1 && all.all(|own| own == first))
    }

    /// Of a piece of the plan.
    fn of(&self, piece: &Piece) -> (f64, f64) {
        match piece.kind {
            PieceKind::Straight => self.sections[piece.vertex],
            PieceKind::Arc { .. } => self.fillets[piece.vertex],
        }
    }

    /// Whether the track may climb on a section.
    pub fn climbs(&self, section: usize) -> bool {
        self.sections[section].0 < self.sections[section].1
    }

    /// Whether it may climb around a vertex.
    pub fn climbs_around(&self, vertex: usize) -> bool {
        self.fillets[vertex].0 < self.fillets[vertex].1
    }

    /// By how much one of two pieces is sure to be above the other, m; 0 when it may not be.
    pub fn apart(&self, a: &Piece, b: &Piece) -> f64 {
        let ((low, high), (bottom, top)) = (self.of(a), self.of(b));
        (bottom - high).max(low - top).max(0.0)
    }

    /// Lowest and highest of all, m.
    pub fn range(&self) -> (f64, f64) {
        self.sections.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (a, b)| (low.min(*a), high.max(*b)))
    }
}
