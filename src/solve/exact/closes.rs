//! A whole number of carts: how much longer a layout has to be for its chain to close.

use super::grid::track;
use crate::elements::{self, Space};
use crate::geometry::{CentreLine, Track};
use crate::kinematics::{fit, level};
use crate::model::Layout;

/// A chain that may be off by what a take-up compensates.
#[derive(Clone, Copy, Debug)]
pub struct Closes<'a> {
    layout: &'a Layout,
    /// Length of a cart, m.
    pub pitch: f64,
    /// m
    pub within: f64,
}

/// A left-over that exceeds the take-up by less does not, m.
const EXACT: f64 = 1e-6;
/// How often a layout is stretched anew because stretching moves the joints on its curves.
const ROUNDS: usize = 6;
/// What curves cut off, against the first term of its series θL²/(24R) (design: chain model), at least and at most.
const CUT: (f64, f64) = (0.9, 1.1);

impl<'a> Closes<'a> {
    pub fn new(layout: &'a Layout) -> Option<Self> {
        Some(Closes { layout, pitch: layout.cart.length, within: layout.chain.closes_within.as_ref()?.value })
    }

    /// Where the joints are: along the slopes, of a track with heights.
    fn line(&self, track: &Track) -> CentreLine {
        if self.layout.levels.is_empty() {
            return level(track);
        }
        Space::new(self.layout, &elements::sequence(track, self.layout)).0.line
    }

    /// What a track lacks to the next length that closes, m; 0 when it does. `None` when no chain fits at all.
    pub fn lack(&self, track: &Track) -> Option<f64> {
        self.off(track).map(|(longer, _)| longer)
    }

    /// By how much a track has to be longer to close, and by how much shorter, m; both 0 when it does.
    pub fn off(&self, track: &Track) -> Option<(f64, f64)> {
        let left = fit(&self.line(track), self.pitch)?.left_over;
        if left.abs() <= self.within + EXACT {
            return Some((0.0, 0.0));
        }
        let (longer, shorter) = if left < 0.0 { (-left, self.pitch + left) } else { (self.pitch - left, left) };
        Some((longer - self.within, shorter - self.within))
    }

    /// A layout with the same turns and radii, longer by no more than it takes.
    pub fn stretch(&self, x: &[f64], polish: &Polish) -> Option<Vec<f64>> {
        let mut x = x.to_vec();
        for _ in 0..ROUNDS {
            let at = track(&x);
            let lack = self.lack(&at)?;
            if lack == 0.0 {
                return Some(x);
            }
            let straights: f64 = (0..at.corners.len()).map(|i| at.straight(i).length).sum();
            x = polish(&x, Some(straights + lack))?;
        }
        None
    }

    /// The least length from `bound` on at which a chain can close, whatever the turns and radii, m.
    pub fn next(&self, layout: &Layout, written: &Track, bound: f64) -> f64 {
        // How much longer than its plan a track with heights is depends on its climbs.
        if !layout.levels.is_empty() {
            return bound;
        }
        let radii = &layout.radii.value;
        let square = self.pitch * self.pitch / 24.0;
        // A loop turns by at least its winding, and by no more than every vertex may.
        let least = written.fillets.iter().map(|f| f.turn).sum::<f64>().abs();
        let most = layout.turns.value.high * written.fillets.len() as f64;
        let low = CUT.0
            * (square * least / radii.high
                - self.pitch * square * 2.0 / (10.0 * radii.high * radii.high) * written.fillets.len() as f64)
                .max(0.0);
        let high = CUT.1 * square * most / radii.low;
        let band = |carts: f64| (carts * self.pitch + low - self.within, carts * self.pitch + high + self.within);
        let carts = ((bound - high - self.within) / self.pitch).ceil();
        bound.max(band(carts).0)
    }
}

/// See [`Setting::polish`].
pub type Polish<'a> = dyn Fn(&[f64], Option<f64>) -> Option<Vec<f64>> + 'a;
