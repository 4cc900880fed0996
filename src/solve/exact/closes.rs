//! A whole number of carts: how much longer a layout has to be for its chain to close.

use super::cut::{Leeway, coupling, cut, leeway};
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

/// How far a track is from the lengths that close, m.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Off {
    /// By how much it has to be longer, and by how much shorter; 0 where it closes.
    pub longer: f64,
    pub shorter: f64,
    /// How far each of these may be off.
    pub unsure: (f64, f64),
}

/// A left-over that exceeds the take-up by less does not, m.
const EXACT: f64 = 1e-6;
/// How often a layout is stretched anew because stretching moves the joints on its curves.
const ROUNDS: usize = 10;
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
        self.off(track).map(|off| off.longer)
    }

    /// How far a track is from the lengths that close, with the same turns and radii. `None` when no chain fits at all.
    pub fn off(&self, track: &Track) -> Option<Off> {
        let now = fit(&self.line(track), self.pitch)?;
        if now.left_over.abs() <= self.within + EXACT {
            return Some(Off::default());
        }
        let carts = now.carts as f64;
        let (more, fewer) = if now.left_over < 0.0 { (carts, carts - 1.0) } else { (carts + 1.0, carts) };
        // Chords of another pitch cut off more or less.
        let cut = |carts: f64, left: f64| match self.layout.levels.is_empty() {
            true => cut(track, self.pitch + left / carts),
            false => (0.0, 0.0),
        };
        let from = (carts * self.pitch + now.left_over, cut(carts, now.left_over).0);
        let change = |carts: f64, left: f64| {
            let (to, share) = cut(carts, left);
            (carts * self.pitch + left - from.0 + to - from.1, share * (to - from.1).abs())
        };
        let (longer, shorter) = (change(more, -self.within), change(fewer, self.within));
        let coupling = self.coupling(track);
        Some(Off { longer: longer.0, shorter: -shorter.0, unsure: (longer.1 + coupling, shorter.1 + coupling) })
    }

    /// How well what a chain leaves over is known of a track from its curves alone, m.
    pub fn coupling(&self, track: &Track) -> f64 {
        coupling(track, self.pitch)
    }

    /// By how much a closed track may be shorter and still close with as many carts, m.
    fn spare(&self, track: &Track) -> f64 {
        fit(&self.line(track), self.pitch).map_or(0.0, |fit| fit.left_over + self.within)
    }

    /// A layout with the same turns and radii that closes, longer by no more than it takes: straights between curves that
    /// are near each other change what these cut off, so that what was lacking may be too much.
    pub fn stretch(&self, x: &[f64], polish: &Polish) -> Option<Vec<f64>> {
        let (mut x, mut closed) = (x.to_vec(), None);
        let straights = |at: &Track| (0..at.corners.len()).map(|i| at.straight(i).length).sum::<f64>();
        let least = straights(&track(&x));
        let mut best = f64::INFINITY;
        for _ in 0..ROUNDS {
            let at = track(&x);
            let (Some(lack), all) = (self.lack(&at), straights(&at)) else { break };
            let next = match lack {
                0.0 => {
                    if all < best {
                        (best, closed) = (all, Some(x.clone()));
                    }
                    all - self.spare(&at)
                }
                lack => all + lack,
            };
            if next < least || (lack == 0.0 && all - next <= EXACT) || next >= best {
                break;
            }
            let Some(polished) = polish(&x, Some(next)) else { break };
            x = polished;
        }
        closed
    }

    /// By how much more and less curves may cut off than on this track, where its straights have other lengths between
    /// these, m, by section. Of tracks with heights nothing is known, and none is told.
    pub fn leeway(&self, track: &Track, straights: &[(f64, f64)]) -> Leeway {
        match self.layout.levels.is_empty() {
            true => leeway(track, self.pitch, straights),
            false => Leeway::default(),
        }
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
