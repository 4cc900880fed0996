//! What a diagnosis costs: three runs with a step of a rail on one track, over all cores.
//!
//! `cargo bench --bench gap [-- LAYOUT.lss]`, the oval of the identification's benches when no layout is given. Its
//! rivals in the same run: the nominal fits alone, which identification needs anyway; and a real re-fit of every
//! candidate in place of the fast screen, reckoned from what simulations of re-fits take here.

#![allow(clippy::expect_used, clippy::unwrap_used)]

#[path = "common/track.rs"]
mod track;

use lss::base::random::normal;
use lss::chain_input::{DeclaredEffect, Simulation};
use lss::dynamics::{End, Plan, Width};
use lss::effects::simulate;
use lss::gap::chain::Chains;
use lss::gap::{Applied, Candidates, Diagnosis, Frame, Laps, PerRun, Request, RunId, Settings, Simulator, diagnose};
use lss::identify::Parameter;
use lss::identify::study::Subject;
use lss::signal::Run;
use std::sync::Mutex;
use std::time::Instant;
use track::track;

/// Speed and tension of the runs over the planned ones.
const RUNS: [(f64, f64); 3] = [(1.0, 1.0), (0.8, 1.2), (1.0, 0.8)];

/// Rounds of simulations that a re-fit takes at most.
const ROUNDS: f64 = 4.0;

fn main() {
    let file = std::env::args().skip(1).find(|a| a != "--bench");
    let file = file.unwrap_or_else(|| "benches/identify/layouts/oval.lss".to_owned());
    let nominal = track(&file);
    let subjects: Vec<Subject> = RUNS.iter().enumerate().map(|(k, over)| measured(&nominal, k, *over)).collect();
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get());

    let clock = Instant::now();
    let chains = Chains::new(&subjects, &Settings::default(), 1, threads, Width::widest(), &|_| {})
        .expect("runs that can be fitted");
    let fits = clock.elapsed().as_secs_f64();
    let counted = Counted { chains, refits: Mutex::default(), simulated: Mutex::default() };
    let clock = Instant::now();
    let found: Diagnosis = diagnose(&counted, &Settings::default(), &mut |_| {});
    let rest = clock.elapsed().as_secs_f64();

    let (refits, seconds) = *counted.refits.lock().expect("a count");
    let simulated = *counted.simulated.lock().expect("a count");
    let candidates = counted.candidates().len();
    let rival = ROUNDS * (candidates * RUNS.len()) as f64 * seconds / refits.max(1) as f64;
    println!(
        "{file}: {} carts, {} m, {threads} threads",
        nominal.chain.carts,
        nominal.track.centre_line().length.round()
    );
    println!("{}", found.summary);
    println!("{:<44}{:>8.0} s", "nominal fits of three runs", fits);
    println!(
        "{:<44}{:>8.0} s   {simulated} simulations, {refits} of them of re-fits",
        "the rest of the diagnosis", rest
    );
    println!("{:<44}{:>8.1}", "diagnosis over nominal fits alone", (fits + rest) / fits);
    println!(
        "{:<44}{:>8.1}",
        format!("re-fits of all {candidates} candidates over it"),
        (fits + rival) / (fits + rest)
    );
}

/// A lap with a step of the right rail by 2 mm, measured with half the as_built step and noise of 1 N.
fn measured(nominal: &Simulation, number: usize, (speed, tension): (f64, f64)) -> Subject {
    let mut simulation = nominal.clone();
    for (p, over) in [(Parameter::Speed, speed), (Parameter::Tension, tension)] {
        p.set(&mut simulation, over * p.get(nominal));
    }
    let mut real = simulation.clone();
    let strengths = [("height", 2e-3), ("at", 0.3 * real.track.centre_line().length), ("rail", 3.0)];
    let strengths = strengths.map(|(name, x)| (name.to_owned(), x)).into();
    real.effects = vec![DeclaredEffect { name: "rail_step".to_owned(), strengths }];
    let plan = Plan { laps: 1, settle: 30.0, step: Some(5e-4), ..Plan::default() };
    let outcome = simulate(&real, &plan, Width::widest(), &mut |_| true).expect("a chain");
    assert_eq!(outcome.end, End::Complete);
    let mut run: Run = outcome.run;
    run.sidecar.speed_setpoint = simulation.chain.speed_m_s;
    run.sidecar.trigger_position = simulation.sensor.photocell_s_m;
    let mut state = number as u64 + 1;
    for samples in run.channels.iter_mut().filter(|(c, _)| c.unit() == "N").map(|(_, samples)| samples) {
        samples.iter_mut().for_each(|x| *x += normal(&mut state));
    }
    Subject { name: format!("run-{:02}", number + 1), run, simulation }
}

/// Chains that count what they are asked, and what re-fits take.
struct Counted {
    chains: Chains,
    /// Simulations, and the time they took over all threads, s.
    refits: Mutex<(usize, f64)>,
    simulated: Mutex<usize>,
}

impl Simulator for Counted {
    fn candidates(&self) -> &Candidates {
        self.chains.candidates()
    }

    fn frames(&self) -> &PerRun<Frame> {
        self.chains.frames()
    }

    fn simulate(&self, run: RunId, step: &[f64], effects: &[Applied]) -> Option<Vec<f64>> {
        self.chains.simulate(run, step, effects)
    }

    fn laps_all(&self, requests: &[Request]) -> Vec<Option<Laps>> {
        *self.simulated.lock().expect("a count") += requests.len();
        self.chains.laps_all(requests)
    }

    fn simulate_all(&self, requests: &[Request]) -> Vec<Option<Vec<f64>>> {
        let clock = Instant::now();
        let answers = self.chains.simulate_all(requests);
        *self.simulated.lock().expect("a count") += requests.len();
        if requests.iter().any(|r| !r.step.is_empty()) {
            let mut refits = self.refits.lock().expect("a count");
            *refits = (refits.0 + requests.len(), refits.1 + clock.elapsed().as_secs_f64());
        }
        answers
    }
}
