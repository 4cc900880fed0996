//! The noise of a sensor: white noise and processes of first order (Uhlenbeck and Ornstein 1930), of covariance
//! σ² exp(−t/τ), so that a mean over a time T has the variance 2 σ² (T/τ − 1 + exp(−T/τ)) (τ/T)².

use crate::base::number::{significant, tidy};
use crate::base::random::{add_correlated, noisy};
use crate::base::trig;
use crate::signal::{Channel, FORCES};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Samples of noise that are drawn: a thousand correlation times of half a second, and of noise that drifts more.
const DRAWN: usize = 1 << 18;
const DRAWN_OF_DRIFT: usize = 1 << 20;

/// Processes of first order that correlated noise is a sum of, at most.
pub const PROCESSES: usize = 3;

/// Noise that lasts as long as this drifts, s.
pub const DRIFTS: f64 = 10.0;

/// A process of first order, of covariance σ² exp(−t/τ).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Process {
    /// σ², N²; 0 for none.
    pub variance: f64,
    /// τ, s
    pub time: f64,
}

/// A sensor's noise.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Noise {
    /// Deviation of the white noise, N.
    pub white: f64,
    /// What its correlated noise is a sum of.
    pub processes: [Process; PROCESSES],
}

impl From<Process> for Noise {
    fn from(own: Process) -> Noise {
        let none = Process::default();
        Noise { white: 0.0, processes: [own, none, none] }
    }
}

impl Noise {
    /// N²
    pub fn variance(&self) -> f64 {
        self.white * self.white + self.correlated_variance()
    }

    /// The processes that it has.
    pub fn correlated(&self) -> impl Iterator<Item = &Process> {
        self.processes.iter().filter(|own| own.variance > 0.0)
    }

    pub fn correlated_variance(&self) -> f64 {
        self.correlated().map(|own| own.variance).sum()
    }

    /// Of the correlated noise, the integral of its covariance over its variance, s; 0 where there is none.
    pub fn time(&self) -> f64 {
        let all: f64 = self.correlated().map(|own| own.variance * own.time).sum();
        if all > 0.0 { all / self.correlated_variance() } else { 0.0 }
    }

    /// Samples of it at a rate, Hz, long enough that simulated sensors can take theirs anywhere; none of no noise.
    pub fn draw(&self, rate: f64, seed: u64) -> Vec<f32> {
        if self.variance() == 0.0 {
            return Vec::new();
        }
        let drifts = self.correlated().any(|own| own.time >= DRIFTS);
        let samples = if drifts { DRAWN_OF_DRIFT } else { DRAWN };
        let mut drawn = noisy(&vec![0.0; samples], self.white as f32, seed);
        for (k, own) in self.correlated().enumerate() {
            let memory = trig::exp(-1.0 / (rate * own.time));
            add_correlated(&mut drawn, own.variance.sqrt(), memory, !seed.wrapping_add(7919 * k as u64));
        }
        drawn
    }
}

/// A sensor's noise in a report.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ChannelNoise {
    /// Deviation of the white noise, N.
    pub white_n: f64,
    /// Beside it; null where none stands out.
    pub correlated: Option<CorrelatedNoise>,
    /// Step that the values are rounded to, where it shows, N.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub resolution_n: Option<f64>,
}

/// Noise whose covariance falls exponentially.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CorrelatedNoise {
    /// N
    pub deviation_n: f64,
    /// Time in which the covariance falls to 1/e, s.
    pub time_s: f64,
}

/// The noise of the channels that were measured, by name, with the steps that they are rounded to, N.
pub fn channel_noise(
    noise: &[Noise; FORCES],
    steps: &[Option<f64>; FORCES],
    measured: impl Fn(usize) -> bool,
) -> BTreeMap<String, ChannelNoise> {
    let all = Channel::FORCES.iter().zip(noise).enumerate().filter(|(k, _)| measured(*k));
    let report = |(k, noise): (usize, &Noise)| ChannelNoise {
        resolution_n: steps[k].map(tidy),
        white_n: tidy(noise.white),
        correlated: noise.correlated().next().map(|_| CorrelatedNoise {
            deviation_n: tidy(noise.correlated_variance().sqrt()),
            time_s: tidy(noise.time()),
        }),
    };
    all.map(|(k, (channel, noise))| (channel.name().to_owned(), report((k, noise)))).collect()
}

impl ChannelNoise {
    /// In words: `0.5 N white, 0.6 N with 0.3 s`.
    pub fn words(&self) -> String {
        let n = |x: f64| significant(x, 2);
        let steps = self.resolution_n.map_or_else(String::new, |step| format!(", in steps of {} N", n(step)));
        match self.correlated {
            Some(own) => {
                format!("{} N white, {} N with {} s{steps}", n(self.white_n), n(own.deviation_n), n(own.time_s))
            }
            None => format!("{} N white{steps}", n(self.white_n)),
        }
    }
}

/// The variance of means over a time, s, of a process of first order of unit variance with a correlation time, s.
pub fn mean_variance(over: f64, time: f64) -> f64 {
    let share = over / time;
    // Near 0 by its series, as 1 is subtracted from nearly 1.
    if share < 1e-3 {
        return 1.0 - share / 3.0;
    }
    2.0 * (share - 1.0 + trig::exp(-share)) / (share * share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_draw_has_its_deviation_and_its_correlation_time() {
        let noise: Noise = Process { variance: 4.0, time: 0.4 }.into();
        let x = noise.draw(100.0, 5);
        let covariance = |apart: usize| {
            x.iter().zip(&x[apart..]).map(|(a, b)| f64::from(a * b)).sum::<f64>() / (x.len() - apart) as f64
        };
        assert!((covariance(0) / 4.0 - 1.0).abs() < 0.1, "{}", covariance(0));
        assert!((covariance(40) / covariance(0) - trig::exp(-1.0)).abs() < 0.06);
    }
}
