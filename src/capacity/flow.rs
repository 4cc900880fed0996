//! Closed form: the flow over each stretch of the loop, and what limits it (Fedtke and Boysen 2017, §3: a sorter is
//! as good as its most used stretch).

use super::sorter::{Chute, Induction, Sorter, Waves};
use crate::base::trig;

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

/// The most with one set of shares.
pub(super) struct Most {
    pub throughput: f64,
    pub limit: Limit,
    /// Carriers in use behind each induction, as a share of all that pass.
    pub used: Vec<f64>,
    /// Of each chute, of all items.
    pub shares: Vec<f64>,
    /// Items an hour with which no chute becomes full; infinite where none ever does.
    pub fits: f64,
    /// Carriers that an item uses on every stretch because its chute was down.
    pub round: f64,
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

/// Two throughputs whose ratio is nearer to 1 limit alike.
const ALIKE: f64 = 1e-7;

/// Items from inductions to chutes, with one set of shares.
pub(super) struct Flow<'a> {
    pub sorter: &'a Sorter,
    /// Of the items of an induction, by induction and chute.
    pub to: Vec<Vec<f64>>,
    /// Carriers that an item of an induction uses while no chute fails: by induction, and by the one behind which it does.
    pub used: Vec<Vec<f64>>,
}

impl<'a> Flow<'a> {
    /// `shares` are those of the chutes, in relation to each other; `reads` says whether the scanners
    /// work, all of them or none. `None` without an induction, or where the items of one have nowhere to go.
    pub fn new(sorter: &'a Sorter, shares: &[f64], reads: bool) -> Option<Self> {
        let normalised = |induction: &Induction| {
            let shares = induction.shares(shares);
            let all: f64 = shares.iter().sum();
            (all > 0.0).then(|| shares.iter().map(|share| share / all).collect::<Vec<f64>>())
        };
        let to = sorter.inductions.iter().map(normalised).collect::<Option<Vec<_>>>()?;
        let used = sorter.inductions.iter().zip(&to).map(|(from, to)| used(sorter, from, to, reads)).collect();
        (!sorter.inductions.is_empty()).then_some(Flow { sorter, to, used })
    }

    /// Where items come to the inductions in these proportions; `None` where none come.
    pub fn most(&self, proportions: &[f64]) -> Option<Most> {
        let sorter = self.sorter;
        let all: f64 = proportions.iter().sum();
        if all <= 0.0 {
            return None;
        }
        let parts: Vec<f64> = proportions.iter().map(|of| of / all).collect();
        let mean = |of: &[Vec<f64>], k: usize| parts.iter().zip(of).map(|(part, of)| part * of[k]).sum::<f64>();
        let used: Vec<f64> = (0..sorter.inductions.len()).map(|at| mean(&self.used, at)).collect();
        let shares: Vec<f64> = (0..sorter.chutes.len()).map(|c| mean(&self.to, c)).collect();
        let mut best = (f64::INFINITY, Limit::Stretch(0));
        let mut offer = |throughput: f64, limit: Limit| {
            if throughput < best.0 * (1.0 - ALIKE) {
                best.1 = limit;
            }
            best.0 = best.0.min(throughput);
        };
        for (i, used) in used.iter().enumerate() {
            if *used > 0.0 {
                offer(self.through(*used, &shares), Limit::Stretch(i));
            }
        }
        for (i, induction) in sorter.inductions.iter().enumerate() {
            if parts[i] > 0.0 {
                offer(sorter.most_of(induction) / parts[i], Limit::Induction(i));
            }
        }
        let rooms = self.rooms(&shares);
        if let Some(first) = rooms.first() {
            offer(self.until_full(&rooms), Limit::Chute(first.chute));
        }
        let available = sorter.stops.map_or(1.0, |s| s.between / (s.between + s.duration));
        let (throughput, limit) = best;
        let round = self.going_round(throughput, &shares);
        let used = used.iter().map(|u| (u + round) * throughput / sorter.carriers_per_hour()).collect();
        let fits = rooms.first().map_or(f64::INFINITY, |room| room.first);
        Some(Most { throughput: throughput * available, limit, used, shares, fits, round })
    }

    /// Carriers an hour that pass a place and become free: none do in what of a changeover is beyond a lap.
    pub fn carriers(&self) -> f64 {
        let still = |waves: &Waves| (waves.changeover - self.sorter.lap()).max(0.0) / waves.every;
        self.sorter.carriers_per_hour() * (1.0 - self.sorter.waves.as_ref().map_or(0.0, still))
    }

    /// Items an hour that can wait on all carriers for the next wave, which empties the chutes.
    pub fn waiting(&self) -> f64 {
        let Sorter { carriers, items, waves, .. } = self.sorter;
        waves.as_ref().map_or(0.0, |waves| *carriers as f64 / (1.0 + items.double) * 3600.0 / waves.every)
    }

    /// Chutes that may become full, the first to do so first, with these shares of all items.
    fn rooms(&self, shares: &[f64]) -> Vec<Room> {
        let room = |(k, (chute, share)): (usize, (&Chute, &f64))| {
            let hourly = self.sorter.most_into(chute)?;
            (*share > 0.0).then_some(Room { chute: k, share: *share, hourly, first: hourly / share })
        };
        let mut rooms: Vec<Room> = self.sorter.chutes.iter().zip(shares).enumerate().filter_map(room).collect();
        rooms.sort_by(|a, b| a.first.total_cmp(&b.first));
        rooms
    }

    /// Items an hour with which the first chute is full, or with waves, with which all carriers are in use by items that wait
    /// for the next one.
    fn until_full(&self, rooms: &[Room]) -> f64 {
        if self.sorter.waves.is_none() {
            return rooms.first().map_or(f64::INFINITY, |room| room.first);
        }
        let (mut taken, mut share) = (self.waiting(), 0.0);
        for (k, room) in rooms.iter().enumerate() {
            taken += room.hourly;
            share += room.share;
            if rooms.get(k + 1).is_none_or(|next| taken / share <= next.first) {
                return taken / share;
            }
        }
        f64::INFINITY
    }

    /// Items an hour over a stretch that an item uses so many carriers of, beside those that go round because of failures.
    fn through(&self, used: f64, shares: &[f64]) -> f64 {
        let carriers = self.carriers();
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
    fn going_round(&self, throughput: f64, shares: &[f64]) -> f64 {
        let Sorter { chutes, items, .. } = self.sorter;
        let carriers = 1.0 + items.double;
        let passing = throughput * carriers / self.sorter.carriers_per_hour();
        let of = |(chute, share): (&Chute, &f64)| {
            let fails = chute.fails.as_ref()?;
            let laps = fails.laps(self.sorter.lap(), items.most_laps);
            let once_down = laps / (1.0 - fails.available());
            Some(carriers * share * laps / (1.0 + once_down * share * passing))
        };
        chutes.iter().zip(shares).filter_map(of).sum()
    }
}

/// Carriers that an item of an induction uses behind each induction while no chute fails, if it goes to the chutes with these
/// shares; `reads` as in [`Flow::new`].
fn used(sorter: &Sorter, from: &Induction, to: &[f64], reads: bool) -> Vec<f64> {
    let length = sorter.length();
    let ahead = |from: f64, to: f64| (to - from).rem_euclid(length);
    let carriers = 1.0 + sorter.items.double;
    let count = sorter.scanners.len();
    let missed = |passed: usize| trig::pow(sorter.items.no_read, passed as f64);
    let mut used = vec![0.0; sorter.inductions.len()];
    for (chute, share) in sorter.chutes.iter().zip(to) {
        let direct = ahead(from.s, chute.s);
        // Laps until a scanner has read it: an item that passes a chute before any of them goes round for certain.
        let passed = sorter.scanners.iter().filter(|scanner| ahead(from.s, scanner.s) <= direct).count();
        let round = match (count, reads) {
            (0, _) => 0.0,
            (_, true) => missed(passed) / (1.0 - missed(count)),
            (_, false) => sorter.items.most_laps as f64 - if passed > 0 { 1.0 } else { 0.0 },
        };
        let late = sorter.waves.as_ref().map_or(0.0, |waves| {
            let travel = direct / sorter.speed + if count > 0 && passed == 0 { sorter.lap() } else { 0.0 };
            waves.changeover.min(sorter.lap()).min(travel) / waves.every
        });
        let laps = round + late;
        // An item that made its laps leaves at the next chute.
        let next = || sorter.chutes.iter().map(|other| ahead(chute.s, other.s)).filter(|way| *way > 0.0);
        let leaves = if reads { direct } else { direct + next().fold(length, f64::min) };
        for (at, used) in sorter.inductions.iter().zip(&mut used) {
            let behind = ahead(from.s, at.s);
            let passes = laps + [behind, behind + length].into_iter().filter(|way| *way < leaves).count() as f64;
            *used += share * carriers * passes;
        }
    }
    used
}
