//! Where a chain runs steadily. A record may hold a stop, a restart or another change of speed: the model is of a chain
//! that runs on, so these samples, and those in which the swings die away that they leave, are compared with nothing.

use super::groups::quartiles;
use super::sums::Sums;
use crate::signal::measures::statistics_of;

/// A speed is off where its mean over two carts is off the usual one by more than this share, and by more than so many
/// times the median. Swings within the passing of a cart are the chain's own; so are those that last.
const OFF: f64 = 0.05;
const OFF_USUAL: f64 = 3.0;

/// Time before that is left out, too, s.
const BEFORE: f64 = 1.0;

/// Swings of the mean over two carts die away until they are below so many times the usual ones, over so long a time, s.
const SWINGS: f64 = 2.0;
const OVER: f64 = 3.0;

/// Swings of less than this share of the speed are usual.
const LEAST: f64 = 5e-4;

/// Time that is left out after they did, s: forces still tell of them.
const AFTER: f64 = 5.0;

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
    let median = |values: &mut dyn Iterator<Item = f64>| quartiles(values)[1];
    let usual = median(&mut means.iter().copied().filter(|v| *v > STANDS * set));
    let usual_off = median(&mut means.iter().filter(|v| **v > STANDS * set).map(|v| (v / usual - 1.0).abs()));
    let most = OFF.max(OFF_USUAL * usual_off);
    let at = |t: f64| time.partition_point(|own| *own < t);
    let mut kept = vec![true; time.len()];
    let mut ends = vec![0];
    let mut done = 0;
    for k in (0..time.len()).filter(|k| (means[*k] / usual - 1.0).abs() > most) {
        kept[at(time[k] - BEFORE).max(done)..=k].fill(false);
        done = k + 1;
        if ends.last() == Some(&k) {
            ends.pop();
        }
        ends.push(done);
    }
    // Swings from each sample on, as far as the speed changes no more.
    let known = means.iter().zip(&kept).map(|(mean, kept)| if *kept { mean / usual - 1.0 } else { f64::NAN });
    let squares = Sums::new(known.map(|off| off * off));
    let swings: Vec<f64> = time
        .iter()
        .enumerate()
        .map(|(k, t)| (t + OVER <= time[time.len() - 1]).then(|| squares.mean(k, at(t + OVER))).flatten())
        .map(|square| square.map_or(f64::NAN, f64::sqrt))
        .collect();
    let most = SWINGS * median(&mut swings.iter().copied().filter(|x| !x.is_nan())).max(LEAST);
    for end in ends {
        let swinging = swings[end..].iter().take_while(|x| **x > most).count();
        if swinging > 0 || end > 0 {
            let calm = time.get(end + swinging).copied().unwrap_or(f64::INFINITY);
            kept[end..at(calm + AFTER)].fill(false);
        }
    }
    (kept.contains(&true) && kept.contains(&false)).then_some(kept)
}

/// Means over the passing of two carts about each sample, or about the nearest that has both; NaN where too little was
/// measured.
fn means(time: &[f64], speeds: &[f64], passing: f64) -> Vec<f64> {
    let (Some(first), Some(last)) = (time.first(), time.last()) else { return Vec::new() };
    let sums = Sums::new(speeds.iter().copied());
    let at = |t: f64| time.partition_point(|own| *own < t);
    let mean = |t: f64| sums.mean(at(t - passing), at(t + passing)).unwrap_or(f64::NAN);
    time.iter().map(|t| mean(t.min(last - passing).max(first + passing))).collect()
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
        assert!((38.0..39.5).contains(&first) && (65.0..66.0).contains(&last), "{first} {last}");
        assert!((running(&speeds, 2.0).unwrap() - 2.0).abs() < 2e-3);
    }

    #[test]
    fn swings_that_last_are_the_chains_own() {
        let (time, mut speeds) = record(false);
        for (t, v) in time.iter().zip(&mut speeds) {
            *v += 0.3 * trig::sin(trig::TAU * 0.1 * t);
        }
        assert_eq!(steady(&time, &speeds, 2.0, 0.625), None);
        speeds[4000..6000].fill(0.0);
        let kept = steady(&time, &speeds, 2.0, 0.625).unwrap();
        let lost = kept.iter().filter(|kept| !**kept).count();
        assert!((2500..3000).contains(&lost), "{lost}");
    }

    #[test]
    fn swings_that_a_start_left_are_left_out_until_they_are_usual() {
        // Usual swings of the chain of 1 mm/s, and those of a start that began with 3 % and fall to a third in 4 s, from
        // 8 s after it on: 8 mm/s at first, 2 mm/s after 5.5 s.
        let (time, mut speeds) = record(false);
        let chain = |t: f64| 1.4e-3 * trig::sin(trig::TAU * 0.2 * t);
        let left = |t: f64| 0.06 * trig::exp(-(t + 8.0) / 4.0) * trig::sin(trig::TAU * 0.25 * t);
        for (t, v) in time.iter().zip(&mut speeds) {
            *v += chain(*t);
        }
        assert_eq!(steady(&time, &speeds, 2.0, 0.625), None);
        for (t, v) in time.iter().zip(&mut speeds) {
            *v += left(*t);
        }
        let kept = steady(&time, &speeds, 2.0, 0.625).unwrap();
        assert!(!kept[0]);
        let first = kept.iter().position(|kept| *kept).unwrap();
        assert!((8.0..12.0).contains(&time[first]), "{}", time[first]);
        assert!(kept[first..].iter().all(|kept| *kept));
        // After a stop, too, however long they take.
        let stop = time.partition_point(|t| *t < 3.0);
        speeds[..stop].fill(0.0);
        let after = steady(&time, &speeds, 2.0, 0.625).unwrap();
        assert!(after.iter().zip(&kept).all(|(after, kept)| kept | !after), "more is kept after a stop");
    }

    #[test]
    fn swings_are_steady_and_a_chain_that_stands_tells_nothing() {
        let (time, speeds) = record(false);
        assert_eq!(steady(&time, &speeds, 2.0, 0.625), None);
        assert_eq!(steady(&time, &vec![0.0; time.len()], 2.0, 0.625), None);
        assert_eq!(running(&[0.01; 5], 2.0), None);
    }
}
