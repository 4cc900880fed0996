//! Models outside that misbehave with an effect: what they did not answer is told, and rules nothing out. Without
//! python3 these say that they were skipped.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use lss::gap::outside::{Outside, Settings};
use lss::gap::{Axis, Diagnosis, diagnose};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Duration;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn python() -> bool {
    let found = Command::new("python3").arg("--version").stdout(Stdio::null()).status().is_ok_and(|s| s.success());
    if !found {
        println!("skipped: python3 is not there");
    }
    found
}

/// The oven of the examples with some lines of Python before it answers; `asked` is the request, `area` the
/// radiation's.
fn oven(folder: &Path, name: &str, lines: &str) -> PathBuf {
    let text = fs::read_to_string(root().join("examples/outside/model.py")).expect("the example");
    let before = "    asked = json.loads(line)\n";
    assert!(text.contains(before));
    let find = "    effects = {e['name']: e['strengths'] for e in asked.get('effects', [])}\n    \
                area = effects.get('radiation', {}).get('area', 0)\n";
    let script = folder.join(format!("{name}.py"));
    fs::write(&script, text.replacen(before, &format!("{before}{find}{lines}\n"), 1)).expect("written");
    script
}

fn diagnosed(script: &Path, timeout: Duration) -> Diagnosis {
    let settings = Settings { timeout, ..Settings::default() };
    let command = format!("python3 \"{}\"", script.display());
    diagnose(
        &Outside::open(&command, &root().join("examples/outside"), &settings).expect("a model"),
        &lss::gap::Settings::default(),
        &mut |_| {},
    )
}

/// The cause is what cannot be simulated: it is named, with strength, run and reason, and no other is sure.
#[test]
fn an_effect_that_crashes_is_silent_or_says_nothing_finite_is_not_ruled_out() {
    if !python() {
        return;
    }
    let at = tempfile::tempdir().expect("a folder");
    let cases = [
        ("crash", "    if area: raise ValueError('area')", "the model ended instead of answering"),
        ("silent", "    if area: import time; time.sleep(60)", "the model did not answer within 3 s"),
        (
            "refusal",
            "    if area: print(json.dumps({'error': 'no licence'}), flush=True); continue",
            "the model refused: no licence",
        ),
        (
            "null",
            "    if area: print(json.dumps({'time': inputs(asked['run']['file'])[0], 'channels': {'temperature': \
             [None] * len(inputs(asked['run']['file'])[0])}}), flush=True); continue",
            "says nothing finite",
        ),
    ];
    for (name, lines, why) in cases {
        let found = diagnosed(&oven(at.path(), name, lines), Duration::from_secs(3));
        let radiation = found.effects.iter().find(|f| f.name == "radiation").expect("an effect");
        assert!(radiation.untested() && radiation.probability > 0.2, "{name}: {radiation:?}");
        for other in found.effects.iter().filter(|f| f.name != "radiation") {
            assert!(other.probability < 0.75, "{name}: {} {}", other.name, other.probability);
        }
        let lost: Vec<_> = found.lost.iter().filter(|l| l.effect == "radiation").collect();
        assert!(
            !lost.is_empty() && lost.iter().all(|l| l.strength["area"] > 0.0 && !l.run.is_empty()),
            "{name}: {lost:?}"
        );
        assert!(lost.iter().any(|l| l.why.contains(why)), "{name}: {lost:?}");
        assert!(found.summary.contains("could not be simulated: radiation"), "{name}: {}", found.summary);
        assert!(found.named().iter().all(|f| f.name != "radiation"));
        assert_eq!(found.axis, Axis::Time);
        // All others were simulated.
        assert!(found.effects.iter().all(|f| f.name == "radiation" || !f.untested()), "{name}");
    }
}

fn run(script: &Path, out: &Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lss"));
    let model = format!("python3 \"{}\"", script.display());
    let arguments = ["gap", "diagnose", "examples/outside", "--model", &model, "-o"];
    command.current_dir(root()).args(arguments).arg(out).output().expect("it runs")
}

/// A model that refuses what is larger than it can do still gives a whole answer: exit code 0, and what was refused is
/// told.
#[test]
fn a_refused_strength_leaves_the_answer_whole() {
    if !python() {
        return;
    }
    let at = tempfile::tempdir().expect("a folder");
    let refuses = "    if area > 0.1: print(json.dumps({'error': 'too hot'}), flush=True); continue";
    let out = at.path().join("out");
    let ran = run(&oven(at.path(), "refuses", refuses), &out);
    let (said, warned) = (String::from_utf8(ran.stdout).unwrap(), String::from_utf8(ran.stderr).unwrap());
    assert_eq!(ran.status.code(), Some(0), "{said}\n{warned}");
    assert!(said.contains("One effect explains the gap: radiation"), "{said}");
    assert!(!said.contains(" m\n") && !said.contains(" m;") && said.contains(" s "), "seconds: {said}");
    let found: Value = serde_json::from_slice(&fs::read(out.join("gap.json")).unwrap()).unwrap();
    assert!(found["where"][0]["from_s"].is_number() && found["where"][0].get("from_m").is_none(), "{found}");
    for lost in found["lost"].as_array().unwrap() {
        assert!(
            lost["strength"]["area"].as_f64().unwrap() > 0.1 && lost["why"] == "the model refused: too hot",
            "{lost}"
        );
        let words = format!("warning: radiation (area {}) could not be simulated in run", lost["strength"]["area"]);
        assert!(warned.contains(&words), "{warned}");
    }
    assert!(!out.join("gap.partial").exists());
}

/// Without the cause the answer is not whole.
#[test]
fn an_untested_effect_ends_with_exit_code_1() {
    if !python() {
        return;
    }
    let at = tempfile::tempdir().expect("a folder");
    let out = at.path().join("out");
    let ran = run(&oven(at.path(), "crash", "    if area: sys.exit(5)"), &out);
    let (said, warned) = (String::from_utf8(ran.stdout).unwrap(), String::from_utf8(ran.stderr).unwrap());
    assert_eq!(ran.status.code(), Some(1), "{said}\n{warned}");
    let page = fs::read_to_string(out.join("gap.html")).unwrap();
    for text in [&said, &page] {
        assert!(text.contains("radiation (area 0.01) could not be simulated in run"), "{text}");
        assert!(text.contains("Not ruled out, as it could not be simulated: radiation"), "{text}");
    }
    assert!(warned.contains("warning: radiation (area 0.01) could not be simulated in run"), "{warned}");
}
