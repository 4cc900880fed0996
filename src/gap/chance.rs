//! Effects that differ from cart to cart by chance, as items on some of the carts and links of unequal pitch, or from
//! lap to lap, as the swings of a late drive. Which cart has how much is not known, nor where a swing begins, so their
//! signature is less a change of the mean lap than how far laps scatter, and their strength is where the scatter fits:
//! at the least of ln s + ln(det C/det C₀)/n (see [`super::repeatability`]) over the strength.

use super::ids::{PerRun, RunId, SignatureId};
use super::observation::{Observation, most_off};
use super::repeatability::{Repeatability, repeatabilities};
use super::settings::{RandomEffects, SHARES, Settings};
use super::signature::{Signature, Signatures, explain};
use super::simulator::{Context, Laps, Request, Simulator, Strength};
use crate::base::{parallel, trig};
use crate::effects::RandomEffect;
use crate::gap::hypothesis::{Fitted, Hypothesis, room, stepped};
use nalgebra::{DMatrix, DVector};

/// Where such effects are looked for.
pub struct Chance<'a> {
    pub simulator: &'a dyn Simulator,
    pub settings: &'a Settings,
    /// Before the nominal chain's repeatability.
    pub nominal: &'a PerRun<Observation>,
    /// What every machine deviates by, of each run.
    pub as_built: &'a PerRun<Vec<Vec<f64>>>,
    pub signatures: &'a Signatures,
}

impl Chance<'_> {
    fn context(&self) -> Context<'_> {
        Context { simulator: self.simulator, settings: self.settings }
    }

    /// Hypotheses of candidates that differ by chance, at the strengths where laps scatter as much as they are off.
    pub fn hypotheses(&self) -> Vec<(Fitted, Option<Repeatability>)> {
        let settings = &self.settings.random_effects;
        let candidates = self.simulator.candidates();
        let own = self.signatures.ids().filter(|k| candidates[self.signatures[*k].candidate].random_effect.is_some());
        let alone = |k: SignatureId| Hypothesis { members: vec![self.signatures[k].candidate], signatures: vec![k] };
        let ladder = |hypothesis: Hypothesis| {
            let strength = self.strength(&hypothesis);
            let rungs = std::iter::successors(Some(strength.trial), |size| Some(size * settings.rung));
            let first = rungs.take(settings.rungs).filter(|size| *size < strength.high).collect();
            (Tried { hypothesis, beside: None, without: None, points: Vec::new() }, first)
        };
        self.search(own.map(alone).map(ladder).unzip())
    }

    /// The same of what was found alone beside another effect, which differs by nothing.
    pub fn with_another(&self, other: &Fitted, found: &[&Fitted]) -> Vec<(Fitted, Option<Repeatability>)> {
        let rung = self.settings.random_effects.rung;
        let run = self.run();
        let effects = other.hypothesis.applied(self.simulator.candidates(), self.signatures, &other.strengths);
        let request = Request { run, step: other.nuisance_offsets[run].clone(), effects };
        let without = self.simulator.laps_all(&[request]).pop().flatten();
        let both = |one: &&Fitted| {
            let hypothesis = other.hypothesis.with(&one.hypothesis);
            let (alone, high) = (one.strengths[0], self.strength(&hypothesis).high);
            let first = [alone / rung, alone, alone * rung].into_iter().filter(|size| *size < high).collect();
            (Tried { hypothesis, beside: Some(other), without: without.clone(), points: Vec::new() }, first)
        };
        self.search(found.iter().map(both).unzip())
    }

    /// The run whose laps are held against what it measured.
    fn run(&self) -> RunId {
        most_off(self.nominal, self.nominal.iter().map(|o| &o.residual))
    }

    /// Hypotheses at the strengths that fit, looked for from some on.
    fn search(&self, (mut all, mut asked): (Vec<Tried>, Vec<Vec<f64>>)) -> Vec<(Fitted, Option<Repeatability>)> {
        let run = self.run();
        let before: Vec<f64> =
            all.iter().map(|tried| self.misfit(tried, run, self.without(tried, run), 1.0, None)).collect();
        for _ in 0..=self.settings.random_effects.further {
            self.simulate(run, &mut all, &asked);
            let further = |tried: &Tried| {
                tried.further(&self.settings.random_effects).filter(|x| *x < self.strength(&tried.hypothesis).high)
            };
            let worth = |(tried, before): (&Tried, &f64)| tried.may_explain(*before).then(|| further(tried)).flatten();
            asked = all.iter().zip(&before).map(|each| worth(each).into_iter().collect()).collect();
        }
        let found: Vec<Fitted> = all
            .iter()
            .zip(before)
            .filter_map(|(tried, before)| self.fitted(tried, tried.size(before, &self.settings.random_effects)?))
            .collect();
        let each: Vec<&Fitted> = found.iter().collect();
        let mut own = repeatabilities(self.context(), self.nominal, self.as_built, self.signatures, &each);
        // Scatter says the strength, not the mean lap's slope.
        for (repeatability, one) in own.iter_mut().zip(&found) {
            if let Some(repeatability) = repeatability {
                let last = one.strengths.len() - 1;
                repeatability.covariance.row_mut(last).copy_from(&one.covariance.row(last));
                repeatability.covariance.column_mut(last).copy_from(&one.covariance.column(last));
            }
        }
        found.into_iter().zip(own).collect()
    }

    /// How laps of a run scatter without what differs by chance.
    fn without<'b>(&'b self, tried: &'b Tried, run: RunId) -> &'b Laps {
        tried.without.as_ref().unwrap_or(&self.simulator.frames()[run].laps)
    }

    /// Of what differs by chance: the last of a hypothesis.
    fn signature(&self, hypothesis: &Hypothesis) -> &Signature {
        &self.signatures[hypothesis.signatures[hypothesis.signatures.len() - 1]]
    }

    fn strength(&self, hypothesis: &Hypothesis) -> &Strength {
        let signature = self.signature(hypothesis);
        &self.simulator.candidates()[signature.candidate].strengths[signature.strength]
    }

    /// Laps of a run with each hypothesis at strengths.
    fn simulate(&self, run: RunId, all: &mut [Tried], asked: &[Vec<f64>]) {
        let each = all.iter().zip(asked);
        let requests: Vec<Request> =
            each.flat_map(|(tried, sizes)| sizes.iter().map(|size| self.request(tried, run, *size))).collect();
        let answers = self.simulator.laps_all(&requests);
        let points = |all: &[Tried]| -> Vec<Option<ScatterPoint>> {
            let sizes = all.iter().zip(asked).flat_map(|(tried, sizes)| sizes.iter().map(move |size| (tried, *size)));
            let each: Vec<(&Tried, f64, Option<&Laps>)> =
                sizes.zip(&answers).map(|((tried, size), laps)| (tried, size, laps.as_ref())).collect();
            parallel::map(&each, self.simulator.threads(), |(tried, size, laps)| {
                let (size, laps, mean) = (*size, (*laps)?, self.mean(&tried.hypothesis, run, *size));
                let misfit = |share: f64| self.misfit(tried, run, laps, share, mean.as_deref());
                Some(ScatterPoint { size, misfits: self.settings.random_effects.shares.map(misfit) })
            })
        };
        let mut points = points(all).into_iter();
        for (tried, sizes) in all.iter_mut().zip(asked) {
            tried.points.extend(points.by_ref().take(sizes.len()).flatten());
            tried.points.sort_by(|a, b| a.size.total_cmp(&b.size));
        }
    }

    /// What a strength changes in a run's mean lap, by the signature; `None` where another lap has another pattern.
    fn mean(&self, hypothesis: &Hypothesis, run: RunId, size: f64) -> Option<Vec<f64>> {
        let signature = self.signature(hypothesis);
        let random_effect = self.simulator.candidates()[signature.candidate].random_effect;
        (random_effect == Some(RandomEffect::ByCart)).then(|| signature.change[run].iter().map(|x| x * size).collect())
    }

    /// ln s + ln(det C/det C₀)/n of a run, where laps scatter and are off in the mean as at a share of the strength
    /// that has these.
    fn misfit(&self, tried: &Tried, run: RunId, laps: &Laps, share: f64, mean: Option<&[f64]>) -> f64 {
        let frame = &self.simulator.frames()[run];
        let added = |(v, own): (&f64, &f64)| if v.is_finite() { v + share * share * (own - v) } else { *v };
        let variance = self.without(tried, run).variance.iter().zip(&laps.variance).map(added).collect();
        let own = Observation::with(frame, &self.as_built[run], &laps.scaled(variance), self.settings);
        let mut left = own.residual.clone();
        if let Some(other) = tried.beside {
            left -= own.column(&other.changes[run]);
        }
        if let Some(mean) = mean {
            left -= own.column(mean) * share;
        }
        trig::ln(own.mean_square(&left).max(0.9)) + own.raised(&self.nominal[run])
    }

    /// A run with the hypothesis at a strength, nuisances where they are without it.
    fn request(&self, tried: &Tried, run: RunId, size: f64) -> Request {
        let effects = tried.hypothesis.applied(self.simulator.candidates(), self.signatures, &tried.strengths(size));
        let alone = || self.nominal[run].nuisance_offsets(&vec![0.0; self.simulator.frames()[run].nominal.len()]);
        Request { run, step: tried.beside.map_or_else(alone, |other| other.nuisance_offsets[run].clone()), effects }
    }

    /// The hypothesis at a strength, simulated.
    fn fitted(&self, tried: &Tried, size: f64) -> Option<Fitted> {
        let (candidates, frames) = (self.simulator.candidates(), self.simulator.frames());
        let mut one = tried.hypothesis.screened(self.nominal, self.signatures, candidates);
        let last = one.strengths.len() - 1;
        one.strengths = tried.strengths(size);
        one.covariance = DMatrix::zeros(last + 1, last + 1);
        let deviation = self.settings.random_effects.deviation;
        one.covariance[(last, last)] = (deviation * size) * (deviation * size);
        if let Some(other) = tried.beside {
            one.columns[..last].clone_from_slice(&other.columns);
            one.covariance.view_mut((0, 0), (last, last)).copy_from(&other.covariance);
        }
        let asked: Vec<Request> = self.nominal.ids().map(|run| self.request(tried, run, size)).collect();
        let by_lap = candidates[self.signature(&tried.hypothesis).candidate].random_effect == Some(RandomEffect::ByLap);
        let features: PerRun<Vec<f64>> = if by_lap {
            // Another lap has another pattern: nothing of the simulated one is in the measured one's mean.
            one.columns[last].iter_mut().for_each(|column| column.fill(0.0));
            let nominal = || asked.iter().map(|r| frames[r.run].at(&r.step)).collect();
            tried.beside.and_then(|other| other.features.clone()).unwrap_or_else(nominal)
        } else {
            self.simulator.simulate_all(&asked).into_iter().collect::<Option<_>>()?
        };
        one.changes = match tried.beside.filter(|_| by_lap) {
            Some(other) => other.changes.clone(),
            None => asked.iter().zip(&features).map(|(r, f)| frames[r.run].moved(f, &r.step)).collect(),
        };
        one.residuals = self.nominal.iter().zip(&one.changes).map(|(o, c)| &o.residual - o.column(c)).collect();
        one.nuisance_offsets = asked.into_iter().map(|r| r.step).collect();
        one.features = Some(features);
        if tried.beside.is_some() {
            self.settle_other(&mut one, last);
        }
        Some(one)
    }

    /// Strengths of the other effect as they fit best beside what differs by chance, which it took for its own.
    fn settle_other(&self, one: &mut Fitted, own: usize) {
        let bounds = one.hypothesis.bounds(self.simulator.candidates(), self.signatures);
        let columns: Vec<&PerRun<DVector<f64>>> = one.columns[..own].iter().collect();
        let step = explain(&one.residuals, &columns, &room(&bounds[..own], &one.strengths), None);
        let more: Vec<f64> = step.strengths.iter().copied().chain([0.0]).collect();
        one.changes = one.hypothesis.changed_further(self.signatures, &one.changes, &more);
        one.strengths = stepped(&one.strengths, &more, &bounds);
        one.residuals = step.residuals;
    }
}

/// A hypothesis at strengths that were simulated, by size.
struct Tried<'a> {
    hypothesis: Hypothesis,
    /// An effect that differs by nothing, beside which it is tried: the first members of the hypothesis.
    beside: Option<&'a Fitted>,
    /// How laps scatter without what differs by chance; as the nominal chain's where nothing else is said.
    without: Option<Laps>,
    points: Vec<ScatterPoint>,
}

/// How far laps are from scattering as much as the run is off, at each share of a strength that is thought of.
struct ScatterPoint {
    size: f64,
    misfits: [f64; SHARES],
}

impl Tried<'_> {
    /// All strengths, where what differs by chance has this one.
    fn strengths(&self, size: f64) -> Vec<f64> {
        self.beside.iter().flat_map(|other| other.strengths.iter().copied()).chain([size]).collect()
    }

    /// Another strength to be simulated: where it fits better when that is near; else half way between strengths with
    /// which laps scatter too little and too much, as scatter grows with the strength, though it may do so all at once.
    fn further(&self, settings: &RandomEffects) -> Option<f64> {
        let each: Vec<(f64, f64)> = self.points.iter().map(|point| (point.size, point.share(settings))).collect();
        if each.iter().any(|(_, share)| *share == 1.0) {
            return None;
        }
        if let Some((size, share)) = each.iter().rfind(|(_, share)| settings.near.contains(share)) {
            let next = size * share;
            return each.iter().all(|(size, _)| *size != next).then_some(next);
        }
        let much = each.iter().position(|(_, share)| *share < 1.0)?;
        let little = much.checked_sub(1).map_or(each[much].0 / (settings.rung * settings.rung), |k| each[k].0);
        Some((little * each[much].0).sqrt())
    }

    /// Whether there is a strength with which laps scatter more like the run than without.
    fn may_explain(&self, before: f64) -> bool {
        self.points.iter().flat_map(|point| point.misfits).any(|misfit| misfit < before)
    }

    /// The simulated strength that fits best, where scatter explains something.
    fn size(&self, before: f64, settings: &RandomEffects) -> Option<f64> {
        let best = self.points.iter().min_by(|a, b| a.misfit(settings).total_cmp(&b.misfit(settings)))?;
        (best.misfit(settings) < before - settings.worth).then_some(best.size)
    }
}

impl ScatterPoint {
    /// At the strength itself.
    fn misfit(&self, settings: &RandomEffects) -> f64 {
        settings
            .shares
            .iter()
            .zip(self.misfits)
            .find(|(share, _)| **share == 1.0)
            .map_or(f64::INFINITY, |(_, misfit)| misfit)
    }

    /// The share of the strength at which it is least; infinite where laps do not scatter by it, whatever the share.
    fn share(&self, settings: &RandomEffects) -> f64 {
        let each = settings.shares.iter().zip(self.misfits);
        let most = self.misfits.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let least = each.min_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, least)| most - least > settings.worth);
        least.map_or(f64::INFINITY, |(share, _)| *share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::ids::{CandidateId, Id};

    /// A quadratic in the logarithm of the strength, as it is where scatter grows in proportion.
    fn tried(sizes: &[f64], fits: f64) -> Tried<'static> {
        let point = |size: &f64| {
            let misfit = |share: f64| trig::ln(share * size / fits) * trig::ln(share * size / fits);
            ScatterPoint { size: *size, misfits: RandomEffects::default().shares.map(misfit) }
        };
        let hypothesis = Hypothesis { members: vec![CandidateId::new(0)], signatures: vec![SignatureId::new(0)] };
        Tried { hypothesis, beside: None, without: None, points: sizes.iter().map(point).collect() }
    }

    #[test]
    fn a_strength_is_looked_for_between_simulated_ones() {
        let settings = RandomEffects::default();
        let next = |fits: f64| tried(&[1.0, 3.0, 9.0], fits).further(&settings);
        // 5 is too much for 3 and too little for 9.
        assert!((next(5.0).unwrap() - 27.0_f64.sqrt()).abs() < 1e-9);
        assert!((next(0.5).unwrap() - 1.0 / 3.0).abs() < 1e-9);
        assert!((next(3.6).unwrap() - 3.75).abs() < 1e-9);
        assert_eq!((next(3.1), next(90.0)), (None, None));
        let there = tried(&[1.0, 3.0, 9.0], 3.1);
        assert_eq!(there.size(9.0, &settings), Some(3.0));
        // What does nothing is too little, whichever share is least by a hair.
        let flat = ScatterPoint {
            size: 0.1,
            misfits: RandomEffects::default().shares.map(|share| 9.0 + 1e-3 * (share - 1.0).abs()),
        };
        let mut beside = tried(&[9.0], 3.0);
        beside.points.insert(0, flat);
        assert!((beside.further(&settings).unwrap() - 0.9_f64.sqrt()).abs() < 1e-9);
        // What explains nothing is not believed, nor looked for any further.
        assert_eq!(there.size(-1.0, &settings), None);
        assert!(there.may_explain(0.1) && !there.may_explain(-1.0));
    }
}
