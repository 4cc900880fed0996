//! Waves: when one ends and the next begins, and the shares that are drawn for it.

use super::sorter::{Induction, Sorter, Waves};
use crate::base::random::Random;
use crate::base::trig;

/// Where the items of the wave that runs go, and how long chutes are closed at its begin.
#[derive(Debug)]
pub(super) struct Turn<'a> {
    sorter: &'a Sorter,
    waves: &'a Waves,
    random: Random,
    /// Waves that have begun.
    begun: u64,
}

impl<'a> Turn<'a> {
    pub(super) fn new(sorter: &'a Sorter, waves: &'a Waves, random: Random) -> Self {
        Turn { sorter, waves, random, begun: 0 }
    }

    /// When the next wave begins, s.
    pub(super) fn next(&self) -> f64 {
        self.begun as f64 * self.waves.every
    }

    /// Begins it, and says until when chutes are closed, s, and the running sums of its shares. Nothing has to be changed over
    /// for the first.
    pub(super) fn begin(&mut self) -> (f64, Vec<Vec<f64>>) {
        let closed = if self.begun == 0 { 0.0 } else { self.next() + self.waves.changeover };
        let shares = self.sorter.shares((self.begun % self.waves.count() as u64) as usize);
        self.begun += 1;
        (closed, running_sums(self.sorter, &drawn(shares, self.waves.spread, &mut self.random)))
    }

    /// The cycle of the wave that runs, and its number in it.
    pub(super) fn at(&self) -> (u64, usize) {
        let (now, count) = (self.begun.saturating_sub(1), self.waves.count() as u64);
        (now / count, (now % count) as usize)
    }
}

/// Sums of the shares of the first one, two, … chutes, by induction.
pub(super) fn running_sums(sorter: &Sorter, shares: &[f64]) -> Vec<Vec<f64>> {
    let sums = |induction: &Induction| {
        let mut sum = 0.0;
        let mut next = |share: f64| {
            sum += share;
            sum
        };
        induction.shares(shares).into_iter().map(&mut next).collect()
    };
    sorter.inductions.iter().map(sums).collect()
}

/// Shares, each multiplied with a random number of mean 1 and this coefficient of variation, gamma distributed. With 1 it is
/// exponential, so that equal shares are what a stick is broken into at random.
pub(super) fn drawn(mut shares: Vec<f64>, spread: f64, random: &mut Random) -> Vec<f64> {
    if spread > 0.0 {
        let shape = 1.0 / (spread * spread);
        shares.iter_mut().for_each(|share| *share *= gamma(shape, random) / shape);
    }
    shares
}

/// A gamma distributed number of scale 1 (Marsaglia and Tsang 2000).
fn gamma(shape: f64, random: &mut Random) -> f64 {
    if shape < 1.0 {
        let less = trig::pow(1.0 - random.uniform(), 1.0 / shape);
        return gamma(shape + 1.0, random) * less;
    }
    let d = shape - 1.0 / 3.0;
    let c = 1.0 / (9.0 * d).sqrt();
    loop {
        let x = random.normal();
        let v = 1.0 + c * x;
        if v <= 0.0 {
            continue;
        }
        let v = v * v * v;
        let u = 1.0 - random.uniform();
        if trig::ln(u) < 0.5 * x * x + d - d * v + d * trig::ln(v) {
            return d * v;
        }
    }
}
