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
    /// By how much one that closes may be shorter and still close with as many carts.
    pub spare: f64,
}

/// What is known of the lengths at which a chain closes, with turns and radii chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Needed {
    /// Straights are so much longer or so much shorter in all, m, at least.
    Lengths { longer: f64, shorter: f64 },
    /// Curves near each other may cut off so much more or less that this says little before the straight of a section,
    /// which lies between these, m, is parted.
    Parted { section: usize, within: (f64, f64) },
    /// It is as near to closing as is known.
    Unknown,
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
            return Some(Off { spare: now.left_over + self.within, ..Off::default() });
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
        let unsure = (longer.1 + coupling, shorter.1 + coupling);
        Some(Off { longer: longer.0, shorter: -shorter.0, unsure, spare: 0.0 })
    }

    /// How well what a chain leaves over is known of a track from its curves alone, m.
    pub fn coupling(&self, track: &Track) -> f64 {
        coupling(track, self.pitch)
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
            let (Some(off), all) = (self.off(&at), straights(&at)) else { break };
            if off.longer == 0.0 && all < best {
                (best, closed) = (all, Some(x.clone()));
            }
            let next = all + off.longer - off.spare;
            if next < least || next >= best - EXACT {
                break;
            }
            let Some(polished) = polish(&x, Some(next)) else { break };
            x = polished;
        }
        closed
    }

    /// What straights between these limits, m, by section, need for a chain to close that is so far off on this track. Of
    /// tracks with heights it is not known how curves near each other matter, and none is told.
    pub fn needed(&self, track: &Track, off: Off, straights: &[(f64, f64)]) -> Needed {
        let leeway = match self.layout.levels.is_empty() {
            true => leeway(track, self.pitch, straights),
            false => Leeway::default(),
        };
        let (longer, shorter) = (off.longer - leeway.less - off.unsure.0, off.shorter - leeway.more - off.unsure.1);
        let fine = 0.1 * self.coupling(track);
        let says_much = |needed: f64, leeway: f64| leeway < fine || leeway < 0.5 * needed;
        if says_much(off.longer, leeway.less) && says_much(off.shorter, leeway.more) {
            return match longer.min(shorter) > EXACT {
                true => Needed::Lengths { longer, shorter },
                false => Needed::Unknown,
            };
        }
        let within = |section: usize| (straights[section].0.max(0.0), straights[section].1.min(self.pitch));
        let parted = leeway.section.map(|section| (section, within(section)));
        match parted.filter(|(_, within)| within.1 - within.0 > EXACT) {
            Some((section, within)) => Needed::Parted { section, within },
            None => Needed::Unknown,
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
