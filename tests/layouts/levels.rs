//! Layouts with heights: they optimise, cross over themselves with headroom, and are ordered whole.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use lss::base::trig;
use lss::compiled::Compiled;
use lss::diagnostic::{Code, Diagnostic};
use lss::elements::{Part, pieces};
use lss::geometry::Track;
use lss::model::Layout;
use lss::semantics::analyse;
use lss::solve::{self, Effort, Options, Status, unsupported};
use lss::source::{Loader, SourceMap};

fn check(text: &str) -> (Option<Layout>, Vec<Diagnostic>) {
    let mut sources = SourceMap::default();
    let (mut loader, main) = Loader::memory(&mut sources, &[("l.lss", text.as_bytes())]).expect("text");
    let analysis = analyse(&mut sources, &mut loader, main, None);
    (analysis.chosen().ok().flatten().cloned(), analysis.diagnostics)
}

fn build(text: &str) -> Compiled {
    let (layout, said) = check(text);
    assert!(!said.iter().any(Diagnostic::is_error), "{said:#?}");
    let layout = layout.expect("a layout");
    assert!(unsupported(&layout).is_empty());
    let stages = solve::solve(&layout, &Options::default(), &|_| ());
    Compiled::new(layout, stages)
}

/// Every stage has met its rows, and every climb fits.
fn feasible(compiled: &Compiled) {
    for stage in &compiled.stages {
        assert_ne!(stage.status, Status::Infeasible, "{} {:?}", stage.name, stage.violations);
    }
    assert!(!compiled.heights.iter().any(Diagnostic::is_error), "{:#?}", compiled.heights);
}

fn layout(vertices: &[(&str, f64, f64, f64)], rest: &str) -> String {
    let vertices: String =
        vertices.iter().map(|(name, x, y, r)| format!("  vertex {name} ({x} m, {y} m) radius {r} m\n")).collect();
    format!(
        "use std.carts.tilt_tray\nuse std.tracks.standard\nlayout l {{\n  catalog standard\n  \
         cart tilt_tray(length: 500 mm)\n  speed 2 m/s\n  width 0.8 m\n{vertices}{rest}\n}}\n"
    )
}

/// Plan of a climb, from the equations of a vertical curve: 2R sin α and (h − 2R(1 − cos α)) / slope.
fn plan(rise: f64, radius: f64, slope: f64) -> f64 {
    let angle = trig::atan(slope);
    2.0 * radius * trig::sin(angle) + (rise - 2.0 * radius * (1.0 - trig::cos(angle))) / slope
}

const RECTANGLE: [(&str, f64, f64, f64); 4] =
    [("P1", 0.0, 0.0, 4.0), ("P2", 40.0, 0.0, 4.0), ("P3", 40.0, 20.0, 4.0), ("P4", 0.0, 20.0, 4.0)];

#[test]
fn climbs_keep_their_room() {
    let text = layout(
        &RECTANGLE,
        "  level P1..P2 1 m\n  level P3..P4 2 m\n  ramp P2..P3 from 0.5 m slope 0.14\n  optimise length",
    );
    let compiled = build(&text);
    feasible(&compiled);
    // The smallest curves of the catalogue; up at the ramp's slope behind `from`, down at the catalogue's steepest,
    // both with its smallest vertical radius. Opposite straights of a rectangle are alike.
    let longer = (0.5 + plan(1.0, 6.0, 0.14)).max(plan(1.0, 6.0, 0.2));
    let least = 6.0 * trig::PI + 2.0 * longer + 2.0 * 0.2;
    let last = compiled.stages.last().expect("a stage");
    assert!((last.length - least).abs() < 1e-3, "{} {least}", last.length);
    let rise = compiled.space.line.stretches.iter().map(|s| s.begin.position.z).fold(f64::NEG_INFINITY, f64::max);
    assert!((rise - 2.0).abs() < 1e-9, "{rise}");
    assert!(compiled.space.line.closure.0 < 1e-6);
}

#[test]
fn spirals_keep_their_run() {
    let text =
        std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/spiral.lss")).expect("an example");
    let compiled = build(&text.replace("optimise nothing", "optimise length"));
    feasible(&compiled);
    let written = Track::new(&compiled.layout.corners()).length;
    assert!(compiled.track.length < written - 1.0, "{} {written}", compiled.track.length);
    for stretch in &compiled.space.line.stretches {
        let steepest = if stretch.form.turn() == 0.0 { 0.2 } else { 0.14 };
        assert!(stretch.form.inclination().1.abs() <= trig::atan(steepest) + 1e-6, "{:?}", stretch.form);
    }
}

const EIGHT: [(&str, f64, f64, f64); 8] = [
    ("A", 0.0, 0.0, 4.0),
    ("B", 30.0, 20.0, 4.0),
    ("C", 42.0, 20.0, 4.0),
    ("D", 42.0, 0.0, 4.0),
    ("E", 30.0, 0.0, 4.0),
    ("F", 0.0, 20.0, 4.0),
    ("G", -12.0, 20.0, 4.0),
    ("H", -12.0, 0.0, 4.0),
];

#[test]
fn sections_cross_with_headroom() {
    let compiled = build(&layout(&EIGHT, "  level A..B 2.2 m\n  level E..F 1 m\n  optimise length"));
    feasible(&compiled);
    assert!(compiled.track.length < Track::new(&compiled.layout.corners()).length - 1.0);
    // Too low, and on one level, it is a mistake; what is asked is said.
    let (_, said) = check(&layout(&EIGHT, "  level A..B 1.9 m\n  level E..F 1 m\n  optimise length"));
    let crossing = said.iter().find(|d| d.code == Code::E0405).expect("a crossing");
    assert_eq!(crossing.expected.as_deref(), Some("the catalogue's headroom of 1 m"));
    let (_, said) = check(&layout(&EIGHT, "  optimise length"));
    assert!(said.iter().any(|d| d.code == Code::E0405));
}

#[test]
fn a_crossing_loop_has_no_side_of_an_obstacle() {
    let obstacle = "  obstacle o [(40 m, 30 m), (41 m, 30 m), (41 m, 31 m)]\n";
    let (layout, _) =
        check(&layout(&EIGHT, &format!("{obstacle}  level A..B 2.2 m\n  level E..F 1 m\n  optimise length")));
    let said = unsupported(&layout.expect("a layout"));
    assert_eq!(said.iter().map(|d| d.code).collect::<Vec<_>>(), [Code::E0650]);
}

#[test]
fn the_bill_is_as_long_as_the_track() {
    for name in ["levels", "spiral"] {
        let path = format!("{}/examples/{name}.lss", env!("CARGO_MANIFEST_DIR"));
        let compiled = build(&std::fs::read_to_string(path).expect("an example"));
        let list = pieces(&compiled.sequence, &compiled.space, &compiled.layout);
        let length: f64 = list.iter().map(|p| p.part.length()).sum();
        assert!((length - compiled.space.line.length).abs() < 1e-6, "{name}: {length}");
        let count = |kind: fn(&Part) -> bool| list.iter().filter(|p| kind(&p.part)).count();
        // Two climbs, a vertical curve at each end.
        assert_eq!(count(|w| matches!(w, Part::Vertical { .. })), 4, "{name}");
        let spirals = if name == "spiral" { 2 } else { 0 };
        assert_eq!(count(|w| matches!(w, Part::Spiral { .. })), spirals, "{name}");
        let ordered: usize = compiled.bill.lines.iter().map(|l| l.count).sum();
        assert_eq!(ordered, list.len(), "{name}");
    }
}

/// What a climb is made of is in the price, and the bound below it.
#[test]
fn climbs_cost() {
    let text = layout(
        &RECTANGLE,
        "  level P1..P2 1 m\n  level P3..P4 2 m\n  ramp P2..P3 from 0.5 m slope 0.1405\n  optimise cost",
    );
    let few = |text: &str| {
        let layout = check(text).0.expect("a layout");
        let effort = Effort { nodes: 100, ..Effort::default() };
        let stages = solve::solve(&layout, &Options { effort, ..Options::default() }, &|_| ());
        Compiled::new(layout, stages)
    };
    let compiled = few(&text);
    feasible(&compiled);
    let certificate = compiled.stages.last().and_then(|s| s.certificate.clone()).expect("a certificate");
    assert!((compiled.bill.price - certificate.value).abs() <= 0.005 * compiled.bill.count as f64 + 1e-3);
    assert!(certificate.lower_bound > 0.0 && certificate.lower_bound <= certificate.value);
    assert!(compiled.bill.lines.iter().any(|l| matches!(l.part, Part::Vertical { .. })));
    let shortest = few(&text.replace("optimise cost", "optimise length"));
    assert!(certificate.lower_bound <= shortest.bill.price);
}

/// A chain closes along the slopes, and not on their plan, which is shorter.
#[test]
fn a_chain_closes_along_the_slopes() {
    let text = include_str!("../../examples/spiral.lss");
    let text = text.replace("optimise nothing", "chain closes within 20 mm\n  optimise cost");
    let layout = check(&text).0.expect("a layout");
    let effort = Effort { nodes: 300, ..Effort::default() };
    let stages = solve::solve(&layout, &Options { effort, threads: 2, ..Options::default() }, &|_| ());
    let certificate = stages.last().and_then(|stage| stage.certificate.clone()).expect("a certificate");
    let compiled = Compiled::new(layout, stages);
    let fit = compiled.chain.expect("a chain");
    assert!(fit.left_over.abs() <= 0.020_01, "{fit:?}");
    assert!(compiled.length() > compiled.track.length + 0.1 && certificate.lower_bound <= certificate.value);
}
