//! Plans and the tasks of them, without processes: what a step would print is made up here.

use super::place::{Place, State};
use super::plan::{NoPlan, Plan};
use super::process::{Call, Ended};
use super::run::{Did, LookedAt, Runner};
use super::table::Table;
use crate::source::SourceMap;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

const LAYOUT: &str = "use \"shared.lss\"\nlet aisle = 2 m\n";
const STUDY: &str = "[[sweep]]\nsteps = [\"build\", \"simulate\"]\nfile = [\"a.lss\", \"b.lss\"]\nlet.aisle = [\"2 m\", \"3 m\"]\n\
    simulate.speed = { from = 1, to = 2, step = 0.5, unit = \"m/s\" }\n";

/// A study with its files.
fn folder(study: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in
        [("study.toml", study), ("a.lss", LAYOUT), ("b.lss", "let aisle = 9 m\n"), ("shared.lss", "let n = 3\n")]
    {
        fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

fn plan(folder: &Path) -> Plan {
    let mut sources = SourceMap::default();
    match Plan::read(&mut sources, &folder.join("study.toml"), &|_| Ok(())) {
        Ok(plan) => plan,
        Err(why) => panic!("{why:?}"),
    }
}

fn wrong(study: &str) -> Vec<(String, String)> {
    let folder = folder(study);
    let mut sources = SourceMap::default();
    match Plan::read(&mut sources, &folder.path().join("study.toml"), &|_| Ok(())) {
        Err(NoPlan::Wrong(said)) => {
            said.iter().map(|d| (d.code.as_str().to_owned(), sources.text(d.label.span).to_owned())).collect()
        }
        other => panic!("{other:?}"),
    }
}

fn hashes(plan: &Plan) -> Vec<String> {
    plan.tasks.iter().map(|task| task.hash.clone()).collect()
}

#[test]
fn a_plan_has_a_task_for_each_combination() {
    let folder = folder(STUDY);
    let plan = plan(folder.path());
    assert_eq!(plan.tasks.len(), 12);
    assert_eq!(hashes(&plan).into_iter().collect::<BTreeSet<_>>().len(), 12);
    assert_eq!(plan.tasks[1].words(), "file=a.lss let.aisle=2 m simulate.speed=1.5 m/s");
    let [build, simulate] = plan.tasks[1].steps.as_slice() else { panic!() };
    assert_eq!((build.options.as_slice(), build.file.as_deref()), (&["--let=aisle=2 m".to_owned()][..], Some("a.lss")));
    assert_eq!(simulate.options, ["--speed=1.5 m/s"]);
    assert_eq!((simulate.file.as_deref(), simulate.made.as_deref()), (None, Some("build/simulation.json")));
    assert_eq!(Plan::from_lines(&plan.lines()), Ok(plan));
}

#[test]
fn a_hash_changes_where_what_a_task_hangs_on_does_and_nowhere_else() {
    let folder = folder(STUDY);
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    let before = hashes(&plan(folder.path()));
    let changed = |of: &[String]| before.iter().zip(of).map(|(a, b)| a != b).collect::<Vec<_>>();
    // Names, comments and the order of keys in the study mean nothing.
    write(
        "study.toml",
        &format!("# again\nname = \"x\"\n{}", STUDY.replace("[[sweep]]", "[[sweep]]\nname = \"y\"\nkeep = false")),
    );
    assert_eq!(hashes(&plan(folder.path())), before);
    fs::rename(folder.path().join("b.lss"), folder.path().join("c.lss")).unwrap();
    write("study.toml", &STUDY.replace("b.lss", "c.lss"));
    assert_eq!(hashes(&plan(folder.path())), before, "another name of the same content");
    // The content of an import does, of those that import it.
    write("shared.lss", "let n = 4\n");
    let now = hashes(&plan(folder.path()));
    assert_eq!(changed(&now), [[true; 6], [false; 6]].concat());
    write("shared.lss", "let n = 3\n");
    assert_eq!(hashes(&plan(folder.path())), before);
    // An option, a value, a step.
    write("study.toml", &(STUDY.replace("b.lss", "c.lss") + "simulate.laps = 2\n"));
    assert_eq!(changed(&hashes(&plan(folder.path()))), [true; 12]);
    write("study.toml", &STUDY.replace("b.lss", "c.lss").replace("\"3 m\"", "\"4 m\""));
    assert_eq!(changed(&hashes(&plan(folder.path()))), [[false; 3], [true; 3], [false; 3], [true; 3]].concat());
}

#[test]
fn mistakes_are_found_all_at_once_with_their_places() {
    let told = |study: &str| wrong(study);
    let is = |code: &str, text: &str| (code.to_owned(), text.to_owned());
    assert_eq!(told("sweeps = 3\n"), [is("E0902", "sweeps")]);
    assert_eq!(told("name = \"x\"\n"), [is("E0906", "")]);
    let begin = "[[sweep]]\nsteps = \"build\"\nfile = \"a.lss\"\n";
    for (line, code, at) in [
        ("build.sed = 3", "E0902", "sed"),
        ("build.time_limit = 3", "E0902", "time_limit"),
        ("build.seed = []", "E0906", "[]"),
        ("build.seed = {from = 1, to = 3}", "E0903", "{from = 1, to = 3}"),
        ("build.seed = {from = 1, to = 3, step = -1}", "E0903", "{from = 1, to = 3, step = -1}"),
        ("build.seed = {from = 1, to = 3, stp = 1}", "E0902", "stp"),
        ("build.seed = 2026-01-01", "E0903", "2026-01-01"),
        ("build.pdf = 3", "E0903", "3"),
        ("simulate.laps = 3", "E0903", "simulate"),
        ("let.aisel = \"3 m\"", "E0905", "aisel"),
        ("let.aisle = \"3 m m\"", "E0903", "\"3 m m\""),
        ("let = 3", "E0903", "let"),
        ("zip = [[\"let.aisle\"]]", "E0902", "let.aisle"),
        ("build.layout = \"a\"\nbuild.\"layout\" = \"b\"", "E0901", ""),
        (
            "build.seed = {from = 1, to = 1000, count = 1000}\nbuild.nodes = {from = 1, to = 1000, count = 1000}",
            "E0906",
            "nodes",
        ),
    ] {
        let found = told(&format!("{begin}{line}\n"));
        assert_eq!(found.len(), 1, "{line}: {found:?}");
        assert_eq!(found[0].0, code, "{line}");
        assert!(at.is_empty() || found[0].1 == at, "{line}: {found:?}");
    }
    assert_eq!(told(&format!("{begin}build.sed = 1\nlet.aisel = \"3 m\"\nbuild.seeed = 2\n")).len(), 2, "all of them");
    for (steps, codes) in [
        ("[]", vec!["E0903"]),
        ("[\"biuld\"]", vec!["E0902"]),
        ("[\"build\", \"build\"]", vec!["E0903"]),
        ("[\"simulate\", \"build\"]", vec!["E0903"]),
        ("[\"build\", \"identify\"]", vec!["E0903"]),
    ] {
        let found = told(&format!("[[sweep]]\nsteps = {steps}\nfile = \"a.lss\"\n"));
        assert_eq!(found.iter().map(|f| f.0.as_str()).collect::<Vec<_>>(), codes, "{steps}");
    }
    for file in ["gone.lss", "../x.lss", "/etc/hostname", "."] {
        let found = told(&format!("[[sweep]]\nsteps = [\"build\"]\nfile = [\"a.lss\", \"{file}\"]\n"));
        assert_eq!(found, [is("E0904", &format!("\"{file}\""))]);
    }
}

#[test]
fn values_are_held_against_the_command_line() {
    let folder = folder(STUDY);
    let mut sources = SourceMap::default();
    let refuse = |words: &[String]| match words.iter().any(|word| word == "--speed=1.5 m/s") {
        true => Err("no such speed".to_owned()),
        false => Ok(()),
    };
    let Err(NoPlan::Wrong(said)) = Plan::read(&mut sources, &folder.path().join("study.toml"), &refuse) else {
        panic!()
    };
    assert_eq!((said.len(), said[0].help.as_deref()), (1, Some("no such speed")));
}

/// A build that is as long as its aisle is wide, in its `--let`; a simulation as fast as its `--speed`.
fn pretend(call: &Call) -> Ended {
    let of = |prefix: &str| {
        let text = call.arguments.iter().find_map(|word| word.strip_prefix(prefix)).unwrap_or("0");
        text.split(' ').next().unwrap().parse::<f64>().unwrap()
    };
    let out = match call.arguments[0].as_str() {
        "build" => format!("{{\"feasible\": true, \"length_m\": {}, \"seconds\": 3.3}}", of("--let=aisle=")),
        _ => format!("{{\"carts\": 7, \"speed\": {}, \"channels\": {{}}}}", of("--speed=")),
    };
    Ended { code: Some(0), signal: None, out, said: String::new() }
}

fn runner<'a>(plan: &'a Plan, place: &'a Place, start: super::process::Start<'a>) -> Runner<'a> {
    Runner { plan, place, threads: 1, retry_failed: false, always: Vec::new(), start, looked_at: LookedAt::default() }
}

#[test]
fn every_order_and_number_of_jobs_gives_the_same_table() {
    let folder = folder(STUDY);
    let plan = plan(folder.path());
    let mut tables = Vec::new();
    for jobs in [1, 2, 5] {
        let place = Place::new(&folder.path().join(format!("out-{jobs}")), false).unwrap();
        let start = |call: Call| Ok(pretend(&call));
        let all = runner(&plan, &place, &start).all(jobs, &|_, _| {});
        assert!(all.values().all(|did| *did == Did::Done));
        let table = Table::collect(&plan, &place);
        tables.push((table.csv(), table.parquet().unwrap()));
    }
    assert!(tables.windows(2).all(|w| w[0] == w[1]));
    let text = String::from_utf8(tables[0].0.clone()).unwrap();
    assert!(text.contains("done,b.lss,3,1.5,true,3,7,"), "{text}");
    assert!(!text.contains("3.3"), "no times");
}

#[test]
fn nothing_is_done_twice_and_what_failed_is_tried_again_when_asked() {
    let folder = folder(STUDY);
    let plan = plan(folder.path());
    let place = Place::new(&folder.path().join("out"), false).unwrap();
    let count = AtomicUsize::new(0);
    let broken = Mutex::new(true);
    let start = |call: Call| {
        count.fetch_add(1, Ordering::Relaxed);
        let fails = *broken.lock().unwrap() && call.arguments.iter().any(|word| word == "--speed=2 m/s");
        let said = "warning: x\nerror: it broke\n".to_owned();
        Ok(if fails { Ended { code: Some(1), said, ..Ended::default() } } else { pretend(&call) })
    };
    let mut first = runner(&plan, &place, &start);
    let told = Mutex::new(Vec::new());
    let all = first.all(2, &|task, did| told.lock().unwrap().push((task.hash.clone(), did.clone())));
    assert_eq!(all.values().filter(|did| **did == Did::Failed("it broke".into())).count(), 4, "others go on");
    assert_eq!(told.lock().unwrap().len(), 12);
    assert_eq!(count.swap(0, Ordering::Relaxed), 24);
    let failed = place.failed(&plan.tasks[2].hash).unwrap();
    assert_eq!((failed.step.as_str(), failed.ended.as_str(), failed.said.len()), ("simulate", "exit code 1", 2));
    let table = String::from_utf8(Table::collect(&plan, &place).csv()).unwrap();
    assert_eq!(table.matches("failed,").count(), 4);
    assert_eq!(table.matches("simulate: it broke").count(), 4);
    // Again: nothing is done.
    let all = first.all(2, &|_, _| {});
    assert_eq!(count.swap(0, Ordering::Relaxed), 0);
    assert_eq!(all.values().filter(|did| matches!(did, Did::FailedBefore(_))).count(), 4);
    // The step before is not done again.
    *broken.lock().unwrap() = false;
    first.retry_failed = true;
    assert!(first.all(2, &|_, _| {}).values().all(|did| matches!(did, Did::Done | Did::Known)));
    assert_eq!(count.swap(0, Ordering::Relaxed), 4);
    assert!(plan.tasks.iter().all(|task| place.state(&task.hash) == State::Done && place.failed(&task.hash).is_none()));
}

#[test]
fn two_at_one_study_share_it() {
    let folder = folder(STUDY);
    let plan = plan(folder.path());
    let place = Place::new(&folder.path().join("out"), false).unwrap();
    let started: Mutex<BTreeMap<String, usize>> = Mutex::default();
    let start = |call: Call| {
        let out = call.arguments.iter().find(|word| word.starts_with("--output=")).unwrap().clone();
        *started.lock().unwrap().entry(out).or_default() += 1;
        std::thread::sleep(std::time::Duration::from_millis(5));
        Ok(pretend(&call))
    };
    std::thread::scope(|scope| {
        let both = [0, 1].map(|_| scope.spawn(|| runner(&plan, &place, &start).all(2, &|_, _| {})));
        for all in both.map(|one| one.join().unwrap()) {
            assert!(all.values().all(|did| matches!(did, Did::Done | Did::Known)), "{all:?}");
        }
    });
    let started = started.into_inner().unwrap();
    assert!(started.len() == 24 && started.values().all(|count| *count == 1), "{started:?}");
}

#[test]
fn what_was_stopped_or_planned_with_other_files_stays_open() {
    let folder = folder(STUDY);
    let plan = plan(folder.path());
    let place = Place::new(&folder.path().join("out"), false).unwrap();
    let stopped = |_: Call| Ok(Ended { signal: Some(15), ..Ended::default() });
    let did = runner(&plan, &place, &stopped).task(&plan.tasks[0], true);
    assert_eq!((did, place.state(&plan.tasks[0].hash)), (Did::Open("stopped by signal 15".into()), State::Open));
    let gone = |_: Call| Err(io::Error::from(io::ErrorKind::NotFound));
    assert!(matches!(runner(&plan, &place, &gone).task(&plan.tasks[0], true), Did::Open(_)));
    let killed = |_: Call| Ok(Ended { signal: Some(9), ..Ended::default() });
    let did = runner(&plan, &place, &killed).task(&plan.tasks[1], true);
    assert!(matches!(&did, Did::Failed(why) if why.contains("memory")), "{did:?}");
    // Changed while the task is done: it counts neither as done nor as failed.
    let start = |call: Call| {
        fs::write(folder.path().join("shared.lss"), "let n = 5\n").unwrap();
        Ok(pretend(&call))
    };
    let did = runner(&plan, &place, &start).task(&plan.tasks[2], true);
    assert!(matches!(&did, Did::Open(why) if why.contains("shared.lss has changed")), "{did:?}");
    assert_eq!(place.state(&plan.tasks[2].hash), State::Open);
}

#[test]
fn a_layout_that_cannot_be_is_an_answer_of_the_last_step_alone() {
    let folder = folder(
        "[[sweep]]\nname = \"one\"\nsteps = \"build\"\nfile = \"a.lss\"\nkeep = false\n\
        [[sweep]]\nname = \"two\"\nsteps = [\"build\", \"simulate\"]\nfile = \"a.lss\"\n",
    );
    let plan = plan(folder.path());
    let place = Place::new(&folder.path().join("out"), false).unwrap();
    let start = |call: Call| {
        let out = call.arguments.iter().find_map(|word| word.strip_prefix("--output=")).unwrap();
        fs::create_dir_all(out)?;
        fs::write(Path::new(out).join("layout.json"), "{}")?;
        Ok(Ended { code: Some(1), out: "{\"feasible\": false, \"length_m\": 3}".into(), ..Ended::default() })
    };
    let runner = runner(&plan, &place, &start);
    assert_eq!(runner.task(&plan.tasks[0], true), Did::Done);
    assert_eq!(place.found(&plan.tasks[0].hash).unwrap().values["build.feasible"], false);
    assert!(!place.task(&plan.tasks[0].hash).join("build").exists(), "outputs are not kept");
    assert!(matches!(runner.task(&plan.tasks[1], true), Did::Failed(_)));
    assert!(place.task(&plan.tasks[1].hash).join("build").exists());
}
