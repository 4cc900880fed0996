//! Models outside: what they may do wrong, and what becomes of them when they do it right. Without python3 these say
//! that they were skipped.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use lss::base::random::normal;
use lss::base::trig;
use lss::gap::outside::{Error, Outside, Settings};
use lss::gap::{Applied, CandidateId, Frame, Id, Request, RunId, Simulator};
use nalgebra::{DMatrix, DVector};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Whether there is Python; says so if not.
fn python() -> bool {
    let found = Command::new("python3").arg("--version").stdout(Stdio::null()).status().is_ok_and(|s| s.success());
    if !found {
        println!("skipped: python3 is not there");
    }
    found
}

fn command(model: &str) -> String {
    format!("python3 \"{}\"", root().join(model).display())
}

/// A model that does one thing wrong, which its first argument names. It writes its process into the file of its
/// second.
const WRONG: &str = r#"
import json, os, sys, time
mode = sys.argv[1]
open(sys.argv[2], "a").write(f"{os.getpid()}\n")
good = {"nuisances": [], "effects": [{"name": "a", "strengths": [{"name": "x", "trial": 1, "low": 0, "high": 2}]}]}
def say(x): print(x if isinstance(x, str) else json.dumps(x), flush=True)
for line in sys.stdin:
    asked = json.loads(line)
    if asked["request"] == "describe":
        if mode == "dies at once": sys.exit(3)
        if mode == "bytes": sys.stdout.buffer.write(b"\xff\n"); sys.stdout.flush(); continue
        if mode == "endless": sys.stdout.write("x" * (1 << 28)); sys.stdout.flush(); time.sleep(60)
        if mode == "no newline": sys.stdout.write("{"); sys.stdout.flush(); sys.exit(0)
        huge = {"name": "x", "trial": 1, "low": 0, "high": 1e308}
        wrong = {
            "prints": "Loading the model ...",
            "no effects": good | {"effects": []},
            "huge": good | {"effects": [{"name": "a", "strengths": [huge]}]},
        }
        say(wrong.get(mode, good))
        if mode == "chatty": say("done")
        continue
    t = [0.5 * i for i in range(100)]
    x = [0.0] * 100
    if mode == "dies later": os._exit(4)
    if mode == "sleeps": time.sleep(60)
    answers = {
        "refuses": {"error": "no licence for this run"},
        "nan": {"time": t, "channels": {"x": [float("nan")] * 100}},
        "short": {"time": t, "channels": {"x": x[:99]}},
        "ends early": {"time": t[:50], "channels": {"x": x[:50]}},
        "other channel": {"time": t, "channels": {"y": x}},
        "backwards": {"time": t[::-1], "channels": {"x": x}},
        "nothing": {"time": t, "channels": {"x": [None] * 100}},
    }
    say(answers.get(mode, {"time": t, "channels": {"x": x}}))
"#;

/// Every mistake has its words, ends in time, and leaves no process behind.
#[test]
fn what_a_model_does_wrong_is_told() {
    if !python() {
        return;
    }
    let at = tempfile::tempdir().expect("a folder");
    let mut data = "time,x,kind\n".to_owned();
    (0..100).for_each(|i| writeln!(data, "{},{},idle", 0.5 * f64::from(i), i % 7).expect("written"));
    fs::write(at.path().join("one.csv"), data).expect("written");
    fs::write(at.path().join("campaign.toml"), "[channels]\nx = \"m\"\n[[run]]\nfile = \"one.csv\"\n")
        .expect("written");
    let (script, log) = (at.path().join("wrong.py"), at.path().join("processes"));
    fs::write(&script, WRONG).expect("written");
    let cases = [
        ("dies at once", "the model ended instead of answering (exit status: 3)"),
        ("dies later", "the model ended instead of answering (exit status: 4)"),
        ("prints", "the model said `Loading the model ...`, which is no answer: expected value at line 1 column 1"),
        (
            "no effects",
            "the model's answer to `describe` is wrong: there are no effects to choose from\n  it said: {\"nui",
        ),
        ("bytes", "which is no answer: it is not text in UTF-8"),
        ("endless", "xxx...`, which is no answer: the line does not end"),
        ("huge", "the model's answer to `describe` is wrong: 1e308 is beyond ±1e30"),
        ("no newline", "the model said `{`, which is no answer"),
        ("chatty", "the model said `done`"),
        ("sleeps", "the model did not answer within 1 s and was stopped"),
        ("refuses", "the model refused: no licence for this run"),
        ("nan", "NaN, NaN"),
        (
            "short",
            "the model's answer to `simulate` is wrong: `x` has 99 samples where time has 100\n  it said: {\"time\"",
        ),
        ("ends early", "it covers 0 s to 24.5 s, but 0 s to 49.5 s were asked for"),
        ("other channel", "the channel `x` is missing"),
        ("backwards", "time has to increase, but 49.5 s comes before 49 s"),
        ("nothing", "one: nothing measured can be compared with what the model says"),
    ];
    for (mode, expected) in cases {
        let command = format!("python3 \"{}\" \"{mode}\" \"{}\"", script.display(), log.display());
        let timeout = Duration::from_secs(if mode == "sleeps" { 1 } else { 60 });
        let begin = Instant::now();
        let told = Outside::open(&command, at.path(), &Settings { timeout, parts: 1, ..Settings::default() });
        let told = told.err().unwrap_or_else(|| panic!("{mode}: no error"));
        assert!(told.to_string().contains(expected), "{mode}: {told}");
        assert!(!told.help().is_empty() && begin.elapsed() < Duration::from_secs(30), "{mode}");
        if mode == "nan" {
            assert!(told.help().contains("write null"), "{}", told.help());
        }
    }
    #[cfg(target_os = "linux")]
    for process in fs::read_to_string(&log).expect("processes").lines() {
        assert!(!Path::new("/proc").join(process).exists(), "process {process} is left");
    }
    let open = |command: &str| Outside::open(command, at.path(), &Settings::default()).err().expect("an error");
    assert!(matches!(open("no-such-program-9"), Error::Start { .. }));
    assert!(matches!(open("python3 '"), Error::Command(_)));
    fs::write(at.path().join("campaign.toml"), "[channels]\nz = \"m\"\n[[run]]\nfile = \"one.csv\"\n")
        .expect("written");
    let told = open("python3");
    assert!(told.to_string().ends_with("one.csv: there is no column `z`"), "{told}");
    assert!(told.help().ends_with("this file has x, kind"), "{}", told.help());
    fs::write(at.path().join("campaign.toml"), "layout = \"a.lss\"\n[[run]]\nfile = \"one.csv\"\n").expect("written");
    assert_eq!(open("python3"), Error::NoChannels);
}

/// An oven that is just as its model says, with noise; each power lasts for as long as it says. Solved exactly.
fn oven(noise: f64, seed: u64, powers: &[(usize, f64)]) -> String {
    let (capacity, loss, step) = (10_400.0, 4.3, 4.0);
    let (mut t, mut state, mut text) = (20.0, seed, "time,power,door,temperature\n".to_owned());
    let rows = powers.iter().flat_map(|&(count, power)| std::iter::repeat_n(power, count));
    for (i, power) in rows.enumerate() {
        writeln!(text, "{},{power},0,{}", step * i as f64, t + noise * normal(&mut state)).expect("written");
        let end = 20.0 + power / loss;
        t = end + (t - end) * trig::exp(-loss * step / capacity);
    }
    text
}

fn ovens() -> tempfile::TempDir {
    let at = tempfile::tempdir().expect("a folder");
    let mut list = "[channels]\ntemperature = \"°C\"\n".to_owned();
    for (name, seed, powers) in [("a", 1, [(400, 2500.0), (600, 700.0)]), ("b", 2, [(700, 1100.0), (500, 0.0)])] {
        fs::write(at.path().join(format!("{name}.csv")), oven(4.0, seed, &powers)).expect("written");
        write!(list, "[[run]]\nfile = \"{name}.csv\"\nstart = 20\n").expect("written");
    }
    fs::write(at.path().join("campaign.toml"), list).expect("written");
    at
}

/// Usable residuals over their deviations.
fn whitened(frame: &Frame, features: &[f64]) -> Vec<f64> {
    let pairs = frame.residual(features).into_iter().zip(&frame.laps.variance);
    pairs.map(|(r, v)| if r.is_finite() { r / v.sqrt() } else { 0.0 }).collect()
}

fn mean_square(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>() / x.len() as f64
}

#[test]
fn a_right_model_leaves_noise_and_its_slopes_are_its_own() {
    if !python() {
        return;
    }
    let at = ovens();
    let settings = Settings { threads: 3, ..Settings::default() };
    let outside = Outside::open(&command("examples/outside/model.py"), at.path(), &settings).expect("a model");
    assert_eq!(outside.frames().len(), 2);
    for (run, frame) in outside.frames().with_ids() {
        let found = outside.nuisances(run);
        assert!((found["capacity"] / 10_400.0 - 1.0).abs() < 0.01, "{found:?}");
        assert!((found["loss"] / 4.3 - 1.0).abs() < 0.02, "{found:?}");
        let left = mean_square(&whitened(frame, &frame.nominal));
        assert!((0.75..1.3).contains(&left), "{left}");
        let of =
            |s: &Vec<f64>| s.iter().zip(&frame.laps.variance).map(|(s, v)| s * s / v).sum::<f64>() / s.len() as f64;
        let repeatability = frame.laps.scatter.iter().map(of).sum::<f64>() / frame.laps.scatter.len() as f64;
        assert!((0.9..1.1).contains(&repeatability), "{repeatability}");
        assert!((60..=150).contains(&frame.labels.len()) && frame.labels.is_sorted());
        let stays = outside.simulate(run, &[0.0, 0.0], &[]).expect("features");
        assert_eq!(stays, frame.nominal);
        for k in 0..2 {
            let mut step = [0.0; 2];
            step[k] = 1e-3;
            let moved = outside.simulate(run, &step, &[]).expect("features");
            for (i, (a, b)) in moved.iter().zip(&frame.nominal).enumerate() {
                let slope = frame.slopes[(i, k)];
                assert!(((a - b) / 1e-3 - slope).abs() < 0.02 * frame.slopes.column(k).amax(), "{i} {k} {slope}");
            }
        }
    }
    let alone = Settings { threads: 1, ..Settings::default() };
    let other = Outside::open(&command("examples/outside/model.py"), at.path(), &alone).expect("a model");
    for (a, b) in outside.frames().iter().zip(other.frames()) {
        assert_eq!((&a.nominal, &a.laps, &a.slopes), (&b.nominal, &b.laps, &b.slopes));
    }
    let requests: Vec<Request> = (0..7)
        .map(|k| Request {
            run: RunId::new(k % 2),
            step: vec![0.01 * k as f64, 0.0],
            effects: vec![Applied { candidate: CandidateId::new(k % 5), strengths: vec![0.1] }],
        })
        .collect();
    let all = outside.simulate_all(&requests);
    assert!(all.iter().all(Option::is_some) && all == other.simulate_all(&requests));
    assert_eq!(outside.simulate(RunId::new(9), &[0.0, 0.0], &[]), None);
    let beyond = Applied { candidate: CandidateId::new(99), strengths: vec![1.0] };
    assert_eq!(outside.simulate(RunId::new(0), &[0.0, 0.0], &[beyond]), None);
}

/// A frame with its nuisances moved and an effect added: what is left, whitened, and how it answers the nuisances and,
/// last, the strength.
struct Fit<'a> {
    outside: &'a Outside,
    run: RunId,
    candidate: CandidateId,
    step: Vec<f64>,
}

impl Fit<'_> {
    fn left(&self, step: &[f64], strength: f64) -> DVector<f64> {
        let effects = [Applied { candidate: self.candidate, strengths: vec![strength] }];
        let effects = if strength == 0.0 { &[][..] } else { &effects };
        let frame = &self.outside.frames()[self.run];
        let request = Request { run: self.run, step: step.to_vec(), effects: effects.to_vec() };
        let features = self.outside.simulate_all(std::slice::from_ref(&request)).pop().flatten();
        let why = || format!("{:?}: {request:?}", self.outside.reason(&request));
        DVector::from_vec(whitened(frame, &features.unwrap_or_else(|| panic!("{}", why()))))
    }

    fn slopes(&self, strength: f64, left: &DVector<f64>) -> DMatrix<f64> {
        let difference = 0.1 * self.outside.candidates()[self.candidate].strengths[0].trial;
        let moved = |k: usize| {
            let mut step = self.step.clone();
            match step.get_mut(k) {
                Some(x) => *x += 1e-3,
                None => return (left - self.left(&step, strength + difference)) / difference,
            }
            (left - self.left(&step, strength)) / 1e-3
        };
        DMatrix::from_columns(&(0..=self.step.len()).map(moved).collect::<Vec<_>>())
    }

    /// Fits the nuisances; the mean square that is left, and how that answers the strength: what is left beside the
    /// nuisances, and what of the strength's slope is.
    fn fit(&mut self, strength: f64) -> (DVector<f64>, DVector<f64>) {
        for last in [false, false, true] {
            let left = self.left(&self.step, strength);
            let slopes = self.slopes(strength, &left);
            let n = self.step.len();
            let nuisances = slopes.columns(0, n).into_owned().svd(true, true);
            let solve = |x: &DVector<f64>| nuisances.solve(x, 1e-9).expect("both factors");
            let beside = |x: &DVector<f64>| x - slopes.columns(0, n) * solve(x);
            let by = solve(&left);
            if last || by.amax() < 1e-4 {
                return (beside(&left), beside(&slopes.column(n).into_owned()));
            }
            self.step.iter_mut().zip(by.iter()).for_each(|(x, by)| *x += by);
        }
        unreachable!("the last round returns")
    }
}

/// Share of the root mean square residual that an effect closes on frames that had no part in finding its strength,
/// nuisances fitted anew; and the mean strength.
fn closure(outside: &Outside, candidate: CandidateId) -> (f64, f64) {
    let frames = outside.frames();
    let bounds = &outside.candidates()[candidate].strengths[0];
    let new = |run: RunId| Fit { outside, run, candidate, step: vec![0.0; frames[run].prior.len()] };
    let (mut before, mut after, mut mean) = (0.0, 0.0, 0.0);
    for out in frames.ids() {
        let mut fits: Vec<Fit> = frames.ids().filter(|run| *run != out).map(new).collect();
        let mut strength = 0.0;
        for _ in 0..6 {
            let each: Vec<_> = fits.iter_mut().map(|f| f.fit(strength)).collect();
            let up: f64 = each.iter().map(|(left, slope)| left.dot(slope)).sum();
            let down: f64 = each.iter().map(|(_, slope)| slope.norm_squared()).sum();
            let next = (strength + up / down.max(1e-12)).clamp(bounds.low, bounds.high);
            let done = (next - strength).abs() < 1e-3 * next.abs();
            strength = next;
            if done {
                break;
            }
        }
        mean += strength / frames.len() as f64;
        before += new(out).fit(0.0).0.norm_squared();
        after += new(out).fit(strength).0.norm_squared();
    }
    (1.0 - (after / before).sqrt(), mean)
}

/// Closures by effect, the largest first.
fn ranking(outside: &Outside) -> Vec<(String, f64, f64)> {
    let each = outside.candidates().with_ids();
    let mut all: Vec<(String, f64, f64)> = each
        .map(|(k, c)| {
            let (closed, strength) = closure(outside, k);
            (c.effect.clone(), closed, strength)
        })
        .collect();
    all.sort_by(|a, b| b.1.total_cmp(&a.1));
    all
}

/// The example of the documentation: its oven radiates from 0.05 m².
#[test]
fn the_example_misses_radiation() {
    if !python() {
        return;
    }
    let model = command("examples/outside/model.py");
    let outside = Outside::open(&model, &root().join("examples/outside"), &Settings::default()).expect("a model");
    let all = ranking(&outside);
    println!("{all:?}");
    let (name, closed, strength) = &all[0];
    assert!(name == "radiation" && *closed > 0.5 && (strength - 0.05).abs() < 0.005, "{all:?}");
    assert!(all[1].1 < closed - 0.1, "{all:?}");
}

/// A real drive without its dry friction. A force balance fitted to one half of the data and by_signature on the other
/// says the same in other numbers: Coulomb's law closes 73 %, quadratic 45 %, cubic 37 %, a spring 2 %.
#[test]
fn a_real_drive_misses_dry_friction() {
    // Beside the repository, or beside the folder of its worktrees.
    let found = root().ancestors().skip(1).find_map(|at| fs::read(at.join("shared/data/emps/emps.csv")).ok());
    let Some(bytes) = found else {
        println!("skipped: ../shared/data/emps/emps.csv is not there");
        return;
    };
    if !python() {
        return;
    }
    let at = tempfile::tempdir().expect("a folder");
    fs::write(at.path().join("emps.csv"), bytes).expect("written");
    fs::copy(root().join("examples/emps/campaign.toml"), at.path().join("campaign.toml")).expect("copied");
    let outside = Outside::open(&command("examples/emps/model.py"), at.path(), &Settings::default()).expect("a model");
    assert_eq!(outside.frames().len(), 4);
    let all = ranking(&outside);
    println!("{all:?}");
    for (run, frame) in outside.frames().with_ids() {
        let left = mean_square(&whitened(frame, &frame.nominal));
        println!("{} {left} {:?} {} windows", frame.run, outside.nuisances(run), frame.labels.len());
    }
    let closed = |name: &str| all.iter().find(|(n, _, _)| n == name).map_or(f64::NAN, |(_, closed, _)| *closed);
    assert_eq!(all[0].0, "coulomb", "{all:?}");
    for (name, low, high) in
        [("coulomb", 0.65, 0.9), ("quadratic_drag", 0.3, 0.6), ("cubic_drag", 0.2, 0.55), ("spring", -0.1, 0.12)]
    {
        assert!((low..high).contains(&closed(name)), "{name}: {all:?}");
    }
    assert!((all[0].2 - 20.39).abs() < 1.5, "newtons, as published: {all:?}");
    assert!(all[1].1 < all[0].1 - 0.15, "{all:?}");
}

/// A model of a line that knows two more shapes; a file says which of its effects is the sine. It notes each simulation
/// with an effect in the file `count`, and kills `lss` once the number in the file `kill` is reached.
const CHANGING: &str = r#"
import json, math, os, signal, sys
here = os.path.dirname(os.path.abspath(__file__))
right = open(sys.argv[1] if len(sys.argv) > 1 else here + "/right").read()
def effect(name): return {"name": name, "strengths": [{"name": "x", "trial": 0.1, "low": -9, "high": 9}]}
for line in sys.stdin:
    asked = json.loads(line)
    if asked["request"] == "describe":
        print(json.dumps({"effects": [effect("a"), effect("b")], "accuracy": {"x": 0.01}}), flush=True)
        continue
    time = [0.5 * i for i in range(400)]
    said = [0.1 * t for t in time]
    for e in asked["effects"]:
        sine = e["name"] == right
        said = [x + e["strengths"]["x"] * (math.sin(0.1 * t) if sine else (t / 100) ** 2) for x, t in zip(said, time)]
    if asked["effects"]:
        open(here + "/count", "a").write(".")
        if os.path.exists(here + "/kill") and os.path.getsize(here + "/count") >= int(open(here + "/kill").read()):
            os.kill(os.getppid(), signal.SIGKILL)
    print(json.dumps({"time": time, "channels": {"x": said}}), flush=True)
"#;

/// Diagnoses with that model: effect named first, all of `gap.json`, and standard error.
#[cfg(target_os = "linux")]
fn diagnosed(at: &Path, named: bool, out: &str) -> Option<(String, Vec<u8>, String)> {
    let right = if named { " right" } else { "" };
    let output = Command::new(env!("CARGO_BIN_EXE_lss"))
        .args(["gap", "diagnose", "runs", "--model", &format!("python3 m.py{right}"), "-o", out, "--format", "json"])
        .current_dir(at)
        .output()
        .expect("lss runs");
    output.status.code()?;
    let printed: serde_json::Value = serde_json::from_slice(&output.stdout).expect("json");
    let stages = printed["cost"]["by_stage"].as_object().expect("stages");
    let counted: u64 = stages.values().map(|stage| stage["simulations"].as_u64().expect("a count")).sum();
    assert!(stages.contains_key("screening") && counted > 0);
    assert_eq!(printed["cost"]["simulations"].as_u64(), Some(counted));
    let json = fs::read(at.join(out).join("gap.json")).expect("a diagnosis");
    let found: serde_json::Value = serde_json::from_slice(&json).expect("json");
    let name = found["effects"][0]["name"].as_str().unwrap_or_default().to_owned();
    Some((name, json, String::from_utf8_lossy(&output.stderr).into_owned()))
}

/// What a stopped diagnosis kept is of the model that it asked, whatever that is made of.
#[cfg(target_os = "linux")]
#[test]
fn a_model_that_was_changed_answers_for_itself() {
    if !python() {
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let write = |name: &str, text: &str| fs::write(at.join(name), text).expect("written");
    fs::create_dir(at.join("runs")).expect("a folder");
    write("m.py", CHANGING);
    let mut list = "[channels]\nx = \"m\"\n".to_owned();
    let mut state = 7;
    for run in ["1", "2", "3"] {
        let mut text = "time,x\n".to_owned();
        for i in 0..400 {
            let t = 0.5 * f64::from(i);
            let x = 0.1 * t + 2.0 * trig::sin(0.1 * t) + 0.05 * normal(&mut state);
            writeln!(text, "{t},{x}").expect("written");
        }
        write(&format!("runs/{run}.csv"), &text);
        writeln!(list, "[[run]]\nfile = \"{run}.csv\"").expect("written");
    }
    write("runs/campaign.toml", &list);
    write("right", "a");
    let fresh = diagnosed(at, true, "fresh-a").expect("it ends");
    assert_eq!(fresh.0, "a");
    let count = fs::metadata(at.join("count")).expect("a file").len();
    write("right", "b");
    let expected = diagnosed(at, true, "fresh-b").expect("it ends");
    assert_eq!(expected.0, "b");
    for (named, said) in [(true, "nothing of it is used"), (false, "the model gives another answer")] {
        let stopped = |out: &str| {
            write("right", "a");
            write("count", "");
            write("kill", &(count - 1).to_string());
            assert_eq!(diagnosed(at, named, out), None, "it was killed");
            assert!(fs::metadata(at.join(out).join("gap.partial")).expect("work is kept").len() > 1000);
            fs::remove_file(at.join("kill")).expect("removed");
            write("count", "");
        };
        stopped("same");
        let same = diagnosed(at, named, "same").expect("it ends");
        assert!(same.1 == fresh.1 && same.2.contains("of its simulations are used again"), "{}", same.2);
        assert!(fs::metadata(at.join("count")).expect("a file").len() < count, "some was kept");
        stopped("other");
        write("right", "b");
        let other = diagnosed(at, named, "other").expect("it ends");
        assert_eq!(other.0, "b");
        assert!(other.1 == expected.1 && other.2.contains(said), "{}", other.2);
        for out in ["same", "other"] {
            fs::remove_dir_all(at.join(out)).expect("removed");
        }
    }
}
