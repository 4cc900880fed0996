//! The most that goes over a sorter, in closed form.

use super::flow::{Limit, Most};
use super::sorter::Sorter;
use super::stream::{Cause, stream};
use super::waves::drawn;
use super::{scanners, split};

/// The most that goes over a sorter.
#[derive(Clone, Debug, PartialEq)]
pub struct Bound {
    /// Items an hour; with waves, the mean over them.
    pub throughput: f64,
    /// With waves, that of the one that takes least.
    pub limit: Limit,
    /// Carriers in use behind each induction, as a share of all that pass, likewise.
    pub used: Vec<f64>,
    /// Each wave until they repeat; nothing without waves.
    pub waves: Vec<WaveBound>,
}

impl Bound {
    /// Whether no way of feeding the sorter beats it, in the proportions that it is of. Where chutes or scanners fail it is
    /// a mean over which of them are down; and where full chutes limit it, items that `items laps` lets leave anywhere come
    /// on top.
    pub fn is_strict(&self, sorter: &Sorter) -> bool {
        let full = |limit: Limit| matches!(limit, Limit::Chute(_)) && sorter.items.most_laps != usize::MAX;
        let limits = self.waves.iter().map(|wave| wave.limit).chain([self.limit]);
        let fails = sorter.chutes.iter().any(|chute| chute.fails.is_some())
            || sorter.scanners.iter().any(|scanner| scanner.fails.is_some());
        !fails && !limits.into_iter().any(full)
    }
}

/// Both closed forms of a sorter.
#[derive(Clone, Debug, PartialEq)]
pub struct Bounds {
    /// However items come.
    pub any: Bound,
    /// In the proportions in which they come; `None` where an induction always has items.
    pub as_fed: Option<Bound>,
}

impl Bounds {
    /// `None` as in [`bound`].
    pub fn of(sorter: &Sorter) -> Option<Bounds> {
        let as_fed = sorter.proportions().and_then(|proportions| bound(sorter, Some(&proportions)));
        Some(Bounds { any: bound(sorter, None)?, as_fed })
    }

    /// What counts for the items that come.
    pub fn own(&self) -> &Bound {
        self.as_fed.as_ref().unwrap_or(&self.any)
    }
}

/// The most that goes over a sorter in a wave.
#[derive(Clone, Debug, PartialEq)]
pub struct WaveBound {
    /// Items an hour, changeover and all.
    pub throughput: f64,
    pub limit: Limit,
    /// The chute with the largest share of the wave's items, before any are drawn.
    pub busiest: usize,
    /// The largest share of a chute; where shares are drawn, its mean.
    pub share: f64,
    /// Items an hour with which no chute becomes full before the next wave; infinite where none ever does.
    pub fits: f64,
}

/// Waves of each kind that are drawn where their shares are random.
const DRAWN: usize = 64;

/// The throughput at which something is used up, where items come to the inductions in these proportions, or in any where
/// there are none.
///
/// An item from an induction to a chute uses a carrier (two, if it is double) on every stretch between them, and on
/// all stretches once more for each lap that it makes in vain: u^k/(1 − u^n) laps in the mean where it passes k of n scanners
/// on its way, whose readings fail with probability u. An induction puts nothing on the carriers that pass while it is
/// down. `None` without an induction or a chute.
///
/// Where a chute with the share p of R items an hour fails, an item goes round for f laps in the mean
/// ([`Failures::laps`](super::sorter::Failures::laps)), if it meets the chute down for g. What goes round leaves less room
/// for what follows: of N carriers, S with items for that chute, S grows by R p (1 - S/N), so that f is
/// f / (1 + g p R/Q) after all.
///
/// Scanners that fail make it a mean over which of them work, each as long as its availability says: repairs are taken to
/// last long against a lap.
///
/// Waves that begin T apart close chutes for c. Of the items that are on the sorter then, those that are due within c
/// make a lap more: with a time of travel τ, and in the mean over all items, they are E[min(c, τ)]/T of all. In what of c
/// is beyond a lap, no carrier becomes free. A chute that holds H items takes H and what is taken away in T − c; what is
/// beyond that waits on carriers for the next wave. The mean is that over the waves, and over some that are drawn.
///
/// In any proportions, the most is that of a linear program ([`split`](super::split)).
pub fn bound(sorter: &Sorter, proportions: Option<&[f64]>) -> Option<Bound> {
    let states = scanners::states(sorter);
    let most = |shares: &[f64]| {
        scanners::mean(&states, shares, |flow| match proportions {
            Some(proportions) => flow.most(proportions),
            None => split::most(flow),
        })
    };
    let Some(waves) = &sorter.waves else {
        let one = most(&sorter.shares(0))?;
        return Some(Bound { throughput: one.throughput, limit: one.limit, used: one.used, waves: Vec::new() });
    };
    let mut random = stream(0, Cause::Waves, 0);
    let mut least: Option<Most> = None;
    let mut rows = Vec::new();
    for wave in 0..waves.count() {
        let said = sorter.shares(wave);
        let planned = most(&said)?;
        let largest = planned.shares.iter().copied().fold(0.0, f64::max);
        let busiest = planned.shares.iter().position(|share| *share == largest)?;
        let each: Vec<Most> = match waves.spread > 0.0 {
            true => {
                let draw = |_| most(&drawn(said.clone(), waves.spread, &mut random));
                (0..DRAWN).map(draw).collect::<Option<_>>()?
            }
            false => vec![planned],
        };
        let (mut throughput, mut share, mut fits) = (0.0, 0.0, 0.0);
        let mut worst: Option<Most> = None;
        let draws = each.len() as f64;
        for most in each {
            share += most.shares.iter().copied().fold(0.0, f64::max) / draws;
            fits += most.fits / draws;
            throughput += most.throughput / draws;
            keep_less(&mut worst, most);
        }
        let worst = worst?;
        rows.push(WaveBound { throughput, limit: worst.limit, busiest, share, fits });
        keep_less(&mut least, worst);
    }
    let throughput = rows.iter().map(|row| row.throughput).sum::<f64>() / rows.len() as f64;
    let Most { limit, used, .. } = least?;
    Some(Bound { throughput, limit, used, waves: rows })
}

fn keep_less(least: &mut Option<Most>, most: Most) {
    if least.as_ref().is_none_or(|least| most.throughput < least.throughput) {
        *least = Some(most);
    }
}
