//! The variance of means over a time, and what it is of a process of first order in a record from which a straight line is
//! taken.

use super::super::noise::mean_variance;
use crate::base::trig;
use nalgebra::{DMatrix, DVector};

/// A variance beyond that of simulated passes: of means of half the difference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Time over which means are taken, s.
    pub(super) over: f64,
    /// Time of the difference from which a straight line was taken, s.
    pub(super) length: f64,
    /// N²
    pub(super) excess: f64,
    pub(super) deviation: f64,
}

impl Row {
    /// Of means over a time in a record of some length, both s.
    pub fn new((over, length): (f64, f64), (excess, deviation): (f64, f64)) -> Row {
        Row { over, length, excess, deviation }
    }

    /// What the variance of noise with a correlation time, s, scatters by in such a record, as a share.
    pub(super) fn sampled(&self, time: f64) -> f64 {
        (2.0 * (self.over + 2.0 * time) / self.length).sqrt()
    }

    /// The variance of means of noise of unit variance with a correlation time, s.
    pub(super) fn of(&self, time: f64) -> f64 {
        let share = self.over / self.length;
        if share > SHORT { along_short(self.over, share, time) } else { along_long(self.over, self.length, time) }
    }
}

/// Means over more than this share of a length are few, and the straight line is taken mostly from what they are of.
const SHORT: f64 = 0.125;

/// Cells in a mean over a time, at each of which one begins.
pub(super) const CELLS: usize = 4;

/// The variance of means over a time of a process of unit variance less the nearest straight line, where means are much
/// shorter than the length: that of means less those of the line's level and slope.
fn along_long(over: f64, length: f64, time: f64) -> f64 {
    let share = over / length;
    mean_variance(over, time) - mean_variance(length, time) - slope_variance(length / time) * (1.0 - share * share)
}

/// The mean square over a length of the slope of the nearest straight line through a process of first order of unit
/// variance; the length is in correlation times u. The slope is ∫ (t − ½) x dt over ∫ (t − ½)² dt = 1/12, and the
/// covariance of x integrated over both times is 2 ∫ exp(−u h) (1/12 − h/4 + h³/6) dh from 0 to 1.
fn slope_variance(u: f64) -> f64 {
    // Near 0 by its series, as what is left of four terms is far smaller than each.
    if u < 0.1 {
        return 0.2 * u * (1.0 - 0.5 * u);
    }
    let far = trig::exp(-u) * (0.25 + 1.0 / u + 1.0 / (u * u)) / (u * u);
    24.0 * (1.0 / (12.0 * u) - 0.25 / (u * u) + 1.0 / (u * u * u * u) - far)
}

/// The same where they are a large share of it: from the covariance of means over cells, a quarter of a mean long.
fn along_short(over: f64, share: f64, time: f64) -> f64 {
    let count = (CELLS as f64 / share).round() as usize;
    if count <= CELLS {
        return 0.0;
    }
    let cell = over / CELLS as f64 / time;
    let apart = (trig::exp(cell) + trig::exp(-cell) - 2.0) / (cell * cell);
    let covariance = |i: usize, j: usize| match i.abs_diff(j) {
        0 => mean_variance(cell, 1.0),
        cells => apart * trig::exp(-(cells as f64) * cell),
    };
    let covariance = DMatrix::from_fn(count, count, covariance);
    // Level and slope.
    let middle = 0.5 * (count as f64 - 1.0);
    let slope = DVector::from_fn(count, |k, _| k as f64 - middle).normalize();
    let level = DVector::from_element(count, 1.0).normalize();
    let without = DMatrix::identity(count, count) - &slope * slope.transpose() - &level * level.transpose();
    let left = &without * covariance * &without;
    let means = 0..=count - CELLS;
    let sum: f64 = means.clone().map(|k| left.view((k, k), (CELLS, CELLS)).sum()).sum();
    sum / means.count() as f64 / (CELLS * CELLS) as f64
}
