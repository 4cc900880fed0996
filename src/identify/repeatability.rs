//! The repeatability: how far apart two replicate laps are. Each cart of a simulation is a lap of its own; a simulation
//! with half the step and one from a fresh start say what the computation adds.

use super::model::{Coordinates, Model, Plan, samples};
use crate::base::trig;
use crate::dynamics::{Ensemble, Settled};
use crate::identify::accumulator::{Block, FORCES, FeatureAccumulator};
use std::collections::BTreeMap;

/// How features of one cart's lap scatter about those of all carts.
#[derive(Clone, Debug)]
pub struct Repeatability {
    /// Of each feature over one lap.
    pub deviation: Vec<f64>,
    /// The same without the sensors' noise where means along the track are concerned, as simulated means have none.
    pub chaos: Vec<f64>,
    /// What a single lap's feature is larger by in the mean than that of many laps together.
    pub bias: Vec<f64>,
    /// Each cart's feature less the mean of all.
    pub scatter: Vec<Vec<f64>>,
    /// By how much all means of a force may be off together, as independent programs and sensors agree no better; 0 for
    /// what is no mean.
    pub level: Vec<f64>,
    /// The mean speed of a lap scatters by, m/s.
    pub speed: f64,
}

/// What a simulation owes to its step and its start rather than to its parameters.
#[derive(Clone, Debug)]
pub struct Numerics {
    /// To be added to what is simulated at the usual step: extrapolated to none, as the integrator is of second order
    /// (Richardson 1911).
    pub correction: Vec<f64>,
    /// By how much features may be off together: half the correction, and what a fresh start does that has had the
    /// usual 30 s to settle, as a measured chain seldom has longer.
    pub discrepancies: [Vec<f64>; 2],
    /// The discrepancies squared, or their mean in a feature's block when that is more; infinite for what the step
    /// makes.
    pub variance: Vec<f64>,
}

/// Change of a spread, a share or an amplitude's logarithm with the step above which it is not the chain's.
const MADE_BY_THE_STEP: f64 = 0.1;

/// A feature's deviation is at least this share of its block's.
const LEAST_SHARE: f64 = 0.1;

/// To what independent programs and sensors agree at best: of the range of a force's means along the track, and
/// relative to spreads and amplitudes (design: chain model, Chaos: two-cart means to 0.0-0.3 %).
pub const MEANS_AGREE: f64 = 5e-4;
const LOGARITHMS_AGREE: f64 = 3e-3;

/// Time that a measured chain ran before, at least, s.
pub const RAN_BEFORE: f64 = 30.0;

impl Numerics {
    /// Of a computation without discrepancies, for so many features.
    pub fn none(features: usize) -> Numerics {
        let none = || vec![0.0; features];
        Numerics { correction: none(), discrepancies: [none(), none()], variance: none() }
    }

    /// From the features at a point, those with half the step, and those of a fresh start.
    pub fn new(model: &Model, at: &Coordinates, usual: &[f64], from: &Settled, noise: u64) -> Option<Numerics> {
        let passes = 0.5 * model.simulation.chain.carts as f64;
        let finer = Plan { passes, step: Some(0.5 * model.step(at)?), from: Some(from), ..Plan::default() };
        let fresh = Plan { passes, settle: Some(RAN_BEFORE), ..Plan::default() };
        let less = |plan: &Plan| -> Option<Vec<f64>> {
            let features = model.answer(&model.run_ensemble(at, plan)?, 0.0, noise).features;
            Some(features.iter().zip(usual).map(|(a, b)| if (a - b).is_nan() { 0.0 } else { a - b }).collect())
        };
        let correction: Vec<f64> = less(&finer)?.into_iter().map(|x| 4.0 / 3.0 * x).collect();
        let discrepancies = [correction.iter().map(|x| 0.5 * x).collect(), less(&fresh)?];
        let named = FeatureAccumulator::blocks(&model.spec);
        // What is mostly made by the step is left out: neither its size nor its slopes are the chain's.
        let made = |k: usize| !matches!(named[k], Block::Mean(_)) && correction[k].abs() > MADE_BY_THE_STEP;
        let own = |k: usize| discrepancies.iter().map(|d: &Vec<f64>| d[k] * d[k]).sum::<f64>();
        let mut blocks: BTreeMap<Block, (f64, f64)> = BTreeMap::new();
        for k in (0..named.len()).filter(|k| !made(*k)) {
            let sum = blocks.entry(named[k]).or_default();
            *sum = (sum.0 + own(k), sum.1 + 1.0);
        }
        let mean = |block: &Block| blocks.get(block).map_or(0.0, |(sum, n)| sum / n);
        let variance =
            (0..named.len()).map(|k| if made(k) { f64::INFINITY } else { mean(&named[k]).max(own(k)) }).collect();
        Some(Numerics { correction, discrepancies, variance })
    }
}

impl Repeatability {
    /// From an ensemble in which every cart went at least once around.
    pub fn new(model: &Model, ensemble: &Ensemble, noise: u64) -> Repeatability {
        let each = model.each(ensemble, noise);
        let mut all = FeatureAccumulator::new(&model.spec);
        each.iter().for_each(|one| all.merge(one));
        let whole = all.features(1.0);
        let single: Vec<Vec<f64>> = each.iter().map(|one| one.features(1.0)).collect();
        let n = single.len() as f64;
        let column = |k: usize| single.iter().map(move |one| one[k]).filter(|x| !x.is_nan());
        let mean: Vec<f64> =
            (0..whole.len()).map(|k| column(k).sum::<f64>() / column(k).count().max(1) as f64).collect();
        let resolution = each.first().map_or_else(Vec::new, FeatureAccumulator::resolution);
        let deviation: Vec<f64> = (0..whole.len())
            .map(|k| {
                let count = column(k).count();
                let sum: f64 = column(k).map(|x| (x - mean[k]) * (x - mean[k])).sum();
                // A feature that half of the carts lack tells nothing.
                if 2 * count < single.len() {
                    f64::NAN
                } else {
                    trig::hypot((sum / (count - 1).max(1) as f64).sqrt(), resolution[k])
                }
            })
            .collect();
        let blocks = FeatureAccumulator::blocks(&model.spec);
        let clean = means_without_noise(model, ensemble);
        let chaos: Vec<f64> = deviation
            .iter()
            .zip(&blocks)
            .enumerate()
            .map(|(k, (own, block))| match (block, clean.get(k)) {
                (Block::Mean(_), Some(clean)) if !own.is_nan() => *clean,
                _ => *own,
            })
            .collect();
        let chaos = Agreed::new(&chaos, &whole, blocks.clone()).levelled(&chaos);
        let agreed = Agreed::new(&deviation, &whole, blocks);
        let deviation = agreed.levelled(&deviation);
        let scatter =
            single.iter().map(|one| one.iter().zip(&mean).map(|(x, m)| if x.is_nan() { 0.0 } else { x - m }).collect());
        let speeds: Vec<f64> = each.iter().filter_map(FeatureAccumulator::mean_speed).collect();
        let speed = speeds.iter().sum::<f64>() / n;
        Repeatability {
            deviation,
            chaos,
            bias: mean.iter().zip(&whole).map(|(m, w)| if (m - w).is_nan() { 0.0 } else { m - w }).collect(),
            scatter: scatter.collect(),
            level: agreed.level(),
            speed: (speeds.iter().map(|v| (v - speed) * (v - speed)).sum::<f64>() / n).sqrt(),
        }
    }

    /// A ensemble of a lap at a point.
    pub fn run_ensemble(model: &Model, at: &Coordinates, from: Option<&Settled>) -> Option<Ensemble> {
        model.run_ensemble(at, &Plan { passes: model.simulation.chain.carts as f64, from, ..Plan::default() })
    }
}

/// How the means along the track of carts' laps scatter without the sensors' noise; they are the first features.
fn means_without_noise(model: &Model, ensemble: &Ensemble) -> Vec<f64> {
    let cells = model.spec.places.cells * FORCES;
    let mut sums = vec![[0.0; 3]; cells];
    for cart in &ensemble.carts {
        let mut one = FeatureAccumulator::new(&model.spec);
        one.add_places(&model.spec, &samples(cart), 0.0);
        for (sum, x) in sums.iter_mut().zip(one.means(1.0)).filter(|(_, x)| !x.is_nan()) {
            sum.iter_mut().zip([1.0, x, x * x]).for_each(|(sum, x)| *sum += x);
        }
    }
    let deviation = |[n, sum, squares]: &[f64; 3]| {
        let mean = sum / n;
        ((squares / n - mean * mean).max(0.0) * n / (n - 1.0).max(1.0)).sqrt()
    };
    sums.iter().map(deviation).collect()
}

/// What a block of features has in common.
#[derive(Clone, Copy)]
struct Common {
    squares: f64,
    count: f64,
    low: f64,
    high: f64,
}

/// How well features are known at best.
struct Agreed {
    blocks: Vec<Block>,
    all: BTreeMap<Block, Common>,
}

impl Agreed {
    fn new(deviation: &[f64], whole: &[f64], blocks: Vec<Block>) -> Self {
        let mut all: BTreeMap<Block, Common> = BTreeMap::new();
        for ((block, x), value) in blocks.iter().zip(deviation).zip(whole).filter(|((_, x), _)| !x.is_nan()) {
            let none = Common { squares: 0.0, count: 0.0, low: f64::INFINITY, high: f64::NEG_INFINITY };
            let own = all.entry(*block).or_insert(none);
            own.squares += x * x;
            own.count += 1.0;
            own.low = own.low.min(*value);
            own.high = own.high.max(*value);
        }
        Agreed { blocks, all }
    }

    /// To what independent programs and sensors agree: a share of a block's range for means, of itself for what is a
    /// logarithm.
    fn least(&self, block: Block) -> f64 {
        match (block, self.all.get(&block)) {
            (Block::Mean(_), Some(own)) => MEANS_AGREE * (own.high - own.low),
            (_, Some(_)) => LOGARITHMS_AGREE,
            (_, None) => 0.0,
        }
    }

    /// No feature is believed better than that, nor much better than the others of its block, as where a wheel never
    /// touches carts agree by chance. NaN stays.
    fn levelled(&self, deviation: &[f64]) -> Vec<f64> {
        let least = |block: Block| {
            let others = self.all.get(&block).map_or(0.0, |own| (own.squares / own.count).sqrt());
            self.least(block).max(LEAST_SHARE * others)
        };
        deviation.iter().zip(&self.blocks).map(|(x, b)| if *x < least(*b) { least(*b) } else { *x }).collect()
    }

    /// The same of all means of a force together.
    fn level(&self) -> Vec<f64> {
        let of = |block: &Block| if matches!(block, Block::Mean(_)) { self.least(*block) } else { 0.0 };
        self.blocks.iter().map(of).collect()
    }
}
