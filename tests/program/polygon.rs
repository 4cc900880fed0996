//! `lss polygon` and `optimise polygon_action` as users run them.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use assert_cmd::Command;
use serde_json::Value;
use std::fs;
use std::path::Path;

fn lss() -> Command {
    let mut command = Command::cargo_bin("lss").expect("the binary");
    command.current_dir(env!("CARGO_MANIFEST_DIR"));
    command
}

fn json(args: &[&str]) -> Value {
    let out = lss().args(args).args(["--format", "json"]).assert().success();
    serde_json::from_slice(&out.get_output().stdout).expect("one JSON object")
}

/// Σ of the squares that an objective counts, counted anew: the chain runs backwards from each start.
fn counted(matrix: &Value, passed: impl Fn(usize, usize) -> bool) -> f64 {
    let rows = matrix.as_array().expect("rows");
    let n = rows.len();
    let mut sum = 0.0;
    for (i, row) in rows.iter().enumerate() {
        for m in 1..=n {
            if passed(m, n) {
                let value = row[(i + n - m) % n].as_f64().expect("a number");
                sum += value * value;
            }
        }
    }
    sum
}

#[test]
fn the_objectives_are_sums_of_squares() {
    for (objective, passed) in
        [("all", (|_, _| true) as fn(usize, usize) -> bool), ("first_three", |m, _| m <= 3), ("last", |m, n| m == n)]
    {
        let found = json(&["polygon", "examples/reference.lss", "--objective", objective]);
        assert_eq!(found["objective"], objective);
        assert_eq!(found["delta_p_mm"].as_array().map(Vec::len), Some(10));
        let sum = counted(&found["delta_p_mm"], passed);
        assert!((found["value"].as_f64().expect("a value") / sum - 1.0).abs() < 1e-9);
    }
}

#[test]
fn a_simulation_input_says_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    lss().args(["build", "examples/levels.lss", "-o"]).arg(folder.path()).assert().success();
    let input = folder.path().join("simulation.json");
    let (a, b) = (json(&["polygon", "examples/levels.lss"]), json(&["polygon", &input.to_string_lossy()]));
    assert_eq!(a, b);
    assert!(a["delta_p_mm"].as_array().expect("rows").len() > 4);
}

#[test]
fn pictures_and_the_report_are_written() {
    let folder = tempfile::tempdir().expect("a folder");
    lss().args(["polygon", "examples/reference.lss", "-o"]).arg(folder.path()).assert().success();
    for file in ["polygon.html", "polygon.json", "polygon.svg", "polygon.png"] {
        assert!(fs::metadata(folder.path().join(file)).expect(file).len() > 1000, "{file}");
    }
    let report: Value =
        serde_json::from_slice(&fs::read(folder.path().join("polygon.json")).expect("a file")).expect("JSON");
    let shares: f64 = report["curves"].as_array().expect("curves").iter().filter_map(|c| c["share"].as_f64()).sum();
    assert!((shares - 1.0).abs() < 1e-6, "{shares}");
    assert!(report["notes"].as_array().is_some_and(|n| !n.is_empty()));
}

#[test]
fn shorter_carts_act_less() {
    let sweep = json(&["polygon", "examples/reference.lss", "--sweep", "cart.length"]);
    let points = sweep["points"].as_array().expect("points");
    let lengths: Vec<f64> = points.iter().filter_map(|p| p["cart_length_m"].as_f64()).collect();
    assert_eq!((lengths.len(), lengths[0], lengths[15]), (16, 0.5, 1.25));
    let value = |k: usize| points[k]["value"].as_f64().expect("a value");
    assert!(value(0) < 0.05 * value(15), "{} {}", value(0), value(15));
    assert_eq!(points[15]["carts"], 171);
}

/// Builds a layout with this objective.
fn build(folder: &Path, objective: &str) -> (Value, Value) {
    let file = folder.join("hall.lss");
    let text = format!(
        "use std.carts.tilt_tray\nuse std.tracks.standard\n\nlayout hall {{\n  catalog standard\n  \
         cart tilt_tray(length: 1250 mm)\n  speed 2.0 m/s\n  width 1.2 m\n\n  \
         vertex P1 (3 m, 3 m) radius 3 m\n  vertex P2 (37 m, 3 m) radius 4 m\n  vertex P3 (37 m, 17 m) radius 3 m\n  \
         vertex P4 (3 m, 17 m) radius 4 m\n\n  \
         building [(0 m, 0 m), (40 m, 0 m), (40 m, 20 m), (0 m, 20 m)]\n  \
         obstacle column [(19 m, 8 m), (21 m, 8 m), (21 m, 10 m), (19 m, 10 m)] clearance 0.5 m\n  \
         fix all P1..P2\n\n  {objective}\n}}\n"
    );
    fs::write(&file, text).expect("written");
    let out = folder.join("out");
    let built = lss().arg("build").arg(&file).arg("-o").arg(&out).args(["--format", "json"]).assert().success();
    let summary = serde_json::from_slice(&built.get_output().stdout).expect("JSON");
    for name in ["layout.json", "simulation.json", "bom.csv", "drawing.svg", "drawing.png", "drawing.dxf"] {
        assert!(out.join(name).is_file(), "{name}");
    }
    let simulation = serde_json::from_slice(&fs::read(out.join("simulation.json")).expect("a file")).expect("JSON");
    (summary, simulation)
}

#[test]
fn a_build_runs_more_evenly_within_its_limits() {
    let folder = tempfile::tempdir().expect("a folder");
    let (summary, simulation) =
        build(folder.path(), "chain closes within 20 mm\n  optimise polygon_action within length + 1 %");
    assert_eq!(summary["feasible"], true);
    let stages = summary["stages"].as_array().expect("stages");
    let length = |k: usize| stages[k]["length_m"].as_f64().expect("a length");
    let last = stages.len() - 1;
    assert_eq!(stages[last]["name"], "polygon");
    assert!(length(last) <= 1.01 * length(last - 1) + 1e-6);
    let left = simulation["chain"]["left_over_m"].as_f64().expect("a left-over");
    assert!(left.abs() <= 0.02 + 1e-6, "{left}");
    // Radii are as written, in driving order from the straight behind P1.
    let radii: Vec<f64> = simulation["track"]["elements"]
        .as_array()
        .expect("elements")
        .iter()
        .filter_map(|e| e["radius"].as_f64())
        .collect();
    assert_eq!(radii, [4.0, 3.0, 4.0, 3.0]);
    let value = |file: &str| json(&["polygon", &folder.path().join(file).to_string_lossy()])["value"].as_f64();
    let after = value("out/simulation.json");
    let (_, _) = build(folder.path(), "optimise nothing");
    assert!(after < value("out/simulation.json"), "{after:?}");
}

#[test]
fn what_cannot_be_is_said() {
    let out = lss().args(["polygon", "examples/errors.lss"]).assert().code(1);
    assert!(!out.get_output().stderr.is_empty());
    lss().args(["polygon", "nowhere.lss"]).assert().code(2);
    lss().args(["polygon", "tests/cases/reference/5-simulation.snap.json", "--verify"]).assert().code(2);
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("circle.json");
    let snap = fs::read_to_string("tests/cases/smallest/5-simulation.snap").expect("a snapshot");
    let mut input: Value = serde_json::from_str(snap.splitn(3, "---\n").nth(2).expect("a body")).expect("JSON");
    let radius = input["chain"]["track_length_m"].as_f64().expect("a length") / std::f64::consts::TAU;
    input["track"]["elements"] = serde_json::json!([{ "kind": "arc", "radius": radius, "turn_deg": 360.0 }]);
    fs::write(&file, input.to_string()).expect("written");
    let out = lss().arg("polygon").arg(&file).assert().code(1);
    let said = String::from_utf8_lossy(&out.get_output().stderr).into_owned();
    assert!(said.contains("the track has none"), "{said}");
}

/// Three layouts against the one before, in the dynamic model, with pictures.
#[test]
fn verification_runs_before_and_after() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    let found = json(&["polygon", "examples/smallest.lss", "--verify", "-o", &out.to_string_lossy()]);
    let cases = found["cases"].as_array().expect("cases");
    let names: Vec<&str> = cases.iter().filter_map(|c| c["name"].as_str()).collect();
    assert_eq!(names, ["before", "all", "first_three", "last"]);
    for case in cases {
        assert!(case["channels"]["joint_xi"]["passing_rms"].as_f64().is_some_and(|x| x > 0.0));
    }
    let all = |k: usize| cases[k]["polygon_action"]["all"].as_f64().expect("a value");
    assert!(all(1) <= all(0), "{} {}", all(1), all(0));
    let page = fs::read_to_string(out.join("verify.html")).expect("a page");
    let written = page.split("<noscript").next().unwrap_or_default();
    assert!(page.starts_with("<!DOCTYPE html>") && !written.contains("NaN") && !written.contains("http:"));
    // Of each of three channels a spectrum and a trace, with a curve of each case.
    assert_eq!(page.matches("\"name\":\"first_three\"").count(), 6);
    for file in ["verify.json", "verify.svg", "verify.png"] {
        assert!(out.join(file).is_file(), "{file}");
    }
}
