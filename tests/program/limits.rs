//! Limits for a whole run: `--time-limit` ends a search with the best so far and says so, `--threads` is taken by every
//! verb; neither changes what is written where it cut nothing.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use assert_cmd::Command;
use lss::semantics::analyse;
use lss::solve::{Cut, Options, Status, Stop, solve};
use lss::source::{Loader, SourceMap};
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::Duration;

const EXAMPLE: &str = "examples/thesis10.lss";

fn lss() -> Command {
    let mut command = Command::cargo_bin("lss").expect("the binary");
    command.current_dir(env!("CARGO_MANIFEST_DIR"));
    command
}

/// The files of a folder, by name.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = fs::read_dir(folder).expect("outputs").map(|entry| entry.expect("an output").path());
    entries
        .map(|path| {
            (path.file_name().expect("a name").to_string_lossy().into_owned(), fs::read(&path).expect("readable"))
        })
        .collect()
}

fn text(output: &[u8]) -> String {
    String::from_utf8_lossy(output).into_owned()
}

#[test]
fn a_limit_that_cuts_nothing_changes_no_byte() {
    let build = |more: &[&str]| {
        let out = tempfile::tempdir().expect("a folder");
        lss().args(["build", EXAMPLE, "-o"]).arg(out.path()).args(more).assert().success();
        contents(out.path())
    };
    let without = build(&[]);
    assert!(without == build(&["--time-limit", "100h"]));
    assert!(without == build(&["--time-limit", "100000", "--threads", "1"]));
}

#[test]
fn a_search_that_was_cut_keeps_its_best_and_says_so() {
    let out = tempfile::tempdir().expect("a folder");
    let cut = |more: &[&str]| {
        let mut command = lss();
        command.args(["build", EXAMPLE, "--time-limit", "0s", "-o"]).arg(out.path()).args(more);
        // It is feasible: that is no failure.
        text(&command.assert().success().get_output().stdout)
    };
    let said = cut(&[]);
    assert!(said.contains("cut: time; this is the best layout so far"), "{said}");
    // Every chain has a bound in any case.
    assert!(said.contains("no layout on this grid is shorter than 1") && !said.contains("gap 100"), "{said}");
    let summary: Value = serde_json::from_str(&cut(&["--format", "json"])).expect("a summary");
    assert_eq!((&summary["cut"], &summary["feasible"]), (&Value::from("time"), &Value::from(true)));
    assert_eq!(summary["certificate"]["proven"], false);
    let length = summary["length_m"].as_f64().expect("a length");
    assert!((159.514_066..215.0).contains(&length), "{length}");
    let layout: Value =
        serde_json::from_slice(&fs::read(out.path().join("layout.json")).expect("written")).expect("JSON");
    let stages = layout["stages"].as_array().expect("stages");
    assert_eq!((stages[0].get("cut"), stages[2].get("cut")), (None, Some(&Value::from("time"))));
    let drawing = fs::read_to_string(out.path().join("drawing.svg")).expect("written");
    assert!(drawing.contains("cut: time"), "the title block says so");
}

#[test]
fn a_search_for_an_even_run_that_was_cut_is_a_layout_too() {
    let text = include_str!("../../examples/even.lss");
    let mut sources = SourceMap::default();
    let (mut loader, main) = Loader::memory(&mut sources, &[("even.lss", text.as_bytes())]).expect("text");
    let analysis = analyse(&mut sources, &mut loader, main, None);
    let layout = analysis.chosen().expect("one layout").expect("a layout");
    let options = Options { stop: Stop::after(Duration::ZERO), ..Options::default() };
    let stages = solve(layout, &options, &|_| {});
    let last = stages.last().expect("a stage");
    assert_eq!((last.name, last.cut), ("polygon", Some(Cut::Time)));
    assert_ne!(last.status, Status::Infeasible, "{:?}", last.violations);
}

#[test]
fn every_verb_takes_threads() {
    let help = text(&lss().arg("--help").assert().success().get_output().stdout);
    let verbs = help.lines().skip_while(|l| *l != "Commands:").skip(1).take_while(|l| !l.is_empty());
    let verbs: Vec<&str> =
        verbs.filter_map(|l| l.strip_prefix("  ")?.split(' ').next().filter(|verb| !verb.is_empty())).collect();
    assert!(verbs.len() > 12, "{help}");
    for verb in verbs.iter().filter(|verb| **verb != "help") {
        let help = text(&lss().args([*verb, "--threads", "3", "--help"]).assert().success().get_output().stdout);
        assert!(help.contains("--threads <N>"), "{verb}\n{help}");
    }
    lss().args(["--threads", "2", "check", EXAMPLE]).assert().success();
    let refused = lss().args(["check", EXAMPLE, "--threads", "0"]).assert().code(2);
    assert!(text(&refused.get_output().stderr).contains("0 is not a number of threads from 1 to 1024"));
    let refused = lss().args(["build", EXAMPLE, "--time-limit", "soon"]).assert().code(2);
    assert!(text(&refused.get_output().stderr).contains("soon is not a time such as 30, 30s or 2min"));
}
