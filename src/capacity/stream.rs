//! Streams of random numbers, one for each cause, so that sorters can be compared by the same items.

use crate::base::random::{Random, mix};
use crate::base::trig;

/// What random numbers are for. Each kind of equipment has its own streams.
#[derive(Clone, Copy, Debug)]
pub(super) enum Cause {
    Arrivals = 1,
    Doubles = 2,
    Used = 3,
    Reads = 4,
    Destinations = 5,
    Stops = 6,
    Inductions = 7,
    Chutes = 8,
    Waves = 9,
    Scanners = 10,
}

/// The stream of a cause, of the piece of equipment with this index.
pub(super) fn stream(seed: u64, cause: Cause, index: usize) -> Random {
    let mut state =
        seed ^ (cause as u64).wrapping_mul(0xA24B_AED4_963E_E407) ^ (index as u64).wrapping_mul(0x9FB2_1C65_1E98_DF25);
    Random::new(mix(&mut state))
}

/// Exponential with a mean.
pub(super) fn exponential(random: &mut Random, mean: f64) -> f64 {
    -mean * trig::ln(1.0 - random.uniform())
}
