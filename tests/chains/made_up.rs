//! A made-up model in closed form: features are linear in nuisances and effects, and replicate runs scatter by white
//! noise.

use lss::base::random::normal;
use lss::base::trig;
use lss::effects::RandomEffect;
use lss::gap::{
    Applied, Band, Candidate, CandidateId, Candidates, Frame, Id, Label, Laps, PerRun, Request, RunId, Simulator,
    Strength,
};
use nalgebra::DMatrix;
use std::sync::Mutex;

pub const FEATURES: usize = 120;
const RUNS: usize = 3;

/// Effects: `slope` grows along the run, `wave` swings, `step` is one of four stretches, `sensor` is channel b's gain,
/// `twin` is nearly `wave`, `rough` lets laps scatter in channel a, `far` is not in proportion to its strength, `bump`
/// begins at one of three places and runs out over a length.
pub struct Made {
    pub candidates: Candidates,
    pub frames: PerRun<Frame>,
    /// Whether it tells how laps scatter with effects.
    pub tells: bool,
    /// What the first run's nuisance does beside its slope, by its square.
    pub bent: f64,
    /// What its nominal model was fitted with, and how strong.
    pub begin: Vec<Applied>,
    /// A candidate that fails, and how.
    pub fails: Option<(usize, Failure)>,
    /// All strengths that were asked for, by candidate.
    pub asked: Mutex<Vec<(usize, f64)>>,
}

#[derive(Clone, Copy, PartialEq)]
pub enum Failure {
    NoAnswer,
    NotFinite,
    InOneRun,
}

pub const ROUGH: usize = 8;
pub const FAR: usize = 9;
/// What `far` does at once, which no effect does alone.
const AT_ONCE: usize = 10;
/// The first bump of the first place; of each place come those that run out over a length of [`LENGTHS`].
const BUMP: usize = 11;
const BEGINS: [f64; 3] = [0.1, 0.3, 0.5];
pub const LENGTHS: [f64; 3] = [0.3, 0.1, 0.6];

/// The candidate of a bump at a place.
pub fn bump(place: usize, length: usize) -> usize {
    BUMP + LENGTHS.len() * place + length
}

/// What a strength of an effect does; all are in proportion but `far`, which does one thing at once and another only
/// when it is large.
fn done(candidate: usize, strength: f64, run: usize, k: usize) -> f64 {
    if candidate != FAR {
        return strength * shape(candidate, run, k);
    }
    let (at_once, late) = (shape(AT_ONCE, run, k), shape(2, run, k) - shape(3, run, k));
    3.0 * (1.0 - trig::exp(-strength / 0.1)) * at_once + 6.0 * (strength / 10.0) * (strength / 10.0) * late
}

fn shape(candidate: usize, run: usize, k: usize) -> f64 {
    let x = (k % 60) as f64 / 60.0;
    let speed = 1.0 + 0.3 * run as f64;
    let first = k < 60;
    let waves = |count: f64, phase: f64| if first { trig::sin(trig::TAU * count * x + phase) * speed } else { 0.0 };
    match candidate {
        0 => {
            if first {
                x * speed
            } else {
                0.3 * x
            }
        }
        1 => waves(3.0, 0.0),
        2..=5 => {
            if (x * 4.0) as usize == candidate - 2 {
                1.0
            } else {
                0.0
            }
        }
        6 => {
            if first {
                0.0
            } else {
                1.0 + x
            }
        }
        7 => waves(3.0, 0.05),
        AT_ONCE => waves(5.0, 0.0),
        bump if bump >= BUMP => {
            let (place, length) = ((bump - BUMP) / LENGTHS.len(), LENGTHS[(bump - BUMP) % LENGTHS.len()]);
            let past = x - BEGINS[place];
            if first && past >= 0.0 { speed * (1.0 - past / length).max(0.0) } else { 0.0 }
        }
        _ => {
            if first {
                0.1
            } else {
                0.0
            }
        }
    }
}

/// A nuisance lifts all features of the first channel alike.
fn level(k: usize) -> f64 {
    if k < 60 { 1.0 } else { 0.0 }
}

pub fn made(truth: &[(usize, f64)], strange: f64, seed: u64) -> Made {
    let one = |effect: &str, place: &str, sensor: bool| Candidate {
        several: effect == "step" || effect == "bump",
        effect: effect.into(),
        place: place.into(),
        fixed: Vec::new(),
        strengths: vec![Strength {
            name: "size".into(),
            unit: "m".into(),
            trial: 1.0,
            as_built: 0.0,
            beside: false,
            low: -50.0,
            high: 50.0,
            shares: PerRun::default(),
        }],
        sensor,
        random_effect: None,
        discrepancy: 0.0,
        alternative_to: None,
    };
    let mut candidates = vec![
        one("slope", "", false),
        one("wave", "", false),
        one("step", "first", false),
        one("step", "second", false),
        one("step", "third", false),
        one("step", "fourth", false),
        one("sensor", "b", true),
        one("twin", "", false),
    ];
    // What only scatters explains a little of anything.
    if truth.iter().any(|t| t.0 == ROUGH) {
        candidates.push(Candidate { random_effect: Some(RandomEffect::ByLap), ..one("rough", "", false) });
    }
    if truth.iter().any(|t| t.0 == FAR) {
        let mut far = one("far", "", false);
        far.strengths[0].low = 0.0;
        candidates.push(one("rough", "", false));
        candidates.push(far);
    }
    if truth.iter().any(|t| t.0 >= BUMP) {
        // So that numbers are those of `shape`.
        candidates.extend(["rough", "far", "at once"].map(|name| one(name, "", false)));
        for (place, begin) in BEGINS.into_iter().enumerate() {
            let first = CandidateId::new(bump(place, 0));
            for (length, run_out) in LENGTHS.into_iter().enumerate() {
                let beside = (length > 0).then_some(first);
                let words = format!("{begin} over {run_out}");
                candidates.push(Candidate { alternative_to: beside, ..one("bump", &words, false) });
            }
        }
    }
    let mut state = seed;
    let mut noise = || (0..FEATURES).map(|_| normal(&mut state)).collect::<Vec<f64>>();
    let labels = |channel: &str, k: usize| Label {
        channel: channel.into(),
        band: Band::Track,
        index: k % 60,
        from: 1000 * (k as i64 % 60),
        to: 1000 * (k as i64 % 60 + 1),
    };
    let frames = (0..RUNS)
        .map(|run| {
            let gap = |k: usize| -> f64 {
                let known: f64 = truth.iter().map(|(c, x)| done(*c, *x, run, k)).sum();
                // Nothing that the library has.
                known + strange * ((k * k % 17) as f64 / 8.0 - 1.0)
            };
            let own = noise();
            let rough: f64 = truth.iter().filter(|t| t.0 == ROUGH).map(|t| t.1).sum();
            let chance = if rough == 0.0 { vec![0.0; FEATURES] } else { noise() };
            Frame {
                run: format!("run-{}", run + 1),
                labels: (0..FEATURES).map(|k| labels(if k < 60 { "a" } else { "b" }, k)).collect(),
                measured: (0..FEATURES)
                    .map(|k| 5.0 + gap(k) + 0.7 * level(k) + own[k] + rough * level(k) * chance[k])
                    .collect(),
                nominal: vec![5.0; FEATURES],
                laps: Laps { variance: vec![1.0; FEATURES], scatter: (0..40).map(|_| noise()).collect() },
                discrepancies: Vec::new(),
                built: Vec::new(),
                slopes: DMatrix::from_fn(FEATURES, 1, |k, _| level(k)),
                prior: vec![(0.0, 10.0)],
                bounds: vec![(-10.0, 10.0)],
                nuisances: vec!["level".into()],
            }
        })
        .collect();
    let (begin, asked) = (Vec::new(), Mutex::default());
    Made { candidates: candidates.into(), frames, tells: true, bent: 0.0, begin, fails: None, asked }
}

impl Simulator for Made {
    fn candidates(&self) -> &Candidates {
        &self.candidates
    }

    fn begin(&self) -> &[Applied] {
        &self.begin
    }

    fn frames(&self) -> &PerRun<Frame> {
        &self.frames
    }

    fn simulate(&self, run: RunId, step: &[f64], effects: &[Applied]) -> Option<Vec<f64>> {
        let run = run.index();
        let strengths = effects.iter().map(|e| (e.candidate.index(), e.strengths[0]));
        self.asked.lock().unwrap().extend(strengths);
        if let Some((candidate, how)) = self.fails
            && effects.iter().any(|e| e.candidate.index() == candidate)
        {
            match how {
                Failure::NoAnswer => return None,
                Failure::InOneRun if run == 1 => return None,
                Failure::InOneRun => {}
                Failure::NotFinite => return Some(vec![f64::INFINITY; FEATURES]),
            }
        }
        let moved = step.first().copied().unwrap_or(0.0);
        let all = |k: usize| effects.iter().map(|e| done(e.candidate.index(), e.strengths[0], run, k)).sum::<f64>();
        let bent = if run == 0 { self.bent * moved * moved } else { 0.0 };
        Some((0..FEATURES).map(|k| 5.0 + moved * level(k) + bent * trig::sin(k as f64) + all(k)).collect())
    }

    fn laps_all(&self, requests: &[Request]) -> Vec<Option<Laps>> {
        let of = |r: &Request| {
            let rough: f64 = r.effects.iter().filter(|e| e.candidate.index() == ROUGH).map(|e| e.strengths[0]).sum();
            let variance = (0..FEATURES).map(|k| 1.0 + rough * rough * level(k)).collect();
            self.tells.then(|| self.frames[r.run].laps.scaled(variance))
        };
        requests.iter().map(of).collect()
    }
}
