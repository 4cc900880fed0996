//! The correlated noise of sensors by what runs of a campaign do not share, where no run passes a place again.
//!
//! What the model misses at a place it misses in every run, more or less: what a run's residuals along the track have in
//! common with those of the other runs is the machine's. What a regression on them leaves, less what chaos and white
//! noise make of it, is noise. Where the gap is large and the others are noisier, it is a little more, as they tell the
//! gap with their noise. An effect whose trace in one run is no sum of those in the others counts as noise, too, so that
//! there is no more of it than sensors with so much white noise have.

use super::excess::{BandPower, Excess, OVER, Row};
use super::grid::{Grid, Lap};
use super::noise::Noise;
use crate::dynamics::CartRecord;
use crate::signal::FORCES;
use nalgebra::{DMatrix, DVector};

/// Parts of the way of a cart's passing, in which residuals are kept.
const PARTS: usize = 4;

/// Means that are known, over what regression takes from them, at least.
const LEAST: f64 = 3.0;

/// Correlated noise has no more deviations of the white noise than this.
const MOST: f64 = 6.0;

/// What a run's means along the track are off the model's.
#[derive(Clone, Debug, Default)]
pub struct Residuals {
    of: [OfForce; FORCES],
    /// Time for a part, s.
    part: f64,
    /// Of the record, s.
    length: f64,
    /// Samples in a part.
    samples: f64,
}

#[derive(Clone, Debug, Default)]
struct OfForce {
    /// N, by part; NaN where nothing was measured.
    parts: Vec<f64>,
    /// The variance of means over so many carts that chaos makes, N².
    chaos: [f64; OVER.len()],
    white: f64,
    bands: Vec<BandPower>,
}

impl Residuals {
    /// Of forces measured at stations, m, as their trigger is at a place, m, beside records of carts each of which goes
    /// around once.
    pub fn new(
        (station, forces): (&[f32], [&[f32]; FORCES]),
        (noise, bands): (&[Noise; FORCES], [Vec<BandPower>; FORCES]),
        trigger: f64,
        lap: Lap,
        (rate, records): (f64, &[CartRecord]),
    ) -> Residuals {
        let grid = Grid::new(lap, rate);
        let parts = PARTS * lap.carts;
        let time = lap.length / lap.speed;
        let mut bands = bands.into_iter();
        let of = std::array::from_fn(|force| {
            let bands = bands.next().unwrap_or_default();
            if forces[force].is_empty() {
                return OfForce::default();
            }
            let laps: Vec<Vec<f64>> =
                records.iter().map(|cart| means(&grid.once(&cart.station, &cart.forces[force]), parts)).collect();
            let model: Vec<f64> = (0..parts).map(|k| mean(laps.iter().map(|lap| lap[k]))).collect();
            let passes = grid.passes(station, forces[force], trigger);
            let passes: Vec<Vec<f64>> = passes.iter().map(|pass| means(pass, parts)).collect();
            let own: Vec<f64> = (0..parts).map(|k| mean(passes.iter().map(|pass| pass[k])) - model[k]).collect();
            let each = laps.iter().map(|lap| -> Vec<f64> { lap.iter().zip(&model).map(|(x, m)| x - m).collect() });
            let each: Vec<Vec<f64>> = each.collect();
            let chaos = OVER.map(|carts| mean(each.iter().map(|lap| square(&over(lap, carts)))));
            OfForce { parts: own, chaos, white: noise[force].white, bands }
        });
        let length = station.len() as f64 / rate;
        Residuals { of, part: time / parts as f64, length, samples: time * rate / parts as f64 }
    }
}

/// What each run has that the others do not share.
pub fn unshared(runs: &[Residuals]) -> Vec<Excess> {
    let of = |run: usize, force: usize| {
        let own = &runs[run].of[force];
        (rows(runs, run, force), own.bands.clone(), MOST * MOST * own.white * own.white)
    };
    (0..runs.len()).map(|run| Excess::known(std::array::from_fn(|force| of(run, force)))).collect()
}

/// Variances of a run's means over carts' passing beyond what the others tell of them.
fn rows(runs: &[Residuals], run: usize, force: usize) -> Vec<Row> {
    let own = &runs[run].of[force];
    let others = (0..runs.len()).filter(|k| *k != run).map(|k| &runs[k].of[force]);
    let others: Vec<&OfForce> = others.filter(|other| other.parts.len() == own.parts.len()).collect();
    if own.parts.is_empty() || others.is_empty() {
        return Vec::new();
    }
    let row = |(k, carts): (usize, &f64)| {
        let means: Vec<Vec<f64>> = std::iter::once(&own).chain(&others).map(|own| over(&own.parts, *carts)).collect();
        let known: Vec<usize> = (0..own.parts.len()).filter(|&p| means.iter().all(|own| own[p].is_finite())).collect();
        // Means over a stretch are one, however many begin in it.
        let long = carts * PARTS as f64;
        let count = known.len() as f64 / long;
        let free = count - others.len() as f64;
        if free < LEAST {
            return None;
        }
        let y = DVector::from_iterator(known.len(), known.iter().map(|&p| means[0][p]));
        let columns = 2 + others.len();
        let x = DMatrix::from_fn(known.len(), columns, |i, j| match j {
            0 => 1.0,
            1 => known[i] as f64 / own.parts.len() as f64 - 0.5,
            _ => means[j - 1][known[i]],
        });
        let normal = x.transpose() * &x;
        let found = normal.cholesky()?.solve(&(x.transpose() * &y));
        let left = (y - x * found).norm_squared() / known.len() as f64 * count / free;
        let white = own.white * own.white / (runs[run].samples * long);
        let deviation = left * (2.0 / free).sqrt();
        let over = long * runs[run].part;
        Some(Row::new((over, runs[run].length), (left - own.chaos[k] - white, deviation)))
    };
    OVER.iter().enumerate().filter_map(row).collect()
}

/// Means over parts of a lap of what is known at places.
fn means(places: &[f32], parts: usize) -> Vec<f64> {
    let part = |k: usize| {
        let of = |k: usize| k * places.len() / parts;
        mean(places[of(k)..of(k + 1)].iter().map(|x| f64::from(*x)))
    };
    (0..parts).map(part).collect()
}

/// Means over so many carts from each part on; NaN where any part is missing.
fn over(parts: &[f64], carts: f64) -> Vec<f64> {
    let long = (carts * PARTS as f64) as usize;
    let from = |k: usize| (k..k + long).map(|p| parts[p % parts.len()]).sum::<f64>() / long as f64;
    (0..parts.len()).map(from).collect()
}

/// Mean of what is known; NaN of nothing.
fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.filter(|x| x.is_finite()).fold((0.0, 0.0), |(sum, n), x| (sum + x, n + 1.0));
    sum / count
}

fn square(values: &[f64]) -> f64 {
    let level = mean(values.iter().copied());
    mean(values.iter().map(|x| (x - level) * (x - level)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::normal;
    use crate::identify::noise::{Process, mean_variance};

    const LAP: Lap = Lap { length: 80.0, speed: 2.0, carts: 64 };
    const RATE: f64 = 500.0;

    /// A lap of a cart, with so much of a gap that every run has.
    fn lap(noise: &Noise, gap: f64, seed: u64) -> (Vec<f32>, Vec<f32>) {
        let mut state = seed;
        let places = (LAP.length / LAP.speed * RATE) as u16;
        let station: Vec<f32> = (0..places).map(|k| f32::from(k) * (LAP.speed / RATE) as f32).collect();
        // Not by the table that simulated sensors draw from.
        let memory = crate::base::trig::exp(-1.0 / (RATE * noise.time().max(1e-9)));
        let deviation = noise.correlated_variance().sqrt();
        let mut own = normal(&mut state);
        let of = |s: &f32| {
            own = memory * own + (1.0 - memory * memory).sqrt() * normal(&mut state);
            let machine = 200.0 + 30.0 * (s * 0.7).sin() + (gap as f32) * (s * 0.4).sin() * (s * 0.11).cos();
            machine + (deviation * own + (noise.white + 0.5) * normal(&mut state)) as f32
        };
        let force = station.iter().map(of).collect();
        (station, force)
    }

    fn residuals(noise: &Noise, gap: f64, seed: u64) -> Residuals {
        let cart = |k: u64| {
            let (station, force) = lap(&Noise::default(), 0.0, 1000 + k);
            let mut forces: [Vec<f32>; FORCES] = Default::default();
            forces[2] = force;
            CartRecord { station, speed: Vec::new(), forces }
        };
        let records: Vec<CartRecord> = (0..24).map(cart).collect();
        let (station, force) = lap(noise, gap, seed);
        let mut forces: [&[f32]; FORCES] = [&[]; FORCES];
        forces[2] = &force;
        let known = [Noise { white: 0.5, ..Noise::default() }; FORCES];
        Residuals::new((&station, forces), (&known, Default::default()), 0.0, LAP, (RATE, &records))
    }

    #[test]
    fn noise_of_single_laps_is_what_the_others_do_not_share() {
        let levels = [0.8, 0.4, 1.2];
        for gap in [0.0, 5.0] {
            let runs: Vec<Residuals> = levels
                .into_iter()
                .zip([0.8, 1.0, 1.3])
                .zip(3..)
                .map(|((level, share), seed)| {
                    let noise = Noise { white: 0.5, ..Process { variance: level * level, time: 0.3 }.into() };
                    residuals(&noise, gap * share, seed)
                })
                .collect();
            for (noise, level) in Excess::noise(&unshared(&runs)).iter().zip(levels) {
                // Of means over two carts' passing; a single lap hardly tells time from level.
                let of = |own: &Process| own.variance * mean_variance(2.0 * LAP.length / LAP.speed / 64.0, own.time);
                let found = noise[2].correlated().map(of).sum::<f64>().sqrt();
                let truth = of(&Process { variance: level * level, time: 0.3 }).sqrt();
                // What the others tell of a gap has their noise.
                let most = 1.6 * if gap > 0.0 { of(&Process { variance: 1.44, time: 0.3 }).sqrt() } else { truth };
                assert!((0.6 * truth..most).contains(&found), "{gap} {found} {truth} {:?}", noise[2].processes[0]);
                assert_eq!(noise[0], Noise::default());
            }
        }
    }

    #[test]
    fn white_noise_and_a_gap_that_all_share_are_no_correlated_noise() {
        let white = Noise { white: 0.5, ..Noise::default() };
        let runs: Vec<Residuals> = (5..8).map(|seed| residuals(&white, 5.0, seed)).collect();
        let found = Excess::noise(&unshared(&runs));
        let most = found.iter().map(|noise| noise[2].correlated_variance().sqrt()).fold(0.0, f64::max);
        assert!(most < 0.15, "{found:?}");
        assert!(unshared(&runs[..1])[0].length() == 0.0);
    }
}
