//! The two tracks of the chain model, and a third with a spiral: what the compiler writes is what they are.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use lss::chain_input::{CentreLinePiece, Simulation, Track};
use lss::compiled::Compiled;
use lss::semantics::analyse;
use lss::solve::{self, Options};
use lss::source::{Loader, SourceMap};
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_owned()
}

fn compile(text: &str) -> Compiled {
    let mut sources = SourceMap::default();
    let (mut loader, main) = Loader::memory(&mut sources, &[("track.lss", text.as_bytes())]).expect("text");
    let analysis = analyse(&mut sources, &mut loader, main, None);
    assert!(!analysis.has_errors(), "{:?}", analysis.diagnostics);
    let layout = analysis.chosen().expect("one layout").expect("no mistakes").clone();
    let stages = solve::solve(&layout, &Options::default(), &|_| {});
    Compiled::new(layout, stages)
}

fn example(name: &str) -> Compiled {
    compile(&std::fs::read_to_string(root().join("examples").join(format!("{name}.lss"))).expect("an example"))
}

fn fixture(name: &str) -> Track {
    let path = root().join("tests/fixtures/tracks").join(format!("{name}.json"));
    serde_json::from_slice(&std::fs::read(path).expect("a fixture")).expect("a track")
}

/// A piece's kind and its numbers.
fn numbers(piece: &CentreLinePiece) -> (&'static str, [f64; 3]) {
    match *piece {
        CentreLinePiece::Straight { length, slope } => ("straight", [length, slope, 0.0]),
        CentreLinePiece::Arc { radius, turn_deg } => ("arc", [radius, turn_deg, 0.0]),
        CentreLinePiece::Vertical { radius, slope_from, slope_to } => ("vertical", [radius, slope_from, slope_to]),
        CentreLinePiece::Spiral { radius, turn_deg, rise } => ("spiral", [radius, turn_deg, rise]),
    }
}

#[test]
fn the_examples_are_the_tracks_of_the_chain_model() {
    for (name, carts, length) in [("reference", 171, 214.0), ("levels", 120, 150.450_687_717)] {
        let (got, expected) = (Simulation::new(&example(name)), fixture(name));
        for (a, b) in got.track.start.iter().zip(expected.start) {
            assert!((a - b).abs() < 1e-9, "{name}: {:?}", got.track.start);
        }
        assert_eq!(got.track.elements.len(), expected.elements.len(), "{name}");
        for (a, b) in got.track.elements.iter().zip(&expected.elements) {
            let ((kind, x), (same, y)) = (numbers(a), numbers(b));
            assert_eq!(kind, same, "{name}");
            assert!(x.iter().zip(y).all(|(x, y)| (x - y).abs() < 1e-9), "{name}: {a:?} {b:?}");
        }
        assert_eq!(got.chain.carts, carts, "{name}");
        assert!((got.chain.track_length_m - length).abs() < 1e-9, "{name}");
    }
}

#[test]
fn every_example_closes_in_space() {
    for name in ["reference", "levels", "spiral"] {
        let (gap, angle) = Simulation::new(&example(name)).track.centre_line().closure;
        assert!(gap < 1e-9 && angle < 1e-9, "{name}: {gap} {angle}");
    }
}

#[test]
fn a_spiral_turns_and_climbs_at_one_slope() {
    let track = Simulation::new(&example("spiral")).track;
    let spirals: Vec<[f64; 3]> = track.elements.iter().map(numbers).filter(|p| p.0 == "spiral").map(|p| p.1).collect();
    assert_eq!(spirals.len(), 1);
    let [radius, turn, rise] = spirals[0];
    let slopes: Vec<f64> = track.elements.iter().map(numbers).filter(|p| p.0 == "straight").map(|p| p.1[1]).collect();
    let slope = rise / (radius * turn.to_radians());
    assert!(slopes.iter().filter(|s| (*s - slope).abs() < 1e-9).count() == 2, "{slope} {slopes:?}");
}

/// Equipment stands on the centre line in space.
#[test]
fn stations_have_the_heights_of_their_level() {
    let compiled = example("levels");
    let line = Simulation::new(&compiled).track.centre_line();
    for motor in compiled.motors() {
        let at = line.at(motor.s).position;
        assert!((at.x - motor.point.x).abs() < 1e-9 && (at.z - motor.z).abs() < 1e-9, "{motor:?} {at}");
    }
    let photocell = compiled.station(compiled.layout.equipment.photocell.expect("one"));
    assert!((photocell.z - 2.6).abs() < 1e-9);
}

#[test]
fn elements_of_raised_tracks_stand_where_their_arc_length_says() {
    for name in ["levels", "spiral"] {
        let compiled = example(name);
        for element in lss::emit::layout::LayoutFile::new(&compiled).elements {
            let at = compiled.station_at(element.s_m).point;
            let apart = at.distance(lss::geometry::Point::new(element.begin_m[0], element.begin_m[1]));
            assert!(apart < 1e-6, "{name}: {} at {} m is {apart} m off", element.article, element.s_m);
        }
    }
}

fn said(heights: &str) -> Vec<String> {
    let text = format!(
        "use std.carts.tilt_tray\nuse std.tracks.standard\nlayout l {{\n  catalog standard\n  cart tilt_tray\n  \
         speed 2 m/s\n  \
         width 1.2 m\n  vertex P1 (0 m, 0 m) radius 4 m\n  vertex P2 (40 m, 0 m) radius 4 m\n  \
         vertex P3 (40 m, 20 m) radius 4 m\n  vertex P4 (0 m, 20 m) radius 4 m\n{heights}\n  optimise nothing\n}}\n"
    )
    .replace("tilt_tray\n  speed", "tilt_tray(length: 1250 mm)\n  speed");
    compile(&text).heights.iter().map(|d| format!("{:?} {}", d.code, d.message)).collect()
}

#[test]
fn what_cannot_be_climbed_is_said() {
    let cases = [
        ("level P1..P2 1 m\nlevel P3..P1 2 m\nramp P2..P3 slope 0.3 radius 6 m", "steeper than the catalogue's 0.2"),
        ("level P1..P2 1 m\nlevel P3..P1 4 m\nramp P2..P3 slope 0.1 radius 6 m", "does not fit on its straight"),
        ("level P1..P3 1 m\nlevel P3..P1 2 m", "no section to climb on"),
        ("level P1..P3 1 m\nlevel P2..P1 2 m", "P2..P3 has two heights"),
        ("level P1..P1 1 m\nramp P2..P3", "from a height to the same one"),
        ("level P1..P2 1 m\nramp P2..P3\nlevel P3..P4 2 m\nramp P4..P2", "reaches into a section that has a level"),
    ];
    for (heights, expected) in cases {
        let said = said(heights);
        assert!(said.iter().any(|m| m.contains(expected)), "{heights}: {said:?}");
    }
}

/// Without a word on how, a climb takes the steepest slope and the largest radius that fit, in the middle of the
/// straight.
#[test]
fn a_climb_has_defaults() {
    assert!(said("level P1..P2 1 m\nlevel P3..P4 2 m").iter().all(|m| m.starts_with("W0711")));
    assert_eq!(said("level P1..P1 1 m"), Vec::<String>::new());
}
