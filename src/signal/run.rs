//! A run: samples in columns over time, and its sidecar.

use super::{Channel, Sidecar};
use std::collections::BTreeMap;

/// What a sensor cart brought home, or a simulation wrote in its stead.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Run {
    /// s, strictly increasing.
    pub time: Vec<f64>,
    /// As long as `time`; NaN is a lost sample. A channel that is not there was not fitted.
    pub channels: BTreeMap<Channel, Vec<f64>>,
    pub sidecar: Sidecar,
}

impl Run {
    /// Samples a second: one over the median step of time, to a µHz, as the differences of decimal times are noisy in
    /// their last digits, Hz. 0 for fewer than two samples.
    pub fn rate(&self) -> f64 {
        let mut steps: Vec<f64> = self.time.windows(2).map(|w| w[1] - w[0]).collect();
        if steps.is_empty() {
            return 0.0;
        }
        let middle = steps.len() / 2;
        let (_, median, _) = steps.select_nth_unstable_by(middle, f64::total_cmp);
        let rounded = (1e6 / *median).round() / 1e6;
        // Steps of weeks, or of no time that a recorder has.
        if rounded > 0.0 && rounded.is_finite() { rounded } else { (1.0 / *median).min(f64::MAX) }
    }

    /// From the first sample to the end of the last one's step, s.
    pub fn duration(&self) -> f64 {
        match (self.time.first(), self.time.last()) {
            (Some(first), Some(last)) if last > first => last - first + 1.0 / self.rate(),
            _ => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Found by random edits of a record: a step of 136 years had a rate of 0, and so no end.
    #[test]
    fn steps_of_any_length_have_a_rate_and_an_end() {
        for step in [1e-308, 0.002, 4_294_967_296.0] {
            let run = Run { time: vec![0.0, step, 2.0 * step], ..Run::default() };
            assert!(run.rate() > 0.0 && run.rate().is_finite(), "{step}: {}", run.rate());
            assert!((run.duration() / (3.0 * step) - 1.0).abs() < 1e-9, "{step}: {}", run.duration());
        }
    }
}
