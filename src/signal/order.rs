//! Order tracking: spectra over distance, so that what repeats with the carts or with a turn of the wheel stands still
//! whatever the speed.
//!
//! Order k of a period is what happens k times in it: order 1 of the cart pitch is the passing of carts, order 1 of 2πr
//! a turn of the wheel of radius r. Samples at equal steps of time are resampled to equal steps of distance (computed
//! order tracking, Fyfe and Munck 1997).

use super::spectrum::{Spectrum, amplitude};

/// Samples at equal steps of distance.
#[derive(Clone, Debug, PartialEq)]
pub struct Resampled {
    /// Number of the first sample's step from distance 0: it is at `first * step`.
    pub first: i64,
    /// m
    pub step: f64,
    pub samples: Vec<f64>,
}

/// Resamples onto the multiples of `step` within the distance covered. Between samples runs the cubic Hermite curve
/// with the slopes of Catmull and Rom (1974); a straight line, which takes the top off short waves, would not do. `s`
/// increases, or the samples that fall back behind another are passed over. NaN next to lost samples.
pub fn resample(s: &[f64], x: &[f64], step: f64) -> Resampled {
    let mut nodes: Vec<(f64, f64)> = Vec::with_capacity(s.len());
    for (&s, &x) in s.iter().zip(x) {
        if s.is_finite() && nodes.last().is_none_or(|n| n.0 < s) {
            nodes.push((s, x));
        }
    }
    let empty = Resampled { first: 0, step, samples: Vec::new() };
    let (Some(begin), Some(end)) = (nodes.first(), nodes.last()) else { return empty };
    let (first, last) = ((begin.0 / step).ceil(), (end.0 / step).floor());
    if nodes.len() < 2 || !(step > 0.0 && last - first < 1e9) {
        return empty;
    }
    let first = first as i64;
    let mut i = 0;
    let samples = (first..=last as i64).map(|k| {
        let at = k as f64 * step;
        while i + 2 < nodes.len() && nodes[i + 1].0 < at {
            i += 1;
        }
        hermite(&nodes, i, at)
    });
    Resampled { first, step, samples: samples.collect() }
}

/// Between nodes `i` and `i + 1`.
fn hermite(nodes: &[(f64, f64)], i: usize, at: f64) -> f64 {
    let (from, to) = (nodes[i], nodes[i + 1]);
    let secant = (to.1 - from.1) / (to.0 - from.0);
    // A lost neighbour costs the curve, not the sample.
    let slope = |a: Option<&(f64, f64)>, b: Option<&(f64, f64)>| match (a, b) {
        (Some(a), Some(b)) if !a.1.is_nan() && !b.1.is_nan() => (b.1 - a.1) / (b.0 - a.0),
        _ => secant,
    };
    let begin = slope(i.checked_sub(1).and_then(|i| nodes.get(i)), Some(&to));
    let end = slope(Some(&from), nodes.get(i + 2));
    let width = to.0 - from.0;
    let t = (at - from.0) / width;
    let u = 1.0 - t;
    from.1 * (1.0 + 2.0 * t) * u * u + to.1 * (3.0 - 2.0 * t) * t * t + width * t * u * (begin * u - end * t)
}

/// Amplitudes against orders of a period in metres: the cart pitch, or 2πr of a wheel. `s` is travelled distance
/// (`Position::s`), `x` a channel with its gaps bridged. Lines are a whole number to an order, as whole periods only
/// are looked at; steps are as long as the mean distance between samples, or a bit shorter. Empty for less than two
/// periods.
pub fn order_spectrum(s: &[f64], x: &[f64], period: f64) -> Spectrum {
    let (Some(first), Some(last)) = (s.first(), s.last()) else { return Spectrum::default() };
    let travelled = last - first;
    if !(period > 0.0 && travelled >= 2.0 * period) {
        return Spectrum::default();
    }
    let per_period = (period * (s.len() - 1) as f64 / travelled).ceil();
    let mut samples = resample(s, x, period / per_period).samples;
    // Exactly n periods, and n lines to an order.
    let whole = samples.len() / per_period as usize * per_period as usize;
    samples.truncate(whole);
    amplitude(&samples, per_period)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::trig::{PI, TAU, sin};

    /// 100 s at 500 Hz with a speed that swings by 10 %.
    fn travel() -> Vec<f64> {
        let at = |i: i32| {
            let t = f64::from(i) / 500.0;
            2.0 * t + 0.2 * sin(t)
        };
        (0..50_000).map(at).collect()
    }

    #[test]
    fn orders_stand_still_while_the_speed_swings() {
        let s = travel();
        let (pitch, turn) = (1.25, TAU * 0.040);
        let wave = |s: &f64| 7.0 + 2.0 * sin(TAU * s / pitch) + 0.3 * sin(2.0 * TAU * s / pitch) + sin(TAU * s / turn);
        let x: Vec<f64> = s.iter().map(wave).collect();
        let carts = order_spectrum(&s, &x, pitch);
        let at = |spectrum: &Spectrum, order: f64| spectrum.values[(order / spectrum.step).round() as usize];
        assert!((1.0 / carts.step).fract().abs() < 1e-9, "whole lines to an order");
        for (order, expected) in [(0.0, 7.0), (1.0, 2.0), (2.0, 0.3), (3.0, 0.0)] {
            assert!((at(&carts, order) - expected).abs() < 2e-3, "order {order}: {}", at(&carts, order));
        }
        let wheel = order_spectrum(&s, &x, turn);
        assert!((at(&wheel, 1.0) - 1.0).abs() < 2e-3, "{}", at(&wheel, 1.0));
        assert_eq!(order_spectrum(&s, &x, 150.0), Spectrum::default());
    }

    #[test]
    fn resampling_keeps_short_waves() {
        // Five samples to a wave, as 100 Hz at 500 Hz.
        let s: Vec<f64> = (0..1000).map(|i| 0.013 + 0.004 * f64::from(i)).collect();
        let x: Vec<f64> = s.iter().map(|s| sin(PI * s / 0.02)).collect();
        let out = resample(&s, &x, 0.002);
        assert_eq!(out.first, 7);
        for (k, y) in out.samples.iter().enumerate().skip(2).take(1900) {
            let at = (out.first + k as i64) as f64 * 0.002;
            assert!((y - sin(PI * at / 0.02)).abs() < 0.02, "{at}");
        }
    }

    #[test]
    fn polynomials_of_second_degree_are_kept_and_lost_samples_lost() {
        let s = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
        let mut x = s.map(|s| s * s);
        assert_eq!(resample(&s, &x, 0.5).samples[3..8], [2.25, 4.0, 6.25, 9.0, 12.25]);
        x[5] = f64::NAN;
        let out = resample(&s, &x, 0.5).samples;
        assert!(out[9].is_nan() && !out[7].is_nan());
        for nothing in [resample(&[], &[], 0.5), resample(&[1.0], &[1.0], 0.5), resample(&s, &x, 0.0)] {
            assert!(nothing.samples.is_empty());
        }
    }
}
