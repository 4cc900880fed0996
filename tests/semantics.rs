//! The front end on whole files: what a layout becomes, and what every rule says.

use lss::diagnostic::{Code, text};
use lss::model::{self, Layout, Side};
use lss::semantics::{Analysis, analyse};
use lss::source::{Loader, SourceMap};

fn check(files: &[(&str, &str)]) -> (SourceMap, Analysis) {
    let mut sources = SourceMap::default();
    let bytes: Vec<(&str, &[u8])> = files.iter().map(|(name, text)| (*name, text.as_bytes())).collect();
    let (mut loader, main) = Loader::memory(&mut sources, &bytes).expect("the main file is text");
    let analysis = analyse(&mut sources, &mut loader, main, None);
    (sources, analysis)
}

fn report(sources: &SourceMap, analysis: &Analysis) -> String {
    analysis.diagnostics.iter().map(|d| text::render(sources, d, text::Style::Plain)).collect()
}

fn codes(analysis: &Analysis) -> Vec<&'static str> {
    analysis.diagnostics.iter().map(|d| d.code.as_str()).collect()
}

/// The only layout of a file without mistakes.
fn built(text: &str) -> Layout {
    let (sources, analysis) = check(&[("main.lss", text)]);
    assert!(!analysis.has_errors(), "{}", report(&sources, &analysis));
    analysis.chosen().expect("one layout").expect("a sound one").clone()
}

const HEAD: &str = "use std.carts.tilt_tray\nuse std.tracks.standard\n";

/// A sound layout with more statements in it.
fn with(statements: &str) -> String {
    format!(
        "{HEAD}layout test {{\n  catalog standard\n  cart tilt_tray\n  speed 2 m/s\n  width 1.2 m\n  vertex A (0 m, 0 m) radius 4 m\n  \
         vertex B (40 m, 0 m) radius 4 m\n  vertex C (40 m, 20 m) radius 4 m\n  vertex D (0 m, 20 m) radius 4 m\n{statements}\n}}\n"
    )
}

#[test]
fn thesis10_is_the_reference_instance() {
    let layout = built(include_str!("../examples/thesis10.lss"));
    assert_eq!(layout.vertices.len(), 10);
    assert_eq!(layout.constraints.len(), 3);
    let sides: Vec<Side> = layout.obstacles.iter().map(|o| o.side).collect();
    assert_eq!(sides, [Side::Left, Side::Left, Side::Right, Side::Right]);
    let track = lss::geometry::Track::new(&layout.corners());
    assert!((track.length - 213.9992334380341).abs() < 1e-9, "{}", track.length);
}

#[test]
fn sides_follow_the_written_layout() {
    let text = include_str!("../examples/thesis10.lss");
    let without: String = text.lines().filter(|l| !l.contains("pass ")).map(|l| format!("{l}\n")).collect();
    let sides: Vec<Side> = built(&without).obstacles.iter().map(|o| o.side).collect();
    assert_eq!(sides, [Side::Left, Side::Left, Side::Right, Side::Right]);
}
