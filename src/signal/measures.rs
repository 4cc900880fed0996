//! What a channel amounts to: mean, deviation, extremes, and how far two of them are apart.
//!
//! Lost samples (NaN) take no part in any of it.

/// What samples amount to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics {
    /// Samples that are not lost.
    pub count: usize,
    pub mean: f64,
    /// √(Σ(x − mean)² / n): of the samples themselves, not of a population they were drawn from.
    pub sd: f64,
    pub min: f64,
    pub max: f64,
    /// √(Σx² / n)
    pub rms: f64,
}

/// `None` when every sample is lost.
pub fn statistics(x: &[f64]) -> Option<Statistics> {
    statistics_of(x.iter().copied())
}

/// The same of samples that are gone through twice.
pub fn statistics_of(x: impl Iterator<Item = f64> + Clone) -> Option<Statistics> {
    let (mut count, mut sum, mut squares) = (0_usize, 0.0, 0.0);
    let (mut min, mut max) = (f64::INFINITY, f64::NEG_INFINITY);
    for x in x.clone().filter(|x| !x.is_nan()) {
        count += 1;
        sum += x;
        squares += x * x;
        min = min.min(x);
        max = max.max(x);
    }
    if count == 0 {
        return None;
    }
    let n = count as f64;
    let mean = sum / n;
    // A second pass: the difference of two large sums would lose the digits.
    let spread: f64 = x.filter(|x| !x.is_nan()).map(|x| (x - mean) * (x - mean)).sum();
    Some(Statistics { count, mean, sd: (spread / n).sqrt(), min, max, rms: (squares / n).sqrt() })
}

/// A part of the track: from `from` up to `to` in driving direction, in metres of arc length within a lap; over the
/// layout's start when `to` is less than `from`.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackSection {
    pub name: String,
    pub from: f64,
    pub to: f64,
}

impl TrackSection {
    /// Whether it holds the arc length `s`, which is in [0, lap).
    pub fn holds(&self, s: f64) -> bool {
        if self.from <= self.to { self.from <= s && s < self.to } else { s >= self.from || s < self.to }
    }
}

/// Statistics over all passages of each section, `s` being travelled arc length (`Position::s`); `None` for a section
/// without a sample.
pub fn by_section(s: &[f64], x: &[f64], lap_length: f64, sections: &[TrackSection]) -> Vec<Option<Statistics>> {
    let within = |section: &TrackSection| {
        let place = s.iter().zip(x).filter(|(s, _)| section.holds(s.rem_euclid(lap_length)));
        statistics(&place.map(|(_, x)| *x).collect::<Vec<_>>())
    };
    sections.iter().map(within).collect()
}

/// Root mean square of the differences where both have a sample. `None` when nowhere.
pub fn rmsd(reference: &[f64], other: &[f64]) -> Option<f64> {
    let difference: Vec<f64> = reference.iter().zip(other).map(|(a, b)| b - a).collect();
    statistics(&difference).map(|d| d.rms)
}

/// Normalised root mean square deviation, the measure by which the thesis judges its model ("around or less than 10 %
/// for all layouts and all measured forces", §2.3.1): the root mean square of the residual (as §2.4.2 minimises) over
/// the range of the reference, max − min of all its samples. The thesis does not print the divisor; the range is the
/// usual one, and the one by which the chain model's page states its own floor.
///
/// `None` without common samples or when the reference does not vary.
///
/// ```
/// use lss::signal::measures::nrmsd;
///
/// assert_eq!(nrmsd(&[0.0, 10.0, 0.0, 10.0], &[1.0, 9.0, 1.0, 9.0]), Some(0.1));
/// ```
pub fn nrmsd(reference: &[f64], other: &[f64]) -> Option<f64> {
    let range = statistics(reference).map(|r| r.max - r.min)?;
    rmsd(reference, other).filter(|_| range > 0.0).map(|d| d / range)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statistics_of_numbers_done_by_hand() {
        let found = statistics(&[2.0, f64::NAN, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0]).expect("samples");
        assert_eq!(
            found,
            Statistics { count: 8, mean: 5.0, sd: 2.0, min: 2.0, max: 9.0, rms: 29.0_f64.sqrt() },
            "Σx² = 232"
        );
        assert_eq!(statistics(&[f64::NAN]), None);
        let far = statistics(&[1e9, 1e9 + 1.0]).expect("samples");
        assert_eq!((far.mean, far.sd), (1e9 + 0.5, 0.5), "digits are kept far from zero");
    }

    #[test]
    fn deviation_is_over_the_range_of_the_reference() {
        assert_eq!(rmsd(&[0.0, 0.0, f64::NAN], &[3.0, 4.0, 9.0]), Some(12.5_f64.sqrt()));
        assert_eq!(nrmsd(&[0.0, 4.0], &[2.0, 6.0]), Some(0.5));
        assert_eq!(nrmsd(&[2.0, 6.0], &[2.0, 2.0]), Some(8.0_f64.sqrt() / 4.0), "the other's range counts for nothing");
        assert_eq!(nrmsd(&[1.0, 1.0], &[1.0, 1.0]), None);
        assert_eq!(nrmsd(&[0.0, 1.0], &[f64::NAN, f64::NAN]), None);
    }

    #[test]
    fn sections_gather_every_passage_and_reach_over_the_start() {
        let s: Vec<f64> = (0..40).map(f64::from).map(|i| i - 15.0).collect();
        let x: Vec<f64> = s.iter().map(|s| s.rem_euclid(10.0)).collect();
        let section = |from, to| TrackSection { name: String::new(), from, to };
        let found = by_section(&s, &x, 10.0, &[section(2.0, 4.0), section(8.0, 1.0), section(3.5, 3.6)]);
        let read = |i: usize| found[i].map(|f| (f.count, f.min, f.max));
        assert_eq!(read(0), Some((8, 2.0, 3.0)));
        assert_eq!(read(1), Some((12, 0.0, 9.0)));
        assert_eq!(read(2), None);
    }
}
