//! Closed form: the flow over each stretch of the loop, and what limits it (Fedtke and Boysen 2017, §3: a sorter is
//! as good as its most used stretch).

use super::sorter::Sorter;

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
    /// Items an hour.
    pub throughput: f64,
    pub limit: Limit,
    /// Carriers in use behind each induction, as a share of all that pass.
    pub used: Vec<f64>,
}

/// The throughput at which something is used up, where items come to the inductions in these proportions.
///
/// An item from an induction to a chute uses a carrier (two, if it is double) on every stretch between them, and on
/// all stretches once more for each lap that it makes in vain: 1/(1 − p) laps in the mean where a reading fails with
/// probability p. Of carriers that pass, the share `efficiency` may be used. `None` without an induction or a chute.
pub fn bound(sorter: &Sorter, proportions: &[f64]) -> Option<Bound> {
    let all: f64 = proportions.iter().sum();
    let shares: f64 = sorter.chutes.iter().map(|c| c.share).sum();
    if sorter.inductions.is_empty() || all <= 0.0 || shares <= 0.0 {
        return None;
    }
    let length = sorter.length();
    let ahead = |from: f64, to: f64| (to - from).rem_euclid(length);
    let carriers = 1.0 + sorter.items.double;
    let vain = if sorter.scanners.is_empty() { 0.0 } else { sorter.items.no_read / (1.0 - sorter.items.no_read) };
    // Carriers in use behind each induction, of an item that comes somewhere.
    let mut used = vec![0.0; sorter.inductions.len()];
    for (from, proportion) in sorter.inductions.iter().zip(proportions) {
        for chute in &sorter.chutes {
            let items = proportion / all * chute.share / shares;
            let scanned = sorter.scanners.iter().map(|s| ahead(from.s, *s)).fold(f64::INFINITY, f64::min);
            let direct = ahead(from.s, chute.s);
            // A chute before the scanner is reached a lap later.
            let laps = vain + if scanned.is_finite() && direct < scanned { 1.0 } else { 0.0 };
            for (at, used) in sorter.inductions.iter().zip(&mut used) {
                let passes = laps + if ahead(from.s, at.s) < direct { 1.0 } else { 0.0 };
                *used += items * carriers * passes;
            }
        }
    }
    let capacity = sorter.carriers_per_hour();
    let mut best = (f64::INFINITY, Limit::Stretch(0));
    let mut offer = |throughput: f64, limit: Limit| {
        if throughput < best.0 {
            best = (throughput, limit);
        }
    };
    for (i, used) in used.iter().enumerate() {
        if *used > 0.0 {
            offer(capacity / used, Limit::Stretch(i));
        }
    }
    for (i, induction) in sorter.inductions.iter().enumerate() {
        if proportions[i] > 0.0 {
            offer(induction.most * all / proportions[i], Limit::Induction(i));
        }
    }
    for (i, chute) in sorter.chutes.iter().enumerate() {
        if let (Some((_, seconds)), true) = (chute.storage, chute.share > 0.0) {
            offer(3600.0 / seconds * shares / chute.share, Limit::Chute(i));
        }
    }
    let available = sorter.stops.map_or(1.0, |s| s.between / (s.between + s.duration));
    let (throughput, limit) = best;
    let used = used.iter().map(|u| u * throughput / capacity).collect();
    Some(Bound { throughput: throughput * available, limit, used })
}
