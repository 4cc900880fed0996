//! When a run passed each place of the lap, as often as it did: what changes with time is felt at these times, also where
//! a run stops in between, begins anywhere, or loses samples.

use crate::identify::feature_spec::Samples;
use std::collections::BTreeMap;

/// Length of a place, m.
const LENGTH: f64 = 0.5;
/// A pass counts with this share of the samples that its place has in the longest one.
const WHOLE: f64 = 0.5;

/// The times of a run's passes.
pub struct PassTimes {
    lap: f64,
    speed: f64,
    /// Of each place in order, when its middle was passed, s after the run's first sample.
    places: Vec<Vec<f64>>,
    /// The middle of the run, s: of places that it does not pass.
    middle: f64,
}

impl PassTimes {
    /// Of samples at a rate, Hz, on a lap of so many metres that the run goes around at a speed; its trigger is at
    /// `trigger`, m.
    pub fn new(samples: &Samples, rate: f64, (lap, speed, trigger): (f64, f64, f64)) -> PassTimes {
        let count = (lap / LENGTH).ceil().max(1.0) as usize;
        // Of each pass of a place: samples, and the sum of the times at which its middle was passed by them.
        let mut sums: Vec<BTreeMap<i64, (f64, f64)>> = vec![BTreeMap::new(); count];
        for (k, station) in samples.station.iter().enumerate() {
            let measured = samples.forces.iter().any(|force| force.get(k).is_some_and(|x| x.is_finite()));
            let s = f64::from(*station) + trigger;
            if !measured || !s.is_finite() {
                continue;
            }
            let (along, place, pass) = place_of(s, lap);
            let place = place.min(count - 1);
            let middle = k as f64 / rate + (middle_of(place) - along) / speed;
            let own = sums[place].entry(pass).or_default();
            *own = (own.0 + 1.0, own.1 + middle);
        }
        let times = |passes: BTreeMap<i64, (f64, f64)>| {
            let most = passes.values().fold(0.0_f64, |most, (n, _)| most.max(*n));
            passes.into_values().filter(|(n, _)| *n >= WHOLE * most).map(|(n, sum)| sum / n).collect()
        };
        let middle = 0.5 * samples.station.len() as f64 / rate;
        PassTimes { lap, speed, places: sums.into_iter().map(times).collect(), middle }
    }

    /// When a place is passed, s: at least once.
    pub fn at(&self, station: f64) -> impl ExactSizeIterator<Item = f64> {
        let (along, place, _) = place_of(station, self.lap);
        let place = place.min(self.places.len().saturating_sub(1));
        let known = self.places.get(place).map_or(&[][..], Vec::as_slice);
        let (times, behind) = match known {
            [] => (std::slice::from_ref(&self.middle), 0.0),
            known => (known, (along - middle_of(place)) / self.speed),
        };
        times.iter().map(move |time| time + behind)
    }

    /// When one of several carts passes a place, s: each stands for one of the passes in turn, moved so that all of them
    /// have their mean.
    pub fn of_one(&self, station: f64, (cart, carts): (usize, usize)) -> f64 {
        let (mut sum, mut taken, mut own) = (0.0, 0.0, 0.0);
        let times = self.at(station);
        let count = times.len();
        for (k, time) in times.enumerate() {
            sum += time;
            // How many of the carts stand for this one.
            taken += time * ((carts + count - 1 - k) / count) as f64;
            own = if cart % count == k { time } else { own };
        }
        own + sum / count as f64 - taken / carts.max(1) as f64
    }
}

/// How far along the lap a station is, m, which place that is, and of which pass.
pub(super) fn place_of(station: f64, lap: f64) -> (f64, usize, i64) {
    let along = station.rem_euclid(lap);
    (along, (along / LENGTH) as usize, ((station - along) / lap).round() as i64)
}

fn middle_of(place: usize) -> f64 {
    (place as f64 + 0.5) * LENGTH
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAP: f64 = 60.0;

    /// At 2 m/s and 100 Hz from 10 m past the trigger, which is at 5 m; samples of some times are lost.
    fn run(laps: f64, lost: std::ops::Range<f64>, pause: f64) -> PassTimes {
        let count = ((laps * LAP / 2.0 + pause) * 100.0) as usize;
        let time = |k: usize| k as f64 / 100.0;
        // Stands while samples are lost.
        let way = |t: f64| 2.0 * if t < lost.start { t } else { (t - pause).max(lost.start) };
        let station: Vec<f32> = (0..count).map(|k| (10.0 + way(time(k))) as f32).collect();
        let force: Vec<f32> = (0..count).map(|k| if lost.contains(&time(k)) { f32::NAN } else { 1.0 }).collect();
        let mut forces = [&[][..]; crate::signal::FORCES];
        forces[2] = &force;
        let samples = Samples { station: &station, speed: &[], forces, coverage: None };
        PassTimes::new(&samples, 100.0, (LAP, 2.0, 5.0))
    }

    fn near(times: &PassTimes, station: f64, expected: &[f64]) {
        let found: Vec<f64> = times.at(station).collect();
        let same = found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 0.02);
        assert!(same, "{station}: {found:?}, not {expected:?}");
    }

    #[test]
    fn places_are_passed_as_often_as_the_run_does() {
        let none = 1e9..1e9;
        let times = run(1.5, none.clone(), 0.0);
        near(&times, 15.0 + 3.3, &[1.65, 31.65]);
        near(&times, 15.0 + 40.0, &[20.0]);
        near(&times, 10.0 + LAP, &[27.5]);
        // What half a lap does not reach has the middle of the run.
        near(&run(0.5, none, 0.0), 10.0, &[7.5]);
    }

    #[test]
    fn a_stop_counts_as_time_and_not_as_a_pass() {
        let times = run(1.5, 12.0..52.0, 40.0);
        near(&times, 15.0 + 20.0, &[10.0, 80.0]);
        near(&times, 15.0 + 40.0, &[60.0]);
    }

    #[test]
    fn carts_stand_for_the_passes_in_turn() {
        let times = run(3.5, 1e9..1e9, 0.0);
        for station in [15.0 + 3.0, 15.0 + 40.0] {
            let all: Vec<f64> = times.at(station).collect();
            let mean = all.iter().sum::<f64>() / all.len() as f64;
            for carts in [1, 6, 14] {
                let each: Vec<f64> = (0..carts).map(|cart| times.of_one(station, (cart, carts))).collect();
                assert!((each.iter().sum::<f64>() / carts as f64 - mean).abs() < 1e-9, "{each:?}");
            }
            let each: Vec<f64> = (0..12).map(|cart| times.of_one(station, (cart, 12))).collect();
            assert!(each.iter().zip(all.iter().cycle()).all(|(own, time)| (own - time).abs() < 1e-9), "{each:?}");
        }
    }
}
