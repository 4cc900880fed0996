//! Models outside that oscillate, that are written as a Python function or as an FMU, that are random or deaf to a
//! parameter; and the dry run. Without python3 (or gcc and FMPy for the FMUs, Octave for the function in MATLAB's language)
//! these say that they were skipped.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use lss::base::random::normal;
use lss::base::trig;
use lss::gap::outside::{Error, Outside, Settings};
use serde_json::Value;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Whether a line of Python runs; says so if not.
fn python(line: &str) -> bool {
    let mut command = Command::new("python3");
    command.args(["-c", line]).stdout(Stdio::null()).stderr(Stdio::null());
    let runs = command.status().is_ok_and(|status| status.success());
    if !runs {
        println!("skipped: python3 does not run `{line}`");
    }
    runs
}

fn lss(verb: &str, at: &Path, rest: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lss"));
    command.args(["gap", verb]).arg(at).args(rest).env("PYTHONPATH", root().join("python")).current_dir(root());
    command.env("LSS_MATLAB", "octave").output().expect("it runs")
}

/// What `lss gap diagnose` found, and what it said.
fn diagnosed(at: &Path, rest: &[&str]) -> (Value, String) {
    let out = at.join("out").display().to_string();
    let ran = lss("diagnose", at, &[rest, &["-o", &out]].concat());
    let said = String::from_utf8_lossy(&ran.stdout).into_owned() + &String::from_utf8_lossy(&ran.stderr);
    let found = fs::read(at.join("out/gap.json")).unwrap_or_else(|_| panic!("{said}"));
    (serde_json::from_slice(&found).expect("json"), said)
}

fn benchmark(case: &str) -> String {
    format!("python3 \"{}\" {case}", root().join("examples/outside/benchmark/models.py").display())
}

/// A drive of many lines, held at 600 Hz, into a Duffing oscillator: y'' = w²(u − y − cubic y³) − 2 d w y'. Integrated
/// with 16 midpoint steps a sample, where the model makes two by Runge and Kutta. Volts.
fn silverbox(cubic: f64, noise: f64, size: f64, seed: u64) -> (String, f64) {
    let (w, d, mut state) = (2.0 * trig::PI * 68.6, 0.05, seed);
    let phases: Vec<f64> = (0..60).map(|_| 10.0 * normal(&mut state)).collect();
    let (mut y, mut v, mut squares) = (0.0_f64, 0.0_f64, 0.0);
    let mut text = "time,drive,output\n".to_owned();
    for i in 0..1200 {
        let t = f64::from(i) / 600.0;
        let lines = phases.iter().enumerate();
        let lines = lines.map(|(k, phase)| trig::cos(2.0 * trig::PI * (2.0 + 3.0 * k as f64) * t + phase));
        let u = size * lines.sum::<f64>() / 30.0_f64.sqrt();
        writeln!(text, "{t},{u},{}", y + noise * normal(&mut state)).unwrap();
        squares += y * y / 1200.0;
        let rate = |y: f64, v: f64| w * w * (u - y - cubic * y * y * y) - 2.0 * d * w * v;
        let h = 1.0 / 600.0 / 16.0;
        for _ in 0..16 {
            let (ym, vm) = (y + 0.5 * h * v, v + 0.5 * h * rate(y, v));
            (y, v) = (y + h * vm, v + h * rate(ym, vm));
        }
    }
    (text, squares.sqrt())
}

/// A misfit that oscillates is no noise: the cubic spring is found, and the error of samples falls to the true noise.
#[test]
fn an_oscillating_misfit_is_no_noise() {
    if !python("pass") {
        return;
    }
    let at = tempfile::tempdir().expect("a folder");
    let mut list = "[channels]\noutput = \"V\"\n".to_owned();
    for (k, size) in [0.010, 0.015, 0.02].into_iter().enumerate() {
        let (text, moves) = silverbox(3.9, 0.0009, size, 40 + k as u64);
        println!("moves {moves} V");
        fs::write(at.path().join(format!("{k}.csv")), text).expect("written");
        writeln!(list, "[[run]]\nfile = \"{k}.csv\"").unwrap();
    }
    fs::write(at.path().join("campaign.toml"), list).expect("written");
    let (found, said) = diagnosed(at.path(), &["--model", &benchmark("silverbox"), "--no-sweep"]);
    assert_eq!(found["verdict"], "effect", "{said}");
    assert_eq!(found["with"][0], "cubic", "{said}");
    let cubic = found["effects"][0]["strength"]["cubic"]["value"].as_f64().unwrap();
    assert!((cubic - 3.9).abs() < 0.2, "{cubic}");
    let error = &found["outside"]["sample_error"]["output"];
    let number = |key: &str| error[key].as_f64().unwrap();
    assert!(number("before") > 0.002 && (number("after") / 0.0009 - 1.0).abs() < 0.1, "{error}");
    assert!((number("noise") / 0.0009 - 1.0).abs() < 0.1, "{error}");
    assert_eq!(error["compared"], "samples", "{error}");
    // Both integrators shift the frequency by a few parts in ten thousand.
    let nuisance = &found["outside"]["nuisances"]["1"]["frequency"];
    let number = |key: &str| nuisance[key].as_f64().unwrap();
    assert!((number("value") - 68.6).abs() < 0.1 && number("high") - number("low") < 0.2, "{nuisance}");
    assert!(said.contains("error of samples") && said.contains("nuisances as fitted"), "{said}");
    // Words of the machine at hand.
    let page = fs::read_to_string(at.path().join("out/gap.html")).expect("a page");
    let body = &page[page.find("<body").unwrap_or(0)..page.find("<noscript").unwrap_or(0)];
    for word in ["metre", "tension", " lap", "laps", "cart", "arc length", ">track<", "wheel"] {
        assert!(!body.contains(word) && !said.contains(word), "{word}: {said}");
    }
}

/// Without the cubic part and with noise that remembers, nothing is found.
#[test]
fn noise_that_remembers_is_no_gap() {
    if !python("pass") {
        return;
    }
    let at = tempfile::tempdir().expect("a folder");
    let mut list = "[channels]\noutput = \"V\"\n".to_owned();
    for (k, size) in [0.010, 0.015, 0.02].into_iter().enumerate() {
        let (text, _) = silverbox(0.0, 0.0, size, 50 + k as u64);
        let (mut state, mut slow) = (k as u64, 0.0);
        let mut lines = text.lines();
        let mut noisy = lines.next().unwrap().to_owned() + "\n";
        for line in lines {
            let (head, y) = line.rsplit_once(',').unwrap();
            slow = 0.8 * slow + 0.0006 * normal(&mut state);
            writeln!(noisy, "{head},{}", y.parse::<f64>().unwrap() + slow).unwrap();
        }
        fs::write(at.path().join(format!("{k}.csv")), noisy).expect("written");
        writeln!(list, "[[run]]\nfile = \"{k}.csv\"").unwrap();
    }
    fs::write(at.path().join("campaign.toml"), list).expect("written");
    let (found, said) = diagnosed(at.path(), &["--model", &benchmark("silverbox"), "--no-sweep"]);
    let none = found["none_probability"].as_f64().unwrap();
    assert!(found["verdict"] == "none" && none > 0.4, "{said}");
}

/// The oven of the examples as a function, and the dry run of it.
#[test]
fn a_python_function_is_a_model() {
    if !python("pass") {
        return;
    }
    let at = tempfile::tempdir().expect("a folder");
    for file in ["campaign.toml", "monday.csv", "tuesday.csv", "friday.csv"] {
        fs::copy(root().join("examples/outside").join(file), at.path().join(file)).expect("copied");
    }
    let model = format!("python3 -m lss_model \"{}\"", root().join("examples/outside/oven_function.py").display());
    let dry = lss("check", at.path(), &["--model", &model, "--timeout", "60", "--jobs", "2"]);
    let (said, warned) = (String::from_utf8_lossy(&dry.stdout), String::from_utf8_lossy(&dry.stderr));
    assert!(dry.status.success() && said.contains("a diagnosis asks about"), "{said}\n{warned}");
    assert!(said.contains("radiation.area") && said.contains("monday"), "{said}");
    assert!(warned.contains("sensor_idle with offset 1 K changes nothing"), "{warned}");
    let (found, said) = diagnosed(at.path(), &["--model", &model, "--no-sweep"]);
    assert_eq!(found["with"][0], "radiation", "{said}");
    let remarks = found["outside"]["remarks"].to_string();
    assert!(remarks.contains("whatever is asked of sensor_idle.offset"), "{remarks}");
}

/// A model that answers differently to the same question, by less than the noise and by more.
#[test]
fn a_random_model_is_noticed() {
    if !python("pass") {
        return;
    }
    let at = tempfile::tempdir().expect("a folder");
    let mut data = "time,x\n".to_owned();
    let mut state = 3;
    (0..400).for_each(|i| writeln!(data, "{},{}", 0.5 * f64::from(i), 0.1 * normal(&mut state)).unwrap());
    fs::write(at.path().join("a.csv"), &data).expect("written");
    fs::write(at.path().join("b.csv"), &data).expect("written");
    let list = "[channels]\nx = \"m\"\n[[run]]\nfile = \"a.csv\"\n[[run]]\nfile = \"b.csv\"\n";
    fs::write(at.path().join("campaign.toml"), list).expect("written");
    let script = at.path().join("chance.py");
    let text = format!(
        "import random, sys\nsys.path.insert(0, {:?})\nfrom lss_model import effect, serve\nsize = float(sys.argv[1])\n\
         def simulate(inputs, p):\n    \
         return {{'x': [size * random.gauss(0, 1) + p['rise.rise'] * t for t in inputs['time']]}}\n\
         serve(simulate, [effect('rise', rise=(0.01, -1, 1, 'm/s'))])\n",
        root().join("python").display().to_string()
    );
    fs::write(&script, text).expect("written");
    let open = |size: &str| {
        let command = format!("python3 \"{}\" {size}", script.display());
        Outside::open(&command, at.path(), &Settings::default())
    };
    let told = open("0.5").err().expect("an error");
    assert!(matches!(told, Error::InRun { .. }) && told.to_string().contains("asked the same twice"), "{told}");
    assert!(told.help().contains("seed"), "{}", told.help());
    let model = open("0.01").expect("a model");
    let found = lss::gap::diagnose(&model, &Settings::default().constants, &mut |_| {});
    let remarks = model.told(&found).remarks.join(" ");
    assert!(remarks.contains("answers differently (x by 0.01"), "{remarks}");
}

/// A pendulum that MuJoCo simulates without its dry friction; all runs share its length and its damping, which would
/// hide the friction if each run had another. Measured: q'' = −(g/L)
/// sin q − (c q' + friction)/(m L²), by midpoint steps of 0.5 ms.
#[test]
fn a_model_in_mujoco() {
    if !python("import mujoco") {
        return;
    }
    let at = tempfile::tempdir().expect("a folder");
    let mut list = "[channels]\nangle = \"rad\"\n".to_owned();
    for (k, begin) in [0.8, 1.1, 1.4].into_iter().enumerate() {
        let (mut q, mut v, mut state) = (begin, 0.0_f64, 70 + k as u64);
        let mut text = "time,angle\n".to_owned();
        let rate = |q: f64, v: f64| {
            let torque = 0.004 * v + 0.01 * (v / 0.0005).clamp(-1.0, 1.0);
            -9.81 / 0.49 * trig::sin(q) - torque / (0.4 * 0.49 * 0.49)
        };
        for i in 0..500 {
            writeln!(text, "{},{}", 0.02 * f64::from(i), q + 0.003 * normal(&mut state)).unwrap();
            for _ in 0..40 {
                let (qm, vm) = (q + 0.00025 * v, v + 0.00025 * rate(q, v));
                (q, v) = (q + 0.0005 * vm, v + 0.0005 * rate(qm, vm));
            }
        }
        fs::write(at.path().join(format!("{k}.csv")), text).expect("written");
        writeln!(list, "[[run]]\nfile = \"{k}.csv\"\nbegin = {begin}").unwrap();
    }
    fs::write(at.path().join("campaign.toml"), list).expect("written");
    let model = format!("python3 -m lss_model \"{}\"", root().join("examples/outside/mujoco_pendulum.py").display());
    let (found, said) = diagnosed(at.path(), &["--model", &model, "--no-sweep"]);
    assert_eq!(found["with"][0], "dry_friction", "{said}");
    let torque = found["effects"][0]["strength"]["torque"]["value"].as_f64().unwrap();
    assert!((torque - 0.01).abs() < 0.0015, "{torque}");
    let length = &found["outside"]["nuisances"]["all runs"]["length"];
    assert!((length["value"].as_f64().unwrap() - 0.49).abs() < 0.003, "{length}");
    // With a damping of each run's own it is hidden, and said to be.
    let alone = fs::read_to_string(root().join("examples/outside/mujoco_pendulum.py")).expect("the example");
    let alone = alone.replace(", shared=True", "");
    fs::write(at.path().join("alone.py"), alone).expect("written");
    let model = format!("python3 -m lss_model \"{}\"", at.path().join("alone.py").display());
    let (found, said) = diagnosed(at.path(), &["--model", &model, "--no-sweep"]);
    let remarks = found["outside"]["remarks"].to_string();
    assert!(remarks.contains("damping differs between the runs by more than its noise"), "{said}");
}

/// A pendulum that swings wide for 20 s, let go at `begin`, and a model whose nominal length is 5 % off: after some swings
/// the phases differ by more than half a period, from where a fit to the whole run has no way downhill.
const LONG_SWINGS: &str = r#"
import math
from lss_model import effect, nuisance

NUISANCES = [nuisance("length", 0.21, 0.16, 0.26, "m", shared=SHARED), nuisance("viscous", 0.05, 0, 0.5, "1/s", shared=SHARED)]
EFFECTS = [effect("sensor_offset", sensor=True, offset=(0.01, -0.2, 0.2, "rad"))]
ACCURACY = {"angle": 0.005}

def simulate(inputs, p):
    ratio, viscous, q, v, said = 9.81 / p["length"], p["viscous"], p["begin"], 0.0, []
    rate = lambda q, v: -ratio * math.sin(q) - viscous * v
    for _ in inputs["time"]:
        said.append(q + p["sensor_offset.offset"])
        for _ in range(4):
            qm, vm = q + 0.0025 * v, v + 0.0025 * rate(q, v)
            q, v = q + 0.005 * vm, v + 0.005 * rate(qm, vm)
    return {"angle": said}
"#;

/// Fits that went astray are tried on growing stretches: the right length is found, of each run and of all together.
#[test]
fn long_swings_are_followed_from_their_beginning() {
    if !python("pass") {
        return;
    }
    let at = tempfile::tempdir().expect("a folder");
    let mut list = "[channels]\nangle = \"rad\"\n".to_owned();
    for (k, begin) in [2.6, -2.3, 2.0].into_iter().enumerate() {
        let (mut q, mut v, mut state) = (begin, 0.0_f64, 30 + k as u64);
        let rate = |q: f64, v: f64| -9.81 / 0.2 * trig::sin(q) - 0.08 * v;
        let mut text = "time,angle\n".to_owned();
        for i in 0..1000 {
            writeln!(text, "{},{}", 0.02 * f64::from(i), q + 0.004 * normal(&mut state)).unwrap();
            for _ in 0..16 {
                let (qm, vm) = (q + 0.000625 * v, v + 0.000625 * rate(q, v));
                (q, v) = (q + 0.00125 * vm, v + 0.00125 * rate(qm, vm));
            }
        }
        fs::write(at.path().join(format!("{k}.csv")), text).expect("written");
        writeln!(list, "[[run]]\nfile = \"{k}.csv\"\nbegin = {begin}").unwrap();
    }
    fs::write(at.path().join("campaign.toml"), list).expect("written");
    for (shared, run) in [("False", "0"), ("True", "all runs")] {
        fs::write(at.path().join("swings.py"), LONG_SWINGS.replace("SHARED", shared)).expect("written");
        let model = format!("python3 -m lss_model \"{}\"", at.path().join("swings.py").display());
        let (found, said) = diagnosed(at.path(), &["--model", &model, "--no-sweep"]);
        let fitted = &found["outside"]["nuisances"][run];
        let length = fitted["length"]["value"].as_f64().unwrap_or_else(|| panic!("{said}"));
        assert!((length - 0.2).abs() < 0.001, "shared {shared}: {fitted} {said}");
        assert_eq!(found["verdict"], "none", "shared {shared}: {said}");
    }
}

/// The oven in MATLAB's language, run by Octave: it answers what the Python function does, an error is told in Octave's
/// words, and the radiation is found.
#[test]
fn a_function_in_matlab_by_octave() {
    let octave = Command::new("octave-cli").arg("--version").stdout(Stdio::null()).status().is_ok_and(|s| s.success());
    if !octave || !python("pass") {
        println!("skipped: octave-cli is not installed");
        return;
    }
    let compare = "import sys; sys.path[:0] = ['python', 'examples/outside']
import lss_model, oven_function, oven_matlab
inputs = lss_model.read('examples/outside/monday.csv')
p = {'capacity': 8000, 'loss': 4.5, 'radiation.area': 0.03, 'door_leak.loss': 0.2, 'sensor_offset.offset': 0.1, 'start': 20.0}
own, other = oven_function.simulate(inputs, p)['temperature'], oven_matlab.simulate(inputs, p)['temperature']
assert len(own) == len(other) == 900 and max(own) > 100, (len(own), len(other), max(own))
assert max(abs(x - y) for x, y in zip(own, other)) < 1e-9
try:
    oven_matlab.simulate(inputs, {'start': 20.0})
    assert False
except RuntimeError as why:
    assert 'sensor_offset_offset' in str(why) or 'undefined' in str(why), why
assert oven_matlab.simulate(inputs, p)['temperature'] == other";
    let mut asked = Command::new("python3");
    asked.args(["-c", compare]).env("LSS_MATLAB", "octave").current_dir(root());
    let ran = asked.output().expect("it runs");
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    let at = tempfile::tempdir().expect("a folder");
    let oven = root().join("examples/outside");
    for file in ["monday.csv", "tuesday.csv", "friday.csv", "campaign.toml"] {
        fs::copy(oven.join(file), at.path().join(file)).expect("copied");
    }
    let model = format!("python3 -m lss_model \"{}\"", oven.join("oven_matlab.py").display());
    let (found, said) = diagnosed(at.path(), &["--model", &model, "--no-sweep"]);
    assert_eq!(found["with"][0], "radiation", "{said}");
    let area = found["effects"][0]["strength"]["area"]["value"].as_f64().unwrap();
    assert!((area - 0.05).abs() < 0.005, "{area}");
}

/// A mass on a spring with dry friction as a unit that gcc compiles, in the folder with runs of the same equation; nothing
/// where there is no compiler or no FMPy, and that is said.
fn with_unit(version: &str) -> Option<tempfile::TempDir> {
    let gcc = Command::new("gcc").arg("--version").stdout(Stdio::null()).status().is_ok_and(|s| s.success());
    if !gcc || !cfg!(all(target_os = "linux", target_arch = "x86_64")) || !python("import fmpy") {
        println!("skipped: it takes gcc on Linux, and FMPy");
        return None;
    }
    let at = tempfile::tempdir().expect("a folder");
    let mut make = Command::new("python3");
    make.arg(root().join("tests/chains/fmu/make.py")).arg(at.path()).arg(version);
    assert!(make.status().expect("python runs").success());
    for (k, size) in [0.6, 1.0, 1.5].into_iter().enumerate() {
        let (mut x, mut v, mut state) = (0.0_f64, 0.0_f64, k as u64);
        let mut text = "time,force,position\n".to_owned();
        for i in 0..800 {
            let t = 0.02 * f64::from(i);
            let force = size * (trig::sin(7.0 * t) + trig::sin(9.6 * t + 1.0) + trig::sin(12.3 * t));
            writeln!(text, "{t},{force},{}", x + 0.0008 * normal(&mut state)).unwrap();
            for _ in 0..40 {
                let dry = 0.25 * (v / 0.0005).clamp(-1.0, 1.0);
                v += 0.0005 * (force - 96.0 * x - 0.7 * v - dry) / 1.08;
                x += 0.0005 * v;
            }
        }
        fs::write(at.path().join(format!("run{}.csv", k + 1)), text).expect("written");
    }
    Some(at)
}

/// The dry friction is found by a unit of FMI 2.0 and by one of FMI 3.0, whose friction is a Float32.
#[test]
fn an_fmu_is_a_model() {
    for version in ["2", "3"] {
        let Some(at) = with_unit(version) else { return };
        let fmu = at.path().join("unit.fmu").display().to_string();
        let (found, said) = diagnosed(at.path(), &["--fmu", &fmu, "--no-sweep"]);
        assert_eq!(found["verdict"], "effect", "FMI {version}: {said}");
        assert_eq!(found["with"][0], "coulomb", "FMI {version}: {said}");
        let force = found["effects"][0]["strength"]["deviation"]["value"].as_f64().unwrap();
        println!("FMI {version}: coulomb {force} N");
        assert!((force - 0.25).abs() < 0.03, "FMI {version}: {force}");
    }
}

/// What of a unit of FMI 3.0 cannot be varied or compared ends the diagnosis with a reason; an integer is a setting.
#[test]
fn types_of_a_unit_of_fmi_3() {
    let Some(at) = with_unit("3") else { return };
    let fmu = at.path().join("unit.fmu").display().to_string();
    let campaign = at.path().join("campaign.toml");
    let right = fs::read_to_string(&campaign).expect("the campaign");
    let said = |text: &str| {
        fs::write(&campaign, text).expect("written");
        let ran = lss("check", at.path(), &["--fmu", &fmu]);
        (
            ran.status.success(),
            String::from_utf8_lossy(&ran.stdout).into_owned() + &String::from_utf8_lossy(&ran.stderr),
        )
    };
    let effect = |name: &str| right.replace("parameter = \"cubic\"", &format!("parameter = \"{name}\""));
    let (runs, told) = said(&effect("masses"));
    assert!(!runs && told.contains("masses of") && told.contains("is an array (2)"), "{told}");
    let (runs, told) = said(&effect("substeps"));
    assert!(!runs && told.contains("is of type Int32; a nuisance or an effect is varied continuously"), "{told}");
    let set = |value: &str| right.replace("file = \"run1.csv\"", &format!("file = \"run1.csv\"\nsubsteps = {value}"));
    let (runs, told) = said(&set("2.5"));
    assert!(!runs && told.contains("substeps is of type Int32, but 2.5 was given"), "{told}");
    let (runs, told) = said(&set("4"));
    assert!(runs, "{told}");
    for k in 1..=3 {
        let run = at.path().join(format!("run{k}.csv"));
        let text = fs::read_to_string(&run).expect("a run");
        fs::write(run, text.replacen("position", "masses", 1)).expect("written");
    }
    let (runs, told) = said(&right.replace("position = \"m\"", "masses = \"kg\""));
    assert!(!runs && told.contains("masses of") && told.contains("is an array (2)"), "{told}");
}
