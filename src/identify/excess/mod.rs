//! The correlated noise of sensors that runs of a campaign have in common, where they pass places again.
//!
//! Two passes of one place by one cart differ by the chain's chaos and by noise alone: whatever the model misses, they
//! share. So the variance of means of their differences, less that of simulated passes, is the noise's own. It is taken
//! for a process of first order, which has no more in any band than was measured there.

mod band_power;
mod row;

pub use band_power::BandPower;
pub(super) use row::Row;

use super::grid::{Grid, Lap};
use super::noise::{Noise, Process};
use crate::base::trig;
use crate::dynamics::CartRecord;
use crate::signal::FORCES;
use row::CELLS;

/// Over how many carts' passing means are taken: what repeats with each cart is none of them.
pub(super) const OVER: [f64; 3] = [1.0, 2.0, 4.0];

/// Correlation times that are thought of, s: the first, their ratio, and how many.
const TIMES: (f64, f64, usize) = (0.08, 1.2, 22);

/// Pairs of simulated carts that are held beside each other at most.
const PAIRS: usize = 24;

/// A variance is known no better than to this share of the largest, and of what chaos makes.
const KNOWN: f64 = 0.1;

/// A variance is believed from so many of its deviations on.
const SURE: f64 = 2.0;

/// A run has noise of its own where twice the logarithm of the likelihood is larger by this, which a level and a time of
/// its own add by chance on average (Wilks 1938).
const UNLIKE: f64 = 2.0;

/// As many variances of means over different times tell as much as one would.
const ALIKE: f64 = OVER.len() as f64;

/// Passes are told apart where they have at least so much of a time in common, s.
const LEAST_S: f64 = 1.5;

/// What a run's passes of the same places differ by beyond simulated ones, of each force. Empty where no place was passed
/// twice.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Excess([OfForce; FORCES]);

#[derive(Clone, Debug, Default, PartialEq)]
struct OfForce {
    rows: Vec<Row>,
    /// What was measured in bands: noise has no more there.
    bands: Vec<BandPower>,
    /// Its variance is no more than this, N²; of what passes of one place differ by there is no such limit.
    most: Option<f64>,
}

impl Excess {
    /// Of forces measured at stations, m, as their trigger is at a place, m, beside records of carts each of which goes
    /// around once.
    pub fn new(
        (station, forces): (&[f32], [&[f32]; FORCES]),
        bands: [Vec<BandPower>; FORCES],
        trigger: f64,
        lap: Lap,
        (rate, records): (f64, &[CartRecord]),
    ) -> Excess {
        let grid = Grid::new(lap, rate);
        let times = OVER.map(|count| count * lap.length / lap.carts as f64 / lap.speed);
        let of = |force: usize| -> Vec<Row> {
            let passes = grid.passes(station, forces[force], trigger);
            let differences: Vec<Vec<f32>> = passes.windows(2).map(|two| less(&two[1], &two[0])).collect();
            let differences: Vec<Vec<f32>> = differences.into_iter().filter(|d| long(&grid, d)).collect();
            if differences.is_empty() {
                return Vec::new();
            }
            let known = differences.iter().map(|d| d.iter().filter(|x| x.is_finite()).count()).sum::<usize>();
            let length = known as f64 / differences.len() as f64 / grid.rate;
            let carts = records.len();
            let once = |cart: &CartRecord| grid.once(&cart.station, &cart.forces[force]);
            let pairs = (carts / 2).min(PAIRS);
            let simulated: Vec<Vec<f32>> =
                (0..pairs).map(|k| less(&once(&records[k]), &once(&records[k + carts / 2]))).collect();
            let found: Vec<[f64; OVER.len()]> = differences.iter().map(|d| variances(&grid, d, &times)).collect();
            // Of the same places.
            let alike: Vec<[f64; OVER.len()]> = simulated
                .iter()
                .flat_map(|d| differences.iter().map(|places| variances(&grid, &only(d, places), &times)))
                .collect();
            let row = |(k, over): (usize, &f64)| {
                let known = |list: &[[f64; OVER.len()]]| -> Vec<f64> {
                    list.iter().map(|one| one[k]).filter(|x| x.is_finite()).collect()
                };
                let (found, alike) = (known(&found), known(&alike));
                let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
                let usual = mean(&alike);
                let square = alike.iter().map(|x| (x - usual) * (x - usual)).sum::<f64>() / (alike.len() as f64 - 1.0);
                let deviation = trig::hypot((square / found.len() as f64).sqrt(), KNOWN * usual);
                let deviation = trig::hypot(deviation, chance(&grid, &differences, *over));
                Row { over: *over, length, excess: mean(&found) - usual, deviation }
            };
            times
                .iter()
                .enumerate()
                .map(row)
                .filter(|row| row.excess.is_finite() && row.deviation.is_finite())
                .collect()
        };
        let mut force = 0..;
        Excess(bands.map(|bands| OfForce { rows: force.next().map_or_else(Vec::new, of), bands, most: None }))
    }

    /// Of variances that are known from elsewhere.
    pub(super) fn known(each: [(Vec<Row>, Vec<BandPower>, f64); FORCES]) -> Excess {
        Excess(each.map(|(rows, bands, most)| OfForce { rows, bands, most: Some(most) }))
    }

    /// For how long places were passed again, s.
    pub fn length(&self) -> f64 {
        self.0.iter().flat_map(|own| &own.rows).map(|row| row.length).fold(0.0, f64::max)
    }

    /// Adds what is known from elsewhere.
    pub fn add(&mut self, other: Excess) {
        for (own, other) in self.0.iter_mut().zip(other.0) {
            own.rows.extend(other.rows);
            if own.bands.is_empty() {
                own.bands = other.bands;
            }
            own.most = own.most.or(other.most);
        }
    }

    /// The correlated noise of each force in each run. Runs of a campaign have the same sensors, so what all tell of a
    /// force holds of each run, but of one that is unlike the others.
    pub fn noise(runs: &[Excess]) -> Vec<[Noise; FORCES]> {
        let together: [Option<Process>; FORCES] =
            std::array::from_fn(|force| exponential(&runs.iter().map(|run| &run.0[force]).collect::<Vec<_>>()));
        let of = |own: &OfForce, together: Option<Process>| {
            let alone = exponential(&[own]);
            let [alike, apart] = [together, alone].map(|noise| own.unlikely(noise.unwrap_or_default()));
            if alike - apart > UNLIKE { alone } else { together }
        };
        let noise = |run: &Excess| {
            std::array::from_fn(|force| of(&run.0[force], together[force]).map_or_else(Noise::default, Noise::from))
        };
        runs.iter().map(noise).collect()
    }
}

impl OfForce {
    /// Less twice the logarithm of the likelihood of its variances with a noise.
    fn unlikely(&self, noise: Process) -> f64 {
        let of = |row: &Row| {
            let shape = if noise.variance > 0.0 { row.of(noise.time) } else { 0.0 };
            let sampled = noise.variance * shape * row.sampled(noise.time);
            let deviation = trig::hypot(row.deviation, sampled);
            let off = (row.excess - noise.variance * shape) / deviation;
            off * off + 2.0 * trig::ln(deviation)
        };
        self.rows.iter().map(of).sum::<f64>() / ALIKE
    }
}

/// The variance and the time of σ² exp(−t/τ) of noise that has no more in any band than was measured there, if there is
/// any beyond doubt. Means over carts' passing hardly tell short times from still shorter ones, so that the time is the
/// mean of its logarithm over all that are thought of, by how likely each is.
fn exponential(known: &[&OfForce]) -> Option<Process> {
    let rows: Vec<Row> = known.iter().flat_map(|own| &own.rows).copied().collect();
    let bands: Vec<BandPower> = known.iter().flat_map(|own| &own.bands).copied().collect();
    let limit = known.iter().filter_map(|own| own.most).fold(f64::INFINITY, f64::min);
    let (rows, bands) = (rows.as_slice(), (bands.as_slice(), limit));
    // No moment is known much better than the others, as no noise is quite of this kind.
    let clear = rows.iter().filter(|row| row.excess > SURE * row.deviation);
    let most = clear.map(|row| row.excess).fold(0.0, f64::max);
    if most <= 0.0 {
        return None;
    }
    let (first, ratio, count) = TIMES;
    let times = std::iter::successors(Some(first), |time| Some(time * ratio)).take(count);
    let each: Vec<OfTime> = times.map(|time| OfTime::new(rows, bands, time, most)).collect();
    let least = each.iter().map(|own| own.unlikely).fold(f64::INFINITY, f64::min);
    let (mut all, mut sum, mut sure) = (0.0, 0.0, false);
    for own in &each {
        let weight = trig::exp(0.5 * (least - own.unlikely));
        (all, sum) = (all + weight, sum + weight * trig::ln(own.time));
        sure |= own.unlikely == least && own.variance > SURE * own.deviation;
    }
    let mean = OfTime::new(rows, bands, trig::exp(sum / all), most);
    (sure && mean.variance > 0.0).then_some(Process { variance: mean.variance, time: mean.time })
}

/// Noise of one correlation time.
struct OfTime {
    time: f64,
    /// The likeliest.
    variance: f64,
    deviation: f64,
    /// Less twice the logarithm of the likelihood.
    unlikely: f64,
}

impl OfTime {
    /// `most` is the largest excess that is clear.
    fn new(rows: &[Row], (bands, limit): (&[BandPower], f64), time: f64, most: f64) -> OfTime {
        let limit = bands.iter().map(|own| own.all_of(time)).fold(limit, f64::min);
        let shapes: Vec<f64> = rows.iter().map(|row| row.of(time)).collect();
        let fitted = |deviations: &[f64]| {
            let (mut square, mut along) = (0.0, 0.0);
            for ((row, shape), deviation) in rows.iter().zip(&shapes).zip(deviations) {
                square += (shape / deviation) * (shape / deviation);
                along += shape * row.excess / (deviation * deviation);
            }
            ((along / square).clamp(0.0, limit), square)
        };
        let alike: Vec<f64> = rows.iter().map(|row| trig::hypot(row.deviation, KNOWN * most)).collect();
        let (first, square) = fitted(&alike);
        // A length has so many independent means of noise that lasts.
        let sampled = |(row, shape): (&Row, &f64)| {
            let scatter = first * shape * row.sampled(time);
            trig::hypot(row.deviation, scatter.max(KNOWN * KNOWN * most))
        };
        let deviations: Vec<f64> = rows.iter().zip(&shapes).map(sampled).collect();
        let (variance, _) = fitted(&deviations);
        let off = |((row, shape), deviation): ((&Row, &f64), &f64)| {
            let off = (row.excess - variance * shape) / deviation;
            off * off + 2.0 * trig::ln(*deviation)
        };
        let unlikely = rows.iter().zip(&shapes).zip(&deviations).map(off).sum::<f64>() / ALIKE
            + bands.iter().map(|own| own.off(variance, time)).sum::<f64>();
        // Moments that are near tell nearly the same.
        OfTime { time, variance, deviation: (ALIKE / square).sqrt(), unlikely }
    }
}

fn long(grid: &Grid, difference: &[f32]) -> bool {
    difference.iter().filter(|x| x.is_finite()).count() as f64 > LEAST_S * grid.rate
}

/// What the variance of means over a time scatters by, N², where white noise alone makes it: of n means, by √(2/n) of
/// itself.
fn chance(grid: &Grid, differences: &[Vec<f32>], over: f64) -> f64 {
    let white = mean(differences.iter().map(|d| white(d.iter().map(|x| f64::from(*x)))));
    let samples: usize = differences.iter().map(|d| d.iter().filter(|x| x.is_finite()).count()).sum();
    let long = (over * grid.rate).max(1.0);
    white / long * (2.0 * long / samples.max(1) as f64).sqrt()
}

/// Variances of means of half a difference without a trend, less what white noise makes of them, N².
fn variances(grid: &Grid, difference: &[f32], over: &[f64; OVER.len()]) -> [f64; OVER.len()] {
    let all = without_trend(difference);
    let white = white(all.iter().copied());
    over.map(|over| {
        let long = ((over * grid.rate).round() as usize).max(1);
        let means = all.windows(long).step_by(long.div_ceil(CELLS));
        let means = means.map(|part| part.iter().sum::<f64>() / long as f64).filter(|x| x.is_finite());
        mean(means.map(|x| 0.5 * x * x)) - white / long as f64
    })
}

/// Variance of the white noise of half a difference, by its steps from sample to sample, N².
fn white(difference: impl Iterator<Item = f64> + Clone) -> f64 {
    let steps = difference.clone().zip(difference.skip(1)).map(|(a, b)| b - a).filter(|x| x.is_finite());
    mean(steps.map(|x| 0.25 * x * x))
}

/// NaN of nothing.
fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (count, sum) = values.fold((0.0, 0.0), |(n, sum), x| (n + 1.0, sum + x));
    sum / count
}

/// Two passes' difference; NaN where one is missing.
fn less(a: &[f32], b: &[f32]) -> Vec<f32> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

/// A difference where another is known.
fn only(difference: &[f32], known: &[f32]) -> Vec<f32> {
    difference.iter().zip(known).map(|(x, known)| if known.is_finite() { *x } else { f32::NAN }).collect()
}

/// Less the straight line that lies nearest, so that a drift is none of it.
fn without_trend(values: &[f32]) -> Vec<f64> {
    let known = || values.iter().enumerate().filter(|(_, x)| x.is_finite()).map(|(k, x)| (k as f64, f64::from(*x)));
    let count = known().count().max(1) as f64;
    let (t, x) = known().fold((0.0, 0.0), |sum, (t, x)| (sum.0 + t, sum.1 + x));
    let (t, x) = (t / count, x / count);
    let (square, along) =
        known().fold((0.0, 0.0), |sum, (a, b)| (sum.0 + (a - t) * (a - t), sum.1 + (a - t) * (b - x)));
    let slope = if square > 0.0 { along / square } else { 0.0 };
    values.iter().enumerate().map(|(k, value)| f64::from(*value) - x - slope * (k as f64 - t)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::normal;

    /// A pass at 2 m/s over 80 m with what repeats, chaos of each pass, and noise.
    fn pass(noise: &Noise, seed: u64) -> (Vec<f32>, Vec<f32>) {
        let mut state = seed;
        let station: Vec<f32> = (0..20_000_u16).map(|k| 0.004 * f32::from(k)).collect();
        let chaos: Vec<f32> = station.iter().map(|_| 0.8 * normal(&mut state) as f32).collect();
        let force: Vec<f32> = station
            .iter()
            .zip(chaos.windows(2).chain([[0.0, 0.0].as_slice()]))
            .map(|(s, two)| 200.0 + 30.0 * (s * 0.7).sin() + 0.5 * (two[0] + two[1]))
            .collect();
        // Not by the table that simulated sensors draw from.
        let memory = trig::exp(-1.0 / (500.0 * noise.time().max(1e-9)));
        let correlated = noise.correlated_variance().sqrt();
        let mut own = normal(&mut state);
        let noisy = force.iter().map(|x| {
            own = memory * own + (1.0 - memory * memory).sqrt() * normal(&mut state);
            x + (correlated * own + noise.white * normal(&mut state)) as f32
        });
        (station, noisy.collect())
    }

    fn ensemble() -> Vec<CartRecord> {
        let none = Noise::default();
        let cart = |k: u64| {
            let (station, force) = pass(&none, 1000 + k);
            let mut forces: [Vec<f32>; FORCES] = Default::default();
            forces[2] = force;
            CartRecord { station, speed: Vec::new(), forces }
        };
        (0..16).map(cart).collect()
    }

    fn found(noise: &Noise, share: f64) -> Noise {
        let ((mut station, mut force), (again, more)) = (pass(noise, 1), pass(noise, 2));
        let extra = (share * again.len() as f64) as usize;
        station.extend(again[..extra].iter().map(|s| s + 80.0));
        force.extend(&more[..extra]);
        let mut forces: [&[f32]; FORCES] = [&[]; FORCES];
        forces[2] = &force;
        let excess = Excess::new(
            (&station, forces),
            Default::default(),
            0.0,
            Lap { length: 80.0, speed: 2.0, carts: 64 },
            (500.0, &ensemble()),
        );
        assert_eq!(excess.length() > 0.0, share > 0.0);
        Excess::noise(&[excess])[0][2]
    }

    #[test]
    fn correlated_noise_is_found_where_places_are_passed_again() {
        let noise = Noise { white: 0.5, ..Process { variance: 0.36, time: 0.3 }.into() };
        let found_noise = found(&noise, 0.9);
        assert!((found_noise.correlated_variance().sqrt() / 0.6 - 1.0).abs() < 0.3, "{found_noise:?}");
        assert!((0.15..0.6).contains(&found_noise.time()), "{found_noise:?}");
    }

    /// Means of noise without a straight line scatter as is said, from far more correlation times than one to a few.
    #[test]
    fn a_straight_line_takes_its_part_of_noise() {
        for (length, time) in [(10.0, 0.3), (10.0, 2.0), (10.0, 30.0), (4.0, 0.6)] {
            let (rate, overs) = (100.0, [0.5, 1.0, 2.0]);
            let noise: Noise = Process { variance: 1.0, time }.into();
            let mut sums = [0.0; 3];
            let draws = 4000;
            let long = (length * rate) as usize;
            let all = noise.draw(rate, 3);
            for begin in (0..draws).map(|k| (k * 7919 * long) % (all.len() - long)) {
                let piece = without_trend(&all[begin..begin + long]);
                for (sum, over) in sums.iter_mut().zip(overs) {
                    let window = (over * rate) as usize;
                    let step = window.div_ceil(CELLS);
                    let means = piece.windows(window).step_by(step).map(|part| part.iter().sum::<f64>());
                    let count = ((long - window) / step + 1) as f64;
                    *sum += means.map(|x| x * x).sum::<f64>() / (window * window) as f64 / count / draws as f64;
                }
            }
            for (found, over) in sums.into_iter().zip(overs) {
                let said = Row { over, length, excess: 0.0, deviation: 0.0 }.of(time);
                assert!((found / said - 1.0).abs() < 0.12, "{length} {time} {over}: {found} {said}");
            }
        }
    }

    /// A band that holds little forbids short times, which means over longer ones hardly tell from others.
    #[test]
    fn noise_has_no_more_in_a_band_than_was_measured() {
        let row = |over: f64| {
            let row = Row { over, length: 10.0, excess: 0.0, deviation: 0.01 };
            Row { excess: 0.36 * row.of(0.3), ..row }
        };
        let rows = [0.6, 1.2, 2.4].map(row);
        let scattered = [1.2, 1.0, 0.7].into_iter().zip(rows).map(|(by, row)| Row { excess: by * row.excess, ..row });
        let scattered: Vec<Row> = scattered.collect();
        let of =
            |bands: Vec<BandPower>| exponential(&[&OfForce { rows: scattered.clone(), bands, most: None }]).unwrap();
        let free = of(Vec::new());
        let band = (10.0, 40.0);
        let turn = |hz: f64| trig::atan(trig::TAU * hz * 0.3);
        let measured = 0.36 * 2.0 / trig::PI * (turn(band.1) - turn(band.0));
        let Process { variance, time } = of(vec![BandPower { measured, beyond: None, band }]);
        assert!(
            (0.15..0.8).contains(&time) && time > free.time && (0.25..0.6).contains(&variance),
            "{variance} {time}"
        );
        assert!(variance <= BandPower { measured, beyond: None, band }.all_of(time));
        let whole = BandPower { measured: 1.0, beyond: None, band: (0.0, 1e9) };
        assert!((whole.all_of(0.3) - 1.0).abs() < 1e-6);
    }

    /// Means over carts' passing hardly tell a short time from a long one; bands do, also where one of them holds something else.
    #[test]
    fn bands_tell_the_time_of_noise() {
        let truth = Process { variance: 0.16, time: 0.15 };
        let row = |over: f64| {
            let row = Row { over, length: 32.0, excess: 0.0, deviation: 0.0 };
            let excess = truth.variance * row.of(truth.time);
            Row { excess, deviation: 0.3 * excess, ..row }
        };
        // A chance under which long times look as likely.
        let rows = [0.6, 1.2, 2.4].map(row).into_iter().zip([0.8, 1.1, 1.4]);
        let rows: Vec<Row> = rows.map(|(row, by)| Row { excess: by * row.excess, ..row }).collect();
        let edges = [0.5, 1.0, 2.0, 2.6, 3.5, 6.0];
        let band = |two: &[f64], more: f64| {
            let band = (two[0], two[1]);
            let own = BandPower { measured: 1.0, beyond: None, band };
            let power = truth.variance * own.share(truth.time);
            BandPower { measured: 1.5 * (power + more), beyond: Some((power + more, 0.2 * (power + more))), band }
        };
        let of = |bands: Vec<BandPower>| exponential(&[&OfForce { rows: rows.clone(), bands, most: None }]).unwrap();
        let alone = of(Vec::new());
        let with = of(edges.windows(2).map(|two| band(two, 0.0)).collect());
        let beside = of(edges.windows(2).map(|two| band(two, if two[0] == 2.0 { 0.5 } else { 0.0 })).collect());
        assert!(alone.time > 0.3, "{alone:?}");
        assert!((0.1..0.22).contains(&with.time) && (0.1..0.25).contains(&with.variance), "{with:?}");
        assert!((0.1..0.22).contains(&beside.time) && (0.1..0.25).contains(&beside.variance), "{beside:?}");
    }

    #[test]
    fn white_noise_is_no_correlated_noise_and_a_single_lap_tells_none() {
        let white = Noise { white: 2.0, ..Noise::default() };
        assert_eq!(found(&white, 0.9), Noise::default());
        assert_eq!(found(&Noise { white: 2.0, ..Process { variance: 25.0, time: 0.3 }.into() }, 0.0), Noise::default());
    }
}
