//! What changed between two layouts, as users and CI ask for it.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use assert_cmd::Command;
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::Command as Process;

const CARTS: &str = "use std.carts.tilt_tray\n";
const LAYOUT: &str = "use std.carts.tilt_tray
use std.tracks.standard
use \"parts/size.lss\"

layout ring {
  catalog standard
  cart tilt_tray(length: 1250 mm)
  speed 2 m/s
  width band
  vertex A (0 m, 0 m) radius 4 m
  vertex B (20 m, 0 m) radius 4 m
  vertex C (20 m, 12 m) radius 4 m
  vertex D (0 m, 12 m) radius 4 m
  fix all A..B
  fix all C..D
}
";

fn lss(folder: &Path) -> Command {
    let mut command = Command::cargo_bin("lss").expect("the binary");
    command.current_dir(folder).arg("diff");
    command
}

fn git(folder: &Path, arguments: &[&str]) -> bool {
    let identity = ["-c", "user.name=a", "-c", "user.email=a@example.com", "-c", "commit.gpgsign=false"];
    let outcome = Process::new("git").current_dir(folder).args(identity).args(arguments).output();
    outcome.is_ok_and(|output| output.status.success())
}

/// A repository with a layout and what it imports; `None` where there is no git.
fn repository() -> Option<tempfile::TempDir> {
    let folder = tempfile::tempdir().expect("a folder");
    let plant = folder.path().join("plant");
    fs::create_dir_all(plant.join("parts")).expect("a folder");
    fs::write(plant.join("ring.lss"), LAYOUT).expect("written");
    fs::write(plant.join("parts/size.lss"), "let band = 1.2 m\n").expect("written");
    let ready = git(folder.path(), &["init", "-q"]) && git(folder.path(), &["add", "-A"]);
    if ready && git(folder.path(), &["commit", "-q", "-m", "one"]) {
        return Some(folder);
    }
    eprintln!("skipped: no git");
    None
}

fn json(command: &mut Command) -> Value {
    let assert = command.args(["--format", "json"]).assert().success();
    serde_json::from_slice(&assert.get_output().stdout).expect("JSON")
}

#[test]
fn order_comments_and_units_are_no_change() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = LAYOUT.replace("use \"parts/size.lss\"\n", "").replace("width band", "width 1.2 m");
    let other = text
        .replace("  speed 2 m/s\n", "  // as the induction asks\n")
        .replace("width 1.2 m", "width 1200 mm\n  speed 120 m/min")
        .replace("  fix all A..B\n", "")
        .replace("  fix all C..D\n", "  fix all C..D\n\n  fix all A..B\n");
    fs::write(folder.path().join("a.lss"), &text).expect("written");
    fs::write(folder.path().join("b.lss"), other).expect("written");
    let said = lss(folder.path()).args(["a.lss", "b.lss", "--fail-on", "any"]).assert().success();
    let said = String::from_utf8_lossy(&said.get_output().stdout).into_owned();
    assert_eq!(said, "ring: a.lss → b.lss\n  nothing changed\n");
}

#[test]
fn what_changed_since_a_revision_is_told_with_its_imports() {
    let Some(folder) = repository() else { return };
    let plant = folder.path().join("plant");
    let same = json(lss(&plant).args(["ring.lss", "--git", "HEAD"]));
    assert_eq!(same["lines"].as_array().map(Vec::len), Some(0), "{same}");
    // Only what is imported changes, and the layout before has what was imported then.
    fs::write(plant.join("parts/size.lss"), "let band = 1.4 m\n").expect("written");
    let found = json(lss(folder.path()).args(["plant/ring.lss", "--git", "HEAD", "-o", "out"]));
    assert_eq!(found["before"]["source"], "HEAD:plant/ring.lss");
    let lines: Vec<&str> = found["lines"].as_array().unwrap().iter().map(|l| l["text"].as_str().unwrap()).collect();
    assert_eq!(lines, ["width 1.2 m", "width 1.4 m"]);
    assert_eq!(found["bill"].as_array().map(Vec::len), Some(0));
    for name in ["change.json", "change.md", "change.svg", "change.png"] {
        assert!(folder.path().join("out").join(name).is_file(), "{name}");
    }
    lss(&plant).args(["ring.lss", "--git", "HEAD", "--fail-on", "bill"]).assert().success();
    lss(&plant).args(["ring.lss", "--git", "HEAD", "--fail-on", "any"]).assert().code(1);

    // Four metres longer on either side, told by the outputs of two builds.
    fs::write(plant.join("ring.lss"), LAYOUT.replace("20 m", "24 m")).expect("written");
    let longer = json(lss(&plant).args(["ring.lss", "--git", "HEAD"]));
    let length = &longer["quantities"][0];
    assert_eq!((length["name"].as_str(), length["unit"].as_str()), (Some("length"), Some("m")));
    assert!((length["after"].as_f64().unwrap() - length["before"].as_f64().unwrap() - 8.0).abs() < 1e-6, "{length}");
    let vertices: Vec<&str> =
        longer["vertices"].as_array().unwrap().iter().map(|v| v["name"].as_str().unwrap()).collect();
    assert_eq!(vertices, ["B", "C"]);
    lss(&plant).args(["ring.lss", "--git", "HEAD", "--fail-on", "bill"]).assert().code(1);
    let markdown = lss(&plant).args(["ring.lss", "--git", "HEAD", "--format", "markdown"]).assert().success();
    let markdown = String::from_utf8_lossy(&markdown.get_output().stdout).into_owned();
    assert!(markdown.contains("| length | ") && markdown.contains("```diff\n- "), "{markdown}");
}

/// What is ordered beside the track is on the bill: motors, and a chute.
#[test]
fn motors_and_chutes_change_the_bill() {
    let folder = tempfile::tempdir().expect("a folder");
    let with = |motors: usize, chutes: usize| {
        let text = LAYOUT.replace("use \"parts/size.lss\"\n", "").replace("width band", "width 1.2 m");
        let row = format!("chutes row_a on A..B from 2 m every 1.5 m count {chutes}");
        text.replace("  fix all A..B\n", &format!("  motors {motors} evenly\n  {row}\n  fix all A..B\n"))
    };
    for (name, motors, chutes) in [("a", 8, 4), ("b", 10, 4), ("c", 8, 5)] {
        fs::write(folder.path().join(format!("{name}.lss")), with(motors, chutes)).expect("written");
    }
    for (after, row) in [("b.lss", "+2"), ("c.lss", "+1")] {
        let assert = lss(folder.path()).args(["a.lss", after, "--fail-on", "bill"]).assert().code(1);
        let said = String::from_utf8_lossy(&assert.get_output().stdout).into_owned();
        assert!(said.contains("ordered beside the track") && said.contains(row), "{said}");
    }
    let found = json(lss(folder.path()).args(["a.lss", "c.lss"]));
    let beside = &found["beside"][0];
    assert_eq!((beside["group"].as_str(), beside["before"].as_u64()), (Some("stations"), Some(4)), "{found}");
    assert_eq!(found["equipment"][0]["after"]["places_m"].as_array().map(Vec::len), Some(5), "{found}");
}

#[test]
fn what_is_not_there_is_said() {
    let Some(folder) = repository() else { return };
    let plant = folder.path().join("plant");
    fs::write(plant.join("new.lss"), LAYOUT).expect("written");
    let says = |arguments: &[&str], at: &Path, code: i32, expected: &str| {
        let assert = lss(at).args(arguments).assert().code(code);
        let said = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        assert!(said.contains(expected), "{said}");
    };
    says(&["new.lss", "--git", "HEAD"], &plant, 1, "HEAD has no plant/new.lss");
    // What is wrong in the revision is told there, not in the file as it is.
    fs::write(plant.join("parts/size.lss"), "let band = 1.2\n").expect("written");
    assert!(git(folder.path(), &["commit", "-q", "-a", "-m", "two"]));
    fs::write(plant.join("parts/size.lss"), "let band = 1.2 m\n").expect("written");
    says(&["ring.lss", "--git", "HEAD"], &plant, 1, "[HEAD:plant/");
    says(&["ring.lss", "--git", "v1.0"], &plant, 2, "no revision v1.0");
    says(&["ring.lss", "--git", "--output=x"], &plant, 2, "");
    assert!(!plant.join("x").exists(), "a revision is no option");
    let outside = tempfile::tempdir().expect("a folder");
    fs::write(outside.path().join("a.lss"), CARTS).expect("written");
    says(&["a.lss", "--git", "HEAD"], outside.path(), 2, "no git repository");
}
