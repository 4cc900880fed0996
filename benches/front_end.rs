//! The front end on a file of 10,000 lines: `cargo bench --bench front_end`.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use divan::{Bencher, black_box};
use lss::semantics::analyse;
use lss::source::{Loader, SourceMap};
use std::fmt::Write;

fn main() {
    divan::main();
}

/// 10,000 lines: values, comments, a loop of 400 vertices, obstacles and requirements.
fn large() -> String {
    let mut text = String::from("use std.carts.tilt_tray\nuse std.tracks.thesis\n");
    for i in 0..4000 {
        let _ = writeln!(text, "let aisle_{i} = {} * 1.2 m + {i} mm // between racks", i % 7 + 1);
    }
    text += "layout large {\n  catalog thesis\n  cart tilt_tray(length: 1250 mm)\n  speed 2 m/s\n  width 1.2 m\n";
    // A comb: every tooth is two vertices up and two down.
    let teeth = 99;
    for i in 0..teeth {
        let x = 40.0 * f64::from(i);
        for (k, (dx, y)) in [(0.0, 0.0), (12.0, 0.0), (12.0, 30.0), (28.0, 30.0)].into_iter().enumerate() {
            let _ = writeln!(text, "  vertex P{i}_{k} ({} m, {} m) radius 4 m", x + dx, 100.0 - y);
        }
    }
    let end = 40.0 * f64::from(teeth);
    let _ = writeln!(text, "  vertex E0 ({end} m, 100 m) radius 4 m\n  vertex E1 ({end} m, 200 m) radius 4 m");
    text += "  vertex E2 (-40 m, 200 m) radius 4 m\n  vertex E3 (-40 m, 112 m) radius 4 m\n";
    for i in 0..2600 {
        let _ = writeln!(text, "  // rack {i}");
        let x = 1.5 * f64::from(i);
        let _ = writeln!(
            text,
            "  obstacle rack_{i} [({x} m, 150 m), ({} m, 150 m), ({} m, 151 m), ({x} m, 151 m)]",
            x + 1.0,
            x + 1.0
        );
    }
    for i in 0..390 {
        let _ = writeln!(text, "  require radius(P{}_{}) <= 8 m \"row {i}\"", i / 4, i % 4);
    }
    text += "  optimise length\n}\n";
    text
}

#[divan::bench]
fn parse(bencher: Bencher) {
    let text = large();
    eprintln!("{} lines, {} bytes", text.lines().count(), text.len());
    bencher.bench_local(|| {
        let mut sources = SourceMap::default();
        lss::syntax::parse(sources.add("large.lss", text.as_str()), black_box(&text))
    });
}

#[divan::bench]
fn check(bencher: Bencher) {
    let text = large();
    bencher.bench_local(|| {
        let mut sources = SourceMap::default();
        let (mut loader, main) = Loader::memory(&mut sources, &[("large.lss", text.as_bytes())]).expect("text");
        analyse(&mut sources, &mut loader, main, None).diagnostics.len()
    });
}
