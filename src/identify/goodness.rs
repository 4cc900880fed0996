//! Goodness of fit: whether what a fit leaves is no more than repeatability allows, and if it is more, in which
//! features and where on the track.
//!
//! The objective's square Q is a mean of squared residuals, each over the variance of replicate laps, so that its mean
//! is 1 where the model is right. Features are correlated, hence Q scatters as χ² of ν degrees of freedom over ν, with
//! ν = tr(C)² / tr(C²) of the covariance C of the scaled features (Satterthwaite 1946). The carts of a simulation are
//! replicate laps and give C.

use super::places::Places;
use super::repeatability::{Numerics, Repeatability};
use crate::base::number::tidy;
use crate::identify::accumulator::Block;
use crate::signal::{Channel, FORCES};
use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The objective of a right model is below the limit so often, as the standard normal quantile: 99 %.
const QUANTILE: f64 = 2.326;

/// What the objective may be over the quantile: it is left to the approximations of a fit and of its variances. Over
/// the campaign of docs/identification.md the right law's objectives go up to 1.12.
const TOLERANCE: f64 = 1.5;

/// A residual over so many deviations is named with its place.
const FAR: f64 = 3.0;

/// Root mean square over the repeatability's above which a kind of feature is named.
const WRONG: f64 = 2.0;

/// Stretches of the track that are named, at most.
const MOST: usize = 6;

/// What repeatability allows an objective to be.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Limit {
    /// The largest objective that passes.
    pub objective: f64,
    /// Effective degrees of freedom of the objective's square.
    pub degrees_of_freedom: f64,
}

/// A stretch of the track on which a force is not what the model says.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Stretch {
    pub channel: String,
    /// `mean` or `spread`.
    pub feature: String,
    /// Arc length, m; a stretch over the start of the lap ends beyond it.
    pub from_m: f64,
    pub to_m: f64,
    /// The largest residual on it over its deviation.
    pub deviations: f64,
}

/// Means of a force along the track, a value a cell.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Profile {
    /// N; none where a cell was not measured.
    pub measured: Vec<Option<f64>>,
    pub simulated: Vec<Option<f64>>,
    /// One standard deviation of the difference by repeatability.
    pub deviation: Vec<Option<f64>>,
}

/// What a fit leaves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Goodness {
    pub limit: Limit,
    /// Where residuals are beyond [`FAR`] deviations, the largest first.
    pub stretches: Vec<Stretch>,
    /// Length of the lap, m.
    pub lap_m: f64,
    /// By channel.
    pub profiles: BTreeMap<String, Profile>,
}

/// Features of a run beside those of its model.
pub(super) struct Left<'a> {
    /// NaN where a feature takes no part.
    pub residual: &'a [f64],
    pub variance: &'a [f64],
    pub predicted: &'a [f64],
    pub passes: &'a [f64],
    pub blocks: &'a [Block],
}

impl Left<'_> {
    /// Residual over deviation.
    fn scaled(&self, k: usize) -> f64 {
        self.residual[k] / self.variance[k].sqrt()
    }

    fn of(&self, block: Block) -> Vec<usize> {
        (0..self.blocks.len()).filter(|k| self.blocks[*k] == block).collect()
    }
}

impl Goodness {
    pub(super) fn new(left: &Left, repeatability: &Repeatability, numerics: &Numerics, places: &Places) -> Goodness {
        let mut stretches = Vec::new();
        let mut profiles = BTreeMap::new();
        for (force, channel) in Channel::FORCES.iter().enumerate().take(FORCES) {
            let (cells, zones) = (left.of(Block::Mean(force)), left.of(Block::Spread(force)));
            let cell = places.lap / places.cells as f64;
            let ends = |i: usize| (i as f64 * cell, (i + 1) as f64 * cell);
            stretches.extend(far(left, &cells, *channel, "mean", &ends));
            stretches.extend(far(left, &zones, *channel, "spread", &|i| (places.zones[i].from, places.zones[i].to)));
            if cells.iter().any(|k| left.residual[*k].is_finite()) {
                profiles.insert(channel.name().to_owned(), Profile::new(left, &cells));
            }
        }
        stretches.sort_by(|a: &Stretch, b| b.deviations.total_cmp(&a.deviations));
        stretches.truncate(MOST);
        stretches.iter_mut().for_each(|s| s.join(places.lap));
        Goodness { limit: limit(left, repeatability, numerics), stretches, lap_m: tidy(places.lap), profiles }
    }
}

impl Stretch {
    /// Over the start of the lap the end is beyond it.
    fn join(&mut self, lap: f64) {
        if self.to_m < self.from_m {
            self.to_m += lap;
        }
        (self.from_m, self.to_m) = (centimetres(self.from_m), centimetres(self.to_m));
    }
}

impl Profile {
    fn new(left: &Left, cells: &[usize]) -> Profile {
        let number = |x: f64| x.is_finite().then_some((x * 1e4).round() / 1e4).map(tidy);
        let all = |of: &dyn Fn(usize) -> f64| cells.iter().map(|k| number(of(*k))).collect();
        Profile {
            measured: all(&|k| left.predicted[k] + left.residual[k]),
            simulated: all(&|k| left.predicted[k]),
            deviation: all(&|k| left.variance[k].sqrt()),
        }
    }
}

fn centimetres(x: f64) -> f64 {
    tidy((100.0 * x).round() / 100.0)
}

/// Neighbouring places whose residuals are far off to one side, as stretches.
fn far(
    left: &Left,
    features: &[usize],
    channel: Channel,
    feature: &str,
    ends: &dyn Fn(usize) -> (f64, f64),
) -> Vec<Stretch> {
    let off: Vec<f64> = features.iter().map(|k| left.scaled(*k)).collect();
    let side = |i: usize| if off[i].abs() > FAR { off[i].signum() } else { 0.0 };
    let mut out: Vec<(f64, Stretch)> = Vec::new();
    for i in (0..off.len()).filter(|i| side(*i) != 0.0) {
        let (from_m, to_m) = ends(i);
        match out.last_mut() {
            Some((sign, last)) if *sign == side(i) && (last.to_m - from_m).abs() < 1e-6 => {
                (last.to_m, last.deviations) = (to_m, last.deviations.max(off[i].abs()));
            }
            _ => {
                let (channel, feature) = (channel.name().to_owned(), feature.to_owned());
                out.push((side(i), Stretch { channel, feature, from_m, to_m, deviations: off[i].abs() }));
            }
        }
    }
    // The lap's last stretch goes on in its first.
    let whole = features.len().checked_sub(1).map_or(0.0, |last| ends(last).1);
    if let ([first, .., last], true) = (&out[..], out.len() > 1)
        && (first.0, first.1.from_m) == (last.0, 0.0)
        && (last.1.to_m - whole).abs() < 1e-6
    {
        let joined =
            Stretch { from_m: last.1.from_m, deviations: first.1.deviations.max(last.1.deviations), ..first.1.clone() };
        out.pop();
        out[0].1 = joined;
    }
    out.into_iter()
        .map(|(_, stretch)| Stretch { deviations: (10.0 * stretch.deviations).round() / 10.0, ..stretch })
        .collect()
}

/// The largest objective that repeatability allows.
fn limit(left: &Left, repeatability: &Repeatability, numerics: &Numerics) -> Limit {
    let rows: Vec<usize> = (0..left.blocks.len()).filter(|k| left.residual[*k].is_finite()).collect();
    let column = |of: &dyn Fn(usize) -> f64| {
        DVector::from_iterator(rows.len(), rows.iter().map(|&k| of(k) / left.variance[k].sqrt()))
    };
    let laps: Vec<DVector<f64>> =
        repeatability.scatter.iter().map(|lap| column(&|k| lap[k] / left.passes[k].sqrt())).collect();
    let common: Vec<DVector<f64>> =
        numerics.discrepancies.iter().map(|discrepancy| column(&|k| discrepancy[k])).collect();
    let degrees_of_freedom = tidy((1e2 * degrees(&laps, &common).clamp(1.0, rows.len().max(1) as f64)).round() / 1e2);
    Limit { objective: tidy(objective(degrees_of_freedom)), degrees_of_freedom }
}

/// The limit for ν degrees of freedom: the root of the quantile of χ²/ν (Wilson and Hilferty 1931), and the tolerance.
pub fn objective(degrees_of_freedom: f64) -> f64 {
    let part = 2.0 / (9.0 * degrees_of_freedom);
    let root = 1.0 - part + QUANTILE * part.sqrt();
    TOLERANCE * (root * root * root).sqrt()
}

/// tr(C)² / tr(C²) of C = S + Σ d dᵀ, with S the covariance that so many laps are drawn from. The square of a
/// covariance that few laps give is too large in the mean, which is taken off (Srivastava 2005, for normal deviates).
pub fn degrees(laps: &[DVector<f64>], common: &[DVector<f64>]) -> f64 {
    let m = laps.len().saturating_sub(1) as f64;
    if m < 2.0 {
        return 1.0;
    }
    let gram = DMatrix::from_fn(laps.len(), laps.len(), |i, j| if j <= i { laps[i].dot(&laps[j]) / m } else { 0.0 });
    let trace = gram.diagonal().sum();
    let square = (0..laps.len())
        .flat_map(|i| (0..=i).map(move |j| (i, j)))
        .fold(0.0, |sum, (i, j)| sum + if i == j { 1.0 } else { 2.0 } * gram[(i, j)] * gram[(i, j)]);
    let square = (m * m / ((m - 1.0) * (m + 2.0)) * (square - trace * trace / m)).max(0.0);
    let along = |d: &DVector<f64>| laps.iter().map(|lap| lap.dot(d) * lap.dot(d)).sum::<f64>() / m;
    let both = common.iter().map(|d| 2.0 * along(d)).sum::<f64>();
    let pairs: f64 = common.iter().flat_map(|a| common.iter().map(move |b| a.dot(b) * a.dot(b))).sum();
    let all = trace + common.iter().map(|d| d.norm_squared()).sum::<f64>();
    let square = square + both + pairs;
    if square > 0.0 { all * all / square } else { 1.0 }
}

/// Whether a kind of feature is far enough off to be named.
pub fn is_wrong(root_mean_square: f64) -> bool {
    root_mean_square > WRONG
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::normal;

    /// Laps of `features` unit normal features, each of which stands `copies` times in the list.
    fn laps(count: usize, features: usize, copies: usize) -> Vec<DVector<f64>> {
        let mut state = 7;
        let one = |_| {
            let own: Vec<f64> = (0..features).map(|_| normal(&mut state)).collect();
            DVector::from_iterator(features * copies, (0..features * copies).map(|k| own[k % features]))
        };
        (0..count).map(one).collect()
    }

    #[test]
    fn degrees_of_freedom_count_independent_features() {
        for (features, copies) in [(60, 1), (60, 8), (300, 2)] {
            let found = degrees(&laps(100, features, copies), &[]);
            assert!((found / features as f64 - 1.0).abs() < 0.15, "{found} for {features}");
        }
        // One direction that has as much variance as all of the features.
        let common = DVector::from_element(60, 1.0);
        assert!(degrees(&laps(100, 60, 1), &[common]) < 5.0);
        assert_eq!(degrees(&[], &[]), 1.0);
    }

    #[test]
    fn the_limit_is_that_of_the_tables_and_the_tolerance() {
        // χ² at 99 %: 23.21 for 10 degrees, 135.81 for 100.
        for (degrees, square) in [(10.0, 2.3209_f64), (100.0, 1.3581)] {
            assert!((objective(degrees) / (TOLERANCE * square.sqrt()) - 1.0).abs() < 3e-3, "{degrees}");
        }
        assert!(objective(1e6) < 1.01 * TOLERANCE);
    }

    #[test]
    fn neighbouring_cells_are_one_stretch_and_the_lap_closes() {
        let off = [4.0, 0.0, -5.0, -7.0, 5.0, f64::NAN, 0.0, 9.0];
        let n = off.len();
        let left = Left {
            residual: &off,
            variance: &vec![1.0; n],
            predicted: &vec![0.0; n],
            passes: &vec![1.0; n],
            blocks: &vec![Block::Mean(4); n],
        };
        let cells: Vec<usize> = (0..n).collect();
        let found = far(&left, &cells, Channel::JointXi, "mean", &|i| (2.0 * i as f64, 2.0 * (i + 1) as f64));
        let told: Vec<_> = found.iter().map(|s| (s.from_m, s.to_m, s.deviations)).collect();
        assert_eq!(told, [(14.0, 2.0, 9.0), (4.0, 8.0, 7.0), (8.0, 10.0, 5.0)]);
        let mut first = found[0].clone();
        first.join(16.0);
        assert_eq!((first.from_m, first.to_m), (14.0, 18.0));
    }
}
