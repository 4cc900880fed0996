//! The commands of the documents, run as a reader runs them: block by block, in a folder with the files of this project.

#![cfg(unix)]
#![allow(clippy::expect_used)]

use crate::links::{blocks, documents};
use crate::route::HALL;
use std::collections::BTreeSet;
use std::fs;
use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::{Command, Output};
use tempfile::TempDir;

/// A page, what its reader has before, as a shell does it, and what of it is not run here.
struct Page {
    path: &'static str,
    before: &'static str,
    /// How lines begin whose whole block is left out, and why.
    without: &'static [(&'static str, &'static str)],
    /// Lines whose block ends with an error, as the page says.
    refused: &'static [&'static str],
}

/// A drawing of a plan; that of a hall is there.
const PLAN: &str = "lss build examples/thesis10.lss -o drawn
cp drawn/drawing.dxf plan.dxf
";

/// A repository in which a layout differs from that of its main branch in a note alone.
const REPOSITORY: &str = "cp examples/thesis10.lss terminal_3.lss
lss fmt terminal_3.lss
mkdir bill
lss build terminal_3.lss -o out
cp out/bom.csv out/layout.json bill/
export GIT_CONFIG_GLOBAL=/dev/null
git init --quiet .
git config user.name reader
git config user.email reader@example.org
git add terminal_3.lss bill
git commit --quiet -m 'bill: first'
git update-ref refs/remotes/origin/main HEAD
echo '// A note.' >> terminal_3.lss
git commit --quiet --all -m 'terminal: add a note'
";

/// A run that was measured, and one that was simulated.
const RUNS: &str = "lss simulate examples/reference.lss -o measured
lss simulate examples/reference.lss --speed 1.9m/s --run-format parquet -o simulated
";

const OF_ITS_OWN: &str = "a build of its own, of what is there";

/// Pages whose commands take seconds.
const PAGES: &[Page] = &[
    Page {
        path: "README.md",
        before: "",
        without: &[("cargo install", OF_ITS_OWN), ("cargo test", "it runs this")],
        refused: &[],
    },
    Page { path: "docs/ci-recipe.md", before: REPOSITORY, without: &[], refused: &[] },
    Page { path: "docs/equipment.md", before: "", without: &[], refused: &[] },
    Page {
        path: "docs/guide.md",
        before: "",
        without: &[("cargo install", OF_ITS_OWN), ("lss build examples/route.lss", "a minute; it is in `LONG`")],
        refused: &["lss check examples/errors.lss"],
    },
    Page { path: "docs/import.md", before: PLAN, without: &[], refused: &[] },
    Page { path: "docs/outputs.md", before: "", without: &[], refused: &[] },
    Page { path: "docs/preview.md", before: "", without: &[], refused: &[] },
    Page { path: "docs/runs.md", before: RUNS, without: &[], refused: &[] },
    Page { path: "docs/simulation.md", before: "", without: &[], refused: &[] },
];

/// Those that take minutes, or other programs.
const LONG: &[Page] = &[
    Page { path: "docs/capacity.md", before: "", without: &[], refused: &[] },
    Page { path: "docs/choice.md", before: "", without: &[], refused: &[] },
    Page { path: "docs/gap.md", before: "", without: &[], refused: &[] },
    Page {
        path: "docs/guide.md",
        before: "",
        without: &[("cargo install", OF_ITS_OWN)],
        refused: &["lss check examples/errors.lss"],
    },
    Page {
        path: "docs/outside-models.md",
        before: "",
        without: &[
            (
                "lss gap diagnose examples/outside --model \"python3 -m lss_model examples/outside/oven_matlab.py",
                "it needs MATLAB or Octave",
            ),
            ("lss gap diagnose examples/emps", "its measurements are others' and not in this repository"),
            ("python3 examples/outside/published", "its measurements are others' and not in this repository"),
        ],
        refused: &[],
    },
    Page { path: "docs/polygon.md", before: "", without: &[], refused: &[] },
    Page { path: "docs/solvers.md", before: "", without: &[], refused: &[] },
    Page {
        path: "docs/study.md",
        before: "",
        without: &[
            ("lss study submit", "it needs a cluster; tests/slurm/run.sh makes one and runs this"),
            ("sudo tests/slurm", "it starts services; it is run by hand"),
        ],
        refused: &[],
    },
];

/// Pages without a command that can be run.
const NONE: &[(&str, &str)] = &[
    ("CONTRIBUTING.md", "those of README.md"),
    ("examples/outside/published/README.md", "its measurements are others' and not in this repository"),
    ("docs/gap-reference.md", "a synopsis"),
    ("docs/python.md", OF_ITS_OWN),
    ("editors/README.md", "it needs Node.js and an editor"),
];

/// Programs as a reader has them: `lss`, and `cargo run` as the same. A preview ends after a while.
fn install(folder: &Path, more: &[(&str, &str)]) {
    let binary = env!("CARGO_BIN_EXE_lss");
    let scripts = [
        (
            "lss",
            format!(
                "if [ \"$1\" = preview ]; then exec timeout --preserve-status -s INT 5 {binary} \"$@\"; fi\nexec {binary} \"$@\"\n"
            ),
        ),
        ("cargo", "[ \"$1 $2 $3\" = 'run --release --' ] || exit 1\nshift 3\nexec lss \"$@\"\n".to_owned()),
    ];
    let more = more.iter().map(|(name, body)| (*name, format!("{body}\n")));
    for (name, body) in scripts.into_iter().chain(more) {
        let path = folder.join(name);
        fs::write(&path, format!("#!/usr/bin/env bash\n{body}")).expect("written");
        fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).expect("made executable");
    }
}

/// A reader's folder with the files of this project, and the programs.
struct Reader {
    bin: TempDir,
    work: TempDir,
}

impl Reader {
    /// With scripts of other names beside `lss`.
    fn new(scripts: &[(&str, &str)]) -> Reader {
        let reader =
            Reader { bin: tempfile::tempdir().expect("a folder"), work: tempfile::tempdir().expect("a folder") };
        install(reader.bin.path(), scripts);
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        for folder in ["examples", "benches/identify/layouts"] {
            let into = reader.work.path().join(folder);
            fs::create_dir_all(into.parent().expect("a parent")).expect("a folder");
            let copied = Command::new("cp").arg("-r").arg(root.join(folder)).arg(&into).status().expect("cp");
            assert!(copied.success());
        }
        reader
    }

    fn shell(&self, script: &str, environment: &[(&str, &str)]) -> Output {
        let path = format!("{}:{}", self.bin.path().display(), std::env::var("PATH").unwrap_or_default());
        let mut bash = Command::new("bash");
        bash.args(["-e", "-u", "-o", "pipefail", "-c", script]).current_dir(self.work.path());
        bash.env("PATH", &path).env("PYTHONPATH", Path::new(env!("CARGO_MANIFEST_DIR")).join("python"));
        bash.envs(environment.iter().copied()).output().expect("bash")
    }
}

/// Runs a page's commands in a folder of its own, and says which end with an error.
fn wrong(page: &Page) -> Vec<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let reader = Reader::new(&[]);
    let work = &reader.work;
    fs::write(work.path().join("hall.dxf"), HALL).expect("written");
    // Files may name others as far as the project goes.
    fs::create_dir(work.path().join(".git")).expect("a folder");
    let text = fs::read_to_string(root.join(page.path)).expect("the page");
    let mut left_out = BTreeSet::new();
    let mut wrong = Vec::new();
    let before = if page.before.is_empty() { None } else { Some(page.before.to_owned()) };
    for block in before.into_iter().chain(blocks(&text)) {
        let out: Vec<&str> =
            page.without.iter().map(|(begin, _)| *begin).filter(|b| block.lines().any(|l| l.starts_with(b))).collect();
        if !out.is_empty() {
            left_out.extend(out);
            continue;
        }
        let ended = reader.shell(&block, &[]);
        let refused = block.lines().any(|line| page.refused.contains(&line));
        if ended.status.success() == refused {
            let said = [ended.stdout, ended.stderr].map(|said| String::from_utf8_lossy(&said).into_owned()).concat();
            wrong.push(format!("{}:\n{block}ended with {}:\n{said}", page.path, ended.status));
        }
    }
    for (begin, _) in page.without.iter().filter(|(begin, _)| !left_out.contains(begin)) {
        wrong.push(format!("{} has no `{begin}` any more", page.path));
    }
    wrong
}

/// What the steps of a workflow run, in their order.
fn steps(workflow: &str) -> Vec<String> {
    let indent = |line: &str| line.len() - line.trim_start().len();
    let mut steps = Vec::new();
    let mut lines = workflow.lines().peekable();
    while let Some(line) = lines.next() {
        let Some(run) = line.trim_start_matches([' ', '-']).strip_prefix("run: ") else { continue };
        let mut step = if run == "|" { String::new() } else { format!("{run}\n") };
        while let Some(more) = lines.next_if(|next| run == "|" && indent(next) > indent(line)) {
            step += &format!("{}\n", more.trim_start());
        }
        steps.push(step);
    }
    steps
}

#[test]
fn the_workflow_comments_a_change_and_stops_a_bill_that_nobody_accepted() {
    let reader = Reader::new(&[("pip", "exit 0"), ("gh", "echo \"$@\" > gh.txt")]);
    let environment = [
        ("GITHUB_BASE_REF", "main"),
        ("GITHUB_STEP_SUMMARY", "summary.md"),
        ("HEAD", "HEAD"),
        ("NUMBER", "7"),
        ("GIT_CONFIG_GLOBAL", "/dev/null"),
    ];
    let shell = |script: &str| reader.shell(script, &environment);
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/ci-recipe.md");
    let page = fs::read_to_string(page).expect("the page");
    let workflow = page.split("```yaml\n").nth(1).and_then(|rest| rest.split("```").next()).expect("a workflow");
    let steps = steps(workflow);
    assert_eq!(steps.len(), 5);
    let begun = shell(REPOSITORY);
    assert!(begun.status.success(), "{}", String::from_utf8_lossy(&begun.stderr));
    for step in &steps {
        let ended = shell(step);
        assert!(ended.status.success(), "{step}{}", String::from_utf8_lossy(&ended.stderr));
    }
    let read = |name: &str| fs::read_to_string(reader.work.path().join(name)).expect(name);
    assert!(read("gh.txt").starts_with("pr comment 7 --body-file comment.md"));
    assert!(read("summary.md").contains("thesis10") && read("comment.md") == read("summary.md"));
    // A motor more is a bill that differs: first nobody says so, then the commit does.
    let change = "sed -i 's/motors 13/motors 14/' terminal_3.lss; git commit -qam ";
    for (message, passes) in [("'terminal: add motors'", false), ("'terminal: add motors' -m 'bill: accepted'", true)] {
        let changed = shell(&format!("git checkout -q HEAD -- terminal_3.lss; {change}{message} --allow-empty"));
        assert!(changed.status.success(), "{}", String::from_utf8_lossy(&changed.stderr));
        let ended = shell(steps.last().expect("steps"));
        assert_eq!(ended.status.success(), passes, "{message}: {}", String::from_utf8_lossy(&ended.stdout));
        shell("git reset -q --hard HEAD~1");
    }
}

#[test]
fn the_commands_of_the_documents_do_what_they_say() {
    let wrong: Vec<String> = PAGES.iter().flat_map(wrong).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
#[ignore = "about ten minutes"]
fn the_long_commands_of_the_documents_do_what_they_say() {
    let wrong: Vec<String> = LONG.iter().flat_map(wrong).collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_document_with_commands_is_run() {
    let listed: BTreeSet<&str> =
        PAGES.iter().chain(LONG).map(|page| page.path).chain(NONE.iter().map(|(path, _)| *path)).collect();
    let with: BTreeSet<String> = documents()
        .into_iter()
        .filter(|(path, text)| path.parent() != Some(Path::new("benches")) && !blocks(text).is_empty())
        .map(|(path, _)| path.display().to_string())
        .collect();
    let with: BTreeSet<&str> = with.iter().map(String::as_str).collect();
    assert_eq!(with, listed);
}
