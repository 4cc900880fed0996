//! What is compared of a channel: means over windows in time, or its samples.

use super::data::RunPart;
use super::model_error::fast;
use crate::gap::{Band, Label, settings};

/// What the features of a part are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Means over windows: the channels change little within one.
    Means,
    /// Samples: the channels swing within a window, and a mean would hide it.
    Samples,
}

impl Kind {
    pub fn words(self) -> &'static str {
        match self {
            Kind::Means => "means over windows",
            Kind::Samples => "samples",
        }
    }
}

/// Equal stretches of time that cover a part, or samples of it.
#[derive(Clone, Debug)]
pub(super) struct Windows {
    pub kind: Kind,
    /// Of each the first sample, that of its second half, and the one behind it.
    bounds: Vec<[usize; 3]>,
    /// Extent that each is reported with, s. Samples have that of a stretch.
    extents: Vec<(f64, f64)>,
    /// A row a channel: whether a sample was measured.
    measured: Vec<Vec<bool>>,
    /// Samples of a window in the mean.
    as_built: usize,
    /// Features that the noise is remembered over.
    pub memory: usize,
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
            kind: Kind::Means,
            bounds: (0..count).map(|i| [at(2 * i), at(2 * i + 1), at(2 * i + 2)]).collect(),
            extents: (0..count).map(|i| (edge(2 * i), edge(2 * i + 2))).collect(),
            measured: measured(part),
            as_built: part.time.len() / count,
            memory: 1,
        }
    }

    /// Samples, each or every so many, so that there are not too many. The noise is remembered over some of the run's.
    fn samples(part: &RunPart, memory: usize, settings: &settings::Windows) -> Windows {
        let every = part.time.len().div_ceil(settings.most_samples).max(1);
        let coarse = Windows::new(part, settings.first, settings);
        let chosen: Vec<usize> = (0..part.time.len()).step_by(every).collect();
        let within = |i: usize| {
            let at = coarse.bounds.partition_point(|[_, _, end]| *end <= i);
            coarse.extents.get(at).or(coarse.extents.last()).copied().unwrap_or_default()
        };
        Windows {
            kind: Kind::Samples,
            extents: chosen.iter().map(|i| within(*i)).collect(),
            bounds: chosen.into_iter().map(|i| [i, i, i + 1]).collect(),
            measured: coarse.measured,
            as_built: 1,
            memory: memory.div_ceil(every),
        }
    }

    /// What suits a part: means over windows whose length suits the noise in each channel, or samples where channels
    /// or what is left of them swing within such a window. `noise` is what is left of each that nothing foretells.
    pub fn suited(part: &RunPart, from: &Seen, settings: &settings::Windows) -> Windows {
        let samples = part.time.len() as f64;
        let memory = from.noise.iter().map(|x| correlation(x, part.time.len() / 30)).max().unwrap_or(1);
        let length =
            (settings.correlation_times * memory as f64).clamp(samples / settings.most, samples / settings.least);
        let means = Windows::new(part, (samples / length).round() as usize, settings);
        let swings = (0..from.left.len()).any(|c| {
            let noise = variance(&fast(&from.noise[c], part.time.len() / 30));
            let above = |x: &[f64], add: f64, share: f64| {
                let within = means.within(x);
                within > settings.swings * (noise + add) && within > share * variance(x)
            };
            above(&from.simulated[c], 0.0, settings.swings_share)
                || above(&from.left[c], noise, settings.left_swings_share)
        });
        if swings { Windows::samples(part, memory, settings) } else { means }
    }

    pub fn count(&self) -> usize {
        self.bounds.len()
    }

    /// Variance of a row within windows, about a straight line through each.
    pub fn within(&self, row: &[f64]) -> f64 {
        let (mut sum, mut freedom) = (0.0, 0.0);
        for [from, _, to] in &self.bounds {
            let x: Vec<(f64, f64)> = row[*from..*to]
                .iter()
                .enumerate()
                .filter(|(_, x)| x.is_finite())
                .map(|(i, x)| (i as f64, *x))
                .collect();
            let n = x.len() as f64;
            if n < 3.0 {
                continue;
            }
            let mean = x.iter().fold((0.0, 0.0), |m, p| (m.0 + p.0 / n, m.1 + p.1 / n));
            let (mut tt, mut tx, mut xx) = (0.0, 0.0, 0.0);
            for (t, x) in x.iter().map(|p| (p.0 - mean.0, p.1 - mean.1)) {
                (tt, tx, xx) = (tt + t * t, tx + t * x, xx + x * x);
            }
            sum += (xx - tx * tx / tt).max(0.0);
            freedom += n - 2.0;
        }
        if freedom > 0.0 { sum / freedom } else { 0.0 }
    }

    /// What the features are about: all of a channel in order of time, then the next channel's.
    pub fn labels<'a>(&self, channels: impl Iterator<Item = &'a String>) -> Vec<Label> {
        let ms = |t: f64| (1e3 * t).round() as i64;
        let of = |channel: &String| {
            let label = |(index, (from, to)): (usize, &(f64, f64))| Label {
                channel: channel.clone(),
                band: Band::Track,
                index,
                from: ms(*from),
                to: ms(*to),
            };
            self.extents.iter().enumerate().map(label).collect::<Vec<_>>()
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

/// What windows are chosen by, a row of samples a channel.
pub(super) struct Seen<'a> {
    pub simulated: &'a [Vec<f64>],
    /// Measured less simulated.
    pub left: &'a [Vec<f64>],
    /// What nothing foretells of it.
    pub noise: &'a [Vec<f64>],
}

fn measured(part: &RunPart) -> Vec<Vec<bool>> {
    part.channels.iter().map(|x| x.iter().map(|x| x.is_finite()).collect()).collect()
}

/// Of what is finite.
fn variance(x: &[f64]) -> f64 {
    let known = || x.iter().copied().filter(|x| x.is_finite());
    let count = known().count().max(1) as f64;
    let mean = known().sum::<f64>() / count;
    known().map(|x| (x - mean) * (x - mean)).sum::<f64>() / count
}

/// Samples after which what is left of a channel has forgotten itself: where the autocorrelation, without what is
/// slower than `slow` samples, is under 1/e. At least 1.
fn correlation(x: &[f64], slow: usize) -> usize {
    let slow = slow.max(2);
    let fast: Vec<f64> = fast(x, slow).into_iter().map(|x| if x.is_finite() { x } else { 0.0 }).collect();
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
        let still = [vec![0.0; 6000]];
        let suited = |x: &Vec<f64>, simulated: &[Vec<f64>]| {
            let left = std::slice::from_ref(x);
            Windows::suited(&part(x.clone()), &Seen { simulated, left, noise: left }, &settings)
        };
        let count = |x: &Vec<f64>| suited(x, &still).count();
        assert_eq!(count(&white), 150);
        // Forgotten to 1/e after 19.5 samples, less as what is slower is left out: 60 to 98 samples a window.
        assert!((61..=100).contains(&count(&slow)), "{}", count(&slow));
        // What swings within a window is compared sample by sample, and what rises slowly is not.
        let of = |f: &dyn Fn(f64) -> f64| [(0..6000).map(|i| f(f64::from(i))).collect::<Vec<f64>>()];
        assert_eq!(suited(&white, &of(&|t| 9.0 * crate::base::trig::sin(0.5 * t))).kind, Kind::Samples);
        assert_eq!(suited(&white, &of(&|t| 9.0 * crate::base::trig::sin(0.002 * t))).kind, Kind::Means);
    }
}
