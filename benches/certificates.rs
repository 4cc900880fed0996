//! What stage 3 proves of all examples and of free loops of 4 to 20 vertices: `cargo bench --bench certificates`. With
//! arguments, only layouts whose names contain one of them; `-- --write DIR` leaves the free loops' texts as files.

#![allow(clippy::expect_used, clippy::unwrap_used)]

#[path = "common/families.rs"]
mod families;
#[path = "common/layout.rs"]
mod layout;

use layout::layout;
use lss::model::Layout;
use lss::solve::{Options, solve};
use std::path::Path;
use std::time::Instant;

/// Vertices that make a free loop, four and two for each of its steps.
const FREE: [usize; 7] = [4, 6, 8, 10, 12, 16, 20];

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    if let Some(folder) = arguments.iter().position(|a| a == "--write").and_then(|i| arguments.get(i + 1)) {
        std::fs::create_dir_all(folder).expect("a folder");
        for n in FREE {
            let path = Path::new(folder).join(format!("free_{n}.lss"));
            std::fs::write(path, families::staircase(n, false)).expect("written");
        }
        return;
    }
    let chosen: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let is_chosen = |name: &str| chosen.is_empty() || chosen.iter().any(|part| name.contains(part.as_str()));
    println!("layout               vertices  obstacles      value      bound    gap %     nodes  seconds");
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let mut files: Vec<_> = std::fs::read_dir(examples).expect("a folder").map(|f| f.expect("a file").path()).collect();
    files.sort();
    for file in files.iter().filter(|f| f.extension().is_some_and(|e| e == "lss")) {
        let name = file.file_stem().expect("a name").to_string_lossy();
        // That one has errors.
        if name != "errors" && is_chosen(&name) {
            row(&name, &layout(&std::fs::read_to_string(file).expect("text")));
        }
    }
    for n in FREE {
        for (drawn, words) in [(false, "free"), (true, "one direction")] {
            let name = format!("{words}, {n}");
            if is_chosen(&name) {
                row(&name, &layout(&families::staircase(n, drawn)));
            }
        }
    }
}

fn row(name: &str, layout: &Layout) {
    if layout.route.is_some() {
        return route(name, layout);
    }
    let clock = Instant::now();
    let stages = solve(layout, &Options::default(), &|_| {});
    let seconds = clock.elapsed().as_secs_f64();
    let Some(last) = stages.last() else { return };
    let Some(c) = &last.certificate else {
        println!(
            "{name:<20} {:>8}  {:>9}  {:?} {}",
            layout.vertices.len(),
            layout.obstacles.len(),
            last.status,
            last.name
        );
        return;
    };
    println!(
        "{name:<20} {:>8}  {:>9} {:>10.3} {:>10.3} {:>8.3} {:>9} {:>8.2}{}",
        layout.vertices.len(),
        layout.obstacles.len(),
        c.value,
        c.lower_bound,
        100.0 * c.gap,
        c.nodes,
        seconds,
        if c.proven { "  proven" } else { "" }
    );
}

/// What is proven of a route: of all loops through its sections.
fn route(name: &str, layout: &Layout) {
    let clock = Instant::now();
    let found = lss::route::find(layout, &Options::default(), &|_| {}).expect("a route");
    let summary = &found.summary;
    let (value, bound) = (summary.value, summary.shortest);
    println!(
        "{name:<20} {:>8}  {:>9} {value:>10.3} {bound:>10.3} {:>8.3} {:>9} {:>8.2}  a route",
        found.layout.vertices.len(),
        layout.obstacles.len(),
        100.0 * (value - bound) / value,
        "",
        clock.elapsed().as_secs_f64()
    );
}
