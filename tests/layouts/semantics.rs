//! The front end on whole files: what a layout becomes, and what every rule says.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use lss::diagnostic::text;
use lss::model::{self, ConstraintKind, FailureOf, Layout, Side};
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
        "{HEAD}layout test {{\n  catalog standard\n  cart tilt_tray\n  speed 2 m/s\n  width 1.2 m\n  \
         vertex A (0 m, 0 m) radius 4 m\n  \
         vertex B (40 m, 0 m) radius 4 m\n  vertex C (40 m, 20 m) radius 4 m\n  vertex D (0 m, 20 m) radius 4 m\n\
         {statements}\n}}\n"
    )
}

#[test]
fn thesis10_is_the_reference_instance() {
    let layout = built(include_str!("../../examples/thesis10.lss"));
    assert_eq!(layout.vertices.len(), 10);
    assert_eq!(layout.constraints.len(), 3);
    let sides: Vec<Side> = layout.obstacles.iter().map(|o| o.side).collect();
    assert_eq!(sides, [Side::Left, Side::Left, Side::Right, Side::Right]);
    let track = lss::geometry::Track::new(&layout.corners());
    assert!((track.length - 213.9992334380341).abs() < 1e-9, "{}", track.length);
}

#[test]
fn sides_follow_the_written_layout() {
    let text = include_str!("../../examples/thesis10.lss");
    let without: String = text.lines().filter(|l| !l.contains("pass ")).map(|l| format!("{l}\n")).collect();
    let sides: Vec<Side> = built(&without).obstacles.iter().map(|o| o.side).collect();
    assert_eq!(sides, [Side::Left, Side::Left, Side::Right, Side::Right]);
}

#[test]
fn the_printed_model_is_the_same_model() {
    let everything = with(
        "  turns 10 deg .. 90 deg\n  radii 3 m .. 7 m\n  \
         building [(-5 m, -5 m), (-5 m, 30 m), (60 m, 30 m), (60 m, -5 m)] clearance 0.5 m\n  \
         obstacle pillar [(10 m, 8 m), (11 m, 8 m), (11 m, 9 m)] clearance 30 cm\n  pass pillar either\n  \
         fix all A..B\n  \
         fix rotation, length straight(B..C)\n  fix D\n  fix radius D\n  \
         require 12 m <= length(C..D) / 2 + 3 m \"chutes \\\"east\\\"\"\n  \
         require min(radius(A), 2 * radius(B)) - x(C) / 4 < abs(y(C) - 3 m)\n  require heading(A..B) == 0 deg\n  \
         require -angle(C) >= -80 deg\n  require sqrt(length(A..B) * (radius(A) + 1 m) + 2 m^2) <= 30 m\n  \
         require distance(C, pillar) >= 2 m\n  \
         require distance(A, C) / distance(C, building) <= 100\n  require 3 m <= radius(C) <= 6 m\n  \
         equal radius(A), radius(B), radius(C)\n  \
         mirror A, D about y = 10 m\n  level A..B 3 m\n  ramp B..C from 1 m slope 10 % radius 6 m\n  \
         start on A..B at 3 m\n  \
         photocell on A..B at 1 m\n  induction west on C..D at 6 m\n  \
         chutes row on C..D from 2 m every 1.25 m count 12\n  \
         motors on A..B from 2 m every 3 m count 4\n  motors on C..D from 1 m every 4 m count 2\n  \
         supports every 2.5 m\n  \
         sensor_cart at cart 7\n  chain tension 600 N\n  chain closes within 20 mm\n  \
         effect joint_clearance(gap: 0.05 mm)\n  optimise 0.7 * polygon_action + 0.3 * cost within length + 0.5 %",
    );
    for text in [include_str!("../../examples/thesis10.lss"), &everything] {
        let (sources, analysis) = check(&[("main.lss", text)]);
        assert!(!analysis.has_errors(), "{}", report(&sources, &analysis));
        let layout = analysis.chosen().unwrap().unwrap();
        let printed = model::print(layout);
        let (sources, again) = check(&[("main.lss", &printed)]);
        assert!(!again.has_errors(), "{printed}\n{}", report(&sources, &again));
        let again = again.chosen().unwrap().unwrap();
        assert_eq!(printed, model::print(again));
        let same = |layout: &Layout| without_places(serde_json::to_value(layout).unwrap());
        assert_eq!(same(layout), same(again));
    }
}

/// Drops spans, and where a side was decided.
fn without_places(value: serde_json::Value) -> serde_json::Value {
    use serde_json::Value;
    match value {
        Value::Object(map) => {
            let kept = map.into_iter().filter(|(key, _)| !matches!(key.as_str(), "span" | "point_span" | "pass"));
            Value::Object(kept.map(|(key, value)| (key, without_places(value))).collect())
        }
        Value::Array(items) => Value::Array(items.into_iter().map(without_places).collect()),
        other => other,
    }
}

#[test]
fn defaults_are_the_declared_ones() {
    let layout = built(&with(""));
    assert_eq!(layout.drive.motor.name, "linear_motor");
    assert_eq!((layout.drive.motor.length, layout.drive.motor.force), (1.0, 400.0));
    assert_eq!(layout.drive.controller.period, 0.01);
    assert_eq!((layout.sensor.lowpass, layout.sensor.rate, layout.sensor.trigger_length), (100.0, 500.0, 0.1));
    assert_eq!(layout.chain.tension, 500.0);
    assert_eq!(layout.cart.inertia, [1.6, 5.6, 6.4]);
    assert_eq!(layout.cart.centre_of_mass, [-0.4, 0.05]);
    assert_eq!((layout.cart.steering.contact.stiffness, layout.cart.running.contact.stiffness), (4.0e7, 5.0e7));
    assert_eq!((layout.cart.joint.axial.stiffness, layout.cart.joint.radial.stiffness), (4.0e6, 2.0e6));
    assert_eq!(layout.cart.running.gap, 0.002);
    assert_eq!(layout.cart.steering.gap, 0.0001);
    assert_eq!(layout.catalog.curve.radii, [3.0, 4.0, 5.0, 6.0, 7.0, 8.0]);
    assert_eq!(layout.objective.terms, [(1.0, model::Goal::Length)]);
    assert!(matches!(layout.equipment.motors, model::Motors::Evenly { count: 0 }));
}

#[test]
fn a_variant_changes_only_what_it_names() {
    let base = with("  induction west on A..B at 6 m\n  motors 8 evenly\n  fix length A..B");
    let text = format!(
        "{base}layout wide from test {{\n  speed 2.5 m/s\n  turns 5 deg .. 90 deg\n  \
         vertex C (40 m, 20 m) radius 5 m\n  induction west on A..B at 9 m\n  \
         motors on A..B from 1 m every 2 m count 3\n  fix radius A\n}}\nlayout wider from wide {{\n  width 1.4 m\n}}\n"
    );
    let (sources, analysis) = check(&[("main.lss", &text)]);
    assert!(analysis.diagnostics.is_empty(), "{}", report(&sources, &analysis));
    let [test, wide, wider] = &analysis.layouts[..] else { panic!("three layouts") };
    assert_eq!((test.speed.value, wide.speed.value, wider.speed.value), (2.0, 2.5, 2.5));
    let names: Vec<&str> = wide.vertices.iter().map(|v| v.name.as_str()).collect();
    assert_eq!(names, ["A", "B", "C", "D"], "a replaced vertex keeps its place");
    assert_eq!((test.vertices[2].radius.value, wide.vertices[2].radius.value), (4.0, 5.0));
    assert_eq!(wide.equipment.inductions.len(), 1);
    assert_eq!(wide.equipment.inductions[0].place.at, 9.0);
    assert!(matches!(&wide.equipment.motors, model::Motors::Rows(rows) if rows.len() == 1));
    assert_eq!((test.constraints.len(), wide.constraints.len()), (1, 2));
    assert_eq!((wide.width.value, wider.width.value), (1.2, 1.4));
    assert!(analysis.chosen().is_err(), "three layouts and no choice");
}

#[test]
fn parameters_and_lets() {
    let text = format!(
        "{HEAD}let aisle = 2 * 1.2 m\nlayout base(long: 40 m, reach: aisle * 5) {{\n  catalog standard\n  \
         cart tilt_tray(length: 750 mm)\n  \
         let half = reach / 2\n  speed 120 m/min\n  width 1200 mm\n  vertex A (0 m, 0 m) radius 4 m\n  \
         vertex B (long, 0 m) radius 4 m\n  \
         vertex C (long, reach) radius 4 m\n  vertex D (0 m, half + half)\n}}\nlayout other from base(long: 60 m)\n"
    );
    let (sources, analysis) = check(&[("main.lss", &text)]);
    assert!(analysis.diagnostics.is_empty(), "{}", report(&sources, &analysis));
    let [base, other] = &analysis.layouts[..] else { panic!("two layouts") };
    assert_eq!((base.vertices[1].point.x, other.vertices[1].point.x), (40.0, 60.0));
    assert_eq!(base.vertices[3].point.y, 12.0);
    assert_eq!(base.vertices[3].radius.value, 3.0, "the catalogue's smallest");
    assert_eq!((base.speed.value, base.cart.length), (2.0, 0.75));
}

/// One statement in a sound layout, and the codes that it must raise: each mistake one message.
const STATEMENTS: &[(&str, &[&str])] = &[
    ("turns 5 deg .. 95 deg", &["E0306"]),
    ("turns 5 m .. 90 deg", &["E0301"]),
    ("radii 3.2 m .. 3.8 m", &["E0306"]),
    ("fix radius E", &["E0207"]),
    ("fix length B..A", &["E0403"]),
    ("require radius(A) >= 9 m", &["E0501"]),
    ("require radius(A) >= 2 m", &["W0704"]),
    ("require angle(A) <= -5 deg", &["E0501"]),
    ("require length(A..B) >= 0 m", &["W0704"]),
    ("require 1 m >= 2 m", &["E0501"]),
    ("require length(A..B) >= 2", &["E0302"]),
    ("require length(A..B) >= 2 s", &["E0301"]),
    ("require length(A..B) + heading(A..B) >= 2 m", &["E0301"]),
    ("fix A\nrequire x(A) >= 1 m", &["E0501"]),
    ("fix all A..B\nrequire y(B) == 0 m", &["W0704"]),
    ("fix length A..B\nrequire length(A..B) == 41 m", &["E0501"]),
    ("fix A\nfix A", &["W0704"]),
    ("require x(A) >= 3 m\nrequire x(A) <= 2 m", &["E0502"]),
    ("require x(A) >= 3 m\nrequire x(A) >= 2 m", &["W0704"]),
    ("require x(A) >= 3 m\nrequire x(A) <= 9 m", &[]),
    ("equal radius(A), x(B)", &[]),
    ("equal radius(A), angle(B)", &["E0301"]),
    ("mirror A, A about x = 2 m", &["E0307"]),
    ("pass A left", &["E0208"]),
    ("obstacle o [(9 m, 8 m), (10 m, 8 m), (10 m, 9 m)]\npass o left\npass o right", &["E0502"]),
    ("obstacle o [(9 m, 8 m), (10 m, 8 m), (10 m, 9 m)]\npass o left\npass o left", &["W0704"]),
    ("obstacle o [(9 m, 8 m), (10 m, 8 m)]", &["E0406"]),
    ("obstacle o [(9 m, 8 m), (10 m, 8 m), (11 m, 8 m)]", &["E0406"]),
    ("obstacle o [(9 m, 8 m), (10 m, 8 m), (10 m, 9 m), (9 m, 8 m)]", &["E0406"]),
    ("obstacle o [(0 m, -1 m), (1 m, -1 m), (1 m, 1 m), (0 m, 1 m)]", &[]),
    ("building [(5 m, -5 m), (60 m, -5 m), (60 m, 30 m), (5 m, 30 m)]", &["E0407"]),
    // A wall across a straight: every tangent point lies inside.
    (
        "building [(-9 m, -9 m), (20 m, -9 m), (20 m, 2 m), (21 m, 2 m), (21 m, -9 m), (60 m, -9 m), (60 m, 30 m), (-9 \
         m, 30 m)]",
        &["E0407"],
    ),
    ("start on A..B at 33 m", &["E0409"]),
    ("start on A..B at -1 m", &["E0306"]),
    ("chutes row on A..B from 1 m every 1 m count 2.5", &["E0306"]),
    ("chutes row on A..B from 1 m every 1 m count 1000000", &["E0306"]),
    ("motors 3 evenly\nmotors on A..B from 1 m every 1 m count 2", &["E0213"]),
    ("sensor_cart at cart 0", &["E0306"]),
    ("supports every 0 m", &["E0306"]),
    ("chain tension 500 kg", &["E0301"]),
    ("optimise length + length", &["E0213"]),
    ("optimise nothing + length", &["E0304"]),
    ("optimise nothing\nrequire length(A..B) >= 50 m", &["E0501"]),
    ("optimise nothing\nrequire length(A..B) >= 30 m", &[]),
    ("let a = b\nlet b = a", &["E0216"]),
    ("let a = 2 m + 1 s + 3 kg", &["E0301", "E0301"]),
    ("let a = sqrt(2 m)\nlet b = a * a + 1 m", &[]),
    ("let a = sqrt(sqrt(2 m))", &["E0301"]),
    ("let a = sin(30 deg) + cos(1 rad)\nlet b = sin(2)", &["E0302"]),
    ("let a = max(2 m, 3 s)", &["E0301"]),
    ("let a = 1 / 0\nlet b = a + 1\nlet c = b * a", &["E0305"]),
    ("let a = 1e300 * 1e300", &["E0305"]),
    ("let a = sqrt(-1 m^2)", &["E0305"]),
    ("let a = length(A..B)", &["E0308"]),
    ("induction w on A..B at x(A)", &["E0308"]),
    ("let a = \"text\" + 1", &["E0304"]),
    ("cart cross_belt", &["E0213"]),
    ("level A..C 3 m", &[]),
];

#[test]
fn each_mistake_is_one_message() {
    let mut failures = String::new();
    for (statement, expected) in STATEMENTS {
        let (sources, analysis) = check(&[("main.lss", &with(statement))]);
        let mut found = codes(&analysis);
        found.sort();
        if &found != expected {
            failures += &format!("{statement}: {found:?}\n{}\n", report(&sources, &analysis));
        }
    }
    assert!(failures.is_empty(), "{failures}");
}

#[test]
fn independent_mistakes_are_all_reported() {
    let text = include_str!("../../examples/errors.lss");
    let (sources, analysis) = check(&[("examples/errors.lss", text)]);
    insta::assert_snapshot!(report(&sources, &analysis));
}

#[test]
fn a_line_that_does_not_parse_takes_nothing_else_along() {
    // The vertex, the cart's import and the obstacle are named in lines that did not parse.
    let text = with("  obstacle o [(9 m, 8 m), (10 m, 8 m), (10 m, 9 m]\n  pass o left\n  fix length A..B C");
    let text = text
        .replace("  vertex B (40 m, 0 m) radius 4 m", "  vertex B (40 m; 0 m) radius 4 m")
        .replace("cart tilt_tray", "cart tilt_tray)");
    let (sources, analysis) = check(&[("main.lss", &text)]);
    assert!(codes(&analysis).iter().all(|c| c.starts_with("E01")), "{}", report(&sources, &analysis));
}

#[test]
fn imports_bring_what_a_file_declares_and_nothing_it_imports() {
    let shared = ("lib/shared.lss", "use \"deep.lss\"\nlet aisle = deep_value * 2\n");
    let deep = ("lib/deep.lss", "let deep_value = 1.5 m\n");
    let (sources, analysis) = check(&[("main.lss", "use \"lib/shared.lss\"\nlet a = aisle + 1 m\n"), shared, deep]);
    assert!(analysis.diagnostics.is_empty(), "{}", report(&sources, &analysis));
    let (_, analysis) = check(&[("main.lss", "use \"lib/shared.lss\"\nlet a = aisle + deep_value\n"), shared, deep]);
    assert_eq!(codes(&analysis), ["E0206"]);
    // Twice the same through two files is no clash; two things of one name are.
    let (_, analysis) = check(&[
        ("main.lss", "use \"a.lss\"\nuse \"b.lss\"\nlet x = v\n"),
        ("a.lss", "let v = 1 m\n"),
        ("b.lss", "let v = 2 m\n"),
    ]);
    assert_eq!(codes(&analysis), ["E0212", "W0701"]);
}

#[test]
fn layouts_of_other_files_can_be_extended() {
    let base = with("");
    let files = [("main.lss", "use \"base.lss\"\nlayout b from test {\n  width 1 m\n}\n"), ("base.lss", base.as_str())];
    let (sources, analysis) = check(&files);
    assert!(analysis.diagnostics.is_empty(), "{}", report(&sources, &analysis));
    assert_eq!(analysis.chosen().unwrap().unwrap().width.value, 1.0);
}

#[test]
fn contact_stiffness_follows_its_exponent() {
    let wheel = |fields: &str| {
        let text =
            format!("use std.wheels.steering_polyurethane\nwheel w from steering_polyurethane {{\n{fields}\n}}\n");
        codes(&check(&[("main.lss", &text)]).1)
    };
    assert!(wheel("stiffness = 3e7 N/m^1.5").is_empty());
    assert_eq!(wheel("stiffness = 3e7 N/m"), ["E0301"]);
    assert!(wheel("exponent = 1\nstiffness = 3e7 N/m").is_empty());
    assert_eq!(wheel("exponent = 1"), ["E0301"], "the stiffness that it inherits no longer fits");
    assert_eq!(wheel("exponent = 1.3"), ["E0306"]);
}

#[test]
fn what_cannot_be_built_yet_is_said() {
    let said = |more: &str| -> Vec<String> {
        let layout = built(&with(&format!(
            "  obstacle o [(9 m, 8 m), (10 m, 8 m), (10 m, 9 m)]\n  pass o either\n  level A..B 3 m\n  ramp B..C\n  \
             chain closes within 5 mm\n  effect joint_clearance(gap: 0.05 mm)\n  optimise {more}"
        )));
        lss::solve::unsupported(&layout).into_iter().map(|d| d.message).collect()
    };
    for built in [
        "cost",
        "length",
        "cost within length + 1 %",
        "length within cost + 1 %",
        "2 * cost + length within cost + 1 %",
    ] {
        assert!(said(built).is_empty(), "{built}");
    }
    let of_itself = said("cost + polygon_action within polygon_action + 1 %");
    assert!(of_itself.iter().any(|m| m.starts_with("a goal within a budget of itself")), "{of_itself:?}");
    for smooth in [
        "polygon_action",
        "cost + polygon_action",
        "polygon_action within cost + 1 %",
        "cost within polygon_action + 1 %",
    ] {
        let said = said(smooth);
        assert!(said.len() == 1 && said[0].starts_with("polygon action on different heights"), "{smooth}: {said:?}");
    }
    assert!(lss::solve::unsupported(&built(include_str!("../../examples/thesis10.lss"))).is_empty());
}

#[test]
fn a_layout_says_what_its_drawing_shows() {
    use lss::model::Coordinate;
    let layout = built(&with(
        "  let bay = 6 m\n  axis \"1\" x = 0 m every bay count 3\n  axis \"H\" y = -2 m every 12 m count 2\n  axis \"N'\" y = 30 m\n  \
         drawing origin (-1 m, 2 m)\n  drawing revision \"B\"\n  drawing author \"A \\\"B\\\" C\"\n  drawing approved \"D\"",
    ));
    let axes: Vec<(&str, Coordinate, f64)> =
        layout.drawing.axes.iter().map(|axis| (axis.name.as_str(), axis.coordinate, axis.at)).collect();
    assert_eq!(
        axes,
        [
            ("1", Coordinate::X, 0.0),
            ("2", Coordinate::X, 6.0),
            ("3", Coordinate::X, 12.0),
            ("H", Coordinate::Y, -2.0),
            ("J", Coordinate::Y, 10.0),
            ("N'", Coordinate::Y, 30.0)
        ]
    );
    assert_eq!((layout.drawing.origin.x, layout.drawing.origin.y), (-1.0, 2.0));
    let title = &layout.drawing.title;
    assert_eq!((&*title.revision, &*title.author, &*title.approved, &*title.date), ("B", "A \"B\" C", "D", ""));
    // The printed model reads back as the same.
    let again = built(&model::print(&layout));
    assert_eq!(again.drawing.title, layout.drawing.title);
    assert_eq!(again.drawing.origin, layout.drawing.origin);
    let names = |layout: &Layout| layout.drawing.axes.iter().map(|a| (a.name.clone(), a.at)).collect::<Vec<_>>();
    assert_eq!(names(&again), names(&layout));
}

#[test]
fn a_variant_replaces_axes_and_fields_by_name() {
    let text = with("  axis \"1\" x = 0 m\n  axis \"2\" x = 6 m\n  drawing revision \"A\"\n  drawing author \"N\"")
        + "layout b from test {\n  axis \"2\" x = 7 m\n  drawing revision \"B\"\n}\n";
    let (sources, analysis) = check(&[("main.lss", &text)]);
    assert!(!analysis.has_errors(), "{}", report(&sources, &analysis));
    let b = &analysis.layouts[1].drawing;
    assert_eq!(b.axes.iter().map(|axis| axis.at).collect::<Vec<_>>(), [0.0, 7.0]);
    assert_eq!((&*b.title.revision, &*b.title.author), ("B", "N"));
}

#[test]
fn mistakes_in_axes_and_title_fields_are_told() {
    for (statements, code, words) in [
        ("axis \"1\" x = 0 m\n  axis \"1\" y = 4 m", "E0212", "the axis `1` is declared twice"),
        ("axis \"1\" x = 0 m every 6 m count 3\n  axis \"3\" x = 40 m", "E0212", "the axis `3` is declared twice"),
        ("axis \"north\" y = 0 m every 6 m count 2", "E0306", "no name follows `north`"),
        ("axis \"1\" x = 0 m every 0 m count 2", "E0306", "the distance between two axes"),
        ("axis \"1\" x = 0 s", "E0301", ""),
        ("axis \"1\" x = 0 m every 1 m count 501", "E0309", "there are too many axes"),
        ("axis 1 x = 0 m", "E0101", "a text in quotes"),
        ("drawing revision \" \"", "E0306", "the text is empty"),
        ("drawing revision \"A\"\n  drawing revision \"B\"", "E0213", "`drawing revision` is said twice"),
        ("drawing reviewer \"A\"", "E0101", "`approved`"),
        ("drawing origin 2 m", "E0101", "a point such as"),
    ] {
        let (sources, analysis) = check(&[("main.lss", &with(&format!("  {statements}")))]);
        let said = report(&sources, &analysis);
        assert_eq!(codes(&analysis).first(), Some(&code), "{statements}: {said}");
        assert!(said.contains(words), "{statements}: {said}");
    }
}

const SORTER: &str = "  induction west on A..B at 2 m\n  chutes row_a on A..B from 6 m every 1.25 m count 4\n  \
     chutes row_b on C..D from 6 m every 1.25 m count 2\n";

#[test]
fn waves_and_failures_are_what_is_written() {
    let said = "  feed west 600 per hour up to 900 per hour to row_a 2, row_b 25 %\n  fails west every 8 h for 10 min\n  fails row_b every 40 h for 15 min\n  \
         scanner on A..B at 4 m\n  fails scanners every 200 h for 1 h\n  storage row_a 40\n  \
         waves every 30 min changeover 90 s spread 40 %\n  wave big to row_a 3, row_b 60 %\n  wave small to row_b 1";
    let text = with(&format!("{SORTER}{said}"));
    let capacity = built(&text).capacity;
    assert_eq!((capacity.feeds[0].rate, &capacity.feeds[0].shares[..]), (Some(600.0), &[(0, 2.0), (1, 0.25)][..]));
    let failures: Vec<(FailureOf, f64, f64)> = capacity.failures.iter().map(|f| (f.of, f.every, f.duration)).collect();
    let said = [
        (FailureOf::Induction(0), 28_800.0, 600.0),
        (FailureOf::Chutes(1), 144_000.0, 900.0),
        (FailureOf::Scanners, 720_000.0, 3600.0),
    ];
    assert_eq!(failures, said);
    let waves = capacity.waves.unwrap();
    assert_eq!((waves.every, waves.changeover, waves.spread), (1800.0, 90.0, 0.4));
    let each: Vec<(&str, &[(usize, f64)])> =
        capacity.each_wave.iter().map(|w| (w.name.as_str(), w.shares.as_slice())).collect();
    assert_eq!(each, [("big", &[(0, 3.0), (1, 0.6)][..]), ("small", &[(1, 1.0)])]);
    assert_eq!(capacity.storages[0].every, None);
    // A variant says a wave, a failure and the waves again.
    let text = text
        + "layout other from test {\n  wave small to row_a 1\n  waves every 1 h\n  fails west every 1 h for 1 min\n}\n";
    let (_, analysis) = check(&[("main.lss", &text)]);
    let other = analysis.layouts.iter().find(|layout| layout.name == "other").unwrap().capacity.clone();
    assert_eq!(other.each_wave[1].shares, [(0, 1.0)]);
    assert_eq!((other.waves.unwrap().changeover, other.failures[0].every), (0.0, 3600.0));
    assert_eq!(other.failures.len(), 3);
}

#[test]
fn waves_and_failures_that_cannot_be_are_told() {
    for (statements, code, words) in [
        ("fails wets every 8 h for 10 min", "E0218", "there is no induction or row of chutes `wets`"),
        ("fails west every 8 for 10 min", "E0302", "the time between two failures needs a unit"),
        ("fails west every 0 s for 10 min", "E0306", "the time between two failures"),
        ("fails west every 8 h for 10 ms", "E0306", "the time of a repair"),
        ("fails west every 8 h", "E0101", "`for`"),
        ("fails west every 8 m for 10 min", "E0301", "a time"),
        ("fails west every 8 h for 1 min\n  fails west every 9 h for 1 min", "E0212", "failure of `west`"),
        ("waves every 30 s", "E0306", "the length of a wave"),
        ("waves every 30 min changeover 30 min", "E0306", "the time of a changeover"),
        ("waves every 30 min changeover 2", "E0302", "the time of a changeover needs a unit"),
        ("waves every 30 min spread 400 %", "E0306", "the spread of shares"),
        ("waves every 30 min\n  waves every 1 h", "E0213", "`waves` is said twice"),
        ("wave big to row_a 1", "E0214", "the wave `big` has no length"),
        ("storage row_a 40", "E0214", "nothing is ever taken from the chutes `row_a`"),
        ("waves every 1 h\n  wave big to row_c 1", "E0218", "there is no row of chutes `row_c`"),
        ("waves every 1 h\n  wave big to row_a 1, row_a 2", "E0212", "share of `row_a`"),
        ("waves every 1 h\n  wave big to row_a 0, row_b 0", "E0306", "go nowhere"),
        ("waves every 1 h\n  wave big to row_a -1", "E0306", "the share of a row"),
        ("waves every 1 h\n  wave big to row_a 1\n  wave big to row_b 1", "E0212", "wave `big`"),
        ("waves every 1 h\n  wave big to row_a", "E0101", "a share such as"),
        ("feed west 600 per hour to row_c 1", "E0218", "there is no row of chutes `row_c`"),
        ("feed west to row_a 1, row_a 2", "E0212", "share of `row_a`"),
        ("feed west to row_a 0", "E0306", "the items of an induction go nowhere"),
        ("feed west to row_a", "E0101", "a share such as"),
        (
            "waves every 1 h\n  wave big to row_b 1\n  feed west to row_a 1",
            "E0306",
            "items of the induction `west` go nowhere in the wave `big`",
        ),
        (
            "induction row_a on C..D at 2 m\n  fails row_a every 8 h for 1 min",
            "E0218",
            "is an induction and a row of chutes",
        ),
        ("fails scanners every 8 h for 1 min", "E0218", "there is no scanner"),
        (
            "scanner on A..B at 4 m\n  chutes scanners on C..D from 9 m every 1 m count 2\n  fails scanners every 8 h for 1 min",
            "E0218",
            "is a row of chutes and what all scanners are called",
        ),
        ("scanner on A..B at 4 m\n  fails scaners every 8 h for 1 min", "E0218", "did you mean `scanners`?"),
        ("fails scanner every 8 h for 1 min", "E0218", "did you mean `scanners`?"),
        ("require capacity >= 5000", "E0206", "`require capacity >= 7000 per hour`"),
        ("feed west 900 per hour up to 400 per hour", "W0714", "more items come to the induction `west` than it takes"),
    ] {
        let (sources, analysis) = check(&[("main.lss", &with(&format!("{SORTER}  {statements}")))]);
        let said = report(&sources, &analysis);
        assert_eq!(codes(&analysis), [code], "{statements}: {said}");
        assert!(said.contains(words), "{statements}: {said}");
    }
}

const FREE: &str = "  choose cart tilt_tray lengths 1100 mm .. 1250 mm\n  choose speed 1.5 m/s .. 2 m/s step 0.25 m/s\n  \
     choose motor linear_motor, strong on straights\n  choose radii [3 m, 4 m]\n  \
     choose take_up short, long\n  choose sensor short\n  \
     drive load 15 kg starts within 10 s stops within 3 s spare 1\n  \
     energy 0.36 EUR/kWh for 1000 h per year over 8 years";

/// The layout with its components left free, beside a motor of its own.
fn free(statements: &str) -> String {
    with(statements).replace(
        HEAD,
        &format!("{HEAD}use std.drives.linear_motor\nmotor strong from linear_motor {{\n  force = 900 N\n}}\n\
             take_up short {{\n  travel = 20 mm\n  force = 450 N\n}}\ntake_up long {{\n  travel = 60 mm\n  price = 5 EUR\n}}\n\
             sensor short {{\n  lowpass = 50 Hz\n  rate = 200 Hz\n  trigger_length = 0.1 m\n  range = 2 kN\n}}\n"
        ),
    )
}

#[test]
fn a_choice_has_every_length_of_a_family() {
    let layout = built(&free(FREE));
    let choice = &layout.choice;
    let carts: Vec<(f64, Option<f64>, &str)> =
        choice.carts.iter().map(|c| (c.item.length, c.item.article.price, c.written.as_str())).collect();
    // 420 EUR and 280 EUR a metre.
    assert_eq!(
        carts,
        [
            (1.1, Some(420.0 + 280.0 * 1.1), "tilt_tray(length: 1100 mm)"),
            (1.15, Some(420.0 + 280.0 * 1.15), "tilt_tray(length: 1150 mm)"),
            (1.2, Some(420.0 + 280.0 * 1.2), "tilt_tray(length: 1200 mm)"),
            (1.25, Some(770.0), "tilt_tray(length: 1250 mm)"),
        ]
    );
    assert_eq!(choice.speeds, [1.5, 1.75, 2.0]);
    assert_eq!(choice.radii, [3.0, 4.0]);
    assert!(choice.on_straights);
    let forces: Vec<(f64, &str)> = choice.motors.iter().map(|m| (m.item.force, m.written.as_str())).collect();
    assert_eq!(forces, [(400.0, "linear_motor"), (900.0, "strong")]);
    let take_ups: Vec<_> = choice.take_ups.iter().map(|t| (t.item.travel, t.item.force, t.written.as_str())).collect();
    assert_eq!(take_ups, [(0.02, Some(450.0), "short"), (0.06, None, "long")]);
    assert_eq!(choice.sensors[0].item.range, Some(2000.0));
    let drive = &choice.drive;
    let times = [&drive.starts, &drive.stops].map(|time| time.as_ref().map(|time| time.value));
    assert_eq!((drive.load, times, drive.spare), (15.0, [Some(10.0), Some(3.0)], 1));
    let energy = choice.energy.unwrap();
    assert!((energy.price - 1e-7).abs() < 1e-20 && energy.running == 3.6e6 && energy.years == 8.0);
    // A length that is given is one cart, and a variant replaces what it says again.
    let text = free(FREE) + "layout other from test {\n  choose cart tilt_tray(length: 600 mm)\n}\n";
    let (_, analysis) = check(&[("main.lss", &text)]);
    let other = analysis.layouts.iter().find(|layout| layout.name == "other").unwrap();
    let lengths: Vec<f64> = other.choice.carts.iter().map(|cart| cart.item.length).collect();
    assert_eq!((lengths, other.choice.speeds.len()), (vec![0.6], 3));
}

/// Its travel is what the chain may leave over, whatever the catalogue says.
#[test]
fn a_layout_names_its_take_up() {
    let own = built(&free("  take_up long"));
    assert_eq!((own.take_up_travel(), built(&free("")).take_up_travel()), (0.06, 0.02));
    assert_eq!(own.catalog.take_up, 0.02);
    let printed = model::print(&own);
    assert!(printed.contains("take_up long {\n  travel = 0.06 m\n  price = 5 EUR\n}"), "{printed}");
    assert_eq!(built(&printed).take_up_travel(), 0.06);
}

#[test]
fn a_printed_choice_reads_back() {
    let printed = model::print(&built(&free(FREE)));
    let again = built(&printed);
    assert_eq!(model::print(&again), printed);
    let (choice, other) = (&built(&free(FREE)).choice, &again.choice);
    let carts = |c: &model::Choice| c.carts.iter().map(|c| (c.item.length, c.item.mass)).collect::<Vec<_>>();
    assert_eq!(carts(other), carts(choice));
    assert_eq!((other.energy, other.drive.spare, &other.speeds), (choice.energy, choice.drive.spare, &choice.speeds));
}

#[test]
fn a_choice_is_checked() {
    for (statements, code) in [
        ("  choose cart nothing", "E0206"),
        ("  choose cart tilt_tray lengths 100 mm .. 200 mm", "E0310"),
        ("  choose cart tilt_tray lengths 2 m .. 1 m", "E0311"),
        ("  choose cart tilt_tray lengths 1 kg .. 2 m", "E0301"),
        ("  choose speed 2 m/s", "E0304"),
        ("  choose speed []", "E0306"),
        ("  choose speed [-1 m/s]", "E0306"),
        ("  choose radii [3.5 m]", "E0306"),
        ("  choose motor linear_motor\n  choose motor strong", "E0213"),
        ("  choose take_up long\n  choose take_up short", "E0213"),
        ("  choose sensor long", "E0206"),
        ("  choose take_up linear_motor", "E0206"),
        // It does not hold the chain's tension.
        ("  take_up short", "E0306"),
        ("  drive spare 1.5", "E0306"),
        ("  drive starts within 0 s", "E0306"),
        ("  energy 0.22 EUR for 6000 h per year over 10 years", "E0301"),
        ("  energy 0.22 EUR/kWh for 9000 h per year over 10 years", "E0306"),
    ] {
        let (sources, analysis) = check(&[("main.lss", &free(statements))]);
        let errors: Vec<&str> = codes(&analysis).into_iter().filter(|code| code.starts_with('E')).collect();
        assert_eq!(errors, [code], "{statements}: {}", report(&sources, &analysis));
    }
}

/// Two zones of equipment that stands freely, with more statements.
fn zones(statements: &str) -> String {
    let lines = "  start on A..B at 1 m\n  induction west of induction_45 at least 2 on A..B\n  \
         chutes row_a of chute at least 4 on A..B after west before east\n  induction east of induction_45 on C..D\n  \
         chutes row_b of chute at least 4 on straights after east\n  \
         chutes row_c of chute at least 4 on C..D after row_b\n";
    with(&format!("{lines}{statements}")).replace(HEAD, &format!("{HEAD}use std.equipment\n"))
}

/// The names that equipment comes after and before.
fn order(layout: &Layout, name: &str) -> (Vec<String>, Vec<String>) {
    let declared = layout.equipment.declared.iter().find(|declared| declared.name == name);
    let Some(model::Stands::Free { after, before, .. }) = declared.map(|declared| &declared.stands) else {
        panic!("`{name}` stands freely")
    };
    (after.clone(), before.clone())
}

#[test]
fn there_is_one_piece_for_each_zone() {
    let scan = "  scanner scan of scanner_portal on straights after the last induction of each zone";
    let layout = built(&zones(scan));
    // `row_c` is behind `row_b` in the same zone, and behind it in the loop: what comes first has nothing between.
    let names: Vec<&str> = layout.equipment.declared.iter().map(|d| d.name.as_str()).collect();
    assert_eq!(names, ["west", "row_a", "east", "row_b", "row_c", "scan_1", "scan_2"]);
    let list = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
    assert_eq!(order(&layout, "scan_1"), (list(&["west"]), list(&["row_a"])));
    assert_eq!(order(&layout, "scan_2"), (list(&["east"]), list(&["row_b"])));
    assert_eq!(built(&model::print(&layout)).equipment.declared.len(), 7);
    // Between what stands on one straight it stands there, too; `row_b` may be anywhere. The first one's straight has the
    // start within it.
    let on = |layout: &Layout, name: &str| {
        let declared = layout.equipment.declared.iter().find(|declared| declared.name == name).unwrap();
        let model::Stands::Free { on, .. } = &declared.stands else { panic!("`{name}` stands freely") };
        on.clone()
    };
    assert_eq!((on(&layout, "scan_1"), on(&layout, "scan_2")), (vec![], vec![]));
    let begins = built(&zones(scan).replace("start on A..B at 1 m", "start on A..B at 0 m"));
    assert_eq!((on(&begins, "scan_1"), on(&begins, "scan_2")), (vec![0], vec![]));

    // Places that the layout gives say the order, too, from its start on.
    let given = "  start on B..C at 1 m\n  induction west on C..D at 30 m\n  chutes row_a on C..D from 2 m every 1.25 m count 4\n  \
         induction east on B..C at 2 m\n  chutes row_b on A..B from 6 m every 1.25 m count 4\n";
    let text = with(&format!("{given}{scan}")).replace(HEAD, &format!("{HEAD}use std.equipment\n"));
    let layout = built(&text);
    assert_eq!(order(&layout, "scan_1"), (list(&["east"]), list(&["row_a"])));
    assert_eq!(order(&layout, "scan_2"), (list(&["west"]), list(&["row_b"])));

    // With one zone it keeps its name.
    let one = "  induction west on A..B at 2 m\n  chutes row_a of chute at least 4 on A..B after west\n";
    let text = with(&format!("{one}{scan} before row_a")).replace(HEAD, &format!("{HEAD}use std.equipment\n"));
    assert_eq!(order(&built(&text), "scan"), (list(&["west"]), list(&["row_a"])));
}

#[test]
fn zones_that_are_none_are_told() {
    let last = "after the last induction of each zone";
    for (statements, code, words) in [
        (format!("scanner s of scanner_portal anywhere {last}\n  gate s_1 of gate_walkway anywhere"), "E0212", "`s_1`"),
        (format!("chutes row_d of chute at least 4 anywhere {last}"), "E0502", "itself of a zone"),
        (format!("induction s of induction_45 anywhere {last}"), "E0502", "itself of a zone"),
        ("scanner s of scanner_portal anywhere after the last".to_owned(), "E0101", "`induction`"),
    ] {
        let (sources, analysis) = check(&[("main.lss", &zones(&format!("  {statements}")))]);
        let said = report(&sources, &analysis);
        assert_eq!(codes(&analysis), [code], "{statements}: {said}");
        assert!(said.contains(words), "{statements}: {said}");
    }
    // Beside a vertex with a mistake, places say nothing.
    let given = format!(
        "  start on C..D at 1 m\n  induction in_1 on A..B at 2 m\n  chutes row_a on B..C from 2 m every 1 m count 2\n  \
         scanner s of scanner_portal anywhere {last}"
    );
    let broken = with(&given).replace("(0 m, 0 m) radius 4 m", "(0 m, 0 m) radius 4 kg");
    let (_, analysis) = check(&[("main.lss", &broken.replace(HEAD, &format!("{HEAD}use std.equipment\n")))]);
    assert!(codes(&analysis).contains(&"E0301"), "{:?}", codes(&analysis));
    let text = with(&format!("  induction west on A..B at 2 m\n  scanner s of scanner_portal anywhere {last}"));
    let (_, analysis) = check(&[("main.lss", &text.replace(HEAD, &format!("{HEAD}use std.equipment\n")))]);
    assert_eq!(codes(&analysis), ["E0214"]);
}

#[test]
fn numbers_of_equipment_may_be_free() {
    let layout = built(&zones("  choose count west, east [2, 1]\n  choose count row_a 4 .. 12 step 4"));
    let [both, row] = &layout.choice.counts[..] else { panic!("two lines") };
    assert_eq!((&both.declared[..], &both.counts[..]), (&[0, 2][..], &[1, 2][..]));
    assert_eq!((&row.declared[..], &row.counts[..]), (&[1][..], &[4, 8, 12][..]));
    assert!(layout.choice.is_open());
    // What is built until then is what the lines say, and a number goes where it is or would be.
    assert_eq!(layout.equipment.declared[0].count(), 2);
    assert_eq!(both.places[0].line(3), "induction west of induction_45 at least 3 on A..B");
    assert_eq!(both.places[1].line(3), "induction east of induction_45 at least 3 on C..D");
    let printed = model::print(&layout);
    assert_eq!(model::print(&built(&printed)), printed);
    for (statements, code, words) in [
        ("choose count west [1, 2.5]", "E0306", "whole"),
        ("choose count west [0, 2]", "E0306", "at least 1"),
        ("choose count west [1 m]", "E0301", ""),
        ("choose count west 1 .. 3", "E0304", "a range with a step"),
        ("choose count wets [1, 2]", "E0218", "did you mean `west`?"),
        ("choose count west, west [1, 2]", "E0213", "`west`"),
        ("choose count west [1, 2]\n  choose count row_a, west [1, 2]", "E0213", "`west`"),
        ("choose count [1, 2]", "E0101", ""),
        ("chutes row_d on A..B from 30 m every 1 m count 3\n  choose count row_d [1, 2]", "E0218", "cannot be chosen"),
    ] {
        let (sources, analysis) = check(&[("main.lss", &zones(&format!("  {statements}")))]);
        let said = report(&sources, &analysis);
        assert_eq!(codes(&analysis), [code], "{statements}: {said}");
        assert!(said.contains(words), "{statements}: {said}");
    }
}

/// Ratios and areas have no metres, differences two sides, and what was worked out no digits of rounding.
#[test]
fn requirements_are_told_as_they_are_written() {
    for (written, told, unit, difference) in [
        ("length(P1..P2) / length(P2..P3) >= 0.2", "length(P1..P2) / length(P2..P3) >= 0.2", "", false),
        ("length(P1..P2) * length(P2..P3) >= 2 m * 3 m", "length(P1..P2) * length(P2..P3) >= 6 m^2", "m^2", false),
        ("distance(P1, P3) >= 3 * 1.2 m", "distance(P1, P3) >= 3.6 m", "m", false),
        ("radius(P1) == radius(P2)", "radius(P1) == radius(P2)", "m", true),
        ("10 m <= length(P2..P3) <= 40 m", "10 m <= length(P2..P3) <= 40 m", "m", false),
        ("angle(P2) == 90 deg", "angle(P2) == 90 deg", "rad", false),
    ] {
        let text = include_str!("../../examples/thesis10.lss")
            .replace("  optimise length", &format!("  require {written}\n  optimise length"));
        let layout = built(&text);
        let own = layout.constraints.iter().filter_map(|c| Some((c, model::required(c, &layout)?))).next_back();
        let (constraint, required) = own.expect("a requirement");
        assert_eq!((required.relation.as_str(), required.difference), (told, difference), "{written}");
        let ConstraintKind::Require { unit: own, .. } = &constraint.kind else { unreachable!() };
        assert_eq!(own.symbol(), unit, "{written}");
    }
}
