//! The fast screen: signatures of all effects, at the sizes that a run asks for.

use super::ids::{CandidateId, PerRun};
use super::observation::{Observation, most_off};
use super::signature::{Runs, Signature, Signatures, Trial, keep, take};
use super::simulator::Context;
use super::sizes::{Sized, sized};
use nalgebra::DVector;

/// Signatures of all strengths of the wanted candidates that stand for themselves, at a size at which they are clear,
/// and do as much as is left of the runs. Those that are looked for only beside others come later.
pub fn signatures(
    context: Context,
    observations: &PerRun<Observation>,
    left: &PerRun<DVector<f64>>,
    wanted: impl Fn(CandidateId) -> bool,
    tell: &mut dyn FnMut(usize, usize),
) -> Signatures {
    let candidates = context.simulator.candidates();
    let alone = candidates.ids().filter(|c| candidates[*c].alternative_to.is_none() && wanted(*c));
    let firsts: Vec<Trial> = alone
        .flat_map(|candidate| {
            let strengths = candidates[candidate].strengths.iter().enumerate().filter(|(_, s)| !s.beside);
            strengths.map(move |(strength, s)| Trial { candidate, strength, size: s.trial })
        })
        .collect();
    let gap = observations.iter().zip(left).any(|(o, left)| o.mean_square(left) > 1.0);
    let (before, all) = if gap { (firsts.len(), 2 * firsts.len()) } else { (0, firsts.len()) };
    let (trials, telling) = match gap {
        true => {
            let sized = sized(context, observations, left, &firsts, &mut |done| tell(done, all));
            let telling = telling(context, observations, left, &sized);
            (sized.into_iter().map(|s| s.trial).collect(), telling)
        }
        false => (firsts.clone(), vec![true; firsts.len()]),
    };
    let frames = context.simulator.frames();
    let mut found = Signatures::default();
    let mut small = Vec::new();
    let told: Vec<Trial> = trials.iter().zip(&telling).filter(|(_, tells)| **tells).map(|(t, _)| *t).collect();
    let mut taken = take(context, observations, &told, Runs::All, &mut |done| tell(before + done, all)).into_iter();
    for ((trial, tells), first) in trials.iter().zip(telling).zip(firsts) {
        if !tells {
            found.push(Signature::nothing(*trial, observations, frames));
            continue;
        }
        let Some((signature, whole)) = taken.next() else { continue };
        if whole {
            found.push(signature);
        } else if signature.size != first.size {
            small.push(first);
        }
    }
    // What cannot be simulated in every run has no signature: it was not tested.
    let again = take(context, observations, &small, Runs::All, &mut |_| tell(all, all));
    found.extend(again.into_iter().filter(|(_, whole)| *whole).map(|(signature, _)| signature));
    found.sort_by_key(|s| (s.candidate, s.strength));
    // An impact at a place has no sign as long as the place is not known.
    let signed = |s: &&Signature| {
        let placed = candidates.iter().any(|c| c.alternative_to == Some(s.candidate));
        let low = candidates[s.candidate].strengths[s.strength].low;
        gap && placed && low < 0.0 && !s.is_nothing()
    };
    let others: Vec<Trial> = found.iter().filter(signed).map(|s| s.trial().other()).collect();
    for (signature, whole) in take(context, observations, &others, Runs::All, &mut |_| tell(all, all)) {
        if whole {
            keep(&mut found, signature, left);
        }
    }
    found
}

/// Which of them are worth simulations of all runs: those that tell something of what is left of the run they were taken
/// in, or of what the best of them together leave there (orthogonal matching pursuit, Pati, Rezaiifar and Krishnaprasad
/// 1993); those that could not be simulated, and those that every built machine has.
fn telling(
    context: Context,
    observations: &PerRun<Observation>,
    left: &PerRun<DVector<f64>>,
    sized: &[Sized],
) -> Vec<bool> {
    let settings = &context.settings.screening;
    let candidates = context.simulator.candidates();
    let run = most_off(observations, left);
    // Where little is left, a score over all runs may see what none shows.
    if observations[run].mean_square(&left[run]) < settings.selects_from {
        return vec![true; sized.len()];
    }
    let free = |trial: &Trial| candidates[trial.candidate].sensor && context.simulator.applies_sensor_models();
    let known = |s: &Sized| {
        let strength = &candidates[s.trial.candidate].strengths[s.trial.strength];
        s.signature.is_none() || strength.as_built > 0.0 || free(&s.trial)
    };
    let mut tells: Vec<bool> = sized.iter().map(known).collect();
    let mut residual = left[run].clone();
    // Orthonormal, of what was taken out.
    let mut out: Vec<DVector<f64>> = Vec::new();
    for _ in 0..settings.selections {
        let worth = (settings.telling_share * residual.norm_squared())
            .max(settings.telling_score * settings.telling_score * observations[run].replicate);
        let explains = |s: &Sized| {
            let mut own = s.signature.as_ref()?.columns[run].clone();
            let whole = own.norm_squared();
            out.iter().for_each(|q| own -= q * q.dot(&own));
            let square = own.norm_squared();
            let along = own.dot(&residual);
            let one_sign = candidates[s.trial.candidate].strengths[s.trial.strength].low >= 0.0;
            let wrong = one_sign && out.is_empty() && along < 0.0;
            (square > 1e-6 * whole && square > 0.0 && !wrong).then(|| (along * along / square, own / square.sqrt()))
        };
        let each: Vec<Option<(f64, DVector<f64>)>> = sized.iter().map(explains).collect();
        for (tells, one) in tells.iter_mut().zip(&each) {
            *tells |= one.as_ref().is_some_and(|(square, _)| *square > worth);
        }
        let Some((_, best)) = each.into_iter().flatten().max_by(|a, b| a.0.total_cmp(&b.0)) else { break };
        residual -= &best * best.dot(&residual);
        out.push(best);
    }
    tells
}
