//! Stages of the optimisation, and the SQP beside Box's complex method: `cargo bench --bench solve`.

#![allow(clippy::expect_used, clippy::unwrap_used)]

#[path = "common/families.rs"]
mod families;
#[path = "common/layout.rs"]
mod layout;

use divan::Bencher;
use layout::layout;
use lss::model::Layout;
use lss::problem::{Problem, Scope, perturbed};
use lss::solve::{Options, Solver, solve, solve_with, sqp};
use std::time::Instant;

fn main() {
    beside_complex();
    rough_starts();
    by_size();
    proofs();
    divan::main();
}

fn thesis10() -> Layout {
    layout(include_str!("../examples/thesis10.lss"))
}

fn comb(n: usize, obstacles: usize) -> Layout {
    layout(&families::comb(n, obstacles))
}

/// One table: what both solvers reach on thesis10, stages 1 and 2.
fn beside_complex() {
    println!("solver   stage   length m   violation m  iterations or evaluations   seconds");
    for (name, solver) in [("sqp", Solver::Sqp), ("complex", Solver::Complex)] {
        let options = Options { solver, threads: 1, ..Options::default() };
        for s in solve_with(&thesis10(), &options, |_, _, s, _, _, _| s.clone().into(), &|_| {}).iter().take(2) {
            println!(
                "{name:<8} {} {:>10.5} {:>12.1e} {:>12} {:>22.4}",
                s.name, s.length, s.max_violation, s.iterations, s.seconds
            );
        }
    }
}

/// Median of each continuous stage of thesis10 over 20 rough starts, one run of the SQP each.
fn rough_starts() {
    let layout = thesis10();
    for (name, scope) in [("stage 1", Scope::Building), ("stage 2", Scope::Obstacles)] {
        let problem = Problem::new(&layout, scope);
        let run = |seed| {
            let start = perturbed(&layout, &problem, 1.5, seed);
            let clock = Instant::now();
            let solution = sqp::minimise(&problem, &start, &sqp::SqpSettings::default(), &|_, _, _| {});
            (clock.elapsed().as_secs_f64() * 1e3, solution.iterations)
        };
        let mut runs: Vec<(f64, usize)> = (1..=20).map(run).collect();
        runs.sort_by(|a, b| a.0.total_cmp(&b.0));
        println!(
            "{name}, 20 rough starts: median {:.1} ms, worst {:.1} ms, {} iterations",
            runs[10].0, runs[19].0, runs[10].1
        );
    }
}

/// How the continuous stages of combs of growing size end.
fn by_size() {
    for n in [12, 20, 52, 100] {
        for s in
            solve_with(&comb(n, 0), &Options::default(), |_, _, s, _, _, _| s.clone().into(), &|_| {}).iter().take(2)
        {
            println!("comb of {n:>3}: {} {:.4} m, {:?} after {} iterations", s.name, s.length, s.status, s.iterations);
        }
    }
}

/// How long stage 3 takes to prove thesis10, on one thread.
fn proofs() {
    println!("thesis10            length m     lower bound m   nodes   proof s   stage 3 s");
    let full = thesis10();
    let mut walls = full.clone();
    walls.obstacles.clear();
    let mut free = walls.clone();
    free.building = None;
    for (name, layout) in [("alone", free), ("building", walls), ("and obstacles", full)] {
        let stages = solve(&layout, &Options { threads: 1, ..Options::default() }, &|_| {});
        let Some(last) = stages.last() else { continue };
        let Some(c) = &last.certificate else { continue };
        println!(
            "{name:<16} {:>12.6} {:>15.6} {:>8} {:>9.3} {:>9.3}  {}",
            last.length,
            c.lower_bound,
            c.nodes,
            c.seconds,
            last.seconds,
            if c.proven { "proven" } else { "open" }
        );
    }
}

#[divan::bench(sample_count = 10)]
fn thesis10_all_stages(bencher: Bencher) {
    let layout = thesis10();
    bencher.bench_local(|| solve(&layout, &Options::default(), &|_| {}).len());
}

#[divan::bench(args = [12, 20, 52, 100, 200], sample_count = 3, sample_size = 1)]
fn stages_1_and_2_by_vertices(bencher: Bencher, n: usize) {
    let layout = comb(n, 0);
    bencher
        .bench_local(|| solve_with(&layout, &Options::default(), |_, _, s, _, _, _| s.clone().into(), &|_| {}).len());
}

#[divan::bench(args = [0, 10, 50], sample_count = 3, sample_size = 1)]
fn stages_1_and_2_by_obstacles(bencher: Bencher, obstacles: usize) {
    let layout = comb(52, obstacles);
    bencher
        .bench_local(|| solve_with(&layout, &Options::default(), |_, _, s, _, _, _| s.clone().into(), &|_| {}).len());
}
