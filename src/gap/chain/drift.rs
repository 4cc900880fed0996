//! How fast a sensor's offset drifts in each run, by the passes of one place. A sensor drifts while it warms up and
//! settles: runs that were recorded at other times of a day may have rates of their own.

use super::pass_times::place_of;
use crate::gap::ids::PerRun;
use crate::identify::Measured;
use crate::identify::feature_spec::Samples;
use crate::signal::FORCES;
use std::collections::BTreeMap;

/// Places whose rates count as one: longer than a sensor's noise lasts and the chain swings.
const TOGETHER: usize = 4;
/// So many of them a deviation is known by, at least.
const LEAST: usize = 6;
/// A pass counts with this share of the samples that a place has, as its mean is another where some are missing.
const WHOLE: f64 = 0.9;
/// So many deviations, and such a share of the largest, a rate differs by from the mean of all runs where runs have rates
/// of their own.
const APART: f64 = 5.0;
const SHARE: f64 = 0.05;
/// A sensor's drift that grows to such a share of what the sensor measures bends the parameters of a fit; where the chain's
/// tension drifts instead, others have more than that share of it.
const BENDS: f64 = 0.02;

/// How fast an offset grows, N/s, and its deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rate {
    rate: f64,
    deviation: f64,
}

/// Of each force of a run at so many samples a second, on a lap of so many metres; `None` where too few places are passed
/// again.
pub fn rates(samples: &Samples, lap: f64, rate: f64) -> [Option<Rate>; FORCES] {
    std::array::from_fn(|k| of_force(samples.station, samples.forces[k], lap, rate))
}

/// Sums of a pass of a place: samples, their forces and times.
type Pass = [f64; 3];

fn of_force(station: &[f32], force: &[f32], lap: f64, rate: f64) -> Option<Rate> {
    let mut places: BTreeMap<usize, BTreeMap<i64, Pass>> = BTreeMap::new();
    for (k, (s, x)) in station.iter().zip(force).enumerate().filter(|(_, (s, x))| s.is_finite() && x.is_finite()) {
        let (_, place, pass) = place_of(f64::from(*s), lap);
        let sums = places.entry(place).or_default().entry(pass).or_default();
        sums.iter_mut().zip([1.0, f64::from(*x), k as f64 / rate]).for_each(|(sum, x)| *sum += x);
    }
    // Between the first and the last whole pass of each place.
    let grown = |passes: &BTreeMap<i64, Pass>| {
        let most = passes.values().fold(0.0_f64, |most, [n, ..]| most.max(*n));
        let mut whole = passes.values().filter(|[n, ..]| *n >= WHOLE * most);
        let (first, last) = (whole.next()?, whole.next_back()?);
        let mean = |[n, x, t]: &Pass| (x / n, t / n);
        let ((x, t), (y, u)) = (mean(first), mean(last));
        Some((y - x) / (u - t))
    };
    let mut together: BTreeMap<usize, (f64, f64)> = BTreeMap::new();
    for (place, own) in places.iter().filter_map(|(place, passes)| Some((place, grown(passes)?))) {
        let sum = together.entry(place / TOGETHER).or_default();
        *sum = (sum.0 + own, sum.1 + 1.0);
    }
    let each: Vec<f64> = together.values().filter(|(_, n)| 2.0 * n >= TOGETHER as f64).map(|(x, n)| x / n).collect();
    if each.len() < LEAST {
        return None;
    }
    let n = each.len() as f64;
    let mean = each.iter().sum::<f64>() / n;
    let square = each.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>();
    Some(Rate { rate: mean, deviation: (square / (n - 1.0) / n).sqrt() })
}

/// A run without the drift of a single sensor, where it bends what the run is fitted with: as no parameter drifts, those
/// that grow along the lap would take it for theirs. `None` where no sensor drifts so, or others drift beside it.
pub fn taken_off(run: &Measured, lap: f64) -> Option<Measured> {
    let samples = run.samples();
    let rates = rates(&samples, lap, run.rate);
    let duration = samples.station.len() as f64 / run.rate;
    let surely = |own: &Rate| own.rate.abs() > APART * own.deviation;
    let size = |force: &[f32]| {
        let known = || force.iter().filter(|x| x.is_finite());
        known().map(|x| f64::from(x.abs())).sum::<f64>() / known().count().max(1) as f64
    };
    let alone = |k: usize| {
        let own = rates[k].filter(surely)?;
        let others: Vec<Rate> = (0..FORCES).filter(|j| *j != k).filter_map(|j| rates[j]).collect();
        let still = others.iter().all(|other| other.rate.abs() < BENDS * own.rate.abs());
        let bends = own.rate.abs() * duration > BENDS * size(samples.forces[k]);
        (bends && still && !others.is_empty()).then_some(own.rate)
    };
    let found: [Option<f64>; FORCES] = std::array::from_fn(alone);
    found.iter().any(Option::is_some).then(|| run.without_drift(&found.map(Option::unwrap_or_default)))
}

/// Which share of the largest rate each run has; one that does not tell it has the mean of the others. Empty where runs
/// do not differ, or fewer than two tell their rates.
pub fn shares(rates: &PerRun<Option<Rate>>) -> PerRun<f64> {
    let known: Vec<Rate> = rates.iter().flatten().copied().filter(|own| own.deviation > 0.0).collect();
    let weight = |own: &Rate| 1.0 / (own.deviation * own.deviation);
    let mean = known.iter().map(|own| weight(own) * own.rate).sum::<f64>() / known.iter().map(weight).sum::<f64>();
    let largest = known.iter().map(|own| own.rate).max_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or_default();
    let apart = |own: &Rate| {
        let apart = (own.rate - mean).abs();
        apart > APART * own.deviation && apart > SHARE * largest.abs()
    };
    if known.len() < 2 || !known.iter().any(apart) {
        return PerRun::default();
    }
    let usual = known.iter().map(|own| own.rate / largest).sum::<f64>() / known.len() as f64;
    rates.map(|own| own.map_or(usual, |own| own.rate / largest))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::trig;
    use crate::chain_input::Simulation;
    use crate::signal::{Channel, Run, Sidecar};

    const LAP: f64 = 90.0;

    /// A force along the lap at 2 m/s and 500 Hz for so many laps, with an offset that grows.
    fn run(laps: f64, drift: f64) -> Option<Rate> {
        let n = (laps * LAP / 2.0 * 500.0) as usize;
        let station: Vec<f32> = (0..n).map(|k| (k as f64 / 250.0) as f32).collect();
        let force = |k: usize| {
            let (s, t) = (k as f64 / 250.0, k as f64 / 500.0);
            let noise = trig::sin(1e4 * trig::sin(k as f64));
            (800.0 + 200.0 * trig::sin(trig::TAU * s / LAP) + drift * t + noise) as f32
        };
        let force: Vec<f32> = (0..n).map(force).collect();
        of_force(&station, &force, LAP, 500.0)
    }

    #[test]
    fn what_grows_from_pass_to_pass_is_a_drift() {
        for (laps, drift) in [(1.5, 1.2), (3.2, -0.4), (1.5, 0.0)] {
            let own = run(laps, drift).expect("places are passed again");
            assert!((own.rate - drift).abs() < 4.0 * own.deviation.max(2e-4), "{laps}, {drift}: {own:?}");
            assert!(own.deviation < 0.01, "{own:?}");
        }
        assert_eq!(run(1.05, 1.0), None, "of nine places nothing is known");
        assert_eq!(run(0.8, 1.0), None);
    }

    /// A run of a lap and a half whose channels drift so, N/s.
    fn measured(drifts: &[(Channel, f64)]) -> Measured {
        let text =
            include_str!("../../../tests/cases/levels/5-simulation.snap").splitn(3, "---\n").nth(2).expect("a body");
        let simulation: Simulation = serde_json::from_str(text).expect("an input");
        let count = (1.5 * LAP / 2.0 * 100.0) as usize;
        let time: Vec<f64> = (0..count).map(|k| k as f64 / 100.0).collect();
        let on_lap = |t: f64| (2.0 * t).rem_euclid(LAP);
        let trigger = time.iter().map(|t| if on_lap(*t) < 1.0 && *t > 0.1 { 1.0 } else { 0.0 }).collect();
        let force = |drift: f64| {
            let own = |(k, t): (usize, &f64)| {
                300.0
                    + 50.0 * trig::sin(trig::TAU * on_lap(*t) / LAP)
                    + drift * t
                    + trig::sin(1e4 * trig::sin(k as f64))
            };
            time.iter().enumerate().map(own).collect::<Vec<f64>>()
        };
        let mut channels: BTreeMap<Channel, Vec<f64>> = drifts.iter().map(|(c, drift)| (*c, force(*drift))).collect();
        channels.insert(Channel::Trigger, trigger);
        let sidecar = Sidecar { speed_setpoint: 2.0, lowpass: 40.0, laps: 1, ..Sidecar::default() };
        Measured::new(&Run { time, channels, sidecar }, &simulation, LAP).expect("a run")
    }

    #[test]
    fn only_the_drift_of_a_single_sensor_is_taken_off() {
        let drifts = |xi: f64, steer: f64| {
            measured(&[(Channel::JointXi, xi), (Channel::SteerLeft, steer), (Channel::RunLeft, 0.0)])
        };
        let left = taken_off(&drifts(1.2, 0.0), LAP).expect("a drift of 81 N");
        let rate = |k: usize| rates(&left.samples(), LAP, left.rate)[k].expect("places are passed again").rate;
        let place = |channel: Channel| Channel::FORCES.iter().position(|c| *c == channel).expect("a force");
        assert!(rate(place(Channel::JointXi)).abs() < 0.01 && rate(place(Channel::SteerLeft)).abs() < 0.01);
        // Where the chain's tension drifts, curves say so; and what is small bends nothing.
        assert!(taken_off(&drifts(1.2, 0.07), LAP).is_none());
        assert!(taken_off(&drifts(0.02, 0.0), LAP).is_none());
        assert!(taken_off(&measured(&[(Channel::JointXi, 1.2)]), LAP).is_none(), "nothing else says so");
    }

    #[test]
    fn runs_that_drift_alike_have_no_shares() {
        let of = |rates: &[Option<f64>]| {
            let each = rates.iter().map(|rate| rate.map(|rate| Rate { rate, deviation: 0.01 }));
            shares(&each.collect()).to_vec()
        };
        assert_eq!(of(&[Some(1.0), Some(1.02), Some(0.99)]), Vec::<f64>::new());
        assert_eq!(of(&[Some(0.004), Some(-0.01), None]), Vec::<f64>::new());
        assert_eq!(of(&[Some(1.0), None, None]), Vec::<f64>::new());
        assert_eq!(of(&[Some(-1.5), Some(-0.75), None]), [1.0, 0.5, 0.75]);
        assert_eq!(of(&[Some(1.5), Some(-0.375)]), [1.0, -0.25]);
    }
}
