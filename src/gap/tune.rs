//! Effects that cost no simulation are asked for as often as it takes: what a shift does to a narrow channel's
//! distribution is in proportion to nothing, and a strength that is a little off leaves more than another sensor's
//! effect does.

use super::ids::{CandidateId, PerRun, RunId};
use super::observation::Observation;
use super::settings::Settings;
use super::signature::{Signature, Signatures, explain};
use super::simulator::{Band, Request, Simulator};
use crate::gap::hypothesis::{Hypothesis, norm_squared, room, stepped};
use nalgebra::DVector;

/// Strengths at which something was simulated, nuisances where the nominal model has them.
pub struct Tuned {
    pub strengths: Vec<f64>,
    /// What is left of each run, projected.
    pub residuals: PerRun<DVector<f64>>,
    /// What the effects change in each run's features, and that projected.
    pub changes: PerRun<Vec<f64>>,
    pub found: PerRun<DVector<f64>>,
    /// What one more of each strength changes there.
    pub columns: Vec<PerRun<DVector<f64>>>,
}

/// What is asked, and before what.
pub struct Tuner<'a> {
    pub simulator: &'a dyn Simulator,
    pub settings: &'a Settings,
    pub observations: &'a PerRun<Observation>,
    pub signatures: &'a Signatures,
}

impl Tuner<'_> {
    /// Whether a candidate costs no simulation.
    pub fn applies_sensor_model(&self, candidate: CandidateId) -> bool {
        self.simulator.applies_sensor_models() && self.simulator.candidates()[candidate].sensor
    }

    /// Strengths that fit best near those from which it starts, or near those that the means along the track ask for,
    /// which most sensors' effects change in proportion. `None` where a member costs simulations, or nothing can be
    /// simulated.
    pub fn tuned(&self, hypothesis: &Hypothesis, start: &[f64]) -> Option<Tuned> {
        if !hypothesis.members.iter().all(|c| self.applies_sensor_model(*c)) {
            return None;
        }
        let found = [self.descended(hypothesis, start.to_vec()), self.descended(hypothesis, self.by_means(hypothesis))];
        found.into_iter().flatten().min_by(|a, b| norm_squared(&a.residuals).total_cmp(&norm_squared(&b.residuals)))
    }

    /// Strengths by the means along the track alone, nuisances held.
    fn by_means(&self, hypothesis: &Hypothesis) -> Vec<f64> {
        let frames = self.simulator.frames();
        let off: PerRun<Vec<f64>> = frames.iter().map(|frame| frame.residual(&frame.nominal)).collect();
        let means = |run: RunId, values: &[f64]| {
            let frame = &frames[run];
            let used = |k: &usize| frame.labels[*k].band == Band::Track && off[run][*k].is_finite();
            let rows = (0..values.len()).filter(used).map(|k| values[k] / frame.laps.variance[k].sqrt());
            DVector::from_vec(rows.collect())
        };
        let of = |values: &PerRun<Vec<f64>>| -> PerRun<DVector<f64>> {
            values.with_ids().map(|(run, values)| means(run, values)).collect()
        };
        let columns: Vec<PerRun<DVector<f64>>> =
            hypothesis.signatures.iter().map(|k| of(&self.signatures[*k].change)).collect();
        let columns: Vec<&PerRun<DVector<f64>>> = columns.iter().collect();
        explain(&of(&off), &columns, &hypothesis.bounds(self.simulator.candidates(), self.signatures), None).strengths
    }

    /// Gauss and Newton's steps on differences.
    fn descended(&self, hypothesis: &Hypothesis, start: Vec<f64>) -> Option<Tuned> {
        let settings = &self.settings.sensor_fits;
        let bounds = hypothesis.bounds(self.simulator.candidates(), self.signatures);
        let (mut at, mut best): (Vec<f64>, Option<Tuned>) = (start, None);
        for _ in 0..settings.steps {
            let here = self.differences(hypothesis, &at)?;
            let square = norm_squared(&here.residuals);
            if let Some(before) = best.as_ref().filter(|best| square >= norm_squared(&best.residuals)) {
                at.iter_mut().zip(&before.strengths).for_each(|(x, y)| *x = 0.5 * (*x + y));
                continue;
            }
            let by: Vec<&PerRun<DVector<f64>>> = here.columns.iter().collect();
            let step = explain(&here.residuals, &by, &room(&bounds, &at), None);
            let gained = square - norm_squared(&step.residuals);
            at = stepped(&at, &step.strengths, &bounds);
            best = Some(here);
            if gained < settings.enough * square {
                break;
            }
        }
        best
    }

    /// What strengths leave, and what a little more of each changes.
    pub fn differences(&self, hypothesis: &Hypothesis, at: &[f64]) -> Option<Tuned> {
        let settings = &self.settings.sensor_fits;
        let (candidates, frames, runs) =
            (self.simulator.candidates(), self.simulator.frames(), self.observations.len());
        let bounds = hypothesis.bounds(candidates, self.signatures);
        let apart = hypothesis.signatures.iter().zip(at).zip(&bounds).map(|((k, x), (_, high))| {
            let Signature { candidate, strength, .. } = self.signatures[*k];
            let apart = (settings.difference * x.abs())
                .max(settings.least_difference * candidates[candidate].strengths[strength].trial.abs());
            if x + apart > *high { -apart } else { apart }
        });
        let apart: Vec<f64> = apart.collect();
        let beside = |k: usize| {
            let mut beside = at.to_vec();
            beside[k] += apart[k];
            beside
        };
        let points: Vec<Vec<f64>> = [at.to_vec()].into_iter().chain((0..at.len()).map(beside)).collect();
        let with = |point: &Vec<f64>| {
            let effects = hypothesis.applied(candidates, self.signatures, point);
            frames.ids().map(move |run| Request { run, step: Vec::new(), effects: effects.clone() })
        };
        let requests: Vec<Request> = points.iter().flat_map(with).collect();
        let answers: Vec<Vec<f64>> = self.simulator.simulate_all(&requests).into_iter().collect::<Option<_>>()?;
        let change = |point: usize| -> PerRun<Vec<f64>> {
            let answers = answers[point * runs..(point + 1) * runs].iter().zip(frames);
            answers.map(|(answer, frame)| answer.iter().zip(&frame.nominal).map(|(a, n)| a - n).collect()).collect()
        };
        let projected = |changes: &PerRun<Vec<f64>>| -> PerRun<DVector<f64>> {
            self.observations.iter().zip(changes).map(|(o, c)| o.column(c)).collect()
        };
        let changes = change(0);
        let found = projected(&changes);
        let columns = (0..at.len()).map(|k| {
            let there = projected(&change(k + 1));
            there.iter().zip(&found).map(|(there, here)| (there - here) / apart[k]).collect()
        });
        Some(Tuned {
            strengths: at.to_vec(),
            residuals: self.observations.iter().zip(&found).map(|(o, c)| &o.residual - c).collect(),
            columns: columns.collect(),
            changes,
            found,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::base::trig;
    use crate::gap::ids::Id;
    use crate::gap::simulator::{Applied, Candidate, Candidates, Frame, Label};
    use nalgebra::DMatrix;

    /// Features in proportion to a strength, and as many that saturate.
    const HALF: usize = 30;

    struct Shifted {
        candidates: Candidates,
        frames: PerRun<Frame>,
    }

    fn shifted(x: f64) -> Vec<f64> {
        (0..2 * HALF).map(|k| if k < HALF { 0.2 * x } else { 80.0 * trig::tanh(x - 0.1 * k as f64) }).collect()
    }

    impl Simulator for Shifted {
        fn candidates(&self) -> &Candidates {
            &self.candidates
        }

        fn frames(&self) -> &PerRun<Frame> {
            &self.frames
        }

        fn simulate(&self, _: RunId, _: &[f64], effects: &[Applied]) -> Option<Vec<f64>> {
            let nothing = shifted(0.0);
            Some(shifted(effects[0].strengths[0]).iter().zip(nothing).map(|(x, y)| x - y).collect())
        }

        fn applies_sensor_models(&self) -> bool {
            true
        }
    }

    #[test]
    fn a_shift_is_found_though_distributions_saturate() {
        let candidate = Candidate { sensor: true, ..Candidate::bare("bias", 1.0, (-99.0, 99.0)) };
        let label = |k: usize| {
            let band = if k < HALF { Band::Track } else { Band::Distribution };
            Label { channel: "a".into(), band, index: k % HALF, from: k as i64, to: k as i64 + 1 }
        };
        let truth = 30.0;
        let measured = shifted(truth).iter().zip(shifted(0.0)).map(|(x, y)| x - y).collect();
        let frame = Frame {
            labels: (0..2 * HALF).map(label).collect(),
            slopes: DMatrix::zeros(2 * HALF, 1),
            prior: vec![(0.0, 1.0)],
            bounds: vec![(-1.0, 1.0)],
            nuisances: vec!["level".into()],
            ..Frame::bare(measured, Vec::new())
        };
        let observations = PerRun::from(vec![Observation::new(&frame, &[], &Settings::default())]);
        let simulator = Shifted { candidates: vec![candidate].into(), frames: vec![frame].into() };
        // Taken where the distribution does not saturate yet: the linear fit asks for far too little.
        let (run, candidate) = (RunId::new(0), CandidateId::new(0));
        let effect = Applied { candidate, strengths: vec![1.0] };
        let change = PerRun::from(vec![simulator.simulate(run, &[], &[effect]).unwrap()]);
        let columns = observations.map(|o| o.column(&change[run]));
        let mut signatures = Signatures::default();
        let own = signatures.push(Signature { candidate, strength: 0, size: 1.0, change, columns });
        let hypothesis = Hypothesis { members: vec![candidate], signatures: vec![own] };
        let screened = hypothesis.screened(&observations, &signatures, &simulator.candidates);
        assert!(screened.strengths[0] < 0.7 * truth || screened.strengths[0] > 1.5 * truth, "{:?}", screened.strengths);
        let settings = Settings::default();
        let tuner =
            Tuner { simulator: &simulator, settings: &settings, observations: &observations, signatures: &signatures };
        let found = tuner.tuned(&hypothesis, &screened.strengths).expect("a fit");
        assert!((found.strengths[0] - truth).abs() < 0.1, "{:?}", found.strengths);
    }
}
