//! `lss identify stiffness` as users run it.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use assert_cmd::Command;
use serde_json::Value;
use std::fs;
use std::path::Path;

fn lss(folder: &Path) -> Command {
    let mut command = Command::cargo_bin("lss").expect("the binary");
    command.current_dir(folder);
    command
}

/// A test of a joint with K = 2·10⁸ N/m^1.45 along the chain and K = 2.13·10⁶ N/m across, read to 20 N.
fn test() -> String {
    let mut text = "direction,deformation,force\n".to_owned();
    for i in 0..=10 {
        let d = 4e-5 * f64::from(i);
        let read = |force: f64| (force / 20.0).round() * 20.0;
        text += &format!("axial,{d:.6},{}\n", read(2e8 * lss::base::trig::pow(d, 1.45)));
        text += &format!("radial,{d:.6},{}\n", read(2.13e6 * d));
    }
    text
}

#[test]
fn the_joint_that_is_written_is_one_a_layout_can_use() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    fs::write(at.join("static-test.csv"), test()).expect("written");
    fs::write(at.join("lss.toml"), "").expect("written");
    let out = lss(at).args(["identify", "stiffness", "static-test.csv", "-o", "tested.lss"]).assert().success();
    insta::assert_snapshot!("table", String::from_utf8_lossy(&out.get_output().stdout));
    insta::assert_snapshot!("joint", fs::read_to_string(at.join("tested.lss")).expect("a joint"));
    let layout = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/smallest.lss")).expect("a layout");
    let layout = layout
        .replace("use std.tracks", "use \"tested.lss\"\nuse std.tracks")
        .replace(
            "layout smallest",
            "cart tested from tilt_tray(length: 500 mm) { joint = static_test }\n\nlayout smallest",
        )
        .replace("cart tilt_tray(length: 0.7 m)\n", "cart tested\n");
    fs::write(at.join("line.lss"), layout).expect("written");
    lss(at).args(["check", "line.lss", "tested.lss"]).assert().success();
    lss(at).args(["fmt", "--check", "tested.lss"]).assert().success();
    let model = lss(at).args(["build", "line.lss", "--emit", "model"]).assert().success();
    let model = String::from_utf8_lossy(&model.get_output().stdout).into_owned();
    assert!(model.contains("static_test"), "{model}");
    // Without -o the joint is shown.
    let out = lss(at).args(["identify", "stiffness", "static-test.csv"]).assert().success();
    let shown = String::from_utf8_lossy(&out.get_output().stdout).into_owned();
    assert!(shown.ends_with(&fs::read_to_string(at.join("tested.lss")).expect("a joint")), "{shown}");
}

#[test]
fn json_says_what_was_fitted() {
    let folder = tempfile::tempdir().expect("a folder");
    let radial: String = test().lines().filter(|l| !l.starts_with("axial")).collect::<Vec<_>>().join("\n");
    fs::write(folder.path().join("ball_joint.csv"), radial.replace("radial,", "").replace("direction,", ""))
        .expect("written");
    let arguments = ["identify", "stiffness", "ball_joint.csv", "--direction", "radial", "--format", "json"];
    let out = lss(folder.path()).args(arguments).assert().success();
    let found: Value = serde_json::from_slice(&out.get_output().stdout).expect("JSON");
    assert_eq!(found["joint"], "joint_ball_joint");
    let radial = &found["directions"]["radial"];
    assert_eq!((&radial["points"], &radial["declared"]["exponent"]), (&10.into(), &1.0.into()));
    for (key, truth) in [("stiffness", 2.13e6), ("exponent", 1.0)] {
        let (low, high) = (radial[key]["low"].as_f64().expect("low"), radial[key]["high"].as_f64().expect("high"));
        assert!(low <= truth && truth <= high && high - low < truth, "{key}: {low} to {high}");
    }
}

#[test]
fn what_cannot_be_fitted_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    for (text, code, told) in [
        (
            Some("direction,deformation,force\naxial,x,1\n"),
            1,
            "error: t.csv, row 2, `deformation`: `x` is not a number",
        ),
        (
            Some("direction,deformation,force\naxial,1,1\n"),
            1,
            "error: t.csv, axial: there is 1 point with a deformation",
        ),
        (None, 2, "error: could not read t.csv"),
    ] {
        let file = folder.path().join("t.csv");
        match text {
            Some(text) => fs::write(&file, text).expect("written"),
            None => fs::remove_file(&file).expect("removed"),
        }
        let out = lss(folder.path()).args(["identify", "stiffness", "t.csv"]).assert().code(code);
        let shown = String::from_utf8_lossy(&out.get_output().stderr).into_owned();
        assert!(shown.starts_with(told), "{shown}");
    }
}
