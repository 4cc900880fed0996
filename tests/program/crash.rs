//! Nothing is lost in a crash: `lss` is killed at each of its writing calls in turn, by `strace`. Afterwards every file
//! is the old one or the new one, whole, and the next run succeeds and leaves nothing behind. Without strace this says
//! that it was skipped.

#![cfg(target_os = "linux")]
#![allow(clippy::expect_used, clippy::unwrap_used)]

use lss::benchmark::seal::seal;
use lss::benchmark::{Case, CaseKind, Facts, Key};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;
use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};

/// What changes a disk. A `?` where some processors have no such call.
const CALLS: &str = "write,fsync,fchmod,?rename,?renameat,renameat2,?link,linkat,?unlink,unlinkat,?mkdir,mkdirat";

/// Points at which a run was killed, over all verbs.
const LEAST: usize = 200;

type Tree = BTreeMap<PathBuf, Vec<u8>>;

/// A command, and the folder in which it runs and writes.
struct Scene {
    name: &'static str,
    folder: tempfile::TempDir,
    arguments: Vec<String>,
    /// Files before it ran, and after it ran to its end.
    before: Tree,
    after: Tree,
    ended: ExitStatus,
}

/// Files below a folder, by relative paths; temporary ones, too.
fn tree(folder: &Path) -> Tree {
    let mut out = Tree::new();
    let mut left = vec![folder.to_owned()];
    while let Some(at) = left.pop() {
        for entry in fs::read_dir(&at).expect("a folder") {
            let path = entry.expect("an entry").path();
            if path.is_dir() {
                left.push(path);
            } else {
                // How long a task took is another number each time.
                let bytes = if path.ends_with("time.json") { Vec::new() } else { fs::read(&path).expect("a file") };
                out.insert(path.strip_prefix(folder).expect("below").to_owned(), bytes);
            }
        }
    }
    out
}

fn is_temporary(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    (name.starts_with(".lss-") && name.ends_with(".tmp")) || path.starts_with("tmp")
}

/// Work that goes on where it was, a line at a time: it may end in half a line.
fn is_log(path: &Path) -> bool {
    path.ends_with("gap.partial")
}

fn is_manifest(path: &Path) -> bool {
    path.file_name().is_some_and(|n| n.to_string_lossy().starts_with(".lss-manifest-"))
}

impl Scene {
    /// `fill` makes the files that are there before.
    fn new(name: &'static str, arguments: &[&str], fill: impl Fn(&Path)) -> Scene {
        let folder = tempfile::tempdir().expect("a folder");
        let mut scene = Scene {
            name,
            folder,
            arguments: arguments.iter().map(|a| (*a).to_owned()).collect(),
            before: Tree::new(),
            after: Tree::new(),
            ended: ExitStatus::from_raw(0),
        };
        fs::create_dir(scene.at().join("tmp")).expect("a folder");
        fill(scene.at());
        scene.before = tree(scene.at());
        scene.ended = scene.run();
        scene.after = tree(scene.at());
        assert!(!scene.after.keys().any(|p| is_temporary(p)), "{name}: {:?}", scene.after.keys());
        scene
    }

    /// The outputs are older ones: their content is another, and they were whole.
    fn with_old_outputs(mut self, is_output: impl Fn(&Path) -> bool) -> Scene {
        for (path, bytes) in &self.after {
            if !is_log(path) && !is_manifest(path) && is_output(path) {
                self.before.insert(path.clone(), [b"old ", bytes.as_slice()].concat());
            }
        }
        self
    }

    fn at(&self) -> &Path {
        self.folder.path()
    }

    fn command(&self, program: &str, tracer: &[&str]) -> Command {
        let mut command = Command::new(program);
        if !tracer.is_empty() {
            command.args(tracer).arg(env!("CARGO_BIN_EXE_lss"));
        }
        command.args(&self.arguments).current_dir(self.at()).env("TMPDIR", self.at().join("tmp"));
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        command
    }

    fn run(&self) -> ExitStatus {
        self.command(env!("CARGO_BIN_EXE_lss"), &[]).status().expect("lss runs")
    }

    /// Everything as it was before.
    fn reset(&self) {
        for path in tree(self.at()).keys() {
            fs::remove_file(self.at().join(path)).expect("removed");
        }
        let _ = fs::remove_dir_all(self.at().join("tmp"));
        fs::create_dir(self.at().join("tmp")).expect("a folder");
        for (path, bytes) in &self.before {
            let path = self.at().join(path);
            fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
            fs::write(path, bytes).expect("written");
        }
    }

    /// The calls with which a whole run changes files in the folder: the call's name and its number within its thread.
    fn calls(&self) -> BTreeSet<(String, usize)> {
        self.reset();
        let log = tempfile::NamedTempFile::new().expect("a file");
        let trace = format!("trace={CALLS}");
        let path = log.path().to_string_lossy().into_owned();
        let tracer = ["-f", "-qq", "-y", "-s", "0", "-o", &path, "-e", &trace];
        self.command("strace", &tracer).status().expect("strace runs");
        let mut numbers: BTreeMap<(String, String), usize> = BTreeMap::new();
        let mut found = BTreeSet::new();
        let folder = self.at().to_string_lossy().into_owned();
        for line in fs::read_to_string(log.path()).expect("a log").lines() {
            let Some((thread, rest)) = line.split_once(' ') else { continue };
            let Some((call, arguments)) = rest.trim_start().split_once('(') else { continue };
            if !call.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit()) {
                continue;
            }
            let number = numbers.entry((thread.to_owned(), call.to_owned())).or_default();
            *number += 1;
            // Relative paths are within the folder; what is written to has its path from strace.
            let within = match call {
                "write" | "fsync" | "fchmod" => arguments.split(',').next().is_some_and(|a| a.contains(&folder)),
                _ => true,
            };
            if within {
                found.insert((call.to_owned(), *number));
            }
        }
        found
    }

    /// Kills a run at a call, if it comes so far.
    fn killed(&self, (call, number): &(String, usize)) -> bool {
        self.reset();
        let (trace, inject) = (format!("trace={call}"), format!("inject={call}:signal=KILL:when={number}"));
        let tracer = ["-f", "-qq", "-o", "/dev/null", "-e", &trace, "-e", &inject];
        self.command("strace", &tracer).status().expect("strace runs").signal() == Some(9)
    }

    /// Every file is the old one or the new one, whole.
    fn check(&self, point: &(String, usize)) {
        let now = tree(self.at());
        let names: BTreeSet<&PathBuf> = now.keys().chain(self.before.keys()).chain(self.after.keys()).collect();
        for path in names.into_iter().filter(|p| !is_temporary(p) && !is_log(p)) {
            let found = now.get(path);
            if is_manifest(path) {
                // Between the two it says what is going on.
                let whole = found.is_none_or(|bytes| serde_json::from_slice::<serde_json::Value>(bytes).is_ok());
                assert!(whole, "{} {point:?}: {}", self.name, path.display());
                continue;
            }
            let known = found == self.before.get(path) || found == self.after.get(path);
            // Challenges and studies keep why a case or task failed: a child that was killed is such a reason.
            let says = |words: &str| found.is_some_and(|bytes| String::from_utf8_lossy(bytes).contains(words));
            let killed = says("signal: 9") || says("killed by signal 9");
            assert!(known || killed, "{} {point:?}: {} is neither old nor new", self.name, path.display());
        }
    }

    /// The next run does all that is left, and sweeps.
    fn check_next_run(&self, point: &(String, usize)) {
        assert_eq!(self.run(), self.ended, "{} {point:?}", self.name);
        let now = tree(self.at());
        let names = |tree: &Tree| tree.keys().cloned().collect::<Vec<_>>();
        assert_eq!(names(&now), names(&self.after), "{} {point:?}", self.name);
        assert!(now == self.after, "{} {point:?}: the next run writes something else", self.name);
    }

    /// Kills at every point, and looks at the next run after every `runs`th of them. How many points that were.
    fn kill_in_turn(&self, runs: usize) -> usize {
        self.kill_at_every(1, runs)
    }

    /// Kills at every `points`th point only.
    fn kill_at_every(&self, each: usize, runs: usize) -> usize {
        let begin = std::time::Instant::now();
        let points = self.calls();
        assert!(self.after == tree(self.at()), "{}: traced, it writes something else", self.name);
        let mut count = 0;
        for point in points.iter().step_by(each) {
            if !self.killed(point) {
                continue;
            }
            count += 1;
            self.check(point);
            if count % runs == 0 {
                self.check_next_run(point);
            }
        }
        println!("{}: {count} points in {:.1} s", self.name, begin.elapsed().as_secs_f64());
        count
    }
}

const LAYOUT: &str = "\
use std.carts.tilt_tray
use std.tracks.standard

layout small {
  catalog standard
  cart tilt_tray(length: 1250 mm)
  speed 2 m/s
  width 1.2 m

  vertex A (0 m, 0 m) radius 4 m
  vertex B (16 m, 0 m) radius 4 m
  vertex C (16 m, 9 m) radius 4 m
  vertex D (0 m, 9 m) radius 4 m

  photocell on A..B at 2 m
  motors 3 evenly

  optimise nothing
}
";

fn write(at: &Path, name: &str, text: impl AsRef<[u8]>) {
    let path = at.join(name);
    fs::create_dir_all(path.parent().expect("a folder")).expect("a folder");
    fs::write(path, text).expect("written");
}

fn fmt() -> Scene {
    let names: Vec<String> = (0..8).map(|k| format!("{k}.lss")).collect();
    let arguments: Vec<&str> = ["fmt"].into_iter().chain(names.iter().map(String::as_str)).collect();
    Scene::new("fmt", &arguments, |at| {
        names.iter().for_each(|name| write(at, name, LAYOUT.replace("  vertex", " vertex")));
    })
}

fn build() -> Scene {
    let scene = Scene::new("build", &["build", "small.lss", "-o", "out"], |at| write(at, "small.lss", LAYOUT));
    scene.with_old_outputs(|path| path.starts_with("out"))
}

/// A line with an offset that the model does not know.
const MODEL: &str = r#"
import json, sys
for line in sys.stdin:
    asked = json.loads(line)
    if asked["request"] == "describe":
        strength = {"name": "x", "trial": 0.1, "low": -9, "high": 9}
        say = {"nuisances": [], "effects": [{"name": "offset", "strengths": [strength]}], "accuracy": {"x": 0.01}}
    else:
        offset = sum(e["strengths"]["x"] for e in asked["effects"])
        t = [0.5 * i for i in range(100)]
        say = {"time": t, "channels": {"x": [0.1 * x + offset for x in t]}}
    print(json.dumps(say), flush=True)
"#;

/// The interpreter itself: what is found by PATH may be a script that starts a hundred programs, each of which would be
/// traced.
fn python() -> String {
    let output = Command::new("python3").args(["-c", "import sys; print(sys.executable)"]).output().expect("python3");
    String::from_utf8_lossy(&output.stdout).trim().to_owned()
}

fn gap() -> Scene {
    let model = format!("\"{}\" -I -S m.py", python());
    let arguments = ["gap", "diagnose", "campaign", "--model", &model, "-o", "out"];
    let scene = Scene::new("gap", &arguments, |at| {
        write(at, "m.py", MODEL);
        let mut list = "[channels]\nx = \"m\"\n".to_owned();
        for run in 0..2 {
            let mut text = "time,x\n".to_owned();
            for i in 0..100 {
                let noise = f64::from((i * i * 7 + i * 3 + run * 5) % 11) - 5.0;
                writeln!(text, "{},{}", 0.5 * f64::from(i), 0.05 * f64::from(i) + 0.01 * noise + 1.0).expect("written");
            }
            write(at, &format!("campaign/{run}.csv"), text);
            writeln!(list, "[[run]]\nfile = \"{run}.csv\"").expect("written");
        }
        write(at, "campaign/campaign.toml", list);
    });
    scene.with_old_outputs(|path| path.starts_with("out"))
}

/// A static test; its points lie on K = 2 MN/m.
fn stiffness() -> Scene {
    Scene::new("stiffness", &["identify", "stiffness", "test.csv", "-o", "joint.lss"], |at| {
        let mut text = "direction,deformation,force\n".to_owned();
        for k in 1..20 {
            let x = 1e-5 * f64::from(k);
            writeln!(text, "axial,{x},{}", 2e6 * x * (1.0 + 0.01 * f64::from(k % 3 - 1))).expect("written");
        }
        write(at, "test.csv", text);
        write(at, "joint.lss", "// older\n");
    })
}

/// A campaign of one simulated run, whose fit is kept.
fn identify() -> Scene {
    let lss = |at: &Path, arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_lss"));
        command.args(arguments).current_dir(at).stdout(Stdio::null()).stderr(Stdio::null());
        assert!(command.status().expect("lss runs").success(), "{arguments:?}");
    };
    let arguments = ["identify", "campaign", "--free", "speed", "-o", "out"];
    let scene = Scene::new("identify", &arguments, |at| {
        write(at, "campaign/small.lss", LAYOUT);
        lss(at, &["simulate", "campaign/small.lss", "--laps", "2", "--settle", "2s", "-o", "run"]);
        for file in ["run-01.csv", "run-01.toml"] {
            fs::rename(at.join("run").join(file), at.join("campaign").join(file)).expect("moved");
        }
        fs::remove_dir_all(at.join("run")).expect("removed");
        write(at, "campaign/campaign.toml", "layout = \"small.lss\"\n[[run]]\nfile = \"run-01.csv\"\n");
        lss(at, &arguments);
    });
    scene.with_old_outputs(|path| path.starts_with("out") && !path.starts_with("out/fits"))
}

/// Cases that cannot be diagnosed: their reasons are kept, and the score counts them.
fn challenge() -> Scene {
    let scene = Scene::new("challenge", &["gap", "challenge", "score", "cases"], |at| {
        let case = |k: usize| Case {
            name: format!("case-{k}"),
            kind: CaseKind::None,
            truth: Vec::new(),
            strength_over_floor: 0.0,
            level: None,
            oracle: None,
            about: String::new(),
        };
        let key = Key { seed: 3, cases: (0..3).map(case).collect() };
        let sealed = seal(&serde_json::to_vec(&key).expect("json"), 3);
        let cases: Vec<String> = key.cases.iter().map(|c| c.name.clone()).collect();
        for case in &cases {
            write(at, &format!("cases/{case}/campaign.toml"), "layout = 3\n");
        }
        let facts = Facts { key_sha256: sealed.hash, cases, mix: String::new() };
        write(at, "cases/challenge.json", serde_json::to_vec(&facts).expect("json"));
        write(at, "cases/key.sealed", sealed.bytes);
    });
    scene.with_old_outputs(|path| path.starts_with("cases/score.json") || path.starts_with("cases/score.md"))
}

/// A challenge of one case. It is simulated each time, so only some of its points are tried.
fn new_challenge() -> Scene {
    let arguments =
        ["gap", "challenge", "new", "--cases", "1", "--only", "none", "--layout", "small.lss", "-o", "cases"];
    Scene::new("new challenge", &arguments, |at| write(at, "small.lss", LAYOUT))
}

const STUDY: &str = "[[sweep]]\nsteps = \"build\"\nfile = \"small.lss\"\nlet.long = [\"16 m\", \"17 m\"]\n";

fn with_study(at: &Path) {
    write(at, "small.lss", LAYOUT.replace("layout small", "let long = 16 m\n\nlayout small").replace("(16 m", "(long"));
    write(at, "study.toml", STUDY);
}

/// Two tasks, and the processes that they start. One of these that is killed alone is a failure, which is tried again.
fn study() -> Scene {
    Scene::new("study", &["study", "run", "study.toml", "-o", "out", "--jobs", "1", "--retry-failed"], with_study)
}

/// The table of such a study.
fn collect() -> Scene {
    let scene = Scene::new("collect", &["study", "collect", "study.toml", "-o", "out"], |at| {
        with_study(at);
        let (code, text) = said(at, &["study", "run", "study.toml", "-o", "out"]);
        assert_eq!(code, Some(0), "{text}");
    });
    scene.with_old_outputs(|path| path.starts_with("out/study.csv") || path.starts_with("out/study.html"))
}

fn is_there(program: &str) -> bool {
    let found = Command::new(program).arg("--version").stdout(Stdio::null()).status().is_ok_and(|s| s.success());
    if !found {
        println!("skipped: {program} is not there");
    }
    found
}

/// Whether processes may be traced here: some containers forbid it.
fn traces() -> bool {
    let traced = Command::new("strace").args(["-qq", "-o", "/dev/null", "true"]).status().is_ok_and(|s| s.success());
    if !traced {
        println!("skipped: strace may not trace here");
    }
    traced
}

#[test]
fn every_file_is_the_old_one_or_the_new_one_whenever_a_run_is_killed() {
    if !is_there("strace") || !traces() || !is_there("python3") {
        return;
    }
    let count: usize = std::thread::scope(|scope| {
        let files = scope.spawn(|| {
            let quick = [fmt(), stiffness(), challenge()];
            let quick = quick.iter().map(|scene| scene.kill_in_turn(1)).sum::<usize>();
            quick + build().kill_in_turn(2)
        });
        let models = scope.spawn(|| {
            let kept = gap().kill_in_turn(1) + identify().kill_in_turn(4);
            kept + new_challenge().kill_at_every(5, 3)
        });
        [files, models].map(|part| part.join().expect("no panic")).iter().sum()
    });
    assert!(count >= LEAST, "{count} points");
}

#[test]
fn a_study_loses_nothing_whenever_it_is_killed() {
    if !is_there("strace") || !traces() {
        return;
    }
    let count = collect().kill_in_turn(2) + study().kill_at_every(2, 2);
    assert!(count >= 30, "{count} points");
}

/// Exit code and standard error of a run.
fn said(at: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_lss")).args(arguments).current_dir(at).output().expect("lss runs");
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

#[test]
fn a_build_says_when_the_one_before_was_stopped_or_its_files_were_changed() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let build = ["build", "small.lss", "-o", "out"];
    write(at, "small.lss", LAYOUT);
    // The layout itself is warned of, too.
    let of_a_build = |text: &str| text.contains("last build") || text.contains("two builds");
    let is_quiet = || {
        let (code, text) = said(at, &build);
        assert!(code == Some(0) && !of_a_build(&text), "{text}");
    };
    is_quiet();
    // A whole set.
    is_quiet();
    write(at, "out/bom.csv", "mine");
    fs::remove_file(at.join("out/bom.json")).expect("removed");
    let (code, text) = said(at, &build);
    assert_eq!(code, Some(0));
    assert!(text.contains("bom.csv in out is not what the last build wrote there"), "{text}");
    assert!(text.contains("bom.json of the last build is gone from out"), "{text}");
    if !is_there("strace") || !traces() {
        return;
    }
    write(at, "small.lss", LAYOUT.replace("(16 m", "(17 m"));
    // The first rename places the manifest, the second and third two files.
    let inject = ["-f", "-qq", "-o", "/dev/null", "-e", "inject=?rename,?renameat,renameat2:signal=KILL:when=4"];
    let mut command = Command::new("strace");
    command.args(inject).arg(env!("CARGO_BIN_EXE_lss")).args(build).current_dir(at).stdout(Stdio::null());
    assert_eq!(command.status().expect("strace runs").signal(), Some(9));
    let (code, text) = said(at, &build);
    assert!(code == Some(0) && text.contains("out holds parts of two builds, as a build was stopped"), "{text}");
    is_quiet();
}

#[test]
fn a_link_is_formatted_within_its_project_and_refused_beyond() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let unformatted = LAYOUT.replace("  vertex", " vertex");
    for file in ["other/a.lss", "project/real/a.lss"] {
        write(at, file, &unformatted);
    }
    write(at, "project/lss.toml", "");
    std::os::unix::fs::symlink("real/a.lss", at.join("project/in.lss")).expect("a link");
    std::os::unix::fs::symlink("../other/a.lss", at.join("project/out.lss")).expect("a link");
    assert_eq!(said(at, &["fmt", "project/in.lss"]), (Some(0), String::new()));
    assert_eq!(fs::read_to_string(at.join("project/real/a.lss")).expect("a file"), LAYOUT);
    assert!(at.join("project/in.lss").is_symlink());
    let (code, text) = said(at, &["fmt", "project/out.lss"]);
    assert!(code == Some(2) && text.contains("it lies outside the project's root, `project`"), "{text}");
    assert_eq!(fs::read_to_string(at.join("other/a.lss")).expect("a file"), unformatted);
}
