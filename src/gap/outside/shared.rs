//! Nuisances that all runs share: one value for the whole campaign, fitted to all runs together with each run's own.
//!
//! With parameters θ of all runs and φᵣ of run r, Gauss and Newton's method minimises Σᵣ |Wᵣ (yᵣ − fᵣ(θ, φᵣ))|² plus the
//! priors, within the bounds. Slopes are corrected by what steps were found to change (Broyden 1965).

use super::data::RunPart;
use super::{Error, Outside};
use crate::base::parallel;
use crate::gap::{Applied, Frame, Label, RunId};
use crate::identify::mode_within;
use nalgebra::{DMatrix, DVector};
use std::sync::{Arc, PoisonError};

/// All runs fitted together.
pub(super) struct Joint {
    /// Of each run, all nuisances.
    pub at: Vec<Vec<f64>>,
    pub features: Vec<Vec<f64>>,
    /// Of each nuisance that is shared, its deviation; 0 of others.
    pub deviation: Vec<f64>,
    /// Squares of what is left over the noise, and of what moves the nuisances from before the runs.
    pub cost: f64,
}

/// Where a search is.
struct Point {
    at: Vec<Vec<f64>>,
    features: Vec<Vec<f64>>,
    /// Residuals over their deviations.
    left: Vec<DVector<f64>>,
    cost: f64,
}

impl Outside {
    /// Which nuisances all runs share.
    pub(super) fn shared(&self) -> Vec<bool> {
        self.description.nuisances.iter().map(|n| n.shared).collect()
    }

    pub(super) fn has_shared(&self) -> bool {
        self.description.nuisances.iter().any(|n| n.shared)
    }

    /// The same point with the shared nuisances of all runs at their mean.
    pub(super) fn at_mean(&self, each: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let mean = |k: usize| each.iter().map(|at| at[k]).sum::<f64>() / each.len().max(1) as f64;
        let means: Vec<Option<f64>> = self.shared().iter().enumerate().map(|(k, s)| s.then(|| mean(k))).collect();
        let with = |at: &Vec<f64>| at.iter().zip(&means).map(|(own, mean)| mean.unwrap_or(*own)).collect();
        each.iter().map(with).collect()
    }

    /// The features of a run with effects and all nuisances fitted, those that are shared to all runs together.
    pub(super) fn jointly(&self, run: RunId, effects: &[Applied]) -> Result<Vec<f64>, Error> {
        let key = format!("{effects:?}");
        let memo = || self.joint.lock().unwrap_or_else(PoisonError::into_inner);
        let known = memo().get(&key).cloned();
        let all = known.unwrap_or_else(|| {
            let enough = self.settings.fitting.along_enough;
            let found = Arc::new(self.fit_jointly(effects, self.fitted.to_vec(), enough).map(|joint| joint.features));
            memo().insert(key, found.clone());
            found
        });
        match &*all {
            Ok(features) => {
                let index = self.parts.ids().position(|other| other == run);
                Ok(index.and_then(|k| features.get(k)).cloned().unwrap_or_default())
            }
            Err(error) => Err(error.clone()),
        }
    }

    /// Fits all runs together while a step promises to leave a share of the squares less.
    pub(super) fn fit_jointly(&self, effects: &[Applied], at: Vec<Vec<f64>>, enough: f64) -> Result<Joint, Error> {
        let begin = if effects.is_empty() { vec![self.nominal_start(); at.len()] } else { at.clone() };
        let joint = self.fit_until(1.0, effects, at, enough)?;
        if self.went_astray_jointly(effects, &joint) {
            self.grown_jointly(effects, joint, begin, enough)
        } else {
            Ok(joint)
        }
    }

    /// The same to each run's first share.
    pub(super) fn fit_until(
        &self,
        until: f64,
        effects: &[Applied],
        at: Vec<Vec<f64>>,
        enough: f64,
    ) -> Result<Joint, Error> {
        let mut now = self.point(effects, at, until)?;
        // Those of the nominal model do to begin with.
        let mut slopes = match effects {
            [_, ..] if until >= 1.0 => self.nominal_slopes()?,
            _ => self.slopes_at(effects, &now, until),
        };
        // Corrected slopes mislead at last; where more than the noise is left they are taken anew, once.
        let noise = now.left.iter().flat_map(|left| left.iter()).filter(|x| **x != 0.0).count() as f64;
        let mut renewed = false;
        for round in 0..self.settings.fitting.steps {
            let (a, g, index) = self.normal(&now, &slopes);
            let range: Vec<(f64, f64)> =
                index.iter().map(|(run, k)| (-now.at[*run][*k], 1.0 - now.at[*run][*k])).collect();
            let step = mode_within(&a, &g, &range, &mut vec![None; range.len()], 1e-12).0;
            let gain = 2.0 * g.dot(&step) - (&a * &step).dot(&step);
            // One step is always made with effects, as a small effect's trace is small against all that is left.
            let promises = gain >= enough * now.cost || (round == 0 && !effects.is_empty());
            let better = if promises { self.along(effects, &now, &step, &mut slopes, until) } else { None };
            match better {
                Some(next) => now = next,
                None if !renewed && now.cost > noise && (round > 0 || !effects.is_empty()) => {
                    slopes = self.slopes_at(effects, &now, until);
                    renewed = true;
                }
                None => break,
            }
        }
        let (a, _, index) = self.normal(&now, &slopes);
        let inverse = a.try_inverse();
        let shared = self.shared();
        let deviation = shared.iter().enumerate().map(|(k, shared)| {
            let own = index.iter().position(|(_, other)| *shared && *other == k);
            own.zip(inverse.as_ref()).map_or(0.0, |(i, inverse)| inverse[(i, i)].max(0.0).sqrt())
        });
        Ok(Joint { deviation: deviation.collect(), at: now.at, features: now.features, cost: now.cost })
    }

    /// Goes along a step as far as that fits better, and corrects the slopes by what each try was found to change.
    fn along(
        &self,
        effects: &[Applied],
        now: &Point,
        step: &DVector<f64>,
        slopes: &mut [DMatrix<f64>],
        until: f64,
    ) -> Option<Point> {
        let mut share = 1.0;
        while share > 0.05 {
            let at = self.moved(&now.at, &(step * share));
            share *= 0.3;
            let Ok(next) = self.point(effects, at, until) else { continue };
            for (r, slopes) in slopes.iter_mut().enumerate() {
                let by =
                    DVector::from_iterator(next.at[r].len(), next.at[r].iter().zip(&now.at[r]).map(|(a, b)| a - b));
                let missed = (&now.left[r] - &next.left[r]) - &*slopes * &by;
                *slopes += missed * by.transpose() / by.norm_squared().max(1e-300);
            }
            if next.cost < now.cost {
                return Some(next);
            }
        }
        None
    }

    /// Slopes of the nominal model where it is fitted.
    fn nominal_slopes(&self) -> Result<Vec<DMatrix<f64>>, Error> {
        let known = || self.slopes.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(slopes) = known().clone() {
            return Ok(slopes);
        }
        let slopes = self.slopes_at(&[], &self.point(&[], self.fitted.to_vec(), 1.0)?, 1.0);
        known().replace(slopes.clone());
        Ok(slopes)
    }

    /// All runs simulated, as features, of which each run's first share counts.
    fn point(&self, effects: &[Applied], at: Vec<Vec<f64>>, until: f64) -> Result<Point, Error> {
        let each: Vec<(usize, RunId)> = self.parts.ids().enumerate().collect();
        let answers = parallel::map(&each, self.pool.most(), |(k, run)| self.features_at(*run, &at[*k], effects));
        let features = answers.into_iter().collect::<Result<Vec<_>, Error>>()?;
        let left: Vec<DVector<f64>> =
            self.frames.iter().zip(&features).map(|(frame, f)| left(frame, f, until)).collect();
        let start = self.nominal_start();
        let prior = self.settings.fitting.prior;
        let off = |at: &Vec<f64>| at.iter().zip(&start).map(|(a, b)| (a - b) * (a - b)).sum::<f64>() / (prior * prior);
        let cost = left.iter().map(DVector::norm_squared).sum::<f64>() + at.iter().map(off).sum::<f64>();
        Ok(Point { at, features, left, cost })
    }

    /// Features of a run with all nuisances given, where they can be compared.
    pub(super) fn features_at(&self, run: RunId, at: &[f64], effects: &[Applied]) -> Result<Vec<f64>, Error> {
        let part: &RunPart = &self.parts[run];
        let features = self.windows[run].means(&self.ask(part, at, effects)?);
        let frame = &self.frames[run];
        match frame.lacking(&features, self.may_lack) {
            0 => Ok(features),
            lacking => Err(Error::NotFinite { lacking, of: frame.labels.len() }),
        }
    }

    /// Of each run the change of weighted features with each nuisance, by differences to the inner side.
    fn slopes_at(&self, effects: &[Applied], now: &Point, until: f64) -> Vec<DMatrix<f64>> {
        let difference = self.settings.fitting.difference;
        let count = self.description.nuisances.len();
        let runs = self.parts.ids().enumerate();
        let each: Vec<(usize, RunId, usize)> = runs.flat_map(|(r, run)| (0..count).map(move |k| (r, run, k))).collect();
        let columns = parallel::map(&each, self.pool.most(), |(r, run, k)| {
            let mut at = now.at[*r].clone();
            let by = if at[*k] < 0.5 { difference } else { -difference };
            at[*k] += by;
            let other = self.features_at(*run, &at, effects).ok()?;
            Some((&now.left[*r] - left(&self.frames[*run], &other, until)) / by)
        });
        let zero = |r: usize| DVector::zeros(now.left[r].len());
        let columns: Vec<DVector<f64>> =
            columns.into_iter().zip(&each).map(|(column, (r, ..))| column.unwrap_or_else(|| zero(*r))).collect();
        if count == 0 {
            return now.left.iter().map(|left| DMatrix::zeros(left.len(), 0)).collect();
        }
        columns.chunks(count).map(DMatrix::from_columns).collect()
    }

    /// Normal equations; of each unknown a run that has it and which nuisance it is. Shared ones come first.
    fn normal(&self, now: &Point, slopes: &[DMatrix<f64>]) -> (DMatrix<f64>, DVector<f64>, Vec<(usize, usize)>) {
        let shared = self.shared();
        let index = unknowns(&shared, now.at.len());
        let at = |r: usize, k: usize| index.iter().position(|(run, own)| *own == k && (shared[k] || *run == r));
        let n = index.len();
        let (mut a, mut g) = (DMatrix::<f64>::zeros(n, n), DVector::<f64>::zeros(n));
        let start = self.nominal_start();
        let prior = 1.0 / (self.settings.fitting.prior * self.settings.fitting.prior);
        for (r, slopes) in slopes.iter().enumerate() {
            let (own, pull) = (slopes.tr_mul(slopes), slopes.tr_mul(&now.left[r]));
            for k in 0..shared.len() {
                let Some(i) = at(r, k) else { continue };
                g[i] += pull[k] + prior * (start[k] - now.at[r][k]);
                a[(i, i)] += prior;
                for l in 0..shared.len() {
                    if let Some(j) = at(r, l) {
                        a[(i, j)] += own[(k, l)];
                    }
                }
            }
        }
        (a, g, index)
    }

    fn moved(&self, at: &[Vec<f64>], step: &DVector<f64>) -> Vec<Vec<f64>> {
        let shared = self.shared();
        let index = unknowns(&shared, at.len());
        let mut out = at.to_vec();
        for ((run, k), by) in index.into_iter().zip(step.iter()) {
            let moved = (at[run][k] + by).clamp(0.0, 1.0);
            if shared[k] {
                out.iter_mut().for_each(|at| at[k] = moved);
            } else {
                out[run][k] = moved;
            }
        }
        out
    }
}

/// Of each unknown a run that has it and which nuisance it is.
fn unknowns(shared: &[bool], runs: usize) -> Vec<(usize, usize)> {
    let common = (0..shared.len()).filter(|k| shared[*k]).map(|k| (0, k));
    let own = (0..runs).flat_map(|run| (0..shared.len()).filter(|k| !shared[*k]).map(move |k| (run, k)));
    common.chain(own).collect()
}

/// Residuals over their deviations; 0 of what is lost, and of what begins later than a share of the run.
pub(super) fn left(frame: &Frame, features: &[f64], until: f64) -> DVector<f64> {
    let ends = frame.labels.iter().map(|label| (label.from, label.to));
    let (first, last) = ends.fold((i64::MAX, i64::MIN), |(a, b), (from, to)| (a.min(from), b.max(to)));
    let until = first as f64 + until * (last as f64 - first as f64);
    let of = |((x, v), label): ((f64, &f64), &Label)| {
        if x.is_finite() && label.from as f64 <= until { x / v.sqrt() } else { 0.0 }
    };
    let each = frame.residual(features).into_iter().zip(&frame.laps.variance).zip(&frame.labels).map(of);
    DVector::from_vec(each.collect())
}
