//! Headings that lines hold off the catalogue's grid are told before anything is solved, with a way out that works.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use lss::diagnostic::{Code, Diagnostic};
use lss::semantics::analyse;
use lss::solve::{Effort, Options, Status, solve};
use lss::source::{Loader, SourceMap};

/// A loop of five with P3..P4 at 166.76° as written.
fn hall(statements: &str) -> String {
    format!(
        "use std.carts.tilt_tray\nuse std.tracks.standard\nlayout hall {{\n  catalog standard\n  \
         cart tilt_tray(length: 1250 mm)\n  speed 2 m/s\n  width 1.2 m\n  vertex P1 (3 m, 3 m) radius 3 m\n  \
         vertex P2 (37 m, 3 m) radius 3 m\n  vertex P3 (37 m, 17 m) radius 3 m\n  \
         vertex P4 (20 m, 21 m) radius 3 m\n  vertex P5 (3 m, 17 m) radius 3 m\n{statements}\n}}\n"
    )
}

/// Errors, each with the line that it points at.
fn errors(text: &str) -> Vec<(String, Diagnostic)> {
    let mut sources = SourceMap::default();
    let (mut loader, main) = Loader::memory(&mut sources, &[("hall.lss", text.as_bytes())]).expect("text");
    let analysis = analyse(&mut sources, &mut loader, main, None);
    let error = |d: &&Diagnostic| d.code.as_str().starts_with('E');
    analysis.diagnostics.iter().filter(error).map(|d| (sources.text(d.label.span).to_owned(), d.clone())).collect()
}

#[test]
fn a_heading_off_the_grid_is_told_at_its_line() {
    for (statements, line, related, expected) in [
        ("  fix all P1..P2\n  fix all P3..P4", "fix all P3..P4", "fix all P1..P2", "165 deg or 167.5 deg"),
        ("  fix rotation P1..P2\n  fix rotation P3..P4", "fix rotation P3..P4", "P1..P2", "165 deg or 167.5 deg"),
        ("  fix all P1..P2\n  fix rotation straight(P3..P4)", "fix rotation straight(P3..P4)", "P1..P2", "165 deg"),
        // Both ends of P3..P4 are fixed by two lines.
        ("  fix all P1..P2\n  fix P3\n  fix P4", "fix P4", "P1..P2", "165 deg or 167.5 deg"),
        (
            "  fix all P1..P2\n  require heading(P3..P4) == 166 deg",
            "require heading(P3..P4) == 166 deg",
            "P1..P2",
            "165 deg",
        ),
        // Most lines share a grid: the odd one is told, though it comes first.
        ("  fix rotation P3..P4\n  fix all P1..P2\n  fix rotation P2..P3", "fix rotation P3..P4", "P1..P2", "165 deg"),
    ] {
        let told = errors(&hall(&format!("{statements}\n  optimise length")));
        let [(at, diagnostic)] = &told[..] else { panic!("{statements}\n{told:?}") };
        assert_eq!((at.as_str(), diagnostic.code), (line, Code::E0502));
        assert!(diagnostic.expected.as_ref().unwrap().starts_with(expected), "{diagnostic:?}");
        assert!(
            related.split(' ').next_back().is_some_and(|r| format!("{diagnostic:?}").contains(r)),
            "{diagnostic:?}"
        );
    }
}

#[test]
fn turns_off_the_grid_are_told_at_their_line() {
    for (line, expected) in [
        ("require angle(P5) == 33 deg", "32.5 deg or 35 deg"),
        ("require angle(P1) + angle(P2) == 111 deg", "110 deg or 112.5 deg"),
        ("require heading(P3..P4) == heading(P1..P2) + 166 deg", "165 deg or 167.5 deg"),
    ] {
        let told = errors(&hall(&format!("  {line}\n  optimise length")));
        let [(at, diagnostic)] = &told[..] else { panic!("{line}\n{told:?}") };
        assert_eq!((at.as_str(), diagnostic.code), (line, Code::E0501));
        assert!(diagnostic.expected.as_ref().unwrap().starts_with(expected), "{diagnostic:?}");
    }
}

#[test]
fn what_the_grid_allows_is_not_told() {
    for statements in [
        // One heading is what the grid is counted from.
        "  fix all P3..P4\n  optimise length",
        "  fix all P1..P2\n  fix all P3..P4\n  optimise nothing",
        "  fix all P1..P2\n  fix rotation P2..P3\n  optimise length",
        "  fix all P1..P2\n  require heading(P3..P4) == 165 deg\n  require heading(P2..P3) == 450 deg\n  optimise length",
        "  fix all P3..P4\n  require heading(P1..P2) <= 1 deg\n  optimise length",
        "  require heading(P3..P4) == heading(P1..P2) + 165 deg\n  require angle(P5) == 75 deg\n  optimise length",
    ] {
        assert_eq!(errors(&hall(statements)), Vec::new(), "{statements}");
    }
}

/// The coordinates of the help, put into the source, give a layout that is solved on the grid.
#[test]
fn the_way_out_works() {
    let statements = "  fix all P1..P2\n  fix all P3..P4\n  optimise length";
    let help = errors(&hall(statements))[0].1.help.clone().unwrap();
    let places: Vec<&str> = help.split('`').filter(|part| part.starts_with('(')).collect();
    assert_eq!(places.len(), 2, "{help}");
    for place in places {
        let text = hall(statements).replace("(20 m, 21 m)", place);
        assert_eq!(errors(&text), Vec::new(), "{place}");
        let mut sources = SourceMap::default();
        let (mut loader, main) = Loader::memory(&mut sources, &[("hall.lss", text.as_bytes())]).expect("text");
        let analysis = analyse(&mut sources, &mut loader, main, None);
        let layout = analysis.chosen().expect("one layout").expect("no mistakes");
        let options = Options { effort: Effort { nodes: 50, ..Effort::default() }, ..Options::default() };
        let stages = solve(layout, &options, &|_| {});
        let last = stages.last().unwrap();
        assert!(last.name == "stage3" && last.status != Status::Infeasible, "{place}: {:?}", last.violations);
    }
}
