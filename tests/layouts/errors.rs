//! Every code has a page and a case. The case is the page's example; its snapshot shows the source and then the
//! message.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use lss::compiled::Compiled;
use lss::diagnostic::{Code, Diagnostic, text};
use lss::dynamics::Width;
use lss::geometry::Track;
use lss::semantics::analyse;
use lss::solve::unsupported;
use lss::source::{Loader, SourceMap};
use lss::study::Plan;
use lss::study::plan::NoPlan;
use lss::{choose, elements, import, route, solve};

fn folder(code: Code) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/errors").join(code.as_str())
}

/// What the case's main file is called: codes of an import have a drawing, those of a study a study.
fn input(code: Code) -> &'static str {
    match &code.as_str()[1..3] {
        "08" => "input.dxf",
        "09" => "input.toml",
        _ => "input.lss",
    }
}

/// The case's files, `input.lss` first. `NAME.spaces` holds the number of spaces that the file NAME is made of.
fn files(code: Code) -> Vec<(String, Vec<u8>)> {
    let input = fs::read(folder(code).join("input.lss")).unwrap_or_else(|_| panic!("{code:?} has no case"));
    let mut files = vec![("input.lss".to_string(), input)];
    for entry in fs::read_dir(folder(code)).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        match name.strip_suffix(".spaces") {
            Some(name) => {
                let count: usize = fs::read_to_string(&path).unwrap().trim().parse().unwrap();
                files.push((name.to_string(), vec![b' '; count]));
            }
            None if name.ends_with(".lss") && name != "input.lss" => files.push((name, fs::read(&path).unwrap())),
            None => {}
        }
    }
    files
}

/// What checking the case says, and building or importing it where that is what the code is about.
fn run(code: Code) -> (SourceMap, Vec<Diagnostic>) {
    let mut sources = SourceMap::default();
    if input(code) == "input.dxf" {
        let text =
            fs::read_to_string(folder(code).join("input.dxf")).unwrap_or_else(|_| panic!("{code:?} has no case"));
        let drawing = sources.add("input.dxf", text);
        let (_, said) = import::read(&sources, drawing, &import::Options::default());
        return (sources, said);
    }
    if input(code) == "input.toml" {
        let path = folder(code).join("input.toml");
        let wrong = match Plan::read(&mut sources, &path, &|_| Ok(())) {
            Err(NoPlan::Wrong(wrong)) => wrong,
            other => panic!("{code:?}: {other:?}"),
        };
        // Messages name the file as it was given.
        let mut plain = SourceMap::default();
        for id in sources.ids() {
            plain.add("input.toml", sources.file(id).text.clone());
        }
        return (plain, wrong);
    }
    let files = files(code);
    let files: Vec<(&str, &[u8])> = files.iter().map(|(name, bytes)| (name.as_str(), bytes.as_slice())).collect();
    let (mut loader, main) = Loader::memory(&mut sources, &files).expect("input.lss is text");
    let analysis = analyse(&mut sources, &mut loader, main, None);
    let mut diagnostics = analysis.diagnostics.clone();
    match (code, analysis.chosen()) {
        (Code::E0217, Err(diagnostic)) => diagnostics.push(*diagnostic),
        (Code::E0650, Ok(Some(layout))) => diagnostics.extend(unsupported(layout)),
        (Code::W0710, Ok(Some(layout))) => {
            let written = Track::new(&layout.corners());
            diagnostics.extend(elements::lacking(&elements::sequence(&written, layout), layout));
        }
        (Code::E0410 | Code::E0411 | Code::W0711, Ok(Some(layout))) => {
            diagnostics.extend(Compiled::new(layout.clone(), Vec::new()).heights);
        }
        (Code::E0603, Ok(Some(layout))) => {
            let compiled = Compiled::new(layout.clone(), solve::solve(layout, &solve::Options::default(), &|_| {}));
            diagnostics.extend(solve::unclosed(layout, &compiled.track, &compiled.space.line));
        }
        (Code::E0604, Ok(Some(layout))) => {
            let compiled = Compiled::new(layout.clone(), solve::solve(layout, &solve::Options::default(), &|_| {}));
            diagnostics.extend(compiled.short_of_capacity());
        }
        (Code::E0605, Ok(Some(layout))) => {
            let settings = choose::Settings {
                options: solve::Options::default(),
                width: Width::used(),
                checks: 0,
                tracks_within: None,
            };
            diagnostics.extend(choose::refused(&choose::choose(layout, &settings, &|_| ()).unwrap()));
        }
        (Code::E0606, Ok(Some(layout))) => {
            diagnostics.extend(lss::placement::findings(layout, &Track::new(&layout.corners())));
        }
        (Code::W0712, Ok(Some(layout))) => {
            let compiled = Compiled::new(layout.clone(), solve::solve(layout, &solve::Options::default(), &|_| {}));
            diagnostics.extend(solve::left_over(layout, &compiled.track, &compiled.space.line, compiled.chain));
        }
        (Code::W0713, Ok(Some(layout))) => {
            let compiled = Compiled::new(layout.clone(), Vec::new());
            diagnostics.extend(lss::placement::conveyors(layout, &compiled.track, &compiled.placement));
        }
        (Code::E0414, Ok(Some(layout))) => {
            let found = route::find(layout, &solve::Options::default(), &|_| {});
            diagnostics.extend(found.err().unwrap_or_default());
        }
        (Code::E0601 | Code::E0602, Ok(Some(layout))) => {
            diagnostics.extend(solve::diagnose(layout, &solve::solve(layout, &solve::Options::default(), &|_| {})));
        }
        (Code::W0705, Ok(Some(layout))) => {
            let stages = solve::solve(layout, &solve::Options::default(), &|_| {});
            diagnostics.extend(solve::implied(layout, &stages));
        }
        _ => {}
    }
    (sources, diagnostics)
}

/// What each case says, in the order of codes. Cases that are solved take seconds, and two tests look at them.
fn said() -> &'static [(SourceMap, Vec<Diagnostic>)] {
    static SAID: OnceLock<Vec<(SourceMap, Vec<Diagnostic>)>> = OnceLock::new();
    SAID.get_or_init(|| {
        let (first, second) = Code::ALL.split_at(Code::ALL.len() / 2);
        std::thread::scope(|scope| {
            let first = scope.spawn(|| first.iter().map(|code| run(*code)).collect::<Vec<_>>());
            let second: Vec<_> = second.iter().map(|code| run(*code)).collect();
            let mut all = first.join().expect("no panic");
            all.extend(second);
            all
        })
    })
}

/// The first example in a page.
fn example(page: &str) -> Option<&str> {
    let (_, rest) =
        page.split_once("```lss\n").or_else(|| page.split_once("```dxf\n")).or_else(|| page.split_once("```toml\n"))?;
    rest.split_once("```").map(|(example, _)| example)
}

#[test]
fn every_code_reports_its_page_example_and_nothing_else() {
    let mut failures = Vec::new();
    for (code, (sources, diagnostics)) in Code::ALL.iter().zip(said()) {
        let input =
            fs::read_to_string(folder(*code).join(input(*code))).unwrap_or_else(|_| panic!("{code:?} has no case"));
        if example(code.page()) != Some(input.as_str()) {
            failures.push(format!("{code:?}: page and case differ"));
        }
        let report: String = diagnostics.iter().map(|d| text::render(sources, d, text::Style::Plain)).collect();
        if !diagnostics.iter().any(|d| d.code == *code) {
            failures.push(format!("{code:?} is not raised by its case:\n{report}"));
        }
        // E0112 stands for mistakes that are not shown, and so comes with others.
        if *code != Code::E0112 && diagnostics.iter().any(|d| d.code != *code) {
            failures.push(format!("{code:?}: the case has other mistakes too:\n{report}"));
        }
        let shown: Vec<&Diagnostic> = diagnostics.iter().filter(|d| d.code == *code).collect();
        let report: String = shown.iter().map(|d| text::render(sources, d, text::Style::Plain)).collect();
        let mut settings = insta::Settings::clone_current();
        settings.set_snapshot_path(folder(*code));
        settings.set_prepend_module_to_snapshot(false);
        settings.set_omit_expression(true);
        settings.bind(|| insta::assert_snapshot!("report", format!("{input}\n{}\n{report}", "─".repeat(100))));
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn pages_have_one_form() {
    for code in Code::ALL {
        let page = code.page();
        let title = format!("# {} {}\n", code.as_str(), code.name());
        assert!(page.starts_with(&title), "{code:?}: the title is not {title:?}");
        for heading in ["\n## Why\n", "\n## Example\n", "\n## How to fix it\n"] {
            assert!(page.contains(heading), "{code:?} lacks {heading:?}");
        }
    }
}

#[test]
fn every_diagnostic_says_what_was_expected_and_found() {
    for (code, (_, diagnostics)) in Code::ALL.iter().zip(said()).filter(|(c, _)| c.as_str() >= "E02") {
        for diagnostic in diagnostics {
            let fixed = diagnostic.help.is_some() || diagnostic.fix.is_some() || diagnostic.expected.is_some();
            assert!(fixed, "{code:?}: {} shows no way out", diagnostic.message);
        }
    }
}
