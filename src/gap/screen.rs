//! The fast screen: what each effect's signature explains, alone and in pairs, with the nuisances projected out.

use super::evidence::Evidence;
use super::simulator::{Applied, Candidate, Request, Simulator};
use nalgebra::{DMatrix, DVector};

/// A signature is taken where it is at least so many times the floor, root mean square over the features that it changes most.
const CLEAR: f64 = 4.0;

/// What a strength of a candidate changes, over all runs.
pub struct Signature {
    pub candidate: usize,
    pub strength: usize,
    /// Of each run, of one unit of the strength; empty where the run could not be simulated.
    pub change: Vec<Vec<f64>>,
    /// The same whitened and projected.
    pub columns: Vec<DVector<f64>>,
}

/// Signatures of all candidates' strengths, at a size at which they are clear.
pub fn signatures(
    simulator: &dyn Simulator,
    evidence: &[Evidence],
    tell: &mut dyn FnMut(usize, usize),
) -> Vec<Signature> {
    let candidates = simulator.candidates();
    let jobs: Vec<(usize, usize)> =
        (0..candidates.len()).flat_map(|c| (0..candidates[c].strengths.len()).map(move |s| (c, s))).collect();
    let mut sizes: Vec<f64> = jobs.iter().map(|&(c, s)| candidates[c].strengths[s].trial).collect();
    let mut found: Vec<Option<Signature>> = jobs.iter().map(|_| None).collect();
    let mut open: Vec<usize> = (0..jobs.len()).collect();
    for round in 0..3 {
        let mut again = Vec::new();
        for part in open.chunks(8) {
            tell(jobs.len() - open.len() + part.len().min(open.len()), jobs.len());
            let requests: Vec<Request> = part
                .iter()
                .flat_map(|&job| {
                    let (c, s) = jobs[job];
                    let applied = alone(candidates, c, s, sizes[job]);
                    (0..evidence.len()).map(move |run| Request {
                        run,
                        step: Vec::new(),
                        effects: vec![applied.clone()],
                    })
                })
                .collect();
            let answers = simulator.simulate_all(&requests);
            for (&job, answers) in part.iter().zip(answers.chunks(evidence.len().max(1))) {
                let (c, s) = jobs[job];
                let frames = simulator.frames();
                let size = sizes[job];
                let change: Vec<Vec<f64>> = answers
                    .iter()
                    .zip(frames)
                    .map(|(answer, frame)| {
                        let Some(answer) = answer else { return vec![0.0; frame.nominal.len()] };
                        answer.iter().zip(&frame.nominal).map(|(a, b)| (a - b) / size).collect()
                    })
                    .collect();
                let columns: Vec<DVector<f64>> = evidence.iter().zip(&change).map(|(e, c)| e.column(c)).collect();
                let largest = columns.iter().map(|c| c.amax()).fold(0.0, f64::max) * size;
                let high = candidates[c].strengths[s].high;
                let larger = (size * (1.5 * CLEAR / largest.max(1e-9)).min(50.0)).min(0.5 * high);
                if largest < CLEAR && round < 2 && larger > 2.0 * size && answers.iter().all(Option::is_some) {
                    sizes[job] = larger;
                    again.push(job);
                }
                found[job] = Some(Signature { candidate: c, strength: s, change, columns });
            }
        }
        open = again;
    }
    found.into_iter().flatten().collect()
}

/// A candidate with one of its strengths.
fn alone(candidates: &[Candidate], c: usize, s: usize, size: f64) -> Applied {
    let mut strengths = vec![0.0; candidates[c].strengths.len()];
    strengths[s] = size;
    Applied { candidate: c, strengths }
}

/// Strengths that explain most together, linearly, and what is left of each run.
#[derive(Clone, Debug)]
pub struct Explained {
    pub strengths: Vec<f64>,
    /// Of the strengths, in units of the floor of honest laps.
    pub covariance: DMatrix<f64>,
    pub residuals: Vec<DVector<f64>>,
}

/// Fits strengths to residuals of the runs, leaving one out where `without` says so. Strengths keep to bounds.
pub fn explain(
    residuals: &[DVector<f64>],
    columns: &[&[DVector<f64>]],
    bounds: &[(f64, f64)],
    without: Option<usize>,
) -> Explained {
    let count = columns.len();
    let mut matrix: DMatrix<f64> = DMatrix::zeros(count, count);
    let mut right: DVector<f64> = DVector::zeros(count);
    for (run, residual) in residuals.iter().enumerate().filter(|(run, _)| Some(*run) != without) {
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
    let left = residuals.iter().enumerate().map(|(run, residual)| {
        let mut left = residual.clone();
        for (x, column) in found.iter().zip(columns) {
            left -= &column[run] * *x;
        }
        left
    });
    Explained { residuals: left.collect(), strengths: found.iter().copied().collect(), covariance: inverse }
}
