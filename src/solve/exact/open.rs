//! What is still open in a search: headings and radii.

use super::grid::{Grid, track};
use std::rc::Rc;

/// What is still open: headings by stage 0..=n, and radii (first and last of the list) by vertex stage.
#[derive(Clone, Debug, PartialEq)]
pub struct Open {
    pub headings: Vec<Vec<i32>>,
    pub radii: Vec<(usize, usize)>,
    /// First and last cell of each straight, by stage, and the hull of their prices; empty where only metres count.
    pub cells: Vec<(usize, usize)>,
    pub hulls: Vec<Rc<[(f64, f64)]>>,
}

impl Open {
    /// Whether one heading is left at every stage.
    pub fn settled(&self) -> bool {
        self.headings.iter().all(|h| h.len() == 1)
    }

    /// How many headings are open.
    pub fn count(&self) -> usize {
        self.headings.iter().map(Vec::len).sum()
    }

    /// Drops headings through which no choice is shorter than `cutoff`. `false` when nothing remains.
    pub fn drop_from(&mut self, through: &[Vec<f64>], cutoff: f64) -> bool {
        for (headings, through) in self.headings.iter_mut().zip(through) {
            let mut bounds = through.iter();
            headings.retain(|_| bounds.next().is_some_and(|&b| b < cutoff));
            if headings.is_empty() {
                return false;
            }
        }
        true
    }
}

/// The headings and radii of a layout, if they are on the grid.
pub fn place(grid: &Grid, x: &[f64]) -> Option<Open> {
    let (n, track) = (grid.len(), track(x));
    let mut headings = vec![vec![0]];
    let mut radii = vec![(0, 0); n];
    for k in 1..=n {
        let fillet = &track.fillets[grid.vertex(k % n)];
        let steps = fillet.turn / grid.step;
        let place = grid.radii[k % n].iter().position(|r| (r - fillet.radius).abs() < 1e-6)?;
        if (steps - steps.round()).abs() > 1e-4 {
            return None;
        }
        headings.push(vec![headings[k - 1][0] + steps.round() as i32]);
        radii[k % n] = (place, place);
    }
    let inside = headings.iter().zip(&grid.headings).all(|(h, all)| all.contains(&h[0]));
    inside.then_some(Open { headings, radii, cells: Vec::new(), hulls: Vec::new() })
}
