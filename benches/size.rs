//! How the continuous stages of layouts of growing size end, and what a whole build takes:
//! `cargo bench --bench size`, with `-- --grid` stage 3 too, with `-- --write DIR` their texts as files,
//! with `-- --nl DIR` their continuous problems for other solvers; `--only NAME` and `--largest N` choose among them.

#![allow(clippy::expect_used, clippy::unwrap_used)]

#[path = "common/families.rs"]
mod families;
#[path = "common/layout.rs"]
mod layout;

use families::{columns, comb, meander};
use lss::problem::measures::to_variables;
use lss::problem::nl::write;
use lss::problem::{Problem, Scope};
use lss::solve::{Options, Stage, Status, solve, solve_with};
use std::time::Instant;

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let after = |flag: &str| arguments.iter().position(|a| a == flag).and_then(|i| arguments.get(i + 1));
    let largest = after("--largest").map_or(200, |n| n.parse().expect("a number of vertices"));
    let only = after("--only").cloned().unwrap_or_default();
    let mut cases = Vec::new();
    for n in [20, 52, 100, 200].into_iter().filter(|&n| n <= largest) {
        cases.push((format!("comb_{n}"), comb(n, 0)));
        cases.push((format!("comb_{n}_50"), comb(n, 50)));
        cases.push((format!("columns_{n}_{}", n / 4), columns(n, n / 4)));
        for seed in 1..=2 {
            cases.push((format!("meander_{n}_{}_{seed}", n / 4), meander(n, n / 4, seed)));
        }
    }
    cases.retain(|(name, _)| name.contains(&only));
    if let Some(folder) = after("--write") {
        std::fs::create_dir_all(folder).expect("a folder");
        for (name, text) in &cases {
            std::fs::write(std::path::Path::new(folder).join(format!("{name}.lss")), text).expect("written");
        }
        return;
    }
    println!(
        "{:<20} {:<7} {:>12} {:>10} {:<12} {:>10} {:>9}",
        "layout", "stage", "length m", "off m", "status", "iterations", "seconds"
    );
    for (name, text) in cases {
        let layout = layout::layout(&text);
        let clock = Instant::now();
        let grid = arguments.iter().any(|a| a == "--grid");
        let stages = match grid {
            true => solve(&layout, &Options::default(), &|_| {}),
            false => solve_with(&layout, &Options::default(), |_, _, s, _, _, _| s.clone().into(), &|_| {}),
        };
        let seconds = clock.elapsed().as_secs_f64();
        if let Some(folder) = after("--nl") {
            for (stage, scope) in stages.iter().zip([Scope::Building, Scope::Obstacles]) {
                let problem = Problem::new(&layout, scope);
                let nl = write(&problem, &problem.start, &to_variables(&stage.corners));
                let path = std::path::Path::new(folder).join(format!("{name}_{}.nl", stage.name));
                std::fs::write(path, nl.model).expect("written");
            }
        }
        stages.iter().take(if grid { 3 } else { 2 }).for_each(|s| tell(&name, s));
        println!("{name:<20} all {:>67.3}", seconds);
    }
}

fn tell(name: &str, stage: &Stage) {
    let status = match stage.status {
        Status::Local => "optimal",
        Status::Feasible => "feasible",
        Status::Infeasible => "infeasible",
        Status::Proven => "proven",
        Status::BestFound => "best found",
        _ => "as written",
    };
    let (length, off) = (stage.length, stage.max_violation);
    println!(
        "{name:<20} {:<7} {length:>12.5} {off:>10.1e} {status:<12} {:>10} {:>9.3}",
        stage.name, stage.iterations, stage.seconds
    );
    if let Some(c) = &stage.certificate {
        println!("{name:<20} bound {:>14.5}, gap {:.4}, {} nodes, {:.2} s", c.lower_bound, c.gap, c.nodes, c.seconds);
    }
}
