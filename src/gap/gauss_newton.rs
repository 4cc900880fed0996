//! Strengths fitted on by the steps of Gauss and Newton, with slopes taken at the strengths themselves. A re-fit begins
//! with signatures, which are secants from a machine without the effect, and corrects them along the steps that it
//! takes: of several strengths it stops short of what fits.

use super::comparison::{Comparison, overall_mean_square};
use super::hypothesis::{Fitted, Hypothesis, norm_squared, room_near, stepped};
use super::ids::{PerRun, RunId};
use super::observation::Observation;
use super::scored::Scored;
use super::settings::GaussNewton;
use super::signature::{Runs, Signature, Signatures, Trial, explain, take};
use super::simulator::{Applied, Request};
use nalgebra::DVector;
use std::collections::BTreeSet;

/// Where the steps begin.
struct Start {
    hypothesis: Hypothesis,
    strengths: Vec<f64>,
    offsets: PerRun<Vec<f64>>,
    /// Of each run, whether nuisances are moved along.
    moved: PerRun<bool>,
}

impl Start {
    /// Where a re-fit ended. Nuisances that it left where the nominal model has them stay there.
    fn at(fitted: &Fitted) -> Start {
        Start {
            hypothesis: fitted.hypothesis.clone(),
            strengths: fitted.strengths.clone(),
            offsets: fitted.nuisance_offsets.clone(),
            moved: fitted.nuisance_offsets.map(|step| step.iter().any(|x| *x != 0.0)),
        }
    }
}

/// What strengths do, as simulated.
struct Point {
    strengths: Vec<f64>,
    features: PerRun<Vec<f64>>,
    /// What the effects change in each run's features, and what is left of the run, projected.
    changes: PerRun<Vec<f64>>,
    residuals: PerRun<DVector<f64>>,
}

/// What one more of a strength changes in each run's features, and that projected.
struct Slope {
    change: PerRun<Vec<f64>>,
    column: PerRun<DVector<f64>>,
}

impl Comparison<'_> {
    /// Those of the re-fitted hypotheses that leave least, fitted on; `met` holds what was fitted on before. Where all
    /// is explained, there is nothing to be fitted on.
    pub fn fitted_on(&self, scored: &[Scored], met: &mut Vec<Hypothesis>) -> Vec<Fitted> {
        let candidates = self.candidates();
        let smooth = |j: &&Scored| {
            let members = &j.fitted.hypothesis.members;
            j.fitted.simulated()
                && self.explains(j.mean_square)
                && !self.settles(j)
                && members.iter().all(|c| candidates[*c].random_effect.is_none())
                && !members.iter().all(|c| self.tuner().applies_sensor_model(*c))
        };
        let mut best: Vec<&Scored> = scored.iter().filter(smooth).collect();
        best.sort_by(|a, b| a.mean_square.total_cmp(&b.mean_square));
        let mut names = BTreeSet::new();
        best.retain(|j| names.insert(self.effects(&j.fitted.hypothesis)));
        best.truncate(self.settings.gauss_newton.hypotheses);
        best.retain(|j| !met.contains(&j.fitted.hypothesis));
        met.extend(best.iter().map(|j| j.fitted.hypothesis.clone()));
        best.into_iter().filter_map(|j| self.descended(Start::at(&j.fitted))).collect()
    }

    /// The effects with which the nominal model was fitted, fitted on: nuisances are already where these have them.
    pub fn begun(&mut self) -> Option<Fitted> {
        let begin = self.simulator.begin().to_vec();
        let trials = begin.iter().flat_map(|Applied { candidate, strengths }| {
            let there = strengths.iter().enumerate().filter(|(_, size)| **size != 0.0);
            there.map(|(strength, size)| Trial { candidate: *candidate, strength, size: *size })
        });
        let trials: Vec<Trial> = trials.collect();
        if trials.is_empty() {
            return None;
        }
        let own = |signatures: &Signatures, trial: &Trial| {
            let same = |s: &Signature| (s.candidate, s.strength) == (trial.candidate, trial.strength);
            signatures.with_ids().find(|(_, s)| same(s)).map(|(id, _)| id)
        };
        let missing: Vec<Trial> = trials.iter().filter(|t| own(&self.signatures, t).is_none()).copied().collect();
        for (signature, _) in take(self.context(), &self.observations, &missing, Runs::All, &mut |_| {}) {
            self.signatures.push(signature);
        }
        let signatures = trials.iter().map(|trial| own(&self.signatures, trial)).collect::<Option<_>>()?;
        let hypothesis = Hypothesis { members: begin.iter().map(|applied| applied.candidate).collect(), signatures };
        let offsets = self.simulator.frames().iter().map(|frame| vec![0.0; frame.nuisances.len()]).collect();
        let strengths = trials.iter().map(|trial| trial.size).collect();
        let moved = self.observations.map(|_| true);
        self.descended(Start { hypothesis, strengths, offsets, moved })
    }

    /// Whether a hypothesis leaves nothing to be explained, in all runs together and in each.
    fn settles(&self, scored: &Scored) -> bool {
        let within = |(run, own): (RunId, &Observation)| {
            let left = scored.mean_square_of(&self.observations, run, &scored.fitted.residuals[run]);
            left <= own.replicate_high / own.replicate
        };
        scored.mean_square <= self.settings.selection.unsettled && self.observations.with_ids().all(within)
    }

    /// A hypothesis with the strengths that leave least of those that were simulated.
    fn descended(&self, start: Start) -> Option<Fitted> {
        let GaussNewton { steps, far, .. } = self.settings.gauss_newton;
        let enough = self.settings.refitting.enough;
        let Start { hypothesis, strengths: mut at, mut offsets, moved } = start;
        let bounds = hypothesis.bounds(self.candidates(), &self.signatures);
        let mut best: Option<Fitted> = None;
        for _ in 0..steps {
            let here = self.point(&hypothesis, &at, &offsets)?;
            let square = norm_squared(&here.residuals);
            if let Some(before) = best.as_ref().filter(|best| square >= norm_squared(&best.residuals)) {
                at.iter_mut().zip(&before.strengths).for_each(|(x, y)| *x = 0.5 * (*x + y));
                continue;
            }
            let slopes = self.slopes(&hypothesis, &at, &offsets)?;
            let columns: Vec<PerRun<DVector<f64>>> = slopes.iter().map(|slope| slope.column.clone()).collect();
            let step =
                explain(&here.residuals, &columns.iter().collect::<Vec<_>>(), &room_near(&bounds, &at, far), None);
            // Below the repeatability there is chance alone.
            let within = overall_mean_square(&self.observations, &here.residuals) <= 1.0;
            let gained = square - norm_squared(&step.residuals);
            let next = stepped(&at, &step.strengths, &bounds);
            let foretold: PerRun<Vec<f64>> = here
                .changes
                .with_ids()
                .map(|(run, change)| {
                    let mut change = change.clone();
                    for (slope, x) in slopes.iter().zip(&step.strengths) {
                        change.iter_mut().zip(&slope.change[run]).for_each(|(sum, d)| *sum += x * d);
                    }
                    change
                })
                .collect();
            best = Some(Fitted {
                hypothesis: hypothesis.clone(),
                strengths: here.strengths,
                covariance: step.covariance,
                residuals: here.residuals,
                columns,
                changes: here.changes,
                nuisance_offsets: offsets.clone(),
                features: Some(here.features),
            });
            if gained < enough * square || within {
                break;
            }
            at = next;
            for ((run, offset), change) in self.observations.ids().zip(&mut offsets).zip(&foretold) {
                if moved[run] {
                    *offset = self.observations[run].nuisance_offsets(change);
                }
            }
        }
        best
    }

    /// All runs with these strengths.
    fn point(&self, hypothesis: &Hypothesis, at: &[f64], offsets: &PerRun<Vec<f64>>) -> Option<Point> {
        self.points(hypothesis, vec![at.to_vec()], offsets)?.pop()
    }

    /// All runs with each of these strengths. `None` where one cannot be simulated.
    fn points(&self, hypothesis: &Hypothesis, all: Vec<Vec<f64>>, offsets: &PerRun<Vec<f64>>) -> Option<Vec<Point>> {
        let (candidates, frames) = (self.candidates(), self.simulator.frames());
        let asked = all.iter().flat_map(|at| {
            let effects = hypothesis.applied(candidates, &self.signatures, at);
            offsets.with_ids().map(move |(run, step)| Request { run, step: step.clone(), effects: effects.clone() })
        });
        let asked: Vec<Request> = asked.collect();
        let mut answers = self.simulator.simulate_all(&asked).into_iter();
        let points = all.into_iter().map(|strengths| {
            let features: PerRun<Vec<f64>> = offsets.iter().map(|_| answers.next()?).collect::<Option<_>>()?;
            let changes: PerRun<Vec<f64>> =
                offsets.with_ids().map(|(run, step)| frames[run].moved(&features[run], step)).collect();
            let residuals =
                self.observations.iter().zip(&changes).map(|(o, change)| &o.residual - o.column(change)).collect();
            Some(Point { strengths, features, changes, residuals })
        });
        points.collect()
    }

    /// What one more of each strength changes where the strengths are, between a share less and as much more of it. A
    /// strength that is there as a whole has none.
    fn slopes(&self, hypothesis: &Hypothesis, at: &[f64], offsets: &PerRun<Vec<f64>>) -> Option<Vec<Slope>> {
        let share = self.settings.gauss_newton.share;
        let bounds = hypothesis.bounds(self.candidates(), &self.signatures);
        let asked = (0..at.len()).flat_map(|k| {
            [1.0 - share, 1.0 + share].map(|by| {
                let mut beside = at.to_vec();
                beside[k] = (by * at[k]).clamp(bounds[k].0, bounds[k].1);
                beside
            })
        });
        let points = self.points(hypothesis, asked.collect(), offsets)?;
        let mut pairs = points.chunks_exact(2);
        (0..at.len())
            .map(|k| {
                let [less, more] = pairs.next()? else { return None };
                let apart = more.strengths[k] - less.strengths[k];
                let per = if apart == 0.0 { 0.0 } else { 1.0 / apart };
                let between = |(a, b): (&Vec<f64>, &Vec<f64>)| a.iter().zip(b).map(|(a, b)| (b - a) * per).collect();
                let change = less.changes.iter().zip(&more.changes).map(between).collect();
                let column = less.residuals.iter().zip(&more.residuals).map(|(a, b)| (a - b) * per).collect();
                Some(Slope { change, column })
            })
            .collect()
    }
}
