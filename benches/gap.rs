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
use lss::gap::chain::{Chains, Work};
use lss::gap::{Costs, Settings, Simulator, diagnose};
use lss::identify::Parameter;
use lss::identify::study::Subject;
use lss::signal::Run;
use lss::solve::Stop;
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

    let mut costs = Costs::new("nominal_fits");
    let work = Work { seed: 1, threads, width: Width::widest(), stop: Stop::NEVER };
    let chains = Chains::new(&subjects, &Settings::default(), work, &|_| {}).expect("runs that can be fitted");
    let mut found = diagnose(&chains, &Settings::default(), &mut |stage| costs.enter(stage.name(), chains.effort()));
    let candidates = chains.candidates().len();
    costs.enter("nominal_fits", chains.effort());
    let anew = chains.anew(&subjects, &found, &Settings::default(), &|_| {});
    if let Some(anew) = &anew {
        found = diagnose(anew, &Settings::default(), &mut |stage| costs.enter(stage.name(), anew.effort()));
    }
    let cost = costs.finish(anew.as_ref().map_or(chains.effort(), |anew| anew.effort()));

    let (fits, refits) =
        (cost.by_stage["nominal_fits"].wall_s, cost.by_stage.get("refits").cloned().unwrap_or_default());
    let each = refits.wall_s / refits.simulations.max(1) as f64;
    let rival = fits + ROUNDS * (candidates * RUNS.len()) as f64 * each;
    println!(
        "{file}: {} carts, {} m, {threads} threads",
        nominal.chain.carts,
        nominal.track.centre_line().length.round()
    );
    println!("{}", found.summary);
    for (stage, cost) in cost.by_stage.iter().map(|(stage, cost)| (*stage, cost)).chain([("all", &cost)]) {
        println!(
            "{stage:<20}{:>8.1} s {:>8} simulations of {:>8.0} s",
            cost.wall_s, cost.simulations, cost.simulated_s
        );
    }
    println!("the whole over nominal fits alone: {:.1}", cost.wall_s / fits);
    println!("re-fits of all {candidates} candidates, reckoned, over it: {:.1}", rival / cost.wall_s);
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
    run.sidecar.tension_setpoint = Some(simulation.chain.tension_n);
    run.sidecar.trigger_position = simulation.sensor.photocell_s_m;
    let mut state = number as u64 + 1;
    for samples in run.channels.iter_mut().filter(|(c, _)| c.unit() == "N").map(|(_, samples)| samples) {
        samples.iter_mut().for_each(|x| *x += normal(&mut state));
    }
    Subject { name: format!("run-{:02}", number + 1), run, simulation }
}
