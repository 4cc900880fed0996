//! Runs of a chain without a gap, as they may come: begun and ended anywhere, with losses, and with noise of several
//! kinds. The model that made them fits on a small loop. On larger tracks it does not yet always: the long test prints
//! what is outside, and asserts only what intervals hold.
//!
//! `cargo test --release --test chains noisy_windows:: -- --ignored --nocapture` goes over 40 runs of four layouts;
//! docs/identification.md has what it prints.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use crate::record::record;
use crate::track;
use lss::base::parallel;
use lss::base::random::{normal, uniform};
use lss::base::trig;
use lss::chain_input::{ContactLaw, Simulation};
use lss::dynamics::{Plan, Width};
use lss::identify::fit::fit;
use lss::identify::{COUNT, FitSettings, Measured, Model, Parameter, interval};
use lss::signal::{Channel, Run};

/// A small loop, and those that are gone over for long.
const SHORT: &str = "benches/identify/layouts/short.lss";
const LAYOUTS: [&str; 4] = [
    "benches/identify/layouts/oval.lss",
    "benches/identify/layouts/hook.lss",
    "benches/identify/layouts/comb.lss",
    "examples/reference.lss",
];

/// What the objective of a run is that the model made.
const OBJECTIVE: std::ops::RangeInclusive<f64> = 0.7..=1.4;

/// Laps of a run.
const LAPS: (f64, f64) = (0.6, 5.0);

fn between(from: f64, to: f64, state: &mut u64) -> f64 {
    from + (to - from) * uniform(state)
}

fn log_between(from: f64, to: f64, state: &mut u64) -> f64 {
    trig::exp(between(trig::ln(from), trig::ln(to), state))
}

/// A truth about nominal values.
fn truth(nominal: &Simulation, state: &mut u64) -> [f64; COUNT] {
    std::array::from_fn(|k| {
        let p = Parameter::ALL[k];
        let value = p.get(nominal);
        match p {
            Parameter::Speed => value * between(0.98, 1.02, state),
            Parameter::Tension => value * between(0.7, 1.5, state),
            Parameter::RollingResistance => value * between(0.7, 1.4, state),
            Parameter::TriggerPosition => value + between(-0.4, 0.4, state),
            Parameter::KP | Parameter::KI => value * between(0.6, 1.6, state),
            _ => between(0.35, 0.85, state),
        }
    })
}

/// Which kinds of noise a run has beside white noise.
#[derive(Clone, Copy, Debug)]
struct Kinds {
    coloured: bool,
    drift: bool,
    hum: bool,
    quantised: bool,
}

impl Kinds {
    fn drawn(state: &mut u64) -> Kinds {
        let mut half = || uniform(state) < 0.5;
        Kinds { coloured: half(), drift: half(), hum: half(), quantised: half() }
    }

    fn words(self) -> String {
        let all =
            [(self.coloured, "coloured"), (self.drift, "drift"), (self.hum, "hum"), (self.quantised, "quantised")];
        std::iter::once("white")
            .chain(all.into_iter().filter(|(has, _)| *has).map(|(_, word)| word))
            .collect::<Vec<_>>()
            .join(" ")
    }
}

/// A process of first order of unit variance, with what it remembers from sample to sample.
struct Process {
    memory: f64,
    now: f64,
}

impl Process {
    fn new(rate: f64, time: f64, state: &mut u64) -> Process {
        Process { memory: trig::exp(-1.0 / (rate * time)), now: normal(state) }
    }

    fn next(&mut self, state: &mut u64) -> f64 {
        self.now = self.memory * self.now + (1.0 - self.memory * self.memory).sqrt() * normal(state);
        self.now
    }
}

/// Adds noise to every channel, of its own level each: white noise of 0.2 to 3 N; noise with a correlation time of 0.05
/// to 1 s, of 0.1 to 1.5 N (joint_xi: three times that); drift over 40 s, of 0.02 to 0.1 % of the largest force; hum of
/// 0.05 to 1 N at 50 or 60 Hz; steps of 0.02 to 0.5 N. Wheel speeds have white noise, hum and steps of 0.05 rad/s for
/// each newton.
fn add_noise(run: &mut Run, kinds: Kinds, state: &mut u64) {
    let rate = run.rate();
    let mains = if uniform(state) < 0.5 { 50.0 } else { 60.0 } + 0.03 * normal(state);
    for (channel, samples) in &mut run.channels {
        let (scale, is_force) = match channel.unit() {
            "N" => (1.0, true),
            "rad/s" => (0.05, false),
            _ => continue,
        };
        let largest = samples.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let white = scale * log_between(0.2, 3.0, state);
        let own = if *channel == Channel::JointXi { 3.0 } else { 1.0 };
        let (coloured, time) = (own * log_between(0.1, 1.5, state), log_between(0.05, 1.0, state));
        let drift = largest * log_between(2e-4, 1e-3, state);
        let (hum, phase) = (scale * log_between(0.05, 1.0, state), trig::TAU * uniform(state));
        let step = scale * log_between(0.02, 0.5, state);
        let mut fast = Process::new(rate, time, state);
        let mut slow = Process::new(rate, 40.0, state);
        for (x, t) in samples.iter_mut().zip(&run.time) {
            *x += white * normal(state);
            if kinds.coloured && is_force {
                *x += coloured * fast.next(state);
            }
            if kinds.drift && is_force {
                *x += drift * slow.next(state);
            }
            if kinds.hum {
                *x += hum * trig::sin(trig::TAU * mains * t + phase);
            }
            if kinds.quantised {
                *x = (*x / step).round() * step;
            }
        }
    }
}

/// Up to two losses of up to 0.15 laps, of one channel or of all but the trigger.
fn lose(run: &mut Run, lap: f64, state: &mut u64) {
    for _ in 0..(3.0 * uniform(state)) as usize {
        let at = (uniform(state) * run.time.len() as f64) as usize;
        let long = (log_between(0.002, 0.15, state) * lap) as usize;
        let one = (uniform(state) < 0.5).then(|| (7.0 * uniform(state)) as usize);
        let channels = run.channels.iter_mut().filter(|(channel, _)| **channel != Channel::Trigger);
        for (_, samples) in channels.enumerate().filter(|(k, _)| one.is_none_or(|one| one == *k)).map(|(_, own)| own) {
            let to = (at + long).min(samples.len());
            samples[at..to].fill(f64::NAN);
        }
    }
}

struct Case {
    nominal: Simulation,
    truth: [f64; COUNT],
    run: Run,
    about: String,
}

/// A run of a chain with a truth of its own, cut out of a longer one.
fn case(layouts: &[(&str, Simulation)], seed: u64) -> Case {
    let state = &mut (seed.wrapping_mul(0x9e37_79b9) + 77);
    let (file, layout) = &layouts[seed as usize % layouts.len()];
    let mut nominal = layout.clone();
    let truth = truth(&nominal, state);
    let (laps, begin) = (log_between(LAPS.0, LAPS.1, state), uniform(state));
    nominal.sensor.cart = 1 + (uniform(state) * nominal.chain.carts as f64) as usize;
    let mut real = nominal.clone();
    Parameter::ALL.iter().for_each(|p| p.set(&mut real, truth[p.index()]));
    let whole = (begin + laps).ceil() as usize;
    let front = 1.25 * uniform(state);
    let plan = Plan { laps: whole, step: Some(2.5e-4), front, ..Plan::default() };
    let mut run = record(&real, &nominal, plan);
    let lap = run.time.len() as f64 / whole as f64;
    let index = |laps: f64| ((laps * lap) as usize).min(run.time.len());
    let (from, to) = (index(begin), index(begin + laps));
    let began = run.time[from];
    run.time = run.time[from..to].iter().map(|t| t - began).collect();
    run.channels.values_mut().for_each(|samples| *samples = samples[from..to].to_vec());
    let kinds = Kinds::drawn(state);
    add_noise(&mut run, kinds, state);
    lose(&mut run, lap, state);
    let about =
        format!("{seed} {}, {laps:.2} laps from {begin:.2}, {}", file.rsplit('/').next().unwrap(), kinds.words());
    Case { nominal, truth, run, about }
}

/// The objective of a run's fit, and of each parameter whether its interval holds the truth; nothing of a record that
/// cannot be placed.
fn fitted(case: &Case, seed: u64) -> Option<(f64, [bool; COUNT])> {
    let lap = case.nominal.track.centre_line().length;
    let measured = match Measured::new(&case.run, &case.nominal, lap) {
        Ok(measured) => measured,
        Err(why) => {
            assert!(why.contains("the trigger never rises"), "{why}");
            return None;
        }
    };
    let mut model = Model::new(&case.nominal, ContactLaw::default(), &measured, Width::widest());
    let found = fit(&mut model, &measured, None, &FitSettings { seed, ..FitSettings::default() }).expect("a fit");
    let holds = Parameter::ALL.map(|p| {
        let deviation = found.covariance[(p.index(), p.index())].sqrt();
        let (low, high) = interval(found.at[p.index()], deviation, model.range(p), 0.9);
        (low..=high).contains(&model.coordinate(p, case.truth[p.index()]))
    });
    Some((found.objective, holds))
}

fn threads() -> usize {
    std::thread::available_parallelism().map_or(1, |n| n.get())
}

/// Objectives and what intervals hold, over runs of layouts.
fn go_over(files: &[&'static str], seeds: std::ops::Range<u64>) -> Vec<(String, f64, [bool; COUNT])> {
    let layouts: Vec<_> = files.iter().map(|file| (*file, track::track(file))).collect();
    let seeds: Vec<u64> = seeds.collect();
    let found = parallel::map(&seeds, threads(), |&seed| {
        let case = case(&layouts, seed);
        fitted(&case, seed).map(|(objective, holds)| (case.about, objective, holds))
    });
    found.into_iter().flatten().collect()
}

fn outside(found: &[(String, f64, [bool; COUNT])]) -> Vec<String> {
    let off = found.iter().filter(|(_, objective, _)| !OBJECTIVE.contains(objective));
    off.map(|(about, objective, _)| format!("{about}: {objective:.3}")).collect()
}

#[test]
fn a_run_without_a_gap_fits_whatever_its_window_and_its_noise() {
    let found = go_over(&[SHORT], 0..6);
    found.iter().for_each(|(about, objective, _)| println!("{about}: {objective:.3}"));
    assert!(found.len() == 6, "{found:#?}");
    // A fit's draws of noise move the objective of a short record by a tenth to a fifth: where one is outside, the middle of
    // five is asked for.
    let layouts = [(SHORT, track::track(SHORT))];
    let off = (0..).zip(&found).filter(|(_, (_, objective, _))| !OBJECTIVE.contains(objective));
    for (seed, (about, objective, _)) in off {
        let case = case(&layouts, seed);
        let again = parallel::map(&[1, 2, 3, 4], threads(), |k| fitted(&case, seed + k));
        let again = again.into_iter().map(|fit| fit.map_or(f64::INFINITY, |(objective, _)| objective));
        let mut all: Vec<f64> = std::iter::once(*objective).chain(again).collect();
        all.sort_by(f64::total_cmp);
        println!("{about}: {all:.3?}");
        assert!(OBJECTIVE.contains(&all[all.len() / 2]), "{about}: {all:?}");
    }
}

#[test]
#[ignore = "minutes"]
fn objectives_and_intervals_of_many_runs() {
    let found = go_over(&LAYOUTS, 0..40);
    found.iter().for_each(|(about, objective, _)| println!("{about}: {objective:.3}"));
    let mut objectives: Vec<f64> = found.iter().map(|(_, objective, _)| *objective).collect();
    objectives.sort_by(f64::total_cmp);
    let at = |share: f64| objectives[((objectives.len() - 1) as f64 * share) as usize];
    println!("{} runs, objective {:.2} to {:.2}, median {:.2}", found.len(), at(0.0), at(1.0), at(0.5));
    let mut all = 0;
    for p in Parameter::ALL {
        let holds = found.iter().filter(|(_, _, holds)| holds[p.index()]).count();
        println!("{:<26}{holds} of {}", p.name(), found.len());
        all += holds;
    }
    let share = all as f64 / (COUNT * found.len()) as f64;
    println!("all {:.1} %", 100.0 * share);
    let off = outside(&found);
    println!("{} outside: {off:#?}", off.len());
    assert!(share > 0.85, "{share}");
}
