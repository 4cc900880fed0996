//! Effects that differ from cart to cart by chance: items on some of the carts, links of unequal pitch. Which cart has how much is not
//! known, so their signature is less a change of the mean lap than how far laps scatter, and their strength is where the
//! scatter fits: at the least of ln s + mean ln v/v₀ (see [`super::floor`]) over the strength.

use super::evidence::{Evidence, most_off};
use super::floor::{Floor, floors};
use super::refit::{Fitted, Hypothesis};
use super::screen::Signature;
use super::simulator::{Request, Simulator};
use crate::geometry::trig;
use nalgebra::DMatrix;

/// Strengths over the simulated one at which the scatter is thought of, by its square, in two rounds.
const SPANS: [[f64; 9]; 2] =
    [[0.1, 0.18, 0.32, 0.56, 1.0, 1.8, 3.2, 5.6, 10.0], [0.4, 0.5, 0.63, 0.8, 1.0, 1.25, 1.6, 2.0, 2.5]];

/// Shares of a strength that are tried where nothing can be simulated with it.
const SMALLER: [f64; 3] = [1.0, 0.3, 0.1];

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
        own.map(alone).filter_map(|hypothesis| self.fitted(&hypothesis, self.strength(&hypothesis)?)).collect()
    }

    /// The strength at which scatter explains most of the run that is off most; `None` where it explains nothing.
    fn strength(&self, hypothesis: &Hypothesis) -> Option<f64> {
        let signature = &self.signatures[*hypothesis.signatures.first()?];
        let strength = &self.simulator.candidates()[signature.candidate].strengths[signature.strength];
        let run = most_off(self.nominal);
        let before = self.misfit(run, &self.simulator.frames()[run].variance, 1.0);
        let mut size = strength.trial;
        for span in SPANS {
            let tried = SMALLER.map(|share| size * share);
            let variances = |size: f64| self.simulator.variances_all(&[self.request(hypothesis, run, size)]).pop()?;
            let (at, variances) = tried.into_iter().find_map(|at| Some((at, variances(at)?)))?;
            let each = span.into_iter().map(|share| (self.misfit(run, &variances, share), share));
            let (least, share) = each.min_by(|a, b| a.0.total_cmp(&b.0))?;
            if least > before - WORTH {
                return None;
            }
            size = (at * share).min(0.9 * strength.high);
        }
        Some(size)
    }

    /// ln s + mean ln v/v₀ of a run, where laps scatter as at a share of the strength that has these variances.
    fn misfit(&self, run: usize, variances: &[f64], share: f64) -> f64 {
        let frame = &self.simulator.frames()[run];
        let added = |(v, own): (&f64, &f64)| if v.is_finite() { v + share * share * (own - v) } else { *v };
        let variance: Vec<f64> = frame.variance.iter().zip(variances).map(added).collect();
        let own = Evidence::with(frame, &self.usual[run], &variance);
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
