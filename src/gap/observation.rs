//! What the runs say of a hypothesis: residuals over the repeatability, with nuisances and the repeatability's
//! correlations projected out.
//!
//! Of each run the residual is r = y − f − J θ − D b + noise, with nuisances θ under their prior, discrepancies and the
//! strongest common deviations of replicate laps as unit normal b, and noise of variance W⁻¹ a feature. Rows for the
//! priors are put below the features' (augmented least squares, Björck 1996), so that projecting on what [J D] cannot
//! reach leaves what effects must explain.

use super::ids::{Id, PerRun, RunId};
use super::settings::{Observations, Settings};
use super::simulator::{Band, Frame, Laps};
use crate::base::trig;
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use std::collections::BTreeMap;

/// A run made ready.
pub struct Observation {
    /// Features that are used.
    rows: Vec<usize>,
    weights: Vec<f64>,
    /// Orthonormal columns of what nuisances, discrepancies and modes reach, with the priors' rows below.
    reach: DMatrix<f64>,
    /// From projections to steps: the triangle of J = Q R.
    triangle: DMatrix<f64>,
    nuisances: usize,
    /// Of their steps.
    bounds: Vec<(f64, f64)>,
    /// How many rows of priors are those of nuisances and discrepancies, and how many of what is within the as-built
    /// tolerance.
    shared: (usize, usize),
    /// Of the residual's covariance by nuisances, discrepancies, modes and what is within the as-built tolerance, over
    /// that of noise alone.
    log_determinant: f64,
    /// Residual of the nominal model that nothing of this reaches.
    pub residual: DVector<f64>,
    /// The same before projection.
    raw: DVector<f64>,
    /// Mean square of replicate laps' residuals, and the largest of 95 % of them.
    pub replicate: f64,
    pub replicate_high: f64,
    /// Replicate laps, chains as they are built, and what is within the as-built tolerance, projected.
    laps: Vec<DVector<f64>>,
    built: Vec<DVector<f64>>,
    as_built: Vec<DVector<f64>>,
    /// As many independent features have mean squares that scatter as much as replicate laps' do.
    pub degrees_of_freedom: f64,
    /// Mean square of what is within the as-built tolerance, and by what those of replicate laps are multiplied, as the
    /// variances hold discrepancies that laps of one simulation do not have.
    drawn: (f64, f64),
}

impl Observation {
    /// From a frame and what every built machine deviates by, each of unit variance.
    pub fn new(frame: &Frame, as_built: &[Vec<f64>], settings: &Settings) -> Observation {
        Observation::with(frame, as_built, &frame.laps, settings)
    }

    /// Before other laps than the frame's.
    pub fn with(frame: &Frame, as_built: &[Vec<f64>], laps: &Laps, settings: &Settings) -> Observation {
        let residual = frame.residual(&frame.nominal);
        let rows: Vec<usize> =
            (0..residual.len()).filter(|k| residual[*k].is_finite() && frame.labels[*k].band != Band::Impact).collect();
        let (weights, replicate, common) = factors(frame, &rows, laps, &settings.observations);
        let white = |x: &[f64]| whitened(&rows, &weights, x);
        let (n, p) = (rows.len(), frame.nuisances.len());
        // Mean squares score features as if there were few; what is within the as-built tolerance is known as it is, so
        // that it is not to be had for nothing.
        let strict = (n as f64 / settings.likelihood.degrees_of_freedom).max(1.0).sqrt();
        let visible = |of: &[Vec<f64>]| -> Vec<DVector<f64>> {
            of.iter().map(|d| white(d)).filter(|d| d.norm_squared() > 1e-12).collect()
        };
        let discrepancies = visible(&frame.discrepancies);
        // All of them, so that each is the same in every run.
        let as_built: Vec<DVector<f64>> = as_built.iter().map(|d| white(d)).collect();
        let shared = (p + discrepancies.len(), as_built.len());
        let known = discrepancies.into_iter().chain(common).map(|column| (column, 1.0));
        let unit: Vec<(DVector<f64>, f64)> = known.chain(as_built.iter().map(|d| (d.clone(), strict))).collect();
        let columns = p + unit.len();
        let mut reach = DMatrix::zeros(n + columns, columns);
        for j in 0..p {
            reach.view_mut((0, j), (n, 1)).copy_from(&white(&slope(frame, j)));
            reach[(n + j, j)] = 1.0 / frame.prior[j].1;
        }
        for (j, (column, weight)) in unit.iter().enumerate() {
            reach.view_mut((0, p + j), (n, 1)).copy_from(column);
            reach[(n + p + j, p + j)] = *weight;
        }
        let priors: f64 = frame.prior.iter().map(|(_, own)| -trig::ln(*own)).sum::<f64>()
            + unit.iter().map(|(_, weight)| trig::ln(*weight)).sum::<f64>();
        let (reach, triangle) = reach.qr().unpack();
        let diagonal = triangle.diagonal();
        let log_determinant = 2.0 * (diagonal.iter().map(|x| trig::ln(x.abs().max(1e-300))).sum::<f64>() - priors);
        let mut raw = DVector::zeros(n + columns);
        raw.rows_mut(0, n).copy_from(&white(&residual));
        for j in 0..p {
            raw[n + j] = frame.prior[j].0 / frame.prior[j].1;
        }
        let mut out = Observation {
            rows,
            weights,
            residual: &raw - &reach * (reach.transpose() * &raw),
            raw,
            reach,
            triangle,
            nuisances: p,
            bounds: frame.bounds.clone(),
            shared,
            log_determinant,
            replicate: 1.0,
            replicate_high: 1.0,
            laps: Vec::new(),
            built: Vec::new(),
            as_built: Vec::new(),
            degrees_of_freedom: n as f64,
            drawn: (0.0, 1.0),
        };
        out.laps = replicate.iter().map(|lap| out.projected(lap)).collect();
        out.built = frame.built.iter().map(|change| out.column(change)).collect();
        out.as_built = as_built.iter().map(|change| out.projected(change)).collect();
        out.find_repeatability();
        out
    }

    /// How replicate laps' mean squares scatter, with what is within the as-built tolerance beside.
    fn find_repeatability(&mut self) {
        let n = self.rows.len().max(1) as f64;
        let mut squares: Vec<f64> = self.laps.iter().map(|lap| lap.norm_squared() / n).collect();
        let built = self.as_built.iter().map(|change| change.norm_squared() / n).sum::<f64>();
        if squares.len() < 4 {
            return;
        }
        squares.sort_by(f64::total_cmp);
        let count = squares.len() as f64;
        let mean = squares.iter().sum::<f64>() / count;
        let variance = squares.iter().map(|s| (s - mean) * (s - mean)).sum::<f64>() / (count - 1.0);
        let scale = mean.max(1.0) / mean.max(1e-9);
        self.replicate = mean.max(1.0) + built;
        self.drawn = (built, scale);
        self.replicate_high = built + scale * squares[((0.95 * count) as usize).min(squares.len() - 1)];
        // χ² of f degrees of freedom over f has the variance 2/f.
        self.degrees_of_freedom = (2.0 * mean * mean / variance.max(1e-12)).clamp(n.min(4.0), n);
    }

    /// Whitened features, projected.
    fn projected(&self, features: &DVector<f64>) -> DVector<f64> {
        let mut long = DVector::zeros(self.raw.len());
        long.rows_mut(0, features.len()).copy_from(features);
        self.project(&long)
    }

    fn project(&self, long: &DVector<f64>) -> DVector<f64> {
        long - &self.reach * (self.reach.transpose() * long)
    }

    /// A change of the features as a column that effects are fitted with.
    pub fn column(&self, change: &[f64]) -> DVector<f64> {
        self.project(&self.long(change))
    }

    /// How far replicate laps lie along a direction, what chains as they are built, and each as-built deviation.
    pub fn along(&self, direction: &DVector<f64>) -> [Vec<f64>; 3] {
        [&self.laps, &self.built, &self.as_built].map(|list| list.iter().map(|x| direction.dot(x)).collect())
    }

    /// A change of the features as it is, whitened.
    pub fn long(&self, change: &[f64]) -> DVector<f64> {
        let mut long = DVector::zeros(self.raw.len());
        long.rows_mut(0, self.rows.len()).copy_from(&whitened(&self.rows, &self.weights, change));
        long
    }

    /// Steps of the nuisances that fit best, once effects have changed the features.
    pub fn steps(&self, change: &[f64]) -> Vec<f64> {
        let left = self.reach.transpose() * (&self.raw - self.long(change));
        let found = self.triangle.solve_upper_triangular(&left);
        found.map_or_else(|| vec![0.0; self.nuisances], |x| x.rows(0, self.nuisances).iter().copied().collect())
    }

    /// The same steps as far as they can be simulated.
    pub fn nuisance_offsets(&self, change: &[f64]) -> Vec<f64> {
        self.steps(change).iter().zip(&self.bounds).map(|(x, (low, high))| x.clamp(*low, *high)).collect()
    }

    /// How many features are used.
    pub fn features(&self) -> usize {
        self.rows.len()
    }

    /// A projected column of the same run and features with other weights and modes, in these.
    pub fn carried(&self, from: &Observation, column: &DVector<f64>) -> DVector<f64> {
        let mut long = DVector::zeros(self.raw.len());
        let features = self.rows.len();
        for (k, (own, other)) in self.weights.iter().zip(&from.weights).enumerate() {
            long[k] = column[k] * own / other;
        }
        // Of the priors' rows, modes are each one's own.
        let first = self.shared.0.min(from.shared.0);
        long.rows_mut(features, first).copy_from(&column.rows(features, first));
        let last = self.shared.1.min(from.shared.1);
        let (own, other) = (long.len() - last, column.len() - last);
        long.rows_mut(own, last).copy_from(&column.rows(other, last));
        self.project(&long)
    }

    /// Logarithm of the determinant of the residual's covariance over that of another, for each feature.
    pub fn raised(&self, from: &Observation) -> f64 {
        let each = self.weights.iter().zip(&from.weights).map(|(own, other)| 2.0 * trig::ln(other / own));
        (each.sum::<f64>() + self.log_determinant - from.log_determinant) / self.weights.len().max(1) as f64
    }

    /// Mean square of a projected residual over that of replicate laps.
    pub fn mean_square(&self, residual: &DVector<f64>) -> f64 {
        residual.norm_squared() / self.rows.len().max(1) as f64 / self.replicate
    }

    /// Replicate laps, projected.
    pub fn laps(&self) -> &[DVector<f64>] {
        &self.laps
    }

    /// Mean square of a replicate lap over that of all, with what is within the as-built tolerance beside.
    pub fn mean_square_of_lap(&self, lap: &DVector<f64>) -> f64 {
        let (built, scale) = self.drawn;
        (built + scale * lap.norm_squared() / self.rows.len().max(1) as f64) / self.replicate
    }

    /// Each used feature's projected residual, over its deviation.
    pub fn each<'a>(&'a self, residual: &'a DVector<f64>) -> impl Iterator<Item = (usize, f64)> + 'a {
        self.rows.iter().copied().zip(residual.iter().copied())
    }
}

/// The run of which most is left, for what it can tell.
pub fn most_off<'a>(observations: &PerRun<Observation>, left: impl IntoIterator<Item = &'a DVector<f64>>) -> RunId {
    let off = observations
        .iter()
        .zip(left)
        .map(|(observation, left)| observation.degrees_of_freedom * observation.mean_square(left));
    observations.ids().zip(off).max_by(|a, b| a.1.total_cmp(&b.1)).map_or(Id::new(0), |(run, _)| run)
}

/// How much laps have in common over the runs, each a residual a run: their mean correlation, feature by feature; 0
/// where features are not the same.
pub fn in_common(frames: &PerRun<Frame>, observations: &PerRun<Observation>, laps: &[PerRun<DVector<f64>>]) -> f64 {
    let (mut along, mut size) = (0.0, 0.0);
    for lap in laps {
        let each: PerRun<BTreeMap<usize, f64>> =
            observations.iter().zip(lap).map(|(o, r)| o.each(r).collect()).collect();
        for b in each.ids() {
            for a in each.ids().take_while(|a| *a < b).filter(|a| frames[*a].labels == frames[b].labels) {
                let both = || each[a].iter().filter_map(|(k, x)| Some((*x, *each[b].get(k)?)));
                let sum = |of: fn((f64, f64)) -> f64| both().map(of).sum::<f64>();
                along += sum(|(x, y)| x * y);
                size += (sum(|(x, _)| x * x) * sum(|(_, y)| y * y)).sqrt();
            }
        }
    }
    if size > 0.0 { along / size } else { 0.0 }
}

/// What a nuisance changes of each feature.
fn slope(frame: &Frame, nuisance: usize) -> Vec<f64> {
    frame.slopes.column(nuisance).iter().copied().collect()
}

/// Features over their deviations; 0 of what is not known.
fn whitened(rows: &[usize], weights: &[f64], features: &[f64]) -> DVector<f64> {
    let each = rows.iter().zip(weights).map(|(&k, w)| if features[k].is_finite() { features[k] * w } else { 0.0 });
    DVector::from_iterator(rows.len(), each)
}

/// Weights of features by what laps scatter of their own, the laps with these weights, and what they have in common:
/// modes and a variance of each feature that is none of theirs, in turns (principal factors, Harman 1976), and no less
/// than the frame's. An effect by which laps scatter in a few ways only explains nothing in others.
fn factors(
    frame: &Frame,
    rows: &[usize],
    laps: &Laps,
    settings: &Observations,
) -> (Vec<f64>, Vec<DVector<f64>>, Vec<DVector<f64>>) {
    let mut own: Vec<f64> = rows.iter().map(|&k| laps.variance[k]).collect();
    let raised = rows.iter().any(|&k| laps.variance[k] > frame.laps.variance[k]);
    let mut turns = if raised { settings.factor_rounds } else { 0 };
    loop {
        let weights = tolerant(frame, rows, own.iter().map(|variance| 1.0 / variance.sqrt()).collect());
        let replicate: Vec<DVector<f64>> = laps.scatter.iter().map(|lap| whitened(rows, &weights, lap)).collect();
        let common = modes(&replicate, if raised { replicate.len() } else { settings.modes }, settings.mode_variance);
        if turns == 0 {
            return (weights, replicate, common);
        }
        turns -= 1;
        for (i, (&k, weight)) in rows.iter().zip(&weights).enumerate() {
            let shared = common.iter().map(|mode| mode[i] * mode[i]).sum::<f64>() / (weight * weight);
            own[i] = (laps.variance[k] - shared).max(frame.laps.variance[k]);
        }
    }
}

/// Weights that expect of each feature what chains as they are built deviate by, once nuisances are at their best.
fn tolerant(frame: &Frame, rows: &[usize], weights: Vec<f64>) -> Vec<f64> {
    let (n, p) = (rows.len(), frame.nuisances.len());
    if frame.built.is_empty() {
        return weights;
    }
    let mut reach = DMatrix::zeros(n + p, p);
    for j in 0..p {
        reach.view_mut((0, j), (n, 1)).copy_from(&whitened(rows, &weights, &slope(frame, j)));
        reach[(n + j, j)] = 1.0 / frame.prior[j].1;
    }
    let reach = reach.qr().q();
    let mut squares = vec![0.0; n];
    for change in &frame.built {
        let mut long = DVector::zeros(n + p);
        long.rows_mut(0, n).copy_from(&whitened(rows, &weights, change));
        let left = &long - &reach * (reach.transpose() * &long);
        squares.iter_mut().zip(left.iter()).for_each(|(sum, x)| *sum += x * x / frame.built.len() as f64);
    }
    weights.into_iter().zip(squares).map(|(w, square)| w / (1.0 + square).sqrt()).collect()
}

/// The strongest common deviations of replicate laps beyond what each feature has of its own, each of unit variance.
///
/// Few laps of many features have strong directions by chance: what stands out is beyond the edge of the spectrum of
/// noise (Marchenko and Pastur 1967), and its variance without what chance adds to it (Paul 2007, spiked covariance).
/// None has less than `least` times the variance of a feature's own.
fn modes(laps: &[DVector<f64>], most: usize, least: f64) -> Vec<DVector<f64>> {
    let count = laps.len();
    if count < 8 {
        return Vec::new();
    }
    let features = laps[0].len().max(1) as f64;
    let ratio = features / (count - 1) as f64;
    // Eigenvectors of the features' covariance from those of the laps' products.
    let products = DMatrix::from_fn(count, count, |i, j| laps[i].dot(&laps[j]) / (count - 1) as f64);
    let eigen = SymmetricEigen::new(products);
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
    let mut rest = eigen.eigenvalues.sum();
    let mut found = Vec::new();
    for k in order.into_iter().take(most) {
        let seen = eigen.eigenvalues[k];
        rest -= seen;
        let own = (rest / features).max(1e-12);
        let variance = own * spike(seen / own, ratio);
        if variance < least {
            break;
        }
        let mut mode = DVector::zeros(laps[0].len());
        for (lap, share) in laps.iter().zip(eigen.eigenvectors.column(k).iter()) {
            mode += lap * *share;
        }
        let norm = mode.norm().max(1e-300);
        found.push(mode * ((variance - own).sqrt() / norm));
    }
    found
}

/// Variance along a direction, over that of noise, whose sample's eigenvalue is so many times the noise's, with so many
/// features for each lap; 1 of what noise has.
fn spike(seen: f64, ratio: f64) -> f64 {
    let edge = (1.0 + ratio.sqrt()) * (1.0 + ratio.sqrt());
    if seen <= edge {
        return 1.0;
    }
    let sum = seen + 1.0 - ratio;
    0.5 * (sum + (sum * sum - 4.0 * seen).max(0.0).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::random::normal;

    #[test]
    fn what_scatters_one_way_explains_nothing_across_it() {
        let (features, laps) = (200, 80);
        let mut state = 5;
        let mut noise = |n: usize| (0..n).map(|_| normal(&mut state)).collect::<Vec<f64>>();
        // Twenty features go up and down together, with a variance of 5 each.
        let way = |k: usize| if k < 20 { 5.0_f64.sqrt() } else { 0.0 };
        let measured = noise(features);
        let frame = Frame::bare(measured, (0..laps).map(|_| noise(features)).collect());
        let lap = |lap: &Vec<f64>, share: f64| lap.iter().enumerate().map(|(k, x)| x + share * way(k)).collect();
        let shares = noise(laps);
        let own = shares.iter().map(|share| share * share).sum::<f64>() / laps as f64;
        let scatter = frame.laps.scatter.iter().zip(shares).map(|(one, share)| lap(one, share)).collect();
        let with = Laps { variance: (0..features).map(|k| 1.0 + own * way(k) * way(k)).collect(), scatter };
        let own = Observation::with(&frame, &[], &with, &Settings::default());
        let along: Vec<f64> = (0..features).map(way).collect();
        let across: Vec<f64> = (0..features).map(|k| if k % 2 == 0 { way(k) } else { -way(k) }).collect();
        let seen = own.column(&across).norm_squared() / 100.0;
        // A sixth of it, were each feature's variance its own.
        assert!((seen - 1.0).abs() < 0.15, "{seen}");
        // 100 over its variance of 1 + 100, and 2.5 as so few laps tell a direction within sin² = 200/80/100 (Paul
        // 2007).
        let seen = own.column(&along).norm_squared();
        assert!((1.0..6.0).contains(&seen), "{seen}");
        // ln det of what noise has with one direction of a variance of 100; 36 more, were each feature's variance its
        // own.
        let more = own.raised(&Observation::new(&frame, &[], &Settings::default())) * features as f64 - trig::ln(101.0);
        assert!((-1.0..4.0).contains(&more), "{more}");
    }

    #[test]
    fn what_scatters_in_many_ways_explains_nothing_but_these() {
        let (features, laps, ways) = (600, 64, 25);
        let mut state = 9;
        let mut noise = |n: usize| (0..n).map(|_| normal(&mut state)).collect::<Vec<f64>>();
        // Each as large as all noise; together they give a feature 26 times its variance.
        let patterns: Vec<Vec<f64>> = (0..=ways).map(|_| noise(features)).collect();
        let mut lap = |known: &[Vec<f64>]| {
            let shares = noise(known.len());
            let more = |sum: Vec<f64>, (p, x): (&Vec<f64>, f64)| sum.iter().zip(p).map(|(s, p)| s + x * p).collect();
            known.iter().zip(shares).fold(noise(features), more)
        };
        let replicate: Vec<Vec<f64>> = (0..laps).map(|_| lap(&[])).collect();
        let scatter: Vec<Vec<f64>> = (0..laps).map(|_| lap(&patterns[..ways])).collect();
        let spread = |k: usize| 1.0 + patterns[..ways].iter().map(|p| p[k] * p[k]).sum::<f64>();
        let with = Laps { variance: (0..features).map(spread).collect(), scatter };
        let frame = Frame::bare(lap(&[]), replicate);
        let own = Observation::with(&frame, &[], &with, &Settings::default());
        let left = |change: &[f64]| own.column(change).norm_squared() / features as f64;
        let (one_of_them, another) = (left(&lap(&patterns[..ways])), lap(&[]));
        let stranger: Vec<f64> = another.iter().zip(&patterns[ways]).map(|(x, p)| x + 5.0 * p).collect();
        assert!(one_of_them < 2.0 && left(&stranger) > 5.0 * one_of_them);
    }

    #[test]
    fn a_common_deviation_is_told_from_what_few_laps_have_by_chance() {
        let (laps, features) = (64, 600);
        let mut state = 3;
        let mut random = |n: usize| DVector::from_iterator(n, (0..n).map(|_| normal(&mut state)));
        let noise: Vec<DVector<f64>> = (0..laps).map(|_| random(features)).collect();
        assert!(modes(&noise, 10, 3.0).is_empty());
        // One direction in which laps differ with a variance of 40.
        let common = random(features).normalize();
        let shares = random(laps);
        let with = noise.iter().zip(shares.iter()).map(|(lap, share)| lap + &common * (*share * 40.0_f64.sqrt()));
        let found = modes(&with.collect::<Vec<_>>(), 10, 3.0);
        assert_eq!(found.len(), 1);
        // The variance that these laps happen to have, of which chance would make a sixth too much.
        let expected = 40.0 * shares.norm_squared() / (laps - 1) as f64;
        let variance = found[0].norm_squared();
        assert!((variance / expected - 1.0).abs() < 0.1, "{variance} for {expected}");
        let cosine = found[0].normalize().dot(&common).abs();
        assert!(cosine > 0.85, "{cosine}");
    }
}
