//! Pairs from other strengths. What an effect does may set in at a threshold, as play that a joint's pull closes does.
//! Beside another effect a fit may then end far below it, where its signature is something else.

use super::comparison::Comparison;
use super::hypothesis::{Fitted, norm_squared, room, stepped};
use super::ids::{CandidateId, PerRun};
use super::scored::Scored;
use super::signature::explain;
use super::simulator::Request;
use nalgebra::DVector;

impl Comparison<'_> {
    /// The pair that leaves least of those that were simulated, each of its members at the strength of a ladder with
    /// which less is left, the other one as it fits best beside it. Nothing where none leaves less.
    pub fn at_other_strengths(&self, scored: &[Scored]) -> Vec<Fitted> {
        let pair = |j: &&Scored| {
            let hypothesis = &j.fitted.hypothesis;
            hypothesis.members.len() == 2 && self.effects(hypothesis).len() == 2 && j.fitted.simulated()
        };
        let best = scored.iter().filter(pair).min_by(|a, b| a.mean_square.total_cmp(&b.mean_square));
        let Some(Scored { fitted, .. }) = best else { return Vec::new() };
        fitted.hypothesis.members.iter().filter_map(|member| self.along_ladder(fitted, *member)).collect()
    }

    /// A pair with a member's strengths so many times as large as leaves least, where that is less than it leaves.
    fn along_ladder(&self, fitted: &Fitted, member: CandidateId) -> Option<Fitted> {
        let (candidates, frames) = (self.candidates(), self.simulator.frames());
        // Strengths of sensors are found from wherever they begin.
        if candidates[member].sensor || candidates[member].random_effect.is_some() {
            return None;
        }
        let hypothesis = &fitted.hypothesis;
        let bounds = hypothesis.bounds(candidates, &self.signatures);
        let own = |k: usize| self.signatures[hypothesis.signatures[k]].candidate == member;
        let (moved, others): (Vec<usize>, Vec<usize>) = (0..fitted.strengths.len()).partition(|k| own(*k));
        let at = |factor: &f64| {
            let mut strengths = fitted.strengths.clone();
            moved.iter().for_each(|k| strengths[*k] = (strengths[*k] * factor).clamp(bounds[*k].0, bounds[*k].1));
            strengths
        };
        let mut tried: Vec<Vec<f64>> = self.settings.selection.pair_factors.iter().map(at).collect();
        tried.dedup();
        let request = |strengths: &Vec<f64>| -> Vec<Request> {
            let effects = hypothesis.applied(candidates, &self.signatures, strengths);
            let each = fitted.nuisance_offsets.with_ids();
            each.map(|(run, step)| Request { run, step: step.clone(), effects: effects.clone() }).collect()
        };
        let requests: Vec<Request> = tried.iter().flat_map(request).collect();
        let answers = self.simulator.simulate_all(&requests);
        let runs = self.observations.len().max(1);
        let of = |n: usize| {
            let asked = requests[n * runs..(n + 1) * runs].iter().zip(&answers[n * runs..(n + 1) * runs]);
            let changes = asked.map(|(r, answer)| Some(frames[r.run].moved(answer.as_ref()?, &r.step)));
            let changes: PerRun<Vec<f64>> = changes.collect::<Option<_>>()?;
            let left: PerRun<DVector<f64>> =
                self.observations.iter().zip(&changes).map(|(o, change)| &o.residual - o.column(change)).collect();
            let columns: Vec<&PerRun<DVector<f64>>> = others.iter().map(|k| &fitted.columns[*k]).collect();
            let pick = |list: &[(f64, f64)]| others.iter().map(|k| list[*k]).collect::<Vec<_>>();
            let step = explain(&left, &columns, &pick(&room(&bounds, &tried[n])), None);
            let mut more = vec![0.0; tried[n].len()];
            others.iter().zip(&step.strengths).for_each(|(k, x)| more[*k] = *x);
            let changes = hypothesis.changed_further(&self.signatures, &changes, &more);
            let nuisance_offsets = self.observations.iter().zip(&changes);
            let nuisance_offsets = nuisance_offsets.map(|(o, change)| o.nuisance_offsets(change)).collect();
            let strengths = stepped(&tried[n], &more, &bounds);
            let residuals = step.residuals;
            Some(Fitted { strengths, residuals, changes, nuisance_offsets, features: None, ..fitted.clone() })
        };
        let best = (0..tried.len()).filter_map(of).map(|one| (norm_squared(&one.residuals), one));
        let (square, best) = best.min_by(|a, b| a.0.total_cmp(&b.0))?;
        (square < (1.0 - self.settings.refitting.enough) * norm_squared(&fitted.residuals)).then_some(best)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::hypothesis::Hypothesis;
    use crate::gap::ids::{Id, SignatureId};
    use crate::gap::observation::Observation;
    use crate::gap::settings::Settings;
    use crate::gap::signature::Signature;
    use crate::gap::simulator::{Candidate, Context};
    use crate::gap::two_effects::{FEATURES, TwoEffects};

    fn even(k: usize) -> f64 {
        if k < 40 { 1.0 } else { 0.0 }
    }

    /// `even` is in proportion to its strength. `play` does a little of the same while it is small, and beyond 5 something
    /// else.
    fn done(strengths: [f64; 2], k: usize) -> f64 {
        let [first, play] = strengths;
        (first + 0.3 * play.min(5.0)) * even(k) + (play - 5.0).max(0.0) * (1.0 - even(k))
    }

    #[test]
    fn a_threshold_is_met_from_far_below() {
        let candidate = |effect: &str| Candidate::bare(effect, 1.0, (0.0, 20.0));
        let model = TwoEffects::new([candidate("even"), candidate("play")], done, [6.0, 9.0], 4);
        let settings = Settings::default();
        let observations: PerRun<Observation> =
            model.frames.iter().map(|frame| Observation::new(frame, &[], &settings)).collect();
        let signature = |n: usize| {
            let change = (0..FEATURES).map(|k| if n == 0 { done([1.0, 0.0], k) } else { done([0.0, 1.0], k) });
            let change: PerRun<Vec<f64>> = vec![change.collect()].into();
            let columns = observations.iter().zip(&change).map(|(o, c)| o.column(c)).collect();
            Signature { candidate: CandidateId::new(n), strength: 0, size: 1.0, change, columns }
        };
        let signatures = vec![signature(0), signature(1)].into();
        let comparison = Comparison::new(Context { simulator: &model, settings: &settings }, observations, signatures);
        let hypothesis = Hypothesis {
            members: vec![CandidateId::new(0), CandidateId::new(1)],
            signatures: vec![SignatureId::new(0), SignatureId::new(1)],
        };
        let mut below = hypothesis.screened(&comparison.observations, &comparison.signatures, &model.candidates);
        // Far below the threshold the two are alike.
        below.strengths = vec![7.0, 1.0];
        let change: Vec<f64> = (0..FEATURES).map(|k| done([7.0, 1.0], k)).collect();
        below.residuals = comparison.observations.map(|o| &o.residual - o.column(&change));
        below.changes = vec![change.clone()].into();
        below.features = Some(vec![change].into());
        let left = norm_squared(&below.residuals);
        let found = comparison.at_other_strengths(&[comparison.score(below, None)]);
        let [one] = &found[..] else { panic!("{} pairs", found.len()) };
        assert_eq!(one.strengths[1], 9.0);
        assert!((one.strengths[0] - 6.0).abs() < 0.6, "{:?}", one.strengths);
        assert!(norm_squared(&one.residuals) < 0.3 * left);
        // From there nothing leaves less.
        let mut there = one.clone();
        there.features = Some(one.changes.clone());
        assert!(comparison.at_other_strengths(&[comparison.score(there, None)]).is_empty());
    }
}
