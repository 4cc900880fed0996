//! Adding a cart's samples, in one operation on the widest vectors that the processor has: beside the motion itself it
//! is what identification and diagnosis spend their time on. Sums are taken in the same order with every width.

use super::super::coverage::{Weighing, Weight};
use super::{FORCES, FeatureAccumulator, FeatureSpec, Moments, NoiseDraw, Samples, THRESHOLDS};
use crate::identify::feature_spec::{SIDE_BY_SIDE, total};
use crate::identify::places::Places;
use pulp::{Simd, WithSimd};
use realfft::num_complex::Complex;

impl FeatureAccumulator {
    /// Adds a cart's samples, moved along the track by `offset`, m.
    pub fn add(&mut self, spec: &FeatureSpec, samples: &Samples, offset: f64, noise: NoiseDraw) {
        let with_noise = |seed: u64| -> Option<Vec<Vec<f32>>> {
            let draw = |k: usize| seed.wrapping_mul(31).wrapping_add(k as u64);
            let forces = samples.forces.iter().enumerate();
            spec.is_noisy().then(|| forces.map(|(k, force)| spec.with_noise(k, force, draw(k))).collect())
        };
        let noisy = match noise {
            NoiseDraw::None => None,
            NoiseDraw::Lap(seed) | NoiseDraw::Mean(seed) => with_noise(seed),
        };
        let mut all = *samples;
        if let Some(noisy) = &noisy {
            all.forces = std::array::from_fn(|k| noisy[k].as_slice());
        }
        let speed = match noise {
            NoiseDraw::None => None,
            NoiseDraw::Lap(seed) | NoiseDraw::Mean(seed) => spec.noisy_speed(samples.speed, !seed),
        };
        if let Some(speed) = &speed {
            all.speed = speed;
        }
        let (of_places, variance) = match noise {
            NoiseDraw::Mean(_) => (*samples, spec.noise().map(|n| n.variance())),
            NoiseDraw::None | NoiseDraw::Lap(_) => (all, [0.0; FORCES]),
        };
        let to = self;
        spec.width.run(Add { to, spec, of_places, variance, others: Some(all), offset });
    }

    /// Adds to the sums by place alone.
    pub fn add_places(&mut self, spec: &FeatureSpec, samples: &Samples, offset: f64) {
        let to = self;
        spec.width.run(Add { to, spec, of_places: *samples, variance: [0.0; FORCES], others: None, offset });
    }
}

struct Add<'a> {
    to: &'a mut FeatureAccumulator,
    spec: &'a FeatureSpec,
    /// For sums by place, and how much more variance they have, N².
    of_places: Samples<'a>,
    variance: [f64; FORCES],
    /// For all others.
    others: Option<Samples<'a>>,
    offset: f64,
}

impl WithSimd for Add<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let (to, spec) = (self.to, self.spec);
        let at = Stations::new(spec, &self.of_places, self.offset);
        add_places(to, &at, &self.of_places, &self.variance);
        if let Some(samples) = &self.others {
            add_blocks(to, spec, &at, samples);
            add_spectra(to, spec, &at, samples);
        }
    }
}

/// Where a cart's samples are.
struct Stations<'a> {
    weighing: Weighing<'a>,
    places: &'a Places,
    /// Part of the lap of each sample, [`Places::fine`].
    fine: Vec<u32>,
    /// Part of the lap that weights are counted by; empty where all samples count alike.
    parts: Vec<u32>,
}

impl<'a> Stations<'a> {
    #[inline(always)]
    fn new(spec: &'a FeatureSpec, samples: &Samples<'a>, offset: f64) -> Self {
        let places = &*spec.places;
        let fine = samples.station.iter().map(|s| places.part(f64::from(*s) + offset));
        let weighing = spec.weighing(samples.coverage);
        let parts = match weighing {
            Weighing::Alike => Vec::new(),
            _ => samples.station.iter().map(|s| weighing.part(*s)).collect(),
        };
        Stations { weighing, places, fine: fine.collect(), parts }
    }

    /// What a sample of a force counts.
    #[inline(always)]
    fn weight(&self, force: usize, k: usize) -> Weight {
        self.weighing.sample(force, self.parts[k])
    }

    fn is_alike(&self) -> bool {
        self.parts.is_empty()
    }
}

#[inline(always)]
fn add_places(to: &mut FeatureAccumulator, at: &Stations, samples: &Samples, variance: &[f64; FORCES]) {
    // Runs of samples in the same cell and zone.
    let mut runs: Vec<(usize, usize, usize, usize)> = Vec::new();
    let mut last = u32::MAX;
    for (k, fine) in at.fine.iter().enumerate() {
        if *fine == last {
            continue;
        }
        last = *fine;
        let (cell, zone) = (Places::cell(*fine as usize), at.places.zone(*fine as usize));
        match runs.last_mut() {
            Some(run) if (run.0, run.1) == (cell, zone) => {}
            open => {
                if let Some(run) = open {
                    run.3 = k;
                }
                runs.push((cell, zone, k, at.fine.len()));
            }
        }
    }
    for (force, values) in samples.forces.iter().enumerate() {
        for (cell, zone, begin, end) in &runs {
            let Some(values) = values.get(*begin..*end) else { break };
            let mut sums = match at.is_alike() {
                true => moments(values),
                false => weighed(values, |k| at.weight(force, begin + k)),
            };
            sums[2] += variance[force] * sums[0];
            for all in [&mut to.cells[*cell][force], &mut to.zones[*zone][force]] {
                all.iter_mut().zip(sums).for_each(|(all, x)| *all += x);
            }
        }
    }
    for v in samples.speed.iter().filter(|v| !v.is_nan()) {
        to.speed.0 += 1.0;
        to.speed.1 += f64::from(*v);
    }
}

#[inline(always)]
fn add_blocks(to: &mut FeatureAccumulator, spec: &FeatureSpec, at: &Stations, samples: &Samples) {
    spec.blocks(&at.fine, samples, |kind, force, begin, mean| {
        let mut weight = Weight::ONE;
        if !at.is_alike() {
            let all = (begin..begin + spec.block).map(|k| at.weight(force, k));
            let (own, shared) = all.fold((0.0, 0.0), |sum, w| (sum.0 + w.own, sum.1 + w.shared));
            weight = Weight { own: own / spec.block as f64, shared: shared / spec.block as f64 };
        }
        let below = &mut to.below[kind][force];
        for (count, threshold) in below.iter_mut().zip(spec.thresholds[kind][force]) {
            *count += if mean < threshold { weight.own } else { 0.0 };
        }
        below[THRESHOLDS] += weight.own;
        below[THRESHOLDS + 1] += weight.shared;
    });
}

#[inline(always)]
fn add_spectra(to: &mut FeatureAccumulator, spec: &FeatureSpec, at: &Stations, samples: &Samples) {
    let n = spec.segment;
    let mut spectrum = Spectrum::new(spec);
    for (force, values) in samples.forces.iter().enumerate() {
        for begin in (0..values.len()).step_by(n / 2) {
            let Some(part) = values.get(begin..begin + n) else { break };
            if !spectrum.take(spec, part) {
                continue;
            }
            let weight = match at.is_alike() {
                true => Weight::ONE,
                false => at.weighing.segment(force, at.parts[begin + n / 2]),
            };
            for (sum, (from, to)) in to.power[force].iter_mut().zip(spec.bands) {
                *sum += weight.own * spectrum.between(from, to);
            }
            for (sum, (from, to)) in to.orders.iter_mut().zip(&spec.orders) {
                sum[force] += weight.own * spectrum.between(*from, *to);
            }
            to.high[force].push(spectrum.between(spec.high.0, spec.high.1));
            to.segments[force] += weight.own;
            to.shared_segments[force] += weight.shared;
        }
    }
    for begin in (0..samples.speed.len()).step_by(n / 2) {
        let Some(part) = samples.speed.get(begin..begin + n) else { break };
        if !spectrum.take(spec, part) {
            continue;
        }
        for (sum, (from, to)) in to.speed_power.iter_mut().zip(spec.bands) {
            *sum += spectrum.between(from, to);
        }
        to.speed_segments += 1.0;
    }
}

/// One-sided power in each line, so that the sum is the variance.
struct Spectrum {
    input: Vec<f32>,
    lines: Vec<Complex<f32>>,
    scratch: Vec<Complex<f32>>,
    scale: f64,
}

impl Spectrum {
    fn new(spec: &FeatureSpec) -> Self {
        let n = spec.segment as f64;
        Spectrum {
            input: vec![0.0; spec.segment],
            lines: spec.plan.make_output_vec(),
            scratch: spec.plan.make_scratch_vec(),
            // Of two sides, through a window whose mean square is 3/8.
            scale: 16.0 / 3.0 / (n * n),
        }
    }

    /// Of samples; false where one is lost.
    #[inline(always)]
    fn take(&mut self, spec: &FeatureSpec, part: &[f32]) -> bool {
        let mean = total(part) / part.len() as f32;
        if mean.is_nan() {
            return false;
        }
        for ((x, y), w) in self.input.iter_mut().zip(part).zip(spec.window.iter()) {
            *x = (y - mean) * w;
        }
        spec.plan.process_with_scratch(&mut self.input, &mut self.lines, &mut self.scratch).is_ok()
    }

    /// In lines of a band.
    #[inline(always)]
    fn between(&self, from: usize, to: usize) -> f64 {
        let (chunks, rest) = self.lines[from..to].as_chunks::<SIDE_BY_SIDE>();
        let mut sums = [0.0; SIDE_BY_SIDE];
        for chunk in chunks {
            sums.iter_mut().zip(chunk).for_each(|(sum, line)| *sum += f64::from(line.norm_sqr()));
        }
        let rest: f64 = rest.iter().map(|line| f64::from(line.norm_sqr())).sum();
        self.scale * (sums.iter().sum::<f64>() + rest)
    }
}

/// The moments of samples that count alike.
#[inline(always)]
fn moments(values: &[f32]) -> Moments {
    let (mut n, mut sum, mut squares) = ([0.0; SIDE_BY_SIDE], [0.0; SIDE_BY_SIDE], [0.0; SIDE_BY_SIDE]);
    let mut add = |k: usize, x: f32| {
        let lost = x.is_nan();
        let x = if lost { 0.0 } else { f64::from(x) };
        n[k] += if lost { 0.0 } else { 1.0 };
        sum[k] += x;
        squares[k] += x * x;
    };
    let chunks = values.chunks_exact(SIDE_BY_SIDE);
    let rest = chunks.remainder();
    for chunk in chunks {
        chunk.iter().enumerate().for_each(|(k, x)| add(k, *x));
    }
    rest.iter().enumerate().for_each(|(k, x)| add(k, *x));
    let [n, sum, squares] = [n, sum, squares].map(|sums| sums.iter().sum::<f64>());
    [n, sum, squares, n]
}

/// The moments of samples that count differently.
#[inline(always)]
fn weighed(values: &[f32], weight: impl Fn(usize) -> Weight) -> Moments {
    let mut moments = [0.0; 4];
    for (k, x) in values.iter().enumerate().filter(|(_, x)| !x.is_nan()) {
        let (x, weight) = (f64::from(*x), weight(k));
        let own = [weight.own, weight.own * x, weight.own * x * x, weight.shared];
        moments.iter_mut().zip(own).for_each(|(sum, x)| *sum += x);
    }
    moments
}
