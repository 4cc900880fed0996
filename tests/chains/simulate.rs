//! `lss simulate` as users run it.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use assert_cmd::Command;
use lss::signal::{Channel, Run};
use serde_json::Value;
use std::fs;
use std::path::Path;

fn lss() -> Command {
    let mut command = Command::cargo_bin("lss").expect("the binary");
    command.current_dir(env!("CARGO_MANIFEST_DIR"));
    command
}

fn simulate(file: &Path, to: &Path, more: &[&str]) -> Value {
    let out = lss()
        .arg("simulate")
        .arg(file)
        .arg("-o")
        .arg(to)
        .args(["--settle", "1s", "--format", "json"])
        .args(more)
        .assert()
        .success();
    serde_json::from_slice(&out.get_output().stdout).expect("one JSON object")
}

#[test]
fn a_layout_and_its_simulation_input_run_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let (a, b) = (folder.path().join("a"), folder.path().join("b"));
    let summary = simulate(Path::new("examples/smallest.lss"), &a, &[]);
    for key in ["carts", "track_m", "simulated_s", "wall_s", "steps", "channels"] {
        assert!(summary.get(key).is_some(), "{key}");
    }
    assert_eq!(summary["channels"].as_object().expect("channels").len(), 15);
    let mean = summary["channels"]["run_left"]["mean"].as_f64().expect("a mean");
    assert!((mean - 201.0).abs() < 5.0, "{mean}");
    simulate(&a.join("simulation.json"), &b, &[]);
    for file in ["run-01.csv", "run-01.toml", "lap.html", "simulation.json"] {
        assert!(fs::read(a.join(file)).expect(file) == fs::read(b.join(file)).expect(file), "{file}");
    }
    let run = Run::read(&a.join("run-01.csv")).expect("a run");
    assert_eq!(run.sidecar.layout, "simulation.json");
    assert_eq!(run.rate(), 500.0);
    // The page shows what was measured, and says so of every channel.
    let page = fs::read_to_string(a.join("lap.html")).expect("text");
    let written = page.split("<noscript").next().unwrap_or_default();
    assert!(page.starts_with("<!DOCTYPE html>") && !written.contains("NaN") && !written.contains("http:"));
    assert!(page.len() < 1_500_000, "{} bytes", page.len());
    assert!(Channel::ALL.iter().all(|c| page.contains(c.name())));
}

#[test]
fn parquet_holds_the_same_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let (a, b) = (folder.path().join("a"), folder.path().join("b"));
    simulate(Path::new("examples/smallest.lss"), &a, &[]);
    simulate(Path::new("examples/smallest.lss"), &b, &["--run-format", "parquet"]);
    let (a, b) = (Run::read(&a.join("run-01.csv")), Run::read(&b.join("run-01.parquet")));
    assert_eq!(a.expect("csv"), b.expect("parquet"));
}

#[test]
fn options_change_the_chain() {
    let folder = tempfile::tempdir().expect("a folder");
    let of = |more: &[&str], to: &str| simulate(Path::new("examples/smallest.lss"), &folder.path().join(to), more);
    let plain = of(&[], "plain");
    let heavy = of(&["--set", "cart.mass_kg=82"], "heavy");
    let ratio = |channel: &str| {
        heavy["channels"][channel]["mean"].as_f64().unwrap_or(0.0)
            / plain["channels"][channel]["mean"].as_f64().unwrap_or(1.0)
    };
    assert!((ratio("run_left") - 2.0).abs() < 0.1, "{}", ratio("run_left"));
    let tight = of(&["--tension", "900N"], "tight");
    assert!(tight["mean_tension_n"].as_f64() > plain["mean_tension_n"].as_f64().map(|t| t + 200.0));
    let fast = of(&["--speed", "2.5m/s", "--law", "flores", "--sensor-cart", "2"], "fast");
    assert!(fast["simulated_s"].as_f64() < plain["simulated_s"].as_f64());
    let written = fs::read_to_string(folder.path().join("fast/simulation.json")).expect("text");
    assert!(written.contains("\"flores\"") && written.contains("\"speed_m_s\": 2.5"), "{written}");
}

#[test]
fn every_number_is_listed() {
    let out = lss().args(["simulate", "examples/smallest.lss", "--list-parameters"]).assert().success();
    let listed = String::from_utf8_lossy(&out.get_output().stdout).into_owned();
    for name in
        ["cart.mass_kg", "joint.axial.restitution", "track.elements.0.length", "motors.s_m.0", "controller.period_s"]
    {
        assert!(listed.contains(name), "{name}");
    }
    assert!(!listed.contains("left_over_m"));
}

#[test]
fn mistakes_say_a_way_out() {
    let cases: [(&[&str], i32, &str); 6] = [
        (&["--set", "cart.mas_kg=1"], 2, "did you mean `cart.mass_kg`"),
        (&["--set", "cart.mass_kg=heavy"], 2, "not a number in SI units"),
        (&["--set", "chain.left_over_m=1"], 2, "follows from"),
        (&["--set", "cart.mass_kg=-1"], 1, "more than 0"),
        (&["--sensor-cart", "9999"], 1, "the number of carts"),
        (&["--step", "soon"], 2, "not a quantity such as 30s"),
    ];
    let folder = tempfile::tempdir().expect("a folder");
    for (more, code, expected) in cases {
        let mut command = lss();
        command.args(["simulate", "examples/smallest.lss", "-o"]).arg(folder.path().join("out")).args(more);
        let out = command.assert().code(code);
        let said = String::from_utf8_lossy(&out.get_output().stderr).into_owned();
        assert!(said.contains(expected), "{more:?}: {said}");
    }
    assert!(!folder.path().join("out").exists());
}

#[test]
fn a_run_compares_with_itself() {
    let folder = tempfile::tempdir().expect("a folder");
    simulate(Path::new("examples/smallest.lss"), folder.path(), &[]);
    let run = folder.path().join("run-01.csv");
    let out = lss().arg("compare").args([&run, &run]).args(["--format", "json"]).assert().success();
    let report: Value = serde_json::from_slice(&out.get_output().stdout).expect("JSON");
    assert_eq!(report["channels"]["joint_xi"]["nrmsd"].as_f64(), Some(0.0));
}
