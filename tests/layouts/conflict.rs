//! Layouts that cannot be, and constraints that follow from others: the lines that messages name, against what follows
//! from the numbers by hand.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use lss::diagnostic::{Code, Diagnostic, json};
use lss::geometry::clearance::lateral_offset;
use lss::geometry::{Corner, Point, Track, self_crossings};
use lss::model::{Constraint, ConstraintKind, FixKind, Formula, Layout, Side, Unit};
use lss::problem::measures::to_corners;
use lss::problem::{Problem, Scope};
use lss::semantics::analyse;
use lss::solve::sqp::{self, SqpSettings};
use lss::solve::{self, Conflict, Cut, Discretise, LineKind, Member, Options, Proof, Stage, Within};
use lss::source::{Loader, SourceMap, Span};

/// A layout of four vertices, by what is said about it.
fn hall(statements: &str) -> String {
    format!(
        "use std.carts.tilt_tray\nuse std.tracks.thesis\nlayout hall {{\n  catalog thesis\n  \
         cart tilt_tray(length: 1250 mm)\n  \
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
    let nothing: Discretise = |_, _, solution, _, _, _| solution.clone().into();
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
        "  fix rotation P1..P2\n  require length(P1..P2) >= 20 m\n  \
         require x(P2) - x(P1) <= 15 m \"the lift shaft\"\n  require length(P3..P4) >= 10 m",
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
    // Fixed vertices 24 m apart, for 30 m. The loop is a rectangle, as four turns of at most 90° make it: P3 alone can
    // only go on, while P2 goes back and aside alike with the loop turning along: (24 + d)² + d² = 30².
    (
        "  fix all P1..P2\n  fix P3\n  require length(P2..P3) >= 30 m\n  require radius(P4) >= 6 m",
        &[
            ("fix all P1..P2", "5.493 m off its written place would do"),
            ("fix P3", "6 m off its written place would do"),
            ("require length(P2..P3) >= 30 m", "6 m less would do"),
        ],
        "",
    ),
    // Tangent lengths are radii where turns are 90°. What the layout narrows is a line; what the catalogue offers is
    // not.
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
        // For machines every line stands once: the main one is not among the related ones.
        let document: serde_json::Value = serde_json::from_str(&json::line(&sources, conflict)).unwrap();
        assert_eq!(document["related"].as_array().map(Vec::len), Some(expected.len() - 1));
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

/// The layout of README, with chutes that are longer than the hall.
fn readme(straight: &str, fixed: &str) -> String {
    format!(
        "use std.carts.tilt_tray\nuse std.tracks.standard\nlayout hall {{\n  catalog standard\n  \
         cart tilt_tray(length: 1250 mm)\n  \
         speed 2.0 m/s\n  width 1.2 m\n  vertex P1 (3 m, 3 m) radius 3 m\n  vertex P2 (37 m, 3 m) radius 3 m\n  \
         vertex P3 (37 m, 17 m) radius 3 m\n  vertex P4 (3 m, 17 m) radius 3 m\n  \
         building [(0 m, 0 m), (40 m, 0 m), (40 m, 20 m), (0 m, 20 m)]\n  \
         obstacle column [(19 m, 8 m), (21 m, 8 m), (21 m, 10 m), (19 m, 10 m)] clearance 0.5 m\n{fixed}  \
         require length(straight(P3..P4)) >= {straight}\n  optimise length\n}}\n"
    )
}

/// Chutes of 45 m and two curves do not fit in 40 m, and opposite sides of a loop of four right angles are equally
/// long: two conflicts, which have only the chutes in common.
#[test]
fn a_hall_too_short_for_its_chutes_is_named_with_them() {
    let (sources, layout) = check(&readme("45 m", "  fix all P1..P2\n"));
    let stages = continuous(&layout);
    let said = solve::diagnose(&layout, &stages);
    let named: Vec<Vec<(&str, String)>> = said.iter().map(|d| lines(&sources, d)).collect();
    let building = "building [(0 m, 0 m), (40 m, 0 m), (40 m, 20 m), (0 m, 20 m)]";
    let chutes = "require length(straight(P3..P4)) >= 45 m";
    let text = |i: usize| named[i].iter().map(|l| l.0).collect::<Vec<_>>();
    assert_eq!(text(0), [building, chutes], "{named:?}");
    assert_eq!(text(1), ["fix all P1..P2", chutes], "{named:?}");
    // Without the fixed section the chutes still do not fit in the hall, so no change of it alone is called enough.
    assert!(named[1][0].1.contains("for these lines alone"), "{named:?}");
    assert!(named[0][0].1.contains("for these lines alone"), "{named:?}");
    // 34 m between P1 and P2 less two curves of 3 m.
    let enough = "17 m less would do; on the catalogue's grid, too";
    assert!(named.iter().all(|lines| lines[1].1 == enough), "{named:?}");
    for diagnostic in &said {
        assert!(diagnostic.help.as_ref().is_some_and(|help| help.contains("proven")), "{diagnostic:?}");
    }
    let fixed = readme("28 m", "  fix all P1..P2\n");
    assert!(solve::diagnose(&check(&fixed).1, &continuous(&check(&fixed).1)).is_empty());
    for conflict in solve::conflicts(&layout, &stages) {
        holds_up(&layout, &conflict);
    }
}

/// Without the fixed section there is one conflict.
#[test]
fn walls_can_be_what_is_in_conflict() {
    let (sources, layout) = check(&readme("45 m", ""));
    let stages = continuous(&layout);
    let [conflict] = &solve::conflicts(&layout, &stages)[..] else { panic!("{stages:?}") };
    let named: Vec<&str> = conflict.members.iter().map(|m| sources.text(m.span).split(' ').next().unwrap()).collect();
    assert_eq!(named, ["building", "require"]);
    assert_eq!(conflict.proof, Proof::Bounds);
    assert!(conflict.members.iter().all(|m| m.within == Within::Layout));
    holds_up(&layout, conflict);
}

#[test]
fn the_side_of_an_obstacle_is_said() {
    let statements = "  obstacle rack [(20 m, 4.3 m), (30 m, 4.3 m), (30 m, 10 m), (20 m, 10 m)] clearance 0.2 m\n  \
                      obstacle pit [(22 m, 1.4 m), (28 m, 1.4 m), (28 m, 3 m), (22 m, 3 m)] clearance 0.3 m\n  \
                      pass pit right";
    let (sources, layout) = check(&hall(statements));
    let said = solve::diagnose(&layout, &continuous(&layout));
    let named = lines(&sources, &said[0]);
    assert!(
        named[0].1.starts_with("taken to lie to the left of travel, as the written vertices have it: "),
        "{named:?}"
    );
    assert!(named[1].1.starts_with("taken to lie to the right of travel, as `pass` says: "), "{named:?}");
    let help = said[0].help.clone().unwrap();
    let sides = [("rack", "right"), ("pit", "left")];
    for (name, other) in sides {
        let way =
            format!("`pass {name} {other}` takes `{name}` to lie on the other side, `pass {name} either` tries both");
        assert!(help.contains(&way), "{help}");
    }
    assert!(help.contains("amounts are enough, not proven to be the least"), "{help}");
    assert!(help.contains("that is no proof"), "{help}");
}

#[test]
fn both_sides_are_tried_where_either_will_do() {
    let low = "obstacle rack [(20 m, 1 m), (30 m, 1 m), (30 m, 10 m), (20 m, 10 m)] clearance 0.2 m";
    let walls = "building [(0 m, 0 m), (60 m, 0 m), (60 m, 30 m), (0 m, 30 m)]";
    for (side, words) in [
        ("left", "to the left of travel, as `pass` says: "),
        ("either", "and no layout was found with it on the other side: "),
    ] {
        let (_, layout) = check(&hall(&format!(
            "  {walls}\n  {low}\n  fix rotation P1..P2\n  require y(P1) <= 4 m\n  \
             require x(P1) <= 10 m\n  require x(P2) >= 40 m\n  pass rack {side}"
        )));
        let said = solve::diagnose(&layout, &continuous(&layout));
        let told: Vec<&String> = said.iter().flat_map(|d| &d.related).map(|l| &l.text).collect();
        assert!(told.iter().any(|text| text.contains(words)), "{side}: {told:?}");
    }
}

/// A range of headings without one on the grid.
#[test]
fn what_the_grid_forbids_is_proven_by_it() {
    let text = hall(
        "  vertex P5 (0 m, 15 m) radius 4 m\n  fix rotation P1..P2\n  require 88 deg <= heading(P2..P3) <= 89 deg\n  \
         require length(P3..P4) >= 10 m",
    )
    .replace("(57 m, 27 m)", "(58 m, 27 m)");
    let (sources, layout) = check(&text);
    let stages = solve::solve(&layout, &Options::default(), &|_| {});
    assert_eq!(stages.last().unwrap().name, "stage3", "{stages:?}");
    let [conflict] = &solve::conflicts(&layout, &stages)[..] else { panic!("{stages:?}") };
    let named: Vec<&str> = conflict.members.iter().map(|m| sources.text(m.span)).collect();
    assert_eq!(named, ["fix rotation P1..P2", "require 88 deg <= heading(P2..P3) <= 89 deg"]);
    assert_eq!((conflict.proof, conflict.on_grid), (Proof::Grid, true));
    assert!(conflict.members.iter().all(|m| m.relaxed.is_some() && m.within == Within::Layout), "{conflict:?}");
    holds_up(&layout, conflict);
    let said = solve::diagnose(&layout, &stages);
    assert!(said[0].message.starts_with("no layout on the catalogue's grid meets"), "{said:?}");
    // Where a limit of time ended the search, nothing is known to contradict, and looking for it would take longer yet.
    let mut cut = stages.clone();
    let last = cut.last_mut().unwrap();
    (last.cut, last.refuted) = (Some(Cut::Time), false);
    assert!(solve::conflicts(&layout, &cut).is_empty());
    let [said] = &solve::diagnose(&layout, &cut)[..] else { panic!("one message") };
    assert!(said.help.as_ref().is_some_and(|help| help.contains("limit of time")), "{said:?}");
}

/// Two curves of right angles leave no straight between them: tangent lengths are radii, of 4.4 m and 4 m at least, and
/// the grid has 5 m and 4 m.
#[test]
fn amounts_on_the_grid_are_said_apart() {
    let (_, layout) = check(&hall(
        "  require radius(P1) >= 4.4 m\n  require length(P1..P2) - length(straight(P1..P2)) <= 8 m\n  require radius(P2) >= 4 m",
    ));
    let [conflict] = &solve::conflicts(&layout, &continuous(&layout))[..] else { panic!("one conflict") };
    holds_up(&layout, conflict);
    let told: Vec<(&str, &str)> = conflict
        .members
        .iter()
        .map(|m| (m.relaxed.as_ref().unwrap().text.as_str(), m.on_grid.as_ref().unwrap().text.as_str()))
        .collect();
    assert_eq!(told, [("0.4 m", "0.4 m"), ("0.4 m", "1 m"), ("0.4 m", "1 m")]);
}

/// What is wrong with a layout by evaluations that share no code with the rows of a problem: the worst excess, m or
/// rad, over the lines that count, of which one may give way.
fn excess(layout: &Layout, corners: &[Corner], counts: &dyn Fn(Span) -> bool, gives: Option<(Span, f64)>) -> f64 {
    let track = Track::new(corners);
    let mut worst = if self_crossings(&track).is_empty() { 0.0f64 } else { 1.0 };
    let mut off = |by: f64, span: Option<Span>| {
        let give = gives.filter(|g| span == Some(g.0)).map_or(0.0, |g| g.1);
        if span.is_none_or(counts) {
            worst = worst.max(by - give);
        }
    };
    let curve = &layout.catalog.curve;
    let written = Track::new(&layout.corners());
    for (i, corner) in corners.iter().enumerate() {
        let turn = track.fillets[i].turn;
        off(if turn * written.fillets[i].turn > 0.0 { 0.0 } else { 1.0 }, None);
        off(turn.abs() - curve.turns.high, None);
        off(curve.turns.low - turn.abs(), None);
        off(turn.abs() - layout.turns.value.high, Some(layout.turns.span));
        off(layout.turns.value.low - turn.abs(), Some(layout.turns.span));
        off(corner.radius - layout.radii.value.high, Some(layout.radii.span));
        off(layout.radii.value.low - corner.radius, Some(layout.radii.span));
        off(layout.catalog.straight.shortest - straight(&track, i), None);
    }
    let points: Vec<Point> = (0..4000).map(|k| track.at(track.length * f64::from(k) / 4000.0).0).collect();
    if let Some(building) = &layout.building {
        for p in &points {
            // The distance from the nearest wall's line: buildings here are rectangles.
            let wall = |(a, b): (Point, Point)| Point::unit((b - a).heading()).cross(*p - a);
            let inside = building.polygon.edges().map(wall).fold(f64::INFINITY, f64::min);
            off(layout.width.value / 2.0 + building.clearance - inside, Some(building.span));
        }
    }
    for obstacle in &layout.obstacles {
        for p in &points {
            let outside =
                obstacle.polygon.distance_to_outline(*p) * if obstacle.polygon.contains(*p) { -1.0 } else { 1.0 };
            off(layout.width.value / 2.0 + obstacle.clearance - outside, Some(obstacle.span));
        }
        let left = obstacle.polygon.points().iter().filter_map(|&q| lateral_offset(&track, q)).sum::<f64>() > 0.0;
        off(if left == (obstacle.side == Side::Left) { 0.0 } else { 1e3 }, Some(obstacle.span));
    }
    for constraint in &layout.constraints {
        off(broken(constraint, layout, corners, &track), Some(constraint.span));
    }
    worst
}

/// m: between tangent points.
fn straight(track: &Track, i: usize) -> f64 {
    let (a, b) = (&track.fillets[i], &track.fillets[(i + 1) % track.fillets.len()]);
    let along = Point::unit((track.corners[(i + 1) % track.corners.len()].point - track.corners[i].point).heading());
    along.dot(b.begin - a.end)
}

fn broken(constraint: &Constraint, layout: &Layout, corners: &[Corner], track: &Track) -> f64 {
    let moved = |v: usize| {
        let (a, b) = (corners[v].point, layout.vertices[v].point);
        (a.x - b.x).abs().max((a.y - b.y).abs())
    };
    match &constraint.kind {
        ConstraintKind::FixVertex { vertex } => moved(*vertex),
        ConstraintKind::FixRadius { vertex } => (corners[*vertex].radius - layout.vertices[*vertex].radius.value).abs(),
        ConstraintKind::FixSection { target, kinds } => {
            let (i, j) = (target.from, (target.from + 1) % corners.len());
            let (a, b) = (layout.vertices[i].point, layout.vertices[j].point);
            if kinds.len() == 4 {
                return moved(i).max(moved(j));
            }
            let now = corners[j].point - corners[i].point;
            let along = Point::unit((b - a).heading());
            let one = |kind: &FixKind| match kind {
                FixKind::Length => (now.norm() - a.distance(b)).abs(),
                FixKind::Rotation if now.dot(along) < 0.0 => 1e3,
                FixKind::Rotation => along.cross(now).abs(),
                _ => panic!("not generated"),
            };
            kinds.iter().map(one).fold(0.0, f64::max)
        }
        ConstraintKind::Holds { .. } => panic!("not generated"),
        ConstraintKind::Require { formula, low, high, .. } => {
            let value = value(formula, corners, track);
            (low - value).max(value - high)
        }
    }
}

fn value(formula: &Formula, corners: &[Corner], track: &Track) -> f64 {
    let next = |i: usize| (i + 1) % corners.len();
    let of = |f: &Formula| value(f, corners, track);
    match formula {
        Formula::Constant(c) => *c,
        Formula::X(i) => corners[*i].point.x,
        Formula::Y(i) => corners[*i].point.y,
        Formula::Radius(i) => corners[*i].radius,
        Formula::Length(target) if target.straight => straight(track, target.from),
        Formula::Length(target) => corners[target.from].point.distance(corners[next(target.from)].point),
        Formula::Angle(i) => track.fillets[*i].turn,
        Formula::Heading(i) => track.straight(*i).heading,
        Formula::DistanceVertices(a, b) => corners[*a].point.distance(corners[*b].point),
        Formula::Sum(terms) => terms.iter().map(of).sum(),
        Formula::Product(terms) => terms.iter().map(of).product(),
        Formula::Negative(f) => -of(f),
        _ => panic!("not generated"),
    }
}

/// What is left of a violation that counts as none: rows hold to a millionth, and lengths of fixed sections are given
/// by rows that agree to second order only.
const MET: f64 = 5e-6;

/// Each statement of a conflict, checked by evaluations of their own; how many of them were made.
fn holds_up(layout: &Layout, conflict: &Conflict) -> usize {
    let named = |span: Span| conflict.members.iter().any(|m| m.span == span);
    let mut statements = 0;
    for member in &conflict.members {
        let others = |span: Span| member.within == Within::Layout || named(span);
        if let Some(corners) = &member.without {
            let left = excess(layout, corners, &|span| span != member.span && others(span), None);
            assert!(left <= MET, "without {member:?}: {left}");
            statements += 1;
        }
        for relaxed in member.relaxed.iter().chain(&member.on_grid) {
            let amount = stated(&relaxed.text, member, layout);
            assert!((relaxed.amount - amount).abs() <= 1e-9, "{} is not {}", relaxed.text, relaxed.amount);
            let left = excess(layout, &relaxed.corners, &others, Some((member.span, amount)));
            assert!(left <= MET, "{member:?} relaxed by {amount}: {left}");
        }
        statements += usize::from(member.relaxed.is_some());
        if let Some(relaxed) = &member.on_grid {
            on_grid(layout, &relaxed.corners);
            assert!(member.relaxed.as_ref().is_some_and(|any| any.amount <= relaxed.amount + 1e-3), "{member:?}");
        }
    }
    if let Some(together) = &conflict.together {
        let give = conflict.members.iter().map(|m| {
            let angle =
                constraint(layout, m).is_some_and(|c| matches!(c, ConstraintKind::Require { unit: Unit::Radian, .. }));
            let by = if angle || m.kind == LineKind::Turns { together.amount / 10.0 } else { together.amount };
            excess(layout, &together.corners, &|span| span == m.span, Some((m.span, by)))
        });
        assert!(give.fold(0.0, f64::max) <= MET, "{conflict:?}");
    }
    if conflict.on_grid {
        let layouts = |m: &Member| [m.without.clone(), m.relaxed.as_ref().map(|r| r.corners.clone())];
        conflict.members.iter().flat_map(layouts).flatten().for_each(|corners| on_grid(layout, &corners));
    } else {
        assert!(!solved_from_elsewhere(layout, &named), "a layout was found for {conflict:?}");
    }
    statements
}

/// Every turn a whole number of angle steps, every radius one of the catalogue's.
fn on_grid(layout: &Layout, corners: &[Corner]) {
    let curve = &layout.catalog.curve;
    for fillet in &Track::new(corners).fillets {
        let steps = fillet.turn / curve.angle_step;
        assert!((steps - steps.round()).abs() < 1e-5, "{corners:?}");
        assert!(curve.radii.iter().any(|r| (r - fillet.radius).abs() < 1e-6), "{corners:?}");
    }
}

fn constraint<'l>(layout: &'l Layout, member: &Member) -> Option<&'l ConstraintKind> {
    layout.constraints.iter().find(|c| c.span == member.span).map(|c| &c.kind)
}

/// The number that a message states, in m or rad.
fn stated(text: &str, member: &Member, layout: &Layout) -> f64 {
    let number = |unit: &str| text.strip_suffix(unit).and_then(|n| n.parse::<f64>().ok());
    let angle = |degrees: f64| degrees.to_radians();
    number("°")
        .map(angle)
        .or(number(" mm").map(|mm| mm / 1e3))
        .or(number(" m"))
        .or(number(" m²"))
        .or(number(""))
        .unwrap_or_else(|| panic!("{text} of {member:?} in {}", layout.name))
}

/// Whether the lines of a conflict, and no others, are met from one of several starts of this test's own.
fn solved_from_elsewhere(layout: &Layout, named: &dyn Fn(Span) -> bool) -> bool {
    let mut layout = layout.clone();
    layout.constraints.retain(|c| named(c.span));
    layout.building = layout.building.filter(|b| named(b.span));
    layout.obstacles.retain(|o| named(o.span));
    let problem = Problem::new(&layout, Scope::Obstacles);
    (101..107u32).any(|seed| {
        let start = lss::problem::perturbed(&layout, &problem, 2.0 + f64::from(seed % 3), u64::from(seed));
        let end = sqp::minimise(&problem, &start, &SqpSettings::default(), &|_, _, _| {});
        excess(&layout, &to_corners(&end.variables), &|_| true, None) <= MET
    })
}

/// A stream of numbers (Marsaglia's xorshift, 2003).
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, end: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) % end
    }

    /// A number of tenths from one to another.
    fn tenths(&mut self, from: u64, to: u64) -> f64 {
        (from + self.below(to - from)) as f64 / 10.0
    }
}

/// Statements that contradict each other.
fn contradiction(numbers: &mut Numbers) -> String {
    let by = numbers.tenths(1, 60);
    match numbers.below(8) {
        0 => format!("  fix P1\n  fix P2\n  require length(P1..P2) >= {} m\n", 54.0 + by),
        // Opposite sides of a loop of four right angles.
        1 => format!("  fix all P3..P4\n  require length(straight(P1..P2)) >= {} m\n", 48.0 + by),
        2 => {
            let walls = "building [(0 m, 0 m), (60 m, 0 m), (60 m, 30 m), (0 m, 30 m)]";
            format!("  {walls}\n  require length(straight(P3..P4)) >= {} m\n", 56.0 + by)
        }
        3 => format!(
            "  fix rotation P1..P2\n  require length(P1..P2) >= {} m\n  require x(P2) - x(P1) <= {} m\n",
            30.0 + by,
            29.0
        ),
        4 => format!("  require angle(P2) <= {} deg\n", 90.0 - by),
        5 => format!(
            "  require radius(P1) >= 5 m\n  require length(P4..P1) - length(straight(P4..P1)) <= {} m\n",
            7.9 - by / 10.0
        ),
        6 => {
            // The band needs 1.4 m between the wall and the rack.
            let low = 0.3 + by / 6.0;
            format!(
                "  building [(0 m, 0 m), (60 m, 0 m), (60 m, 30 m), (0 m, 30 m)]\n  \
                 obstacle rack [(20 m, {low} m), (30 m, {low} m), \
                 (30 m, 10 m), (20 m, 10 m)] clearance 0.2 m\n  pass rack left\n"
            )
        }
        _ => format!(
            "  radii 3 m .. 5 m\n  require length(P2..P3) - length(straight(P2..P3)) >= {} m\n",
            10.0 + by / 3.0
        ),
    }
}

/// Statements that are met without anything else.
fn harmless(numbers: &mut Numbers) -> &'static str {
    match numbers.below(4) {
        0 => "  require length(P2..P3) >= 12 m\n",
        1 => "  require radius(P4) >= 4 m\n",
        2 => "  obstacle far [(40 m, 10 m), (42 m, 10 m), (42 m, 12 m), (40 m, 12 m)]\n",
        _ => "  require distance(P1, P3) >= 20 m\n",
    }
}

/// Random contradictions, one or two of them: infeasible as they stand, feasible without any member and with any stated
/// relaxation.
#[test]
fn whatever_is_said_of_a_conflict_holds() {
    let mut numbers = Numbers(0x9E37_79B9_7F4A_7C15);
    let (mut said, mut asked, mut proven, mut conflicts) = (0, 0, 0, 0);
    for _ in 0..LAYOUTS {
        let mut statements = contradiction(&mut numbers) + harmless(&mut numbers);
        if numbers.below(3) == 0 {
            let second = contradiction(&mut numbers);
            let once = |word: &str| !(statements.contains(word) && second.contains(word));
            if once("building") && once("radii") && once("fix") {
                statements += &second;
            }
        }
        let (_, layout) = check(&hall(&statements));
        let stages = continuous(&layout);
        let found = solve::conflicts(&layout, &stages);
        assert!(!found.is_empty(), "{statements}\n{stages:?}");
        for conflict in &found {
            conflicts += 1;
            assert!(!conflict.members.is_empty(), "{statements}");
            said += holds_up(&layout, conflict);
            asked += 2 * conflict.members.len();
            proven += usize::from(conflict.proof == Proof::Bounds);
        }
    }
    // It would be easy to be right by saying nothing.
    assert!(10 * said >= 9 * asked, "{said} of {asked} statements");
    assert!(4 * proven >= conflicts, "{proven} of {conflicts} proven");
}

const LAYOUTS: usize = 20;
