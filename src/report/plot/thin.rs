//! Many samples as few points: peaks stay.

/// Samples gathered in cells of equal width.
pub struct Cells {
    /// Middle of each cell.
    pub x: Vec<f64>,
    /// NaN where a cell has no sample.
    pub low: Vec<f64>,
    pub mean: Vec<f64>,
    pub high: Vec<f64>,
}

/// Of samples at places in [0, `to`): least, largest and mean in each of `count` cells. Lost samples (NaN) take no part.
pub fn cells(places: &[f64], samples: &[f64], to: f64, count: usize) -> Cells {
    let mut found: Vec<Option<(f64, f64, f64, f64)>> = vec![None; count];
    for (s, x) in places.iter().zip(samples).filter(|(s, x)| s.is_finite() && x.is_finite()) {
        let cell = ((s / to * count as f64).max(0.0) as usize).min(count - 1);
        let (low, high, sum, n) = found[cell].get_or_insert((*x, *x, 0.0, 0.0));
        (*low, *high, *sum, *n) = (low.min(*x), high.max(*x), *sum + x, *n + 1.0);
    }
    let each = |of: &dyn Fn((f64, f64, f64, f64)) -> f64| found.iter().map(|c| c.map_or(f64::NAN, of)).collect();
    Cells { x: middles(to, count), low: each(&|c| c.0), mean: each(&|c| c.2 / c.3), high: each(&|c| c.1) }
}

/// Middles of cells over [0, `to`).
pub fn middles(to: f64, count: usize) -> Vec<f64> {
    (0..count).map(|k| (k as f64 + 0.5) / count as f64 * to).collect()
}

/// Of samples at times in [0, `to`), the least and the largest of each of `count` columns in the order of time: twice as
/// many values, which belong to the [`middles`] of so many cells. A column's only sample stands twice; NaN is none.
pub fn extremes(time: &[f64], samples: &[f64], to: f64, count: usize) -> Vec<f64> {
    let mut found: Vec<Option<[(f64, f64); 2]>> = vec![None; count];
    for (t, x) in time.iter().zip(samples).filter(|(t, x)| (0.0..to).contains(*t) && x.is_finite()) {
        let [least, most] = found[((t / to * count as f64) as usize).min(count - 1)].get_or_insert([(*t, *x); 2]);
        if *x < least.1 {
            *least = (*t, *x);
        }
        if *x > most.1 {
            *most = (*t, *x);
        }
    }
    let both = |column: Option<[(f64, f64); 2]>| match column {
        Some([least, most]) if least.0 <= most.0 => [least.1, most.1],
        Some([least, most]) => [most.1, least.1],
        None => [f64::NAN; 2],
    };
    found.into_iter().flat_map(both).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_keep_peaks_and_means_and_say_where_nothing_is() {
        let found = cells(&[0.1, 0.2, 0.9, 2.5], &[1.0, f64::NAN, -5.0, 7.0], 3.0, 3);
        assert_eq!((found.low[0], found.high[0], found.mean[0]), (-5.0, 1.0, -2.0));
        assert!(found.mean[1].is_nan());
        assert_eq!((found.low[2], found.x[2]), (7.0, 2.5));
    }

    #[test]
    fn a_peak_of_one_sample_among_many_stays() {
        let time: Vec<f64> = (0..100_000).map(f64::from).collect();
        let mut samples = vec![0.0; time.len()];
        (samples[77_777], samples[77_790]) = (9.0, -4.0);
        let few = extremes(&time, &samples, 1e5, 500);
        let place = few.iter().position(|x| *x == 9.0);
        assert_eq!((few.len(), place.map(|k| few[k + 1])), (1000, Some(-4.0)));
        let lost = extremes(&[0.0, 1.0, 3.0], &[1.0, f64::NAN, 2.0], 4.0, 4);
        assert!(lost[..2] == [1.0, 1.0] && lost[2..6].iter().all(|x| x.is_nan()) && lost[6..] == [2.0, 2.0]);
    }
}
