//! Effects that differ from cart to cart by chance, as items on some of the carts and links of unequal pitch, or from lap to lap, as the
//! swings of a late drive. Which cart has how much is not known, nor where a swing begins, so their signature is less a change of the mean
//! lap than how far laps scatter, and their strength is where the scatter fits: at the least of ln s + mean ln v/v₀ (see [`super::floor`])
//! over the strength.

use super::evidence::{Evidence, most_off};
use super::floor::{Floor, floors};
use super::refit::{Fitted, Hypothesis};
use super::screen::Signature;
use super::simulator::{Laps, Request, Simulator, Strength};
use crate::geometry::trig;
use nalgebra::DMatrix;

/// Strengths that are simulated at first, from the trial on, each so many times the one before.
const LADDER: usize = 4;
const RUNG: f64 = 3.0;

/// Strengths over a simulated one at which the scatter is thought of, by its square.
const SPAN: [f64; 9] = [0.4, 0.5, 0.63, 0.8, 1.0, 1.25, 1.6, 2.0, 2.5];

/// What scatter must explain at least, as a logarithm, for the effect to be fitted.
const WORTH: f64 = 0.05;

/// Deviation of the logarithm of a strength that is found by scatter.
const SURE: f64 = 0.3;

/// Where such effects are looked for.
pub struct Chance<'a> {
    pub simulator: &'a dyn Simulator,
    /// Before the nominal chain's floor.
    pub nominal: &'a [Evidence],
    /// What every machine deviates by, of each run.
    pub usual: &'a [Vec<Vec<f64>>],
    pub signatures: &'a [Signature],
}

impl Chance<'_> {
    /// Hypotheses of candidates that differ by chance, at the strengths where laps scatter as much as they are off.
    pub fn hypotheses(&self) -> Vec<(Fitted, Option<Floor>)> {
        let candidates = self.simulator.candidates();
        let own = (0..self.signatures.len()).filter(|k| candidates[self.signatures[*k].candidate].chance);
        let alone = |k: usize| Hypothesis { members: vec![self.signatures[k].candidate], signatures: vec![k] };
        let all: Vec<Hypothesis> = own.map(alone).collect();
        let rungs = all.iter().map(|hypothesis| {
            let strength = self.strength(hypothesis);
            let rungs = (0..LADDER).scan(strength.trial, |size, _| {
                let own = *size;
                *size *= RUNG;
                Some(own)
            });
            (hypothesis, rungs.filter(|size| *size < strength.high).collect::<Vec<f64>>())
        });
        let first = self.where_it_fits(&rungs.collect::<Vec<_>>());
        let again: Vec<(&Hypothesis, Vec<f64>)> =
            all.iter().zip(first).filter_map(|(h, x)| Some((h, vec![x?]))).collect();
        let found = self.where_it_fits(&again);
        let fitted = again.iter().zip(found).filter_map(|((h, _), x)| self.fitted(h, x?));
        fitted.collect()
    }

    /// What of a hypothesis is fitted.
    fn strength(&self, hypothesis: &Hypothesis) -> &Strength {
        let signature = &self.signatures[hypothesis.signatures[0]];
        &self.simulator.candidates()[signature.candidate].strengths[signature.strength]
    }

    /// Of each hypothesis the strength at which scatter explains most of the run that is off most, from simulations at some; `None`
    /// where it explains nothing.
    fn where_it_fits(&self, tried: &[(&Hypothesis, Vec<f64>)]) -> Vec<Option<f64>> {
        let run = most_off(self.nominal);
        let before = self.misfit(run, &self.simulator.frames()[run].laps, 1.0);
        let requests = tried.iter().flat_map(|(h, sizes)| sizes.iter().map(|size| self.request(h, run, *size)));
        let mut answers = self.simulator.laps_all(&requests.collect::<Vec<_>>()).into_iter();
        let of = |(hypothesis, sizes): &(&Hypothesis, Vec<f64>)| {
            let mut best: Option<(f64, f64)> = None;
            for size in sizes {
                let Some(laps) = answers.next().flatten() else { continue };
                for share in SPAN {
                    let misfit = self.misfit(run, &laps, share);
                    if best.is_none_or(|(least, _)| misfit < least) {
                        best = Some((misfit, size * share));
                    }
                }
            }
            let (least, size) = best?;
            (least < before - WORTH).then(|| size.min(0.9 * self.strength(hypothesis).high))
        };
        tried.iter().map(of).collect()
    }

    /// ln s + the mean logarithm of what its floor is raised by, of a run, where laps scatter as at a share of the strength that has these.
    fn misfit(&self, run: usize, laps: &Laps, share: f64) -> f64 {
        let frame = &self.simulator.frames()[run];
        let added = |(v, own): (&f64, &f64)| if v.is_finite() { v + share * share * (own - v) } else { *v };
        let variance = frame.laps.variance.iter().zip(&laps.variance).map(added).collect();
        let own = Evidence::with(frame, &self.usual[run], &laps.scaled(variance));
        trig::ln(own.excess(&own.residual).max(0.9)) + own.raised(&self.nominal[run])
    }

    /// A run with the hypothesis at a strength, nuisances where they are without it.
    fn request(&self, hypothesis: &Hypothesis, run: usize, size: f64) -> Request {
        let effects = hypothesis.applied(self.simulator.candidates(), self.signatures, &[size]);
        let nothing = vec![0.0; self.simulator.frames()[run].nominal.len()];
        Request { run, step: self.nominal[run].steps(&nothing), effects }
    }

    /// The hypothesis at a strength, simulated.
    fn fitted(&self, hypothesis: &Hypothesis, size: f64) -> Option<(Fitted, Option<Floor>)> {
        let mut one = hypothesis.screened(self.nominal, self.signatures, self.simulator.candidates());
        one.strengths = vec![size];
        one.covariance = DMatrix::from_element(1, 1, (SURE * size) * (SURE * size));
        let asked: Vec<Request> = (0..self.nominal.len()).map(|run| self.request(hypothesis, run, size)).collect();
        let features: Vec<Vec<f64>> = self.simulator.simulate_all(&asked).into_iter().collect::<Option<_>>()?;
        let frames = self.simulator.frames();
        one.changes = asked.iter().zip(&features).map(|(r, f)| frames[r.run].moved(f, &r.step)).collect();
        one.residuals = self.nominal.iter().zip(&one.changes).map(|(e, c)| &e.residual - e.column(c)).collect();
        one.features = Some(features);
        let mut floor = floors(self.simulator, self.nominal, self.usual, self.signatures, &[&one]).pop()?;
        // Scatter says the strength, not the mean lap's slope.
        if let Some(floor) = &mut floor {
            floor.covariance.clone_from(&one.covariance);
        }
        Some((one, floor))
    }
}
