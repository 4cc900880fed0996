//! Shares, means, curves, each with its 95 % interval.

use crate::base::random::mix;
use serde::Serialize;

/// Deviations of the normal distribution that hold 95 %.
const Z: f64 = 1.959_963_984_540_054;
/// Samples of a bootstrap, and where they begin.
const RESAMPLES: usize = 2000;
const SEED: u64 = 5;

/// Hits among trials, with Wilson's interval (1927).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Share {
    pub hits: usize,
    pub of: usize,
    pub low: f64,
    pub high: f64,
}

impl Share {
    pub fn new(hits: usize, of: usize) -> Self {
        if of == 0 {
            return Share { hits, of, low: 0.0, high: 1.0 };
        }
        let (n, p, square) = (of as f64, hits as f64 / of as f64, Z * Z);
        let middle = (p + square / (2.0 * n)) / (1.0 + square / n);
        let half = Z / (1.0 + square / n) * (p * (1.0 - p) / n + square / (4.0 * n * n)).sqrt();
        Share { hits, of, low: (middle - half).max(0.0), high: (middle + half).min(1.0) }
    }

    pub fn of_all(all: impl IntoIterator<Item = bool>) -> Self {
        let (hits, of) = all.into_iter().fold((0, 0), |(hits, of), hit| (hits + usize::from(hit), of + 1));
        Share::new(hits, of)
    }

    /// `None` of no trials.
    pub fn value(self) -> Option<f64> {
        (self.of > 0).then(|| self.hits as f64 / self.of as f64)
    }
}

/// A number with the interval that resampling gives (Efron 1979, percentiles).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Mean {
    pub value: f64,
    pub low: f64,
    pub high: f64,
    pub of: usize,
}

/// Mean of what is finite; `None` of nothing.
pub fn mean(values: &[f64]) -> Option<Mean> {
    let values: Vec<f64> = values.iter().copied().filter(|x| x.is_finite()).collect();
    let average = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
    let (low, high) = resampled(&[&values], |parts| average(&parts[0]))?;
    Some(Mean { value: average(&values), low, high, of: values.len() })
}

/// Area under the receiver operating characteristic: how often a positive's score is above a negative's, ties by half
/// (Mann and Whitney 1947). `None` without either.
pub fn area(positive: &[f64], negative: &[f64]) -> Option<Mean> {
    let area = |positive: &[f64], negative: &[f64]| {
        // Ranks among the sorted negatives.
        let mut sorted = negative.to_vec();
        sorted.sort_by(f64::total_cmp);
        let won = |p: &f64| {
            let below = sorted.partition_point(|n| n < p);
            let not_above = sorted.partition_point(|n| n <= p);
            0.5 * (below + not_above) as f64
        };
        positive.iter().map(won).sum::<f64>() / (positive.len() * negative.len()) as f64
    };
    let (low, high) = resampled(&[positive, negative], |parts| area(&parts[0], &parts[1]))?;
    Some(Mean { value: area(positive, negative), low, high, of: positive.len() + negative.len() })
}

/// 2.5th and 97.5th percentile of a statistic over resamples of each part; `None` where a part is empty.
fn resampled(parts: &[&[f64]], statistic: impl Fn(&[Vec<f64>]) -> f64) -> Option<(f64, f64)> {
    if parts.iter().any(|p| p.is_empty()) {
        return None;
    }
    let mut state = SEED;
    let mut draw = |part: &[f64]| -> Vec<f64> {
        (0..part.len()).map(|_| part[(mix(&mut state) % part.len() as u64) as usize]).collect()
    };
    let mut found: Vec<f64> =
        (0..RESAMPLES).map(|_| statistic(&parts.iter().map(|part| draw(part)).collect::<Vec<_>>())).collect();
    found.sort_by(f64::total_cmp);
    let at = |share: f64| found[((share * RESAMPLES as f64) as usize).min(RESAMPLES - 1)];
    Some((at(0.025), at(0.975)))
}

/// A bin of the calibration curve: forecasts within a tenth, their mean, and how often they came true.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Bin {
    pub from: f64,
    pub to: f64,
    pub forecast: f64,
    pub came_true: Share,
}

/// Ten bins of forecasts; those without any are left out.
pub fn calibration(forecasts: &[(f64, bool)]) -> Vec<Bin> {
    let of = |k: usize| {
        let own: Vec<&(f64, bool)> = forecasts.iter().filter(|(p, _)| ((p * 10.0) as usize).min(9) == k).collect();
        let forecast = own.iter().map(|f| f.0).sum::<f64>() / own.len().max(1) as f64;
        let came_true = Share::of_all(own.iter().map(|f| f.1));
        Bin { from: k as f64 / 10.0, to: (k + 1) as f64 / 10.0, forecast, came_true }
    };
    (0..10).map(of).filter(|bin| bin.came_true.of > 0).collect()
}

/// Mean square of forecast less outcome (Brier 1950).
pub fn brier(forecasts: &[(f64, bool)]) -> Option<Mean> {
    let squares: Vec<f64> = forecasts
        .iter()
        .map(|(p, present)| {
            let off = p - f64::from(u8::from(*present));
            off * off
        })
        .collect();
    mean(&squares)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wilson_intervals_are_those_of_tables() {
        // Newcombe 1998, table I: 81/263, 15/148, 0/20, 1/29.
        let tables =
            [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)];
        for (hits, of, low, high) in tables {
            let share = Share::new(hits, of);
            assert!((share.low - low).abs() < 1e-4 && (share.high - high).abs() < 1e-4, "{share:?}");
        }
        assert_eq!(Share::new(0, 0).value(), None);
    }

    #[test]
    fn areas_count_pairs() {
        // 0.9 beats three; 0.4 beats one and ties with one, of six pairs.
        let found = area(&[0.9, 0.4], &[0.5, 0.1, 0.4]).unwrap();
        assert_eq!(found.value, 4.5 / 6.0);
        assert!(found.low <= found.value && found.value <= found.high);
        assert_eq!(area(&[], &[1.0]), None);
    }

    #[test]
    fn a_mean_has_the_interval_of_its_standard_error() {
        let values: Vec<f64> = (0..400).map(|k| f64::from(k % 20)).collect();
        let found = mean(&values).unwrap();
        // Deviation of 0 … 19 evenly: √(399/12) = 5.766, over 20.
        assert!((found.value - 9.5).abs() < 1e-12);
        assert!((found.high - found.low - 2.0 * 1.96 * 0.2883).abs() < 0.06, "{found:?}");
        assert_eq!(mean(&[f64::NAN]), None);
    }

    #[test]
    fn forecasts_are_held_against_what_came() {
        let forecasts = [(0.05, false), (0.07, true), (0.95, true), (1.0, true)];
        let bins = calibration(&forecasts);
        assert_eq!(bins.len(), 2);
        assert!((bins[0].forecast - 0.06).abs() < 1e-12 && bins[0].came_true.hits == 1);
        assert_eq!((bins[1].came_true.hits, bins[1].came_true.of), (2, 2));
        let expected = (0.05 * 0.05 + 0.93 * 0.93 + 0.05 * 0.05) / 4.0;
        assert!((brier(&forecasts).unwrap().value - expected).abs() < 1e-12);
    }
}
