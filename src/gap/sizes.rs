//! At which strengths the screen takes signatures: those at which they do as much as is left of a run. What an effect
//! does is seldom in proportion to its strength, and a fit that begins far off ends far off.

use super::ids::{PerRun, RunId};
use super::observation::{Observation, most_off};
use super::settings::Screening;
use super::signature::{Runs, Signature, Trial, take};
use super::simulator::{Candidates, Context};
use crate::base::trig;
use nalgebra::DVector;

/// A trial at the size that a run asks for, and the last signature in that run that led to it; none where it could not
/// be simulated.
pub struct Sized {
    pub trial: Trial,
    pub signature: Option<Signature>,
}

/// Which way strengths are tried.
#[derive(Clone, Copy)]
enum Sign {
    Plus,
    Minus,
}

/// Trials at the sizes that the run asks for of which most is left.
pub fn sized(
    context: Context,
    observations: &PerRun<Observation>,
    left: &PerRun<DVector<f64>>,
    firsts: &[Trial],
    tell: &mut dyn FnMut(usize),
) -> Vec<Sized> {
    let settings = &context.settings.screening;
    let candidates = context.simulator.candidates();
    let run = most_off(observations, left);
    let mut all: Vec<Sized> = firsts.iter().map(|trial| Sized { trial: *trial, signature: None }).collect();
    // What is there of an effect where hardly a gap is has no strength far from the first.
    let large = observations[run].mean_square(&left[run]) >= settings.selects_from;
    let few = |k: &usize| large && few(candidates, firsts[*k], settings.few_places);
    let signed = |k: &usize| candidates[firsts[*k].candidate].strengths[firsts[*k].strength].low < 0.0;
    let (one_sign, mut open): (Vec<usize>, Vec<usize>) = (0..all.len()).partition(|k| few(k) && !signed(k));
    for _ in 0..settings.resizings {
        let now: Vec<Trial> = open.iter().map(|k| all[*k].trial).collect();
        let before = all.len() - open.len();
        let taken = take(context, observations, &now, Runs::One(run), &mut |done| tell(before + done));
        let mut again = Vec::new();
        for (k, (signature, whole)) in open.into_iter().zip(taken) {
            let own = &mut all[k];
            let strength = &candidates[own.trial.candidate].strengths[own.trial.strength];
            if whole {
                let size =
                    asked(&signature, &observations[run], run, &left[run], (strength.low, strength.high), settings);
                if !strength.whole() && !(0.5..2.0).contains(&(size / own.trial.size)) {
                    own.trial.size = size;
                    again.push(k);
                }
                own.signature = Some(signature);
            } else {
                // As large as could be simulated.
                own.trial = firsts[k];
            }
        }
        open = again;
    }
    let ladders = Ladders { context, observations, run, left, firsts };
    ladders.climb(&mut all, one_sign.into_iter().map(|k| (k, Sign::Plus)).collect(), tell);
    // What has two signs begins where it is small, as signs differ there. Where it is large it may do something else,
    // which is looked for unless something explains nearly all that is left.
    if large && !all.iter().any(|one| ladders.explains(one)) {
        let both = (0..all.len()).filter(|k| few(k) && signed(k)).flat_map(|k| [(k, Sign::Plus), (k, Sign::Minus)]);
        ladders.climb(&mut all, both.collect(), tell);
    }
    all
}

/// Strengths a factor apart, in one run.
struct Ladders<'a> {
    context: Context<'a>,
    observations: &'a PerRun<Observation>,
    run: RunId,
    left: &'a PerRun<DVector<f64>>,
    firsts: &'a [Trial],
}

impl Ladders<'_> {
    /// Tries larger strengths until they do far more than there is to explain. Where none explains anything, the first
    /// that is clear is taken, or the largest.
    fn climb(&self, all: &mut [Sized], mut open: Vec<(usize, Sign)>, tell: &mut dyn FnMut(usize)) {
        let Ladders { context, observations, run, left, firsts } = *self;
        let (settings, candidates) = (&context.settings.screening, context.simulator.candidates());
        let left = &left[run];
        let gap = left.norm_squared();
        let nothing = settings.rung_left * gap;
        let mut least = vec![nothing; all.len()];
        for rung in 0..settings.rungs {
            let share = rung as f64 / (settings.rungs - 1) as f64;
            let tried: Vec<Trial> = open.iter().map(|(k, sign)| firsts[*k].rung(candidates, share, *sign)).collect();
            let taken = take(context, observations, &tried, Runs::One(run), &mut |_| tell(all.len()));
            let mut again = Vec::new();
            for (((k, sign), trial), (signature, whole)) in open.into_iter().zip(tried).zip(taken) {
                if !whole {
                    continue;
                }
                let left = (left - &signature.columns[run] * trial.size).norm_squared();
                if left < settings.overshot * gap {
                    again.push((k, sign));
                }
                let clear = |s: &Signature| s.columns[run].amax() * s.size.abs() >= settings.clear;
                let better = match &all[k].signature {
                    None => true,
                    Some(before) => left < least[k] || (least[k] == nothing && !clear(before)),
                };
                if better {
                    least[k] = least[k].min(left);
                    all[k] = Sized { trial, signature: Some(signature) };
                }
            }
            open = again;
        }
    }

    /// Whether it explains nearly all that is left.
    fn explains(&self, one: &Sized) -> bool {
        let explained = one.signature.as_ref().map_or(0.0, |signature| signature.explains(self.left));
        let gap = self.left[self.run].norm_squared();
        gap - explained < self.context.settings.screening.explained * gap
    }
}

/// Whether an effect has few places, `most` of them.
fn few(candidates: &Candidates, trial: Trial, most: usize) -> bool {
    let own = &candidates[trial.candidate];
    let alike = candidates.iter().filter(|c| c.alternative_to.is_none() && c.effect == own.effect);
    !own.sensor && alike.count() <= most
}

impl Trial {
    /// At a share of the way, by factors, from half its own strength to half of what may be.
    fn rung(self, candidates: &Candidates, share: f64, sign: Sign) -> Trial {
        let strength = &candidates[self.candidate].strengths[self.strength];
        let (sign, most) = match sign {
            Sign::Plus => (1.0, strength.high),
            Sign::Minus => (-1.0, -strength.low),
        };
        let (low, high) = (0.5 * self.size, 0.5 * most);
        Trial { size: sign * low * trig::exp(share * trig::ln(high / low)), ..self }
    }
}

/// The strength at which an effect does as much in a run as is left to explain, and is clear: few effects are linear,
/// and power grows with the square at first.
fn asked(
    signature: &Signature,
    observation: &Observation,
    run: RunId,
    left: &DVector<f64>,
    (low, high): (f64, f64),
    settings: &Screening,
) -> f64 {
    let column = &signature.columns[run];
    let own = column.norm_squared().max(1e-300);
    let gap = left.norm_squared() - observation.replicate * observation.features() as f64;
    let size = (gap.max(0.0) / own).sqrt().max(1.5 * settings.clear / column.amax().max(1e-300));
    let now = signature.size.abs();
    let size = size.clamp(now / settings.resize_factor, now * settings.resize_factor);
    // A strength that has one sign only keeps it.
    let negative = if high > 0.0 { low < 0.0 && column.dot(left) < 0.0 } else { true };
    if negative { -size.min(-0.5 * low) } else { size.min(0.5 * high) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::ids::{CandidateId, Id};
    use crate::gap::settings::Settings;
    use crate::gap::simulator::Candidate;
    use crate::gap::two_effects::TwoEffects;

    /// `moved` moves waves along, the later ones farther, as another length of the track does; `level` is in proportion to
    /// its strength.
    fn done([moved, level]: [f64; 2], k: usize) -> f64 {
        let wave = |x: f64| 20.0 * trig::sin(0.5 * k as f64 + x * (1.0 + k as f64 / 40.0));
        wave(moved) - wave(0.0) + level
    }

    /// Of what is measured, the size at which `moved` is taken.
    fn taken(truth: [f64; 2]) -> f64 {
        let candidates = [Candidate::bare("moved", 0.1, (-10.0, 10.0)), Candidate::bare("level", 0.1, (-50.0, 50.0))];
        let (model, settings) = (TwoEffects::new(candidates, done, truth, 7), Settings::default());
        let observations: PerRun<Observation> =
            model.frames.iter().map(|f| Observation::new(f, &[], &settings)).collect();
        let left: PerRun<DVector<f64>> = observations.iter().map(|o| o.residual.clone()).collect();
        let trial = |n: usize| Trial { candidate: CandidateId::new(n), strength: 0, size: 0.1 };
        let context = Context { simulator: &model, settings: &settings };
        let all = sized(context, &observations, &left, &[trial(0), trial(1)], &mut |_| ());
        all[0].trial.size
    }

    #[test]
    fn what_moves_waves_far_is_met_with_its_sign() {
        // What a small strength does is at nearly a right angle to it, and asks for the other sign.
        for truth in [-2.0, 2.0] {
            let size = taken([truth, 0.0]);
            assert!((size - truth).abs() < 0.1, "{size}");
        }
    }

    #[test]
    fn where_something_explains_all_strengths_stay_small() {
        let size = taken([0.0, 30.0]);
        assert!(size.abs() < 1.5, "{size}");
    }
}
