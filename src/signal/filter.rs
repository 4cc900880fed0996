//! Filters in time: the low-pass of the sensor cart's electronics, and means over the passing of carts.

use crate::base::trig::{PI, tan};
use std::f64::consts::SQRT_2;

/// Second-order Butterworth low-pass (Butterworth 1930) as a digital filter: the bilinear transform of
/// H(s) = 1 / (s² + √2 s + 1), prewarped so that the gain at the corner is 1/√2 exactly (Oppenheim and Schafer,
/// *Discrete-Time Signal Processing*, §7.1).
///
/// Its gain at f Hz is 1/√(1 + (tan(πf/r) / tan(πc/r))⁴) for the corner c and the rate r.
///
/// ```
/// use lss::signal::filter::Lowpass;
///
/// let mut filter = Lowpass::new(100.0, 1000.0).unwrap();
/// filter.reset_to(5.0);
/// assert!((filter.step(5.0) - 5.0).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lowpass {
    /// b₀ = b₂ = b₁/2.
    b: f64,
    a1: f64,
    a2: f64,
    z1: f64,
    z2: f64,
}

impl Lowpass {
    /// A filter at rest at 0, with its corner and the rate it is stepped at, both in Hz. `None` unless
    /// 0 < corner < rate/2.
    pub fn new(corner_hz: f64, rate_hz: f64) -> Option<Self> {
        if !(corner_hz > 0.0 && corner_hz < rate_hz / 2.0 && rate_hz.is_finite()) {
            return None;
        }
        let k = tan(PI * corner_hz / rate_hz);
        let scale = 1.0 / (1.0 + SQRT_2 * k + k * k);
        Some(Lowpass {
            b: k * k * scale,
            a1: 2.0 * (k * k - 1.0) * scale,
            a2: (1.0 - SQRT_2 * k + k * k) * scale,
            z1: 0.0,
            z2: 0.0,
        })
    }

    /// Takes the next sample and returns the next filtered one (transposed direct form II).
    #[inline]
    pub fn step(&mut self, x: f64) -> f64 {
        let [mut z1, mut z2] = self.delay();
        let y = self.pass(x, &mut z1, &mut z2);
        (self.z1, self.z2) = (z1, z2);
        y
    }

    /// The same with a memory kept elsewhere, for many channels behind equal filters.
    #[inline(always)]
    pub fn pass(&self, x: f64, z1: &mut f64, z2: &mut f64) -> f64 {
        let y = self.b * x + *z1;
        *z1 = 2.0 * self.b * x - self.a1 * y + *z2;
        *z2 = self.b * x - self.a2 * y;
        y
    }

    /// The filter's memory.
    pub fn delay(&self) -> [f64; 2] {
        [self.z1, self.z2]
    }

    /// At rest at `x`, as if it had been there for ever.
    pub fn reset_to(&mut self, x: f64) {
        self.z1 = (1.0 - self.b) * x;
        self.z2 = (self.b - self.a2) * x;
    }
}

/// Filters samples, at rest at the first before them. A lost sample (NaN) stays lost; the filter starts afresh, at
/// rest, at the next one. `None` as in [`Lowpass::new`].
pub fn lowpass(x: &[f64], corner_hz: f64, rate_hz: f64) -> Option<Vec<f64>> {
    let mut filter = Lowpass::new(corner_hz, rate_hz)?;
    let mut running = false;
    let step = |&x: &f64| {
        if x.is_nan() {
            running = false;
            return x;
        }
        if !running {
            filter.reset_to(x);
            running = true;
        }
        filter.step(x)
    };
    Some(x.iter().map(step).collect())
}

/// The centred moving mean over `width` samples, which need not be a whole number: the two samples at the ends of the
/// window count in part. NaN where the window reaches over an end or a lost sample, as a mean over less would not
/// cancel what the window is made for.
///
/// For the mean over the passing of two carts, `width` = 2 · pitch / speed · rate. Within it, everything that repeats
/// with each cart or each second cart cancels; the chaos of the lateral motion is of that kind (design: chain model,
/// Chaos).
pub fn moving_mean(x: &[f64], width: f64) -> Vec<f64> {
    if !(width > 1.0 && width.is_finite()) {
        return x.to_vec();
    }
    if width > x.len() as f64 {
        return vec![f64::NAN; x.len()];
    }
    let reach = ((width - 1.0) / 2.0).floor();
    let edge = (width - 1.0) / 2.0 - reach;
    let reach = reach as usize;
    let around = reach + usize::from(edge > 0.0);
    let mut sums = Vec::with_capacity(x.len() + 1);
    let mut lost = Vec::with_capacity(x.len() + 1);
    let (mut sum, mut count) = (0.0, 0_usize);
    sums.push(sum);
    lost.push(count);
    for &x in x {
        if x.is_nan() {
            count += 1;
        } else {
            sum += x;
        }
        sums.push(sum);
        lost.push(count);
    }
    let mean = |i: usize| {
        let (Some(from), to) = (i.checked_sub(around), i + around + 1) else { return f64::NAN };
        if to > x.len() || lost[to] != lost[from] {
            return f64::NAN;
        }
        let ends = if edge > 0.0 { edge * (x[from] + x[to - 1]) } else { 0.0 };
        (sums[i + reach + 1] - sums[i - reach] + ends) / width
    };
    (0..x.len()).map(mean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::trig::{TAU, sin};

    fn sine(frequency: f64, rate: f64, count: usize) -> Vec<f64> {
        (0..count).map(|i| sin(TAU * frequency * i as f64 / rate)).collect()
    }

    /// The steady amplitude of a filtered sine, by its projection on sine and cosine over whole periods.
    fn gain(frequency: f64, corner: f64, rate: f64) -> f64 {
        let (settle, count) = (4 * rate as usize, rate as usize);
        let y = lowpass(&sine(frequency, rate, settle + count), corner, rate).unwrap();
        let (mut a, mut b) = (0.0, 0.0);
        for (i, y) in y.iter().enumerate().skip(settle) {
            let phase = TAU * frequency * i as f64 / rate;
            a += y * sin(phase);
            b += y * crate::base::trig::cos(phase);
        }
        (a * a + b * b).sqrt() * 2.0 / count as f64
    }

    #[test]
    fn the_gain_is_the_prewarped_bilinear_response() {
        for (corner, rate) in [(100.0, 2000.0), (100.0, 500.0), (10.0, 4000.0)] {
            for frequency in [1.0, 10.0, 50.0, 100.0, 150.0, 230.0] {
                let ratio = tan(PI * frequency / rate) / tan(PI * corner / rate);
                let expected = 1.0 / (1.0 + ratio * ratio * ratio * ratio).sqrt();
                let found = gain(frequency, corner, rate);
                assert!((found - expected).abs() < 1e-9, "{frequency} of {corner}/{rate}: {found}, not {expected}");
            }
            assert!((gain(corner, corner, rate) - 0.5_f64.sqrt()).abs() < 1e-9);
        }
    }

    #[test]
    fn a_step_overshoots_by_four_per_cent() {
        // exp(−π) of a second-order system with damping ratio 1/√2.
        let mut filter = Lowpass::new(10.0, 100_000.0).unwrap();
        let peak = (0..20_000).map(|_| filter.step(1.0)).fold(0.0, f64::max);
        assert!((peak - 1.0 - crate::base::trig::exp(-PI)).abs() < 1e-5, "{peak}");
    }

    #[test]
    fn corners_that_cannot_be_are_refused() {
        for (corner, rate) in [(0.0, 500.0), (250.0, 500.0), (-1.0, 500.0), (f64::NAN, 500.0), (1.0, f64::INFINITY)] {
            assert_eq!(Lowpass::new(corner, rate), None, "{corner}, {rate}");
        }
    }

    #[test]
    fn lost_samples_stay_lost_and_harm_no_other() {
        let y = lowpass(&[3.0, 3.0, f64::NAN, 7.0, 7.0], 50.0, 500.0).unwrap();
        assert!(y[2].is_nan());
        for (y, expected) in [(y[1], 3.0), (y[3], 7.0), (y[4], 7.0)] {
            assert!((y - expected).abs() < 1e-12);
        }
    }

    #[test]
    fn means_over_whole_periods_cancel_them() {
        let x: Vec<f64> = sine(8.0, 1000.0, 2000).iter().map(|x| 5.0 + x).collect();
        for width in [125.0, 250.0] {
            let y = moving_mean(&x, width);
            assert!(y[400..1600].iter().all(|y| (y - 5.0).abs() < 2e-3), "{width}");
        }
        assert_eq!(moving_mean(&[1.0, 2.0, 6.0], 3.0)[1], 3.0);
        assert_eq!(moving_mean(&[1.0, 2.0, 6.0], 2.0)[1], (0.5 + 2.0 + 3.0) / 2.0);
        assert!(moving_mean(&[1.0, 2.0, 6.0], 3.0)[0].is_nan());
        let holes = moving_mean(&[1.0, f64::NAN, 1.0, 1.0, 1.0], 3.0);
        assert!(holes[2].is_nan() && holes[3] == 1.0);
        assert_eq!(moving_mean(&[4.0], 1.0), [4.0]);
        assert!(moving_mean(&[4.0, 5.0], 1e300).iter().all(|y| y.is_nan()));
    }
}
