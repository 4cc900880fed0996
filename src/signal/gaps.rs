//! Lost samples: short gaps are bridged, longer ones masked.

/// Gaps up to this long are bridged, s (design: measurement files).
pub const BRIDGED: f64 = 0.050;

/// A channel whose short gaps are bridged.
#[derive(Clone, Debug, PartialEq)]
pub struct Bridged {
    /// The samples; NaN where a gap was too long.
    pub samples: Vec<f64>,
    /// Samples that were filled in.
    pub filled: usize,
    /// Gaps that were bridged.
    pub bridged: usize,
    /// Whether a sample is still lost: leave it out of every residual.
    pub masked: Vec<bool>,
}

/// Gaps of a channel that are short enough to be bridged. The samples are not copied.
#[derive(Clone, Debug)]
pub struct Gaps<'a> {
    time: &'a [f64],
    samples: &'a [f64],
    /// The last sample before and the first one after each.
    bridged: Vec<(usize, usize)>,
}

impl<'a> Gaps<'a> {
    /// A gap lasts from the last sample before it to the first one after it, less one step: 25 lost samples at 500 Hz
    /// are 50 ms. Gaps at the ends stay.
    pub fn new(time: &'a [f64], samples: &'a [f64]) -> Self {
        let mut bridged = Vec::new();
        let mut before: Option<usize> = None;
        for (i, _) in samples.iter().enumerate().filter(|(_, x)| !x.is_nan()) {
            if let Some(b) = before
                && i > b + 1
                && let (Some(&from), Some(&to)) = (time.get(b), time.get(i))
            {
                let lost = (to - from) * (i - b - 1) as f64 / (i - b) as f64;
                if lost <= BRIDGED * (1.0 + 1e-9) {
                    bridged.push((b, i));
                }
            }
            before = Some(i);
        }
        Gaps { time, samples, bridged }
    }

    /// Samples that are filled in.
    pub fn filled(&self) -> usize {
        self.bridged.iter().map(|(before, after)| after - before - 1).sum()
    }

    /// The samples, with straight lines over time across the gaps; NaN where a gap was too long.
    pub fn iter(&self) -> impl Iterator<Item = f64> + Clone + '_ {
        let mut next = 0;
        self.samples.iter().enumerate().map(move |(i, &x)| {
            while self.bridged.get(next).is_some_and(|(_, after)| *after <= i) {
                next += 1;
            }
            match self.bridged.get(next) {
                Some(&(b, a)) if b < i => {
                    let (from, to) = (self.time[b], self.time[a]);
                    self.samples[b] + (self.samples[a] - self.samples[b]) * (self.time[i] - from) / (to - from)
                }
                _ => x,
            }
        })
    }
}

/// Bridges gaps up to [`BRIDGED`] by straight lines over time (see [`Gaps`]). Not for the trigger, which has nothing
/// between 0 and 1.
pub fn bridge(time: &[f64], samples: &[f64]) -> Bridged {
    let gaps = Gaps::new(time, samples);
    let out: Vec<f64> = gaps.iter().collect();
    let masked = out.iter().map(|x| x.is_nan()).collect();
    Bridged { samples: out, filled: gaps.filled(), bridged: gaps.bridged.len(), masked }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_of_fifty_milliseconds_are_bridged_and_longer_ones_masked() {
        let time: Vec<f64> = (0..100).map(|i| f64::from(i) * 0.002).collect();
        let whole: Vec<f64> = time.iter().map(|t| 3.0 + 100.0 * t).collect();
        for (lost, fits) in [(1, true), (25, true), (26, false)] {
            let mut samples = whole.clone();
            samples[40..40 + lost].fill(f64::NAN);
            samples[0] = f64::NAN;
            samples[99] = f64::NAN;
            let bridged = bridge(&time, &samples);
            assert_eq!((bridged.filled, bridged.bridged), if fits { (lost, 1) } else { (0, 0) }, "{lost}");
            assert!(bridged.masked[0] && bridged.masked[99] && !bridged.masked[39]);
            for (i, expected) in whole.iter().enumerate().skip(40).take(lost) {
                assert_eq!(bridged.masked[i], !fits);
                assert!(!fits || (bridged.samples[i] - expected).abs() < 1e-12);
            }
        }
        assert_eq!(bridge(&[], &[]).filled, 0);
        assert!(bridge(&time, &[f64::NAN; 100]).masked.iter().all(|m| *m));
    }
}
