//! What a lap amounts to, in numbers that two replicate simulations of it share.
//!
//! The motion is chaotic, so samples are not compared at the same instant. Compared are means over the passing of two
//! carts at each place of the track, the spread within each straight and curve, how often forces are low or high, and
//! the power in bands around the passing of carts. All are sums over samples, so laps and carts add up.

mod add;

use crate::base::trig;
use crate::identify::feature_spec::{KINDS, SPEED_BANDS};

pub use crate::identify::feature_spec::{BANDS, FeatureSpec, Samples, THRESHOLDS};
pub use crate::signal::FORCES;

/// Sums over samples of weights, forces, their squares, and of weights over how often a place was passed.
type Moments = [f64; 4];

/// Sums over blocks of weights below each threshold, of all, and of these over how often a place was passed.
type Shares = [f64; THRESHOLDS + 2];

/// Sums over samples.
#[derive(Clone, Debug, PartialEq)]
pub struct FeatureAccumulator {
    cells: Vec<[Moments; FORCES]>,
    zones: Vec<[Moments; FORCES]>,
    below: [[Shares; FORCES]; KINDS],
    power: [[f64; BANDS]; FORCES],
    /// Power above the low-pass, of each segment.
    high: [Vec<f64>; FORCES],
    segments: [f64; FORCES],
    /// The segments over how often their places were passed.
    shared_segments: [f64; FORCES],
    speed_power: [f64; SPEED_BANDS],
    speed_segments: f64,
    speed: (f64, f64),
    orders: Vec<[f64; FORCES]>,
    local: bool,
    /// Variances that show nothing, N²: those of what is left of hum.
    unseen: [f64; FORCES],
}

/// How samples get the sensors' noise; a seed picks the draw.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoiseDraw {
    /// They are measured and have it.
    None,
    /// As it is in a single lap.
    Lap(u64),
    /// As many laps have it in the mean: no means along the track, but all the rest.
    Mean(u64),
}

/// A group of features of one kind and force, which share what the model may miss.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Block {
    /// Means along the track.
    Mean(usize),
    /// Deviation within straights and curves.
    Spread(usize),
    /// Shares below thresholds.
    Share(usize),
    /// Power in bands.
    Power(usize),
    /// Power in bands of the chain's speed.
    SpeedPower,
    /// Power at orders of wheels and motors.
    Order(usize),
    /// Deviation within each cell.
    Local(usize),
}

impl FeatureAccumulator {
    pub fn new(spec: &FeatureSpec) -> Self {
        let places = &spec.places;
        FeatureAccumulator {
            cells: vec![[[0.0; 4]; FORCES]; places.cells],
            zones: vec![[[0.0; 4]; FORCES]; places.zones.len()],
            below: Default::default(),
            power: Default::default(),
            high: Default::default(),
            segments: Default::default(),
            shared_segments: Default::default(),
            speed_power: Default::default(),
            speed_segments: 0.0,
            speed: (0.0, 0.0),
            orders: vec![[0.0; FORCES]; spec.orders.len()],
            local: spec.local,
            unseen: spec.unseen,
        }
    }

    /// Adds another accumulator of the same spec.
    pub fn merge(&mut self, other: &FeatureAccumulator) {
        let add = |a: &mut f64, b: &f64| *a += b;
        let pairs = |a: &mut [f64], b: &[f64]| a.iter_mut().zip(b).for_each(|(a, b)| add(a, b));
        for (a, b) in self.cells.iter_mut().flatten().zip(other.cells.iter().flatten()) {
            pairs(a, b);
        }
        for (a, b) in self.zones.iter_mut().flatten().zip(other.zones.iter().flatten()) {
            pairs(a, b);
        }
        for (a, b) in self.below.iter_mut().flatten().zip(other.below.iter().flatten()) {
            pairs(a, b);
        }
        for (a, b) in self.power.iter_mut().zip(&other.power) {
            pairs(a, b);
        }
        self.high.iter_mut().zip(&other.high).for_each(|(a, b)| a.extend(b));
        pairs(&mut self.segments, &other.segments);
        pairs(&mut self.shared_segments, &other.shared_segments);
        pairs(&mut self.speed_power, &other.speed_power);
        self.speed_segments += other.speed_segments;
        self.speed = (self.speed.0 + other.speed.0, self.speed.1 + other.speed.1);
        for (a, b) in self.orders.iter_mut().zip(&other.orders) {
            pairs(a, b);
        }
    }

    /// Variance of what lies above the low-pass in the middle one of the segments, so that an impact at one place is no
    /// noise, and the share of white noise that does.
    pub fn high_power(&self, spec: &FeatureSpec) -> ([f64; FORCES], f64) {
        let share = 2.0 * (spec.high.1 - spec.high.0) as f64 / spec.segment as f64;
        let middle = |of: &Vec<f64>| {
            let mut sorted = of.clone();
            sorted.sort_by(f64::total_cmp);
            sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)
        };
        (std::array::from_fn(|k| middle(&self.high[k])), share)
    }

    /// Power of a force in each band; NaN where nothing was measured.
    pub fn band_power(&self, force: usize) -> [f64; BANDS] {
        self.power[force].map(|power| power / self.segments[force])
    }

    /// Mean speed, m/s.
    pub fn mean_speed(&self) -> Option<f64> {
        (self.speed.0 > 0.0).then(|| self.speed.1 / self.speed.0)
    }

    /// Mean of a force over all samples, N.
    pub fn mean(&self, force: usize) -> Option<f64> {
        let (n, sum) = self.cells.iter().fold((0.0, 0.0), |a, c| (a.0 + c[force][0], a.1 + c[force][1]));
        (n > 0.0).then(|| sum / n)
    }

    /// The means along the track, which are the first features.
    pub fn means(&self, least: f64) -> impl Iterator<Item = f64> {
        let mean = move |[n, sum, ..]: Moments| if n >= least { sum / n } else { f64::NAN };
        (0..FORCES).flat_map(move |force| self.cells.iter().map(move |c| mean(c[force])))
    }

    /// The features, each with its block; NaN where there are too few samples. `least` is how many make a cell's mean.
    /// All but the mean speed, which is measured otherwise.
    pub fn features(&self, least: f64) -> Vec<f64> {
        let mut out = Vec::with_capacity(self.cells.len() * FORCES + 256);
        out.extend(self.means(least));
        let spread = |[n, sum, squares, _]: Moments, force: usize| {
            let variance = squares / n - sum / n * (sum / n);
            if n >= least && variance > 0.0 { 0.5 * trig::ln(variance + self.unseen[force]) } else { f64::NAN }
        };
        for force in 0..FORCES {
            out.extend(self.zones.iter().map(|z| spread(z[force], force)));
        }
        for force in 0..FORCES {
            for kind in &self.below {
                let count = kind[force][THRESHOLDS];
                let share = |n: &f64| if count >= 20.0 { n / count } else { f64::NAN };
                out.extend(kind[force][..THRESHOLDS].iter().map(share));
            }
        }
        let power = |sum: f64, n: f64| if n > 0.0 && sum > 0.0 { 0.5 * trig::ln(sum / n) } else { f64::NAN };
        for force in 0..FORCES {
            out.extend(self.power[force].iter().map(|p| power(*p, self.segments[force])));
        }
        out.extend(self.speed_power.iter().map(|p| power(*p, self.speed_segments)));
        for force in 0..FORCES {
            out.extend(self.orders.iter().map(|p| power(p[force], self.segments[force])));
        }
        for force in (0..FORCES).filter(|_| self.local) {
            out.extend(self.cells.iter().map(|c| spread(c[force], force)));
        }
        out
    }

    /// How many passes of its places each feature is a mean over; at least one. The chain's speed has no place: `laps`
    /// is how long the run was.
    pub fn passes(&self, laps: f64) -> Vec<f64> {
        let over = |n: f64, shared: f64| if shared > 0.0 { (n / shared).max(1.0) } else { 1.0 };
        let moments = |of: &[Moments; FORCES], force: usize| over(of[force][0], of[force][3]);
        let spectrum = |force: usize| over(self.segments[force], self.shared_segments[force]);
        let mut out = Vec::with_capacity(self.cells.len() * FORCES + 256);
        (0..FORCES).for_each(|f| out.extend(self.cells.iter().map(|c| moments(c, f))));
        (0..FORCES).for_each(|f| out.extend(self.zones.iter().map(|z| moments(z, f))));
        for force in 0..FORCES {
            for kind in &self.below {
                out.extend([over(kind[force][THRESHOLDS], kind[force][THRESHOLDS + 1]); THRESHOLDS]);
            }
        }
        (0..FORCES).for_each(|f| out.extend([spectrum(f); BANDS]));
        out.extend([laps; SPEED_BANDS]);
        (0..FORCES).for_each(|f| out.extend(vec![spectrum(f); self.orders.len()]));
        for force in (0..FORCES).filter(|_| self.local) {
            out.extend(self.cells.iter().map(|c| moments(c, force)));
        }
        out
    }

    /// How finely this accumulator tells each feature: a share changes by whole blocks of samples; 0 for the others.
    pub fn resolution(&self) -> Vec<f64> {
        let mut out = vec![0.0; (self.cells.len() + self.zones.len()) * FORCES];
        for force in 0..FORCES {
            for kind in &self.below {
                out.extend([1.0 / kind[force][THRESHOLDS].max(1.0); THRESHOLDS]);
            }
        }
        out.extend([0.0; FORCES * BANDS + SPEED_BANDS]);
        let local = if self.local { self.cells.len() } else { 0 };
        out.extend(vec![0.0; FORCES * (self.orders.len() + local)]);
        out
    }

    /// The block of each feature.
    pub fn blocks(spec: &FeatureSpec) -> Vec<Block> {
        let places = &spec.places;
        let mut out = Vec::new();
        (0..FORCES).for_each(|f| out.extend(vec![Block::Mean(f); places.cells]));
        (0..FORCES).for_each(|f| out.extend(vec![Block::Spread(f); places.zones.len()]));
        (0..FORCES).for_each(|f| out.extend(vec![Block::Share(f); KINDS * THRESHOLDS]));
        (0..FORCES).for_each(|f| out.extend(vec![Block::Power(f); BANDS]));
        out.extend(vec![Block::SpeedPower; SPEED_BANDS]);
        (0..FORCES).for_each(|f| out.extend(vec![Block::Order(f); spec.orders.len()]));
        let local = if spec.local { places.cells } else { 0 };
        (0..FORCES).for_each(|f| out.extend(vec![Block::Local(f); local]));
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dynamics::Width;
    use crate::identify::coverage::Coverage;
    use crate::identify::noise::Noise;
    use crate::identify::places::{PlaceKind, Places, Zone};
    use std::sync::Arc;

    /// A lap of 40 m in 8 cells, the second half a left curve.
    fn spec() -> FeatureSpec {
        let zone = |from, to, kind| Zone { from, to, kind };
        let places = Places::of(40.0, 8, vec![zone(0.0, 20.0, PlaceKind::Straight), zone(20.0, 40.0, PlaceKind::Left)]);
        FeatureSpec::new(Arc::new(places), 500.0, 1.6, 100.0, Width::widest())
    }

    /// Two laps at 2 m/s: 100 N on the straight, 300 N in the curve, and a sine of 10 N at 4 Hz.
    fn lap() -> (Vec<f32>, Vec<f32>) {
        let time: Vec<f64> = (0..20_000).map(|i| f64::from(i) / 500.0).collect();
        let station: Vec<f32> = time.iter().map(|t| (2.0 * t + 0.001) as f32).collect();
        let level = |t: &f64| if (2.0 * t + 0.001).rem_euclid(40.0) < 20.0 { 100.0 } else { 300.0 };
        let force = time.iter().map(|t| (level(t) + 10.0 * trig::sin(trig::TAU * 4.0 * t)) as f32).collect();
        (station, force)
    }

    fn of_joint<'a>(station: &'a [f32], force: &'a [f32]) -> Samples<'a> {
        let mut forces: [&[f32]; FORCES] = [&[]; FORCES];
        forces[4] = force;
        Samples { station, speed: &[], forces, coverage: None }
    }

    fn set_noise(spec: &mut FeatureSpec) {
        let mut noise = [Noise::default(); FORCES];
        noise[4].white = 3.0;
        spec.set_noise(noise);
    }

    fn features_of(block: Block, spec: &FeatureSpec, features: &[f64]) -> Vec<f64> {
        let blocks = FeatureAccumulator::blocks(spec);
        assert_eq!(blocks.len(), features.len());
        blocks.iter().zip(features).filter(|(b, _)| **b == block).map(|(_, x)| *x).collect()
    }

    #[test]
    fn features_of_a_known_signal() {
        let mut spec = spec();
        let (station, force) = lap();
        let samples = of_joint(&station, &force);
        spec.set_thresholds(&samples, 0.0);
        let mut accumulator = FeatureAccumulator::new(&spec);
        accumulator.add(&spec, &samples, 0.0, NoiseDraw::None);
        let features = accumulator.features(1.0);
        let of = |block| features_of(block, &spec, &features);
        for (cell, mean) in of(Block::Mean(4)).iter().enumerate() {
            assert!((mean - if cell < 4 { 100.0 } else { 300.0 }).abs() < 0.02, "cell {cell}: {mean}");
        }
        // A sine's deviation is its amplitude over √2.
        assert!(of(Block::Spread(4)).iter().all(|x| (x - trig::ln(10.0 / 2_f64.sqrt())).abs() < 1e-3));
        // The median by construction, on straights and in left curves; no right curve.
        let shares = of(Block::Share(4));
        assert!((shares[1] - 0.5).abs() < 0.05 && (shares[4] - 0.5).abs() < 0.05, "{shares:?}");
        assert!(shares[6..].iter().all(|x| x.is_nan()));
        // 4 Hz is 2.5 passings: in the fifth band, and without the levels in no other but for what the window leaks.
        let sine: Vec<f32> = force.iter().map(|x| if *x < 200.0 { x - 100.0 } else { x - 300.0 }).collect();
        let mut alone = FeatureAccumulator::new(&spec);
        alone.add(&spec, &of_joint(&station, &sine), 0.0, NoiseDraw::None);
        let power = features_of(Block::Power(4), &spec, &alone.features(1.0));
        assert!((power[4] - trig::ln(10.0 / 2_f64.sqrt())).abs() < 1e-3, "{power:?}");
        assert!((0..BANDS).all(|k| k == 4 || power[k] < power[4] - 3.0), "{power:?}");
        assert!(of(Block::Mean(0)).iter().all(|x| x.is_nan()), "what was not measured has no features");
        // Moved by half a lap, the levels change places; two halves add up to the whole.
        let mut moved = FeatureAccumulator::new(&spec);
        moved.add(&spec, &samples, 20.0, NoiseDraw::None);
        let means = features_of(Block::Mean(4), &spec, &moved.features(1.0));
        assert!((means[0] - 300.0).abs() < 0.5 && (means[5] - 100.0).abs() < 0.5);
        let mut twice = accumulator.clone();
        twice.merge(&accumulator);
        let both = twice.features(1.0);
        let same = |(a, b): (&f64, &f64)| (a.is_nan() && b.is_nan()) || (a - b).abs() < 1e-12 * a.abs().max(1.0);
        assert!(features.iter().zip(&both).all(same));
    }

    /// A wheel that touches nowhere in the curve, where the smallest noise must not decide about half of its samples.
    #[test]
    fn no_threshold_splits_a_force_that_rests() {
        let mut spec = spec();
        let (station, mut force) = lap();
        force.iter_mut().filter(|x| **x > 200.0).for_each(|x| *x = 0.0);
        let samples = of_joint(&station, &force);
        spec.set_thresholds(&samples, 0.0);
        let noisy: Vec<f32> =
            force.iter().enumerate().map(|(i, x)| x + if i % 3 == 0 { 1e-3 } else { -1e-3 }).collect();
        let shares = |force: &[f32]| {
            let mut accumulator = FeatureAccumulator::new(&spec);
            accumulator.add(&spec, &of_joint(&station, force), 0.0, NoiseDraw::None);
            features_of(Block::Share(4), &spec, &accumulator.features(1.0))
        };
        assert_eq!((&shares(&force)[3..6], &shares(&noisy)[3..6]), (&[1.0; 3][..], &[1.0; 3][..]));
    }

    /// Where a chain swings, it is slow where it is tight: a run's means are then those of its simulation, whatever it
    /// covers.
    #[test]
    fn means_of_a_run_that_swings_are_those_of_its_simulation() {
        let mut spec = spec();
        // 1.3 laps, with a swing of a tenth of the speed at every 1.25 m.
        let (mut station, mut force, mut at) = (Vec::new(), Vec::new(), 3.0_f64);
        while at < 55.0 {
            let swing = trig::sin(trig::TAU * at / 1.25);
            station.push(at as f32);
            force.push((600.0 - 2000.0 * swing) as f32);
            at += 0.004 * (1.0 + 0.1 * swing);
        }
        let lap = station.iter().position(|s| *s >= 43.0).unwrap();
        let means = |spec: &FeatureSpec, samples: &Samples| {
            let mut accumulator = FeatureAccumulator::new(spec);
            accumulator.add(spec, samples, 0.0, NoiseDraw::None);
            features_of(Block::Mean(4), spec, &accumulator.features(1.0))
        };
        let mut forces: [&[f32]; FORCES] = [&[]; FORCES];
        forces[4] = &force;
        let coverage = Arc::new(Coverage::new(&station, forces, 40.0, 500.0));
        let measured = means(&spec, &Samples { coverage: Some(&coverage), ..of_joint(&station, &force) });
        spec.within = Some((coverage.clone(), 0.0));
        let simulated = means(&spec, &of_joint(&station[..lap], &force[..lap]));
        let most = measured.iter().zip(&simulated).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(most < 2.0 && measured[0] > 650.0, "{most} {measured:?} {simulated:?}");
    }

    #[test]
    fn lost_samples_take_no_part_and_noise_shows_above_the_low_pass() {
        let mut spec = spec();
        let (station, mut force) = lap();
        force[300..400].fill(f32::NAN);
        let mut accumulator = FeatureAccumulator::new(&spec);
        accumulator.add(&spec, &of_joint(&station, &force), 0.0, NoiseDraw::None);
        let means = features_of(Block::Mean(4), &spec, &accumulator.features(1.0));
        assert!(means.iter().all(|x| x.is_finite()));
        set_noise(&mut spec);
        let found = |seed: u64| {
            let mut noisy = FeatureAccumulator::new(&spec);
            noisy.add(&spec, &of_joint(&station, &force), 0.0, NoiseDraw::Lap(seed));
            let ((clean, share), (high_power, _)) = (accumulator.high_power(&spec), noisy.high_power(&spec));
            ((high_power[4] - clean[4]) / share).sqrt()
        };
        let mean = (0..16).map(found).sum::<f64>() / 16.0;
        assert!((mean - 3.0).abs() < 0.08, "{mean}");
    }

    #[test]
    fn a_blow_is_no_noise() {
        let mut spec = spec();
        set_noise(&mut spec);
        let (station, mut force) = lap();
        let power = |force: &[f32]| {
            let mut accumulator = FeatureAccumulator::new(&spec);
            accumulator.add(&spec, &of_joint(&station, force), 0.0, NoiseDraw::Lap(5));
            accumulator.high_power(&spec).0[4]
        };
        let before = power(&force);
        let at = force.len() / 7;
        force[at] += 500.0;
        let after = power(&force);
        assert!((after / before - 1.0).abs() < 0.2, "{before} {after}");
    }
}
