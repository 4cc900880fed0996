//! Studies of identification, too long for tests; docs/identification.md shows what they print.
//!
//! `cargo bench --bench identify -- recovery 50`: random truths on four layouts, measured with another integrator, step
//! and noise; how often the 90 % intervals hold them, and the bias. `... -- campaign DIR`: a campaign of 22 runs on
//! seven layouts to fit with `lss identify DIR`, with the truths beside it. `... -- one`: a fit's time on one core.

#![allow(clippy::expect_used, clippy::unwrap_used)]

#[path = "../common/record.rs"]
mod record;
#[path = "../common/track.rs"]
mod track;

use lss::base::parallel;
use lss::base::random::{normal, uniform};
use lss::chain_input::{ContactLaw, Simulation};
use lss::dynamics::{Method, Plan, Width};
use lss::identify::study::{RunFit, Subject, fit_run};
use lss::identify::{COUNT, Counter, FitSettings, Parameter};
use lss::signal::{Run, csv};
use record::record;
use std::path::{Path, PathBuf};
use std::time::Instant;
use track::track;

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    match words.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["recovery", cases] => recovery(cases.parse().expect("a number of cases")),
        ["campaign", folder] => campaign(Path::new(folder)),
        _ => one(),
    }
}

const LAYOUTS: [&str; 7] = [
    "examples/reference.lss",
    "examples/levels.lss",
    "examples/spiral.lss",
    "benches/identify/layouts/oval.lss",
    "benches/identify/layouts/hook.lss",
    "benches/identify/layouts/slant.lss",
    "benches/identify/layouts/comb.lss",
];

/// A truth about nominal values: restitutions of `restitution`, the others within 2 to 60 %.
fn truth(nominal: &Simulation, restitution: (f64, f64), state: &mut u64) -> [f64; COUNT] {
    let mut draw = |from: f64, to: f64| from + (to - from) * uniform(state);
    std::array::from_fn(|k| {
        let p = Parameter::ALL[k];
        let value = p.get(nominal);
        match p {
            Parameter::Speed => value * draw(0.98, 1.02),
            Parameter::Tension => value * draw(0.7, 1.5),
            Parameter::RollingResistance => value * draw(0.7, 1.4),
            Parameter::TriggerPosition => value + draw(-0.4, 0.4),
            Parameter::KP | Parameter::KI => value * draw(0.6, 1.6),
            _ => draw(restitution.0, restitution.1),
        }
    })
}

/// A lap as a sensor cart would bring it home: a quarter of the usual step or less, every fifth by Runge and Kutta's
/// method, noise of 1 N and 0.05 rad/s; the sidecar has the nominal values.
fn measure(nominal: &Simulation, truth: &[f64; COUNT], case: u64, state: &mut u64) -> Run {
    let mut real = nominal.clone();
    Parameter::ALL.iter().for_each(|p| p.set(&mut real, truth[p.index()]));
    let method = if case % 5 == 4 { Method::CashKarp } else { Method::Verlet };
    let plan =
        Plan { laps: 1, settle: 30.0, step: Some(2.5e-4), method, front: 1.25 * uniform(state), supports: false };
    let mut run = record(&real, nominal, plan);
    for (channel, samples) in &mut run.channels {
        let deviation = match channel.unit() {
            "N" => 1.0,
            "rad/s" => 0.05,
            _ => 0.0,
        };
        samples.iter_mut().for_each(|x| *x += deviation * normal(state));
    }
    run
}

fn fitted(subject: &Subject, seed: u64) -> RunFit {
    let settings = FitSettings { seed, ..FitSettings::default() };
    fit_run(subject, ContactLaw::default(), None, &settings, (Width::widest(), &Counter::default()), String::new())
        .expect("a fit")
}

fn recovery(cases: u64) {
    let layouts: Vec<Simulation> = [0, 1, 4, 5].iter().map(|k| track(LAYOUTS[*k])).collect();
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
    let numbers: Vec<u64> = (0..cases).collect();
    let clock = Instant::now();
    let found = parallel::map(&numbers, threads, |&case| {
        let nominal = &layouts[case as usize % layouts.len()];
        let mut state = 9000 + case;
        let truth = truth(nominal, (0.35, 0.85), &mut state);
        let run = measure(nominal, &truth, case, &mut state);
        let subject = Subject { name: format!("case-{case:02}"), run, simulation: nominal.clone() };
        (truth, fitted(&subject, case))
    });
    println!("{cases} truths in {:.0} s over {threads} threads", clock.elapsed().as_secs_f64());
    println!("{:<26}{:>8}{:>14}{:>14}{:>14}", "parameter", "inside", "median width", "median bias", "rms error");
    let mut inside_all = 0;
    for p in Parameter::ALL {
        let ratio = |x: f64, truth: f64| match p {
            Parameter::TriggerPosition => x - truth,
            _ if p.is_restitution() => x - truth,
            _ => x / truth - 1.0,
        };
        let estimates: Vec<_> = found.iter().map(|(t, f)| (t[p.index()], f.parameters[p.name()])).collect();
        let inside = estimates.iter().filter(|(t, e)| e.low <= *t && *t <= e.high).count();
        inside_all += inside;
        let median = |mut x: Vec<f64>| {
            x.sort_by(f64::total_cmp);
            x[x.len() / 2]
        };
        let errors: Vec<f64> = estimates.iter().map(|(t, e)| ratio(e.value, *t)).collect();
        let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
        let width = median(estimates.iter().map(|(t, e)| ratio(e.high, *t) - ratio(e.low, *t)).collect());
        println!(
            "{:<26}{:>7.0}%{:>14.5}{:>14.5}{:>14.5}",
            p.name(),
            100.0 * inside as f64 / cases as f64,
            width,
            median(errors),
            rms
        );
    }
    println!("all: {:.1} %", 100.0 * inside_all as f64 / (cases as usize * COUNT) as f64);
}

fn campaign(folder: &Path) {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
    let numbers: Vec<u64> = (0..22).collect();
    std::fs::create_dir_all(folder).expect("a folder");
    for file in LAYOUTS {
        let name = Path::new(file).file_name().expect("a name");
        std::fs::copy(root.join(file), folder.join(name)).expect("a copy");
    }
    // Speeds and tensions that the runs of a layout are set to, of its nominal ones.
    const SETTINGS: [(f64, f64); 4] = [(1.0, 1.0), (0.85, 1.4), (1.1, 0.8), (0.95, 1.8)];
    let runs = parallel::map(&numbers, threads, |&k| {
        let file = LAYOUTS[k as usize % LAYOUTS.len()];
        let (speed, tension) = SETTINGS[k as usize / LAYOUTS.len()];
        let mut nominal = track(file);
        nominal.chain.speed_m_s *= speed;
        nominal.chain.tension_n *= tension;
        let mut state = 77_000 + k;
        let mut truth = truth(&nominal, (0.0, 1.0), &mut state);
        // Wheels and joints are much the same in all runs.
        for (p, e) in Parameter::RESTITUTIONS.into_iter().zip([0.62, 0.55, 0.58, 0.66]) {
            truth[p.index()] = e + 0.03 * normal(&mut state);
        }
        let mut run = measure(&nominal, &truth, k, &mut state);
        let layout = Path::new(file).file_name().expect("a name").to_string_lossy().into_owned();
        run.sidecar.layout.clone_from(&layout);
        let name = format!("run-{:02}", k + 1);
        std::fs::write(folder.join(format!("{name}.csv")), csv::write(&run)).expect("written");
        std::fs::write(folder.join(format!("{name}.toml")), run.sidecar.write()).expect("written");
        let (speed, tension) = (nominal.chain.speed_m_s, nominal.chain.tension_n);
        let entry = format!(
            "[[run]]\nfile = \"{name}.csv\"\nlayout = \"{layout}\"\nspeed = {speed:?}\ntension = {tension:?}\n"
        );
        let values: Vec<String> =
            Parameter::ALL.iter().map(|p| format!("\"{}\": {}", p.name(), truth[p.index()])).collect();
        (entry, format!("\"{name}\": {{{}}}", values.join(", ")))
    });
    let entries: Vec<String> = runs.iter().map(|r| r.0.clone()).collect();
    std::fs::write(folder.join("campaign.toml"), entries.join("\n")).expect("written");
    let truths: Vec<String> = runs.iter().map(|r| r.1.clone()).collect();
    std::fs::write(folder.join("truth.json"), format!("{{{}}}\n", truths.join(",\n"))).expect("written");
}

fn one() {
    let nominal = track(LAYOUTS[0]);
    let mut state = 1;
    let truth = truth(&nominal, (0.35, 0.85), &mut state);
    let run = measure(&nominal, &truth, 0, &mut state);
    let subject = Subject { name: "one".into(), run, simulation: nominal };
    let clock = Instant::now();
    let fit = fitted(&subject, 1);
    println!(
        "one run of ten parameters on one core: {:.1} s, {} simulations, {} steps",
        clock.elapsed().as_secs_f64(),
        fit.simulations,
        fit.steps
    );
}
