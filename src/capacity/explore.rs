//! Where carriers are in use along the loop, and what another speed or fewer inductions would give.

use super::flow::bound;
use super::replicate::{Mean, Measured, Settings, measure};
use super::sorter::Sorter;

/// Shares of carriers that are in use behind each place where that changes, by arc length (m), ascending.
///
/// Between inductions, where they are counted, they fall by what each chute takes.
pub fn used_along(sorter: &Sorter, measured: &Measured) -> Vec<(f64, f64)> {
    enum Change {
        To(f64),
        By(f64),
    }
    let carriers = 1.0 + sorter.items.double;
    let passing = measured.passing.max(f64::MIN_POSITIVE);
    let mut changes: Vec<(f64, Change)> = Vec::new();
    for (induction, used) in sorter.inductions.iter().zip(&measured.used) {
        changes.push((induction.s, Change::To(used.1)));
    }
    for (chute, (rate, _)) in sorter.chutes.iter().zip(&measured.chutes) {
        changes.push((chute.s, Change::By(rate * carriers / passing)));
    }
    changes.sort_by(|a, b| a.0.total_cmp(&b.0));
    // What is in use at s = 0 is known behind the first induction only: begin there.
    let first = changes.iter().position(|(_, change)| matches!(change, Change::To(_))).unwrap_or(0);
    let mut share = 0.0;
    let mut shares = vec![0.0; changes.len()];
    for k in 0..changes.len() {
        let at = (first + k) % changes.len();
        share = match changes[at].1 {
            Change::To(used) => used,
            Change::By(taken) => (share - taken).max(0.0),
        };
        shares[at] = share;
    }
    changes.into_iter().zip(shares).map(|((s, _), share)| (s, share)).collect()
}

/// The share at an arc length, m, of what [`used_along`] says.
pub fn used_at(along: &[(f64, f64)], s: f64) -> f64 {
    let behind = along.partition_point(|(at, _)| *at <= s);
    let k = if behind == 0 { along.len() } else { behind };
    along.get(k.wrapping_sub(1)).map_or(0.0, |(_, share)| *share)
}

/// What a changed sorter takes: the closed form, and simulated with items at every induction at any time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Changed {
    /// Speed, m/s, or number of inductions.
    pub of: f64,
    pub bound: f64,
    pub simulated: Mean,
}

fn changed(of: f64, sorter: &Sorter, settings: &Settings) -> Option<Changed> {
    let sorter = sorter.always_fed();
    let bound = bound(&sorter, &sorter.proportions())?.throughput;
    Some(Changed { of, bound, simulated: measure(&sorter, settings).throughput })
}

/// At other speeds, as shares of the layout's.
pub fn by_speed(sorter: &Sorter, shares: &[f64], settings: &Settings) -> Vec<Changed> {
    let faster = |share: &f64| {
        let sorter = Sorter { speed: sorter.speed * share, ..sorter.clone() };
        changed(sorter.speed, &sorter, settings)
    };
    shares.iter().filter_map(faster).collect()
}

/// With the first one, the first two, … of the inductions in driving order.
pub fn by_inductions(sorter: &Sorter, settings: &Settings) -> Vec<Changed> {
    let mut ordered = sorter.inductions.clone();
    ordered.sort_by(|a, b| a.s.total_cmp(&b.s));
    let with = |count: usize| {
        let sorter = Sorter { inductions: ordered[..count].to_vec(), ..sorter.clone() };
        changed(count as f64, &sorter, settings)
    };
    (1..=ordered.len()).filter_map(with).collect()
}
