//! How samples become features: places, thresholds, and the lines of a spectrum.

use super::coverage::{Coverage, Weighing, hop};
use super::noise::Noise;
use super::places::{PlaceKind, Places};
use super::recorder::Recorder;
use crate::base::random::mix;
use crate::base::trig;
use crate::dynamics::Width;
use crate::signal::FORCES;
use realfft::{RealFftPlanner, RealToComplex};
use std::sync::Arc;

/// Thresholds a force is held against in each kind of place.
pub const THRESHOLDS: usize = 3;

/// Kinds of place with thresholds of their own: straights (also those that climb), left curves, right curves.
pub(super) const KINDS: usize = 3;

/// Samples that are averaged before they are held against a threshold: 40 ms at 500 Hz.
const BLOCK_S: f64 = 0.04;

/// Edges of the bands, in passings of a cart.
const EDGES: [f64; 9] = [0.3, 0.7, 1.3, 1.7, 2.3, 4.0, 9.0, 20.0, 60.0];

/// Steering wheels are the first forces.
const STEERING: usize = 2;
/// A wheel that hangs free shows so many deviations of its noise, and such a share of its sensor's range, at most.
const NOISE: f32 = 5.0;
const OFFSET: f32 = 0.005;

/// Bands of power.
pub const BANDS: usize = EDGES.len() - 1;

/// Bands of the chain's speed: the first ones.
pub(super) const SPEED_BANDS: usize = 3;

/// Samples of one cart: NaN is lost. `speed` may be empty.
#[derive(Clone, Copy, Debug)]
pub struct Samples<'a> {
    /// Arc length, m; any lap's.
    pub station: &'a [f32],
    pub speed: &'a [f32],
    pub forces: [&'a [f32]; FORCES],
    /// What of the lap they cover, when they are a run's.
    pub coverage: Option<&'a Coverage>,
}

/// How samples become features; the same for a measured run and every simulation of it.
#[derive(Clone)]
pub struct FeatureSpec {
    pub places: Arc<Places>,
    /// Samples a second, Hz.
    pub rate: f64,
    /// Passings of a cart a second, Hz.
    pub passing: f64,
    /// Of each kind of place and force, N.
    pub thresholds: [[[f32; THRESHOLDS]; FORCES]; KINDS],
    /// Which vector instructions features are worked out with.
    pub(super) width: Width,
    noise: [Noise; FORCES],
    /// Draws of it that all simulated sensors take theirs from.
    drawn: [Arc<Vec<f32>>; FORCES],
    /// The same of the chain's speed, m/s.
    drawn_speed: Arc<Vec<f32>>,
    pub(super) segment: usize,
    pub(super) block: usize,
    pub(super) window: Arc<Vec<f32>>,
    pub(super) plan: Arc<dyn RealToComplex<f32>>,
    /// Lines of each band, and of the band above the low-pass in which noise shows.
    pub(super) bands: [(usize, usize); BANDS],
    pub(super) high: (usize, usize),
    /// Lines of each order that is looked at besides: of wheels and motors.
    pub(super) orders: Vec<(usize, usize)>,
    /// Whether fluctuation is looked at cell by cell besides.
    pub local: bool,
    /// What the run's recorder did to forces.
    pub recorder: Recorder,
    /// Variances that show nothing, N².
    pub unseen: [f64; FORCES],
    /// Where the run measured that is simulated, with the trigger's place, m; everywhere when not given.
    pub within: Option<(Arc<Coverage>, f64)>,
}

/// Numbers that are added side by side: sums in a fixed order that a processor can take several at once of.
pub(super) const SIDE_BY_SIDE: usize = 8;

/// The sum of samples.
#[inline(always)]
pub(super) fn total(values: &[f32]) -> f32 {
    let mut sums = [0.0; SIDE_BY_SIDE];
    let chunks = values.chunks_exact(SIDE_BY_SIDE);
    let rest: f32 = chunks.remainder().iter().sum();
    for chunk in chunks {
        sums.iter_mut().zip(chunk).for_each(|(sum, x)| *sum += x);
    }
    sums.iter().sum::<f32>() + rest
}

/// Variance of white noise by the middle one of all steps from sample to sample, as impacts make some of them large.
fn white(samples: &[f32]) -> f32 {
    /// Of a normal deviate's size, the middle one.
    const MIDDLE: f32 = 0.674_49;
    let mut steps: Vec<f32> = samples.windows(2).map(|two| (two[1] - two[0]).abs()).filter(|x| x.is_finite()).collect();
    if steps.is_empty() {
        return 0.0;
    }
    let half = steps.len() / 2;
    let (_, middle, _) = steps.select_nth_unstable_by(half, f32::total_cmp);
    let deviation = *middle / MIDDLE;
    0.5 * deviation * deviation
}

impl FeatureSpec {
    pub fn new(places: Arc<Places>, rate: f64, passing: f64, lowpass: f64, width: Width) -> Self {
        let segment = 2 * hop(rate);
        let line = |hz: f64| ((hz * segment as f64 / rate).round() as usize).clamp(1, segment / 2);
        let bands = std::array::from_fn(|k| {
            let top = 0.45 * rate;
            (line((EDGES[k] * passing).min(top)), line((EDGES[k + 1] * passing).min(top)))
        });
        // Where the low-pass leaves a fifth or less of the forces.
        let high = if 2.0 * lowpass < 0.46 * rate { (line(0.4 * rate), line(0.49 * rate)) } else { (0, 0) };
        let window: Vec<f32> =
            (0..segment).map(|i| (0.5 - 0.5 * trig::cos(trig::TAU * i as f64 / segment as f64)) as f32).collect();
        FeatureSpec {
            places,
            rate,
            passing,
            thresholds: Default::default(),
            width,
            noise: Default::default(),
            drawn: Default::default(),
            drawn_speed: Arc::default(),
            segment,
            block: ((BLOCK_S * rate).round() as usize).max(1),
            window: Arc::new(window),
            plan: RealFftPlanner::<f32>::new().plan_fft_forward(segment),
            bands,
            high,
            orders: Vec::new(),
            local: false,
            recorder: Recorder::default(),
            unseen: [0.0; FORCES],
            within: None,
        }
    }

    /// Looks at orders besides, Hz: within 3 % or a line of each.
    pub fn set_orders(&mut self, orders: &[f64]) {
        let line = |hz: f64| hz * self.segment as f64 / self.rate;
        let lines = |hz: &f64| {
            let most = self.segment / 2;
            let low = (line(0.97 * hz).floor() as usize).clamp(1, most - 1);
            (low, (line(1.03 * hz).ceil() as usize + 1).clamp(low + 1, most))
        };
        self.orders = orders.iter().map(lines).collect();
    }

    /// Sets thresholds at the 10th, 50th and 90th percentile of a run's 40 ms means, and a hundredth of their range
    /// above, at least a thousandth of the force's range on the whole lap, five of one that was set to zero: a wheel that
    /// does not touch has a force of 0 for long, in some kinds of place all the time, and no threshold must split that: of
    /// steering wheels, which mostly hang free, none lies where noise and a small offset of the sensor may take such a mean.
    pub fn set_thresholds(&mut self, samples: &Samples, offset: f64) {
        let mut found: Vec<Vec<f32>> = vec![Vec::new(); KINDS * FORCES];
        let fine: Vec<u32> = samples.station.iter().map(|s| self.places.part(f64::from(*s) + offset)).collect();
        self.blocks(&fine, samples, |kind, force, _, mean| found[kind * FORCES + force].push(mean));
        found.iter_mut().for_each(|means| means.sort_by(f32::total_cmp));
        let lowest = |means: &Vec<f32>| means.first().copied().unwrap_or(f32::INFINITY);
        let highest = |means: &Vec<f32>| means.last().copied().unwrap_or(f32::NEG_INFINITY);
        let whole: [f32; FORCES] = std::array::from_fn(|force| {
            let kinds = || found.iter().skip(force).step_by(FORCES);
            let (high, low) = (kinds().map(highest).fold(f32::NEG_INFINITY, f32::max), kinds().map(lowest));
            (high - low.fold(f32::INFINITY, f32::min)).max(0.0)
        });
        let length = self.block as f32;
        let rest: [f32; FORCES] = std::array::from_fn(|force| match force {
            0..STEERING if !self.recorder.zeroed[force] => {
                NOISE * (white(samples.forces[force]) / length).sqrt() + OFFSET * whole[force]
            }
            _ => 0.0,
        });
        for (k, means) in found.iter().enumerate() {
            let range = (highest(means) - lowest(means)).max(0.0);
            // Where a force that was set to zero rests is known as well as its mean.
            let least = if self.recorder.zeroed[k % FORCES] { 0.005 } else { 0.001 };
            let above = (0.01 * range).max(least * whole[k % FORCES]);
            let rest = rest[k % FORCES];
            for (t, share) in [0.1, 0.5, 0.9].into_iter().enumerate() {
                let at = (share * means.len() as f64) as usize;
                let level = above + means.get(at).copied().unwrap_or(0.0);
                self.thresholds[k / FORCES][k % FORCES][t] = if level.abs() < rest { rest } else { level };
            }
        }
    }

    /// How samples are weighed: by their own coverage, or those of a simulation where the run measured.
    pub(super) fn weighing<'a>(&'a self, own: Option<&'a Coverage>) -> Weighing<'a> {
        match (own, &self.within) {
            (Some(own), _) => Weighing::Measured(own),
            (None, Some((run, trigger))) => Weighing::Within(run, *trigger),
            (None, None) => Weighing::Alike,
        }
    }

    /// Means of blocks of samples that begin and end in one zone, by their parts of the lap: the kind of place, the
    /// force, where they begin, and their mean.
    #[inline(always)]
    pub(super) fn blocks(&self, fine: &[u32], samples: &Samples, mut take: impl FnMut(usize, usize, usize, f32)) {
        let length = self.block;
        for (n, fine) in fine.chunks_exact(length).enumerate() {
            let zone = |k: usize| self.places.zone(fine[k] as usize);
            let first = zone(0);
            if zone(length - 1) != first {
                continue;
            }
            let kind = match self.places.zones[first].kind {
                PlaceKind::Straight | PlaceKind::Vertical => 0,
                PlaceKind::Left => 1,
                PlaceKind::Right => 2,
            };
            let begin = n * length;
            for (force, values) in samples.forces.iter().enumerate() {
                let Some(values) = values.get(begin..begin + length) else { continue };
                let mean = total(values) / length as f32;
                if !mean.is_nan() {
                    take(kind, force, begin, mean);
                }
            }
        }
    }

    /// Noise that a simulated sensor needs to measure as the real one.
    pub fn noise(&self) -> &[Noise; FORCES] {
        &self.noise
    }

    /// Gives the simulated sensors this noise.
    pub fn set_noise(&mut self, noise: [Noise; FORCES]) {
        self.noise = noise;
        self.drawn = std::array::from_fn(|k| Arc::new(noise[k].draw(self.rate, k as u64)));
    }

    /// Gives the simulated speed this noise, m/s.
    pub fn set_speed_noise(&mut self, noise: Noise) {
        self.drawn_speed = Arc::new(noise.draw(self.rate, FORCES as u64));
    }

    /// The chain's speed with a draw of its noise; none where it has none.
    pub(super) fn noisy_speed(&self, samples: &[f32], seed: u64) -> Option<Vec<f32>> {
        (!self.drawn_speed.is_empty()).then(|| drawn_at(&self.drawn_speed, samples, seed))
    }

    /// Whether a sensor has noise.
    pub(super) fn is_noisy(&self) -> bool {
        self.noise.iter().any(|n| n.variance() > 0.0)
    }

    /// A force's samples with a draw of its sensor's noise that `seed` picks.
    pub(super) fn with_noise(&self, force: usize, samples: &[f32], seed: u64) -> Vec<f32> {
        let drawn = &self.drawn[force];
        let mut noisy = if drawn.is_empty() { samples.to_vec() } else { drawn_at(drawn, samples, seed) };
        self.recorder.round(force, &mut noisy);
        noisy
    }
}

/// Samples with noise from a place of a table that `seed` picks.
fn drawn_at(drawn: &[f32], samples: &[f32], seed: u64) -> Vec<f32> {
    let mut noisy = Vec::with_capacity(samples.len());
    let mut from = mix(&mut { seed }) as usize % drawn.len();
    let mut left = samples;
    while !left.is_empty() {
        let (now, later) = left.split_at(left.len().min(drawn.len() - from));
        noisy.extend(now.iter().zip(&drawn[from..]).map(|(x, noise)| x + noise));
        (left, from) = (later, 0);
    }
    noisy
}
