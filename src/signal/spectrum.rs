//! Spectra in frequency.
//!
//! Both kinds look through a Hann window, which keeps a line from leaking over the whole spectrum, and correct for it.

use crate::base::trig::{TAU, cos, log10};
use realfft::RealFftPlanner;

/// Values at equal steps of frequency from 0 on. Orders are frequencies too: cycles per whatever the step is "per".
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spectrum {
    /// Distance between two values, Hz or orders.
    pub step: f64,
    pub values: Vec<f64>,
}

impl Spectrum {
    /// Frequencies and values.
    pub fn points(&self) -> impl Iterator<Item = (f64, f64)> {
        self.values.iter().enumerate().map(|(k, &v)| (k as f64 * self.step, v))
    }

    /// Frequency and value of the largest value above frequency 0, if there is one.
    pub fn peak(&self) -> Option<(f64, f64)> {
        self.points().skip(1).filter(|p| !p.1.is_nan()).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Integral over frequency from `from` to below `to`: of a power spectral density, the power in the band, the mean
    /// square of what a filter would let through.
    pub fn band(&self, from: f64, to: f64) -> f64 {
        let within = self.points().filter(|(f, _)| (from..to).contains(f));
        within.map(|(_, v)| v).sum::<f64>() * self.step
    }
}

/// The periodic Hann window 0.5 − 0.5 cos(2πi/n) (Harris 1978), whose shifted copies by half its length add up to one.
fn hann(count: usize) -> Vec<f64> {
    (0..count).map(|i| 0.5 - 0.5 * cos(TAU * i as f64 / count as f64)).collect()
}

/// Squared magnitudes of the discrete Fourier transform, from frequency 0 to half the rate.
fn squared(mut samples: Vec<f64>, planner: &mut RealFftPlanner<f64>) -> Vec<f64> {
    let plan = planner.plan_fft_forward(samples.len());
    let mut lines = plan.make_output_vec();
    // Lengths agree by construction, and nothing else can fail.
    if plan.process(&mut samples, &mut lines).is_err() {
        return Vec::new();
    }
    lines.iter().map(|c| c.norm_sqr()).collect()
}

/// Whether a line stands for a pair of frequencies, one of them negative.
fn is_paired(line: usize, count: usize) -> bool {
    line > 0 && 2 * line != count
}

/// Amplitudes: of each sine in the samples its amplitude, in their unit; at frequency 0 the mean's size. `rate` is
/// samples a second (or a metre, or a period: then frequencies are per metre, or orders). Between two lines, a sine
/// shows up to 15 % low (Harris 1978, scalloping loss 1.42 dB). A lost sample makes every value NaN: bridge gaps
/// before.
pub fn amplitude(x: &[f64], rate: f64) -> Spectrum {
    let count = x.len();
    if count < 4 {
        return Spectrum::default();
    }
    let window = hann(count);
    let gain: f64 = window.iter().sum();
    let mean = x.iter().sum::<f64>() / count as f64;
    // The mean would leak into the first lines.
    let weighted = x.iter().zip(&window).map(|(x, w)| (x - mean) * w).collect();
    let mut values: Vec<f64> = squared(weighted, &mut RealFftPlanner::new())
        .into_iter()
        .enumerate()
        .map(|(k, power)| power.sqrt() / gain * if is_paired(k, count) { 2.0 } else { 1.0 })
        .collect();
    if let Some(first) = values.first_mut() {
        *first = mean.abs();
    }
    Spectrum { step: rate / count as f64, values }
}

/// One-sided power spectral density by Welch's method (1967): the mean over segments of `segment` samples that overlap
/// by half, each without its mean and through a Hann window. In unit²/Hz; its integral is the variance. Segments with a
/// lost sample are left out; when none is left, or the segment is shorter than four samples, the spectrum is empty. A
/// segment longer than the samples is cut to them.
pub fn welch(x: &[f64], rate: f64, segment: usize) -> Spectrum {
    let count = segment.min(x.len());
    if count < 4 {
        return Spectrum::default();
    }
    let window = hann(count);
    let energy: f64 = window.iter().map(|w| w * w).sum();
    let mut planner = RealFftPlanner::new();
    let mut values = vec![0.0; count / 2 + 1];
    let mut segments = 0_usize;
    let mut begin = 0;
    while let Some(part) = x.get(begin..begin + count) {
        begin += count / 2;
        let mean = part.iter().sum::<f64>() / count as f64;
        if mean.is_nan() {
            continue;
        }
        let weighted = part.iter().zip(&window).map(|(x, w)| (x - mean) * w).collect();
        for (sum, power) in values.iter_mut().zip(squared(weighted, &mut planner)) {
            *sum += power;
        }
        segments += 1;
    }
    if segments == 0 {
        return Spectrum::default();
    }
    for (k, value) in values.iter_mut().enumerate() {
        *value *= if is_paired(k, count) { 2.0 } else { 1.0 } / (segments as f64 * rate * energy);
    }
    Spectrum { step: rate / count as f64, values }
}

/// Log-spectral distance (Gray and Markel 1976) of two power spectral densities over a band, in dB: the root mean
/// square over its lines of 10 lg(P₁/P₂). 3 dB is a factor of two in power everywhere. Lines at which either has no
/// power are left out; `None` when no line is left, or the lines of the two are not at the same frequencies.
pub fn log_distance(reference: &Spectrum, other: &Spectrum, from: f64, to: f64) -> Option<f64> {
    if (reference.step - other.step).abs() > 1e-6 * reference.step {
        return None;
    }
    let lines = reference.points().zip(&other.values);
    let levels: Vec<f64> = lines
        .filter(|((f, p), q)| (from..to).contains(f) && *p > 0.0 && **q > 0.0)
        .map(|((_, p), q)| 10.0 * log10(q / p))
        .collect();
    super::measures::statistics(&levels).map(|s| s.rms)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::trig::sin;

    /// Noise that is the same everywhere: a linear congruential generator (Knuth's MMIX), uniform in ±1.
    fn noise(count: usize) -> Vec<f64> {
        seeded(count, 1)
    }

    fn seeded(count: usize, mut state: u64) -> Vec<f64> {
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
        };
        (0..count).map(|_| next()).collect()
    }

    fn sines(count: usize) -> Vec<f64> {
        let at = |i: usize| {
            let t = i as f64 / 500.0;
            12.0 + 3.0 * sin(TAU * 20.0 * t) + 0.5 * sin(TAU * 61.0 * t + 1.0)
        };
        (0..count).map(at).collect()
    }

    #[test]
    fn amplitudes_are_those_of_the_sines() {
        for count in [500, 1000, 1500] {
            let spectrum = amplitude(&sines(count), 500.0);
            assert_eq!(spectrum.values.len(), count / 2 + 1);
            let at = |f: f64| spectrum.values[(f / spectrum.step).round() as usize];
            for (f, expected) in [(0.0, 12.0), (20.0, 3.0), (61.0, 0.5), (100.0, 0.0)] {
                assert!((at(f) - expected).abs() < 1e-9, "{f} Hz: {}", at(f));
            }
            assert_eq!(spectrum.peak().map(|p| p.0.round()), Some(20.0));
        }
    }

    /// Parseval: what the density sums up to is the variance, for a sine A²/2.
    #[test]
    fn densities_sum_up_to_the_variance() {
        let spectrum = welch(&sines(20_000), 500.0, 1000);
        assert!((spectrum.band(15.0, 25.0) - 4.5).abs() < 1e-6, "{}", spectrum.band(15.0, 25.0));
        assert!((spectrum.band(56.0, 66.0) - 0.125).abs() < 1e-6);
        let x = noise(100_000);
        for segment in [500, 501, 1024] {
            let white = welch(&x, 500.0, segment);
            // White noise uniform in ±1: variance 1/3, even over 250 Hz.
            assert!((white.band(0.0, 1e9) - 1.0 / 3.0).abs() < 0.005, "{segment}");
            assert!((white.band(50.0, 150.0) - 0.4 / 3.0).abs() < 0.005, "{segment}");
        }
    }

    #[test]
    fn one_rectangular_segment_obeys_parseval_to_the_last_digit() {
        for count in [64, 65] {
            let x = noise(count);
            let lines = squared(x.clone(), &mut RealFftPlanner::new());
            let two_sided = lines.iter().enumerate().map(|(k, p)| if is_paired(k, count) { 2.0 * p } else { *p });
            let energy: f64 = x.iter().map(|x| x * x).sum();
            assert!((two_sided.sum::<f64>() / count as f64 - energy).abs() < 1e-12 * energy);
        }
    }

    #[test]
    fn segments_with_lost_samples_are_left_out() {
        let mut x = sines(20_000);
        x[5000..5040].fill(f64::NAN);
        assert!((welch(&x, 500.0, 1000).band(15.0, 25.0) - 4.5).abs() < 1e-6);
        assert_eq!(welch(&[f64::NAN; 100], 500.0, 50), Spectrum::default());
        assert_eq!(welch(&[1.0; 3], 500.0, 50), Spectrum::default());
        assert!(amplitude(&x, 500.0).values.iter().all(|v| v.is_nan()));
    }

    #[test]
    fn a_factor_in_power_is_its_decibels_everywhere() {
        let x = noise(20_000);
        let louder: Vec<f64> = x.iter().map(|x| 2.0 * x).collect();
        let (a, b) = (welch(&x, 500.0, 500), welch(&louder, 500.0, 500));
        let found = log_distance(&a, &b, 1.0, 100.0).expect("lines");
        assert!((found - 20.0 * log10(2.0)).abs() < 1e-9, "{found}");
        assert_eq!(log_distance(&a, &a, 1.0, 100.0), Some(0.0));
        // Chance, as `compare` states it: 19 segments of 10 s.
        let [p, q] = [1, 99].map(|seed| welch(&seeded(50_000, seed), 500.0, 5000));
        let found = log_distance(&p, &q, 1.0, 200.0).expect("lines");
        assert!((found - 1.48).abs() < 0.1, "{found}");
        assert_eq!(log_distance(&a, &welch(&x, 500.0, 600), 1.0, 100.0), None);
    }
}
