//! The repeatability of a measured run: by how much its features would differ if the same were measured again.
//!
//! There is no second run to compare with, so the noise is taken from what a model leaves and what no model of its
//! error foretells (`model_error.rs`). Of means over windows it is what is faster than a window: the means of the two
//! halves differ by it, and half of that difference is a draw of the noise of the whole window's mean. Of samples it is
//! what is faster than a thirtieth of the run. What is slower cannot be told from the machine; there, it counts how
//! closely the model is believed to follow.

use super::Rows;
use super::model_error::{MEDIAN_SQUARE, by_second_differences, fast};
use super::windows::{Kind, Windows};
use crate::base::random::{normal, uniform};
use crate::base::trig;
use crate::gap::settings;

/// How far replicate features differ.
#[derive(Clone, Debug)]
pub(super) struct Repeatability {
    pub variance: Vec<f64>,
    pub scatter: Vec<Vec<f64>>,
    pub discrepancies: Vec<Vec<f64>>,
}

/// What the repeatability of a run is found from.
pub(super) struct Inputs<'a> {
    pub windows: &'a Windows,
    /// What nothing foretells of measured less simulated, a row a channel.
    pub noise: &'a Rows,
    /// Whether these are what the best hypothesis leaves. What the nominal model leaves may swing by a misfit, and is
    /// no more than second differences have.
    pub settled: bool,
    /// Features as measured.
    pub measured: &'a [f64],
    /// How closely the model is believed to follow each channel, in its unit.
    pub accuracy: &'a [f64],
    /// What that is multiplied by.
    pub factor: f64,
    /// Mean square by which each channel's features differ when the model is asked twice.
    pub repeat: &'a [f64],
}

/// Noise of a channel.
struct Noise {
    /// Draws of it, of unit variance.
    draws: Vec<f64>,
    /// Of each window.
    deviation: Vec<f64>,
    /// Of what is slower.
    slow: f64,
}

impl Repeatability {
    pub fn new(from: &Inputs, settings: &settings::Noise) -> Repeatability {
        let count = from.windows.count();
        let all = match from.windows.kind {
            Kind::Means => of_means(from),
            Kind::Samples => of_samples(from, settings),
        };
        let channels: Vec<Noise> = (0..from.noise.len())
            .map(|c| {
                let of = |x: &'_ [f64]| x[c * count..(c + 1) * count].to_vec();
                let agreed = settings.agreement * range(&of(from.measured));
                let slow = trig::hypot(from.factor * from.accuracy[c].max(agreed), from.repeat[c].sqrt());
                Noise::new(&of(&all), slow, settings.own)
            })
            .collect();
        let variance = channels.iter().flat_map(|c| c.deviation.iter().map(|d| d * d + c.slow * c.slow)).collect();
        let discrepancy = |c: usize| {
            (0..channels.len()).flat_map(|k| vec![if k == c { channels[k].slow } else { 0.0 }; count]).collect()
        };
        let block = match from.windows.kind {
            Kind::Means => settings.block,
            Kind::Samples => settings.block * from.windows.memory,
        };
        Repeatability {
            variance,
            scatter: (0..settings.samples as u64).map(|k| sample(&channels, count, block, k, settings)).collect(),
            discrepancies: (0..channels.len()).filter(|&c| channels[c].slow > 0.0).map(discrepancy).collect(),
        }
    }
}

/// Draws of the noise of each window's mean.
fn of_means(from: &Inputs) -> Vec<f64> {
    let count = from.windows.count();
    let means = from.windows.means(from.noise);
    let halves = from.windows.halves(from.noise);
    let each = means.chunks(count).zip(halves[0].chunks(count)).zip(halves[1].chunks(count));
    each.flat_map(|((means, first), second)| draws(means, first, second)).collect()
}

/// Draws of the noise of each sample.
fn of_samples(from: &Inputs, settings: &settings::Noise) -> Vec<f64> {
    let own = |row: &Vec<f64>| {
        let mut fast = fast(row, row.len() / settings.slow);
        let known = || fast.iter().filter(|x| x.is_finite());
        let square = known().map(|x| x * x).sum::<f64>() / known().count().max(1) as f64;
        let least = by_second_differences(&fast);
        if !from.settled && least < settings.smooth * square {
            let down = (least / square).sqrt();
            fast.iter_mut().for_each(|x| *x *= down);
        }
        fast
    };
    from.windows.means(&from.noise.iter().map(own).collect::<Vec<_>>())
}

/// Of each window a draw of its mean's noise: half of what its halves' means differ by, less what they do because the
/// windows around it rise or fall. NaN where a half is lost.
fn draws(means: &[f64], first: &[f64], second: &[f64]) -> Vec<f64> {
    let rise = |i: usize| match (i.checked_sub(1).and_then(|b| means.get(b)), means.get(i + 1)) {
        (Some(before), Some(after)) if (after - before).is_finite() => 0.25 * (after - before),
        _ => 0.0,
    };
    // The rise adds 1/32 to the variance.
    let scale = (32.0_f64 / 33.0).sqrt();
    first.iter().zip(second).enumerate().map(|(i, (a, b))| scale * 0.5 * (b - a - rise(i))).collect()
}

impl Noise {
    fn new(draws: &[f64], slow: f64, own: f64) -> Noise {
        let mut squares: Vec<f64> = draws.iter().map(|d| d * d).filter(|d| d.is_finite()).collect();
        squares.sort_by(f64::total_cmp);
        let as_built = squares.get(squares.len() / 2).map_or(0.0, |median| median / MEDIAN_SQUARE).sqrt();
        let deviation = |d: &f64| if d.abs() > own * as_built { d.abs() } else { as_built };
        let deviation: Vec<f64> = draws.iter().map(deviation).collect();
        let ratio = |(d, deviation): (&f64, &f64)| if *deviation > 0.0 && d.is_finite() { d / deviation } else { 0.0 };
        let mut unit: Vec<f64> = draws.iter().zip(&deviation).map(ratio).collect();
        // What the median missed of the mean square.
        let square = unit.iter().map(|u| u * u).sum::<f64>() / squares.len().max(1) as f64;
        let factor = if square > 0.0 { square.sqrt() } else { 1.0 };
        unit.iter_mut().for_each(|u| *u /= factor);
        Noise { draws: unit, deviation: deviation.into_iter().map(|d| d * factor).collect(), slow }
    }
}

/// A sample of the repeatability: blocks of draws from other places, with either sign and alike in all channels; and
/// slow waves as large as the model is inaccurate.
fn sample(channels: &[Noise], count: usize, block: usize, number: u64, settings: &settings::Noise) -> Vec<f64> {
    let mut state = 0x6f75_7473_6964_6500 ^ number;
    let blocks: Vec<(usize, f64)> = (0..count.div_ceil(block))
        .map(|_| {
            let from = (uniform(&mut state) * count as f64) as usize;
            (from, if uniform(&mut state) < 0.5 { -1.0 } else { 1.0 })
        })
        .collect();
    let mut all = Vec::with_capacity(channels.len() * count);
    for channel in channels {
        let waves: Vec<f64> = (0..settings.waves).map(|_| normal(&mut state)).collect();
        let size = channel.slow * (2.0 / settings.waves as f64).sqrt();
        for i in 0..count {
            let (from, sign) = blocks[i / block];
            let noise = sign * channel.deviation[i] * channel.draws[(from + i % block) % count];
            let phase = trig::PI * (i as f64 + 0.5) / count as f64;
            let wave: f64 = waves.iter().enumerate().map(|(k, w)| w * trig::cos((k + 1) as f64 * phase)).sum();
            all.push(noise + size * wave);
        }
    }
    all
}

fn range(x: &[f64]) -> f64 {
    let known = || x.iter().copied().filter(|x| x.is_finite());
    let (low, high) = (known().fold(f64::INFINITY, f64::min), known().fold(f64::NEG_INFINITY, f64::max));
    if high > low { high - low } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// White noise over a line that rises, with a jump: the noise is found, and only the jump's window has more.
    #[test]
    fn noise_is_found_beside_trends_and_jumps() {
        let settings = settings::Noise::default();
        let (count, mut state) = (400, 11);
        let mut half = |i: usize| {
            let jump = if i > 400 { 30.0 } else { 0.0 };
            0.2 * i as f64 + jump + normal(&mut state)
        };
        let pairs: Vec<(f64, f64)> = (0..count).map(|i| (half(2 * i), half(2 * i + 1))).collect();
        let (first, second): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
        let means: Vec<f64> = first.iter().zip(&second).map(|(a, b)| 0.5 * (a + b)).collect();
        let noise = Noise::new(&draws(&means, &first, &second), 0.0, settings.own);
        let truth = 0.5_f64.sqrt();
        assert!((noise.deviation[10] / truth - 1.0).abs() < 0.1, "{}", noise.deviation[10]);
        assert!(noise.deviation[200] > 5.0, "{}", noise.deviation[200]);
        assert!(noise.deviation.iter().filter(|d| **d > 3.0).count() <= 3);
        let samples: Vec<f64> = (0..settings.samples as u64)
            .flat_map(|k| sample(std::slice::from_ref(&noise), count, settings.block, k, &settings))
            .collect();
        let as_built: Vec<f64> = samples.iter().filter(|x| x.abs() < 3.0).map(|x| x * x).collect();
        let found = (as_built.iter().sum::<f64>() / as_built.len() as f64).sqrt();
        assert!((found / truth - 1.0).abs() < 0.15, "{found}");
    }

    #[test]
    fn inaccuracy_is_slow_and_as_large_as_was_said() {
        let settings = settings::Noise::default();
        let quiet = Noise::new(&[0.0; 200], 2.0, settings.own);
        let samples: Vec<Vec<f64>> = (0..settings.samples as u64)
            .map(|k| sample(std::slice::from_ref(&quiet), 200, settings.block, k, &settings))
            .collect();
        let square = samples.iter().flatten().map(|x| x * x).sum::<f64>() / (200.0 * settings.samples as f64);
        assert!((square.sqrt() - 2.0).abs() < 0.3, "{square}");
        assert!(samples[0].windows(2).all(|w| (w[1] - w[0]).abs() < 0.5));
    }
}
