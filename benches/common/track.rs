//! The simulation of a layout's file, for benches of the chain.

#[path = "layout.rs"]
mod layout;

use lss::chain_input::Simulation;
use lss::compiled::Compiled;
use lss::solve::{Options, solve};
use std::path::Path;

/// Of a file in the project's folder.
pub fn track(file: &str) -> Simulation {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    let layout = layout::layout(&std::fs::read_to_string(path).expect("a layout"));
    let stages = solve(&layout, &Options::default(), &|_| {});
    Simulation::new(&Compiled::new(layout, stages))
}
