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

/// Combines what runs say of shared parameters: of each run the others are eliminated with their priors (Schur's
/// complement), and what is left is added up, with the prior of the shared ones once.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain_input::{ContactLaw, Simulation};
    use crate::identify::Measured;
    use crate::signal::{Channel, Run, Sidecar};
    use std::collections::BTreeMap;

    fn model() -> Model {
        let text =
            include_str!("../../tests/cases/levels/5-simulation.snap").splitn(3, "---\n").nth(2).expect("a body");
        let simulation: Simulation = serde_json::from_str(text).expect("an input");
        let time: Vec<f64> = (0..100).map(|i| f64::from(i) / 500.0).collect();
        let trigger = time.iter().map(|t| if *t > 0.1 { 1.0 } else { 0.0 }).collect();
        let channels = [(Channel::JointXi, vec![1.0; 100]), (Channel::Trigger, trigger)].into();
        let sidecar = Sidecar { speed_setpoint: 2.0, lowpass: 100.0, laps: 1, ..Sidecar::default() };
        let measured = Measured::new(&Run { time, channels, sidecar }, &simulation, 150.45).expect("a run");
        Model::new(&simulation, ContactLaw::default(), &measured, crate::dynamics::Width::widest())
    }

    /// Two runs that know a parameter four times and once as well, and one of them only together with another
    /// parameter.
    #[test]
    fn runs_count_by_what_they_know() {
        let model = model();
        let p = Parameter::RollingResistance;
        let (k, other) = (p.index(), Parameter::Tension.index());
        let at = Parameter::ALL.map(|p| p.prior(model.law, model.nominal[p.index()]).0);
        let fit = |information: f64, away: f64, mixed: f64| {
            let mut matrix = DMatrix::zeros(COUNT, COUNT);
            matrix[(k, k)] = information;
            matrix[(other, other)] = 1e6;
            matrix[(k, other)] = mixed;
            matrix[(other, k)] = mixed;
            let mut at = at;
            at[k] += away;
            Fit {
                at,
                covariance: DMatrix::zeros(COUNT, COUNT),
                bound: vec![0; COUNT],
                objective: 1.0,
                blocks: BTreeMap::new(),
                goodness: None,
                information: DMatrix::zeros(0, 0),
                own: Information { matrix, pull: DVector::zeros(COUNT) },
                steps: 1,
                simulations: 1,
                noise: Default::default(),
            }
        };
        let (a, b) = (fit(4e4, 0.01, 0.0), fit(1e4, -0.02, 0.0));
        let shared = combine(&[p], &[(&model, &a), (&model, &b)]).expect("combined");
        // (4 · 0.01 − 1 · 0.02) / 5, but for the prior's little weight.
        assert!((shared.at[0] - at[k] - 0.004).abs() < 1e-5, "{}", shared.at[0] - at[k]);
        assert!((shared.deviation[0] - p.reach() / 5e4_f64.sqrt()).abs() < 1e-6);
        // What goes into another parameter is lost: 4e4 − 1.8e5² / 1e6.
        let mixed = fit(4e4, 0.01, 1.8e5);
        let alone = combine(&[p], &[(&model, &mixed)]).expect("combined");
        assert!((alone.deviation[0] - p.reach() / 7.6e3_f64.sqrt()).abs() < 1e-5, "{}", alone.deviation[0]);
    }
}
