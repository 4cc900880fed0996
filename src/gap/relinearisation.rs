//! Relinearisation: a signature is a linearisation at one strength, and few effects are in proportion to theirs. Where
//! an effect explains something, its signature is taken again at the strength that fits, as the steps of Gauss and
//! Newton's method take slopes anew (Bell and Cathey 1993).

use super::comparison::Comparison;
use super::ids::CandidateId;
use super::scored::Scored;
use super::screen;
use super::signature::{Runs, Signature, Trial, keep, take};
use super::simulator::Context;
use super::tune::Tuner;
use crate::gap::hypothesis::{Fitted, Hypothesis};
use std::collections::{BTreeMap, BTreeSet};

impl Comparison<'_> {
    /// With the signatures of what explains something taken again, and where there is a gap that one effect does not
    /// explain alone, of what is beside it.
    #[must_use]
    pub fn relinearised(mut self, gap: bool, tell: &mut dyn FnMut(usize, usize)) -> Self {
        let rounds = self.settings.relinearisation.rounds;
        self.tune();
        for _ in 0..rounds {
            self.relinearise(None, tell);
        }
        self.look_beside(tell);
        for round in 0..if gap { rounds } else { 0 } {
            let Some(leader) = self.leader() else { break };
            if round == 0 {
                self.screen_beside(&leader, tell);
            }
            self.relinearise(Some(&leader), tell);
        }
        self
    }

    pub fn tuner(&self) -> Tuner<'_> {
        Tuner {
            simulator: self.simulator,
            settings: self.settings,
            observations: &self.observations,
            signatures: &self.signatures,
        }
    }

    /// Takes signatures of what costs no simulation at the strengths that fit best.
    fn tune(&mut self) {
        let candidates = self.simulator.candidates();
        let worth = self.settings.relinearisation.worth * (self.mean_square - 1.0).max(0.0);
        let cheap = self.singles().into_iter().filter(|j| match j.fitted.hypothesis.signatures[..] {
            [own] => {
                let Signature { candidate, strength, .. } = self.signatures[own];
                self.tuner().applies_sensor_model(candidate)
                    && !candidates[candidate].strengths[strength].whole()
                    && self.mean_square - j.mean_square > worth
            }
            _ => false,
        });
        let cheap: Vec<Fitted> = cheap.take(self.settings.relinearisation.sensors).map(|j| j.fitted).collect();
        let left = self.residuals();
        for Fitted { hypothesis, strengths, .. } in cheap {
            let tuned = self.tuner().tuned(&hypothesis, &strengths);
            let Some(tuned) = tuned.filter(|t| t.strengths[0] != 0.0) else { continue };
            let size = tuned.strengths[0];
            let change = tuned.changes.iter().map(|run| run.iter().map(|x| x / size).collect()).collect();
            let columns = tuned.found.iter().map(|column| column / size).collect();
            let signature = Signature { size, change, columns, ..self.signatures[hypothesis.signatures[0]].clone() };
            keep(&mut self.signatures, signature, &left);
        }
    }

    /// Takes signatures again where something is explained: at the strength that fits, as few effects are linear, and
    /// at the places beside. Where another hypothesis leads, in what that one leaves.
    fn relinearise(&mut self, leader: Option<&Scored>, tell: &mut dyn FnMut(usize, usize)) {
        let settings = &self.settings.relinearisation;
        let mut trials: Vec<Trial> = Vec::new();
        // Each strength of an effect where it fits best.
        let mut seen: BTreeMap<&str, BTreeSet<usize>> = BTreeMap::new();
        let mut sensors = 0;
        let candidates = self.simulator.candidates();
        let before = leader.map_or(self.mean_square, |j| j.mean_square);
        let worth = self.settings.relinearisation.worth * (before - 1.0).max(0.0);
        let alone = self.singles().into_iter().filter(|j| j.fitted.strengths.len() == 1);
        let explaining = match leader {
            None => alone.collect(),
            Some(leader) => self.with_leader(leader, alone),
        };
        // What may lead instead keeps its signatures: beside the leader it is hardly there, and would be taken far too
        // small.
        let rivals = leader.map(|_| self.leading()).unwrap_or_default();
        for scored in explaining.iter().filter(|j| before - j.mean_square > worth) {
            let Fitted { hypothesis, strengths, .. } = &scored.fitted;
            let (Some(own), Some(size)) = (hypothesis.signatures.last(), strengths.last()) else { continue };
            let signature = &self.signatures[*own];
            let candidate = &candidates[signature.candidate];
            if rivals.contains(candidate.effect.as_str()) {
                continue;
            }
            sensors += usize::from(candidate.sensor);
            let room = match candidate.sensor {
                true if self.simulator.applies_sensor_models() => false,
                true => sensors <= settings.sensors,
                false => {
                    let effect = candidate.effect.as_str();
                    (seen.contains_key(effect) || seen.len() < settings.effects)
                        && seen.entry(effect).or_default().insert(signature.strength)
                }
            };
            if room {
                trials.extend(again(self.context(), signature, *size));
                trials.extend(at_alternatives(self.context(), signature, *size));
            }
        }
        let left = leader.map_or_else(|| self.residuals(), |j| j.fitted.residuals.clone());
        let of = trials.len();
        let taken = take(self.context(), &self.observations, &trials, Runs::All, &mut |done| tell(done, of));
        for (signature, _) in taken.into_iter().filter(|(_, whole)| *whole) {
            keep(&mut self.signatures, signature, &left);
        }
    }

    /// A single effect that explains most of the gap, where it leaves something.
    fn leader(&self) -> Option<Scored> {
        self.singles().into_iter().next().filter(|j| j.mean_square > self.settings.selection.unsettled && self.leads(j))
    }

    /// Whether it explains most of the gap.
    pub fn leads(&self, scored: &Scored) -> bool {
        scored.mean_square - 1.0 < self.settings.relinearisation.leads * (self.mean_square - 1.0)
    }

    /// Effects of which one alone leads.
    fn leading(&self) -> BTreeSet<String> {
        let effect = |j: Scored| self.simulator.candidates()[j.fitted.hypothesis.members[0]].effect.clone();
        self.singles().into_iter().filter(|j| self.leads(j)).map(effect).collect()
    }

    /// Takes signatures of the machine's other effects again where one leads, at sizes such as what that one leaves
    /// asks for; but not of those that may lead in its stead.
    fn screen_beside(&mut self, leader: &Scored, tell: &mut dyn FnMut(usize, usize)) {
        let (candidates, left) = (self.simulator.candidates(), &leader.fitted.residuals);
        let lead = self.leading();
        let others = |c: CandidateId| !candidates[c].sensor && !lead.contains(candidates[c].effect.as_str());
        for signature in screen::signatures(self.context(), &self.observations, left, others, tell) {
            // What could not be simulated tells nothing.
            if signature.change.iter().all(|run| run.iter().any(|x| *x != 0.0)) {
                keep(&mut self.signatures, signature, left);
            }
        }
    }

    /// Other effects beside one, the likeliest first.
    fn with_leader(&self, leader: &Scored, others: impl Iterator<Item = Scored>) -> Vec<Scored> {
        let effect = |j: &Scored| &self.simulator.candidates()[j.fitted.hypothesis.members[0]].effect;
        let others = others.filter(|j| effect(j) != effect(leader));
        let both: Vec<Hypothesis> = others.map(|j| leader.fitted.hypothesis.with(&j.fitted.hypothesis)).collect();
        self.likeliest(&both)
    }

    /// The same effects with the other sign, by signatures of their own, where they strike at a place: up and down look
    /// nearly alike until they are simulated.
    pub fn turned(mut self, chosen: &[Scored]) -> (Self, Vec<Fitted>) {
        let candidates = self.simulator.candidates();
        let mut pairs = 0;
        let mut ways: Vec<(&Hypothesis, usize, Trial)> = Vec::new();
        for Fitted { hypothesis, strengths, .. } in chosen.iter().map(|j| &j.fitted) {
            let mut own = hypothesis.signatures.iter().map(|own| &self.signatures[*own]).zip(strengths).enumerate();
            let Some((k, (signature, size))) =
                own.find(|(_, (signature, size))| self.strikes(signature) && **size != 0.0)
            else {
                continue;
            };
            pairs += usize::from(hypothesis.members.len() > 1);
            if hypothesis.members.len() == 1 || pairs <= self.settings.relinearisation.turned_pairs {
                ways.push((hypothesis, k, turned(self.context(), signature, *size)));
            }
        }
        let trials: Vec<Trial> = ways.iter().map(|(.., trial)| *trial).collect();
        let taken = take(self.context(), &self.observations, &trials, Runs::All, &mut |_| {});
        let mut found = Vec::new();
        for ((hypothesis, k, _), (signature, _)) in ways.iter().zip(taken).filter(|(_, (_, whole))| *whole) {
            let mut hypothesis = (*hypothesis).clone();
            hypothesis.signatures[*k] = self.signatures.push(signature);
            found.push(hypothesis.screened(&self.observations, &self.signatures, candidates));
        }
        (self, found)
    }
}

/// A signature's trial with the strength that fits, of the other sign.
pub fn turned(context: Context, signature: &Signature, size: f64) -> Trial {
    Trial { size: -fitting(context, signature, size), ..signature.trial() }
}

/// The strength that fits, no smaller than a signature is clear at, as one that is not tells of the simulation's own
/// chance; but never beyond its bounds.
fn fitting(context: Context, signature: &Signature, size: f64) -> f64 {
    let clear = signature.clear(&context.settings.screening) * size.signum();
    let fits = if size.abs() < clear.abs() { clear } else { size };
    context.simulator.candidates()[signature.candidate].strengths[signature.strength].bounded(fits)
}

/// A signature at the strength that fits, where that is another than it was taken at.
pub fn again(context: Context, signature: &Signature, size: f64) -> Option<Trial> {
    let settings = &context.settings.relinearisation;
    let candidate = &context.simulator.candidates()[signature.candidate];
    let (fits, before) = (fitting(context, signature, size), signature.size);
    let (near, again) = match candidate.sensor {
        // Between both, as a signature of too much asks for too little, and the other way round.
        true if fits * before > 0.0 => (&settings.near_sensor, fits.signum() * (fits * before).sqrt()),
        true => (&settings.near_sensor, fits),
        false => (&settings.near, fits),
    };
    let there = size != 0.0 && !candidate.strengths[signature.strength].whole();
    (there && !near.contains(&(fits / before))).then_some(Trial { size: again, ..signature.trial() })
}

/// The same strength at the places beside, of either sign where it has one.
pub fn at_alternatives(context: Context, signature: &Signature, size: f64) -> Vec<Trial> {
    let candidates = context.simulator.candidates();
    let size = if size == 0.0 { signature.size } else { fitting(context, signature, size) };
    let signed = candidates[signature.candidate].strengths[signature.strength].low < 0.0;
    let places = candidates.ids().filter(|c| candidates[*c].alternative_to == Some(signature.candidate));
    let at = |candidate: CandidateId| {
        let trial = Trial { candidate, size, ..signature.trial() };
        [Some(trial), signed.then(|| trial.other())].into_iter().flatten()
    };
    places.flat_map(at).collect()
}
