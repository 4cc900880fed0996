//! What a project that somebody else wrote can make `lss` read and write: nothing beyond its root. `SECURITY.md` names
//! these tests.

#![cfg(unix)]
#![allow(clippy::expect_used, clippy::unwrap_used)]

use assert_cmd::Command;
use std::fs;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::time::Duration;
use tempfile::TempDir;

/// What lies outside and must not be said.
const SECRET: &str = "hunter2_s3cr3t";

const SIDECAR: &str = "sensor_cart = 1\nspeed_setpoint = 2\ntrigger_position = 0\nlowpass = 100\nlaps = 1\n";
const DATA: &str = "time,joint_xi\n0,1\n0.002,2\n0.004,3\n";

/// A folder with a project `p` and a secret beside it.
struct Place(TempDir);

impl Place {
    /// `marked` says whether `p` is marked as a root.
    fn new(marked: bool) -> Place {
        let place = Place(tempfile::tempdir().unwrap());
        for (name, text) in [
            ("secret/words.lss", format!("{SECRET} = 1\n")),
            ("secret/words.json", format!("{{\"{SECRET}\": 1}}\n")),
            ("secret/words.toml", format!("{SECRET} = [\n")),
            ("secret/words.csv", format!("{SECRET},{SECRET}\n1,2\n")),
            ("secret/words.dxf", format!("{SECRET}\n")),
        ] {
            place.write(name, &text);
        }
        place.write("p/a/run-01.csv", DATA);
        place.write("p/a/run-01.toml", &format!("layout = \"../track.json\"\n{SIDECAR}"));
        if marked {
            place.write("p/lss.toml", "");
        }
        place
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, text: &str) {
        let path = self.path(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    }

    /// A link `p/NAME` to a place in this folder.
    fn link(&self, name: &str, to: &str) {
        let _ = fs::remove_file(self.path(name));
        symlink(self.path(to), self.path(name)).unwrap();
    }

    /// What the program says on both streams, and its exit code.
    fn said(&self, arguments: &[&str]) -> (String, i32) {
        let mut command = Command::cargo_bin("lss").expect("the binary");
        command.current_dir(self.0.path()).env("LSS_TEST_SECRET", SECRET).args(arguments);
        let output = command.timeout(Duration::from_secs(60)).output().unwrap();
        let said = [output.stdout, output.stderr].concat();
        (String::from_utf8_lossy(&said).into_owned(), output.status.code().expect("it ends by itself"))
    }

    /// That the program fails without a word of the secret.
    fn keeps_quiet(&self, arguments: &[&str]) -> String {
        let (said, code) = self.said(arguments);
        assert!(!said.contains(SECRET), "{arguments:?} tells\n{said}");
        assert!(code == 1 || code == 2, "{arguments:?} ends with {code}\n{said}");
        said
    }
}

/// The verbs that read a campaign.
const CAMPAIGN_VERBS: [&[&str]; 3] =
    [&["runs", "p/a"], &["identify", "p/a", "-o", "out"], &["gap", "diagnose", "p/a", "-o", "out"]];

#[test]
fn a_campaign_reads_no_layout_and_no_run_outside_the_root() {
    let place = Place::new(false);
    let beside = |name: &str| place.path(name).to_string_lossy().into_owned();
    for named in [
        "/proc/self/environ",
        "/proc/self/../self/environ",
        "../../secret/words.lss",
        "../../secret/words.json",
        "../../p/../secret/words.json",
        &beside("secret/words.lss"),
        &beside("secret/words.json"),
    ] {
        for list in [
            format!("layout = \"{named}\"\n[[run]]\nfile = \"run-01.csv\"\n"),
            format!("[[run]]\nfile = \"run-01.csv\"\nlayout = \"{named}\"\n"),
        ] {
            place.write("p/a/campaign.toml", &list);
            for verb in &CAMPAIGN_VERBS[1..] {
                let said = place.keeps_quiet(verb);
                assert!(said.contains("outside the project's root"), "{said}");
            }
            let (said, _) = place.said(CAMPAIGN_VERBS[0]);
            assert!(!said.contains(SECRET) && said.contains("outside the project's root"), "{said}");
        }
    }
    for named in ["../../secret/words.csv", "../../secret/missing.csv", &beside("secret/words.csv"), "/dev/fd/0.csv"] {
        place.write("p/a/campaign.toml", &format!("[[run]]\nfile = \"{named}\"\n"));
        for verb in CAMPAIGN_VERBS {
            let said = place.keeps_quiet(verb);
            assert!(said.contains("outside the project's root") && said.contains("row 2"), "{said}");
        }
    }
}

#[test]
fn a_sidecar_names_no_layout_outside_the_root() {
    let place = Place::new(false);
    for named in ["/proc/self/environ", "../../secret/words.lss", "../../secret/words.json"] {
        place.write("p/a/run-01.toml", &format!("layout = \"{named}\"\n{SIDECAR}"));
        for verb in &CAMPAIGN_VERBS[1..] {
            assert!(place.keeps_quiet(verb).contains("outside the project's root"));
        }
        for verb in
            [&["runs", "p/a"][..], &["runs", "p/a/run-01.csv"], &["compare", "p/a/run-01.csv", "p/a/run-01.csv"]]
        {
            let (said, _) = place.said(verb);
            assert!(!said.contains(SECRET), "{said}");
        }
    }
}

#[test]
fn links_in_a_project_do_not_lead_out_of_it() {
    for marked in [true, false] {
        let place = Place::new(marked);
        for (link, to, verb) in [
            ("p/track.json", "secret/words.json", &["identify", "p/a", "-o", "out"][..]),
            ("p/a/run-01.csv", "secret/words.csv", &["runs", "p/a"]),
            ("p/a/run-01.toml", "secret/words.toml", &["runs", "p/a"]),
            ("p/a/run-01.toml", "secret/words.toml", &["compare", "p/a/run-01.csv", "p/a/run-01.csv"]),
            ("p/a/campaign.toml", "secret/words.toml", &["runs", "p/a"]),
            ("p/a/campaign.toml", "secret/words.toml", &["gap", "diagnose", "p/a", "-o", "out"]),
        ] {
            let kept = fs::read(place.path(link)).ok();
            place.link(link, to);
            let said = place.keeps_quiet(verb);
            assert!(said.contains("outside the project's root"), "{said}");
            fs::remove_file(place.path(link)).unwrap();
            if let Some(bytes) = kept {
                fs::write(place.path(link), bytes).unwrap();
            }
        }
    }
}

/// `lss check layouts/*.lss` names what somebody else put there.
#[test]
fn a_link_on_the_command_line_does_not_lead_out_of_a_marked_project() {
    let place = Place::new(true);
    for (link, verb) in [
        ("p/words.lss", &["check", "p/words.lss"][..]),
        ("p/words.lss", &["build", "p/words.lss", "-o", "out"]),
        ("p/words.lss", &["fmt", "--diff", "p/words.lss"]),
        ("p/words.lss", &["polygon", "p/words.lss"]),
        ("p/words.json", &["simulate", "p/words.json", "-o", "out"]),
        ("p/words.csv", &["compare", "p/words.csv", "p/words.csv"]),
        ("p/words.csv", &["runs", "p/words.csv"]),
        ("p/words.csv", &["identify", "stiffness", "p/words.csv"]),
        ("p/words.dxf", &["import", "p/words.dxf", "-o", "new.lss"]),
        ("p/words.lss", &["identify", "p/a", "--layout", "p/words.lss", "-o", "out"]),
    ] {
        place.link(link, &link.replace("p/", "secret/"));
        let said = place.keeps_quiet(verb);
        assert!(said.contains("outside the project's root, `p`"), "{said}");
    }
    let (said, code) = place.said(&["check", "p/words.lss", "--root", "."]);
    assert!(said.contains(SECRET) && code == 1, "--root widens it: {said}");
    place.link("free.lss", "secret/words.lss");
    assert!(
        place.said(&["check", "free.lss"]).0.contains(SECRET),
        "outside any project, a link is a name like any other"
    );
}

#[test]
fn the_root_is_marked_or_given_or_the_folder_above_the_campaign() {
    let is_there = "laps, speeds and sides cannot be told";
    let layout = fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/smallest.lss")).unwrap();
    for (named, marks, more, is_read) in [
        ("../track.lss", &[][..], &[][..], true),
        ("../../track.lss", &[], &[], false),
        ("../../track.lss", &["lss.toml"], &[], true),
        ("../../track.lss", &[".git/HEAD"], &[], true),
        // As in work trees and submodules.
        ("../../track.lss", &[".git"], &[], true),
        ("../../track.lss", &["p/.git", "lss.toml"], &[], false),
        ("../../track.lss", &[], &["--root", "."], true),
        ("../../track.lss", &["p/.git"], &["--root", "."], true),
        ("../track.lss", &[], &["--root", "p/a"], false),
    ] {
        let place = Place::new(false);
        for name in ["track.lss", "p/track.lss"] {
            place.write(name, &String::from_utf8_lossy(&layout));
        }
        place.write("p/a/campaign.toml", &format!("layout = \"{named}\"\n[[run]]\nfile = \"run-01.csv\"\n"));
        marks.iter().for_each(|mark| place.write(mark, ""));
        let (said, _) = place.said(&[&["runs", "p/a"], more].concat());
        assert_eq!(!said.contains(is_there), is_read, "{named} {marks:?} {more:?}\n{said}");
    }
    let place = Place::new(false);
    assert_eq!(place.said(&["runs", "p/a", "--root", "nowhere"]).1, 2);
}

#[test]
fn imports_of_a_layout_stay_within_its_root() {
    let place = Place::new(true);
    place.link("p/link.lss", "secret/words.lss");
    place.link("p/dangling.lss", "secret/missing.lss");
    let secret = place.path("secret/words.lss");
    for named in ["../secret/words.lss", &secret.to_string_lossy(), "link.lss", "dangling.lss", "../secret/missing.lss"]
    {
        place.write("p/main.lss", &format!("use \"{named}\"\n"));
        let said = place.keeps_quiet(&["check", "p/main.lss"]);
        assert!(said.contains("E0203"), "{said}");
        // A layout that the command line names, or that a campaign names, has a root of its own.
        place.keeps_quiet(&["identify", "p/a", "--layout", "p/main.lss", "-o", "out"]);
        place.write("p/a/campaign.toml", "layout = \"../main.lss\"\n[[run]]\nfile = \"run-01.csv\"\n");
        place.keeps_quiet(&["identify", "p/a", "-o", "out"]);
    }
}

#[test]
fn pipes_devices_and_the_systems_own_files_are_not_read() {
    let place = Place::new(true);
    let pipe = place.path("p/pipe.lss");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    for file in ["p/pipe.lss", "/dev/zero", "/proc/self/environ"] {
        let said = place.keeps_quiet(&["check", file]);
        assert!(said.contains("not a regular file"), "{said}");
    }
    let said = place.keeps_quiet(&["check", "p"]);
    assert!(said.contains("it is a folder"), "{said}");
    place.write("p/a/campaign.toml", "layout = \"../pipe.lss\"\n[[run]]\nfile = \"run-01.csv\"\n");
    place.keeps_quiet(&["identify", "p/a", "-o", "out"]);
    // With the file system as the root, /proc is within it.
    place.write("p/a/campaign.toml", "layout = \"/proc/self/environ\"\n[[run]]\nfile = \"run-01.csv\"\n");
    place.keeps_quiet(&["identify", "p/a", "-o", "out", "--root", "/"]);
}

#[test]
fn outputs_do_not_follow_links_out_of_the_project() {
    let place = Place::new(true);
    fs::copy(Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/smallest.lss"), place.path("p/s.lss")).unwrap();
    fs::create_dir(place.path("elsewhere")).unwrap();
    place.link("p/out", "elsewhere");
    let said = place.keeps_quiet(&["build", "p/s.lss", "-o", "p/out"]);
    assert!(said.contains("outside the project's root"), "{said}");
    assert_eq!(fs::read_dir(place.path("elsewhere")).unwrap().count(), 0);
    // A link in place of a file is replaced.
    place.write("elsewhere/mine", "mine");
    fs::create_dir(place.path("p/set")).unwrap();
    for name in ["layout.json", "drawing.svg", "bom.csv"] {
        place.link(&format!("p/set/{name}"), "elsewhere/mine");
    }
    assert_eq!(place.said(&["build", "p/s.lss", "-o", "p/set"]).1, 0);
    place.write("p/test.csv", "deformation,force\n0.001,10\n0.002,30\n0.003,50\n0.004,80\n0.005,110\n");
    place.link("p/joint.lss", "elsewhere/mine");
    place.said(&["identify", "stiffness", "p/test.csv", "-o", "p/joint.lss"]);
    assert_eq!(fs::read_to_string(place.path("elsewhere/mine")).unwrap(), "mine");
}

#[test]
fn a_challenge_reads_and_writes_nothing_outside_its_folder() {
    let place = Place::new(true);
    place.write("elsewhere/mine", "mine");
    place.write("c/challenge.json", r#"{"key_sha256":"","cases":["case-1"],"mix":""}"#);
    place.write("c/case-1/run-01.csv", DATA);
    place.link("c/case-1/campaign.toml", "secret/words.toml");
    place.keeps_quiet(&["gap", "challenge", "score", "c"]);
    fs::remove_file(place.path("c/case-1/campaign.toml")).unwrap();
    place.link("c/answers", "elsewhere");
    let said = place.keeps_quiet(&["gap", "challenge", "score", "c"]);
    assert!(said.contains("outside"), "{said}");
    fs::remove_file(place.path("c/answers")).unwrap();
    fs::create_dir_all(place.path("c/answers/case-1")).unwrap();
    for name in ["gap.json.part", "failure.txt.part", "failure.txt"] {
        place.link(&format!("c/answers/case-1/{name}"), "elsewhere/mine");
    }
    place.link("c/score.json", "elsewhere/mine");
    place.keeps_quiet(&["gap", "challenge", "score", "c"]);
    assert_eq!(fs::read_to_string(place.path("elsewhere/mine")).unwrap(), "mine");
    assert_eq!(fs::read_dir(place.path("elsewhere")).unwrap().count(), 1);
    for case in ["../secret", "/etc", "a/b"] {
        place.write("c/challenge.json", &format!(r#"{{"key_sha256":"","cases":["{case}"],"mix":""}}"#));
        assert!(place.keeps_quiet(&["gap", "challenge", "score", "c"]).contains("no name of a case"));
    }
}

#[test]
fn a_study_reads_nothing_outside_its_root_and_sets_no_option_that_starts_a_program() {
    let place = Place::new(true);
    place.link("p/link.lss", "secret/words.lss");
    for file in ["../secret/words.lss", "link.lss", "/proc/self/environ", "../secret/missing.lss", "-o", "a"] {
        place.write("p/study.toml", &format!("[[sweep]]\nsteps = \"build\"\nfile = \"{file}\"\n"));
        place.keeps_quiet(&["study", "run", "p/study.toml", "-o", "out"]);
        place.write("p/study.toml", &format!("[[sweep]]\nsteps = \"identify\"\nfile = \"{file}\"\n"));
        place.keeps_quiet(&["study", "run", "p/study.toml", "-o", "out"]);
    }
    fs::copy(Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/smallest.lss"), place.path("p/s.lss")).unwrap();
    for line in
        ["diagnose.model = \"touch hit\"", "model = \"touch hit\"", "diagnose.fmu = true", "build.output = \"x\""]
    {
        place.write(
            "p/study.toml",
            &format!("[[sweep]]\nsteps = [\"build\", \"simulate\", \"diagnose\"]\nfile = \"s.lss\"\n{line}\n"),
        );
        assert!(place.keeps_quiet(&["study", "run", "p/study.toml", "-o", "out"]).contains("E0902"));
    }
    // A value is told as one word with its option, so that it is none itself.
    place.write(
        "p/study.toml",
        "[[sweep]]\nsteps = \"build\"\nfile = \"s.lss\"\nbuild.layout = \"--output=../elsewhere\"\n",
    );
    place.keeps_quiet(&["study", "run", "p/study.toml", "-o", "out"]);
    assert!(!place.path("hit").exists() && !place.path("elsewhere").exists() && !place.path("p/elsewhere").exists());
    // Nor does a folder of results lead out of the project.
    place.write("p/study.toml", "[[sweep]]\nsteps = \"build\"\nfile = \"s.lss\"\n");
    fs::create_dir(place.path("elsewhere")).unwrap();
    place.link("p/out", "elsewhere");
    let said = place.keeps_quiet(&["study", "run", "p/study.toml", "-o", "p/out"]);
    assert!(said.contains("outside the project's root"), "{said}");
    fs::remove_file(place.path("p/out")).unwrap();
    fs::create_dir(place.path("p/out")).unwrap();
    place.link("p/out/tasks", "elsewhere");
    place.keeps_quiet(&["study", "run", "p/study.toml", "-o", "p/out"]);
    assert_eq!(fs::read_dir(place.path("elsewhere")).unwrap().count(), 0);
}

/// A program outside is started by `--model`, which only the command line has; `lss` starts itself for a challenge and for
/// a study, and Slurm where the command line says so.
#[test]
fn processes_are_started_in_few_places_only() {
    fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            match path.is_dir() {
                true => sources(&path, found),
                false if path.extension().is_some_and(|e| e == "rs") => found.push(path),
                false => {}
            }
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut all = Vec::new();
    sources(&root.join("src"), &mut all);
    let starts = |path: &&PathBuf| {
        let text = fs::read_to_string(path).unwrap();
        let product = text.split("#[cfg(test)]").next().unwrap_or_default();
        product.contains("Command::new(") && !path.ends_with("tests.rs")
    };
    let mut found: Vec<_> = all.iter().filter(starts).map(|p| p.strip_prefix(root).unwrap()).collect();
    found.sort();
    let known = [
        "src/benchmark/answering.rs",
        "src/gap/outside/process.rs",
        "src/source/revision.rs",
        "src/study/process.rs",
        "src/study/slurm.rs",
    ];
    assert_eq!(found, known.map(Path::new));
    for key in ["model", "command", "run_before", "exec"] {
        let place = Place::new(false);
        place.write("p/a/campaign.toml", &format!("{key} = \"touch hit\"\n[[run]]\nfile = \"run-01.csv\"\n"));
        place.keeps_quiet(&["runs", "p/a"]);
        assert!(!place.path("hit").exists());
    }
}
