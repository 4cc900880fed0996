//! `lss runs` as users run it, and what it suspects of runs with a fault that was put in.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use assert_cmd::Command;
use lss::chain_input::Simulation;
use lss::signal::health::health;
use lss::signal::{Channel, Run, csv};
use serde_json::Value;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

fn lss() -> Command {
    let mut command = Command::cargo_bin("lss").expect("the binary");
    command.current_dir(env!("CARGO_MANIFEST_DIR"));
    command
}

/// A run of an example, with its layout.
fn simulated(example: &str, more: &[&str]) -> (TempDir, Run, Simulation) {
    let folder = tempfile::tempdir().expect("a folder");
    lss().args(["simulate", example, "-o"]).arg(folder.path()).args(more).assert().success();
    let run = Run::read(&folder.path().join("run-01.csv")).expect("a run");
    let layout = fs::read(folder.path().join("simulation.json")).expect("a layout");
    (folder, run, serde_json::from_slice(&layout).expect("a simulation input"))
}

/// A fault, and how what is said of it begins.
type Fault = (fn(&mut Run), &'static [&'static str]);

fn samples(run: &mut Run, channel: Channel) -> &mut Vec<f64> {
    run.channels.entry(channel).or_default()
}

fn exchange(run: &mut Run, a: Channel, b: Channel) {
    let first = std::mem::take(samples(run, a));
    let second = std::mem::replace(samples(run, b), first);
    *samples(run, a) = second;
}

fn said(run: &Run, layout: &Simulation, faults: &[Fault]) {
    for (i, (fault, expected)) in faults.iter().enumerate() {
        let mut run = run.clone();
        fault(&mut run);
        let warnings = health(&run, Some(layout)).warnings();
        let fits = warnings.len() == expected.len() && warnings.iter().zip(*expected).all(|(w, e)| w.starts_with(e));
        assert!(fits, "fault {i}: {warnings:#?}\n{expected:#?}");
    }
}

#[test]
fn every_fault_is_suspected_and_a_clean_run_is_not() {
    let (_folder, run, layout) = simulated("examples/reference.lss", &["--settle", "10s", "--laps", "2"]);
    let clean = health(&run, Some(&layout));
    assert_eq!((clean.samples, clean.rate, clean.edges), (run.time.len(), 500.0, 2));
    assert!((clean.laps.expect("laps") - 2.0).abs() < 0.01);
    for speed in [clean.speed_trigger, clean.speed_wheels] {
        assert!((speed.expect("a speed") - 2.0).abs() < 0.002, "{speed:?}");
    }
    let faults: [Fault; 25] = [
        (|_| {}, &[]),
        // Noise as of real wheels, at a tenth of their load, hides nothing and is no fault.
        (|run| noisy(run, 20.0), &[]),
        (
            |run| {
                noisy(run, 20.0);
                exchange(run, Channel::SteerLeft, Channel::SteerRight);
            },
            &["steer_left and steer_right look exchanged: in curves"],
        ),
        (|run| samples(run, Channel::RunLeft).fill(201.5), &["run_left looks dead: it stays at 201.5 N"]),
        (
            |run| samples(run, Channel::JointZeta).iter_mut().enumerate().for_each(|(i, x)| *x = (i % 3) as f64),
            &["joint_zeta looks dead: it only goes from 0 to 2 N"],
        ),
        (
            |run| samples(run, Channel::SteerLeft).iter_mut().for_each(|x| *x = x.min(100.0)),
            &["steer_left looks clipped: it is at 100 N in "],
        ),
        (
            |run| samples(run, Channel::JointXi).iter_mut().for_each(|x| *x = x.max(250.0)),
            &["joint_xi looks clipped: it is at 250 N in "],
        ),
        (
            |run| exchange(run, Channel::SteerLeft, Channel::SteerRight),
            &["steer_left and steer_right look exchanged: in curves the wrong one is the larger"],
        ),
        (|run| exchange(run, Channel::RunLeft, Channel::RunRight), &["run_left and run_right look exchanged"]),
        (
            |run| exchange(run, Channel::WheelSpeedSteerLeft, Channel::WheelSpeedSteerRight),
            &["wheel_speed_steer_left and wheel_speed_steer_right look exchanged"],
        ),
        (
            |run| exchange(run, Channel::WheelSpeedRunLeft, Channel::WheelSpeedRunRight),
            &["wheel_speed_run_left and wheel_speed_run_right look exchanged"],
        ),
        (
            |run| exchange(run, Channel::JointXi, Channel::JointEta),
            &["joint_xi and joint_eta look exchanged: their means are -"],
        ),
        (
            |run| exchange(run, Channel::RunLeft, Channel::JointZeta),
            &["run_left and joint_zeta look exchanged: their means are -"],
        ),
        (
            |run| exchange(run, Channel::SteerRight, Channel::JointXi),
            &["steer_right and joint_xi look exchanged: their means are "],
        ),
        (|run| samples(run, Channel::JointXi).fill(f64::NAN), &["joint_xi is empty: every sample is lost"]),
        (
            |run| {
                exchange(run, Channel::JointXi, Channel::JointZeta);
            },
            &["joint_xi and joint_zeta look exchanged"],
        ),
        (
            |run| samples(run, Channel::WheelSpeedRunLeft).iter_mut().for_each(|x| *x *= 1.1),
            &["the trigger says 2.000 m/s and the running wheels 2.099 m/s"],
        ),
        (
            |run| run.sidecar.trigger_position += 95.0,
            &["steer_left and steer_right follow the curves with trigger_position 10.5 m, not with 105.0 m: check it"],
        ),
        (
            |run| Channel::FORCES.into_iter().for_each(|c| samples(run, c).iter_mut().for_each(|x| *x /= 1000.0)),
            &[
                "steer_left, steer_right, run_left, run_right, joint_xi, joint_eta and joint_zeta look like kN: forces are in N",
            ],
        ),
        (
            |run| samples(run, Channel::JointXi).iter_mut().for_each(|x| *x = -*x),
            &[
                "joint_xi looks reversed: change the sign with `factor = -1` under `[columns]` in the sidecar (the mean of joint_xi is -",
            ],
        ),
        (
            |run| {
                for channel in [Channel::RunLeft, Channel::RunRight, Channel::JointXi] {
                    let samples = samples(run, channel);
                    let mean = samples.iter().sum::<f64>() / samples.len() as f64;
                    samples.iter_mut().for_each(|x| *x -= mean);
                }
            },
            &["run_left, run_right and joint_xi look set to zero under load: their means say nothing"],
        ),
        (
            |run| [700, 9000, 9001, 20_000].into_iter().for_each(|k| samples(run, Channel::JointXi)[k] = 9999.0),
            &["joint_xi has spikes, samples that jump there and back: 4, the first at 1.4 s to 9999 N"],
        ),
        // An impact that the low-pass has spread is none, though it is as high.
        (
            |run| {
                let impact = [0.319, 0.165, 0.032].map(|x| x * 3e4);
                impact.iter().enumerate().for_each(|(k, x)| samples(run, Channel::JointXi)[7000 + k] += x);
            },
            &[],
        ),
        // An item that doubles the load, and a sensor's gain, are no other unit.
        (|run| samples(run, Channel::RunLeft).iter_mut().for_each(|x| *x *= 0.3), &[]),
        (|run| samples(run, Channel::Trigger).fill(0.0), &["the trigger never rises"]),
    ];
    said(&run, &layout, &faults);
}

/// Uniform noise from a linear congruence (Knuth's MMIX) on every force.
fn noisy(run: &mut Run, size: f64) {
    let mut state = 1_u64;
    for (_, samples) in run.channels.iter_mut().filter(|(c, _)| c.is_force()) {
        for x in samples {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            *x += size * (2.0 * (state >> 11) as f64 / (1_u64 << 53) as f64 - 1.0);
        }
    }
}

#[test]
fn a_missed_edge_shows_in_the_times_of_laps() {
    let (_folder, run, layout) = simulated("examples/smallest.lss", &["--settle", "1s", "--laps", "4"]);
    let faults: [Fault; 2] = [
        (|_| {}, &[]),
        (
            |run| {
                let second = lss::signal::position::edges(run)[1];
                let times = run.time.clone();
                let trigger = samples(run, Channel::Trigger);
                trigger.iter_mut().zip(times).filter(|(_, t)| (t - second).abs() < 1.0).for_each(|(x, _)| *x = 0.0);
            },
            &["the trigger says ", "laps take from "],
        ),
    ];
    said(&run, &layout, &faults);
}

#[test]
fn lost_samples_are_counted() {
    let mut run = Run { time: (0..500).map(|i| f64::from(i) / 500.0).collect(), ..Run::default() };
    let mut force: Vec<f64> = run.time.iter().map(|t| 400.0 + t).collect();
    force[10..20].fill(f64::NAN);
    force[100..200].fill(f64::NAN);
    run.channels.insert(Channel::JointXi, force);
    let found = health(&run, None);
    assert_eq!((found.lost, found.bridged, found.masked, found.laps), (110, 10, 100, None));
    assert_eq!(found.warnings(), [""; 0]);
}

/// A campaign of a good run without a layout and one with a wrong column.
fn campaign(folder: &Path) {
    let mut run = Run { time: (0..500).map(|i| f64::from(i) / 500.0).collect(), ..Run::default() };
    run.channels.insert(Channel::JointXi, run.time.iter().map(|t| 400.0 + 100.0 * t).collect());
    let sidecar =
        "layout = \"none.lss\"\nsensor_cart = 1\nspeed_setpoint = 2\ntrigger_position = 0\nlowpass = 100\nlaps = 1\n";
    let text = String::from_utf8(csv::write(&run)).expect("text");
    for (name, text) in [("a", text.replace("joint_xi", "joint_x")), ("b", text.clone())] {
        fs::write(folder.join(name).with_extension("csv"), text).expect("written");
        fs::write(folder.join(name).with_extension("toml"), sidecar).expect("written");
    }
}

#[test]
fn a_bad_run_does_not_hide_the_good_ones() {
    let folder = tempfile::tempdir().expect("a folder");
    campaign(folder.path());
    let out = lss().arg("runs").arg(folder.path()).args(["--format", "json"]).assert().code(1);
    let found: Value = serde_json::from_slice(&out.get_output().stdout).expect("JSON");
    assert_eq!(found["runs"][0]["name"], "b");
    assert_eq!(found["runs"][0]["channels"]["joint_xi"]["min"], 400.0);
    assert_eq!(found["refused"][0]["name"], "a");
    assert!(found["runs"][0]["warnings"][0].as_str().expect("text").contains("none.lss is not there"));
    let keys = [
        "name",
        "file",
        "layout",
        "samples",
        "rate_hz",
        "duration_s",
        "laps",
        "edges",
        "lost",
        "bridged",
        "masked",
        "speed_trigger",
        "speed_wheels",
        "channels",
        "warnings",
    ];
    assert!(keys.iter().all(|key| found["runs"][0].get(key).is_some()));
    let shown = String::from_utf8_lossy(&out.get_output().stderr).into_owned();
    assert!(shown.contains("`joint_x`: there is no such column\n  help: did you mean `joint_xi`?"), "{shown}");
    fs::remove_file(folder.path().join("a.csv")).expect("removed");
    let out = lss().arg("runs").arg(folder.path()).assert().success();
    let table = String::from_utf8_lossy(&out.get_output().stdout).into_owned();
    insta::assert_snapshot!(table.replace(&format!("{}", folder.path().display()), "FOLDER"));
}

#[test]
fn what_is_no_campaign_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    for (path, code, told) in
        [(folder.path(), 1, "the campaign has no runs"), (Path::new("no/such/folder"), 2, "folder: cannot be read")]
    {
        let out = lss().arg("runs").arg(path).assert().code(code);
        let shown = String::from_utf8_lossy(&out.get_output().stderr).into_owned();
        assert!(shown.contains(told), "{shown}");
    }
}
