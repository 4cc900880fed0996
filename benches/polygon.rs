//! What `docs/polygon.md` claims: `cargo bench --bench polygon`.
//!
//! How well the kinematic measure predicts the dynamic model over random layouts (rank correlation), and the search
//! beside Box's complex method on the same problem.

#![allow(clippy::expect_used, clippy::unwrap_used)]

#[path = "common/layout.rs"]
mod layout;

use layout::layout;
use lss::chain_input::Simulation;
use lss::compiled::Compiled;
use lss::dynamics::{Plan, Width};
use lss::effects::simulate_all;
use lss::geometry::{Point, Track};
use lss::kinematics::polygon::{Course, PolygonObjective, action};
use lss::model::{Goal, Layout};
use lss::problem::{Problem, Scope, perturbed};
use lss::signal::Channel;
use lss::signal::measures::statistics;
use lss::signal::spectrum::welch;
use lss::solve::polygon::{Smooth, rival, run};
use lss::solve::{Options, discretise, solve};
use std::time::Instant;

/// Random layouts, and repetitions of the complex method (the thesis' ten).
const LAYOUTS: u64 = 40;
const REPETITIONS: u64 = 10;

fn main() {
    // `cargo bench -- correlation` runs one of both.
    let wanted: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let runs = |name: &str| wanted.is_empty() || wanted.iter().any(|w| w == name);
    if runs("correlation") {
        correlation();
    }
    if runs("complex") {
        beside_complex("reference", REFERENCE, None);
        beside_complex("thesis10", include_str!("../examples/thesis10.lss"), Some(0.005));
    }
}

/// The reference track as a layout that may be optimised.
const REFERENCE: &str = include_str!("../examples/reference.lss");

/// The reference track with every section shifted sideways at random, which keeps its ten turns of 90° and the length
/// within a few metres: 40 tracks that differ in their phases alone.
fn shifted(seed: u64) -> Layout {
    let mut layout = layout(REFERENCE);
    let problem = Problem::new(&layout, Scope::Obstacles);
    let drawn = perturbed(&layout, &problem, 0.6, seed);
    let n = layout.vertices.len();
    let written: Vec<Point> = layout.vertices.iter().map(|v| v.point).collect();
    for i in 0..n {
        // A section keeps its heading: it takes the random shift of its first vertex across it.
        let across = |k: usize| {
            let along = written[(k + 1) % n] - written[k];
            let left = along.left() * (1.0 / along.norm());
            let moved = Point::new(drawn[3 * k], drawn[3 * k + 1]) - written[k];
            left * left.dot(moved)
        };
        let shift = across((i + n - 1) % n) + across(i);
        layout.vertices[i].point = written[i] + shift;
    }
    layout
}

fn correlation() {
    let begin = Instant::now();
    let inputs: Vec<(Simulation, Plan)> = (1..=LAYOUTS)
        .map(|seed| {
            let layout = shifted(seed);
            let stages = solve(&layout, &Options::default(), &|_| ());
            (Simulation::new(&Compiled::new(layout, stages)), Plan::default())
        })
        .collect();
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get());
    let laps: Vec<_> = simulate_all(&inputs, Width::widest(), threads).into_iter().map(|l| l.expect("a lap")).collect();
    println!("{LAYOUTS} layouts, each a lap after 30 s: {:.0} s", begin.elapsed().as_secs_f64());
    // Carts are adapted to close, and so the kinematic chain has their length.
    let actions: Vec<_> = inputs
        .iter()
        .zip(&laps)
        .map(|((s, _), lap)| {
            let course = Course::new(&s.track.centre_line()).expect("a course");
            action(&course, lap.cart_length).expect("a chain")
        })
        .collect();
    println!("\nSpearman's rank correlation of polygon action with the dynamic model's forces");
    println!("{:<12} {:<12} {:>8} {:>12}", "objective", "channel", "sd", "at passing");
    for objective in PolygonObjective::EACH {
        let kinematic: Vec<f64> = actions.iter().map(|a| a.value(objective)).collect();
        for channel in [Channel::JointXi, Channel::SteerLeft, Channel::SteerRight] {
            let of = |f: &dyn Fn(&lss::dynamics::Outcome) -> f64| -> Vec<f64> { laps.iter().map(f).collect() };
            let sd = of(&|lap| statistics(&lap.run.channels[&channel]).map_or(0.0, |s| s.sd));
            let passing = of(&|lap| {
                let (rate, carts) = (lap.run.rate(), lap.carts as f64);
                let f = 2.0 * carts / lap.track;
                welch(&lap.run.channels[&channel], rate, (10.0 * rate) as usize).band(0.85 * f, 1.15 * f)
            });
            println!(
                "{:<12} {:<12} {:>8.2} {:>12.2}",
                objective.name(),
                channel.name(),
                spearman(&kinematic, &sd),
                spearman(&kinematic, &passing)
            );
        }
    }
    let spread = |objective: PolygonObjective| {
        let mut all: Vec<f64> = actions.iter().map(|a| 1e6 * a.value(objective)).collect();
        all.sort_by(f64::total_cmp);
        (all[0], all[all.len() / 2], all[all.len() - 1])
    };
    println!("\nleast, median and largest polygon action, mm²");
    for objective in PolygonObjective::EACH {
        let (low, middle, high) = spread(objective);
        println!("{:<12} {low:>9.2} {middle:>9.2} {high:>9.2}", objective.name());
    }
}

fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*a].total_cmp(&values[*b]));
    let mut ranks = vec![0.0; values.len()];
    order.iter().enumerate().for_each(|(rank, k)| ranks[*k] = rank as f64);
    ranks
}

fn spearman(a: &[f64], b: &[f64]) -> f64 {
    let n = a.len() as f64;
    let apart: f64 = ranks(a).iter().zip(ranks(b)).map(|(x, y)| (x - y) * (x - y)).sum();
    1.0 - 6.0 * apart / (n * (n * n - 1.0))
}

fn beside_complex(name: &str, text: &str, budget: Option<f64>) {
    let mut layout = layout(text);
    layout.objective.terms = vec![(1.0, Goal::PolygonAction)];
    layout.objective.within = budget.map(|ratio| (Goal::Length, ratio));
    let goal = Smooth::of(&layout.objective).expect("polygon action");
    let options = Options::default();
    let value = |corners: &[lss::geometry::Corner]| {
        let course = Course::of_track(&Track::new(corners)).expect("a course");
        1e6 * action(&course, layout.cart.length).expect("a chain").value(goal.counted)
    };
    let begin = Instant::now();
    let (stages, effort) = run(&layout, goal, &options, discretise, &|_| ());
    let seconds = begin.elapsed().as_secs_f64();
    let [.., base, last] = stages.as_slice() else { panic!("{stages:?}") };
    println!("\n{name}: Σ ΔP², mm², of all straights from all starts; before {:.2}", value(&base.corners));
    println!("{:<24} {:>10} {:>9} {:>12} {:>9}", "", "value", "length", "evaluations", "seconds");
    println!(
        "{:<24} {:>10.2} {:>9.3} {:>12} {:>9.1}   {} choices of turns, {} steps of the SQP",
        "this search, on the grid",
        value(&last.corners),
        last.length,
        effort.phases + effort.iterations,
        seconds,
        effort.choices,
        effort.iterations
    );
    for seed in 1..=REPETITIONS {
        let begin = Instant::now();
        let Some(found) = rival(&layout, goal, &options, discretise, seed) else { continue };
        println!(
            "{:<24} {:>10.2} {:>9.3} {:>12} {:>9.1}   violation {:.1e}",
            format!("complex method, {seed}"),
            found.value,
            found.length,
            found.evaluations,
            begin.elapsed().as_secs_f64(),
            found.max_violation
        );
    }
}
