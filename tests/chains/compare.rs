//! `lss compare` on small runs with known differences.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use assert_cmd::Command;
use lss::base::trig::{TAU, sin};
use lss::signal::{Channel, Run, Sidecar, csv, parquet};
use std::path::Path;

const LAP: f64 = 50.0;

/// A lap and a bit of 50 m: a curve between 20 and 30 m, and carts of 1.25 m whose passing has a phase of its own.
fn run(phase: f64, gain: f64) -> Run {
    let time: Vec<f64> = (0..13_000).map(|i| f64::from(i) / 500.0).collect();
    let over = |s: f64| if (20.0..30.0).contains(&s) { 80.0 } else { 0.0 };
    let force = |t: &f64| gain * (20.0 + over((2.0 * t).rem_euclid(LAP)) + 2.0 * sin(TAU * 2.0 * t / 1.25 + phase));
    let trigger = |t: &f64| f64::from(u8::from((0.0..0.1).contains(&((2.0 * t - 1.0).rem_euclid(LAP)))));
    let mut run = Run { time, ..Run::default() };
    run.channels.insert(Channel::SteerLeft, run.time.iter().map(force).collect());
    run.channels.insert(Channel::Temperature, vec![20.0; run.time.len()]);
    run.channels.insert(Channel::Trigger, run.time.iter().map(trigger).collect());
    run.sidecar = Sidecar {
        layout: "written.lss".into(),
        sensor_cart: 1,
        speed_setpoint: 2.0,
        trigger_position: 1.0,
        lowpass: 100.0,
        laps: 1,
        ..Sidecar::default()
    };
    run
}

fn write(folder: &Path, name: &str, run: &Run) {
    let data = if name.ends_with(".csv") { csv::write(run) } else { parquet::write(run).expect("columns") };
    std::fs::write(folder.join(name), data).expect("written");
    std::fs::write(folder.join(name).with_extension("toml"), run.sidecar.write()).expect("written");
}

/// Standard output, standard error and the exit code.
fn compare(folder: &Path, arguments: &[&str]) -> (String, String, Option<i32>) {
    let mut command = Command::cargo_bin("lss").expect("the binary");
    let output = command.current_dir(folder).arg("compare").args(arguments).output().expect("it runs");
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("text");
    (text(output.stdout), text(output.stderr), output.status.code())
}

fn two_runs() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    write(folder.path(), "a.csv", &run(0.0, 1.0));
    let mut other = run(TAU / 2.0, 1.0);
    other.channels.entry(Channel::SteerLeft).and_modify(|x| x[700..710].fill(f64::NAN));
    write(folder.path(), "b.parquet", &other);
    folder
}

#[test]
fn a_table_for_people() {
    let folder = two_runs();
    let (out, err, code) = compare(folder.path(), &["a.csv", "b.parquet", "--lap", "50m", "--pitch", "1250mm"]);
    assert_eq!((err.as_str(), code), ("", Some(0)));
    insta::assert_snapshot!(out);
}

#[test]
fn json_for_machines() {
    let folder = two_runs();
    let arguments = ["a.csv", "b.parquet", "--pitch", "1.25m", "--slope", "5", "--format", "json"];
    let (out, _, code) = compare(folder.path(), &arguments);
    assert_eq!(code, Some(0));
    let report: serde_json::Value = serde_json::from_str(&out).expect("JSON");
    let steer = &report["channels"]["steer_left"];
    // The passing of carts is 2 N in opposite phase on a range of 84 N, and cancels in the mean.
    let raw = steer["nrmsd"].as_f64().expect("a number");
    assert!((raw - 4.0 / 2.0_f64.sqrt() / 84.0).abs() < 2e-3, "{raw}");
    assert!(steer["nrmsd_two_carts"].as_f64().expect("a number") < 1e-3);
    assert_eq!(steer["filled"], serde_json::json!([0, 10]));
    assert_eq!(report["channels"]["temperature"]["nrmsd"], serde_json::Value::Null);
    assert_eq!(report["lap_from"], "the trigger's lap time and the nominal speed");
    assert!((report["lap_m"].as_f64().expect("a number") - LAP).abs() < 0.01);
    assert!(report["channels"].get("trigger").is_none());
}

#[test]
fn scale_comes_from_the_layout_where_it_can_be_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    let mut build = Command::cargo_bin("lss").expect("the binary");
    build.args(["build", "examples/smallest.lss", "-o"]).arg(&out).assert().success();
    let mut a = run(0.0, 1.0);
    a.sidecar.layout = "out/simulation.json".into();
    write(folder.path(), "a.csv", &a);
    write(folder.path(), "b.csv", &run(0.0, 1.1));
    let (text, _, code) = compare(folder.path(), &["a.csv", "b.csv", "--format", "json"]);
    assert_eq!(code, Some(0));
    let report: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let bytes = std::fs::read(out.join("simulation.json")).expect("built");
    let layout: serde_json::Value = serde_json::from_slice(&bytes).expect("JSON");
    assert_eq!(report["lap_m"], layout["chain"]["track_length_m"]);
    assert_eq!(report["pitch_m"], layout["chain"]["pitch_m"]);
    assert_eq!(report["pitch_from"], "out/simulation.json");
    let damage = report["channels"]["steer_left"]["damage_ratio"].as_f64().expect("a number");
    assert!((damage - 1.1).abs() < 1e-6, "{damage}");
}

#[test]
fn mistakes_end_in_a_sentence() {
    let folder = two_runs();
    let path = folder.path();
    std::fs::write(path.join("alone.csv"), "time,steer_left\n0,1\n1,2\n").expect("written");
    std::fs::write(path.join("slow.csv"), "time,steer_left\n0,1\n0.1,2\n").expect("written");
    std::fs::copy(path.join("a.toml"), path.join("slow.toml")).expect("copied");
    std::fs::write(path.join("text.csv"), "time,steer_left\n0,1\n0.002,two\n").expect("written");
    std::fs::copy(path.join("a.toml"), path.join("text.toml")).expect("copied");
    let cases: [(&[&str], &str, i32); 6] = [
        (&["a.csv", "nowhere.csv"], "error: nowhere.csv: cannot be read: ", 2),
        (
            &["alone.csv", "a.csv"],
            "error: alone.csv: there is no sidecar alone.toml\n  help: write it with layout, ",
            1,
        ),
        (&["slow.csv", "a.csv"], "error: slow.csv: sampled at 10.0 Hz, less than twice the low-pass of 100 Hz\n", 1),
        (&["a.csv", "text.csv"], "error: text.csv, row 3, `steer_left`: `two` is not a number\n", 1),
        (&["a.toml", "a.csv"], "error: a.toml: is none of CSV, Parquet and MDF4\n  help: name a data file", 1),
        (&["a.csv", "b.parquet", "--lap", "0m"], "error: invalid value '0m' for '--lap <LENGTH>'", 2),
    ];
    for (arguments, expected, expected_code) in cases {
        let (_, err, code) = compare(path, arguments);
        assert!(err.starts_with(expected), "{arguments:?}: {err}");
        assert_eq!(code, Some(expected_code), "{arguments:?}");
    }
}

#[test]
fn what_cannot_be_told_is_said() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut part = run(0.0, 1.0);
    part.time.truncate(6_000);
    part.channels.values_mut().for_each(|x| x.truncate(6_000));
    write(folder.path(), "part.csv", &part);
    part.channels.remove(&Channel::Trigger);
    part.sidecar.layout = "gone/simulation.json".into();
    write(folder.path(), "blind.csv", &part);
    let (out, err, code) = compare(folder.path(), &["part.csv", "blind.csv", "--lap", "50 m"]);
    assert_eq!(code, Some(0));
    assert!(out.contains("pitch  unknown; there is no mean over two carts: give --pitch"), "{out}");
    let warnings: Vec<&str> = err.lines().collect();
    assert_eq!(warnings.len(), 3, "{err}");
    assert!(warnings[0].starts_with("warning: gone/simulation.json is not taken into account: "), "{err}");
    assert!(warnings[1].starts_with("warning: part.csv: the run covers 24.0 of the lap's 50.0 m"), "{err}");
    assert!(warnings[2].starts_with("warning: blind.csv: the trigger never rises"), "{err}");
}

/// Of a campaign the layout is known, and what its recorder did, though a run is given alone.
#[test]
fn a_run_is_as_its_campaign_lists_it() {
    let folder = two_runs();
    let layout = "use std.carts.tilt_tray\nuse std.tracks.standard\nlayout small {\n  catalog standard\n  \
                  cart tilt_tray(length: 1250 mm)\n  speed 2 m/s\n  width 1.2 m\n  vertex A (0 m, 0 m) radius 4 m\n  \
                  vertex B (19.43363 m, 0 m) radius 4 m\n  vertex C (19.43363 m, 9 m) radius 4 m\n  \
                  vertex D (0 m, 9 m) radius 4 m\n  optimise nothing\n}\n";
    std::fs::write(folder.path().join("small.lss"), layout).expect("written");
    let list = "layout = \"small.lss\"\n[[run]]\nfile = \"a.csv\"\nspeed = 2\ntension = 400\n\
                [[run]]\nfile = \"b.parquet\"\nspeed = 2\ntension = 700\n";
    std::fs::write(folder.path().join("campaign.toml"), list).expect("written");
    let (out, err, code) = compare(folder.path(), &["a.csv", "b.parquet"]);
    assert_eq!(code, Some(0), "{err}");
    assert!(out.contains("50.000 m, from small.lss") && out.contains("1.250 m, from small.lss"), "{out}");
    assert!(err.contains("the runs were set to tensions of 400 and 700 N"), "{err}");
    // The same layout without its campaign, and another, of which a lap would be too fast.
    std::fs::remove_file(folder.path().join("campaign.toml")).expect("removed");
    let (given, _, _) = compare(folder.path(), &["a.csv", "b.parquet", "--layout", "small.lss"]);
    assert_eq!(given, out);
    std::fs::write(folder.path().join("large.lss"), layout.replace("9 m", "29 m")).expect("written");
    let (_, err, code) = compare(folder.path(), &["a.csv", "b.parquet", "--layout", "large.lss"]);
    assert!(code == Some(0) && err.contains("between triggers is") && err.contains("is it of this track?"), "{err}");
}
