//! The floor: how far apart two honest laps are. Each cart of a simulation is a lap of its own; a simulation with half the step and one
//! from a fresh start say what the computation adds.

use super::model::{Coordinates, Model, Plan};
use super::summary::{Block, Summary};
use crate::dynamics::{Fleet, Settled};
use std::collections::BTreeMap;

/// How features of one cart's lap scatter about those of all carts.
#[derive(Clone, Debug)]
pub struct Floor {
    /// Of each feature over one lap.
    pub deviation: Vec<f64>,
    /// What a single lap's feature is larger by in the mean than that of many laps together.
    pub bias: Vec<f64>,
    /// Each cart's feature less the mean of all.
    pub scatter: Vec<Vec<f64>>,
    /// The mean speed of a lap scatters by, m/s.
    pub speed: f64,
}

/// What a simulation owes to its step and its start rather than to its parameters.
#[derive(Clone, Debug)]
pub struct Numerics {
    /// To be added to what is simulated at the usual step: extrapolated to none, as the integrator is of second order
    /// (Richardson 1911).
    pub correction: Vec<f64>,
    /// By how much features may be off together: half the correction, and what a fresh start does that has had the usual 30 s to
    /// settle, as a measured chain seldom has longer.
    pub doubts: [Vec<f64>; 2],
    /// Mean square of the doubts in a feature's block.
    pub variance: Vec<f64>,
}

/// Time that a measured chain ran before, at least, s.
const RAN_BEFORE: f64 = 30.0;

impl Numerics {
    /// Of a computation without doubts, for so many features.
    pub fn none(features: usize) -> Numerics {
        let none = || vec![0.0; features];
        Numerics { correction: none(), doubts: [none(), none()], variance: none() }
    }

    /// From the features at a point, those with half the step, and those of a fresh start.
    pub fn new(model: &Model, at: &Coordinates, usual: &[f64], from: &Settled, noise: u64) -> Option<Numerics> {
        let passes = 0.5 * model.simulation.chain.carts as f64;
        let finer = Plan { passes, step: Some(0.5 * model.step(at)?), from: Some(from), ..Plan::default() };
        let fresh = Plan { passes, settle: Some(RAN_BEFORE), ..Plan::default() };
        let less = |plan: &Plan| -> Option<Vec<f64>> {
            let features = model.answer(&model.survey(at, plan)?, 0.0, noise).features;
            Some(features.iter().zip(usual).map(|(a, b)| if (a - b).is_nan() { 0.0 } else { a - b }).collect())
        };
        let correction: Vec<f64> = less(&finer)?.into_iter().map(|x| 4.0 / 3.0 * x).collect();
        let doubts = [correction.iter().map(|x| 0.5 * x).collect(), less(&fresh)?];
        let mut blocks: BTreeMap<Block, (f64, f64)> = BTreeMap::new();
        let named = Summary::blocks(&model.recipe.places);
        for (k, block) in named.iter().enumerate() {
            let sum = blocks.entry(*block).or_default();
            *sum = (sum.0 + doubts.iter().map(|d| d[k] * d[k]).sum::<f64>(), sum.1 + 1.0);
        }
        let variance = named.iter().map(|b| blocks.get(b).map_or(0.0, |(sum, n)| sum / n)).collect();
        Some(Numerics { correction, doubts, variance })
    }
}

impl Floor {
    /// From a survey in which every cart went at least once around.
    pub fn new(model: &Model, fleet: &Fleet, noise: u64) -> Floor {
        let each = model.each(fleet, noise);
        let mut all = Summary::new(&model.recipe.places);
        each.iter().for_each(|one| all.merge(one));
        let whole = all.features(1.0);
        let single: Vec<Vec<f64>> = each.iter().map(|one| one.features(1.0)).collect();
        let n = single.len() as f64;
        let column = |k: usize| single.iter().map(move |one| one[k]).filter(|x| !x.is_nan());
        let mean: Vec<f64> =
            (0..whole.len()).map(|k| column(k).sum::<f64>() / column(k).count().max(1) as f64).collect();
        let deviation = (0..whole.len())
            .map(|k| {
                let count = column(k).count();
                let sum: f64 = column(k).map(|x| (x - mean[k]) * (x - mean[k])).sum();
                // A feature that half of the carts lack tells nothing.
                if 2 * count < single.len() { f64::NAN } else { (sum / (count - 1).max(1) as f64).sqrt() }
            })
            .collect();
        let scatter =
            single.iter().map(|one| one.iter().zip(&mean).map(|(x, m)| if x.is_nan() { 0.0 } else { x - m }).collect());
        let speeds: Vec<f64> = each.iter().filter_map(Summary::mean_speed).collect();
        let speed = speeds.iter().sum::<f64>() / n;
        Floor {
            deviation,
            bias: mean.iter().zip(&whole).map(|(m, w)| if (m - w).is_nan() { 0.0 } else { m - w }).collect(),
            scatter: scatter.collect(),
            speed: (speeds.iter().map(|v| (v - speed) * (v - speed)).sum::<f64>() / n).sqrt(),
        }
    }

    /// A survey of a lap at a point.
    pub fn fleet(model: &Model, at: &Coordinates, from: Option<&Settled>) -> Option<Fleet> {
        model.survey(at, &Plan { passes: model.simulation.chain.carts as f64, from, ..Plan::default() })
    }
}
