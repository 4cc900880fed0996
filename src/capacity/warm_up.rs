//! Where a simulation's warm-up ends: the truncation with the least standard error of what is left (MSER-5, White 1997).

/// Values that are averaged before the rule looks at them.
pub const BATCH: usize = 5;

/// How many of the first values to leave out: at most half of them, a multiple of [`BATCH`].
pub fn truncation(values: &[f64]) -> usize {
    let means: Vec<f64> = values.chunks_exact(BATCH).map(|batch| batch.iter().sum::<f64>() / BATCH as f64).collect();
    let n = means.len();
    let (mut sum, mut squares) = (0.0, 0.0);
    let mut best = (f64::INFINITY, 0);
    for k in (0..n).rev() {
        sum += means[k];
        squares += means[k] * means[k];
        let left = (n - k) as f64;
        if k > n / 2 {
            continue;
        }
        let variance = (squares - sum * sum / left).max(0.0) / left;
        let error = variance / left;
        if error <= best.0 {
            best = (error, k);
        }
    }
    best.1 * BATCH
}
