//! What of the lap a run covers, and how often. A run begins and ends anywhere and has gaps, so that some places are
//! measured twice and others not at all, and within a cell some of a cart's passing. Measured samples count less the
//! more often their place was passed, so that every passage counts the same, and simulated ones only where the run
//! measured: both are then means over the same places.
//!
//! They are means over time, not over distance: where a chain swings, its speed and its forces go together, and a place
//! that is passed slowly has more samples, measured as simulated.
//!
//! Parts of the lap are counted from the trigger, as a run knows no other places.

use super::places::part;
use crate::signal::FORCES;

/// Samples of one passage that a part of the lap is long.
const SAMPLES: f64 = 4.0;

/// Parts of a lap at most.
const MOST: f64 = 16384.0;

/// What of the lap each force was measured on.
#[derive(Clone, Debug)]
pub struct Coverage {
    lap: f64,
    parts: usize,
    /// Of single samples.
    samples: [Passes; FORCES],
    /// Of the middles of a spectrum's segments.
    segments: [Passes; FORCES],
}

/// How often each part of the lap is passed.
#[derive(Clone, Debug, Default)]
struct Passes {
    /// Passes of each part; 0 where it is not covered.
    count: Vec<f32>,
    /// What a measured sample in each part counts.
    measured: Vec<f32>,
    /// What a simulated one counts.
    simulated: Vec<f32>,
}

impl Coverage {
    /// Of a run whose forces were measured at stations past its trigger, m.
    pub fn new(station: &[f32], forces: [&[f32]; FORCES], lap: f64, rate: f64) -> Coverage {
        let travelled = match station {
            [first, .., last] => f64::from(last - first).max(1e-3 * lap),
            _ => lap,
        };
        let each = travelled / station.len().max(1) as f64;
        let parts = (lap / (SAMPLES * each)).floor().clamp(1.0, MOST) as usize;
        Coverage {
            lap,
            parts,
            samples: forces.map(|values| Passes::of_samples(station, values, lap, parts)),
            segments: forces.map(|values| Passes::of_segments(station, values, lap, parts, (rate, each))),
        }
    }

    /// Whether all of the lap is covered by every force that was measured.
    pub fn is_whole(&self) -> bool {
        self.samples.iter().all(|passes| passes.count.iter().all(|n| *n > 0.0))
    }
}

impl Passes {
    fn of_samples(station: &[f32], values: &[f32], lap: f64, parts: usize) -> Passes {
        if values.is_empty() {
            return Passes::default();
        }
        let mut count = vec![0.0_f32; parts];
        let mut before = None;
        for (s, x) in station.iter().zip(values) {
            let part = (!x.is_nan()).then(|| part(f64::from(*s), lap, parts) as usize);
            if let Some(part) = part {
                count[part] += if before == Some(part) { 0.0 } else { 1.0 };
            }
            before = part;
        }
        Passes {
            measured: count.iter().map(|n| if *n > 0.0 { 1.0 / n } else { 0.0 }).collect(),
            simulated: count.iter().map(|n| n.min(1.0)).collect(),
            count,
        }
    }

    /// A segment tells of places up to the middle of the next, ever less: triangles that add up to 1 along a passage.
    fn of_segments(station: &[f32], values: &[f32], lap: f64, parts: usize, (rate, each): (f64, f64)) -> Passes {
        let hop = hop(rate);
        let reach = (hop as f64 * each / lap * parts as f64).max(1.0);
        let mut count = vec![0.0_f32; if values.is_empty() { 0 } else { parts }];
        for begin in (0..values.len()).step_by(hop) {
            let Some(segment) = values.get(begin..begin + 2 * hop) else { break };
            if segment.iter().any(|x| x.is_nan()) {
                continue;
            }
            let middle = part(f64::from(station[begin + hop]), lap, parts) as i64;
            for off in -(reach as i64)..=reach as i64 {
                let share = 1.0 - off.abs() as f64 / reach;
                count[(middle + off).rem_euclid(parts as i64) as usize] += share as f32;
            }
        }
        Passes {
            measured: count.iter().map(|n| 1.0 / n.max(1.0)).collect(),
            simulated: count.iter().map(|n| n.min(1.0)).collect(),
            count,
        }
    }
}

/// What a sample counts.
#[derive(Clone, Copy, Debug)]
pub struct Weight {
    pub own: f64,
    /// The same over how often its place was passed.
    pub shared: f64,
}

impl Weight {
    /// Of a sample like all others.
    pub const ONE: Weight = Weight { own: 1.0, shared: 1.0 };
}

/// How samples are weighed.
#[derive(Clone, Copy)]
pub enum Weighing<'a> {
    /// All the same.
    Alike,
    /// Those of the run itself: every place the same.
    Measured(&'a Coverage),
    /// Simulated ones, where the run measured with its trigger at a place, m.
    Within(&'a Coverage, f64),
}

impl Weighing<'_> {
    /// Part of the lap in which a station is weighed.
    #[inline(always)]
    pub fn part(self, station: f32) -> u32 {
        let (coverage, from) = match self {
            Weighing::Alike => return 0,
            Weighing::Measured(coverage) => (coverage, 0.0),
            Weighing::Within(coverage, trigger) => (coverage, trigger),
        };
        part(f64::from(station) - from, coverage.lap, coverage.parts)
    }

    /// Of a sample of a force in a part; all alike where the force was not measured.
    #[inline(always)]
    pub fn sample(self, force: usize, part: u32) -> Weight {
        self.of(|coverage| &coverage.samples[force], part)
    }

    /// Of a spectrum's segment by its middle.
    #[inline(always)]
    pub fn segment(self, force: usize, part: u32) -> Weight {
        self.of(|coverage| &coverage.segments[force], part)
    }

    #[inline(always)]
    fn of<'a>(&'a self, which: impl Fn(&'a Coverage) -> &'a Passes, part: u32) -> Weight {
        let part = part as usize;
        match self {
            Weighing::Measured(coverage) if !which(coverage).count.is_empty() => {
                let passes = which(coverage);
                let own = f64::from(passes.measured[part]);
                Weight { own, shared: own / f64::from(passes.count[part].max(1.0)) }
            }
            Weighing::Within(coverage, _) if !which(coverage).count.is_empty() => {
                let simulated = f64::from(which(coverage).simulated[part]);
                Weight { own: simulated, shared: simulated }
            }
            _ => Weight::ONE,
        }
    }
}

/// Length of a spectrum's segment, s.
const SEGMENT_S: f64 = 4.0;

/// Samples between the beginnings of a spectrum's segments, half of one.
pub(super) fn hop(rate: f64) -> usize {
    ((SEGMENT_S * rate).round() as usize).max(16).next_power_of_two() / 2
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1.25 laps of 40 m at 2 m/s from 10 m before the trigger on, with samples lost from 15 to 17 m.
    fn coverage() -> Coverage {
        let station: Vec<f32> = (0..12_500_i16).map(|i| 0.004 * f32::from(i) - 9.999).collect();
        let force: Vec<f32> = station.iter().map(|s| if (15.0..17.0).contains(s) { f32::NAN } else { 1.0 }).collect();
        let mut forces: [&[f32]; FORCES] = [&[]; FORCES];
        forces[4] = &force;
        Coverage::new(&station, forces, 40.0, 500.0)
    }

    #[test]
    fn what_was_passed_twice_counts_half_and_what_was_lost_nothing() {
        let coverage = coverage();
        assert!(!coverage.is_whole());
        let sample = |weighing: Weighing, force: usize, s: f32| weighing.sample(force, weighing.part(s));
        let measured = |s: f32| sample(Weighing::Measured(&coverage), 4, s);
        // The last quarter of a lap before the trigger was passed at the end, too.
        for s in [-5.0, 35.0] {
            assert_eq!((measured(s).own, measured(s).shared), (0.5, 0.25), "{s}");
        }
        assert_eq!((measured(5.0).own, measured(16.0).own), (1.0, 0.0));
        let within = |s: f32| sample(Weighing::Within(&coverage, 3.0), 4, s).own;
        assert_eq!((within(18.9), within(8.0), within(38.0 - 40.0)), (0.0, 1.0, 1.0));
        assert_eq!(sample(Weighing::Within(&coverage, 3.0), 0, 18.9).own, 1.0, "not measured, hence not limited");
    }

    #[test]
    fn segments_with_losses_tell_nothing() {
        let coverage = coverage();
        let weighing = Weighing::Within(&coverage, 0.0);
        let within = |s: f32| weighing.segment(4, weighing.part(s)).own;
        assert_eq!(within(16.0), 0.0);
        assert!(within(2.0) > 0.9 && within(28.0) > 0.9, "{} {}", within(2.0), within(28.0));
    }
}
