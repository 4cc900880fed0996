//! The noise of a run's sensors, found from the run itself: white noise above the low-pass, where nothing is simulated,
//! and noise with a correlation time where the run passes places again.
//!
//! Two passes of one place by one cart differ by the chain's chaos and by noise alone: whatever the model misses, they
//! share. So the variance of means of their differences, less that of simulated passes, is the noise's own. It is taken
//! for white noise and a process of first order (Uhlenbeck and Ornstein 1930), of covariance σ² exp(−t/τ): its mean over
//! a time T has the variance 2 σ² (T/τ − 1 + exp(−T/τ)) (τ/T)².

use crate::base::number::{significant, tidy};
use crate::base::random::{add_correlated, noisy};
use crate::base::trig;
use crate::dynamics::CartRecord;
use crate::signal::{Channel, FORCES};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Samples of noise that are drawn: a thousand correlation times of half a second, and of noise that drifts more.
const DRAWN: usize = 1 << 18;
const DRAWN_OF_DRIFT: usize = 1 << 20;

/// Processes of first order that correlated noise is a sum of, at most.
pub const PROCESSES: usize = 3;

/// Noise that lasts as long as this drifts, s.
pub const DRIFTS: f64 = 10.0;

/// A process of first order, of covariance σ² exp(−t/τ).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Process {
    /// σ², N²; 0 for none.
    pub variance: f64,
    /// τ, s
    pub time: f64,
}

/// A sensor's noise.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Noise {
    /// Deviation of the white noise, N.
    pub white: f64,
    /// What its correlated noise is a sum of.
    pub processes: [Process; PROCESSES],
}

impl From<Process> for Noise {
    fn from(own: Process) -> Noise {
        let none = Process::default();
        Noise { white: 0.0, processes: [own, none, none] }
    }
}

impl Noise {
    /// N²
    pub fn variance(&self) -> f64 {
        self.white * self.white + self.correlated_variance()
    }

    /// The processes that it has.
    pub fn correlated(&self) -> impl Iterator<Item = &Process> {
        self.processes.iter().filter(|own| own.variance > 0.0)
    }

    fn correlated_variance(&self) -> f64 {
        self.correlated().map(|own| own.variance).sum()
    }

    /// Of the correlated noise, the integral of its covariance over its variance, s; 0 where there is none.
    fn time(&self) -> f64 {
        let all: f64 = self.correlated().map(|own| own.variance * own.time).sum();
        if all > 0.0 { all / self.correlated_variance() } else { 0.0 }
    }

    /// Samples of it at a rate, Hz, long enough that simulated sensors can take theirs anywhere; none of no noise.
    pub fn draw(&self, rate: f64, seed: u64) -> Vec<f32> {
        if self.variance() == 0.0 {
            return Vec::new();
        }
        let drifts = self.correlated().any(|own| own.time >= DRIFTS);
        let samples = if drifts { DRAWN_OF_DRIFT } else { DRAWN };
        let mut drawn = noisy(&vec![0.0; samples], self.white as f32, seed);
        for (k, own) in self.correlated().enumerate() {
            let memory = trig::exp(-1.0 / (rate * own.time));
            add_correlated(&mut drawn, own.variance.sqrt(), memory, !seed.wrapping_add(7919 * k as u64));
        }
        drawn
    }
}

/// A sensor's noise in a report.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ChannelNoise {
    /// Deviation of the white noise, N.
    pub white_n: f64,
    /// Beside it; null where none stands out.
    pub correlated: Option<CorrelatedNoise>,
}

/// Noise whose covariance falls exponentially.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CorrelatedNoise {
    /// N
    pub deviation_n: f64,
    /// Time in which the covariance falls to 1/e, s.
    pub time_s: f64,
}

/// The noise of the channels that were measured, by name.
pub fn channel_noise(noise: &[Noise; FORCES], measured: impl Fn(usize) -> bool) -> BTreeMap<String, ChannelNoise> {
    let all = Channel::FORCES.iter().zip(noise).enumerate().filter(|(k, _)| measured(*k));
    let report = |noise: &Noise| ChannelNoise {
        white_n: tidy(noise.white),
        correlated: noise.correlated().next().map(|_| CorrelatedNoise {
            deviation_n: tidy(noise.correlated_variance().sqrt()),
            time_s: tidy(noise.time()),
        }),
    };
    all.map(|(_, (channel, noise))| (channel.name().to_owned(), report(noise))).collect()
}

impl ChannelNoise {
    /// In words: `0.5 N white, 0.6 N with 0.3 s`.
    pub fn words(&self) -> String {
        let n = |x: f64| significant(x, 2);
        match self.correlated {
            Some(own) => format!("{} N white, {} N with {} s", n(self.white_n), n(own.deviation_n), n(own.time_s)),
            None => format!("{} N white", n(self.white_n)),
        }
    }
}

/// Over how many carts' passing means are taken: what repeats with each cart is none of them.
const OVER: [f64; 3] = [1.0, 2.0, 4.0];

/// Correlation times that are thought of, s: the first, their ratio, and how many.
const TIMES: (f64, f64, usize) = (0.08, 1.2, 22);

/// Pairs of simulated carts that are held beside each other at most.
const PAIRS: usize = 24;

/// A variance is known no better than to this share of the largest, and of what chaos makes.
const KNOWN: f64 = 0.1;

/// A variance is believed from so many of its deviations on.
const SURE: f64 = 2.0;

/// As many variances of means over different times tell as much as one would.
const ALIKE: f64 = OVER.len() as f64;

/// Passes are told apart where they have at least so much of a time in common, s.
const LEAST_S: f64 = 1.5;

/// What a run's passes of the same places differ by beyond simulated ones, of each force. Empty where no place was passed
/// twice.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Excess([Vec<Row>; FORCES]);

/// A variance beyond that of simulated passes: of means of half the difference.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Row {
    /// Time over which means are taken, s.
    over: f64,
    /// N²
    excess: f64,
    deviation: f64,
}

impl Row {
    /// The variance of means of noise of unit variance with a correlation time, s.
    fn of(&self, time: f64) -> f64 {
        mean_variance(self.over, time)
    }
}

/// The variance of means over a time, s, of a process of first order of unit variance with a correlation time, s.
pub fn mean_variance(over: f64, time: f64) -> f64 {
    let share = over / time;
    // Near 0 by its series, as 1 is subtracted from nearly 1.
    if share < 1e-3 {
        return 1.0 - share / 3.0;
    }
    2.0 * (share - 1.0 + trig::exp(-share)) / (share * share)
}

/// What of a lap is compared.
#[derive(Clone, Copy, Debug)]
pub struct Lap {
    /// m
    pub length: f64,
    /// m/s
    pub speed: f64,
    pub carts: usize,
}

impl Excess {
    /// Of forces measured at stations, m, as their trigger is at a place, m, beside records of carts each of which goes
    /// around once.
    pub fn new(
        (station, forces): (&[f32], [&[f32]; FORCES]),
        trigger: f64,
        lap: Lap,
        (rate, records): (f64, &[CartRecord]),
    ) -> Excess {
        let grid = Grid::new(lap, rate);
        let of = |force: usize| -> Vec<Row> {
            let passes = grid.passes(station, forces[force], trigger);
            let differences: Vec<Vec<f32>> = passes.windows(2).map(|two| less(&two[1], &two[0])).collect();
            let differences: Vec<Vec<f32>> = differences.into_iter().filter(|d| grid.long(d)).collect();
            if differences.is_empty() {
                return Vec::new();
            }
            let carts = records.len();
            let once = |cart: &CartRecord| grid.once(&cart.station, &cart.forces[force]);
            let pairs = (carts / 2).min(PAIRS);
            let simulated: Vec<Vec<f32>> =
                (0..pairs).map(|k| less(&once(&records[k]), &once(&records[k + carts / 2]))).collect();
            let found: Vec<[f64; OVER.len()]> = differences.iter().map(|d| grid.variances(d)).collect();
            // Of the same places.
            let alike: Vec<[f64; OVER.len()]> = simulated
                .iter()
                .flat_map(|d| differences.iter().map(|places| grid.variances(&only(d, places))))
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
                let deviation = trig::hypot(deviation, grid.chance(&differences, *over));
                Row { over: *over, excess: mean(&found) - usual, deviation }
            };
            grid.over
                .iter()
                .enumerate()
                .map(row)
                .filter(|row| row.excess.is_finite() && row.deviation.is_finite())
                .collect()
        };
        Excess(std::array::from_fn(of))
    }

    /// Whether any force passed a place twice.
    pub fn is_known(&self) -> bool {
        self.0.iter().any(|rows| !rows.is_empty())
    }

    /// The correlated noise of each force that runs with the same sensors have.
    pub fn noise(runs: &[Excess]) -> [Noise; FORCES] {
        std::array::from_fn(|force| {
            let rows: Vec<Row> = runs.iter().flat_map(|run| &run.0[force]).copied().collect();
            let Some((variance, time)) = exponential(&rows) else { return Noise::default() };
            Process { variance, time }.into()
        })
    }
}

/// The variance and the time of σ² exp(−t/τ) that lie nearest, if there is one beyond doubt.
fn exponential(rows: &[Row]) -> Option<(f64, f64)> {
    // No moment is known much better than the others, as no noise is quite of this kind.
    let clear = rows.iter().filter(|row| row.excess > SURE * row.deviation);
    let most = clear.map(|row| row.excess).fold(0.0, f64::max);
    if most <= 0.0 {
        return None;
    }
    let (first, ratio, count) = TIMES;
    let mut best: Option<(f64, f64, f64, f64)> = None;
    let mut time = first;
    for _ in 0..count {
        let (mut square, mut along, mut whole) = (0.0, 0.0, 0.0);
        for row in rows {
            let deviation = trig::hypot(row.deviation, KNOWN * most);
            let shape = row.of(time) / deviation;
            let excess = row.excess / deviation;
            square += shape * shape;
            along += shape * excess;
            whole += excess * excess;
        }
        let variance = along / square;
        let left = whole - along * variance;
        // Moments that are near tell nearly the same.
        let deviation = (ALIKE / square).sqrt();
        if best.is_none_or(|(least, ..)| left < least) {
            best = Some((left, variance, time, deviation));
        }
        time *= ratio;
    }
    best.filter(|(_, variance, _, deviation)| *variance > SURE * deviation)
        .map(|(_, variance, time, _)| (variance, time))
}

/// Equal places of a lap, about as many as it has samples.
pub struct Grid {
    /// m
    pub lap: f64,
    pub places: usize,
    /// Hz
    pub rate: f64,
    /// Times over which means are taken, s.
    over: [f64; OVER.len()],
}

impl Grid {
    /// Of a lap that is measured at a rate, Hz.
    pub fn new(lap: Lap, rate: f64) -> Grid {
        let places = (lap.length / lap.speed * rate).round().max(16.0) as usize;
        let passing = lap.length / lap.carts as f64 / lap.speed;
        Grid { lap: lap.length, places, rate, over: OVER.map(|carts| carts * passing) }
    }

    /// What was measured at each place in each pass; NaN where nothing was.
    fn passes(&self, station: &[f32], values: &[f32], trigger: f64) -> Vec<Vec<f32>> {
        let mut passes = vec![vec![f32::NAN; self.places]];
        let mut before: Option<usize> = None;
        for (s, x) in station.iter().zip(values) {
            let share = (f64::from(*s) + trigger) / self.lap;
            let place = (((share - share.floor()) * self.places as f64) as usize).min(self.places - 1);
            // Where the lap begins anew; a place or two back are the trigger's jitter.
            if before.is_some_and(|before| place + self.places / 2 < before) {
                passes.push(vec![f32::NAN; self.places]);
            }
            before = Some(place);
            if let Some(pass) = passes.last_mut() {
                pass[place] = *x;
            }
        }
        self.bridged(passes)
    }

    /// The same of a cart that goes around once, wherever it begins.
    pub fn once(&self, station: &[f32], values: &[f32]) -> Vec<f32> {
        let mut once = vec![f32::NAN; self.places];
        for pass in self.passes(station, values, 0.0) {
            once.iter_mut().zip(pass).filter(|(_, x)| x.is_finite()).for_each(|(to, x)| *to = x);
        }
        once
    }

    /// Places between two samples take the one before.
    fn bridged(&self, mut passes: Vec<Vec<f32>>) -> Vec<Vec<f32>> {
        for pass in &mut passes {
            for k in 1..pass.len() {
                let next = pass.get(k + 1).copied().unwrap_or(f32::NAN);
                if pass[k].is_nan() && !pass[k - 1].is_nan() && !next.is_nan() {
                    pass[k] = pass[k - 1];
                }
            }
        }
        passes
    }

    fn long(&self, difference: &[f32]) -> bool {
        difference.iter().filter(|x| x.is_finite()).count() as f64 > LEAST_S * self.rate
    }

    /// What the variance of means over a time scatters by, N², where white noise alone makes it: of n means, by √(2/n) of
    /// itself.
    fn chance(&self, differences: &[Vec<f32>], over: f64) -> f64 {
        let white = mean(differences.iter().map(|d| white(d.iter().map(|x| f64::from(*x)))));
        let samples: usize = differences.iter().map(|d| d.iter().filter(|x| x.is_finite()).count()).sum();
        let long = (over * self.rate).max(1.0);
        white / long * (2.0 * long / samples.max(1) as f64).sqrt()
    }

    /// Variances of means of half a difference without a trend, less what white noise makes of them, N².
    fn variances(&self, difference: &[f32]) -> [f64; OVER.len()] {
        let all = without_trend(difference);
        let white = white(all.iter().copied());
        self.over.map(|over| {
            let long = ((over * self.rate).round() as usize).max(1);
            let means = all.windows(long).step_by(long.div_ceil(4));
            let means = means.map(|part| part.iter().sum::<f64>() / long as f64).filter(|x| x.is_finite());
            mean(means.map(|x| 0.5 * x * x)) - white / long as f64
        })
    }
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
    use crate::dynamics::CartRecord;

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
        let excess =
            Excess::new((&station, forces), 0.0, Lap { length: 80.0, speed: 2.0, carts: 64 }, (500.0, &ensemble()));
        assert_eq!(excess.is_known(), share > 0.0);
        Excess::noise(&[excess])[2]
    }

    #[test]
    fn correlated_noise_is_found_where_places_are_passed_again() {
        let noise = Noise { white: 0.5, ..Process { variance: 0.36, time: 0.3 }.into() };
        let found_noise = found(&noise, 0.9);
        assert!((found_noise.correlated_variance().sqrt() / 0.6 - 1.0).abs() < 0.3, "{found_noise:?}");
        assert!((0.15..0.6).contains(&found_noise.time()), "{found_noise:?}");
    }

    #[test]
    fn white_noise_is_no_correlated_noise_and_a_single_lap_tells_none() {
        let white = Noise { white: 2.0, ..Noise::default() };
        assert_eq!(found(&white, 0.9), Noise::default());
        assert_eq!(found(&Noise { white: 2.0, ..Process { variance: 25.0, time: 0.3 }.into() }, 0.0), Noise::default());
    }

    #[test]
    fn a_draw_has_its_deviation_and_its_correlation_time() {
        let noise: Noise = Process { variance: 4.0, time: 0.4 }.into();
        let x = noise.draw(100.0, 5);
        let covariance = |apart: usize| {
            x.iter().zip(&x[apart..]).map(|(a, b)| f64::from(a * b)).sum::<f64>() / (x.len() - apart) as f64
        };
        assert!((covariance(0) / 4.0 - 1.0).abs() < 0.1, "{}", covariance(0));
        assert!((covariance(40) / covariance(0) - trig::exp(-1.0)).abs() < 0.06);
    }
}
