//! The noise of a sensor by how means over neighbouring times differ, for times from hundredths of a second to
//! half of what is compared (Allan 1966): noise of any correlation time shows in the times that it lasts.
//!
//! What is looked at is the difference of two passes of a place, which the chain's chaos and noise alone make. A record
//! that passes little of the lap twice is held against the simulated mean of all carts, too; then what the model misses
//! everywhere alike counts as noise, and no more than [`MOST_OF_ONE_PASS`] of it is believed. The chaos is known from
//! simulated carts. The rest is taken for a sum of processes of first order, one after the other, whose variances
//! maximise the likelihood of mean squares with so many degrees of freedom (Whittle 1953), found by multiplicative
//! steps that keep them positive (Févotte, Bertin and Durrieu 2009).

use super::grid::Grid;
use super::noise::{DRIFTS, Noise, PROCESSES, Process, mean_variance};
use super::sums::Sums;
use crate::base::trig;

/// Shortest time over which means are taken, samples.
const SHORTEST: usize = 32;

/// The chain's own mean squares are known to this share, as they are simulated with parameters that are not quite its.
const UNSURE: f64 = 0.3;

/// Degrees of freedom of the power above the low-pass: white noise is what it shows, whatever the short times do.
const SURE_OF_WHITE: f64 = 1e6;

/// The same of the power in bands, which is known to about 10 %.
const SURE_OF_BANDS: f64 = 200.0;

/// Correlation times that are thought of, s: the first, their ratio, and how many.
const TIMES: (f64, f64, usize) = (0.05, 1.35, 24);

/// Steps towards the most likely variances.
const STEPS: usize = 80;

/// A process is believed where it makes what was measured more likely by this factor's logarithm: two degrees of χ² at
/// 99.5 %, and those that come to it at 95 %.
const SURE: f64 = 5.3;
const SURE_OF_MORE: f64 = 3.0;

/// Passes are compared with each other where they have so much of a lap in common.
const LEAST_TWICE: f64 = 0.12;

/// From so much of a lap on they tell all; with less the record is held against the simulated mean besides.
const ENOUGH_TWICE: f64 = 0.6;

/// Times whose logarithms of the likelihood differ by less are alike: one degree of χ² at 90 %.
const ALIKE: f64 = 1.35;

/// Of the largest force: deviation of the noise that drifts. More is a fault of the sensor.
const MOST_DRIFT: f64 = 5e-3;

/// Of the largest force: deviation of all correlated noise of a record that passes no place twice.
const MOST_OF_ONE_PASS: f64 = 1e-2;

/// Fewer places than this are all looked at; from this many on, the quietest quarter.
const FEW: usize = 16;

/// Pairs of carts that are compared at most.
const PAIRS: usize = 24;

/// A sensor's samples in a record.
pub struct Record<'a> {
    /// m
    pub station: &'a [f32],
    pub values: &'a [f32],
    /// m
    pub trigger: f64,
}

/// A mean square of differences of means, or the power of a band.
struct Moment {
    of: Of,
    measured: f64,
    chaos: f64,
    degrees: f64,
    /// Whether it says only that there is no more.
    at_most: bool,
}

/// What a moment is made of.
#[derive(Clone, Copy)]
enum Of {
    /// Differences of neighbouring means over so many samples, of so long a time, s.
    Differences(f64, f64),
    /// The mean over so many samples, of so long a time, of passes a lap's time apart, s.
    Level(f64, f64, f64),
    /// A band, in shares of the rate, Hz.
    Band((f64, f64), f64),
}

impl Of {
    /// What white noise of unit variance makes of it.
    fn white(self) -> f64 {
        match self {
            Of::Differences(samples, _) | Of::Level(samples, ..) => 1.0 / samples,
            Of::Band((from, to), _) => 2.0 * (to - from),
        }
    }

    /// What a process of unit variance makes of it.
    fn process(self, own: f64) -> f64 {
        match self {
            Of::Differences(_, time) => 2.0 * (mean_variance(time, own) - mean_variance(2.0 * time, own)),
            Of::Level(_, time, lap) => mean_variance(time, own) * (1.0 - trig::exp(-lap / own)),
            Of::Band(band, rate) => share_in(band, trig::exp(-1.0 / (rate * own))),
        }
    }
}

impl Moment {
    /// `samples` is how many independent squares it is a mean of.
    fn new(of: Of, (measured, chaos): (f64, f64), samples: f64) -> Moment {
        let unsure = UNSURE * chaos / measured.max(chaos).max(1e-300);
        let degrees = 2.0 / (2.0 / samples.max(1.0) + unsure * unsure);
        Moment { of, measured, chaos, degrees, at_most: false }
    }

    /// Whether it speaks against a prediction.
    fn counts(&self, predicted: f64) -> bool {
        !self.at_most || predicted > self.measured
    }
}

/// The power of a band.
pub struct Power {
    pub measured: f64,
    pub simulated: f64,
    /// Where it lies, as shares of the rate.
    pub band: (f64, f64),
}

/// What is known of a sensor before passes are compared.
pub struct Known {
    /// Deviation of its white noise, and the least that it has.
    pub white: f64,
    pub floor: f64,
    /// The largest value that it measured.
    pub largest: f64,
    /// What lies above the low-pass, which only white noise does.
    pub high: Option<Power>,
    /// Bands below: noise has no more than what was measured there.
    pub bands: Vec<Power>,
}

/// The noise of a sensor, from its record and from each simulated cart's samples at the grid's places. `once` says
/// whether a record that passes no place twice may be held against the simulated mean.
pub fn noise(grid: &Grid, record: &Record, carts: &[Vec<f32>], known: &Known, once: bool) -> Noise {
    let none = Noise { white: known.white, ..Noise::default() };
    let measured = unwrapped(grid, record);
    let places = grid.places;
    let twice: Vec<f32> = match measured.values.get(places..) {
        Some(later) => later.iter().zip(&measured.values).map(|(b, a)| (b - a) * HALF as f32).collect(),
        None => Vec::new(),
    };
    let common = twice.iter().filter(|x| x.is_finite()).count() as f64 / places as f64;
    let is_twice = common > LEAST_TWICE;
    let mut moments = Vec::new();
    if is_twice {
        let pairs = (carts.len() / 2).min(PAIRS);
        let pair = |k: usize| {
            let (a, b) = (&carts[k], &carts[k + carts.len() / 2]);
            a.iter().zip(b).map(|(a, b)| (b - a) * HALF as f32).collect()
        };
        let simulated: Vec<Vec<f32>> = (0..pairs).map(pair).collect();
        moments.extend(differences(grid, &twice, &simulated, measured.first));
        moments.extend(levels(grid, &twice, &simulated));
    }
    if once && common < ENOUGH_TWICE {
        let mean = mean_of(carts, places);
        let off = |cart: &Vec<f32>| cart.iter().zip(&mean).map(|(x, mean)| x - mean).collect();
        let at = |k: usize| mean[(measured.first + k as i64).rem_euclid(places as i64) as usize];
        let difference: Vec<f32> = measured.values.iter().enumerate().map(|(k, x)| x - at(k)).collect();
        let simulated: Vec<Vec<f32>> = carts.iter().step_by(carts.len().div_ceil(PAIRS).max(1)).map(off).collect();
        moments.extend(differences(grid, &difference, &simulated, measured.first));
    }
    if moments.is_empty() {
        return none;
    }
    if let Some(high) = &known.high {
        let of = Of::Band(high.band, grid.rate);
        let (measured, chaos) = (high.measured, high.simulated);
        moments.push(Moment { of, measured, chaos, degrees: SURE_OF_WHITE, at_most: false });
    }
    for power in &known.bands {
        let (of, measured, chaos) = (Of::Band(power.band, grid.rate), power.measured, power.simulated);
        moments.push(Moment { of, measured, chaos: chaos.min(measured), degrees: SURE_OF_BANDS, at_most: true });
    }
    let Some((white, mut processes)) = most_likely(&moments, known) else { return none };
    let bound = |most: f64, processes: &mut [Process; PROCESSES], which: &dyn Fn(f64) -> bool| {
        let counted = processes.iter_mut().filter(|own| which(own.time)).collect::<Vec<_>>();
        let total: f64 = counted.iter().map(|own| own.variance).sum();
        if total > most * most {
            counted.into_iter().for_each(|own| own.variance *= most * most / total);
        }
    };
    bound(MOST_DRIFT * known.largest, &mut processes, &|time| time >= DRIFTS);
    if !is_twice {
        bound(MOST_OF_ONE_PASS * known.largest, &mut processes, &|_| true);
    }
    Noise { white: white.sqrt(), processes }
}

/// The share of its variance that a sampled process of first order with a correlation from sample to sample has in a
/// band, which is given in shares of the rate.
fn share_in((from, to): (f64, f64), memory: f64) -> f64 {
    let points = 32;
    let density = |k: usize| {
        let at = trig::TAU * (from + (to - from) * (k as f64 + 0.5) / points as f64);
        2.0 * (1.0 - memory * memory) / (1.0 - 2.0 * memory * trig::cos(at) + memory * memory)
    };
    (to - from) * (0..points).map(density).sum::<f64>() / points as f64
}

/// 1/√2: two passes differ by the noise of both.
const HALF: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Samples by places of all laps, one after the other.
struct Unwrapped {
    first: i64,
    values: Vec<f32>,
}

fn unwrapped(grid: &Grid, record: &Record) -> Unwrapped {
    let place = |s: f32| ((f64::from(s) + record.trigger) / grid.lap * grid.places as f64).floor() as i64;
    let (first, last) =
        record.station.iter().fold((i64::MAX, i64::MIN), |(a, b), s| (a.min(place(*s)), b.max(place(*s))));
    let length = usize::try_from(last - first + 1).unwrap_or(0).min(record.station.len().saturating_mul(2));
    let mut values = vec![f32::NAN; length];
    for (s, x) in record.station.iter().zip(record.values) {
        if let Some(to) = values.get_mut((place(*s) - first) as usize) {
            *to = *x;
        }
    }
    // Places between two samples take the one before.
    for k in 1..values.len().saturating_sub(1) {
        if values[k].is_nan() && !values[k - 1].is_nan() && !values[k + 1].is_nan() {
            values[k] = values[k - 1];
        }
    }
    Unwrapped { first, values }
}

/// Of what each cart measured at each place.
fn mean_of(carts: &[Vec<f32>], places: usize) -> Vec<f32> {
    let mut sums = vec![(0.0_f64, 0.0_f64); places];
    for cart in carts {
        for (sum, x) in sums.iter_mut().zip(cart).filter(|(_, x)| x.is_finite()) {
            *sum = (sum.0 + f64::from(*x), sum.1 + 1.0);
        }
    }
    sums.iter().map(|(sum, n)| (sum / n) as f32).collect()
}

/// Of neighbouring means of a difference, which begins at a place, beside simulated ones.
fn differences(grid: &Grid, difference: &[f32], simulated: &[Vec<f32>], first: i64) -> Vec<Moment> {
    let places = grid.places;
    let known: Vec<bool> = difference.iter().take(places).map(|x| x.is_finite()).collect();
    let alike = |one: &Vec<f32>| -> Vec<f32> {
        let at = |k: usize| one[(first + k as i64).rem_euclid(places as i64) as usize];
        (0..known.len()).map(|k| if known[k] { at(k) } else { f32::NAN }).collect()
    };
    let simulated: Vec<Sums> = simulated.iter().map(|one| Sums::new(alike(one).into_iter().map(f64::from))).collect();
    let measured = Sums::new(difference.iter().copied().map(f64::from));
    let length = difference.iter().filter(|x| x.is_finite()).count() as f64;
    let mut out = Vec::new();
    let mut over = SHORTEST;
    while 2 * over <= difference.len() {
        let (found, chaos) = quiet(&measured, &simulated, over, known.len());
        if let (Some(found), true) = (found, chaos.is_finite()) {
            let of = Of::Differences(over as f64, over as f64 / grid.rate);
            out.push(Moment::new(of, (found, chaos), 0.25 * length / over as f64));
        }
        over *= 2;
    }
    out
}

/// How far passes a lap apart differ in the mean.
fn levels(grid: &Grid, difference: &[f32], simulated: &[Vec<f32>]) -> Vec<Moment> {
    let places = grid.places;
    let mut out = Vec::new();
    for piece in difference.chunks(places) {
        let known = piece.iter().filter(|x| x.is_finite()).count() as f64;
        let mean_of = |values: &[f32]| mean(values.iter().filter(|x| x.is_finite()).map(|x| f64::from(*x)));
        // The chaos of whole laps is less than that of a part, which hardly counts beside what drifts.
        let chaos = mean(simulated.iter().map(|one| mean_of(one)).map(|x| x * x).filter(|x| x.is_finite()));
        let chaos = chaos * places as f64 / known.max(1.0);
        if known > LEAST_TWICE * places as f64 && chaos.is_finite() {
            let of = Of::Level(known, known / grid.rate, places as f64 / grid.rate);
            let level = mean_of(piece);
            out.push(Moment::new(of, (level * level, chaos), 1.0));
        }
    }
    out
}

/// Half the mean square of differences of neighbouring means, measured and simulated, in the quarter of the places
/// where the chain is quietest: noise is the same everywhere, and shows best there.
fn quiet(measured: &Sums, simulated: &[Sums], over: usize, places: usize) -> (Option<f64>, f64) {
    let step = (over / 4).max(1);
    let chaos: Vec<f64> =
        (0..places).step_by(step).map(|from| mean(simulated.iter().filter_map(|one| one.allan(from, over)))).collect();
    let mut sorted: Vec<f64> = chaos.iter().copied().filter(|x| x.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let most = if sorted.len() < FEW { f64::INFINITY } else { sorted[sorted.len() / 4] };
    let kept = |k: usize| chaos[k] <= most;
    let usual = mean((0..chaos.len()).filter(|k| kept(*k)).map(|k| chaos[k]));
    let (mut sum, mut count) = (0.0, 0.0);
    for lap in (0..measured.samples()).step_by(places.max(1)) {
        for k in (0..chaos.len()).filter(|k| kept(*k)) {
            if let Some(square) = measured.allan(lap + k * step, over) {
                (sum, count) = (sum + square, count + 1.0);
            }
        }
    }
    ((count > 0.0).then(|| sum / count), usual)
}

/// The white noise's variance and the processes that make the moments most likely, one process after the other; none
/// where they make them hardly more so than white noise alone.
fn most_likely(moments: &[Moment], known: &Known) -> Option<(f64, [Process; PROCESSES])> {
    let floor = known.white.max(known.floor);
    let mut best = Sum { variances: vec![floor * floor], times: Vec::new() }.fitted(moments);
    let mut unlikely = best.unlikely(moments);
    for sure in [SURE, SURE_OF_MORE, SURE_OF_MORE] {
        let (first, ratio, count) = TIMES;
        let times = std::iter::successors(Some(first), |time| Some(time * ratio)).take(count);
        let candidates: Vec<(f64, Sum)> = times
            .map(|time| {
                let with = best.with(time, moments).fitted(moments);
                (with.unlikely(moments), with)
            })
            .collect();
        let least = candidates.iter().map(|(own, _)| *own).fold(f64::INFINITY, f64::min);
        // Of times that are nearly as likely the longest, as a short record bounds no noise that lasts longer.
        let more = candidates.into_iter().rev().find(|(own, _)| *own < least + ALIKE);
        match more {
            Some((own, with)) if unlikely - own > sure => (unlikely, best) = (own, with),
            _ => break,
        }
    }
    if best.times.is_empty() {
        return None;
    }
    let process = |k: usize| match (best.times.get(k), best.variances.get(k + 1)) {
        (Some(time), Some(variance)) => Process { variance: *variance, time: *time },
        _ => Process::default(),
    };
    Some((best.variances[0], std::array::from_fn(process)))
}

/// White noise and processes.
struct Sum {
    /// Of the white noise, and of each process.
    variances: Vec<f64>,
    times: Vec<f64>,
}

impl Sum {
    /// What each kind of unit variance makes of a moment.
    fn row(&self, moment: &Moment) -> Vec<f64> {
        let processes = self.times.iter().map(|time| moment.of.process(*time));
        std::iter::once(moment.of.white()).chain(processes).collect()
    }

    fn predicted(&self, row: &[f64], moment: &Moment) -> f64 {
        (moment.chaos + row.iter().zip(&self.variances).map(|(of, own)| of * own).sum::<f64>()).max(1e-15)
    }

    /// With another process, large enough to explain what most lacks.
    fn with(&self, time: f64, moments: &[Moment]) -> Sum {
        let lacking = |moment: &Moment| {
            let most = (moment.measured - self.predicted(&self.row(moment), moment)) / moment.of.process(time);
            if most.is_finite() { most } else { 0.0 }
        };
        let largest = moments.iter().map(lacking).fold(1e-9, f64::max);
        let variances = self.variances.iter().copied().chain([0.1 * largest]).collect();
        Sum { variances, times: self.times.iter().copied().chain([time]).collect() }
    }

    /// With the variances that make moments most likely.
    fn fitted(mut self, moments: &[Moment]) -> Sum {
        let rows: Vec<Vec<f64>> = moments.iter().map(|moment| self.row(moment)).collect();
        for _ in 0..STEPS {
            let mut sums = vec![(0.0, 0.0); self.variances.len()];
            for (moment, row) in moments.iter().zip(&rows) {
                let predicted = self.predicted(row, moment);
                if !moment.counts(predicted) {
                    continue;
                }
                for ((up, down), of) in sums.iter_mut().zip(row) {
                    *up += moment.degrees * of * moment.measured / (predicted * predicted);
                    *down += moment.degrees * of / predicted;
                }
            }
            for (variance, (up, down)) in self.variances.iter_mut().zip(sums) {
                *variance *= (up / f64::max(down, 1e-300)).sqrt();
            }
        }
        self
    }

    /// Less the logarithm of the likelihood.
    fn unlikely(&self, moments: &[Moment]) -> f64 {
        let one = |moment: &Moment| {
            let predicted = self.predicted(&self.row(moment), moment);
            let predicted = if moment.counts(predicted) { predicted } else { moment.measured };
            0.5 * moment.degrees * (trig::ln(predicted) + moment.measured / predicted)
        };
        moments.iter().map(one).sum()
    }
}

/// NaN of nothing.
fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (count, sum) = values.fold((0.0, 0.0), |(n, sum), x| (n + 1.0, sum + x));
    sum / count
}
