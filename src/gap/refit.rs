//! Real re-fits of what the screen left: simulations with the effect, nuisances moved along.

use super::ids::{CandidateId, PerRun, RunId};
use super::observation::Observation;
use super::settings::Refitting;
use super::signature::{Signatures, explain};
use super::simulator::{Candidates, Context};
use super::tune::{Tuned, Tuner};
use crate::gap::hypothesis::{Fitted, Hypothesis, norm_squared, room, stepped};
use nalgebra::DVector;

/// Where a hypothesis' simulations are.
struct Search {
    /// The last strengths that were simulated, and what they changed, projected.
    at: Vec<f64>,
    found: PerRun<DVector<f64>>,
    best: Option<RefitPoint>,
    /// Of each run, whether nuisances are moved along.
    moved: PerRun<bool>,
    settled: bool,
}

/// What was simulated with least left.
struct RefitPoint {
    square: f64,
    strengths: Vec<f64>,
    residuals: PerRun<DVector<f64>>,
    changes: PerRun<Vec<f64>>,
    features: PerRun<Vec<f64>>,
}

impl Search {
    fn new(strengths: usize, observations: &PerRun<Observation>) -> Search {
        let found = observations.iter().map(|o| DVector::zeros(o.residual.len())).collect();
        Search { at: vec![0.0; strengths], found, best: None, moved: observations.map(|_| true), settled: false }
    }

    /// Begins where strengths were tuned.
    fn begin(&mut self, one: &mut Fitted, tuned: Tuned) {
        (self.at, self.found) = (tuned.strengths.clone(), tuned.found);
        (one.strengths, one.columns) = (tuned.strengths, tuned.columns);
        (one.residuals, one.changes) = (tuned.residuals, tuned.changes);
    }

    /// Whether nuisances of some runs are farther from linear than the effects are, as these leave far more than was
    /// foretold, by a factor. What the effects do is then simulated where the nominal model is, and nuisances are
    /// thought of by their slopes.
    fn astray(
        &mut self,
        observations: &PerRun<Observation>,
        foretold: &PerRun<DVector<f64>>,
        left: &PerRun<DVector<f64>>,
        factor: f64,
    ) -> bool {
        let mut astray = false;
        for ((run, foretold), left) in foretold.with_ids().zip(left) {
            let expected = observations[run].mean_square(foretold).max(1.0);
            if self.moved[run] && observations[run].mean_square(left) > factor * expected {
                (self.moved[run], astray) = (false, true);
            }
        }
        astray
    }

    /// Corrects what one more of each strength changes by what all of them together were found to since the last
    /// simulation: the least change of the columns that says so, each for its share (Broyden 1965). Chaos drowns what
    /// short steps change, those of less than a share `short` of all.
    fn learn(
        &mut self,
        columns: &mut [PerRun<DVector<f64>>],
        strengths: &[f64],
        found: PerRun<DVector<f64>>,
        short: f64,
    ) {
        let moved: Vec<f64> = strengths.iter().zip(&self.at).map(|(x, y)| x - y).collect();
        let squares = columns.iter().zip(&moved);
        let squares: Vec<f64> = squares.map(|(c, x)| x * x * norm_squared(c)).collect();
        let all: f64 = squares.iter().sum();
        if all > short * short * norm_squared(&found) && all > 0.0 {
            for (run, found) in found.with_ids() {
                let mut missed = found - &self.found[run];
                for (column, x) in columns.iter().zip(&moved) {
                    missed -= &column[run] * *x;
                }
                for ((column, x), square) in columns.iter_mut().zip(&moved).zip(&squares).filter(|(c, _)| *c.1 != 0.0) {
                    column[run] += &missed * (square / all / x);
                }
            }
        }
        self.at = strengths.to_vec();
        self.found = found;
    }
}

/// Fits hypotheses by simulation. All requests of a round are made at once.
pub fn refit(
    context: Context,
    observations: &PerRun<Observation>,
    signatures: &Signatures,
    screened: Vec<Fitted>,
    tell: &mut dyn FnMut(usize, usize),
) -> Vec<Fitted> {
    let Context { simulator, settings } = context;
    let Refitting { rounds, enough, hopeless, astray, short } = settings.refitting;
    let (candidates, frames) = (simulator.candidates(), simulator.frames());
    let mut fitted = screened;
    let mut searches: Vec<Search> = fitted.iter().map(|one| Search::new(one.strengths.len(), observations)).collect();
    let runs = observations.len();
    let tuner = Tuner { simulator, settings, observations, signatures };
    for (one, search) in fitted.iter_mut().zip(&mut searches) {
        if let Some(tuned) = tuner.tuned(&one.hypothesis, &one.strengths) {
            search.begin(one, tuned);
            one.move_along(observations, &search.moved);
        }
    }
    for round in 0..rounds {
        tell(round, rounds);
        let going: Vec<usize> = (0..fitted.len()).filter(|k| !searches[*k].settled).collect();
        let mut requests = Vec::new();
        for one in going.iter().map(|k| &fitted[*k]) {
            requests.extend(one.requests(candidates, signatures));
        }
        let answers = simulator.simulate_all(&requests);
        for (n, k) in going.into_iter().enumerate() {
            let rows = n * runs..(n + 1) * runs;
            let answers: Option<PerRun<&Vec<f64>>> = answers[rows.clone()].iter().map(Option::as_ref).collect();
            // What cannot be simulated keeps what is known of it.
            let (one, search) = (&mut fitted[k], &mut searches[k]);
            let Some(answers) = answers else {
                search.settled = true;
                continue;
            };
            let asked = requests[rows].iter().zip(&answers);
            let changes: PerRun<Vec<f64>> = asked.map(|(r, answer)| frames[r.run].moved(answer, &r.step)).collect();
            let found: PerRun<DVector<f64>> = observations.iter().zip(&changes).map(|(o, c)| o.column(c)).collect();
            let residuals: PerRun<DVector<f64>> =
                observations.iter().zip(&found).map(|(o, c)| &o.residual - c).collect();
            if search.astray(observations, &one.residuals, &residuals, astray) {
                one.move_along(observations, &search.moved);
                continue;
            }
            search.learn(&mut one.columns, &one.strengths, found, short);
            let square = norm_squared(&residuals);
            if search.best.as_ref().is_none_or(|best| square < best.square) {
                let features = answers.into_iter().cloned().collect();
                let strengths = one.strengths.clone();
                search.best = Some(RefitPoint { square, strengths, residuals, changes, features });
            }
            if let Some(best) = &search.best {
                one.tune_sensors(&tuner, &best.strengths);
                search.settled = one.step(best, candidates, signatures, enough);
                one.move_along(observations, &search.moved);
            }
        }
        // What leaves several times as much as another one will not come up with it.
        let least = searches.iter().filter_map(|s| s.best.as_ref()).map(|b| b.square).fold(f64::INFINITY, f64::min);
        for search in &mut searches {
            search.settled |= search.best.as_ref().is_some_and(|best| best.square > hopeless * least);
        }
    }
    fitted
}

/// What strengths change in each run, by columns of one more of each.
pub fn along(columns: &[PerRun<DVector<f64>>], strengths: &[f64]) -> PerRun<DVector<f64>> {
    let in_run = |run: RunId| {
        let each = columns.iter().zip(strengths).map(|(column, x)| &column[run] * *x);
        each.reduce(|sum, more| sum + more)
    };
    columns.first().into_iter().flat_map(|column| column.ids()).filter_map(in_run).collect()
}

impl Fitted {
    /// Nuisances of some runs as they fit best with what the effects change.
    fn move_along(&mut self, observations: &PerRun<Observation>, moved: &PerRun<bool>) {
        for (run, step) in observations.ids().zip(&mut self.nuisance_offsets) {
            *step = observations[run].nuisance_offsets(&self.changes[run]);
            if !moved[run] {
                step.fill(0.0);
            }
        }
    }

    /// Takes what one more of a sensor's strengths changes where the strengths are.
    fn tune_sensors(&mut self, tuner: &Tuner, at: &[f64]) {
        let Hypothesis { members, signatures: own } = &self.hypothesis;
        let rows: Vec<usize> =
            (0..own.len()).filter(|k| tuner.applies_sensor_model(tuner.signatures[own[*k]].candidate)).collect();
        let sensors = Hypothesis {
            members: members.iter().copied().filter(|c| tuner.applies_sensor_model(*c)).collect(),
            signatures: rows.iter().map(|k| own[*k]).collect(),
        };
        let at: Vec<f64> = rows.iter().map(|k| at[*k]).collect();
        let slopes = (!rows.is_empty()).then(|| tuner.differences(&sensors, &at)).flatten();
        for (row, column) in rows.into_iter().zip(slopes.into_iter().flat_map(|s| s.columns)) {
            self.columns[row] = column;
        }
    }

    /// What its strengths change in each run, projected.
    pub fn direction(&self) -> PerRun<DVector<f64>> {
        along(&self.columns, &self.strengths)
    }

    /// Whether it was simulated with something.
    pub fn simulated(&self) -> bool {
        self.features.is_some() && self.strengths.iter().any(|x| *x != 0.0)
    }

    /// Whether all members do something, where there are several.
    pub fn all_there(&self, signatures: &Signatures) -> bool {
        let Hypothesis { members, signatures: own } = &self.hypothesis;
        let does = |member: &CandidateId| {
            own.iter().zip(&self.strengths).any(|(k, x)| signatures[*k].candidate == *member && *x != 0.0)
        };
        members.len() < 2 || members.iter().all(does)
    }

    /// To where it fits best from the best that was simulated; whether that gains less than a share `enough`.
    fn step(&mut self, best: &RefitPoint, candidates: &Candidates, signatures: &Signatures, enough: f64) -> bool {
        let bounds = self.hypothesis.bounds(candidates, signatures);
        let by: Vec<&PerRun<DVector<f64>>> = self.columns.iter().collect();
        let step = explain(&best.residuals, &by, &room(&bounds, &best.strengths), None);
        self.strengths = stepped(&best.strengths, &step.strengths, &bounds);
        let gained = best.square - norm_squared(&step.residuals);
        self.residuals = step.residuals;
        self.covariance = step.covariance;
        self.changes = self.hypothesis.changed_further(signatures, &best.changes, &step.strengths);
        self.features = Some(best.features.clone());
        gained < enough * best.square
    }
}
