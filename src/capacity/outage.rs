//! Failures of one piece of equipment as they happen.

use super::sorter::Failures;
use super::stream::exponential;
use crate::base::random::Random;

/// Whether it works, and until when.
#[derive(Debug)]
pub(super) struct Outage {
    random: Random,
    between: f64,
    duration: f64,
    down: bool,
    /// When that changes, s.
    until: f64,
}

impl Outage {
    /// Down at the begin as often as at any other time: exponential times have no memory.
    pub(super) fn new(fails: &Failures, mut random: Random) -> Outage {
        let Failures { between, duration, .. } = *fails;
        let down = random.uniform() >= fails.available();
        let until = exponential(&mut random, if down { duration } else { between });
        Outage { random, between, duration, down, until }
    }

    /// Whether it is down at a time, s, that is not before the one last asked for.
    pub(super) fn is_down(&mut self, now: f64) -> bool {
        while self.until <= now {
            self.down = !self.down;
            self.until += exponential(&mut self.random, if self.down { self.duration } else { self.between });
        }
        self.down
    }
}
