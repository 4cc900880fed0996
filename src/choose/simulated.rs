//! What a choice's sorter takes in the simulation of its capacity. The closed form is an upper bound, which a sorter with
//! items at random does not reach.

use crate::base::stop::Stop;
use crate::capacity::{Mean, Settings, Sorter, measure};

/// Sorters that are simulated, at most, until one takes what is required. Motors do not matter to them.
pub const MOST: usize = 200;

/// A sorter that was simulated, with items at every induction at any time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Simulated {
    /// Index into fitted carts.
    pub fitted: usize,
    /// m/s
    pub speed: f64,
    /// Items an hour.
    pub found: Mean,
}

/// A short simulation that comes first: hours and replications.
const BRIEF: (f64, usize) = (2.0, 4);

/// Items an hour that a sorter takes with items at every induction at any time. So much is simulated as `lss capacity` does
/// unless it is told otherwise, so that both say the same, and more where waves take longer to repeat; but a tenth of it where
/// that is less than what is required by twice its interval.
pub fn simulate(sorter: &Sorter, required: f64, threads: usize, stop: Stop) -> Mean {
    let usual = Settings { threads, stop, ..Settings::default() };
    let least = sorter.waves.as_ref().map_or(0.0, |waves| 2.0 * waves.cycle() / 3600.0).ceil();
    let fed = sorter.always_fed();
    let of = |hours: f64, replications: usize| {
        measure(&fed, &Settings { hours: hours.max(least), replications, ..usual }).throughput
    };
    let brief = of(BRIEF.0, BRIEF.1);
    let far = brief.value + 2.0 * brief.half_width < required;
    if far { brief } else { of(usual.hours, usual.replications) }
}

/// Whether a mean is surely less than what is required: its interval of 95 % lies below.
pub fn is_short(found: Mean, required: f64) -> bool {
    found.value + found.half_width < required
}
