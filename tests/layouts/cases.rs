//! Every example through every stage of the compiler, one snapshot a stage in `tests/cases/<name>/`. The same snapshots
//! hold in debug and release builds (`cargo test --release --test layouts cases::`).

#![allow(clippy::expect_used, clippy::unwrap_used)]

use lss::compiled::Compiled;
use lss::emit;
use lss::model::{self, Layout};
use lss::problem::{self, Problem, Scope};
use lss::semantics::analyse;
use lss::solve::{self, Options, Stage, unsupported};
use lss::source::{Loader, SourceMap};
use std::path::Path;

const CASES: [&str; 11] = [
    "constraints",
    "equipment",
    "even",
    "hub",
    "levels",
    "parcel_hub",
    "reference",
    "smallest",
    "spiral",
    "thesis10",
    "written",
];

/// The text of an example.
fn text(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(format!("{name}.lss"));
    std::fs::read_to_string(&path).unwrap_or_else(|why| panic!("{}: {why}", path.display()))
}

fn check(name: &str, text: &str) -> (SourceMap, Layout) {
    let mut sources = SourceMap::default();
    let file = format!("{name}.lss");
    let (mut loader, main) = Loader::memory(&mut sources, &[(&file, text.as_bytes())]).expect("text");
    let analysis = analyse(&mut sources, &mut loader, main, None);
    assert!(analysis.diagnostics.is_empty(), "{name}: {:?}", analysis.diagnostics);
    let layout = analysis.chosen().expect("one layout").expect("no mistakes").clone();
    assert!(unsupported(&layout).is_empty());
    (sources, layout)
}

/// Lengths to 10 µm, which is what the stages promise.
fn told(stages: &[Stage]) -> String {
    let line = |s: &Stage| {
        format!("{:<8} {:.5} m {:?}, violation below 1e-6: {}\n", s.name, s.length, s.status, s.max_violation <= 1e-6)
    };
    stages.iter().map(line).collect()
}

#[test]
fn every_stage_of_every_example() {
    for name in CASES {
        let text = text(name);
        let (sources, layout) = check(name, &text);
        let stages = solve::solve(&layout, &Options::default(), &|_| {});
        let compiled = Compiled::new(layout.clone(), stages);
        // The thesis does not ask for it, and the other one was built with carts of its own.
        assert_eq!(compiled.chain_fits(), !["thesis10", "levels"].contains(&name), "{name}: {:?}", compiled.chain);
        let mut settings = insta::Settings::clone_current();
        settings.set_snapshot_path(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cases").join(name));
        settings.set_prepend_module_to_snapshot(false);
        settings.set_omit_expression(true);
        settings.bind(|| {
            insta::assert_snapshot!("1-model", model::print(&layout));
            insta::assert_snapshot!("2-problem", problem::print(&Problem::new(&layout, Scope::Obstacles), &sources));
            insta::assert_snapshot!("3-stages", told(&compiled.stages));
            for (file, bytes) in emit::data_files(&compiled, &emit::OwnNumbers::default()) {
                if file == "bom.csv" || file == "simulation.json" {
                    let step = if file == "bom.csv" { "4-bom" } else { "5-simulation" };
                    insta::assert_snapshot!(step, String::from_utf8(bytes).expect("text"));
                }
            }
        });
    }
}

#[test]
fn examples_are_formatted() {
    for name in CASES {
        let text = text(name);
        let mut sources = SourceMap::default();
        let (tree, mistakes) = lss::syntax::parse(sources.add(name, text.clone()), &text);
        assert!(mistakes.is_empty());
        assert_eq!(lss::syntax::format(&tree, &text), text, "{name}.lss");
    }
}

/// What a printed model says is the layout again: building it gives the same bill.
#[test]
fn a_printed_model_builds_the_same() {
    let (_, layout) = check("smallest", &text("smallest"));
    let (_, again) = check("printed", &model::print(&layout));
    let bill = |layout: &Layout| {
        let compiled = Compiled::new(layout.clone(), solve::solve(layout, &Options::default(), &|_| {}));
        emit::bom::csv(&compiled, &emit::OwnNumbers::default())
    };
    assert_eq!(bill(&layout), bill(&again));
}
