//! Where carriers are in use along the loop, and what another speed or fewer inductions would give.

use super::bound::bound;
use super::replicate::{Mean, Measured, Settings, measure};
use super::sorter::{Sorter, Waves};

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
    let bound = bound(&sorter, None)?.throughput;
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

/// What one cause takes from a sorter.
#[derive(Clone, Debug, PartialEq)]
pub struct Cost {
    pub cause: Cause,
    /// Items an hour that the sorter would take more without it.
    pub per_hour: Mean,
}

/// What costs throughput.
#[derive(Clone, Debug, PartialEq)]
pub enum Cause {
    Stops,
    /// Of an induction, of all chutes of a row, or of all scanners.
    Failures(String),
    Changeover,
    /// Shares that differ from wave to wave.
    Shares,
}

/// What stops, failures and waves cost, each against the sorter without it and with the same items: `always` is what the
/// sorter takes with items at every induction at any time.
pub fn costs(sorter: &Sorter, always: &Measured, settings: &Settings) -> Vec<Cost> {
    causes(sorter)
        .into_iter()
        .map(|cause| {
            let spared = measure(&without(sorter, &cause).always_fed(), settings);
            let more: Vec<f64> = spared.each.iter().zip(&always.each).map(|(spared, has)| spared - has).collect();
            Cost { cause, per_hour: Mean::of(&more) }
        })
        .collect()
}

fn causes(sorter: &Sorter) -> Vec<Cause> {
    let mut all: Vec<Cause> = sorter.stops.iter().map(|_| Cause::Stops).collect();
    let inductions = sorter.inductions.iter().map(|i| &i.fails);
    let equipment =
        inductions.chain(sorter.chutes.iter().map(|c| &c.fails)).chain(sorter.scanners.iter().map(|s| &s.fails));
    for fails in equipment.flatten() {
        let cause = Cause::Failures(fails.name.clone());
        if !all.contains(&cause) {
            all.push(cause);
        }
    }
    if let Some(waves) = &sorter.waves {
        all.extend((waves.changeover > 0.0).then_some(Cause::Changeover));
        all.extend((waves.spread > 0.0 || waves.each.len() > 1).then_some(Cause::Shares));
    }
    all
}

fn without(sorter: &Sorter, cause: &Cause) -> Sorter {
    let mut spared = sorter.clone();
    match cause {
        Cause::Stops => spared.stops = None,
        Cause::Failures(name) => {
            let inductions = spared.inductions.iter_mut().map(|i| &mut i.fails);
            let chutes = spared.chutes.iter_mut().map(|c| &mut c.fails);
            let scanners = spared.scanners.iter_mut().map(|s| &mut s.fails);
            for fails in inductions.chain(chutes).chain(scanners) {
                if fails.as_ref().is_some_and(|fails| fails.name == *name) {
                    *fails = None;
                }
            }
        }
        Cause::Changeover => spared.waves.iter_mut().for_each(|waves| waves.changeover = 0.0),
        Cause::Shares => {
            let mean = mean_shares(sorter);
            if let Some(waves) = &mut spared.waves {
                waves.spread = 0.0;
                waves.each.iter_mut().for_each(|wave| wave.shares.clone_from(&mean));
            }
        }
    }
    spared
}

/// The share of each chute of all items, in the mean over the waves.
fn mean_shares(sorter: &Sorter) -> Vec<f64> {
    let mut mean = vec![0.0; sorter.chutes.len()];
    for wave in 0..sorter.waves.as_ref().map_or(1, Waves::count) {
        let shares = sorter.shares(wave);
        let all: f64 = shares.iter().sum();
        mean.iter_mut().zip(shares).for_each(|(mean, share)| *mean += share / all);
    }
    mean
}
