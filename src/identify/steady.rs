//! Where a chain runs steadily. A record may hold a stop, a restart or another change of speed: the model is of a chain
//! that runs on, so these samples, and those in which the swings die away that they leave, are compared with nothing.

/// A speed is off where its mean over two carts is off the usual one by more than this share. Swings within the passing
/// of a cart are the chain's own.
const OFF: f64 = 0.05;

/// A mean is known where so much of it was measured.
const KNOWN: f64 = 0.8;

/// Time before and after that is left out, too, s.
const BEFORE: f64 = 1.0;
const AFTER: f64 = 10.0;

/// Below this share of the speed that was set, a chain stands.
const STANDS: f64 = 0.1;

/// Where a chain runs steadily.
#[derive(Clone, Debug, PartialEq)]
pub struct Steady {
    /// Whether each sample is steady.
    pub kept: Vec<bool>,
    /// Mean speed of those, m/s.
    pub speed: f64,
}

/// Mean of the speeds at which a chain does not stand; `None` of a chain, or a sensor, that always does.
pub fn running(speeds: &[f64], set: f64) -> Option<f64> {
    mean(speeds.iter().copied().filter(|v| *v > STANDS * set))
}

/// Of a chain whose speed was measured, m/s, at times, s, and set, m/s; a cart passes in so long, s. `None` where all is
/// steady, or nothing.
pub fn steady(time: &[f64], speeds: &[f64], set: f64, passing: f64) -> Option<Steady> {
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
    if kept.iter().all(|kept| *kept) {
        return None;
    }
    let speed = mean(speeds.iter().zip(&kept).filter(|(_, kept)| **kept).map(|(v, _)| *v))?;
    Some(Steady { kept, speed })
}

/// Means over the passing of two carts about each sample; NaN where too little was measured.
fn means(time: &[f64], speeds: &[f64], passing: f64) -> Vec<f64> {
    let (mut sums, mut counts) = (vec![0.0], vec![0.0]);
    let (mut sum, mut count) = (0.0, 0.0);
    for v in speeds {
        if v.is_finite() {
            (sum, count) = (sum + v, count + 1.0);
        }
        sums.push(sum);
        counts.push(count);
    }
    let (mut from, mut to) = (0, 0);
    let mean = |t: &f64| {
        while time[from] < t - passing {
            from += 1;
        }
        while time.get(to).is_some_and(|own| *own <= t + passing) {
            to += 1;
        }
        let count = counts[to] - counts[from];
        if count < KNOWN * (to - from) as f64 { f64::NAN } else { (sums[to] - sums[from]) / count }
    };
    time.iter().map(mean).collect()
}

/// Of what is known; `None` of nothing.
fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, sum) = values.filter(|x| x.is_finite()).fold((0.0, 0.0), |(n, sum), x| (n + 1.0, sum + x));
    (count > 0.0).then(|| sum / count)
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
        let found = steady(&time, &speeds, 2.0, 0.625).unwrap();
        let first = time[found.kept.iter().position(|kept| !kept).unwrap()];
        let last = time[found.kept.iter().rposition(|kept| !kept).unwrap()];
        assert!((38.0..39.5).contains(&first) && (70.0..71.0).contains(&last), "{first} {last}");
        assert!((found.speed - 2.0).abs() < 2e-3, "{}", found.speed);
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
