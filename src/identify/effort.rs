//! How much was simulated.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Simulations that were made, and the time that they simulate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    pub simulations: u64,
    /// µs: whole numbers have the same sum on any number of threads.
    pub simulated: u64,
}

impl Effort {
    pub fn plus(self, other: Effort) -> Effort {
        Effort { simulations: self.simulations + other.simulations, simulated: self.simulated + other.simulated }
    }

    /// What came since an earlier count.
    pub fn since(self, earlier: Effort) -> Effort {
        Effort { simulations: self.simulations - earlier.simulations, simulated: self.simulated - earlier.simulated }
    }
}

/// A count that all clones share.
#[derive(Clone, Debug, Default)]
pub struct Counter(Arc<[AtomicU64; 2]>);

impl Counter {
    /// Goes on from what was simulated before.
    pub fn after(before: Effort) -> Counter {
        Counter(Arc::new([AtomicU64::new(before.simulations), AtomicU64::new(before.simulated)]))
    }

    /// One more simulation, of so many seconds.
    pub fn add(&self, seconds: f64) {
        let [simulations, simulated] = &*self.0;
        simulations.fetch_add(1, Ordering::Relaxed);
        simulated.fetch_add((1e6 * seconds).round() as u64, Ordering::Relaxed);
    }

    pub fn effort(&self) -> Effort {
        let [simulations, simulated] = &*self.0;
        Effort { simulations: simulations.load(Ordering::Relaxed), simulated: simulated.load(Ordering::Relaxed) }
    }
}
