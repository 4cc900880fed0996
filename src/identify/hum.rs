//! Mains hum of a sensor: a sine near a multiple of 50 or 60 Hz that stands out of its neighbourhood. It is no part of
//! the chain's motion, and taken off before anything is compared.

use crate::base::number::tidy;
use crate::base::trig;
use serde::{Deserialize, Serialize};

/// Frequencies of mains and their first multiples, Hz.
const MAINS: [f64; 6] = [50.0, 60.0, 100.0, 120.0, 150.0, 180.0];

/// How far from there hum is looked for, Hz: a large grid keeps its frequency to 0.2 Hz.
const NEAR: f64 = 0.2;

/// Samples are gathered over this time, s, and hum keeps its amplitude and phase for [`KEEPS`] times as long.
const GATHERED: f64 = 1.0;
const KEEPS: usize = 10;

/// A line is hum from so many times the power on which chance would put it on.
const STANDS_OUT: f64 = 20.0;

/// Where else the power is looked at, Hz from the mains.
const BESIDE: [f64; 6] = [-3.1, -2.3, -1.4, 1.4, 2.3, 3.1];

/// Less gathered times than this tell no hum.
const LEAST: usize = 8;

/// Hum of a sensor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Hum {
    pub hz: f64,
    /// In the sensor's unit.
    pub amplitude: f64,
    /// Deviation of what is not taken off, as the chain moves at that frequency, too; in the sensor's unit.
    #[serde(skip)]
    pub left: f64,
}

/// Takes hum off samples at a rate, Hz, and says what it was. Lines within a record's resolution of a multiple of
/// `own` frequencies, Hz, are the chain's and stay.
pub fn take_off(samples: &mut [f64], rate: f64, own: &[f64]) -> Vec<Hum> {
    let mut found = Vec::new();
    for mains in MAINS.into_iter().filter(|mains| *mains < 0.49 * rate) {
        let about = Demodulated::new(samples, rate, mains);
        let known: Vec<usize> = (0..about.0.len()).filter(|k| about.0[*k].is_some()).collect();
        if known.len() < LEAST {
            continue;
        }
        let blocks = about.0.len() as f64;
        // In steps of a quarter of the resolution.
        let steps = (4.0 * NEAR * GATHERED * blocks) as i32;
        let off = |step: i32| f64::from(step) / (4.0 * GATHERED * blocks);
        let power = |step: i32| square(about.mean(off(step), &known));
        let Some(best) = (-steps..=steps).max_by(|a, b| power(*a).total_cmp(&power(*b))) else { continue };
        let beside = BESIDE.map(|by| Demodulated::new(samples, rate, mains + by).power());
        let usual = beside.iter().sum::<f64>() / BESIDE.len() as f64 / known.len() as f64;
        let hz = mains + off(best);
        let is_own = own.iter().any(|own| (hz - (hz / own).round() * own).abs() < 2.0 / (GATHERED * blocks));
        if power(best) > STANDS_OUT * usual && !is_own {
            Demodulated::new(samples, rate, hz).take_off(samples, rate, hz);
            // A mean over so many has as much of the power beside; a sine of amplitude A has the variance A²/2.
            let over = known.len().min(2 * KEEPS + 1) as f64;
            let left = (2.0 * usual * known.len() as f64 / over).sqrt();
            found.push(Hum { hz: tidy(hz), amplitude: tidy(2.0 * power(best).sqrt()), left });
        }
    }
    found
}

/// Means of a signal times exp(−2πi f t) over gathered samples; none where half of them are lost.
struct Demodulated(Vec<Option<[f64; 2]>>);

fn square([re, im]: [f64; 2]) -> f64 {
    re * re + im * im
}

fn turned([re, im]: [f64; 2], angle: f64) -> [f64; 2] {
    let (sin, cos) = (trig::sin(angle), trig::cos(angle));
    [re * cos - im * sin, re * sin + im * cos]
}

impl Demodulated {
    fn new(samples: &[f64], rate: f64, hz: f64) -> Demodulated {
        let long = (GATHERED * rate).round().max(1.0) as usize;
        let step = trig::TAU * hz / rate;
        let one = |(block, part): (usize, &[f64])| {
            let known = part.iter().filter(|x| !x.is_nan());
            let count = known.clone().count();
            let mean = known.sum::<f64>() / count.max(1) as f64;
            let mut sum = [0.0, 0.0];
            for (k, x) in part.iter().enumerate().filter(|(_, x)| !x.is_nan()) {
                let phase = step * (block * long + k) as f64;
                sum = [sum[0] + (x - mean) * trig::cos(phase), sum[1] - (x - mean) * trig::sin(phase)];
            }
            (2 * count > long).then(|| sum.map(|x| x / count as f64))
        };
        Demodulated(samples.chunks(long).enumerate().map(one).collect())
    }

    /// Mean of what is known, at a frequency so far off.
    fn mean(&self, off: f64, known: &[usize]) -> [f64; 2] {
        let mut sum = [0.0, 0.0];
        for &k in known {
            let one = turned(self.0[k].unwrap_or_default(), -trig::TAU * off * GATHERED * (k as f64 + 0.5));
            sum = [sum[0] + one[0], sum[1] + one[1]];
        }
        sum.map(|x| x / known.len() as f64)
    }

    fn power(&self) -> f64 {
        let known = self.0.iter().flatten();
        known.clone().map(|x| square(*x)).sum::<f64>() / known.count().max(1) as f64
    }

    /// Takes the line off samples, with amplitude and phase as they are about each gathered time.
    fn take_off(&self, samples: &mut [f64], rate: f64, hz: f64) {
        let long = (GATHERED * rate).round().max(1.0) as usize;
        let step = trig::TAU * hz / rate;
        for (block, part) in samples.chunks_mut(long).enumerate() {
            let about = block.saturating_sub(KEEPS)..(block + KEEPS + 1).min(self.0.len());
            let near: Vec<[f64; 2]> = self.0[about].iter().flatten().copied().collect();
            let n = near.len().max(1) as f64;
            let [re, im] = near.iter().fold([0.0, 0.0], |sum, x| [sum[0] + x[0] / n, sum[1] + x[1] / n]);
            for (k, x) in part.iter_mut().enumerate() {
                let phase = step * (block * long + k) as f64;
                *x -= 2.0 * (re * trig::cos(phase) - im * trig::sin(phase));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::normal;

    fn signal(hum: f64, hz: f64) -> Vec<f64> {
        let mut state = 3;
        let one = |k: i32| {
            let t = f64::from(k) / 500.0;
            40.0 * trig::sin(trig::TAU * 1.6 * t) + normal(&mut state) + hum * trig::sin(trig::TAU * hz * t + 1.0)
        };
        (0..30_000).map(one).collect()
    }

    #[test]
    fn hum_is_found_and_taken_off_and_white_noise_is_none() {
        let (clean, mut noisy) = (signal(0.0, 50.0), signal(0.4, 50.07));
        assert_eq!(take_off(&mut clean.clone(), 500.0, &[1.6]), []);
        let found = take_off(&mut noisy, 500.0, &[1.6]);
        assert_eq!(found.len(), 1);
        assert!((found[0].hz - 50.07).abs() < 0.01 && (found[0].amplitude - 0.4).abs() < 0.05, "{found:?}");
        let left = noisy.iter().zip(&clean).map(|(a, b)| (a - b) * (a - b)).sum::<f64>() / clean.len() as f64;
        assert!(left.sqrt() < 0.06, "{}", left.sqrt());
        // As much as is said, up to what the hum of that frequency turned in the time.
        assert!((0.5..2.0).contains(&(left.sqrt() / found[0].left)), "{} {}", left.sqrt(), found[0].left);
    }

    #[test]
    fn a_line_of_the_chain_stays() {
        let mut samples = signal(0.4, 50.07);
        assert_eq!(take_off(&mut samples, 500.0, &[5.007]), []);
    }
}
