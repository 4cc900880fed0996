//! A model of two effects in one run, for tests.

use super::ids::{Id, PerRun, RunId};
use super::simulator::{Applied, Candidate, Candidates, Frame, Simulator};
use crate::base::random::normal;

/// Features of a run.
pub const FEATURES: usize = 80;

/// What both strengths change in a feature.
pub type Done = fn([f64; 2], usize) -> f64;

pub struct TwoEffects {
    pub candidates: Candidates,
    pub frames: PerRun<Frame>,
    done: Done,
}

impl TwoEffects {
    /// Measured with true strengths, and noise of a seed.
    pub fn new(candidates: [Candidate; 2], done: Done, truth: [f64; 2], seed: u64) -> TwoEffects {
        let mut state = seed;
        let mut noise = || (0..FEATURES).map(|_| normal(&mut state)).collect::<Vec<f64>>();
        let measured = noise().iter().enumerate().map(|(k, x)| x + done(truth, k)).collect();
        let frames = vec![Frame::bare(measured, (0..40).map(|_| noise()).collect())].into();
        TwoEffects { candidates: Vec::from(candidates).into(), frames, done }
    }
}

impl Simulator for TwoEffects {
    fn candidates(&self) -> &Candidates {
        &self.candidates
    }

    fn frames(&self) -> &PerRun<Frame> {
        &self.frames
    }

    fn simulate(&self, _: RunId, _: &[f64], effects: &[Applied]) -> Option<Vec<f64>> {
        let of = |n: usize| effects.iter().find(|e| e.candidate.index() == n).map_or(0.0, |e| e.strengths[0]);
        Some((0..FEATURES).map(|k| (self.done)([of(0), of(1)], k)).collect())
    }
}
