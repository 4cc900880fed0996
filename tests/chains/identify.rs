//! `lss identify` as users run it, on a small track: truths are found again, work is kept, and what is broken is said.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use crate::result_page::ResultPage;
use assert_cmd::Command;
use lss::base::random::normal;
use lss::chain_input::Simulation;
use lss::dynamics::{Plan, Width};
use lss::effects::simulate;
use lss::identify::Parameter;
use lss::signal::{Channel, Run, csv};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::sync::OnceLock;
use tempfile::TempDir;

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

fn lss() -> Command {
    let mut command = Command::cargo_bin("lss").expect("the binary");
    command.current_dir(env!("CARGO_MANIFEST_DIR"));
    command
}

const TRUTH: [(Parameter, f64); 6] = [
    (Parameter::Speed, 2.02),
    (Parameter::Tension, 620.0),
    (Parameter::RollingResistance, 0.018),
    (Parameter::TriggerPosition, 0.17),
    (Parameter::RestitutionSteering, 0.45),
    (Parameter::RestitutionJointAxial, 0.7),
];

/// A run of three laps by a finer integration, without noise; its sidecar has the nominal values.
fn simulated(nominal: &Simulation) -> Run {
    let mut real = nominal.clone();
    for (p, value) in TRUTH {
        let offset = if p == Parameter::TriggerPosition { nominal.sensor.photocell_s_m } else { 0.0 };
        p.set(&mut real, offset + value);
    }
    let plan = Plan { laps: 3, step: Some(2.5e-4), front: 0.3, ..Plan::default() };
    let mut run = simulate(&real, &plan, Width::widest(), &mut |_| true).expect("a chain").run;
    run.sidecar.speed_setpoint = nominal.chain.speed_m_s;
    run.sidecar.tension_setpoint = Some(nominal.chain.tension_n);
    run.sidecar.trigger_position = nominal.sensor.photocell_s_m;
    run.sidecar.layout = "small.lss".into();
    run
}

/// The same with noise.
fn measured(simulated: &Run, seed: u64) -> Run {
    let mut run = simulated.clone();
    let mut state = seed;
    for (channel, samples) in &mut run.channels {
        if channel.is_force() {
            samples.iter_mut().for_each(|x| *x += normal(&mut state));
        }
    }
    run
}

fn keep(run: &Run, folder: &Path, name: &str) {
    fs::write(folder.join(format!("{name}.csv")), csv::write(run)).expect("written");
    fs::write(folder.join(format!("{name}.toml")), run.sidecar.write()).expect("written");
}

/// A campaign of one run.
struct Campaign {
    folder: TempDir,
    nominal: Simulation,
    /// What was measured, before noise: it is the same in all tests.
    simulated: Run,
}

fn campaign() -> &'static Campaign {
    static CAMPAIGN: OnceLock<Campaign> = OnceLock::new();
    CAMPAIGN.get_or_init(|| {
        let folder = tempfile::tempdir().expect("a folder");
        fs::write(folder.path().join("small.lss"), LAYOUT).expect("written");
        let built = tempfile::tempdir().expect("a folder");
        lss().arg("build").arg(folder.path().join("small.lss")).arg("-o").arg(built.path()).assert().success();
        let text = fs::read(built.path().join("simulation.json")).expect("an input");
        let nominal: Simulation = serde_json::from_slice(&text).expect("an input");
        let simulated = simulated(&nominal);
        keep(&measured(&simulated, 5), folder.path(), "run-01");
        Campaign { folder, nominal, simulated }
    })
}

fn json(output: &[u8]) -> Vec<Value> {
    let text = String::from_utf8_lossy(output);
    text.lines().map(|line| serde_json::from_str(line).expect("an object a line")).collect()
}

#[test]
fn truths_are_found_again_in_every_law_and_work_is_kept() {
    let Campaign { folder, nominal, .. } = campaign();
    let out = tempfile::tempdir().expect("a folder");
    let identify = || {
        let mut command = lss();
        command.args(["identify", "--law", "all", "--format", "json", "-o"]).arg(out.path()).arg(folder.path());
        command.assert().success().get_output().stdout.clone()
    };
    let first = identify();
    let laws = json(&first);
    // The model that made the run fits it.
    let goodness = &laws[0]["runs"]["run-01"]["goodness"]["limit"];
    assert!(laws[0]["objective"].as_f64() < goodness["objective"].as_f64(), "{goodness}");
    let (_, said) = told(&["--law", "all"], folder.path(), out.path());
    assert!(!said.contains("herbert_mcwhannell: the model does not fit"), "{said}");
    assert_eq!(laws.len(), 8);
    assert_eq!(laws[0]["law"], "herbert_mcwhannell");
    for law in &laws {
        let run = &law["runs"]["run-01"];
        // As near as two laps are, where no bound was met and the law is of the same kind.
        let near = law["law"] == "herbert_mcwhannell" || run["carried_from"].is_string();
        let objective = law["objective"].as_f64().expect("a number");
        assert!(objective > 0.2 && (objective < 3.0 || !near), "{}: {objective}", law["law"]);
        assert_eq!(run["parameters"].as_object().map(|p| p.len()), Some(10));
        assert_eq!(run["nrmsd"].as_object().map(|p| p.len()), Some(7));
    }
    let parameters = &laws[0]["runs"]["run-01"]["parameters"];
    for (p, value) in TRUTH {
        let e = &parameters[p.name()];
        let [found, low, high] = ["value", "low", "high"].map(|k| e[k].as_f64().expect("a number"));
        let truth = value + if p == Parameter::TriggerPosition { nominal.sensor.photocell_s_m } else { 0.0 };
        assert!(low <= found && found <= high, "{}: {e}", p.name());
        // Near, and not by an interval that holds everything.
        let near = match p {
            Parameter::Speed => 0.002,
            Parameter::Tension => 6.0,
            Parameter::RollingResistance => 0.001,
            Parameter::TriggerPosition => 0.02,
            // Over eight draws of the noise it is off by 0.03 at most.
            Parameter::RestitutionSteering => 0.1,
            // Over the same draws it is off by 0.1 in the root mean square: in one of eight its slopes are lost in
            // chaos, and then its interval is wide.
            _ => 0.3,
        };
        assert!((found - truth).abs() < near, "{}: {e}, true {truth}", p.name());
    }
    // The laws are one in other coordinates.
    let damping = |law: &Value| law["runs"]["run-01"]["damping"]["restitution_steering"].as_f64().expect("χ");
    for law in laws.iter().filter(|l| l["law"] != "kelvin_voigt" && l["runs"]["run-01"]["carried_from"].is_string()) {
        assert!((damping(law) - damping(&laws[0])).abs() < 1e-6, "{}", law["law"]);
    }
    // What is kept is not made again, nor different.
    let fits = out.path().join("fits/herbert_mcwhannell/run-01.json");
    let (before, kept) =
        (fs::metadata(&fits).expect("kept").modified().expect("a time"), fs::read(&fits).expect("kept"));
    assert_eq!(identify(), first);
    assert_eq!(fs::metadata(&fits).expect("kept").modified().expect("a time"), before);
    // A torn file is made again, the same.
    fs::write(&fits, &kept[..kept.len() / 2]).expect("torn");
    assert_eq!(identify(), first);
    assert_eq!(fs::read(&fits).expect("made"), kept);
    // The fitted layout is a layout, and simulates with what was found.
    let fitted = out.path().join("small-fitted.lss");
    lss().arg("check").arg(&fitted).assert().success();
    let built = tempfile::tempdir().expect("a folder");
    lss().arg("build").arg(&fitted).args(["--layout", "small_fitted", "-o"]).arg(built.path()).assert().success();
    let read =
        |path: &Path| -> Simulation { serde_json::from_slice(&fs::read(path).expect("an input")).expect("an input") };
    let (a, b) = (read(&built.path().join("simulation.json")), read(&out.path().join("small-fitted.json")));
    for p in Parameter::ALL {
        assert!((p.get(&a) - p.get(&b)).abs() < 1e-9 * p.get(&b).abs().max(1.0), "{p}: {} {}", p.get(&a), p.get(&b));
    }
    let at = out.path().join("identification.html");
    let page = fs::read_to_string(&at).expect("a page");
    assert!(page.contains("one law in other coordinates") && !written(&page).contains("NaN"));
    if let Some(browser) = ResultPage::start() {
        browser.hold(&at);
        // Curves of all seven forces, and a plan that has their cursor.
        assert_eq!(browser.number("page.curves.size"), 7.0);
        browser.ask("page.links.get('track').set(3)");
        assert!(browser.ask("page.stage.where.textContent").as_str().expect("text").starts_with("s = 3.00 m"));
    }
}

#[test]
fn what_is_not_free_keeps_its_value_and_what_is_shared_is_one_for_all() {
    let Campaign { folder, simulated, .. } = campaign();
    let two = tempfile::tempdir().expect("a folder");
    fs::copy(folder.path().join("small.lss"), two.path().join("small.lss")).expect("copied");
    for (name, seed) in [("run-01", 5), ("run-02", 6)] {
        keep(&measured(simulated, seed), two.path(), name);
    }
    let out = tempfile::tempdir().expect("a folder");
    let free = "speed,tension,rolling_resistance,trigger_position";
    let mut command = lss();
    command.args(["identify", "--free", free, "--share", "rolling_resistance", "--format", "json", "-o"]);
    let stdout = command.arg(out.path()).arg(two.path()).assert().success().get_output().stdout.clone();
    let law = &json(&stdout)[0];
    let shared = &law["shared"]["rolling_resistance"];
    for run in ["run-01", "run-02"] {
        let parameters = &law["runs"][run]["parameters"];
        assert_eq!(parameters["rolling_resistance"]["value"], shared["value"]);
        assert_eq!(parameters["k_p"]["value"], 400.0);
        assert_eq!(parameters["k_p"]["fitted"], false);
        assert_eq!(parameters["restitution_steering"]["value"], 0.6);
    }
    let value = shared["value"].as_f64().expect("a number");
    assert!((value - 0.018).abs() < 0.001, "{shared}");
    let (code, said) = told(&["--free", "speed", "--share", "tension"], two.path(), out.path());
    assert_eq!(code, Some(2));
    assert!(said.contains("tension cannot be shared, as it is not fitted"), "{said}");
}

#[test]
fn exchanged_sensors_do_not_lead_the_fit_astray() {
    let Campaign { folder, nominal, simulated } = campaign();
    let other = tempfile::tempdir().expect("a folder");
    fs::copy(folder.path().join("small.lss"), other.path().join("small.lss")).expect("copied");
    let mut run = measured(simulated, 5);
    let [one, two] = [Channel::RunRight, Channel::JointXi].map(|c| run.channels.remove(&c).expect("samples"));
    run.channels.extend([(Channel::JointXi, one), (Channel::RunRight, two)]);
    keep(&run, other.path(), "run-01");
    let out = tempfile::tempdir().expect("a folder");
    let mut command = lss();
    command.args(["identify", "--free", "speed,tension,rolling_resistance,trigger_position", "--format", "json", "-o"]);
    let stdout = command.arg(out.path()).arg(other.path()).assert().success().get_output().stdout.clone();
    let parameters = &json(&stdout)[0]["runs"]["run-01"]["parameters"];
    // What joint_xi said of the tension is in another channel: the wheels tell it still.
    for (name, truth, near) in
        [("tension", 620.0, 30.0), ("trigger_position", nominal.sensor.photocell_s_m + 0.17, 0.05)]
    {
        let found = parameters[name]["value"].as_f64().expect("a number");
        assert!((found - truth).abs() < near, "{name}: {}", parameters[name]);
    }
}

/// The words of ticks in each picture of a page that has an axis.
fn tick_labels(page: &str) -> Vec<Vec<&str>> {
    let axes =
        written(page).split("row-ticks\">").skip(1).map(|axis| axis.split("row-value").next().unwrap_or_default());
    axes.map(|axis| {
        let texts = axis.split("<span").skip(1).filter(|text| text.contains("left:"));
        texts.map(|text| text.split('>').nth(1).unwrap_or_default().split('<').next().unwrap_or_default()).collect()
    })
    .collect()
}

/// The page as far as words and pictures stand in it, without scripts.
fn written(page: &str) -> &str {
    page.split("<noscript").next().unwrap_or_default()
}

/// Force that is measured on a tenth of the lap and that no parameter makes, N.
const BUMP: f64 = 40.0;

#[test]
fn a_bad_fit_is_told_where_it_is_and_set_points_are_not_mixed() {
    let Campaign { folder, nominal, simulated } = campaign();
    let two = tempfile::tempdir().expect("a folder");
    fs::copy(folder.path().join("small.lss"), two.path().join("small.lss")).expect("copied");
    keep(&measured(simulated, 5), two.path(), "run-01");
    let mut off = measured(simulated, 6);
    let lap = nominal.chain.track_length_m;
    let place = lss::signal::position::position(&off, lap).expect("a place");
    let joint = off.channels.get_mut(&Channel::JointZeta).expect("samples");
    for (i, x) in joint.iter_mut().enumerate() {
        let s = place.on_track(i).expect("a sample");
        *x += if (0.5 * lap..0.6 * lap).contains(&s) { BUMP } else { 0.0 };
    }
    keep(&off, two.path(), "run-02");
    let list = "[[run]]\nfile = \"run-01.csv\"\nspeed = 2\n\n[[run]]\nfile = \"run-02.csv\"\nspeed = 2.1\n";
    fs::write(two.path().join("campaign.toml"), list).expect("written");
    let out = tempfile::tempdir().expect("a folder");
    let (code, said) = told(&["--free", "speed,tension,rolling_resistance,trigger_position"], two.path(), out.path());
    assert_eq!(code, Some(0), "{said}");
    // The good run is none to warn of; a line a minute says that it was fitted, on a machine that takes so long.
    assert!(said.contains("warning: run-02") && !said.contains("warning: run-01"), "{said}");
    for part in [
        "run-02, herbert_mcwhannell: the model does not fit: the objective is",
        "what: means along the track of joint_zeta",
        "lss gap diagnose",
    ] {
        assert!(said.contains(part), "{part} is not in\n{said}");
    }
    let read = |name: &str| fs::read_to_string(out.path().join(name)).unwrap_or_else(|_| panic!("{name} is not there"));
    let study: Value = serde_json::from_str(&read("identification.json")).expect("a study");
    let law = &study["laws"]["herbert_mcwhannell"];
    assert_eq!(law["warnings"].as_array().map(Vec::len), Some(1));
    let report: Value = serde_json::from_str(&read("herbert_mcwhannell.json")).expect("a law");
    // The first stretch is the bump's, to two cells.
    let stretch = &report["runs"]["run-02"]["goodness"]["stretches"][0];
    assert_eq!(stretch["channel"], "joint_zeta", "{stretch}");
    let ends = ["from_m", "to_m"].map(|end| stretch[end].as_f64().expect("a place"));
    assert!((ends[0] - 0.5 * lap).abs() < 5.0 && (ends[1] - 0.6 * lap).abs() < 5.0, "{stretch} of {lap} m");
    // A group's median is its own run's value.
    let groups = law["groups"].as_array().expect("groups");
    assert_eq!(groups.len(), 2);
    for (group, (run, speed)) in groups.iter().zip([("run-01", 2.0), ("run-02", 2.1)]) {
        assert_eq!((&group["runs"][0], group["speed"].as_f64()), (&Value::from(run), Some(speed)));
        let own = &report["runs"][run]["parameters"]["tension"]["value"];
        assert_eq!(&group["parameters"]["tension"]["median"], own);
    }
    let fitted = |speed: &str| read(&format!("small-{speed}mps-{}N-fitted.lss", nominal.chain.tension_n));
    let (good, bad) = (fitted("2"), fitted("2.1"));
    assert!(!good.contains("WARNING"), "{good}");
    let head: Vec<&str> = bad.lines().take(3).collect();
    assert!(head[1].starts_with("// WARNING: the model does not fit this run: the objective of run-02 is"), "{head:?}");
    assert!(head[2].contains("lss gap diagnose"), "{head:?}");
    let page = read("identification.html");
    assert!(
        page.contains("the model does not fit 1 of them")
            && page.contains("class=\"warning\"")
            && !written(&page).contains("NaN")
    );
    // Bars of both runs for each of four fitted parameters, and seven forces of each run.
    assert_eq!(page.matches("class=\"bar\"").count(), 2 * 4);
    assert_eq!(page.matches("\"name\":\"measured\"").count(), 14);
    assert!(page.contains("\"colour\":\"off\""));
    for labels in tick_labels(&page) {
        let mut different = labels.clone();
        different.dedup();
        assert_eq!(different, labels);
        assert!(labels.len() > 1, "{labels:?}");
    }
    lss()
        .arg("check")
        .arg(out.path().join(format!("small-2mps-{}N-fitted.lss", nominal.chain.tension_n)))
        .assert()
        .success();
}

/// Exit code and standard error.
fn told(more: &[&str], what: &Path, out: &Path) -> (Option<i32>, String) {
    let output = lss().arg("identify").args(more).arg("-o").arg(out).arg(what).output().expect("runs");
    (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
}

#[test]
fn what_runs_can_tell_is_said_before_a_fit() {
    let Campaign { folder, .. } = campaign();
    let out = tempfile::tempdir().expect("a folder");
    let mut command = lss();
    command.args(["identify", "--identifiability", "-o"]).arg(out.path()).arg(folder.path());
    let stdout = command.assert().success().get_output().stdout.clone();
    let text = String::from_utf8_lossy(&stdout).into_owned();
    assert!(text.contains("speed                     would be known to 0.00"), "{text}");
    assert!(text.contains("almost nothing of"), "{text}");
    assert!(fs::read_dir(out.path()).expect("a folder").next().is_none(), "nothing was fitted, nothing is written");
}

#[test]
fn broken_campaigns_are_told_with_a_way_out() {
    let Campaign { folder, simulated, .. } = campaign();
    let broken = tempfile::tempdir().expect("a folder");
    let path = |name: &str| broken.path().join(name);
    let expect = |what: &Path, more: &[&str], code: i32, parts: &[&str]| {
        let (found, said) = told(more, what, &path("out"));
        assert_eq!(found, Some(code), "{said}");
        parts.iter().for_each(|part| assert!(said.contains(part), "{part} is not in\n{said}"));
    };
    expect(&path("nowhere"), &[], 2, &["nowhere"]);
    keep(&measured(simulated, 5), broken.path(), "run-01");
    expect(broken.path(), &[], 1, &["small.lss is not there\n  help: give it with --layout", "no run is left to fit"]);
    let text = fs::read_to_string(path("run-01.csv")).expect("a run");
    let mut torn: Vec<&str> = text.lines().take(40).collect();
    torn.swap(20, 21);
    fs::write(path("run-01.csv"), torn.join("\n")).expect("written");
    fs::copy(folder.path().join("small.lss"), path("small.lss")).expect("copied");
    expect(broken.path(), &[], 1, &["row 22, `time`", "no run is left to fit"]);
    // No trigger: said of this run.
    let mut silent = measured(simulated, 5);
    silent.channels.remove(&lss::signal::Channel::Trigger);
    keep(&silent, broken.path(), "run-01");
    expect(broken.path(), &[], 1, &["the trigger never rises, so no sample has a place"]);
    // In kilonewtons: nothing of it can be compared. The sign of one channel: the others can.
    let mut kilo = measured(simulated, 5);
    for channel in lss::signal::Channel::FORCES {
        kilo.channels.get_mut(&channel).expect("a force").iter_mut().for_each(|x| *x /= 1000.0);
    }
    keep(&kilo, broken.path(), "run-01");
    expect(broken.path(), &[], 1, &["look like kN: forces are in N", "it has none of steer_left"]);
    let mut reversed = measured(simulated, 5);
    let xi = reversed.channels.get_mut(&lss::signal::Channel::JointXi).expect("a force");
    xi.iter_mut().for_each(|x| *x = -*x);
    keep(&reversed, broken.path(), "run-01");
    expect(broken.path(), &["--free", "speed"], 0, &["joint_xi looks reversed: change the sign", "left out: joint_xi"]);
    expect(broken.path(), &["--law", "hertz"], 2, &["there is no law hertz; take `all` or one of"]);
    expect(broken.path(), &["--free", "mass"], 2, &["restitution_joint_axial"]);
}

/// Runs on two layouts that are called the same, in folders of their own, outside of a project.
#[test]
fn layouts_of_one_name_are_kept_apart() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    let mut list = String::new();
    for (k, radius) in ["4 m", "3 m"].into_iter().enumerate() {
        let name = ["a", "b"][k];
        fs::create_dir_all(at(name)).expect("a folder");
        fs::write(at(&format!("{name}/oval.lss")), LAYOUT.replace("radius 4 m", &format!("radius {radius}")))
            .expect("written");
        lss().arg("build").arg(at(&format!("{name}/oval.lss"))).arg("-o").arg(at("built")).assert().success();
        let text = fs::read(at("built/simulation.json")).expect("an input");
        let nominal: Simulation = serde_json::from_slice(&text).expect("an input");
        keep(&measured(&simulated(&nominal), 5), folder.path(), name);
        list += &format!("[[run]]\nfile = \"{name}.csv\"\nlayout = \"{name}/oval.lss\"\n");
    }
    fs::write(at("campaign.toml"), list).expect("written");
    let out = tempfile::tempdir().expect("a folder");
    let mut command = lss();
    command.args(["identify", "--free", "speed", "-o"]).arg(out.path()).arg(folder.path()).assert().success();
    let read = |path: &Path| fs::read_to_string(path).expect("a file");
    for name in ["a", "b"] {
        let copy = read(&out.path().join(format!("{name}-oval.lss")));
        assert_eq!(copy, read(&at(&format!("{name}/oval.lss"))));
        let fitted = out.path().join(format!("{name}-oval-fitted.lss"));
        assert!(read(&fitted).contains(&format!("use \"{name}-oval.lss\"")));
        lss().arg("check").arg(&fitted).assert().success();
    }
}
