//! A record begins and ends anywhere and has gaps: the objective is that of whole laps, as what was measured is
//! compared with the same passings of the simulation.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use crate::track;
use lss::base::random::{normal, uniform};
use lss::base::trig;
use lss::chain_input::Simulation;
use lss::dynamics::{Plan, Width};
use lss::effects::simulate;
use lss::identify::fit::fit;
use lss::identify::{FitSettings, Measured, Model, Parameter};
use lss::signal::{Channel, Run};

const LAYOUT: &str = "benches/identify/layouts/oval.lss";

/// Laps of the run from which windows are cut.
const LAPS: usize = 4;

fn run(simulation: &Simulation) -> Run {
    let plan = Plan { laps: LAPS, front: 0.3, ..Plan::default() };
    let mut run = simulate(simulation, &plan, Width::widest(), &mut |_| true).expect("a chain").run;
    let mut state = 11;
    for (_, samples) in run.channels.iter_mut().filter(|(channel, _)| channel.is_force()) {
        samples.iter_mut().for_each(|x| *x += normal(&mut state));
    }
    run
}

/// The samples from one to another, with those of `gap` lost.
fn cut(run: &Run, from: usize, to: usize, gap: std::ops::Range<usize>) -> Run {
    let mut out = run.clone();
    out.time = run.time[from..to].iter().map(|t| t - run.time[from]).collect();
    for (channel, samples) in &mut out.channels {
        if *channel != Channel::Trigger {
            samples[gap.clone()].fill(f64::NAN);
        }
        *samples = samples[from..to].to_vec();
    }
    out
}

/// Objective at the parameters that made the run.
fn objective(simulation: &Simulation, run: &Run) -> Result<f64, String> {
    let measured = Measured::new(run, simulation, simulation.chain.track_length_m)?;
    let mut model = Model::new(simulation, simulation.contact_law, &measured, Width::widest());
    let truth = Parameter::ALL.map(|p| model.coordinate(p, p.get(simulation)));
    let settings = FitSettings { steps: 0, threads: 2, ..FitSettings::default() };
    fit(&mut model, &measured, Some(truth), &settings).map(|fit| fit.objective)
}

#[test]
fn a_window_of_a_run_fits_as_whole_laps_do() {
    let simulation = track::track(LAYOUT);
    let run = run(&simulation);
    let whole = objective(&simulation, &run).expect("an objective");
    let lap = run.time.len() as f64 / LAPS as f64;
    let mut state = 5;
    let mut draw = |from: f64, to: f64| from + (to - from) * uniform(&mut state);
    let (mut found, mut wrong) = (0, Vec::new());
    for _ in 0..100 {
        // In turn less than a lap, and more.
        let laps = if found % 2 == 0 { draw(0.6, 0.95) } else { draw(1.0, 3.0) };
        let begin = draw(0.0, LAPS as f64 - laps);
        let (lost, at) = (draw(0.01, 0.15), begin + laps * draw(0.2, 0.7));
        let index = |laps: f64| ((laps * lap) as usize).min(run.time.len());
        let (from, to) = (index(begin), index(begin + laps));
        let window = cut(&run, from, to, index(at)..index(at + lost).min(to));
        match objective(&simulation, &window) {
            // Nothing tells where such a window is.
            Err(why) => assert!(why.contains("the trigger never rises"), "{why}"),
            Ok(own) => {
                found += 1;
                println!("{laps:.2} laps from {begin:.2}, {lost:.2} lost at {at:.2}: {own:.3}, whole {whole:.3}");
                if (own / whole - 1.0).abs() > 0.2 {
                    wrong.push(format!(
                        "{laps:.2} laps from {begin:.2}, {lost:.2} lost at {at:.2}: {own:.3}, not {whole:.3}"
                    ));
                }
            }
        }
        if found == 8 {
            break;
        }
    }
    assert!(found >= 8 && wrong.is_empty(), "{wrong:#?}");
}

/// The same with a stop of 20 s, whose forces are those of no running chain; the chain slows down and starts within 3 s
/// each.
fn stopped(run: &Run, at: usize) -> Run {
    let rate = run.rate();
    let (ramp, rest) = ((3.0 * rate) as usize, (20.0 * rate) as usize);
    // Both ramps together are as far as one at full speed.
    let (skipped, long) = (ramp, 2 * ramp + rest);
    let share = |k: usize| -> f64 {
        if k < ramp { 1.0 - k as f64 / ramp as f64 } else { (k as f64 - (ramp + rest) as f64).max(0.0) / ramp as f64 }
    };
    let mut out = run.clone();
    for (channel, samples) in &mut out.channels {
        let before = samples[at];
        let stop = (0..long).map(|k| match channel.unit() {
            "rad/s" => share(k) * before,
            "N" => before + 400.0 * (1.0 - share(k)),
            _ => before,
        });
        let stop: Vec<f64> = stop.collect();
        samples.splice(at..at + skipped, stop);
    }
    let samples = out.channels[&Channel::Trigger].len();
    out.time = (0..samples).map(|k| k as f64 / rate).collect();
    out
}

#[test]
fn a_stop_is_no_part_of_a_lap() {
    let simulation = track::track(LAYOUT);
    let run = run(&simulation);
    let whole = objective(&simulation, &run).expect("an objective");
    let lap = run.time.len() / LAPS;
    // In the second lap, away from the trigger; and once more with the stop in the record's only whole lap.
    for (laps, at) in [(4, 1.4), (2, 0.6)] {
        let window = cut(&run, 0, laps * lap, 0..0);
        let stopped = stopped(&window, (at * lap as f64) as usize);
        let measured = Measured::new(&stopped, &simulation, simulation.chain.track_length_m).expect("a record");
        let (speed, _) = measured.speed.expect("a speed");
        assert!((speed / simulation.chain.speed_m_s - 1.0).abs() < 2e-3, "{speed}");
        assert!((30.0..45.0).contains(&measured.unsteady), "{}", measured.unsteady);
        let own = objective(&simulation, &stopped).expect("an objective");
        println!("stop at {at} of {laps} laps: {own:.3}, whole {whole:.3}");
        assert!((own / whole - 1.0).abs() < 0.2, "{own} {whole}");
    }
}

/// Rounded to 2 N, with 3 N of hum, or set to zero under load: what a recorder does to a run without a gap is none. Whole
/// laps, and a window with a gap.
#[test]
fn what_a_recorder_does_to_forces_is_no_gap() {
    let simulation = track::track(LAYOUT);
    let plan = Plan { laps: LAPS, front: 0.3, ..Plan::default() };
    let run = simulate(&simulation, &plan, Width::widest(), &mut |_| true).expect("a chain").run;
    let lap = run.time.len() / LAPS;
    let changed = |run: &Run, of: &dyn Fn(usize, f64, f64) -> f64| {
        let mut run = run.clone();
        for (k, force) in Channel::FORCES.into_iter().enumerate() {
            let Some(samples) = run.channels.get_mut(&force) else { continue };
            let known: Vec<f64> = samples.iter().copied().filter(|x| x.is_finite()).collect();
            let mean = known.iter().sum::<f64>() / known.len() as f64;
            samples.iter_mut().enumerate().for_each(|(i, x)| *x = of(i, mean + 11.0 * k as f64, *x));
        }
        run
    };
    for window in [cut(&run, 0, 2 * lap, 0..0), cut(&run, lap / 3, lap / 3 + 6 * lap / 5, lap..lap + lap / 20)] {
        let as_it_is = objective(&simulation, &window).expect("an objective");
        let rounded = changed(&window, &|_, _, x| 2.0 * (x / 2.0).round());
        let hum = |k: usize| 3.0 * trig::sin(trig::TAU * 50.0 * k as f64 / 500.0 + 0.3);
        let humming = changed(&window, &|k, _, x| x + hum(k));
        // Whatever was on the sensors then.
        let mut zeroed = changed(&window, &|_, mean, x| x - mean);
        let unsaid = objective(&simulation, &zeroed).expect("an objective");
        assert!(unsaid > 100.0, "{unsaid}");
        zeroed.sidecar.zeroed = Channel::FORCES.to_vec();
        for (how, run) in [("rounded", rounded), ("humming", humming), ("zeroed", zeroed)] {
            let own = objective(&simulation, &run).expect("an objective");
            println!("{how}: {own:.3}, as it is {as_it_is:.3}");
            assert!((0.7..1.4).contains(&own), "{how}: {own}, as it is {as_it_is}");
        }
    }
}
