//! Drawings of thesis10 and of the hub: `cargo bench --bench drawing`.

#![allow(clippy::expect_used, clippy::unwrap_used)]

#[path = "common/layout.rs"]
mod layout;

use divan::Bencher;
use layout::layout;
use lss::compiled::Compiled;
use lss::emit;
use lss::emit::svg;
use lss::solve::{Options, solve};

fn main() {
    divan::main();
}

const EXAMPLES: [&str; 2] = ["thesis10", "hub"];

fn compiled(name: &str) -> Compiled {
    let text = match name {
        "hub" => include_str!("../examples/hub.lss"),
        _ => include_str!("../examples/thesis10.lss"),
    };
    let layout = layout(text);
    let stages = solve(&layout, &Options::default(), &|_| {});
    Compiled::new(layout, stages)
}

#[divan::bench(args = EXAMPLES)]
fn drawing_svg(bencher: Bencher, name: &str) {
    let compiled = compiled(name);
    bencher.bench_local(|| svg::drawing(&compiled, svg::Theme::Adaptive).map(|s| s.len()));
}

#[divan::bench(args = EXAMPLES)]
fn drawing_dxf(bencher: Bencher, name: &str) {
    let compiled = compiled(name);
    bencher.bench_local(|| emit::dxf::drawing(&compiled).map(|text| text.len()));
}

#[divan::bench(args = EXAMPLES, sample_count = 10)]
fn all_drawings(bencher: Bencher, name: &str) {
    let compiled = compiled(name);
    bencher.bench_local(|| emit::drawing_files(&compiled).map(|f| f.len()));
}
