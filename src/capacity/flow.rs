//! Closed form: the flow over each stretch of the loop, and what limits it (Fedtke and Boysen 2017, §3: a sorter is
//! as good as its most used stretch).

use super::sorter::{Chute, Sorter};
use super::stream::{Cause, stream};
use super::waves::drawn;

/// What limits a sorter's throughput.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Limit {
    /// Carriers, on the stretch behind the induction of this index.
    Stretch(usize),
    /// What this induction can put on carriers.
    Induction(usize),
    /// How fast items are taken from this chute.
    Chute(usize),
}

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
    /// Whether no way of feeding the sorter beats it. Where chutes fail it is a mean over which of them are down; and where
    /// full chutes limit it, items that `items laps` lets leave anywhere come on top.
    pub fn is_strict(&self, sorter: &Sorter) -> bool {
        let full = |limit: Limit| matches!(limit, Limit::Chute(_)) && sorter.items.most_laps != usize::MAX;
        let limits = self.waves.iter().map(|wave| wave.limit).chain([self.limit]);
        sorter.chutes.iter().all(|chute| chute.fails.is_none()) && !limits.into_iter().any(full)
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

/// The throughput at which something is used up, where items come to the inductions in these proportions.
///
/// An item from an induction to a chute uses a carrier (two, if it is double) on every stretch between them, and on
/// all stretches once more for each lap that it makes in vain: 1/(1 − p) laps in the mean where a reading fails with
/// probability p. An induction puts nothing on the carriers that pass while it is down. `None` without an induction or a
/// chute.
///
/// Where a chute with the share p of R items an hour fails, an item goes round for f laps in the mean
/// ([`Failures::laps`](super::sorter::Failures::laps)), if it meets the chute down for g. What goes round leaves less room
/// for what follows: of N carriers, S with items for that chute, S grows by R p (1 - S/N), so that f is
/// f / (1 + g p R/Q) after all.
///
/// Waves that begin T apart close chutes for c. Of the items that are on the sorter then, those that are due within c
/// make a lap more: with a time of travel τ, and in the mean over all items, they are E[min(c, τ)]/T of all. In what of c
/// is beyond a lap, no carrier becomes free. A chute that holds H items takes H and what is taken away in T − c; what is
/// beyond that waits on carriers for the next wave. The mean is that over the waves, and over some that are drawn.
pub fn bound(sorter: &Sorter, proportions: &[f64]) -> Option<Bound> {
    let Some(waves) = &sorter.waves else {
        let one = Flow { sorter, proportions, shares: &sorter.shares(0) }.most()?;
        return Some(Bound { throughput: one.throughput, limit: one.limit, used: one.used, waves: Vec::new() });
    };
    let mut random = stream(0, Cause::Waves, 0);
    let draws = if waves.spread > 0.0 { DRAWN } else { 1 };
    let mut least: Option<Most> = None;
    let mut rows = Vec::new();
    for wave in 0..waves.count() {
        let said = sorter.shares(wave);
        let largest = said.iter().copied().fold(0.0, f64::max);
        let busiest = said.iter().position(|share| *share == largest)?;
        let (mut throughput, mut share, mut fits) = (0.0, 0.0, 0.0);
        let mut worst: Option<Most> = None;
        for _ in 0..draws {
            let shares = drawn(said.clone(), waves.spread, &mut random);
            share += shares.iter().copied().fold(0.0, f64::max) / shares.iter().sum::<f64>() / draws as f64;
            let flow = Flow { sorter, proportions, shares: &shares };
            fits += flow.rooms().first().map_or(f64::INFINITY, |room| room.first) / draws as f64;
            let most = flow.most()?;
            throughput += most.throughput / draws as f64;
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

/// The most with one set of shares.
struct Most {
    throughput: f64,
    limit: Limit,
    used: Vec<f64>,
}

fn keep_less(least: &mut Option<Most>, most: Most) {
    if least.as_ref().is_none_or(|least| most.throughput < least.throughput) {
        *least = Some(most);
    }
}

/// What a chute can take.
struct Room {
    chute: usize,
    /// Of all items.
    share: f64,
    /// Items an hour that go in.
    hourly: f64,
    /// Items an hour of the sorter with which these come.
    first: f64,
}

/// Items from inductions to chutes.
struct Flow<'a> {
    sorter: &'a Sorter,
    proportions: &'a [f64],
    shares: &'a [f64],
}

impl Flow<'_> {
    fn most(&self) -> Option<Most> {
        let Flow { sorter, proportions, .. } = self;
        let all: f64 = proportions.iter().sum();
        let shares: f64 = self.shares.iter().sum();
        if sorter.inductions.is_empty() || all <= 0.0 || shares <= 0.0 {
            return None;
        }
        let used = self.used(all, shares);
        // In what of a changeover is beyond a lap.
        let still = sorter.waves.as_ref().map_or(0.0, |waves| (waves.changeover - sorter.lap()).max(0.0) / waves.every);
        let carriers = sorter.carriers_per_hour();
        let mut best = (f64::INFINITY, Limit::Stretch(0));
        let mut offer = |throughput: f64, limit: Limit| {
            if throughput < best.0 {
                best = (throughput, limit);
            }
        };
        for (i, used) in used.iter().enumerate() {
            if *used > 0.0 {
                offer(self.through(*used, carriers * (1.0 - still), shares), Limit::Stretch(i));
            }
        }
        for (i, induction) in sorter.inductions.iter().enumerate() {
            if proportions[i] > 0.0 {
                offer(sorter.most_of(induction) * all / proportions[i], Limit::Induction(i));
            }
        }
        let rooms = self.rooms();
        if let Some(first) = rooms.first() {
            offer(self.until_full(&rooms), Limit::Chute(first.chute));
        }
        let available = sorter.stops.map_or(1.0, |s| s.between / (s.between + s.duration));
        let (throughput, limit) = best;
        let round = self.going_round(throughput, shares);
        let used = used.iter().map(|u| (u + round) * throughput / carriers).collect();
        Some(Most { throughput: throughput * available, limit, used })
    }

    /// Chutes that may become full, the first to do so first.
    fn rooms(&self) -> Vec<Room> {
        let shares: f64 = self.shares.iter().sum();
        let room = |(k, (chute, share)): (usize, (&Chute, &f64))| {
            let (share, hourly) = (share / shares, self.sorter.most_into(chute)?);
            (share > 0.0).then_some(Room { chute: k, share, hourly, first: hourly / share })
        };
        let mut rooms: Vec<Room> = self.sorter.chutes.iter().zip(self.shares).enumerate().filter_map(room).collect();
        rooms.sort_by(|a, b| a.first.total_cmp(&b.first));
        rooms
    }

    /// Items an hour with which the first chute is full, or with waves, with which all carriers are in use by items that wait
    /// for the next one.
    fn until_full(&self, rooms: &[Room]) -> f64 {
        let Some(waves) = &self.sorter.waves else { return rooms.first().map_or(f64::INFINITY, |room| room.first) };
        let waiting = self.sorter.carriers as f64 / (1.0 + self.sorter.items.double) * 3600.0 / waves.every;
        let (mut taken, mut share) = (0.0, 0.0);
        for (k, room) in rooms.iter().enumerate() {
            taken += room.hourly;
            share += room.share;
            let all = (waiting + taken) / share;
            if rooms.get(k + 1).is_none_or(|next| all <= next.first) {
                return all;
            }
        }
        f64::INFINITY
    }

    /// Items an hour over a stretch that an item uses so many carriers of, beside those that go round because of failures.
    fn through(&self, used: f64, carriers: f64, shares: f64) -> f64 {
        let (mut low, mut high) = (0.0, carriers / used);
        if self.sorter.chutes.iter().all(|chute| chute.fails.is_none()) {
            return high;
        }
        // What goes round grows with the throughput, so there is one that fits.
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if middle * (used + self.going_round(middle, shares)) > carriers { high = middle } else { low = middle }
        }
        low
    }

    /// Carriers that an item uses on every stretch because its chute was down, with so many items an hour.
    fn going_round(&self, throughput: f64, shares: f64) -> f64 {
        let Sorter { chutes, items, .. } = self.sorter;
        let carriers = 1.0 + items.double;
        let passing = throughput * carriers / self.sorter.carriers_per_hour();
        let of = |(chute, share): (&Chute, &f64)| {
            let fails = chute.fails.as_ref()?;
            let (p, laps) = (share / shares, fails.laps(self.sorter.lap(), items.most_laps));
            let once_down = laps / (1.0 - fails.available());
            Some(carriers * p * laps / (1.0 + once_down * p * passing))
        };
        chutes.iter().zip(self.shares).filter_map(of).sum()
    }

    /// Carriers in use behind each induction, of an item that comes somewhere, while no chute fails.
    fn used(&self, all: f64, shares: f64) -> Vec<f64> {
        let Flow { sorter, proportions, .. } = self;
        let length = sorter.length();
        let ahead = |from: f64, to: f64| (to - from).rem_euclid(length);
        let carriers = 1.0 + sorter.items.double;
        let unread = if sorter.scanners.is_empty() { 0.0 } else { sorter.items.no_read / (1.0 - sorter.items.no_read) };
        let mut used = vec![0.0; sorter.inductions.len()];
        for (from, proportion) in sorter.inductions.iter().zip(*proportions) {
            for (chute, share) in sorter.chutes.iter().zip(self.shares) {
                let items = proportion / all * share / shares;
                let scanned = sorter.scanners.iter().map(|s| ahead(from.s, *s)).fold(f64::INFINITY, f64::min);
                let direct = ahead(from.s, chute.s);
                // A chute before the scanner is reached a lap later.
                let twice = if scanned.is_finite() && direct < scanned { 1.0 } else { 0.0 };
                let late = sorter.waves.as_ref().map_or(0.0, |waves| {
                    let travel = direct / sorter.speed + twice * sorter.lap();
                    waves.changeover.min(sorter.lap()).min(travel) / waves.every
                });
                let laps = unread + late + twice;
                for (at, used) in sorter.inductions.iter().zip(&mut used) {
                    let passes = laps + if ahead(from.s, at.s) < direct { 1.0 } else { 0.0 };
                    *used += items * carriers * passes;
                }
            }
        }
        used
    }
}
