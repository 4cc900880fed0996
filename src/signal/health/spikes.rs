//! Samples that jump there and back: a bit that was lost on the way, a code for "no value". What a sensor sees passes a
//! low-pass first, so that an impact spreads over several samples: of the second order with its corner at a quarter of the rate
//! or below, the samples beside the peak of its answer to an impulse span at least 0.4 of it.

use super::super::{Channel, Run};

/// Samples a time constant, at least, for a spike to differ from an impact.
const SAMPLED: f64 = 4.0;
/// A spike is off its neighbours by so many times their range, and by so many deviations of the channel.
const OFF: f64 = 10.0;
const DEVIATIONS: f64 = 8.0;
/// Samples of one value in a row that may be one spike.
const LONGEST: usize = 5;
/// Neighbours on each side.
const BESIDE: usize = 2;

/// The samples of a channel with a deviation that are spikes.
pub fn spikes(run: &Run, channel: Channel, samples: &[f64], deviation: f64) -> Vec<usize> {
    let turns = Channel::WheelSpeedSteerLeft <= channel && channel <= Channel::WheelSpeedRunRight;
    let low_passed = channel.is_force() && run.rate() >= SAMPLED * run.sidecar.lowpass;
    if !(turns || low_passed) {
        return Vec::new();
    }
    let mut found = Vec::new();
    let mut from = 0;
    for row in samples.chunk_by(|a, b| a == b) {
        let to = from + row.len();
        let far = |x: f64| (row[0] - x).abs() > DEVIATIONS * deviation;
        // Most samples are near the one before.
        if row.len() <= LONGEST && from >= BESIDE && to + BESIDE <= samples.len() && far(samples[from - 1]) {
            let beside = || samples[from - BESIDE..from].iter().chain(&samples[to..to + BESIDE]);
            let (low, high) = beside().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
            let middle = 0.5 * (low + high);
            let known = beside().all(|x| x.is_finite());
            if known && far(middle) && (row[0] - middle).abs() > OFF * (high - low) {
                found.extend(from..to);
            }
        }
        from = to;
    }
    found
}
