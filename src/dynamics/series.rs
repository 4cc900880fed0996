//! Roots, reciprocals and angles near the centre line as polynomials: a processor works out some twenty of their
//! products in the time of one division. Each begins with the polynomial of least relative error on its range (Remez
//! 1934) and, but for the angle, ends with one correction by a series in what is left; all are right to the last two
//! digits.

use super::lanes::{Lane, Splat};
use pulp::Simd;

/// Largest offset from a curve's centre line, in radii, for which [`inverse_root`] and [`inverse_of_one_and`] hold.
pub const NEAR: f64 = 0.25;

/// 1/√(1 − x) for −0.6 ≤ x ≤ 0.45.
#[inline(always)]
pub fn inverse_root<S: Simd>(x: Lane<S>) -> Lane<S> {
    let (c, square) = (x.splat_like(), x * x);
    let odd = polynomial(c, square, [0.500_352_061_714_208_5, 0.300_811_141_828_561_3, 0.345_245_675_618_399_5]);
    let even = [1.000_024_729_867_927, 0.373_005_913_469_605_4, 0.292_777_969_947_576, 0.222_463_153_586_429_73];
    let y = odd.mul_add(x, polynomial(c, square, even));
    // y (1 + e/2 + 3 e²/8 + 5 e³/16) with e = 1 − (1 − x) y².
    let e = (y * y).mul_add(x - c.of(1.0), c.of(1.0));
    let more = polynomial(c, e, [0.5, 0.375, 0.3125]);
    y.mul_add(e * more, y)
}

/// 1/(1 + w) for 0.74 ≤ w ≤ 1.27.
#[inline(always)]
pub fn inverse_of_one_and<S: Simd>(w: Lane<S>) -> Lane<S> {
    let (c, square) = (w.splat_like(), w * w);
    let odd = polynomial(c, square, [-0.693_367_756_630_951_6, -0.062_976_610_343_027]);
    let even = polynomial(c, square, [0.940_182_428_847_757_8, 0.316_142_583_921_995_57]);
    let z = odd.mul_add(w, even);
    // z (1 + e + e² + e³) with e = 1 − (1 + w) z.
    let e = (w + c.of(1.0)).neg_mul_add(z, c.of(1.0));
    let more = e.mul_add(e, e).mul_add(e, e);
    z.mul_add(more, z)
}

/// asin(√x)/√x for 0 ≤ x ≤ 0.27.
#[inline(always)]
pub fn asin_over<S: Simd>(x: Lane<S>) -> Lane<S> {
    let (c, square) = (x.splat_like(), x * x);
    let odd = [
        0.166_666_666_666_610_96,
        0.044_642_856_235_225_16,
        0.022_371_234_334_454_57,
        0.013_812_949_336_427_01,
        0.004_604_282_065_495_675,
        -0.024_004_426_158_367_09,
    ];
    let even = [
        1.0,
        0.075_000_000_011_353_16,
        0.030_381_982_059_723_016,
        0.017_367_290_692_666_584,
        0.012_628_283_953_073_227,
        0.024_635_023_122_392_725,
        0.037_093_304_240_820_23,
    ];
    polynomial(c, square, odd).mul_add(x, polynomial(c, square, even))
}

#[inline(always)]
fn polynomial<S: Simd, const N: usize>(c: Splat<S>, x: Lane<S>, coefficients: [f64; N]) -> Lane<S> {
    let mut sum = c.of(coefficients[N - 1]);
    for k in (0..N - 1).rev() {
        sum = sum.mul_add(x, c.of(coefficients[k]));
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn worst(from: f64, to: f64, ours: impl Fn(f64) -> f64, exact: impl Fn(f64) -> f64) -> f64 {
        let at = |k: i32| from + (to - from) * f64::from(k) / 10_000.0;
        (0..=10_000).map(|k| (ours(at(k)) / exact(at(k)) - 1.0).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn all_are_right_to_the_last_two_digits() {
        let root = worst(-0.6, 0.45, |x| inverse_root(Lane::one(x)).number(), |x| 1.0 / (1.0 - x).sqrt());
        let sum = worst(0.74, 1.27, |w| inverse_of_one_and(Lane::one(w)).number(), |w| 1.0 / (1.0 + w));
        let exact = |x: f64| if x == 0.0 { 1.0 } else { libm::asin(x.sqrt()) / x.sqrt() };
        let angle = worst(0.0, 0.27, |x| asin_over(Lane::one(x)).number(), exact);
        assert!(root < 5e-16 && sum < 5e-16 && angle < 5e-16, "{root:e} {sum:e} {angle:e}");
    }

    #[test]
    fn what_is_near_is_within_the_ranges() {
        // x = 1 − w², with w = 1 − κ y.
        let (near, far) = (1.0 - NEAR, 1.0 + NEAR);
        assert!(1.0 - far * far >= -0.6 && 1.0 - near * near <= 0.45 && near >= 0.74 && far <= 1.27);
    }
}
