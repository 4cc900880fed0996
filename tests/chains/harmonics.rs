//! Strengths that are looked for only beside others, on a made-up model: powers at orders, to which a ripple of the motors
//! adds the squares of its harmonics.

use lss::base::random::normal;
use lss::base::trig;
use lss::gap::{
    Applied, Band, Candidate, Candidates, Diagnosis, Frame, Id, Label, Laps, PerRun, RunId, Settings, Simulator,
    Strength, Verdict, diagnose,
};
use nalgebra::DMatrix;
use std::sync::Mutex;

/// Orders of the longest pitch, each seen by so many channels; 0 is what does not ripple.
const ORDERS: [usize; 8] = [0, 1, 2, 3, 4, 6, 8, 12];
const CHANNELS: usize = 12;
const FEATURES: usize = ORDERS.len() * CHANNELS;
const RUNS: usize = 3;

/// Pitches at which the ripple may be, as orders, then drag, which lifts what does not ripple.
const SITES: [usize; 3] = [1, 2, 4];
const DRAG: usize = SITES.len();

/// A logarithm of a power, of which the noise is a twentieth.
fn feature(k: usize, run: usize, effects: &[(usize, Vec<f64>)]) -> f64 {
    let (order, channel) = (ORDERS[k / CHANNELS], k % CHANNELS);
    let gain = (1.0 + 0.1 * channel as f64 + 0.2 * run as f64) / (order.max(1) as f64).sqrt();
    let mut power = 1e-3;
    let mut lifted = 0.0;
    for (candidate, strengths) in effects {
        match SITES.get(*candidate) {
            Some(first) => {
                for (ratio, n) in strengths.iter().zip(1..) {
                    power += if first * n == order { gain * ratio * gain * ratio } else { 0.0 };
                }
            }
            None if order == 0 => lifted += strengths[0] * (1.0 + channel as f64 / 6.0),
            None => {}
        }
    }
    20.0 * (0.5 * trig::ln(power) + lifted)
}

struct Powers {
    candidates: Candidates,
    frames: PerRun<Frame>,
    asked: Mutex<Vec<Applied>>,
}

impl Powers {
    fn new(truth: &[(usize, Vec<f64>)], seed: u64) -> Powers {
        let strength = |name: &str, beside: bool| Strength {
            name: name.into(),
            unit: String::new(),
            trial: 0.1,
            as_built: 0.0,
            beside,
            low: 0.0,
            high: 1.0,
            shares: PerRun::default(),
        };
        let one = |effect: &str, place: String, strengths: Vec<Strength>| Candidate {
            effect: effect.into(),
            place,
            fixed: Vec::new(),
            strengths,
            sensor: false,
            random_effect: None,
            // As the library has it.
            discrepancy: 0.15,
            several: false,
            alternative_to: None,
        };
        let waves = || vec![strength("ratio", false), strength("twice", true), strength("thrice", true)];
        let mut candidates: Vec<Candidate> = SITES.map(|n| one("ripple", format!("order {n}"), waves())).to_vec();
        candidates.push(one("drag", String::new(), vec![strength("size", false)]));
        let mut state = seed;
        let mut noise = || (0..FEATURES).map(|_| normal(&mut state)).collect::<Vec<f64>>();
        let label = |k: usize| Label {
            channel: format!("channel {}", k % CHANNELS),
            band: Band::Motor,
            index: k / CHANNELS,
            from: 0,
            to: 1000,
        };
        let frames = (0..RUNS).map(|run| Frame {
            run: format!("run-{}", run + 1),
            labels: (0..FEATURES).map(label).collect(),
            measured: noise().iter().enumerate().map(|(k, x)| x + feature(k, run, truth)).collect(),
            nominal: (0..FEATURES).map(|k| feature(k, run, &[])).collect(),
            laps: Laps { variance: vec![1.0; FEATURES], scatter: (0..40).map(|_| noise()).collect() },
            discrepancies: Vec::new(),
            built: Vec::new(),
            slopes: DMatrix::zeros(FEATURES, 0),
            prior: Vec::new(),
            bounds: Vec::new(),
            nuisances: Vec::new(),
        });
        Powers { candidates: candidates.into(), frames: frames.collect(), asked: Mutex::default() }
    }

    fn diagnosed(&self) -> Diagnosis {
        diagnose(self, &Settings::default(), &mut |_| {})
    }

    /// Whether it was ever asked for harmonics.
    fn asked_for_harmonics(&self) -> bool {
        self.asked.lock().unwrap().iter().any(|effect| effect.strengths.iter().skip(1).any(|x| *x != 0.0))
    }
}

impl Simulator for Powers {
    fn candidates(&self) -> &Candidates {
        &self.candidates
    }

    fn frames(&self) -> &PerRun<Frame> {
        &self.frames
    }

    fn simulate(&self, run: RunId, _: &[f64], effects: &[Applied]) -> Option<Vec<f64>> {
        self.asked.lock().unwrap().extend(effects.iter().cloned());
        let effects: Vec<(usize, Vec<f64>)> =
            effects.iter().map(|e| (e.candidate.index(), e.strengths.clone())).collect();
        Some((0..FEATURES).map(|k| feature(k, run.index(), &effects)).collect())
    }
}

/// Asserts that a ripple is named at an order, and which of its strengths are not 0 and what they hold.
fn ripples(found: &Diagnosis, order: usize, truth: [f64; 3]) {
    let first = &found.effects[0];
    let named = (found.verdict, first.name.as_str(), first.place.clone());
    assert_eq!(named, (Verdict::Effect, "ripple", format!("order {order}")), "{}", found.summary);
    for (name, x) in ["ratio", "twice", "thrice"].into_iter().zip(truth) {
        match first.strength.get(name) {
            Some(own) if x > 0.0 => {
                assert!(0.0 < own.low && own.low <= x && x <= own.high, "{name} {x}: {own:?}");
                assert!((own.value / x - 1.0).abs() < 0.1, "{name} {x}: {own:?}");
            }
            Some(own) => assert!(own.may_be_zero(), "{name}: {own:?}"),
            None => assert_eq!(x, 0.0, "{name} of {first:?}"),
        }
    }
}

#[test]
fn harmonics_are_found_beside_their_fundamental() {
    for (k, truth) in [[0.1, 0.06, 0.0], [0.1, 0.0, 0.05], [0.2, 0.1, 0.05], [0.05, 0.15, 0.0]].into_iter().enumerate()
    {
        let powers = Powers::new(&[(0, truth.to_vec())], 31 + k as u64);
        ripples(&powers.diagnosed(), 1, truth);
        assert!(powers.asked_for_harmonics());
    }
}

#[test]
fn one_sine_has_no_harmonics_and_is_no_harmonic_of_a_longer_pitch() {
    for (site, order) in SITES.into_iter().enumerate() {
        for seed in [41, 42, 43] {
            let powers = Powers::new(&[(site, vec![0.1, 0.0, 0.0])], seed);
            ripples(&powers.diagnosed(), order, [0.1, 0.0, 0.0]);
        }
    }
}

#[test]
fn where_nothing_ripples_no_harmonic_is_asked_for() {
    let powers = Powers::new(&[(DRAG, vec![0.5])], 51);
    let found = powers.diagnosed();
    assert_eq!((found.verdict, found.effects[0].name.as_str()), (Verdict::Effect, "drag"), "{}", found.summary);
    assert!(!powers.asked_for_harmonics());
    // What was never asked for is not untested: the fundamental was.
    assert_eq!(found.untested_probability, 0.0);
}
