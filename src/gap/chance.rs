//! Effects that differ from cart to cart by chance: items on some of the carts, links of unequal pitch. Which cart has how much is not
//! known, so their signature is less a change of the mean lap than how far laps scatter, and their strength is where the
//! scatter fits: at the least of ln s + mean ln v/v₀ (see [`super::floor`]) over the strength.

use super::evidence::Evidence;
use super::floor::{Floor, floors};
use super::refit::{Fitted, Hypothesis};
use super::screen::Signature;
use super::simulator::{Request, Simulator};
use crate::geometry::trig;
use nalgebra::DMatrix;

/// Strengths over the simulated one at which the scatter is thought of, by its square, in two rounds.
const SPANS: [[f64; 9]; 2] =
    [[0.1, 0.18, 0.32, 0.56, 1.0, 1.8, 3.2, 5.6, 10.0], [0.4, 0.5, 0.63, 0.8, 1.0, 1.25, 1.6, 2.0, 2.5]];

/// How often a strength with which nothing can be simulated is made smaller, and how much.
const SMALLER: (usize, f64) = (3, 0.3);

/// What scatter must explain at least, as a logarithm, for the effect to be fitted.
const WORTH: f64 = 0.05;

/// Deviation of the logarithm of a strength that is found by scatter.
const SURE: f64 = 0.3;

/// Hypotheses of candidates that differ by chance, at the strengths where laps scatter as much as they are off. The strength is looked
/// for on the run that is off most.
pub fn by_chance(
    simulator: &dyn Simulator,
    nominal: &[Evidence],
    usual: &[Vec<Vec<f64>>],
    signatures: &[Signature],
) -> Vec<(Fitted, Option<Floor>)> {
    let candidates = simulator.candidates();
    let off = |run: &usize| nominal[*run].freedom * nominal[*run].excess(&nominal[*run].residual);
    let Some(run) = (0..nominal.len()).max_by(|a, b| off(a).total_cmp(&off(b))) else { return Vec::new() };
    let nothing = |run: usize| vec![0.0; simulator.frames()[run].nominal.len()];
    let own = (0..signatures.len()).filter(|k| candidates[signatures[*k].candidate].chance);
    own.filter_map(|k| {
        let signature = &signatures[k];
        let strength = &candidates[signature.candidate].strengths[signature.strength];
        let hypothesis = Hypothesis { members: vec![signature.candidate], signatures: vec![k] };
        let variances = |size: f64| {
            let effects = hypothesis.applied(candidates, signatures, &[size]);
            let step = nominal[run].steps(&nothing(run));
            simulator.variances_all(&[Request { run, step, effects }]).pop().flatten()
        };
        let misfit = |variances: &[f64], share: f64| {
            let frame = &simulator.frames()[run];
            let added = |(v, own): (&f64, &f64)| if v.is_finite() { v + share * share * (own - v) } else { *v };
            let variance: Vec<f64> = frame.variance.iter().zip(variances).map(added).collect();
            let own = Evidence::with(frame, &usual[run], &variance);
            trig::ln(own.excess(&own.residual).max(0.9)) + own.raised(&nominal[run])
        };
        let before = trig::ln(nominal[run].excess(&nominal[run].residual).max(0.9));
        let (mut size, mut least) = (strength.trial, f64::INFINITY);
        for span in SPANS {
            let tried = (0..SMALLER.0).map(|n| size * SMALLER.1.powi(n as i32));
            let (at, found) = tried.into_iter().find_map(|at| Some((at, variances(at)?)))?;
            let each = span.into_iter().map(|share| (misfit(&found, share), share));
            let best = each.min_by(|a, b| a.0.total_cmp(&b.0))?;
            least = best.0;
            size = (at * best.1).min(0.9 * strength.high);
            if least > before - WORTH {
                return None;
            }
        }
        (least <= before - WORTH).then(|| fitted(simulator, nominal, usual, signatures, &hypothesis, size))?
    })
    .collect()
}

/// The hypothesis at a strength, simulated.
fn fitted(
    simulator: &dyn Simulator,
    nominal: &[Evidence],
    usual: &[Vec<Vec<f64>>],
    signatures: &[Signature],
    hypothesis: &Hypothesis,
    size: f64,
) -> Option<(Fitted, Option<Floor>)> {
    let mut one = hypothesis.screened(nominal, signatures, simulator.candidates());
    one.strengths = vec![size];
    one.covariance = DMatrix::from_element(1, 1, (SURE * size) * (SURE * size));
    let effects = hypothesis.applied(simulator.candidates(), signatures, &one.strengths);
    let steps = nominal.iter().zip(simulator.frames()).map(|(e, frame)| e.steps(&vec![0.0; frame.nominal.len()]));
    let asked = steps.enumerate().map(|(run, step)| Request { run, step, effects: effects.clone() });
    let asked: Vec<Request> = asked.collect();
    let features: Vec<Vec<f64>> = simulator.simulate_all(&asked).into_iter().collect::<Option<_>>()?;
    one.changes = asked.iter().zip(&features).map(|(r, f)| simulator.frames()[r.run].moved(f, &r.step)).collect();
    one.residuals = nominal.iter().zip(&one.changes).map(|(e, c)| &e.residual - e.column(c)).collect();
    one.features = Some(features);
    let floor = floors(simulator, nominal, usual, signatures, &[&one]).pop()?;
    Some((one, floor))
}
