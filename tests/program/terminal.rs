//! Names and texts from files do not steer the terminal, and do not look like the program's own messages.

#![cfg(unix)]
#![allow(clippy::expect_used, clippy::unwrap_used)]

use assert_cmd::Command;
use serde_json::Value;
use std::fs;
use std::path::Path;
use tempfile::TempDir;

/// Names that mean harm: one clears the screen, one begins a line of its own, one turns the text around.
const NAMES: [&str; 5] = ["a\u{1b}[2Jb", "a\nerror: b", "a\u{202e}b\u{2066}", "a\u{9b}31m\u{7f}b", "a\rb\u{200f}"];

const SIDECAR: &str = "sensor_cart = 1\nspeed_setpoint = 2\ntrigger_position = 0\nlowpass = 100\nlaps = 1\n";
const DATA: &str = "time,joint_xi,trigger\n0,1,0\n0.002,2,1\n0.004,3,0\n";

fn steers(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Runs a verb in a folder; what it says on both streams holds nothing that steers a terminal. Standard output is
/// returned.
fn said(at: &Path, arguments: &[&str]) -> String {
    let mut command = Command::cargo_bin("lss").expect("the binary");
    let output = command.current_dir(at).args(arguments).output().unwrap();
    for stream in [&output.stdout, &output.stderr] {
        let text = std::str::from_utf8(stream).expect("UTF-8");
        let bad = text.chars().find(|c| steers(*c) && *c != '\n' && *c != '\t');
        assert!(bad.is_none(), "{arguments:?} writes {bad:?}\n{text:?}");
        assert!(!text.lines().any(|line| line.starts_with("error: b")), "{arguments:?} is made to say\n{text}");
    }
    assert!(output.status.code().is_some_and(|code| code <= 2), "{arguments:?}\n{output:?}");
    String::from_utf8(output.stdout).unwrap()
}

fn folder(files: &[(&str, &str)]) -> TempDir {
    let at = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = at.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }
    at
}

/// On a terminal, a verb that solves a layout first shows how far that is.
#[test]
fn verbs_that_solve_say_how_far_they_are() {
    let is_there = std::process::Command::new("script").arg("--version").output().is_ok();
    if !cfg!(target_os = "linux") || !is_there {
        eprintln!("SKIPPED: there is no `script` here, which makes a terminal");
        return;
    }
    let layout = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/thesis10.lss");
    let layout = layout.to_str().unwrap();
    for verb in
        [format!("polygon {layout}"), format!("simulate {layout} --list-parameters"), format!("diff {layout} {layout}")]
    {
        let command = format!("{} {verb}", env!("CARGO_BIN_EXE_lss"));
        let output = std::process::Command::new("script").args(["-qec", &command, "/dev/null"]).output().unwrap();
        let said = String::from_utf8_lossy(&output.stdout);
        assert!(said.contains("stage 3, node "), "{verb}: {said}");
    }
}

#[test]
fn hostile_names_of_layouts_are_escaped_by_every_verb() {
    let smallest = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/smallest.lss")).unwrap();
    for name in NAMES {
        let file = format!("{name}.lss");
        let (wrong, foreign, plan) = (format!("{name}-wrong.lss"), format!("{name}.json"), format!("{name}.dxf"));
        let out = format!("{name}-out");
        let at = folder(&[
            (&file, &smallest.replace("layout", "  layout")),
            (&wrong, "layout a { speed 2 }\n"),
            (&foreign, "{\"nam\u{202e}e\": 1}"),
            (&plan, "0\nSECTION\n2\nENT\u{1b}[2JITIES\n"),
            ("uses.lss", &format!("use \"{}-wrong.lss\"\n", name.replace('\n', ""))),
        ]);
        let at = at.path();
        let missing = format!("{name}-missing.lss");
        for verb in [
            &["check", &wrong][..],
            &["check", &file, &wrong, &missing],
            &["check", "uses.lss"],
            &["fmt", "--check", &file],
            &["fmt", "--diff", &file],
            &["build", &wrong, "-o", &out],
            &["build", &file, "-o", &out],
            &["build", &foreign, "-o", &out],
            &["simulate", &foreign, "-o", &out],
            &["simulate", &missing, "-o", &out],
            &["polygon", &missing],
            &["polygon", &file],
            &["import", &plan, "-o", "new.lss"],
            &["import", &missing, "-o", "new.lss"],
            &["new", &format!("{name}-new")],
            &["new", &format!("{name}-new")],
            &["explain", name],
            &["build", &file, name],
            &["--root", &missing, "check", &file],
        ] {
            said(at, verb);
        }
        let json = said(at, &["check", "--message-format", "json", &wrong]);
        let first: Value = serde_json::from_str(json.lines().next().expect("a diagnostic")).expect("JSON");
        assert_eq!(first["file"], wrong, "JSON says the name as it is");
    }
}

#[test]
fn hostile_names_of_runs_are_escaped_by_every_verb() {
    for name in NAMES {
        let (data, sidecar, lonely) = (format!("c/{name}.csv"), format!("c/{name}.toml"), format!("c/{name}-2.csv"));
        let at = folder(&[
            (&data, DATA),
            (&sidecar, &format!("layout = \"../l\u{9b}a\u{202e}.json\"\n{SIDECAR}note = \"\u{202e}\u{9b}\"\n")),
            (&lonely, "time,joint_xi\n0,\u{202e}1\u{9b}\n1,2\n"),
            (&lonely.replace(".csv", ".toml"), &format!("layout = \"a.lss\"\n{SIDECAR}")),
            ("d/campaign.toml", "[[run]]\nfile = \"\\u001b[2J\\nerror: b.csv\"\n\"\\u001b\" = 1\n"),
            ("e/campaign.toml", "[[run]]\nfile = \"\\u001b[2J\\nerror: b.csv\"\n"),
            ("f/campaign.toml", "[[run]]\nfile = \"x.csv\"\n[channels]\n\"\\u001b[2J\\nerror: b\" = \"N\"\n"),
            ("f/x.csv", DATA),
        ]);
        let at = at.path();
        for verb in [
            &["runs", "c"][..],
            &["runs", &data],
            &["runs", "d"],
            &["runs", "e"],
            &["runs", "f"],
            &["runs", &format!("{name}-missing")],
            &["compare", &data, &lonely],
            &["compare", &data, &data, "--pitch", "1250mm", "--lap", "50m"],
            &["identify", "c", "-o", "out"],
            &["gap", "diagnose", "c", "-o", "out"],
            &["gap", "diagnose", "f", "-o", "out", "--model", "true"],
            &["gap", "challenge", "score", &format!("{name}-missing")],
            &["identify", "stiffness", &lonely],
        ] {
            said(at, verb);
        }
        let json: Value = serde_json::from_str(&said(at, &["runs", "c", "--format", "json"])).expect("JSON");
        assert_eq!(json["runs"][0]["file"], data.as_str(), "JSON says the name as it is");
        assert!(json["refused"][0]["error"].as_str().unwrap().contains("is not a number"));
    }
}

/// A model that answers with control characters.
#[test]
fn the_answers_of_a_model_are_escaped() {
    let at = folder(&[
        ("campaign.toml", "[[run]]\nfile = \"x.csv\"\n[channels]\nx = \"N\"\n"),
        (
            "x.csv",
            &(0..400).fold("time,x\n".to_owned(), |text, i| text + &format!("{},{}\n", f64::from(i) / 10.0, i % 7)),
        ),
    ]);
    for (k, answer) in [
        "\u{1b}[2J not JSON",
        "{\"error\": \"\\u001b[2J\\nerror: b\\u202e\"}",
        "{\"effects\": [{\"name\": \"\\u001b[2J\", \"strengths\": [{\"name\": \"a\", \"trial\": 1, \"low\": 0, \
         \"high\": 1}]}]}",
        "{\"effects\": [], \"\\u202e\\nerror: b\": 1}",
    ]
    .iter()
    .enumerate()
    {
        let file = format!("answer-{k}");
        fs::write(at.path().join(&file), format!("{answer}\n")).unwrap();
        said(at.path(), &["gap", "diagnose", ".", "-o", "out", "--model", &format!("cat {file}")]);
    }
}
