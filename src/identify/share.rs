//! Parameters that runs of a campaign have in common.

use super::fit::Fit;
use super::model::Model;
use super::parameter::{COUNT, Parameter};
use super::posterior::{Information, Posterior, posterior};
use nalgebra::{DMatrix, DVector};

/// Values of shared parameters that all runs together say, in coordinates: their mode within bounds and its covariance.
#[derive(Clone, Debug)]
pub struct Shared {
    pub parameters: Vec<Parameter>,
    /// Coordinates, in the order of `parameters`.
    pub at: Vec<f64>,
    pub deviation: Vec<f64>,
    /// −1 or 1 at a bound.
    pub bound: Vec<i8>,
}

/// Combines what runs say of shared parameters: of each run the others are eliminated with their priors (Schur's complement), and what is
/// left is added up, with the prior of the shared ones once.
pub fn combine(shared: &[Parameter], runs: &[(&Model, &Fit)]) -> Option<Shared> {
    let (first, _) = runs.first()?;
    let reach = |p: &Parameter| p.reach();
    let prior = |model: &Model, p: Parameter| p.prior(model.law, model.nominal[p.index()]);
    let others: Vec<Parameter> = Parameter::ALL.into_iter().filter(|p| !shared.contains(p)).collect();
    let (m, n) = (shared.len(), others.len());
    let mut matrix = DMatrix::zeros(COUNT, COUNT);
    let mut pull = DVector::zeros(COUNT);
    for (model, fit) in runs {
        let own = &fit.own;
        let part = |rows: &[Parameter], columns: &[Parameter]| {
            DMatrix::from_fn(rows.len(), columns.len(), |i, j| own.matrix[(rows[i].index(), columns[j].index())])
        };
        let mut open = part(&others, &others);
        let mut right = DVector::from_fn(n, |i, _| own.pull[others[i].index()]);
        for (i, p) in others.iter().enumerate() {
            let (mean, deviation) = prior(model, *p);
            let weight = (reach(p) / deviation) * (reach(p) / deviation);
            open[(i, i)] += weight;
            right[i] += weight * (mean - fit.at[p.index()]) / reach(p);
        }
        let across = part(shared, &others);
        let solved = open.cholesky()?;
        let reduced = part(shared, shared) - &across * solved.solve(&across.transpose());
        let left = DVector::from_fn(m, |i, _| own.pull[shared[i].index()]) - &across * solved.solve(&right);
        // About the first run's place instead of this one's.
        let away = DVector::from_fn(m, |i, _| {
            (fit.at[shared[i].index()] - runs[0].1.at[shared[i].index()]) / reach(&shared[i])
        });
        let left = left + &reduced * away;
        for (i, p) in shared.iter().enumerate() {
            pull[p.index()] += left[i];
            for (j, q) in shared.iter().enumerate() {
                matrix[(p.index(), q.index())] += reduced[(i, j)];
            }
        }
    }
    let at = &runs[0].1.at;
    let about = std::array::from_fn(|k| {
        let p = Parameter::ALL[k];
        let (mean, deviation) = prior(first, p);
        ((mean - at[k]) / reach(&p), deviation / reach(&p))
    });
    let range = std::array::from_fn(|k| {
        let p = Parameter::ALL[k];
        let (low, high) = first.range(p);
        ((low - at[k]) / reach(&p), (high - at[k]) / reach(&p))
    });
    let free = std::array::from_fn(|k| shared.contains(&Parameter::ALL[k]));
    let Posterior { step, covariance, bound } = posterior(&Information { matrix, pull }, &about, &range, &free);
    Some(Shared {
        parameters: shared.to_vec(),
        at: shared.iter().map(|p| at[p.index()] + step[p.index()] * reach(p)).collect(),
        deviation: shared.iter().map(|p| covariance[(p.index(), p.index())].sqrt() * reach(p)).collect(),
        bound: shared.iter().map(|p| bound[p.index()]).collect(),
    })
}
