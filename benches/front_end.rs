//! The front end on a file of 10,000 lines: `cargo bench --bench front_end`.

#![allow(clippy::expect_used, clippy::unwrap_used)]

#[path = "common/large.rs"]
mod large;

use divan::{Bencher, black_box};
use large::large;
use lss::semantics::analyse;
use lss::source::{Loader, SourceMap};

fn main() {
    divan::main();
}

#[divan::bench]
fn parse(bencher: Bencher) {
    let text = large(4000, 99, 2600, 390);
    eprintln!("{} lines, {} bytes", text.lines().count(), text.len());
    bencher.bench_local(|| {
        let mut sources = SourceMap::default();
        lss::syntax::parse(sources.add("large.lss", text.as_str()), black_box(&text))
    });
}

#[divan::bench]
fn check(bencher: Bencher) {
    let text = large(4000, 99, 2600, 390);
    bencher.bench_local(|| {
        let mut sources = SourceMap::default();
        let (mut loader, main) = Loader::memory(&mut sources, &[("large.lss", text.as_bytes())]).expect("text");
        analyse(&mut sources, &mut loader, main, None).diagnostics.len()
    });
}
