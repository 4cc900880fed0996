//! A chain with one effect is told to have that one: simulated runs are diagnosed end to end. It takes a minute or two:
//! `cargo test --release --test chains single_effect:: -- --ignored`.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Command;

fn lss(at: &Path, arguments: &[&str]) {
    let output = Command::new(env!("CARGO_BIN_EXE_lss")).args(arguments).current_dir(at).output().expect("lss runs");
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
}

/// Three runs of `truth-0.lss` to `truth-2.lss` at two speeds and three tensions, of so many laps, as a campaign of
/// `oval.lss`.
fn campaign(at: &Path, laps: &str) {
    let mut list = "layout = \"oval.lss\"\n".to_owned();
    for (run, (speed, tension)) in [("1.8m/s", "500N"), ("1.44m/s", "600N"), ("1.8m/s", "400N")].iter().enumerate() {
        let out = format!("run-{run}");
        let truth = format!("truth-{run}.lss");
        lss(at, &["simulate", &truth, "--speed", speed, "--tension", tension, "--laps", laps, "-o", &out]);
        let sidecar = fs::read_to_string(at.join(&out).join("run-01.toml")).expect("a sidecar");
        fs::write(at.join(format!("campaign/{run}.toml")), sidecar.replace("simulation.json", "oval.lss"))
            .expect("written");
        fs::rename(at.join(out).join("run-01.csv"), at.join(format!("campaign/{run}.csv"))).expect("moved");
        list += &format!("[[run]]\nfile = \"{run}.csv\"\n");
    }
    fs::write(at.join("campaign/campaign.toml"), list).expect("written");
}

/// What a campaign whose chains have these effects is diagnosed to have, and the folder of it.
fn diagnosed(effects: &str) -> (tempfile::TempDir, Value) {
    diagnosed_of([effects; 3], "1")
}

/// The same, with the effects of each run, and so many laps.
fn diagnosed_of(effects: [&str; 3], laps: &str) -> (tempfile::TempDir, Value) {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let oval = include_str!("../../benches/identify/layouts/oval.lss");
    fs::create_dir(at.join("campaign")).expect("a folder");
    fs::write(at.join("campaign/oval.lss"), oval).expect("written");
    let end = oval.rfind('}').expect("the layout's end");
    for (run, effects) in effects.iter().enumerate() {
        fs::write(at.join(format!("truth-{run}.lss")), format!("{}{effects}}}\n", &oval[..end])).expect("written");
    }
    campaign(at, laps);
    lss(at, &["gap", "diagnose", "campaign", "-o", "out", "--apply"]);
    let gap = serde_json::from_slice(&fs::read(at.join("out/gap.json")).expect("gap.json")).expect("JSON");
    (folder, gap)
}

/// Asserts that an interval is of one sign and holds the truth.
fn holds(strength: &Value, truth: f64) {
    let [low, high] = ["low", "high"].map(|end| strength[end].as_f64().expect("an interval"));
    assert!(low * high > 0.0 && low <= truth && truth <= high, "{truth}: {strength}");
}

#[test]
#[ignore = "takes a minute or two"]
fn clearance_of_the_joints_alone_is_one_effect() {
    let (folder, gap) = diagnosed("  effect joint_clearance(gap: 0.2 mm)\n");
    assert_eq!(gap["verdict"], "effect", "{}", gap["summary"]);
    let named = &gap["effects"][0];
    assert_eq!(named["name"], "joint_clearance");
    holds(&named["strength"]["gap"], 0.2e-3);
    let applied = fs::read_to_string(folder.path().join("out/oval-gap.lss")).expect("a layout");
    assert_eq!(applied.matches("effect ").count(), 1, "{applied}");
}

/// Without them the nominal model's parameters go where slopes no longer reach back from: strengths have to be fitted
/// together with them.
#[test]
#[ignore = "takes some minutes"]
fn steps_that_pull_the_nominal_parameters_are_found_with_their_heights() {
    let steps = [("2", 12.0, 1.0), ("3", 42.0, -0.8)];
    let declared = steps
        .map(|(rail, at, mm)| format!("  effect rail_step(height: {mm} mm, at: {at} m, rail: {rail}, rise: 50 mm)\n"));
    let (_folder, gap) = diagnosed(&declared.concat());
    assert_eq!(gap["verdict"], "effect", "{}", gap["summary"]);
    let named = &gap["effects"][0];
    assert_eq!(named["name"], "rail_step");
    let elsewhere = named["elsewhere"].as_array().expect("another place");
    let found: Vec<&Value> = std::iter::once(named).chain(elsewhere).collect();
    assert_eq!(found.len(), steps.len(), "{}", gap["summary"]);
    for (rail, at, mm) in steps {
        let own = found.iter().find(|f| f["fixed"]["rail"].as_f64() == rail.parse().ok()).expect("the rail");
        assert!((own["fixed"]["at"].as_f64().expect("a place") - at).abs() < 0.1, "{own}");
        holds(&own["strength"]["height"], 1e-3 * mm);
    }
    for run in gap["runs"].as_array().expect("runs") {
        assert!(run["after"].as_f64() < run["honest_high"].as_f64(), "{run}");
    }
}

/// The parameters of a fit take a stiffness that is another all along, but none that comes up in a run.
#[test]
#[ignore = "takes a minute or two"]
fn stiffness_that_comes_up_in_a_run_is_found() {
    let (_folder, gap) = diagnosed("  effect stiffness_temperature(change: -0.2, after: 20 s)\n");
    assert_eq!(gap["verdict"], "effect", "{}", gap["summary"]);
    let named = &gap["effects"][0];
    assert_eq!(named["name"], "stiffness_temperature", "{}", gap["summary"]);
    // Time constants are tried, not fitted: any but the one of a stiffness that is so from the beginning.
    assert!(named["fixed"]["after"].as_f64() > Some(0.0), "{named}");
    holds(&named["strength"]["change"], -0.2);
}

/// A sensor drifts while it warms up, and the runs of a campaign are recorded one after the other.
#[test]
#[ignore = "takes a minute or two"]
fn a_drift_that_slows_down_from_run_to_run_is_one_effect() {
    let rates = [1.5, 1.0, 0.4];
    let effects = rates.map(|rate| format!("  effect sensor_bias_drift(drift: {rate} N/s, channel: 5)\n"));
    let (folder, gap) = diagnosed_of([&effects[0], &effects[1], &effects[2]], "2");
    assert_eq!(gap["verdict"], "sensor", "{}", gap["summary"]);
    let named = &gap["effects"][0];
    assert_eq!(named["name"], "sensor_bias_drift", "{}", gap["summary"]);
    let drift = &named["strength"]["drift"];
    holds(drift, rates[0]);
    let by_run: Vec<f64> = drift["by_run"].as_object().expect("runs").values().filter_map(Value::as_f64).collect();
    assert!(by_run.iter().zip(rates).all(|(found, rate)| (found / rate - 1.0).abs() < 0.1), "{drift}");
    let applied = fs::read_to_string(folder.path().join("out/oval-gap.lss")).expect("a layout");
    assert!(applied.contains("// drift of each run: "), "{applied}");
}

/// Asserts that the first effect is ripple of the motors at a pitch, m.
fn ripples(gap: &Value, wavelength: f64) -> &Value {
    assert_eq!(gap["verdict"], "effect", "{}", gap["summary"]);
    let named = &gap["effects"][0];
    assert_eq!(named["name"], "motor_ripple", "{}", gap["summary"]);
    let found = named["fixed"]["wavelength"].as_f64().expect("a wavelength");
    assert!((found / wavelength - 1.0).abs() < 0.05, "{named}");
    named
}

/// No phase is known to the diagnosis, which looks for all with 0.
#[test]
#[ignore = "takes some minutes"]
fn a_ripple_is_found_with_its_second_harmonic() {
    let (folder, gap) =
        diagnosed("  effect motor_ripple(ratio: 0.1, twice: 0.06, wavelength: 200 mm, twice_phase: 1)\n");
    let named = ripples(&gap, 0.2);
    holds(&named["strength"]["ratio"], 0.1);
    holds(&named["strength"]["twice"], 0.06);
    assert_eq!((&named["shape"]["over"], &named["shape"]["unit"]), (&"m".into(), &"".into()));
    let applied = fs::read_to_string(folder.path().join("out/oval-gap.lss")).expect("a layout");
    assert!(applied.contains("twice: "), "{applied}");
}

#[test]
#[ignore = "takes some minutes"]
fn a_ripple_of_one_sine_has_no_harmonics() {
    let (_folder, gap) = diagnosed("  effect motor_ripple(ratio: 0.1, wavelength: 200 mm)\n");
    let named = ripples(&gap, 0.2);
    holds(&named["strength"]["ratio"], 0.1);
    for harmonic in ["twice", "thrice"] {
        let low = named["strength"][harmonic]["low"].as_f64();
        assert!(low.is_none_or(|low| low <= 0.0), "{harmonic}: {named}");
    }
}
