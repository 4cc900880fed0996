//! Draws by chance, and what they draw on.

use crate::base::random::{mix, uniform};
use crate::base::trig;
use crate::chain_input::Simulation;

/// A number in a range.
pub fn draw(state: &mut u64, from: f64, to: f64) -> f64 {
    from + (to - from) * uniform(state)
}

/// One in a range, evenly by its logarithm.
pub fn draw_log(state: &mut u64, from: f64, to: f64) -> f64 {
    trig::exp(draw(state, trig::ln(from), trig::ln(to)))
}

/// One of the first `count` numbers.
pub fn pick(state: &mut u64, count: usize) -> usize {
    (mix(state) % count.max(1) as u64) as usize
}

/// Length of the track, m.
pub fn lap(simulation: &Simulation) -> f64 {
    simulation.track.centre_line().length
}

/// Adds a profile over the lap to a closed table.
pub fn add(table: &mut Vec<f64>, lap: f64, profile: impl Fn(f64) -> f64) {
    if table.is_empty() {
        table.resize(((lap * POINTS_A_METRE) as usize).max(16), 0.0);
    }
    let n = table.len();
    for (k, x) in table.iter_mut().enumerate() {
        *x += profile(lap * k as f64 / n as f64);
    }
}

/// In another order (Fisher and Yates).
pub fn shuffle<T>(items: &mut [T], state: &mut u64) {
    for k in (1..items.len()).rev() {
        items.swap(k, pick(state, k + 1));
    }
}

/// Points of a profile a metre of track.
const POINTS_A_METRE: f64 = 200.0;
