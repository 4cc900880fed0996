//! The power of a force in a band of frequency, and what a process of first order has of it.

use crate::base::trig;

/// More than noise in a band is so many deviations off.
const ELSE: f64 = 3.0;

/// The power that was measured in a band, N².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandPower {
    pub measured: f64,
    /// Beyond that of laps of a fitted model with white noise, and how far that may be off; `None` of one that is not fitted.
    pub beyond: Option<(f64, f64)>,
    /// Where it lies, Hz.
    pub band: (f64, f64),
}

impl BandPower {
    /// The variance of a process with a correlation time, s, that has all of it: its density is 4 σ² τ/(1 + (2π f τ)²).
    pub(super) fn all_of(&self, time: f64) -> f64 {
        self.measured / self.share(time)
    }

    /// The share of the variance of such a process that lies in it.
    pub(super) fn share(&self, time: f64) -> f64 {
        let turn = |hz: f64| trig::atan(trig::TAU * hz * time);
        2.0 / trig::PI * (turn(self.band.1) - turn(self.band.0))
    }

    /// Squared deviations by which such a process of a variance, N², lies beside what is beyond simulated laps. What else is in
    /// a band may be of any size: it counts as [`ELSE`] deviations.
    pub(super) fn off(&self, variance: f64, time: f64) -> f64 {
        let Some((beyond, deviation)) = self.beyond else { return 0.0 };
        let off = (beyond - variance * self.share(time)) / deviation;
        (off * off).min(ELSE * ELSE)
    }
}
