//! Means of several simulations with their intervals, after a warm-up that is found and not guessed.

use super::simulate::{Counts, Plan, Seen, simulate};
use super::sorter::{Sorter, Waves};
use super::warm_up;
use crate::base::stop::Stop;
use crate::base::{parallel, student};
use schemars::JsonSchema;
use serde::Serialize;
use std::ops::Range;

/// How much is simulated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Simulated time of each replication, h.
    pub hours: f64,
    pub replications: usize,
    /// The same seed gives two sorters the same items (common random numbers).
    pub seed: u64,
    pub threads: usize,
    /// When to end early: what is found then counts for nothing.
    pub stop: Stop,
}

impl Default for Settings {
    fn default() -> Self {
        Settings { hours: 8.0, replications: 10, seed: 1, threads: 1, stop: Stop::NEVER }
    }
}

/// A mean over replications, and half the width of its interval of 95 % (Student).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Mean {
    pub value: f64,
    pub half_width: f64,
}

impl Mean {
    /// Of independent values; one alone says nothing of its scatter.
    pub fn of(values: &[f64]) -> Mean {
        let n = values.len() as f64;
        let value = values.iter().sum::<f64>() / n;
        if values.len() < 2 {
            return Mean { value, half_width: f64::INFINITY };
        }
        let variance = values.iter().map(|x| (x - value) * (x - value)).sum::<f64>() / (n - 1.0);
        Mean { value, half_width: student::two_sided(0.95, values.len() - 1) * (variance / n).sqrt() }
    }
}

/// What replications say together.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measured {
    /// Items given out an hour, after the warm-up; with waves, in whole cycles of them.
    pub throughput: Mean,
    /// The same of each replication.
    pub each: Vec<f64>,
    /// What is left out at the begin of each replication, s.
    pub warm_up: f64,
    /// From coming to being given out, s.
    pub time: Mean,
    /// Carriers that pass a place in an hour, stops counted.
    pub passing: f64,
    /// Carriers that are in use before and behind each induction, as a share of those that pass.
    pub used: Vec<(f64, f64)>,
    /// Items an hour of each induction, and how long they wait, s.
    pub inductions: Vec<(f64, f64)>,
    /// Items that wait at the end, in the mean.
    pub queues: Vec<f64>,
    /// Share of the carriers that passed an induction while it worked.
    pub available: Vec<f64>,
    /// Items an hour of each chute, and the share of those that came which found it full.
    pub chutes: Vec<(f64, f64)>,
    /// The shares of those that found it down.
    pub chutes_down: Vec<f64>,
    /// Items an hour given out in each wave, until they repeat.
    pub waves: Vec<f64>,
    /// Laps in vain an item: readings that failed, chutes that were full, down, and closed between two waves.
    pub unread: f64,
    pub refused: f64,
    pub down: f64,
    pub closed: f64,
    /// Items at another chute than theirs, as a share of all.
    pub misplaced: f64,
    /// Item events that were simulated.
    pub events: u64,
}

/// Length of an interval of the series, s, or a little else where waves are no whole number of them.
const INTERVAL: f64 = 60.0;

/// Simulates replications of a sorter that begins empty.
pub fn measure(sorter: &Sorter, settings: &Settings) -> Measured {
    let numbers: Vec<u64> = (0..settings.replications.max(1) as u64).collect();
    let waves = sorter.waves.as_ref();
    let interval = waves.map_or(INTERVAL, |w| w.every / (w.every / INTERVAL).round().max(1.0));
    let plan = |k: u64| Plan {
        duration: 3600.0 * settings.hours,
        seed: settings.seed.wrapping_mul(1_000_003).wrapping_add(k),
        interval,
    };
    let seen: Vec<Seen> = parallel::map(&numbers, settings.threads, |k| simulate(sorter, &plan(*k), settings.stop));
    if settings.stop.now() {
        return Measured::default();
    }
    let count = seen.len() as f64;
    // The last interval may be cut.
    let length = (plan(0).duration / interval + 1e-9) as usize;
    // The mean over replications shows the begin more clearly than each of them (Welch 1983).
    let series: Vec<f64> =
        (0..length).map(|t| seen.iter().map(|s| f64::from(s.series[t])).sum::<f64>() / count).collect();
    let cycle = waves.map_or(1, |w| (w.cycle() / interval).round() as usize);
    let kept = whole_cycles(warm_up::truncation(&series), length, cycle);
    let per_hour = |s: &Seen| {
        let kept = &s.series[kept.clone()];
        kept.iter().map(|n| f64::from(*n)).sum::<f64>() / kept.len().max(1) as f64 * 3600.0 / interval
    };
    let each: Vec<f64> = seen.iter().map(per_hour).collect();
    let throughput = Mean::of(&each);
    // All else is of the same time.
    let (counted, marked): (Vec<Counts>, Vec<bool>) = seen.iter().map(|s| s.within(&kept)).unzip();
    let end = if marked.iter().all(|known| *known) { kept.end as f64 * interval } else { plan(0).duration };
    let hours = (end - kept.start as f64 * interval) / 3600.0;
    let time = Mean::of(&counted.iter().map(|s| s.time / s.items.max(1) as f64).collect::<Vec<_>>());
    let mean = |of: &dyn Fn(&Counts) -> f64| counted.iter().map(of).sum::<f64>() / count;
    let share = |part: u64, all: u64| if all == 0 { 0.0 } else { part as f64 / all as f64 };
    let of_inductions = |of: &dyn Fn(&super::simulate::InductionSeen) -> f64| -> Vec<f64> {
        (0..sorter.inductions.len()).map(|i| mean(&|s| of(&s.inductions[i]))).collect()
    };
    let carriers = 1.0 + sorter.items.double;
    let before = of_inductions(&|i| 1.0 - share(i.free, i.passed));
    let added = of_inductions(&|i| share(i.items, i.passed) * carriers);
    let rates = of_inductions(&|i| i.items as f64 / hours);
    let waits = of_inductions(&|i| i.waited / i.items.max(1) as f64);
    let chutes = (0..sorter.chutes.len()).map(|c| {
        let rate = mean(&|s| s.chutes[c].items as f64) / hours;
        (rate, mean(&|s| share(s.chutes[c].refused, s.chutes[c].came())))
    });
    let of_wave = |k: usize| {
        let Some(waves) = waves else { return 0.0 };
        let cycles = (plan(0).duration / waves.cycle()).floor() - 1.0;
        seen.iter().map(|s| s.waves[k] as f64).sum::<f64>() / count * 3600.0 / (cycles.max(1.0) * waves.every)
    };
    Measured {
        throughput,
        each,
        warm_up: kept.start as f64 * interval,
        time,
        passing: of_inductions(&|i| i.passed as f64 / hours).first().copied().unwrap_or(0.0),
        used: before.iter().zip(&added).map(|(b, a)| (*b, (b + a).min(1.0))).collect(),
        inductions: rates.into_iter().zip(waits).collect(),
        queues: (0..sorter.inductions.len())
            .map(|i| seen.iter().map(|s| s.queues[i] as f64).sum::<f64>() / count)
            .collect(),
        available: of_inductions(&|i| 1.0 - share(i.down, i.passed)),
        chutes: chutes.collect(),
        chutes_down: (0..sorter.chutes.len()).map(|c| mean(&|s| share(s.chutes[c].down, s.chutes[c].came()))).collect(),
        waves: (0..waves.map_or(0, Waves::count)).map(of_wave).collect(),
        unread: mean(&|s| share(s.unread, s.items)),
        refused: mean(&|s| share(s.refused, s.items)),
        down: mean(&|s| share(s.down, s.items)),
        closed: mean(&|s| share(s.closed, s.items)),
        misplaced: mean(&|s| share(s.misplaced, s.items)),
        events: seen.iter().map(|s| s.events).sum(),
    }
}

/// What is kept of a series: behind its beginning, and with waves whole cycles of them behind the first, which begins
/// without a changeover.
fn whole_cycles(skip: usize, length: usize, cycle: usize) -> Range<usize> {
    let whole = length / cycle.max(1);
    if cycle <= 1 || whole < 2 {
        return skip.min(length)..length;
    }
    skip.div_ceil(cycle).clamp(1, whole - 1) * cycle..whole * cycle
}
