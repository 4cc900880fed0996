//! A fitted run as the diagnosis sees it: what its features are about, the repeatability, discrepancies, and slopes by
//! the nuisances.

use super::FittedRun;
use crate::gap::simulator::{Band, Frame, Label, Laps};
use crate::identify::Parameter;
use crate::identify::accumulator::Block;
use crate::identify::local::WITH_FLOOR;
use crate::signal::{Channel, FORCES};
use nalgebra::DMatrix;
use std::collections::BTreeMap;

/// The run as the diagnosis sees it, but for impacts; the chain's speed is the last feature.
pub fn frame(name: &str, run: &FittedRun) -> Frame {
    let landing = &run.landing;
    let rounding = run.settings.ensembles.rounding;
    let mut labels = labels(run);
    labels.push(Label { channel: "speed".into(), band: Band::Drift, index: 0, from: 0, to: lap_mm(run) });
    let (speed, deviation) = landing.speed.unwrap_or((0.0, f64::INFINITY));
    let simulated = landing.centre.answer.speed;
    let with = |list: &[f64], last: f64| list.iter().copied().chain([last]).collect::<Vec<f64>>();
    let mut discrepancies: Vec<Vec<f64>> = landing.numerics.discrepancies.iter().map(|d| with(d, 0.0)).collect();
    for force in 0..FORCES {
        let level =
            |k: usize| if landing.blocks[k] == Block::Mean(force) { landing.repeatability.level[k] } else { 0.0 };
        discrepancies.push(with(&(0..landing.blocks.len()).map(level).collect::<Vec<f64>>(), 0.0));
    }
    let reach = |j: usize| Parameter::ALL.get(j).map_or(crate::identify::FLOOR_SCALE, |p| p.reach());
    let slopes = &landing.sensitivity.slopes;
    Frame {
        run: name.to_owned(),
        labels,
        measured: with(&landing.measured, simulated + speed),
        nominal: with(&landing.nominal, simulated),
        laps: Laps {
            variance: with(&landing.variance, deviation * deviation)
                .into_iter()
                .map(|v| telling(v, rounding))
                .collect(),
            scatter: scatter(run, &landing.repeatability.scatter),
        },
        discrepancies,
        built: Vec::new(),
        slopes: DMatrix::from_fn(slopes.nrows(), WITH_FLOOR, |i, j| slopes[(i, j)] * reach(j)),
        prior: (0..WITH_FLOOR).map(|j| prior(run, j)).collect(),
        bounds: (0..WITH_FLOOR).map(|j| bounds(run, j)).collect(),
        nuisances: Parameter::ALL.iter().map(|p| p.name().to_owned()).chain(["approach_floor".to_owned()]).collect(),
    }
}

/// Deviations of single laps as those of as many passes as each feature is a mean over.
pub fn scatter(run: &FittedRun, single: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let roots: Vec<f64> = run.landing.passes.iter().map(|passes| passes.sqrt()).collect();
    let each = |lap: &Vec<f64>| lap.iter().zip(&roots).map(|(x, root)| x / root).chain([0.0]).collect();
    single.iter().map(each).collect()
}

/// A variance; infinite of what no lap changes but for a deviation of rounding, as the share of time above a force that
/// is never reached.
fn telling(variance: f64, rounding: f64) -> f64 {
    if variance < rounding * rounding { f64::INFINITY } else { variance }
}

/// Of a nuisance's step from where the fit ended.
fn prior(run: &FittedRun, j: usize) -> (f64, f64) {
    let Some(p) = Parameter::ALL.get(j) else {
        return (0.0, run.settings.ensembles.approach_floor_deviation / crate::identify::FLOOR_SCALE);
    };
    let (mean, deviation) = p.prior(run.model.law, run.model.nominal[j]);
    ((mean - run.landing.at[j]) / p.reach(), deviation / p.reach())
}

/// Of a nuisance's step: within its range, and no farther than slopes were taken.
fn bounds(run: &FittedRun, j: usize) -> (f64, f64) {
    let Some(p) = Parameter::ALL.get(j) else { return (-1.0, 1.0) };
    let (low, high) = run.model.range(*p);
    let share = |x: f64| ((x - run.landing.at[j]) / p.reach()).clamp(-1.0, 1.0);
    (share(low), share(high))
}

fn lap_mm(run: &FittedRun) -> i64 {
    (1e3 * run.model.spec.places.lap).round() as i64
}

fn labels(run: &FittedRun) -> Vec<Label> {
    let places = &run.model.spec.places;
    let mut counted: BTreeMap<Block, usize> = BTreeMap::new();
    let lap = lap_mm(run);
    let mm = |x: f64| (1e3 * x).round() as i64;
    let one = |block: &Block| {
        let count = counted.entry(*block).or_default();
        let index = *count;
        *count += 1;
        let (force, band, from, to) = match *block {
            Block::Mean(f) | Block::Local(f) => {
                let cell = places.lap / places.cells as f64;
                let band = if matches!(block, Block::Mean(_)) { Band::Track } else { Band::Fluctuation };
                (f, band, mm(cell * index as f64), mm(cell * (index + 1) as f64))
            }
            Block::Spread(f) => {
                let zone = places.zones.get(index).map_or((0.0, places.lap), |z| (z.from, z.to));
                (f, Band::Fluctuation, mm(zone.0), mm(zone.1))
            }
            Block::Share(f) => (f, Band::Distribution, 0, lap),
            Block::Power(f) => (f, Band::Cart, 0, lap),
            Block::Order(f) => (f, run.orders.get(index).copied().unwrap_or(Band::Motor), 0, lap),
            Block::SpeedPower => (FORCES, Band::Drift, 0, lap),
        };
        let channel = Channel::FORCES.get(force).map_or("speed", |c| c.name());
        Label { channel: channel.to_owned(), band, index, from, to }
    };
    run.landing.blocks.iter().map(one).collect()
}
