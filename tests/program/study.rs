//! Studies as users start them: killed and started again, two at once, with tasks that fail; the table as others read it.
//!
//! On a real Slurm with two nodes, one of them killed midway (root; slurmctld, slurmd, slurm-client and munge):
//! `cargo test --test program slurm -- --ignored --nocapture`.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

const LAYOUT: &str = "\
use std.carts.tilt_tray
use std.tracks.standard

let long = 16 m

layout small {
  catalog standard
  cart tilt_tray(length: 1250 mm)
  speed 2 m/s
  width 1.2 m

  vertex A (0 m, 0 m) radius 4 m
  vertex B (long, 0 m) radius 4 m
  vertex C (long, 9 m) radius 4 m
  vertex D (0 m, 9 m) radius 4 m

  photocell on A..B at 2 m
  motors 3 evenly

  optimise nothing
}
";

const STUDY: &str = "\
name = \"small loops\"

[[sweep]]
steps = [\"build\", \"simulate\"]
file = \"small.lss\"
let.long = [\"16 m\", \"17 m\"]
simulate.speed = { from = 1, to = 2, step = 0.5, unit = \"m/s\" }
simulate.settle = \"1s\"
";

struct Scene(tempfile::TempDir);

impl Scene {
    fn new(study: &str) -> Scene {
        let scene = Scene(tempfile::tempdir().unwrap());
        fs::write(scene.path("small.lss"), LAYOUT).unwrap();
        fs::write(scene.path("study.toml"), study).unwrap();
        scene
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn command(&self, words: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_lss"));
        command.arg("study").args(words).current_dir(self.0.path()).stdin(Stdio::null());
        command
    }

    fn said(&self, words: &[&str]) -> (Option<i32>, String) {
        let Output { status, stdout, stderr } = self.command(words).output().unwrap();
        (status.code(), String::from_utf8_lossy(&[stdout, stderr].concat()).into_owned())
    }

    fn started(&self, words: &[&str]) -> Child {
        self.command(words).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
    }

    fn results(&self, out: &str) -> usize {
        let tasks = fs::read_dir(self.path(out).join("tasks")).into_iter().flatten().filter_map(Result::ok);
        tasks.filter(|task| task.path().join("result.json").exists()).count()
    }

    /// Waits for so many results.
    fn wait(&self, out: &str, results: usize) {
        let begin = Instant::now();
        while self.results(out) < results {
            assert!(begin.elapsed() < Duration::from_secs(120), "no results");
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// The files of the table.
    fn collected(&self, out: &str) -> Vec<Vec<u8>> {
        let (code, text) = self.said(&["collect", "study.toml", "-o", out]);
        assert_eq!(code, Some(0), "{text}");
        ["study.parquet", "study.csv", "study.html"].map(|name| fs::read(self.path(out).join(name)).unwrap()).to_vec()
    }
}

#[test]
fn a_study_that_was_killed_again_and_again_ends_with_the_same_table() {
    let scene = Scene::new(STUDY);
    assert_eq!(scene.said(&["run", "study.toml", "-o", "whole", "--jobs", "1"]).0, Some(0));
    let whole = scene.collected("whole");
    for results in [1, 2, 4] {
        let mut child = scene.started(&["run", "study.toml", "-o", "out", "--jobs", "2"]);
        scene.wait("out", results);
        child.kill().unwrap();
        child.wait().unwrap();
    }
    // What was done is there, and what is open has no result.
    let (_, text) = scene.said(&["status", "-o", "out"]);
    assert!(text.starts_with("small loops: 6 tasks, ") && text.contains(" done"), "{text}");
    let (code, text) = scene.said(&["run", "study.toml", "-o", "out", "--jobs", "2"]);
    assert!(code == Some(0) && text.contains("6 tasks, 6 done"), "{text}");
    assert!(text.contains("`lss study collect study.toml -o out` makes a table"), "{text}");
    assert!(scene.collected("out") == whole);
    // Nothing is left to do.
    let before = fs::metadata(scene.path("out/study.csv")).unwrap().modified().unwrap();
    assert_eq!(scene.said(&["run", "study.toml", "-o", "out"]).0, Some(0));
    assert_eq!(fs::metadata(scene.path("out/study.csv")).unwrap().modified().unwrap(), before);
}

#[test]
fn two_processes_at_one_study_do_each_task_once() {
    let scene = Scene::new(STUDY);
    let both = [0, 1].map(|_| scene.started(&["run", "study.toml", "-o", "out", "--jobs", "1"]));
    for child in both {
        let output = child.wait_with_output().unwrap();
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success() && text.contains("6 tasks, 6 done"), "{text}");
    }
    assert_eq!(scene.said(&["run", "study.toml", "-o", "alone"]).0, Some(0));
    assert!(scene.collected("out") == scene.collected("alone"));
}

/// Tasks one by one, as Slurm, Dask and Ray call them.
#[test]
fn tasks_by_their_hashes_make_the_same_table() {
    let scene = Scene::new(STUDY);
    let (code, _) = scene.said(&["task", "0123456789abcdef", "-o", "out"]);
    assert_eq!(code, Some(2), "nothing is planned");
    let output = scene.command(&["plan", "study.toml", "-o", "out", "--format", "json"]).output().unwrap();
    let lines: Vec<Value> =
        String::from_utf8_lossy(&output.stdout).lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert_eq!(lines.len(), 6);
    assert_eq!((&lines[0]["state"], &lines[0]["parameters"]["let.long"]), (&"open".into(), &"16 m".into()));
    for line in lines.iter().rev() {
        let hash = line["hash"].as_str().unwrap();
        let (code, text) = scene.said(&["task", hash, "-o", "out"]);
        assert!(code == Some(0) && text.contains(&format!("{hash} done")), "{text}");
    }
    assert_eq!(scene.said(&["run", "study.toml", "-o", "alone"]).0, Some(0));
    assert!(scene.collected("out") == scene.collected("alone"));
    assert_eq!(scene.said(&["task", "0123456789abcdef", "-o", "out"]).0, Some(2), "no such task");
    // The layout is another one than was planned with.
    let hash = lines[0]["hash"].as_str().unwrap();
    fs::write(scene.path("small.lss"), LAYOUT.replace("9 m", "10 m")).unwrap();
    fs::remove_file(scene.path("out/tasks").join(hash).join("result.json")).unwrap();
    let (code, text) = scene.said(&["task", hash, "-o", "out"]);
    assert!(code == Some(2) && text.contains("has changed since the study was planned"), "{text}");
    let (_, text) = scene.said(&["plan", "study.toml", "-o", "out"]);
    assert!(text.contains("6 tasks, 6 open"), "{text}");
}

#[test]
fn a_task_that_fails_stops_no_other_and_is_told() {
    let scene = Scene::new(&STUDY.replace("\"17 m\"", "\"17 kg\"").replace("to = 2,", "to = 1,"));
    let (code, text) = scene.said(&["run", "study.toml", "-o", "out"]);
    assert!(code == Some(1) && text.contains("2 tasks, 1 done, 1 failed"), "{text}");
    assert!(
        text.contains("the x coordinate must be a length, not a mass") && text.contains("let.long=17 kg"),
        "{text}"
    );
    let (code, text) = scene.said(&["collect", "study.toml", "-o", "out"]);
    assert!(code == Some(1) && text.contains("1 task failed"), "{text}");
    let table = fs::read_to_string(scene.path("out/study.csv")).unwrap();
    assert!(
        table.lines().nth(2).unwrap().ends_with("\"build: the x coordinate must be a length, not a mass\""),
        "{table}"
    );
    let (code, text) = scene.said(&["run", "study.toml", "-o", "out"]);
    assert!(code == Some(1) && text.contains("--retry-failed"), "{text}");
    let (code, text) = scene.said(&["status", "-o", "out"]);
    assert!(code == Some(1) && text.contains("2 tasks, 1 done, 1 failed"), "{text}");
    let mut failed = fs::read_dir(scene.path("out/tasks"))
        .unwrap()
        .filter_map(|task| fs::read(task.unwrap().path().join("failed.json")).ok());
    let failed: Value = serde_json::from_slice(&failed.next().unwrap()).unwrap();
    assert_eq!((&failed["step"], &failed["ended"]), (&"build".into(), &"exit code 1".into()));
    assert!(failed["command"].as_array().unwrap().contains(&"--let=long=17 kg".into()), "{failed}");
}

/// Simulated runs are identified, and the parameters found are those that were set.
#[test]
fn a_pipeline_finds_what_was_put_in() {
    let scene = Scene::new(
        "[[sweep]]\nsteps = [\"simulate\", \"identify\"]\nfile = \"small.lss\"\nkeep = false\n\
         simulate = { laps = 2, settle = \"2s\", tension = [\"400N\", \"600N\"] }\nidentify.free = \"tension\"\n",
    );
    let (code, text) = scene.said(&["run", "study.toml", "-o", "out"]);
    assert_eq!(code, Some(0), "{text}");
    scene.collected("out");
    let mut table = csv::Reader::from_path(scene.path("out/study.csv")).unwrap();
    let names = table.headers().unwrap().clone();
    let column = |name: &str| names.iter().position(|n| n == name).unwrap_or_else(|| panic!("{name} of {names:?}"));
    let columns = ["simulate.tension", "identify.tension.value", "identify.tension.low", "identify.tension.high"];
    let columns = columns.map(column);
    let rows: Vec<[f64; 4]> =
        table.records().map(|row| columns.map(|k| row.as_ref().unwrap()[k].parse().unwrap())).collect();
    assert_eq!(rows.iter().map(|row| row[0]).collect::<Vec<_>>(), [400.0, 600.0]);
    for [set, value, low, high] in rows {
        assert!(low <= value && value <= high && (value - set).abs() < 0.1 * set, "{set}: {value} [{low}, {high}]");
    }
    // Of what is not kept, only the results are left.
    for task in fs::read_dir(scene.path("out/tasks")).unwrap() {
        let mut names: Vec<_> = fs::read_dir(task.unwrap().path())
            .unwrap()
            .map(|e| e.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        assert_eq!(names, [".claim", "result.json", "time.json"]);
    }
}

const READER: &str = "
import csv, sys
import pyarrow.parquet
table = pyarrow.parquet.read_table(sys.argv[1])
rows = list(csv.reader(open(sys.argv[2], newline='')))
assert table.column_names == rows[0], table.column_names
types = {str(field.type) for field in table.schema}
assert types <= {'double', 'bool', 'string'}, types
for name, cells in zip(rows[0], zip(*rows[1:])):
    for cell, value in zip(cells, table[name].to_pylist()):
        if cell == '':
            assert value is None or value == '', (name, value)
        elif isinstance(value, bool):
            assert cell == str(value).lower(), (name, cell, value)
        elif isinstance(value, float):
            assert float(cell) == value, (name, cell, value)
        else:
            assert cell == value, (name, cell, value)
print('read', table.num_rows, table.num_columns)
";

#[test]
fn another_reader_finds_in_parquet_what_csv_has() {
    let there = Command::new("python3").args(["-c", "import pyarrow.parquet"]).stderr(Stdio::null()).status();
    if !there.is_ok_and(|status| status.success()) {
        println!("skipped: python3 with pyarrow is not there");
        return;
    }
    // Failed tasks, truths and texts among them.
    let scene = Scene::new(&STUDY.replace("\"17 m\"", "\"17 kg\"").replace("to = 2,", "to = 1.5,"));
    assert_eq!(scene.said(&["run", "study.toml", "-o", "out"]).0, Some(1));
    assert_eq!(scene.said(&["collect", "study.toml", "-o", "out"]).0, Some(1));
    let mut python = Command::new("python3");
    python.args(["-c", READER]).args(["study.parquet", "study.csv"].map(|name| scene.path("out").join(name)));
    let output = python.output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(said.starts_with("read 4 "), "{said}");
}

#[test]
fn scripts_for_slurm_are_written_where_there_is_none() {
    let scene = Scene::new(STUDY);
    let (code, text) =
        scene.said(&["submit", "study.toml", "-o", "out", "--engine", "slurm", "--each", "20s", "--dry-run"]);
    assert!(code == Some(0) && text.contains("6 tasks of 20 s each in 2 jobs of about 60 s"), "{text}");
    let list = fs::read_to_string(scene.path("out/slurm/array-1.txt")).unwrap();
    assert_eq!(list.lines().map(|line| line.split(' ').count()).collect::<Vec<_>>(), [3, 3]);
    // The script does what Slurm would let it do.
    let script = scene.path("out/slurm/array-1.sh");
    for job in ["0", "1"] {
        let status = Command::new("sh").arg(&script).env("SLURM_ARRAY_TASK_ID", job).stderr(Stdio::null()).status();
        assert!(status.unwrap().success());
    }
    assert_eq!(scene.results("out"), 6);
    let (code, text) = scene.said(&["submit", "study.toml", "-o", "out", "--engine", "slurm"]);
    assert!(code == Some(0) && text.contains("nothing to submit"), "{text}");
}

/// What docs/study.md has for Dask and for Ray, run as it stands there.
#[test]
fn the_recipes_for_python_do_all_tasks() {
    let page = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/study.md")).unwrap();
    let recipes: Vec<&str> = page.split("```python\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    assert_eq!(recipes.len(), 2);
    for (module, recipe) in ["dask.distributed", "ray"].into_iter().zip(recipes) {
        let there = Command::new("python3").args(["-c", &format!("import {module}")]).output();
        if !there.is_ok_and(|output| output.status.success()) {
            eprintln!("skipped: {module} is not there");
            continue;
        }
        let scene = Scene::new(STUDY);
        fs::write(scene.path("recipe.py"), recipe).unwrap();
        let program = Path::new(env!("CARGO_BIN_EXE_lss")).parent().unwrap();
        let path = format!("{}:{}", program.display(), std::env::var("PATH").unwrap_or_default());
        let mut python = Command::new("python3");
        python
            .arg("recipe.py")
            .current_dir(scene.path(""))
            .env("PATH", path)
            .env("RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO", "0");
        let output = python.output().unwrap();
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success(), "{module}: {said}{}", String::from_utf8_lossy(&output.stderr));
        assert!(said.lines().any(|line| line.trim() == "0 failed"), "{module}: {said}");
        assert_eq!(scene.results("out"), 6, "{module}");
        assert!(scene.path("out/study.parquet").is_file(), "{module}");
    }
}

#[test]
#[ignore = "starts a cluster: needs root and Slurm"]
fn slurm_loses_nothing_when_a_node_dies() {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/slurm/run.sh");
    let output = Command::new("bash").arg(script).arg(env!("CARGO_BIN_EXE_lss")).output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    println!("{said}{}", String::from_utf8_lossy(&output.stderr));
    let ended = said.lines().last().unwrap_or_default();
    assert!(output.status.success() && (ended.starts_with("passed") || ended.starts_with("skipped")), "{ended}");
}
