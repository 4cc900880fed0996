//! Means over windows in time: the features by which a run is compared with a model.

use super::data::RunPart;
use crate::gap::{Band, Label, settings};

/// Equal stretches of time that cover a part.
#[derive(Clone, Debug)]
pub(super) struct Windows {
    /// Of each the first sample, that of its second half, and the one behind it.
    bounds: Vec<[usize; 3]>,
    /// s
    edges: Vec<f64>,
    /// A row a channel: whether a sample was measured.
    measured: Vec<Vec<bool>>,
    /// Samples of a window in the mean.
    as_built: usize,
}

impl Windows {
    /// So many windows, or fewer when that would leave too few samples in each.
    pub fn new(part: &RunPart, count: usize, settings: &settings::Windows) -> Windows {
        let count = count.min(part.time.len() / settings.samples).max(1);
        let (from, to) = part.ends();
        let edge = |half: usize| from + (to - from) * half as f64 / (2 * count) as f64;
        let at = |half: usize| {
            if half == 2 * count { part.time.len() } else { part.time.partition_point(|t| *t < edge(half)) }
        };
        Windows {
            bounds: (0..count).map(|i| [at(2 * i), at(2 * i + 1), at(2 * i + 2)]).collect(),
            edges: (0..=count).map(|i| edge(2 * i)).collect(),
            measured: part.channels.iter().map(|x| x.iter().map(|x| x.is_finite()).collect()).collect(),
            as_built: part.time.len() / count,
        }
    }

    /// Windows whose length suits the noise in what is left of each channel.
    pub fn suited(part: &RunPart, left: &[Vec<f64>], settings: &settings::Windows) -> Windows {
        let samples = part.time.len() as f64;
        let memory = left.iter().map(|x| correlation(x, part.time.len() / 30)).max().unwrap_or(1) as f64;
        let length = (settings.correlation_times * memory).clamp(samples / settings.most, samples / settings.least);
        Windows::new(part, (samples / length).round() as usize, settings)
    }

    pub fn count(&self) -> usize {
        self.bounds.len()
    }

    /// What the features are about: all windows of a channel, then the next channel's.
    pub fn labels<'a>(&self, channels: impl Iterator<Item = &'a String>) -> Vec<Label> {
        let ms = |t: f64| (1e3 * t).round() as i64;
        let of = |channel: &String| {
            let label = |(index, w): (usize, &[f64])| Label {
                channel: channel.clone(),
                band: Band::Track,
                index,
                from: ms(w[0]),
                to: ms(w[1]),
            };
            self.edges.windows(2).enumerate().map(label).collect::<Vec<_>>()
        };
        channels.flat_map(of).collect()
    }

    /// Features of rows of samples, a row a channel: means over what was measured of each window. NaN where less than
    /// half of a window was measured, or where the row has none for a sample that was.
    pub fn means(&self, rows: &[Vec<f64>]) -> Vec<f64> {
        self.over(rows, |[from, _, to]| (from, to), self.as_built.div_ceil(2))
    }

    /// As [`Windows::means`], of the first and of the second half of each window.
    pub fn halves(&self, rows: &[Vec<f64>]) -> [Vec<f64>; 2] {
        let least = self.as_built.div_ceil(8);
        [self.over(rows, |[from, half, _]| (from, half), least), self.over(rows, |[_, half, to]| (half, to), least)]
    }

    fn over(&self, rows: &[Vec<f64>], range: impl Fn([usize; 3]) -> (usize, usize), least: usize) -> Vec<f64> {
        let mut means = Vec::with_capacity(rows.len() * self.bounds.len());
        for (row, measured) in rows.iter().zip(&self.measured) {
            for bounds in &self.bounds {
                let (from, to) = range(*bounds);
                let (mut sum, mut count) = (0.0, 0);
                for (x, _) in row[from..to].iter().zip(&measured[from..to]).filter(|(_, measured)| **measured) {
                    sum += x;
                    count += 1;
                }
                means.push(if count >= least.max(1) { sum / count as f64 } else { f64::NAN });
            }
        }
        means
    }
}

/// Samples after which what is left of a channel has forgotten itself: where the autocorrelation, without what is
/// slower than `slow` samples, is under 1/e. At least 1.
fn correlation(x: &[f64], slow: usize) -> usize {
    let slow = slow.max(2);
    let mut fast = Vec::with_capacity(x.len());
    for stretch in x.chunks(slow) {
        let known = || stretch.iter().filter(|x| x.is_finite());
        let mean = known().sum::<f64>() / known().count().max(1) as f64;
        fast.extend(stretch.iter().map(|x| if x.is_finite() { x - mean } else { 0.0 }));
    }
    let product = |lag: usize| -> f64 { fast.iter().zip(&fast[lag..]).map(|(a, b)| a * b).sum() };
    let power = product(0);
    (1..slow.min(fast.len())).find(|&lag| product(lag) < power * 0.367_879_441).unwrap_or(slow)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn part(samples: Vec<f64>) -> RunPart {
        RunPart {
            content: String::new(),
            name: "run".into(),
            run: "run".into(),
            file: "run.csv".into(),
            settings: Default::default(),
            time: (0..samples.len()).map(|i| i as f64 * 0.5).collect(),
            channels: vec![samples],
        }
    }

    #[test]
    fn means_are_over_what_was_measured() {
        let mut samples: Vec<f64> = (0..80).map(f64::from).collect();
        samples[0] = f64::NAN;
        samples[8..14].fill(f64::NAN);
        let run = part(samples.clone());
        let windows = Windows::new(&run, 10, &settings::Windows::default());
        let means = windows.means(&run.channels);
        assert_eq!((means[0], means[2]), (4.0, 19.5));
        assert!(means[1].is_nan(), "two samples of eight");
        assert_eq!(windows.halves(&run.channels)[1][2], 21.5);
        let ones = windows.means(&[vec![1.0; 80]]);
        assert!(ones[1].is_nan() && ones[0] == 1.0);
        assert_eq!(windows.labels([&"x".to_owned()].into_iter())[1].from, 3950);
        assert_eq!(Windows::new(&run, 1000, &settings::Windows::default()).count(), 20);
    }

    #[test]
    fn windows_are_longer_when_the_noise_remembers_longer() {
        let settings = settings::Windows::default();
        let mut state = 3;
        let white: Vec<f64> = (0..6000).map(|_| crate::base::random::normal(&mut state)).collect();
        let mut slow = vec![0.0; 6000];
        for i in 1..6000 {
            slow[i] = 0.95 * slow[i - 1] + white[i];
        }
        let count = |x: &Vec<f64>| Windows::suited(&part(x.clone()), std::slice::from_ref(x), &settings).count();
        assert_eq!(count(&white), 150);
        // Forgotten to 1/e after 19.5 samples, less as what is slower is left out: 60 to 98 samples a window.
        assert!((61..=100).contains(&count(&slow)), "{}", count(&slow));
    }
}
