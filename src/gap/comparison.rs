//! Comparison of hypotheses: the log posterior of each, and of something unknown beside them.

use super::ids::{CandidateId, PerRun, SignatureId};
use super::likelihood;
use super::observation::{self, Observation};
use super::refit::along;
use super::repeatability::Repeatability;
use super::scored::{self, Explanation, Scored, Terms};
use super::settings::{Likelihood, Settings};
use super::signature::{Signature, Signatures};
use super::significance::ScoreTest;
use super::simulator::{Band, Candidate, Candidates, Context, Simulator};
use crate::base::{parallel, trig};
use crate::effects::RandomEffect;
use crate::gap::hypothesis::{Fitted, Hypothesis, norm_squared};
use nalgebra::DVector;
use std::collections::BTreeSet;

/// What hypotheses are compared by: the runs, and the signatures of effects that were screened.
pub struct Comparison<'a> {
    pub simulator: &'a dyn Simulator,
    pub settings: &'a Settings,
    pub observations: PerRun<Observation>,
    pub signatures: Signatures,
    pub degrees_of_freedom: f64,
    /// Normalised mean-square residual of the nominal model.
    pub mean_square: f64,
}

/// All hypotheses with their scores, the likeliest first.
pub struct Compared<'a> {
    pub comparison: Comparison<'a>,
    pub scored: Vec<Scored>,
    /// Log posterior of something unknown.
    pub unknown: f64,
}

impl<'a> Comparison<'a> {
    pub fn new(context: Context<'a>, observations: PerRun<Observation>, signatures: Signatures) -> Self {
        let degrees_of_freedom = observations.iter().map(|o| o.degrees_of_freedom).sum::<f64>();
        let degrees_of_freedom = degrees_of_freedom.min(context.settings.likelihood.degrees_of_freedom);
        let mean_square = overall_mean_square(&observations, observations.iter().map(|o| &o.residual));
        let Context { simulator, settings } = context;
        Comparison { simulator, settings, observations, signatures, degrees_of_freedom, mean_square }
    }

    /// What hypotheses that were fitted and scored come to, once all are there: what each costs beside, and something
    /// unknown.
    pub fn compared(self, scored: Vec<Scored>) -> Compared<'a> {
        let scored = self.without_what_is_seen_beyond(self.without_wrong_impacts(scored));
        let unknown = self.unknown(&scored);
        Compared { comparison: self, scored, unknown }
    }
}

impl Compared<'_> {
    /// How no gap, something unknown and the likeliest hypotheses came to their scores.
    pub fn explained(&self) -> Vec<Explanation> {
        let comparison = &self.comparison;
        let settings = comparison.likelihood();
        let (mean_square, prior) = (comparison.mean_square, trig::ln(settings.prior_none));
        let none = Terms {
            likelihood: settings.log_likelihood(mean_square, comparison.degrees_of_freedom),
            prior,
            ..Terms::default()
        };
        let prior = trig::ln(settings.prior_unknown);
        let unknown = Terms { likelihood: self.unknown - prior, prior, ..Terms::default() };
        let without = |terms| Explanation { effects: Vec::new(), simulated: true, mean_square, terms };
        let name = |c: &CandidateId| {
            let candidate = &comparison.candidates()[*c];
            let place = if candidate.place.is_empty() { String::new() } else { format!(" ({})", candidate.place) };
            format!("{}{place}", candidate.effect)
        };
        let each = self.scored.iter().take(comparison.settings.reporting.explained).map(|scored| Explanation {
            effects: scored.fitted.hypothesis.members.iter().map(name).collect(),
            simulated: scored.fitted.simulated(),
            mean_square: scored.mean_square,
            terms: scored.terms,
        });
        [without(none), without(unknown)].into_iter().chain(each).collect()
    }

    /// The same without one of the hypotheses.
    pub fn without(mut self, at: usize) -> Self {
        self.scored.remove(at);
        self
    }
}

/// Mean square residual over that of replicate laps, over all runs, each for what it can tell.
pub fn overall_mean_square<'a>(
    observations: &PerRun<Observation>,
    residuals: impl IntoIterator<Item = &'a DVector<f64>>,
) -> f64 {
    let mut sum = (0.0, 0.0);
    for (observation, residual) in observations.iter().zip(residuals) {
        sum = (
            sum.0 + observation.degrees_of_freedom * observation.mean_square(residual),
            sum.1 + observation.degrees_of_freedom,
        );
    }
    sum.0 / sum.1.max(1e-9)
}

/// Of what changes all runs.
fn norm(each: &PerRun<DVector<f64>>) -> f64 {
    norm_squared(each).sqrt()
}

impl Comparison<'_> {
    /// A candidate alone, each of its strengths by the first of its signatures.
    pub fn single(&self, candidate: CandidateId) -> Hypothesis {
        let mut met = BTreeSet::new();
        let own = self.signatures.with_ids().filter(|(_, s)| s.candidate == candidate && met.insert(s.strength));
        Hypothesis { members: vec![candidate], signatures: own.map(|(k, _)| k).collect() }
    }

    /// All candidates with signatures, the likeliest first.
    pub fn singles(&self) -> Vec<Scored> {
        let known: BTreeSet<CandidateId> = self.signatures.iter().map(|s| s.candidate).collect();
        let ways: Vec<Hypothesis> = known
            .into_iter()
            .flat_map(|c| {
                let whole = self.single(c);
                let (beside, own): (Vec<SignatureId>, Vec<SignatureId>) =
                    whole.signatures.iter().copied().partition(|k| self.is_beside(*k));
                // Of an effect with several strengths each may be there without the others.
                let mut some: Vec<Vec<SignatureId>> = own.iter().map(|k| vec![*k]).collect();
                // What is looked for only beside those is, one by one.
                some.extend(beside.into_iter().map(|k| own.iter().copied().chain([k]).collect()));
                some.retain(|some| some.len() < whole.signatures.len());
                let some = some.into_iter().map(move |signatures| Hypothesis { members: vec![c], signatures });
                some.chain([whole]).collect::<Vec<_>>()
            })
            .collect();
        self.likeliest(&ways)
    }

    /// Hypotheses by signatures alone, the likeliest first.
    pub fn likeliest(&self, hypotheses: &[Hypothesis]) -> Vec<Scored> {
        let mut scored = parallel::map(hypotheses, self.simulator.threads(), |h| self.screened(h.clone()));
        scored::sort(&mut scored);
        scored
    }

    /// The place of a candidate: one beside another is at that one's.
    pub fn place(&self, candidate: CandidateId) -> CandidateId {
        let before = |c: &CandidateId| self.candidates()[*c].alternative_to;
        std::iter::successors(Some(candidate), before).last().unwrap_or(candidate)
    }

    pub fn candidates(&self) -> &Candidates {
        self.simulator.candidates()
    }

    fn screened(&self, hypothesis: Hypothesis) -> Scored {
        self.score(hypothesis.screened(&self.observations, &self.signatures, self.candidates()), None)
    }

    pub fn score(&self, fitted: Fitted, repeatability: Option<Repeatability>) -> Scored {
        let mean_square = match &repeatability {
            Some(repeatability) => {
                trig::exp(repeatability.raised)
                    * overall_mean_square(&repeatability.observations, &repeatability.residuals)
            }
            None => overall_mean_square(&self.observations, &fitted.residuals),
        };
        let prior = self.prior(&fitted.hypothesis);
        let strengths = self.strengths(&fitted.hypothesis);
        let counts = self.likelihood().counts(mean_square);
        let by_signature = if counts > 0.0 { self.along_signature(&fitted, counts) } else { f64::NEG_INFINITY };
        let common = repeatability.as_ref().map_or(0.0, |repeatability| self.in_common(&fitted, repeatability));
        let whole = self.likelihood().log_likelihood(mean_square, self.degrees_of_freedom);
        let likelihood = (whole - common).max(by_signature);
        let lost = whole.max(by_signature) - likelihood;
        let terms = Terms {
            likelihood,
            in_common: lost,
            strengths: likelihood::cost(strengths, self.degrees_of_freedom),
            prior,
            ..Terms::default()
        };
        Scored { fitted, repeatability, mean_square, terms }
    }

    /// How many numbers a hypothesis has that are fitted.
    pub fn strengths(&self, hypothesis: &Hypothesis) -> f64 {
        let count =
            |signature: &Signature| self.candidates()[signature.candidate].strengths[signature.strength].count();
        hypothesis.signatures.iter().map(|k| count(&self.signatures[*k])).sum::<usize>() as f64
    }

    /// The effects of a hypothesis, each once.
    pub fn effects(&self, hypothesis: &Hypothesis) -> Vec<&str> {
        let mut met = BTreeSet::new();
        let all = hypothesis.members.iter().map(|c| self.candidates()[*c].effect.as_str());
        all.filter(|name| met.insert(*name)).collect()
    }

    /// Log prior of a hypothesis: effects share theirs, and places of an effect; each further place of an effect costs.
    pub fn prior(&self, hypothesis: &Hypothesis) -> f64 {
        let candidates = self.candidates();
        let effects = {
            let mut names: Vec<&str> = candidates.iter().map(|c| c.effect.as_str()).collect();
            names.sort_unstable();
            names.dedup();
            names.len().max(1) as f64
        };
        let members = &hypothesis.members;
        let alike = |c: CandidateId, o: &Candidate| o.alternative_to.is_none() && o.effect == candidates[c].effect;
        let sites = |c: CandidateId| candidates.iter().filter(|o| alike(c, o)).count() as f64;
        let named = self.effects(hypothesis).len();
        let shared = named as f64 * trig::ln(effects) + members.iter().map(|c| trig::ln(sites(*c))).sum::<f64>();
        let settings = self.likelihood();
        let further = (members.len() - named) as f64 * trig::ln(settings.prior_place);
        trig::ln(if named == 1 { settings.prior_one } else { settings.prior_pair }) + further - shared
    }

    /// The hypotheses with what it costs that their impacts go the other way round than measured, by what was simulated
    /// or, where nothing was, by signatures.
    fn without_wrong_impacts(&self, scored: Vec<Scored>) -> Vec<Scored> {
        let with = |scored: Scored| {
            let impacts = self.wrong_impacts(&scored.fitted);
            Scored { terms: Terms { impacts, ..scored.terms }, ..scored }
        };
        scored.into_iter().map(with).collect()
    }

    fn wrong_impacts(&self, fitted: &Fitted) -> f64 {
        let Fitted { features, hypothesis, strengths, .. } = fitted;
        // What does not strike moves such forces with all others, as far as its equation is the machine's.
        if !hypothesis.signatures.iter().any(|own| self.strikes(&self.signatures[*own])) {
            return 0.0;
        }
        let mut cost = 0.0;
        for (run, frame) in self.simulator.frames().with_ids() {
            // An impact hardly grows with the strength: no more of it is believed than was simulated.
            let by_signature = |k: usize| {
                let own = hypothesis.signatures.iter().map(|own| &self.signatures[*own]).zip(strengths);
                let change = |(s, x): (&Signature, &f64)| s.change[run][k] * x.clamp(-s.size.abs(), s.size.abs());
                frame.nominal[k] + own.map(change).sum::<f64>()
            };
            let impacts = (0..frame.labels.len()).filter(|k| frame.labels[*k].band == Band::Impact);
            let simulated = |k: usize| features.as_ref().map_or_else(|| by_signature(k), |f| f[run][k]);
            cost += impacts.map(|k| self.likelihood().wrong_way(frame.measured[k], simulated(k))).sum::<f64>();
        }
        cost.min(self.likelihood().wrong_impacts)
    }

    /// Whether an effect strikes at a place, up or down.
    pub fn strikes(&self, signature: &Signature) -> bool {
        let candidates = self.candidates();
        let places = candidates.iter().any(|c| c.alternative_to == Some(signature.candidate));
        let placed = places || candidates[signature.candidate].alternative_to.is_some();
        placed && candidates[signature.candidate].strengths[signature.strength].low < 0.0
    }

    /// In what the members of a hypothesis differ by chance.
    fn random_effect(&self, fitted: &Fitted) -> Vec<RandomEffect> {
        fitted.hypothesis.members.iter().filter_map(|c| self.candidates()[*c].random_effect).collect()
    }

    /// What runs have in common speaks against what differs from lap to lap, and what they have not against what
    /// differs from cart to cart.
    fn in_common(&self, fitted: &Fitted, repeatability: &Repeatability) -> f64 {
        let random_effect = self.random_effect(fitted);
        if random_effect.is_empty() {
            return 0.0;
        }
        let expected =
            if random_effect.iter().all(|d| *d == RandomEffect::ByCart) { repeatability.common } else { 0.0 };
        self.likelihood().in_common(
            self.seen_in_common(fitted),
            expected,
            self.observations.len(),
            self.degrees_of_freedom,
        )
    }

    /// How much runs have in common of what a hypothesis leaves.
    fn seen_in_common(&self, fitted: &Fitted) -> f64 {
        let left = std::slice::from_ref(&fitted.residuals);
        observation::in_common(self.simulator.frames(), &self.observations, left)
    }

    /// What the nominal model leaves of each run.
    pub fn residuals(&self) -> PerRun<DVector<f64>> {
        self.observations.iter().map(|o| o.residual.clone()).collect()
    }

    pub fn context(&self) -> Context<'_> {
        Context { simulator: self.simulator, settings: self.settings }
    }

    /// Constants of likelihoods.
    pub fn likelihood(&self) -> &Likelihood {
        &self.settings.likelihood
    }

    /// How surely a direction is in residuals of all runs.
    pub fn tested(&self, residuals: &PerRun<DVector<f64>>, direction: &PerRun<DVector<f64>>) -> ScoreTest {
        ScoreTest::new(&self.settings.significance, &self.observations, residuals, direction)
    }

    /// How surely what a hypothesis changes is in what is off.
    pub fn score_test(&self, fitted: &Fitted) -> ScoreTest {
        let direction = fitted.direction();
        let along = |k: SignatureId, column: &PerRun<DVector<f64>>| {
            self.as_built(k) * column.iter().zip(&direction).map(|(c, d)| c.dot(d)).sum::<f64>()
        };
        let own = fitted.hypothesis.signatures.iter().zip(&fitted.columns).map(|(k, column)| along(*k, column));
        self.tested(&self.residuals(), &direction).with_scatter(own)
    }

    /// How surely a signature is in what is off.
    fn signature_test(&self, signature: SignatureId, residuals: &PerRun<DVector<f64>>) -> ScoreTest {
        let columns = &self.signatures[signature].columns;
        let square = norm_squared(columns);
        self.tested(residuals, columns).with_scatter([self.as_built(signature) * square])
    }

    /// What every built machine has of a signature's strength, and what sensors are accurate to.
    fn as_built(&self, signature: SignatureId) -> f64 {
        let Signature { candidate, strength, .. } = self.signatures[signature];
        let candidate = &self.candidates()[candidate];
        let strength = &candidate.strengths[strength];
        let ratio = candidate.sensor && strength.unit.is_empty();
        strength.as_built.max(if ratio { self.settings.significance.accuracy } else { 0.0 })
    }

    /// Log likelihood by what scores say for a hypothesis, so far as they count; of a pair for each of both, whatever
    /// says it of the first.
    fn along_signature(&self, fitted: &Fitted, counts: f64) -> f64 {
        let hypothesis = &fitted.hypothesis;
        let z = self.score_test(fitted).z().max(0.0);
        let nothing = self.likelihood().log_likelihood(self.mean_square, self.degrees_of_freedom);
        let supported = |z: f64, strengths: usize| {
            counts * self.settings.significance.support(z) - self.likelihood().score_cost * strengths as f64
        };
        if hypothesis.members.len() < 2 {
            return nothing + supported(z, hypothesis.signatures.len());
        }
        let residuals = self.residuals();
        let each = hypothesis.signatures.iter().map(|k| (self.signature_test(*k, &residuals), *k));
        let Some((first, signature)) = each.max_by(|a, b| a.0.z().abs().total_cmp(&b.0.z().abs())) else {
            return nothing;
        };
        let candidate = self.signatures[signature].candidate;
        let (own, others): (Vec<SignatureId>, Vec<SignatureId>) =
            hypothesis.signatures.iter().partition(|k| self.signatures[**k].candidate == candidate);
        let alone = Hypothesis { members: vec![candidate], signatures: own };
        let left = alone.screened(&self.observations, &self.signatures, self.candidates());
        let told = self
            .likelihood()
            .log_likelihood(overall_mean_square(&self.observations, &left.residuals), self.degrees_of_freedom);
        let scores: Vec<(SignatureId, ScoreTest)> =
            others.iter().map(|k| (*k, self.signature_test(*k, &residuals))).collect();
        let second = self.seen_beyond(&left, &scores);
        let first = first.z().abs().min(z);
        let both = told.max(nothing + supported(first, alone.signatures.len())) + supported(second, others.len());
        // No more than both scores say together, or what leaves nothing: one effect that does as well has no second to
        // be supported.
        let together = nothing + supported(trig::hypot(first, second), hypothesis.signatures.len());
        both.min(together.max(self.likelihood().log_likelihood(0.0, self.degrees_of_freedom)))
    }

    /// What the equations of a hypothesis miss along other signatures, of what it changes by some columns. Those of
    /// sensors are exact.
    fn missed(&self, fitted: &Fitted, columns: &[PerRun<DVector<f64>>]) -> f64 {
        let sensor = |k: &SignatureId| self.candidates()[self.signatures[*k].candidate].sensor;
        let own = fitted.hypothesis.signatures.iter().zip(&fitted.strengths);
        let inexact: Vec<f64> = own.map(|(k, x)| if sensor(k) { 0.0 } else { *x }).collect();
        self.settings.significance.missed * norm(&along(columns, &inexact))
    }

    /// The hypotheses with what is seen of signatures beyond each, which speaks against it. The likeliest first.
    fn without_what_is_seen_beyond(&self, mut scored: Vec<Scored>) -> Vec<Scored> {
        scored::sort(&mut scored);
        let residuals = self.residuals();
        let scores: Vec<(SignatureId, ScoreTest)> =
            self.signatures.ids().map(|k| (k, self.signature_test(k, &residuals))).collect();
        let with = |(rank, scored): (usize, Scored)| {
            let counts = self.likelihood().counts(scored.mean_square);
            if rank >= self.settings.selection.compared || counts <= 0.0 {
                return scored;
            }
            let rest = match &scored.repeatability {
                Some(repeatability) => self.seen_before(repeatability, &scored.fitted),
                None => self.seen_beyond(&scored.fitted, &scores),
            };
            let beyond = counts * self.beyond(rest);
            Scored { terms: Terms { beyond, ..scored.terms }, ..scored }
        };
        let mut scored: Vec<Scored> = scored.into_iter().enumerate().map(with).collect();
        scored::sort(&mut scored);
        scored
    }

    /// The largest score of signatures in what a hypothesis leaves, given those in all that is off.
    fn seen_beyond(&self, fitted: &Fitted, scores: &[(SignatureId, ScoreTest)]) -> f64 {
        let missed = self.missed(fitted, &fitted.columns);
        let rest = |(signature, score): &(SignatureId, ScoreTest)| {
            let columns = &self.signatures[*signature].columns;
            let left = if fitted.features.is_some() {
                self.signature_test(*signature, &fitted.residuals)
            } else {
                let along = columns.iter().zip(&fitted.residuals).map(|(c, r)| c.dot(r)).sum();
                ScoreTest { along, ..*score }
            };
            left.with_scatter([missed * norm(columns)]).z().abs()
        };
        scores.iter().map(rest).fold(0.0, f64::max)
    }

    /// The same before the repeatability that the hypothesis makes itself.
    fn seen_before(&self, repeatability: &Repeatability, fitted: &Fitted) -> f64 {
        let missed = self.missed(fitted, &repeatability.columns);
        let rest = |k: SignatureId| {
            let own = repeatability.observations.iter().zip(&self.signatures[k].change);
            let columns: PerRun<DVector<f64>> = own.map(|(own, change)| own.column(change)).collect();
            let score = ScoreTest::new(
                &self.settings.significance,
                &repeatability.observations,
                &repeatability.residuals,
                &columns,
            );
            let size = norm(&columns);
            score.with_scatter([self.as_built(k) * size * size, missed * size]).z().abs()
        };
        self.signatures.ids().map(rest).fold(0.0, f64::max)
    }

    /// What a score says that is the largest of as many as there are signatures.
    fn beyond(&self, z: f64) -> f64 {
        (self.settings.significance.support(z) - trig::ln(self.signatures.len().max(1) as f64)).max(0.0)
    }

    /// Log posterior of something unknown: it explains what the best effect of the library does.
    fn unknown(&self, scored: &[Scored]) -> f64 {
        let best = scored.first();
        let known = self.likelihood().unknown(self.mean_square, self.degrees_of_freedom);
        let counts = self.likelihood().counts(self.mean_square);
        let by_signature = best.filter(|_| counts > 0.0).map(|best| {
            let gain = counts * self.beyond(self.score_test(&best.fitted).z());
            self.likelihood().log_likelihood(self.mean_square, self.degrees_of_freedom) + gain
                - likelihood::cost(self.likelihood().unknown_strengths, self.degrees_of_freedom)
        });
        let alike = scored.iter().filter_map(|j| self.alike(j)).fold(f64::NEG_INFINITY, f64::max);
        trig::ln(self.likelihood().prior_unknown)
            + by_signature.map_or(known, |by_signature| known.max(by_signature)).max(alike)
    }

    /// What differs by chance has patterns along the track of nearly any shape, so something unknown that sits at
    /// places may have the same ones, but in all runs: what these say for it where a hypothesis is of that kind, and
    /// nothing else. What the hypothesis changes in the mean lap is its own.
    fn alike(&self, scored: &Scored) -> Option<f64> {
        let fitted = &scored.fitted;
        let repeatability = scored
            .repeatability
            .as_ref()
            .filter(|_| self.random_effect(fitted).len() >= fitted.hypothesis.members.len())?;
        let patterns =
            overall_mean_square(&repeatability.observations, repeatability.observations.iter().map(|o| &o.residual));
        let by_patterns =
            self.likelihood().log_likelihood(trig::exp(repeatability.raised) * patterns, self.degrees_of_freedom);
        let own =
            (self.likelihood().log_likelihood(scored.mean_square, self.degrees_of_freedom) - by_patterns).max(0.0);
        let said = scored.log_posterior() - self.prior(&fitted.hypothesis)
            + (scored.terms.in_common + scored.terms.impacts)
            - own;
        let seen = self.seen_in_common(fitted);
        let placed = self.likelihood().in_common(
            seen,
            seen.max(self.likelihood().placed),
            self.observations.len(),
            self.degrees_of_freedom,
        );
        Some(
            trig::ln(self.likelihood().patterned) + said
                - placed
                - self.likelihood().strange(self.mean_square, scored.mean_square, self.degrees_of_freedom),
        )
    }
}
