//! The repeatability of laps with an effect. Two replicate laps of a chain whose wheels are out of round or whose carts
//! carry items by chance are farther apart than two of the nominal chain: what an effect makes of the repeatability
//! belongs to its signature.
//!
//! With C the covariance of n features with the effect and C₀ without, by noise, nuisances, discrepancies and modes,
//! −f/2 (ln s + ln(det C/det C₀)/n) is the log likelihood of a mean square s in units of C (the normal distribution
//! with unknown scale, Seber and Wild 2003): a repeatability that is raised for nothing costs.

use super::ids::PerRun;
use super::observation::{self, Observation};
use super::signature::{Signatures, explain};
use super::simulator::{Candidates, Context, Laps, Request};
use crate::gap::hypothesis::Fitted;
use nalgebra::{DMatrix, DVector};

/// A hypothesis before the repeatability that it makes itself.
pub struct Repeatability {
    pub observations: PerRun<Observation>,
    /// What is left of each run, projected.
    pub residuals: PerRun<DVector<f64>>,
    /// What one more of each strength changes.
    pub columns: Vec<PerRun<DVector<f64>>>,
    pub covariance: DMatrix<f64>,
    /// Logarithm of the covariance's determinant over that without the effect, for each feature of all runs.
    pub raised: f64,
    /// How much a cart's laps have in common over the runs.
    pub common: f64,
}

/// The repeatabilities of fitted hypotheses; `None` where the nominal chain's holds. `as_built` is what every machine
/// deviates by, of each run.
pub fn repeatabilities(
    context: Context,
    nominal: &PerRun<Observation>,
    as_built: &PerRun<Vec<Vec<f64>>>,
    signatures: &Signatures,
    fitted: &[&Fitted],
) -> Vec<Option<Repeatability>> {
    let Context { simulator, settings } = context;
    let (candidates, frames) = (simulator.candidates(), simulator.frames());
    let requests: Vec<Request> = fitted.iter().flat_map(|one| one.requests(candidates, signatures)).collect();
    let answers = simulator.laps_all(&requests);
    let of = |(one, laps): (&&Fitted, &[Option<Laps>])| {
        let laps: PerRun<&Laps> = laps.iter().map(Option::as_ref).collect::<Option<_>>()?;
        let own = laps.with_ids().map(|(run, laps)| Observation::with(&frames[run], &as_built[run], laps, settings));
        let carts = laps.iter().map(|laps| laps.scatter.len()).min().unwrap_or(0);
        let cart = |k: usize| nominal.iter().zip(&laps).map(|(o, laps)| o.column(&laps.scatter[k])).collect();
        let some: Vec<PerRun<DVector<f64>>> =
            (0..carts).step_by(carts.div_ceil(settings.random_effects.carts).max(1)).map(cart).collect();
        let common = observation::in_common(frames, nominal, &some);
        Some(Repeatability { common, ..Repeatability::new(one, nominal, own.collect(), candidates, signatures) })
    };
    fitted.iter().zip(answers.chunks(nominal.len().max(1))).map(of).collect()
}

impl Repeatability {
    fn new(
        fitted: &Fitted,
        nominal: &PerRun<Observation>,
        observations: PerRun<Observation>,
        candidates: &Candidates,
        signatures: &Signatures,
    ) -> Repeatability {
        let left =
            |(observation, change): (&Observation, &Vec<f64>)| &observation.residual - observation.column(change);
        let residuals: PerRun<DVector<f64>> = observations.iter().zip(&fitted.changes).map(left).collect();
        let carried = |column: &PerRun<DVector<f64>>| {
            let each = observations.iter().zip(nominal).zip(column);
            each.map(|((own, nominal), c)| own.carried(nominal, c)).collect()
        };
        let columns: Vec<PerRun<DVector<f64>>> = fitted.columns.iter().map(carried).collect();
        let by: Vec<&PerRun<DVector<f64>>> = columns.iter().collect();
        let covariance = explain(&residuals, &by, &fitted.hypothesis.bounds(candidates, signatures), None).covariance;
        let (mut raised, mut degrees_of_freedom) = (0.0, 0.0);
        for (own, nominal) in observations.iter().zip(nominal) {
            raised += nominal.degrees_of_freedom * own.raised(nominal);
            degrees_of_freedom += nominal.degrees_of_freedom;
        }
        Repeatability {
            observations,
            residuals,
            columns,
            covariance,
            raised: raised / degrees_of_freedom.max(1e-9),
            common: 0.0,
        }
    }
}
