//! The diagnosis: screen, re-fit, judge.

use super::chance::Chance;
use super::court::{Court, Judged, mean_excess};
use super::diagnosis::Diagnosis;
use super::evidence::Evidence;
use super::floor::floors;
use super::judge::MOST_FREEDOM;
use super::refit::{Fitted, Hypothesis, refit};
use super::report::report;
use super::screen::{self, Runs, Signature, Trial};
use super::simulator::{Candidate, Simulator};
use super::tune::Tuner;
use std::collections::{BTreeMap, BTreeSet};

/// Hypotheses that are re-fitted, and of these single effects at least.
const REFITTED: (usize, usize) = (8, 4);

/// Candidates of which pairs are made.
const PAIRED: usize = 12;

/// How often a closer look is taken, at how many effects, and what share of the gap they must explain.
const LOOKS: usize = 3;
const LOOKED_AT: usize = 4;
const WORTH: f64 = 0.02;

/// Pairs of which a member that strikes is tried with the other sign: those that are likeliest before.
const TURNED_PAIRS: usize = 2;

/// Signatures of sensors' effects that are taken again at most: they need no simulation, and what a shift does to a narrow channel's distribution
/// is in proportion to nothing.
const SENSORS: usize = 24;

/// How far a strength that fits may be from the one that a signature was taken at, as factors; of a sensor's effect.
const NEAR: std::ops::Range<f64> = 0.6..1.6;
const NEAR_SENSOR: std::ops::Range<f64> = 0.9..1.1;

/// Hypotheses that are held against a floor of their own at most, and what share of the gap they must explain.
const FLOORS: usize = 5;
const SOME: f64 = 0.05;

/// A score from which on there is something to look at though the mean square is at the floor.
const HEARD: f64 = 4.0;

/// How far a diagnosis is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Stage {
    Screening { done: usize, of: usize },
    Fitting { done: usize, of: usize },
}

/// Diagnoses the gap between a model and its runs.
pub fn diagnose(simulator: &dyn Simulator, tell: &mut dyn FnMut(Stage)) -> Diagnosis {
    let frames = simulator.frames();
    let evidence: Vec<Evidence> = frames.iter().map(|f| Evidence::new(f, &[])).collect();
    let candidates = simulator.candidates();
    let mut signatures = screen::signatures(simulator, &evidence, &mut |done, of| tell(Stage::Screening { done, of }));
    // What every built machine has of the effects is no gap, once their signatures are known.
    let usual = |run: usize| -> Vec<Vec<f64>> {
        let strength = |s: &Signature| candidates[s.candidate].strengths[s.strength].usual;
        let some = signatures.iter().filter(|s| strength(s) > 0.0);
        some.map(|s| s.change[run].iter().map(|x| x * strength(s)).collect()).collect()
    };
    let usual: Vec<Vec<Vec<f64>>> = (0..frames.len()).map(usual).collect();
    let evidence: Vec<Evidence> = frames.iter().zip(&usual).map(|(f, usual)| Evidence::new(f, usual)).collect();
    for signature in &mut signatures {
        signature.columns = evidence.iter().zip(&signature.change).map(|(e, c)| e.column(c)).collect();
    }
    let freedom = evidence.iter().map(|e| e.freedom).sum::<f64>().min(MOST_FREEDOM);
    let mut court = Court { simulator, excess: 0.0, evidence, signatures, freedom, judged: Vec::new(), unknown: 0.0 };
    court.excess = mean_excess(&court.evidence, court.evidence.iter().map(|e| &e.residual));

    // Where there is no gap there is nothing to look at more closely; one that only scores tell of is too small to be fitted by simulation.
    let gap = court.excess > 1.0;
    let heard = gap || court.singles().iter().any(|j| court.score(&j.fitted).z() > HEARD);
    if heard {
        court.tune();
    }
    for _ in 0..if heard { LOOKS } else { 0 } {
        court.look_closer(&mut |done, of| tell(Stage::Screening { done, of }));
    }
    let singles = court.singles();
    let first = |judged: &Judged| judged.fitted.hypothesis.members[0];
    let mut pairs: Vec<Judged> = Vec::new();
    // Each candidate once, in whichever way it is likeliest: a pair has some of its strengths, or all.
    let mut met = BTreeSet::new();
    let leading: Vec<&Judged> = singles.iter().filter(|j| met.insert(first(j))).collect();
    for (rank, a) in leading.iter().enumerate().take(PAIRED) {
        for b in &leading[rank + 1..] {
            let (x, y) = (first(a), first(b));
            if candidates[x].effect != candidates[y].effect {
                let ways = |c: usize| {
                    singles.iter().filter(move |j| first(j) == c).map(|j| &j.fitted.hypothesis.signatures[..])
                };
                for (one, two) in ways(x).flat_map(|one| ways(y).map(move |two| (one, two))) {
                    pairs.push(court.screened(Hypothesis { members: vec![x, y], signatures: [one, two].concat() }));
                }
            }
        }
    }
    pairs.sort_by(|a, b| b.weight.total_cmp(&a.weight));
    let (mut chosen, mut rest) = court.shortlist(singles, pairs);
    if !gap {
        rest.append(&mut chosen);
    }
    let turned = court.turned(&chosen);
    let chosen = chosen.into_iter().map(|j| j.fitted).chain(turned).collect();
    let fitted = refit(simulator, &court.evidence, &court.signatures, chosen, &mut |done, of| {
        tell(Stage::Fitting { done, of });
    });
    let chance = Chance { simulator, nominal: &court.evidence, usual: &usual, signatures: &court.signatures };
    let scattered = if gap { chance.hypotheses() } else { Vec::new() };
    let asked = court.worth_a_floor(&fitted);
    let some: Vec<&Fitted> = fitted.iter().zip(&asked).filter(|(_, asked)| **asked).map(|(f, _)| f).collect();
    let mut own = floors(simulator, &court.evidence, &usual, &court.signatures, &some).into_iter();
    let mut judged: Vec<Judged> = Vec::new();
    for (fitted, asked) in fitted.into_iter().zip(asked) {
        let floor = if asked { own.next().flatten() } else { None };
        // A pair of which one does nothing is the other one alone.
        if fitted.all_there(&court.signatures) {
            judged.push(court.weigh(fitted, floor));
        }
    }
    judged.extend(scattered.into_iter().map(|(fitted, floor)| court.weigh(fitted, floor)));
    judged.extend(rest);
    court.settle(&mut judged);
    court.unknown = court.unknown(&judged);
    court.judged = judged;
    report(&court)
}

impl Court<'_> {
    fn tuner(&self) -> Tuner<'_> {
        Tuner { simulator: self.simulator, evidence: &self.evidence, signatures: &self.signatures }
    }

    /// Takes signatures of what costs no simulation at the strengths that fit best.
    fn tune(&mut self) {
        let candidates = self.simulator.candidates();
        let worth = WORTH * (self.excess - 1.0).max(0.0);
        let cheap = self.singles().into_iter().filter(|j| match j.fitted.hypothesis.signatures[..] {
            [own] => {
                let Signature { candidate, strength, .. } = self.signatures[own];
                self.tuner().hears(candidate)
                    && !candidates[candidate].strengths[strength].whole()
                    && self.excess - j.excess > worth
            }
            _ => false,
        });
        let cheap: Vec<Fitted> = cheap.take(SENSORS).map(|j| j.fitted).collect();
        for Fitted { hypothesis, strengths, .. } in cheap {
            let tuned = self.tuner().tuned(&hypothesis, &strengths);
            let Some(tuned) = tuned.filter(|t| t.strengths[0] != 0.0) else { continue };
            let size = tuned.strengths[0];
            let change = tuned.changes.iter().map(|run| run.iter().map(|x| x / size).collect()).collect();
            let columns = tuned.found.iter().map(|column| column / size).collect();
            let signature = Signature { size, change, columns, ..self.signatures[hypothesis.signatures[0]].clone() };
            screen::keep(&mut self.signatures, signature, &self.evidence);
        }
    }

    /// Takes signatures again where something is explained: at the strength that fits, as few effects are linear, and at the places
    /// beside.
    fn look_closer(&mut self, tell: &mut dyn FnMut(usize, usize)) {
        let mut trials: Vec<Trial> = Vec::new();
        let mut seen: BTreeSet<&str> = BTreeSet::new();
        let mut sensors = 0;
        let candidates = self.simulator.candidates();
        let worth = WORTH * (self.excess - 1.0).max(0.0);
        for judged in self.singles().iter().filter(|j| self.excess - j.excess > worth) {
            let ([own], [size]) = (&judged.fitted.hypothesis.signatures[..], &judged.fitted.strengths[..]) else {
                continue;
            };
            let signature = &self.signatures[*own];
            let candidate = &candidates[signature.candidate];
            sensors += usize::from(candidate.sensor);
            let room = match candidate.sensor {
                true if self.simulator.hears() => false,
                true => sensors <= SENSORS,
                false => seen.len() < LOOKED_AT && seen.insert(&candidate.effect),
            };
            if room {
                trials.extend(again(signature, candidate, *size));
                trials.extend(beside(signature, candidates, *size));
            }
        }
        let of = trials.len();
        let taken = screen::take(self.simulator, &self.evidence, &trials, Runs::All, &mut |done| tell(done, of));
        for (signature, _) in taken.into_iter().filter(|(_, whole)| *whole) {
            screen::keep(&mut self.signatures, signature, &self.evidence);
        }
    }

    /// The same effects with the other sign, where they strike at a place: up and down look nearly alike until they are simulated.
    fn turned(&mut self, chosen: &[Judged]) -> Vec<Fitted> {
        let candidates = self.simulator.candidates();
        let strikes = |signature: &Signature| {
            let places = candidates.iter().any(|c| c.beside == Some(signature.candidate));
            let placed = places || candidates[signature.candidate].beside.is_some();
            placed && candidates[signature.candidate].strengths[signature.strength].low < 0.0
        };
        let mut pairs = 0;
        let mut ways: Vec<(&Hypothesis, usize, Trial)> = Vec::new();
        for Fitted { hypothesis, strengths, .. } in chosen.iter().map(|j| &j.fitted) {
            pairs += usize::from(hypothesis.members.len() > 1);
            let mut own = hypothesis.signatures.iter().map(|own| &self.signatures[*own]).zip(strengths).enumerate();
            let Some((k, (signature, size))) = own.find(|(_, (signature, _))| strikes(signature)) else { continue };
            if hypothesis.members.len() == 1 || pairs <= TURNED_PAIRS {
                ways.push((hypothesis, k, Trial { size: -fitting(signature, *size), ..signature.trial() }));
            }
        }
        let trials: Vec<Trial> = ways.iter().map(|(.., trial)| *trial).collect();
        let taken = screen::take(self.simulator, &self.evidence, &trials, Runs::All, &mut |_| {});
        let mut turned = Vec::new();
        for ((hypothesis, k, _), (signature, _)) in ways.iter().zip(taken).filter(|(_, (_, whole))| *whole) {
            let mut hypothesis = (*hypothesis).clone();
            hypothesis.signatures[*k] = self.signatures.len();
            self.signatures.push(signature);
            turned.push(hypothesis.screened(&self.evidence, &self.signatures, candidates));
        }
        turned
    }

    /// Which fitted hypotheses are held against the floor that they make themselves: the best of those that explain something.
    fn worth_a_floor(&self, fitted: &[Fitted]) -> Vec<bool> {
        let excess: Vec<f64> = fitted.iter().map(|f| mean_excess(&self.evidence, &f.residuals)).collect();
        let mut order: Vec<usize> = (0..fitted.len()).collect();
        order.sort_by(|a, b| excess[*a].total_cmp(&excess[*b]));
        let worth =
            |k: &usize| fitted[*k].simulated() && self.excess - excess[*k] > SOME * (self.excess - 1.0).max(0.0);
        let best: BTreeSet<usize> = order.into_iter().filter(worth).take(FLOORS).collect();
        (0..fitted.len()).map(|k| best.contains(&k)).collect()
    }

    /// What is re-fitted: the best single effects, each at its best place, and the best of all; and the rest.
    fn shortlist(&self, singles: Vec<Judged>, pairs: Vec<Judged>) -> (Vec<Judged>, Vec<Judged>) {
        let (mut chosen, mut rest) = (Vec::new(), Vec::new());
        let mut seen: BTreeMap<Vec<&str>, usize> = BTreeMap::new();
        let mut all: Vec<Judged> = singles.into_iter().chain(pairs).collect();
        all.sort_by(|a, b| b.weight.total_cmp(&a.weight));
        let mut single = 0;
        for judged in all {
            let members = &judged.fitted.hypothesis.members;
            let mut names: Vec<&str> = members.iter().map(|c| self.candidates()[*c].effect.as_str()).collect();
            names.sort_unstable();
            let alone = members.len() == 1;
            let room = if alone {
                single < REFITTED.1 || chosen.len() < REFITTED.0
            } else {
                chosen.len() + REFITTED.1.saturating_sub(single) < REFITTED.0
            };
            let known = seen.entry(names).or_default();
            if room && *known == 0 && judged.fitted.strengths.iter().any(|x| *x != 0.0) {
                *known += 1;
                single += usize::from(alone);
                chosen.push(judged);
            } else {
                rest.push(judged);
            }
        }
        (chosen, rest)
    }
}

/// The strength that fits, no smaller than a signature is clear at: one that is not tells of the simulation's own chance.
fn fitting(signature: &Signature, size: f64) -> f64 {
    let clear = signature.clear() * size.signum();
    if size.abs() < clear.abs() { clear } else { size }
}

/// A signature at the strength that fits, where that is another than it was taken at.
fn again(signature: &Signature, candidate: &Candidate, size: f64) -> Option<Trial> {
    let (fits, before) = (fitting(signature, size), signature.size);
    let (near, again) = match candidate.sensor {
        // Between both, as a signature of too much asks for too little, and the other way round.
        true if fits * before > 0.0 => (NEAR_SENSOR, fits.signum() * (fits * before).sqrt()),
        true => (NEAR_SENSOR, fits),
        false => (NEAR, fits),
    };
    let there = size != 0.0 && !candidate.strengths[signature.strength].whole();
    (there && !near.contains(&(fits / before))).then_some(Trial { size: again, ..signature.trial() })
}

/// The same strength at the places beside, of either sign where it has one.
fn beside(signature: &Signature, candidates: &[Candidate], size: f64) -> Vec<Trial> {
    let size = if size == 0.0 { signature.size } else { fitting(signature, size) };
    let signed = candidates[signature.candidate].strengths[signature.strength].low < 0.0;
    let places = (0..candidates.len()).filter(|c| candidates[*c].beside == Some(signature.candidate));
    let at = |candidate: usize| {
        let trial = Trial { candidate, size, ..signature.trial() };
        [Some(trial), signed.then(|| trial.other())].into_iter().flatten()
    };
    places.flat_map(at).collect()
}
