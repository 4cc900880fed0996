//! The fast screen: what each effect's signature explains, alone and in pairs, with the nuisances projected out.

use super::ids::{CandidateId, List, PerRun, RunId, SignatureId};
use super::observation::{Observation, most_off};
use super::settings::Screening;
use super::simulator::{Applied, Candidates, Context, Frame, Request};
use super::sizes::{Sized, sized};
use nalgebra::{DMatrix, DVector};

/// What a strength of a candidate changes, over all runs.
#[derive(Clone)]
pub struct Signature {
    pub candidate: CandidateId,
    pub strength: usize,
    /// The strength it was taken at.
    pub size: f64,
    /// Of each run, of one unit of the strength; all 0 where the run could not be simulated.
    pub change: PerRun<Vec<f64>>,
    /// The same whitened and projected.
    pub columns: PerRun<DVector<f64>>,
}

/// Signatures, a strength of a candidate once.
pub type Signatures = List<SignatureId, Signature>;

/// A strength of a candidate at a size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trial {
    pub candidate: CandidateId,
    pub strength: usize,
    pub size: f64,
}

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

/// Keeps a signature, unless one that was taken with the other sign explains more of what is left of each run.
pub fn keep(found: &mut Signatures, signature: Signature, left: &PerRun<DVector<f64>>) {
    let same = |s: &&mut Signature| (s.candidate, s.strength) == (signature.candidate, signature.strength);
    match found.iter_mut().find(same) {
        Some(known) => {
            let turned = known.size * signature.size < 0.0;
            if !turned || known.explains(left) < signature.explains(left) {
                *known = signature;
            }
        }
        None => {
            found.push(signature);
        }
    }
}

impl Signature {
    /// As it was taken.
    pub fn trial(&self) -> Trial {
        Trial { candidate: self.candidate, strength: self.strength, size: self.size }
    }

    /// Of a trial that tells nothing of the runs.
    fn nothing(
        Trial { candidate, strength, size }: Trial,
        observations: &PerRun<Observation>,
        frames: &PerRun<Frame>,
    ) -> Signature {
        let change = frames.iter().map(|f| vec![0.0; f.nominal.len()]).collect();
        let columns = observations.iter().map(|o| DVector::zeros(o.residual.len())).collect();
        Signature { candidate, strength, size, change, columns }
    }

    /// Whether it changes nothing.
    fn is_nothing(&self) -> bool {
        self.change.iter().flatten().all(|x| *x == 0.0)
    }

    /// The least strength at which it is clear.
    pub fn clear(&self, settings: &Screening) -> f64 {
        settings.clear / self.columns.iter().map(DVector::amax).fold(1e-300, f64::max)
    }

    /// How much of the squares of what is left it explains, with its own sign.
    pub fn explains(&self, left: &PerRun<DVector<f64>>) -> f64 {
        let (mut own, mut along) = (0.0, 0.0);
        for (column, left) in self.columns.iter().zip(left) {
            own += column.norm_squared();
            along += column.dot(left);
        }
        let along = (along * self.size.signum()).max(0.0);
        along * along / own.max(1e-300)
    }
}

impl Trial {
    /// At the nearest size that is declared.
    fn bounded(self, candidates: &Candidates) -> Trial {
        Trial { size: candidates[self.candidate].strengths[self.strength].bounded(self.size), ..self }
    }

    /// With the other sign.
    pub fn other(self) -> Trial {
        Trial { size: -self.size, ..self }
    }
}

/// Which runs a signature is taken of.
#[derive(Clone, Copy, Debug)]
pub enum Runs {
    All,
    One(RunId),
}

/// The signature of each trial, at the nearest size that is declared: 0 in runs of which it is not taken, and whether
/// every run could be simulated with it.
pub fn take(
    context: Context,
    observations: &PerRun<Observation>,
    trials: &[Trial],
    runs: Runs,
    tell: &mut dyn FnMut(usize),
) -> Vec<(Signature, bool)> {
    let Context { simulator, settings } = context;
    let settings = &settings.screening;
    let (candidates, frames) = (simulator.candidates(), simulator.frames());
    let runs: Vec<RunId> = match runs {
        Runs::All => observations.ids().collect(),
        Runs::One(run) => vec![run],
    };
    let trials: Vec<Trial> = trials.iter().map(|trial| trial.bounded(candidates)).collect();
    let mut found = Vec::with_capacity(trials.len());
    for part in trials.chunks(settings.batch.div_ceil(runs.len().max(1))) {
        tell(found.len() + part.len());
        let with = |trial: &Trial| {
            let effects = vec![applied(candidates, trial)];
            runs.iter().map(move |run| Request { run: *run, step: Vec::new(), effects: effects.clone() })
        };
        // The other sign of a strength that has one only is nothing.
        let something = |trial: &&Trial| trial.size != 0.0;
        let requests: Vec<Request> = part.iter().filter(something).flat_map(with).collect();
        let all = simulator.simulate_all(&requests);
        let mut all = all.chunks(runs.len().max(1));
        let nothing = vec![None; runs.len()];
        for trial in part {
            let answers = if trial.size == 0.0 { None } else { all.next() }.unwrap_or(&nothing);
            let mut change: PerRun<Vec<f64>> = frames.iter().map(|f| vec![0.0; f.nominal.len()]).collect();
            for (run, answer) in runs.iter().zip(answers) {
                let rows = answer.iter().flatten().zip(&frames[*run].nominal);
                change[*run].iter_mut().zip(rows).for_each(|(x, (a, b))| *x = (a - b) / trial.size);
            }
            let mut columns: PerRun<DVector<f64>> =
                observations.iter().zip(&change).map(|(o, c)| o.column(c)).collect();
            if columns.iter().all(|column| column.amax() * trial.size.abs() < settings.nothing) {
                change.iter_mut().for_each(|c| c.fill(0.0));
                columns.iter_mut().for_each(|c| c.fill(0.0));
            }
            let Trial { candidate, strength, size } = *trial;
            let whole = answers.iter().all(Option::is_some);
            found.push((Signature { candidate, strength, size, change, columns }, whole));
        }
    }
    found
}

/// A candidate with one of its strengths.
fn applied(candidates: &Candidates, trial: &Trial) -> Applied {
    let mut strengths = vec![0.0; candidates[trial.candidate].strengths.len()];
    strengths[trial.strength] = trial.size;
    Applied { candidate: trial.candidate, strengths }
}

/// Strengths that explain most together, linearly, and what is left of each run.
#[derive(Clone, Debug)]
pub struct Explained {
    pub strengths: Vec<f64>,
    /// Of the strengths, in units of the repeatability of replicate laps.
    pub covariance: DMatrix<f64>,
    pub residuals: PerRun<DVector<f64>>,
}

/// Fits strengths to residuals of the runs, leaving one out where `without` says so. Strengths keep to bounds.
pub fn explain(
    residuals: &PerRun<DVector<f64>>,
    columns: &[&PerRun<DVector<f64>>],
    bounds: &[(f64, f64)],
    without: Option<RunId>,
) -> Explained {
    let count = columns.len();
    let mut matrix: DMatrix<f64> = DMatrix::zeros(count, count);
    let mut right: DVector<f64> = DVector::zeros(count);
    for (run, residual) in residuals.with_ids().filter(|(run, _)| Some(*run) != without) {
        for i in 0..count {
            right[i] += columns[i][run].dot(residual);
            for j in 0..count {
                matrix[(i, j)] += columns[i][run].dot(&columns[j][run]);
            }
        }
    }
    // Strengths as far as their bounds are believed before.
    for i in 0..count {
        let wide = (bounds[i].1 - bounds[i].0).max(1e-300);
        matrix[(i, i)] += 1.0 / (wide * wide);
    }
    let inverse = matrix.clone().try_inverse().unwrap_or_else(|| DMatrix::zeros(count, count));
    let mut found = &inverse * &right;
    for i in 0..count {
        let held = found[i].clamp(bounds[i].0, bounds[i].1);
        if held != found[i] && count == 2 {
            // The other one alone, with this one at its bound.
            let other = 1 - i;
            found[i] = held;
            found[other] = ((right[other] - matrix[(other, i)] * held) / matrix[(other, other)])
                .clamp(bounds[other].0, bounds[other].1);
            break;
        }
        found[i] = held;
    }
    let left = residuals.with_ids().map(|(run, residual)| {
        let mut left = residual.clone();
        for (x, column) in found.iter().zip(columns) {
            left -= &column[run] * *x;
        }
        left
    });
    Explained { residuals: left.collect(), strengths: found.iter().copied().collect(), covariance: inverse }
}
