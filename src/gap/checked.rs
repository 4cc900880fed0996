//! The one door to a model: what is asked keeps to the declared bounds, and what had no answer is known afterwards.

use super::diagnosis::Lost;
use super::ids::{CandidateId, PerRun};
use super::settings::Checks;
use super::simulator::{Applied, Axis, Candidate, Candidates, Frame, Laps, Outline, Request, Simulator};
use crate::identify::Effort;
use crate::identify::noise::ChannelNoise;
use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A simulator that is asked nothing outside the bounds of its strengths, and whose answers are finite wherever they
/// can be compared.
pub struct Checked<'a> {
    simulator: &'a dyn Simulator,
    settings: &'a Checks,
    failures: Mutex<Vec<Failure>>,
}

/// A request that had no answer.
#[derive(Clone, Debug, PartialEq)]
struct Failure {
    request: Request,
    why: String,
}

impl<'a> Checked<'a> {
    pub fn new(simulator: &'a dyn Simulator, settings: &'a Checks) -> Checked<'a> {
        Checked { simulator, settings, failures: Mutex::default() }
    }

    fn failures(&self) -> MutexGuard<'_, Vec<Failure>> {
        self.failures.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Of each effect, or effects together, and each reason the request with the least strength that had no answer.
    pub fn lost(&self) -> Vec<Lost> {
        let size =
            |request: &Request| request.effects.iter().flat_map(|e| &e.strengths).fold(0.0, |a, x| x.abs().max(a));
        let mut least: BTreeMap<(Vec<CandidateId>, &str), &Request> = BTreeMap::new();
        let failures = self.failures();
        for Failure { request, why } in failures.iter() {
            let effects = request.effects.iter().map(|e| e.candidate).collect();
            let known = least.entry((effects, why)).or_insert(request);
            if size(request) < size(known) {
                *known = request;
            }
        }
        least.into_iter().map(|((_, why), request)| self.named(request, why)).collect()
    }

    fn named(&self, request: &Request, why: &str) -> Lost {
        let with = |applied: &Applied| -> Option<(&Candidate, BTreeMap<String, f64>)> {
            let candidate = self.candidates().at(applied.candidate)?;
            let names = candidate.strengths.iter().map(|s| s.name.clone());
            let strength = names.zip(applied.strengths.iter().copied()).filter(|(_, x)| *x != 0.0).collect();
            Some((candidate, strength))
        };
        let each: Vec<_> = request.effects.iter().filter_map(with).collect();
        let words = |of: &dyn Fn(&Candidate) -> &str| -> String {
            let each: Vec<&str> = each.iter().map(|(c, _)| of(c)).filter(|text| !text.is_empty()).collect();
            each.join(" and ")
        };
        Lost {
            effect: words(&|c| &c.effect),
            place: words(&|c| &c.place),
            strength: each.iter().flat_map(|(_, strength)| strength.clone()).collect(),
            run: self.frames().at(request.run).map_or_else(String::new, |f| f.run.clone()),
            why: why.to_owned(),
        }
    }
}

impl Simulator for Checked<'_> {
    fn candidates(&self) -> &Candidates {
        self.simulator.candidates()
    }

    fn frames(&self) -> &PerRun<Frame> {
        self.simulator.frames()
    }

    fn begin(&self) -> &[Applied] {
        self.simulator.begin()
    }

    fn threads(&self) -> usize {
        self.simulator.threads()
    }

    fn axis(&self) -> Axis {
        self.simulator.axis()
    }

    fn reason(&self, request: &Request) -> Option<String> {
        self.simulator.reason(request)
    }

    fn effort(&self) -> Effort {
        self.simulator.effort()
    }

    fn outline(&self, applied: &Applied, at: Option<&[f64]>) -> Option<Outline> {
        self.simulator.outline(applied, at)
    }

    fn noise(&self) -> BTreeMap<String, BTreeMap<String, ChannelNoise>> {
        self.simulator.noise()
    }

    fn applies_sensor_models(&self) -> bool {
        self.simulator.applies_sensor_models()
    }

    fn laps_all(&self, requests: &[Request]) -> Vec<Option<Laps>> {
        let asked: Vec<Request> = requests.iter().map(|r| r.bounded(self.candidates())).collect();
        self.simulator.laps_all(&asked)
    }

    fn simulate_all(&self, requests: &[Request]) -> Vec<Option<Vec<f64>>> {
        let asked: Vec<Request> = requests.iter().map(|r| r.bounded(self.candidates())).collect();
        let mut answers = self.simulator.simulate_all(&asked);
        for (request, answer) in asked.into_iter().zip(&mut answers) {
            let lacking = answer.as_ref().zip(self.frames().at(request.run));
            let lacking = lacking.map_or(0, |(a, f)| f.lacking(a, self.settings.may_lack));
            let why = match answer {
                None => self.reason(&request).unwrap_or_else(|| "it cannot be simulated".to_owned()),
                Some(_) if lacking > 0 => format!("{lacking} of its features are no finite numbers"),
                Some(_) => continue,
            };
            *answer = None;
            self.failures().push(Failure { request, why });
        }
        answers
    }
}

impl Request {
    /// The same with all strengths within their bounds.
    fn bounded(&self, candidates: &Candidates) -> Request {
        let mut bounded = self.clone();
        for effect in &mut bounded.effects {
            if let Some(candidate) = candidates.at(effect.candidate) {
                effect.strengths = candidate.bounded(&effect.strengths);
            }
        }
        bounded
    }
}
