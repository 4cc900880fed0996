//! Where a chain runs steadily. A record may hold a stop, a restart or another change of speed: the model is of a chain
//! that runs on, so these samples, and those in which the swings die away that they leave, are compared with nothing.

use super::sums::Sums;
use crate::signal::measures::statistics_of;

/// A speed is off where its mean over two carts is off the usual one by more than this share. Swings within the passing
/// of a cart are the chain's own.
const OFF: f64 = 0.05;

/// Time before and after that is left out, too, s.
const BEFORE: f64 = 1.0;
const AFTER: f64 = 10.0;

/// Below this share of the speed that was set, a chain stands.
const STANDS: f64 = 0.1;

/// Mean of the speeds at which a chain does not stand; `None` of a chain, or a sensor, that always does.
pub fn running(speeds: &[f64], set: f64) -> Option<f64> {
    statistics_of(speeds.iter().copied().filter(|v| *v > STANDS * set)).map(|s| s.mean)
}

/// Which samples are steady of a chain whose speed was measured, m/s, at times, s, and set, m/s; a cart passes in so
/// long, s. `None` where all are, or none.
pub fn steady(time: &[f64], speeds: &[f64], set: f64, passing: f64) -> Option<Vec<bool>> {
    let means = means(time, speeds, passing);
    let mut running: Vec<f64> = means.iter().copied().filter(|v| *v > STANDS * set).collect();
    let middle = running.len() / 2;
    if running.is_empty() {
        return None;
    }
    let usual = *running.select_nth_unstable_by(middle, f64::total_cmp).1;
    let off = |k: &usize| (means[*k] / usual - 1.0).abs() > OFF;
    let mut kept = vec![true; time.len()];
    let mut done = 0;
    for k in (0..time.len()).filter(off) {
        let from = time.partition_point(|t| *t < time[k] - BEFORE).max(done);
        done = time.partition_point(|t| *t <= time[k] + AFTER);
        kept[from..done].fill(false);
    }
    (kept.contains(&true) && kept.contains(&false)).then_some(kept)
}

/// Means over the passing of two carts about each sample; NaN where too little was measured.
fn means(time: &[f64], speeds: &[f64], passing: f64) -> Vec<f64> {
    let sums = Sums::new(speeds.iter().copied());
    let at = |t: f64| time.partition_point(|own| *own < t);
    time.iter().map(|t| sums.mean(at(t - passing), at(t + passing)).unwrap_or(f64::NAN)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::trig;

    /// 100 s at 2 m/s with swings of a tenth, and a stop from 40 to 60 s.
    fn record(stops: bool) -> (Vec<f64>, Vec<f64>) {
        let time: Vec<f64> = (0..10_000).map(|k| 0.01 * f64::from(k)).collect();
        let speed = |t: &f64| {
            let swing = 0.2 * trig::sin(trig::TAU * 1.6 * t);
            let stands = stops && (40.0..60.0).contains(t);
            if stands { 0.0 } else { 2.0 + swing }
        };
        let speeds = time.iter().map(speed).collect();
        (time, speeds)
    }

    #[test]
    fn a_stop_is_left_out_with_what_it_leaves() {
        let (time, mut speeds) = record(true);
        speeds[2000..2100].fill(f64::NAN);
        let kept = steady(&time, &speeds, 2.0, 0.625).unwrap();
        let first = time[kept.iter().position(|kept| !kept).unwrap()];
        let last = time[kept.iter().rposition(|kept| !kept).unwrap()];
        assert!((38.0..39.5).contains(&first) && (70.0..71.0).contains(&last), "{first} {last}");
        assert!((running(&speeds, 2.0).unwrap() - 2.0).abs() < 2e-3);
    }

    #[test]
    fn swings_are_steady_and_a_chain_that_stands_tells_nothing() {
        let (time, speeds) = record(false);
        assert_eq!(steady(&time, &speeds, 2.0, 0.625), None);
        assert_eq!(steady(&time, &vec![0.0; time.len()], 2.0, 0.625), None);
        assert_eq!(running(&[0.01; 5], 2.0), None);
    }
}
