//! White noise that is the same wherever and however often it is drawn.

use crate::base::trig;
use std::sync::OnceLock;

/// Numbers drawn once.
const TABLE: usize = 1 << 14;

/// SplitMix64 (Steele, Lea and Flood 2014): the next state and a well-mixed number of it.
pub fn mix(state: &mut u64) -> u64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Uniform in (0, 1).
pub fn uniform(state: &mut u64) -> f64 {
    ((mix(state) >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
}

/// Standard normal (Box and Muller 1958).
pub fn normal(state: &mut u64) -> f64 {
    let (u, v) = (uniform(state), uniform(state));
    (-2.0 * trig::ln(u)).sqrt() * trig::cos(trig::TAU * v)
}

/// A stream of [`mix`] that stays the same for ever, which snapshots rely on.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Random(seed)
    }

    /// Uniform in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        (mix(&mut self.0) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Standard normal (Box and Muller 1958).
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * trig::ln(1.0 - self.uniform())).sqrt();
        radius * trig::cos(trig::TAU * self.uniform())
    }
}

/// Samples with white noise of a deviation added, walking a table from a place that `seed` picks.
pub fn noisy(samples: &[f32], deviation: f32, seed: u64) -> Vec<f32> {
    if deviation <= 0.0 {
        return samples.to_vec();
    }
    static NORMAL: OnceLock<Vec<f32>> = OnceLock::new();
    let table = NORMAL.get_or_init(|| {
        let mut state = 1;
        (0..TABLE).map(|_| normal(&mut state) as f32).collect()
    });
    let mut state = seed;
    let mut at = mix(&mut state) as usize;
    let mut out = Vec::with_capacity(samples.len());
    for part in samples.chunks(1024) {
        // A new place each time, so that two channels that meet once do not stay together.
        at = at.wrapping_add(mix(&mut state) as usize);
        let mut left = part;
        let mut from = at % TABLE;
        while !left.is_empty() {
            let (now, later) = left.split_at(left.len().min(TABLE - from));
            out.extend(now.iter().zip(&table[from..]).map(|(x, noise)| x + deviation * noise));
            (left, from) = (later, 0);
        }
    }
    out
}

/// Adds noise of a deviation to samples that remembers so much of itself from one to the next. What it adds to its
/// memory is uniform, which is normal in the sum of many.
pub fn add_correlated(samples: &mut [f32], deviation: f64, memory: f64, seed: u64) {
    let mut state = seed;
    let innovation = (12.0 * (1.0 - memory * memory).max(0.0)).sqrt();
    let mut noise = normal(&mut state);
    for sample in samples {
        *sample += (deviation * noise) as f32;
        noise = memory * noise + innovation * (uniform(&mut state) - 0.5);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::measures::statistics;

    #[test]
    fn noise_has_its_deviation_and_no_memory() {
        let x: Vec<f64> = noisy(&[5.0; 50_000], 2.0, 7).into_iter().map(f64::from).collect();
        let found = statistics(&x).expect("samples");
        assert!((found.mean - 5.0).abs() < 0.05 && (found.sd - 2.0).abs() < 0.03, "{found:?}");
        let product: f64 = x.windows(2).map(|w| (w[0] - 5.0) * (w[1] - 5.0)).sum::<f64>() / 5e4;
        assert!(product.abs() < 0.06, "{product}");
        assert_eq!(noisy(&[1.0; 9], 1.0, 3), noisy(&[1.0; 9], 1.0, 3));
    }
}
