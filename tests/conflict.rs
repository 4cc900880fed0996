//! Layouts that cannot be, and constraints that follow from others: the lines that messages name, against what follows
//! from the numbers by hand.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use lss::diagnostic::{Code, Diagnostic, json};
use lss::model::Layout;
use lss::semantics::analyse;
use lss::solve::{self, Discretise, Options, Stage};
use lss::source::{Loader, SourceMap};

/// A layout of four vertices, by what is said about it.
fn hall(statements: &str) -> String {
    format!(
        "use std.carts.tilt_tray\nuse std.tracks.thesis\nlayout hall {{\n  catalog thesis\n  cart tilt_tray(length: 1250 mm)\n  \
         speed 2 m/s\n  width 1.2 m\n  vertex P1 (3 m, 3 m) radius 4 m\n  vertex P2 (57 m, 3 m) radius 4 m\n  \
         vertex P3 (57 m, 27 m) radius 4 m\n  vertex P4 (3 m, 27 m) radius 4 m\n{statements}\n  optimise length\n}}\n"
    )
}

fn check(text: &str) -> (SourceMap, Layout) {
    let mut sources = SourceMap::default();
    let (mut loader, main) = Loader::memory(&mut sources, &[("main.lss", text.as_bytes())]).expect("text");
    let analysis = analyse(&mut sources, &mut loader, main, None);
    assert!(!analysis.has_errors(), "{text}\n{:?}", analysis.diagnostics);
    let layout = analysis.chosen().expect("one layout").expect("no mistakes").clone();
    (sources, layout)
}

fn continuous(layout: &Layout) -> Vec<Stage> {
    let nothing: Discretise = |_, _, solution, _, _| solution.clone().into();
    let mut stages = solve::solve_with(layout, &Options::default(), nothing, &|_| {});
    stages.truncate(2);
    stages
}

/// Each line of a message with what is said about it.
fn lines<'s>(sources: &'s SourceMap, diagnostic: &Diagnostic) -> Vec<(&'s str, String)> {
    diagnostic.related.iter().map(|label| (sources.text(label.span), label.text.clone())).collect()
}

/// What is written, the lines that conflict with the words about each, and what is said of all.
type Told = (&'static str, &'static [(&'static str, &'static str)], &'static str);

/// Statements that contradict each other among others that do not, and how far each must give way alone.
const CONFLICTS: [Told; 5] = [
    // A section of 20 m along x over 15 m: turned by acos(15/20) it would end 13.229 m beside.
    (
        "  fix rotation P1..P2\n  require length(P1..P2) >= 20 m\n  require x(P2) - x(P1) <= 15 m \"the lift shaft\"\n  \
         require length(P3..P4) >= 10 m",
        &[
            ("fix rotation P1..P2", "13.229 m off its written place would do"),
            ("require length(P1..P2) >= 20 m", "5 m less would do"),
            ("require x(P2) - x(P1) <= 15 m \"the lift shaft\"", "5 m more would do"),
        ],
        "",
    ),
    // A gap of 1.3 m for a band of 1.2 m with 0.2 m and 0.3 m beside it.
    (
        "  obstacle rack [(20 m, 4.3 m), (30 m, 4.3 m), (30 m, 10 m), (20 m, 10 m)] clearance 0.2 m\n  \
         obstacle pit [(22 m, 1.4 m), (28 m, 1.4 m), (28 m, 3 m), (22 m, 3 m)] clearance 0.3 m\n  \
         obstacle far [(40 m, 10 m), (42 m, 10 m), (42 m, 12 m), (40 m, 12 m)]\n  pass rack left\n  pass pit right",
        &[
            (
                "obstacle rack [(20 m, 4.3 m), (30 m, 4.3 m), (30 m, 10 m), (20 m, 10 m)] clearance 0.2 m",
                "0.4 m closer would do",
            ),
            (
                "obstacle pit [(22 m, 1.4 m), (28 m, 1.4 m), (28 m, 3 m), (22 m, 3 m)] clearance 0.3 m",
                "0.4 m closer would do",
            ),
        ],
        "give way by 0.2 m each",
    ),
    // Four turns of at most 90° make a full one.
    (
        "  require angle(P1) <= 85 deg\n  require length(P1..P2) <= 30 m",
        &[("require angle(P1) <= 85 deg", "5° more would do")],
        "",
    ),
    // Fixed vertices 24 m apart, for 30 m. The loop is a rectangle, as four turns of at most 90° make it: P3 alone can only
    // go on, while P2 goes back and aside alike with the loop turning along: (24 + d)² + d² = 30².
    (
        "  fix all P1..P2\n  fix P3\n  require length(P2..P3) >= 30 m\n  require radius(P4) >= 6 m",
        &[
            ("fix all P1..P2", "5.493 m off its written place would do"),
            ("fix P3", "6 m off its written place would do"),
            ("require length(P2..P3) >= 30 m", "6 m less would do"),
        ],
        "",
    ),
    // Tangent lengths are radii where turns are 90°. What the layout narrows is a line; what the catalogue offers is not.
    (
        "  radii 3 m .. 5 m\n  require length(P1..P2) - length(straight(P1..P2)) >= 12 m\n  require radius(P3) <= 4 m",
        &[
            ("3 m .. 5 m", "radii 1 m beyond these limits would do"),
            ("require length(P1..P2) - length(straight(P1..P2)) >= 12 m", "2 m less would do"),
        ],
        "",
    ),
];

#[test]
fn conflicts_name_a_smallest_set_of_lines() {
    for (statements, expected, help) in CONFLICTS {
        let (sources, layout) = check(&hall(statements));
        let stages = continuous(&layout);
        let said = solve::diagnose(&layout, &stages);
        let [conflict] = &said[..] else { panic!("{statements}\n{said:?}") };
        assert_eq!(conflict.code, Code::E0601);
        let named = lines(&sources, conflict);
        assert_eq!(
            named.iter().map(|(line, _)| *line).collect::<Vec<_>>(),
            expected.iter().map(|e| e.0).collect::<Vec<_>>()
        );
        for ((line, label), (_, expected)) in named.iter().zip(expected) {
            assert!(label.contains(expected), "{line}: {label}, expected {expected}");
        }
        assert!(conflict.help.as_ref().is_some_and(|text| text.contains(help)), "{:?}", conflict.help);
        // For machines every line is among the related ones, the main one too.
        let document: serde_json::Value = serde_json::from_str(&json::line(&sources, conflict)).unwrap();
        assert_eq!(document["related"].as_array().map(Vec::len), Some(expected.len()));
        assert_eq!(conflict.label, *conflict.related.iter().find(|l| l.span == conflict.label.span).unwrap());
        every_line_is_needed(statements, &named);
    }
}

/// Each line of a set left out in turn, the others hold: solved by the stages, which know nothing of the search.
fn every_line_is_needed(statements: &str, named: &[(&str, String)]) {
    let is_named = |line: &str| named.iter().any(|(text, _)| line.contains(text));
    for (left_out, _) in named {
        let keeps = |line: &&str| !line.contains(left_out) && (is_named(line) || line.trim().starts_with("pass"));
        let obstacle = left_out.split(' ').nth(1).filter(|_| left_out.starts_with("obstacle"));
        let about = |line: &&str| obstacle.is_none_or(|name| !line.contains(&format!("pass {name}")));
        let rest: Vec<&str> = statements.lines().filter(keeps).filter(about).collect();
        let (_, layout) = check(&hall(&rest.join("\n")));
        let stages = continuous(&layout);
        assert!(solve::diagnose(&layout, &stages).is_empty(), "without {left_out}: {stages:?}");
    }
}

/// Constraints with the one that follows from the others, and those.
const IMPLIED: [(&str, &str, &[&str]); 4] = [
    ("  fix P1\n  fix P2\n  fix length P1..P2", "fix length P1..P2", &["fix P1", "fix P2"]),
    (
        "  require x(P1) >= 2 m\n  require x(P2) - x(P1) >= 20 m\n  require x(P2) >= 21 m",
        "require x(P2) >= 21 m",
        &["require x(P1) >= 2 m", "require x(P2) - x(P1) >= 20 m"],
    ),
    (
        "  fix P1\n  fix rotation P1..P2\n  require length(P2..P3) >= 20 m\n  require y(P2) == 3 m",
        "require y(P2) == 3 m",
        &["fix P1", "fix rotation P1..P2"],
    ),
    (
        "  fix P4\n  equal x(P4), x(P1)\n  require x(P1) <= 5 m",
        "require x(P1) <= 5 m",
        &["fix P4", "equal x(P4), x(P1)"],
    ),
];

#[test]
fn what_follows_from_other_lines_is_said() {
    for (statements, line, reasons) in IMPLIED {
        let (sources, layout) = check(&hall(statements));
        let said = solve::implied(&layout, &continuous(&layout));
        let [warning] = &said[..] else { panic!("{statements}\n{said:?}") };
        assert_eq!((warning.code, sources.text(warning.label.span)), (Code::W0705, line));
        let named: Vec<&str> = lines(&sources, warning).into_iter().map(|(line, _)| line).collect();
        assert_eq!(named, reasons);
    }
}

#[test]
fn what_rules_something_out_is_not_called_implied() {
    for statements in [
        "  fix P1\n  fix length P1..P2\n  fix rotation P1..P2",
        "  require x(P1) >= 2 m\n  require x(P2) - x(P1) >= 20 m\n  require x(P2) >= 23 m",
        "  fix rotation P1..P2\n  require length(P1..P2) >= 20 m\n  require length(P3..P4) >= 15 m",
        "  require radius(P1) + radius(P2) >= 12 m\n  require radius(P1) <= 6 m\n  require radius(P2) <= 7 m",
        "  require distance(P1, P3) >= 30 m\n  require length(P1..P2) >= 10 m\n  require length(P2..P3) >= 5 m",
        "  equal radius(P1), radius(P2)\n  equal radius(P2), radius(P3)\n  require length(P1..P2) >= 20 m\n  \
         require length(P2..P3) >= 15 m",
    ] {
        let (_, layout) = check(&hall(statements));
        let stages = continuous(&layout);
        assert!(solve::diagnose(&layout, &stages).is_empty(), "{statements}\n{stages:?}");
        let said = solve::implied(&layout, &stages);
        assert!(said.is_empty(), "{statements}\n{said:?}");
    }
}
