//! Input that means harm, or was mangled on the way: it ends in diagnostics, quickly, and never in a panic.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use lss::diagnostic::{Diagnostic, json, text};
use lss::semantics::{Analysis, analyse, unsupported};
use lss::source::{Loader, SourceMap};
use proptest::prelude::*;

/// Checks a text and shows everything that is said about it.
fn run(text: &str) -> Analysis {
    let mut sources = SourceMap::default();
    let (mut loader, main) = Loader::memory(&mut sources, &[("main.lss", text.as_bytes())]).expect("UTF-8");
    let analysis = analyse(&mut sources, &mut loader, main, None);
    for diagnostic in analysis.diagnostics.iter().take(200) {
        text::render(&sources, diagnostic, text::Style::Plain);
        json::line(&sources, diagnostic);
    }
    for layout in &analysis.layouts {
        unsupported(layout);
        lss::model::print(layout);
    }
    analysis
}

const SEEDS: [&str; 4] = [
    include_str!("../examples/thesis10.lss"),
    include_str!("../examples/errors.lss"),
    include_str!("../stdlib/tracks.lss"),
    include_str!("../stdlib/carts.lss"),
];

/// What a slip or an attack puts in place of a word.
const WORDS: [&str; 24] = [
    "0",
    "-1",
    "1e308 m",
    "1e999",
    "inf",
    "NaN",
    "P1",
    "P2..P3",
    "\"",
    "{",
    "}",
    "[",
    ")",
    "..",
    "from",
    "layout",
    "let a = a",
    "1000000",
    "0 m",
    "90 deg",
    "length(P1..P2)",
    "radius",
    "sqrt(-1)",
    "10 %",
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn mutated_layouts_never_panic(
        seed in 0..SEEDS.len(),
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0..4u8, 0..WORDS.len()), 1..6),
    ) {
        let mut words: Vec<String> = SEEDS[seed].split_inclusive([' ', '\n', ',', '(', ')']).map(str::to_string).collect();
        for (at, what, word) in edits {
            let at = at.index(words.len());
            match what {
                0 => words[at] = format!("{} ", WORDS[word]),
                1 => words[at].clear(),
                2 => words[at] = words[at].repeat(2),
                _ => {
                    let other = word * 31 % words.len();
                    words.swap(at, other);
                }
            }
        }
        run(&words.concat());
    }
}

/// A loop with that many vertices on a circle, and lines in it.
fn circle(vertices: usize, more: &str) -> String {
    let mut text = String::from(
        "use std.carts.tilt_tray\nuse std.tracks.standard\nlayout big {\n  catalog standard\n  cart tilt_tray\n  speed 2 m/s\n  width 1.2 m\n",
    );
    for i in 0..vertices {
        let angle = i as f64 / vertices as f64 * std::f64::consts::TAU;
        let (x, y) = (10_000.0 * libm::cos(angle), 10_000.0 * libm::sin(angle));
        text += &format!("  vertex P{i} ({x:.6} m, {y:.6} m) radius 3 m\n");
    }
    text + more + "}\n"
}

fn codes(diagnostics: &[Diagnostic]) -> Vec<&'static str> {
    let mut codes: Vec<&str> = diagnostics.iter().map(|d| d.code.as_str()).collect();
    codes.sort_unstable();
    codes.dedup();
    codes
}

#[test]
fn ten_thousand_vertices_are_one_message() {
    assert_eq!(codes(&run(&circle(10_000, "")).diagnostics), ["E0309"]);
}

#[test]
fn a_tangle_ends_after_some_crossings() {
    // Every long section crosses every other.
    let mut text = circle(0, "");
    text.truncate(text.len() - 2);
    for i in 0..1_000 {
        let y = f64::from(i) * 40.0;
        let x = if i % 2 == 0 { -9e4 + 50.0 * f64::from(i) } else { 9e4 - 50.0 * f64::from(i) };
        text += &format!("  vertex P{i} ({x} m, {} m) radius 3 m\n", if i % 3 == 0 { y } else { 4e4 - y });
    }
    let analysis = run(&(text + "}\n"));
    assert!(analysis.diagnostics.len() < 2_000 && analysis.has_errors());
}

#[test]
fn long_chains_of_definitions_do_not_exhaust_the_stack() {
    let forwards: String = (1..5_000).map(|i| format!("let a{i} = a{} + 1 m\n", i - 1)).collect();
    assert!(run(&format!("let a0 = 1 m\n{forwards}")).diagnostics.is_empty(), "in order, any number is fine");
    let backwards: String = (0..5_000).map(|i| format!("let a{i} = a{} + 1 m\n", i + 1)).collect();
    assert_eq!(codes(&run(&format!("{backwards}let a5000 = 1 m\n")).diagnostics), ["E0309"]);
    let extends: String = (0..5_000).map(|i| format!("cart c{i} from c{}\n", i + 1)).collect();
    run(&extends);
    let layouts: String = (0..5_000).map(|i| format!("layout l{i} from l{}\n", i + 1)).collect();
    run(&layouts);
}

#[test]
fn ten_thousand_unknown_names_end_quickly() {
    let lines: String = (0..8_000).map(|i| format!("  fix Q{i}xyz\n")).collect();
    let analysis = run(&circle(2_000, &lines));
    assert_eq!(analysis.diagnostics.iter().filter(|d| d.code.as_str() == "E0207").count(), 8_000);
}
