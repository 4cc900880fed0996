//! Signatures: what a strength of an effect changes, with the nuisances projected out, and what several explain together.

use super::ids::{CandidateId, List, PerRun, RunId, SignatureId};
use super::observation::Observation;
use super::settings::Screening;
use super::simulator::{Applied, Candidates, Context, Frame, Request};
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
    pub fn nothing(
        Trial { candidate, strength, size }: Trial,
        observations: &PerRun<Observation>,
        frames: &PerRun<Frame>,
    ) -> Signature {
        let change = frames.iter().map(|f| vec![0.0; f.nominal.len()]).collect();
        let columns = observations.iter().map(|o| DVector::zeros(o.residual.len())).collect();
        Signature { candidate, strength, size, change, columns }
    }

    /// Whether it changes nothing.
    pub fn is_nothing(&self) -> bool {
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
