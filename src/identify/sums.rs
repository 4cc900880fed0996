//! Means over any stretch of samples, of which some are lost.

/// Sums up to each sample, from which means over any time follow.
pub struct Sums {
    sums: Vec<f64>,
    known: Vec<u32>,
}

impl Sums {
    pub fn new(values: impl Iterator<Item = f64>) -> Sums {
        let (mut sums, mut known) = (vec![0.0], vec![0]);
        let (mut sum, mut count) = (0.0, 0);
        for x in values {
            if x.is_finite() {
                sum += x;
                count += 1;
            }
            sums.push(sum);
            known.push(count);
        }
        Sums { sums, known }
    }

    pub fn samples(&self) -> usize {
        self.sums.len() - 1
    }

    /// Mean from one sample up to another, where all are known but a few.
    pub fn mean(&self, from: usize, to: usize) -> Option<f64> {
        let known = f64::from(self.known[to] - self.known[from]);
        (known >= 0.95 * (to - from) as f64).then(|| (self.sums[to] - self.sums[from]) / known)
    }

    /// Half the square of the difference of two neighbouring means.
    pub fn allan(&self, from: usize, over: usize) -> Option<f64> {
        let end = from + 2 * over;
        let fits = end < self.sums.len();
        let (a, b) = (fits.then(|| self.mean(from, from + over))??, self.mean(from + over, end)?);
        Some(0.5 * (b - a) * (b - a))
    }
}
