//! Input that means harm, or was mangled on the way: it ends in diagnostics, quickly, and never in a panic.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use lss::diagnostic::{Diagnostic, json, text};
use lss::semantics::{Analysis, analyse};
use lss::solve::unsupported;
use lss::source::{Loader, SourceMap};
use proptest::prelude::*;

/// Checks a text and shows everything that is said about it.
fn run(text: &str) -> Analysis {
    let mut sources = SourceMap::default();
    let (mut loader, main) = Loader::memory(&mut sources, &[("main.lss", text.as_bytes())]).expect("UTF-8");
    let analysis = analyse(&mut sources, &mut loader, main, None);
    for diagnostic in analysis.diagnostics.iter().take(200) {
        text::render(&sources, diagnostic, text::Style::Plain);
        json::line(&sources, diagnostic);
    }
    for layout in &analysis.layouts {
        unsupported(layout);
        lss::model::print(layout);
    }
    analysis
}

const SEEDS: [&str; 4] = [
    include_str!("../../examples/thesis10.lss"),
    include_str!("../../examples/errors.lss"),
    include_str!("../../stdlib/tracks.lss"),
    include_str!("../../stdlib/carts.lss"),
];

/// What a slip or an attack puts in place of a word.
const WORDS: [&str; 24] = [
    "0",
    "-1",
    "1e308 m",
    "1e999",
    "inf",
    "NaN",
    "P1",
    "P2..P3",
    "\"",
    "{",
    "}",
    "[",
    ")",
    "..",
    "from",
    "layout",
    "let a = a",
    "1000000",
    "0 m",
    "90 deg",
    "length(P1..P2)",
    "radius",
    "sqrt(-1)",
    "10 %",
];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn mutated_layouts_never_panic(
        seed in 0..SEEDS.len(),
        edits in prop::collection::vec((any::<prop::sample::Index>(), 0..4u8, 0..WORDS.len()), 1..6),
    ) {
        let ends = [' ', '\n', ',', '(', ')'];
        let mut words: Vec<String> = SEEDS[seed].split_inclusive(ends).map(str::to_string).collect();
        for (at, what, word) in edits {
            let at = at.index(words.len());
            match what {
                0 => words[at] = format!("{} ", WORDS[word]),
                1 => words[at].clear(),
                2 => words[at] = words[at].repeat(2),
                _ => {
                    let other = word * 31 % words.len();
                    words.swap(at, other);
                }
            }
        }
        run(&words.concat());
    }
}

/// A loop with that many vertices on a circle, and lines in it.
fn circle(vertices: usize, more: &str) -> String {
    let mut text = String::from(
        "use std.carts.tilt_tray\nuse std.tracks.standard\nlayout big {\n  catalog standard\n  cart tilt_tray\n  \
         speed 2 m/s\n  width 1.2 m\n",
    );
    for i in 0..vertices {
        let angle = i as f64 / vertices as f64 * std::f64::consts::TAU;
        let (x, y) = (10_000.0 * libm::cos(angle), 10_000.0 * libm::sin(angle));
        text += &format!("  vertex P{i} ({x:.6} m, {y:.6} m) radius 3 m\n");
    }
    text + more + "}\n"
}

fn codes(diagnostics: &[Diagnostic]) -> Vec<&'static str> {
    let mut codes: Vec<&str> = diagnostics.iter().map(|d| d.code.as_str()).collect();
    codes.sort_unstable();
    codes.dedup();
    codes
}

#[test]
fn ten_thousand_vertices_are_one_message() {
    assert_eq!(codes(&run(&circle(10_000, "")).diagnostics), ["E0309"]);
}

#[test]
fn a_tangle_ends_after_some_crossings() {
    // Every long section crosses every other.
    let mut text = circle(0, "");
    text.truncate(text.len() - 2);
    for i in 0..1_000 {
        let y = f64::from(i) * 40.0;
        let x = if i % 2 == 0 { -9e4 + 50.0 * f64::from(i) } else { 9e4 - 50.0 * f64::from(i) };
        text += &format!("  vertex P{i} ({x} m, {} m) radius 3 m\n", if i % 3 == 0 { y } else { 4e4 - y });
    }
    let analysis = run(&(text + "}\n"));
    assert!(analysis.diagnostics.len() < 2_000 && analysis.has_errors());
}

#[test]
fn long_chains_of_definitions_do_not_exhaust_the_stack() {
    let forwards: String = (1..5_000).map(|i| format!("let a{i} = a{} + 1 m\n", i - 1)).collect();
    assert!(run(&format!("let a0 = 1 m\n{forwards}")).diagnostics.is_empty(), "in order, any number is fine");
    let backwards: String = (0..5_000).map(|i| format!("let a{i} = a{} + 1 m\n", i + 1)).collect();
    assert_eq!(codes(&run(&format!("{backwards}let a5000 = 1 m\n")).diagnostics), ["E0309"]);
    let extends: String = (0..5_000).map(|i| format!("cart c{i} from c{}\n", i + 1)).collect();
    run(&extends);
    let layouts: String = (0..5_000).map(|i| format!("layout l{i} from l{}\n", i + 1)).collect();
    run(&layouts);
}

#[test]
fn ten_thousand_unknown_names_end_quickly() {
    let lines: String = (0..8_000).map(|i| format!("  fix Q{i}xyz\n")).collect();
    let analysis = run(&circle(2_000, &lines));
    assert_eq!(analysis.diagnostics.iter().filter(|d| d.code.as_str() == "E0207").count(), 8_000);
}

/// A column that repeats one value is small, however long it is.
#[test]
fn a_parquet_file_of_endless_columns_is_refused() {
    use ::parquet::basic::Compression;
    use ::parquet::data_type::DoubleType;
    use ::parquet::file::properties::WriterProperties;
    use ::parquet::file::writer::SerializedFileWriter;
    use ::parquet::schema::parser::parse_message_type;
    use lss::signal::{DataProblem, parquet};
    use std::sync::Arc;

    let names = ["time", "joint_xi", "joint_eta", "joint_zeta", "run_left", "run_right", "temperature"];
    let columns: String = names.iter().map(|name| format!("required double {name};")).collect();
    let schema = Arc::new(parse_message_type(&format!("message run {{ {columns} }}")).unwrap());
    let properties = Arc::new(WriterProperties::builder().set_compression(Compression::SNAPPY).build());
    let file = tempfile::NamedTempFile::new().unwrap();
    let mut writer = SerializedFileWriter::new(file.as_file(), schema, properties).unwrap();
    let same = vec![1.0; 4 << 20];
    for _ in 0..10 {
        let mut group = writer.next_row_group().unwrap();
        while let Some(mut column) = group.next_column().unwrap() {
            column.typed::<DoubleType>().write_batch(&same, None, None).unwrap();
            column.close().unwrap();
        }
        group.close().unwrap();
    }
    writer.close().unwrap();
    assert!(file.as_file().metadata().unwrap().len() < 1 << 20, "a bomb is small");
    let found = parquet::read(file.reopen().unwrap(), file.path()).expect_err("too large");
    assert!(matches!(found.problem, DataProblem::TooLong { .. }), "{found}");
}

/// A sum of such values is infinite, and so is its square.
#[test]
fn absurd_numbers_in_a_run_are_refused_in_every_format() {
    use lss::signal::{Channel, DataProblem, Run, csv, parquet};
    use std::path::Path;

    for value in [1e308, -1e308, 1.1e9] {
        let mut run = Run { time: vec![0.0, 1.0, 2.0], ..Run::default() };
        run.channels.insert(Channel::JointXi, vec![0.0, value, 0.0]);
        let mut file = tempfile::NamedTempFile::new().unwrap();
        std::io::Write::write_all(&mut file, &parquet::write(&run).unwrap()).unwrap();
        let text = format!("time,joint_xi\n0,0\n1,{value}\n2,0\n");
        let told = [
            csv::read(text.as_bytes(), Path::new("run.csv")).expect_err("absurd"),
            parquet::read(file.reopen().unwrap(), Path::new("run.parquet")).expect_err("absurd"),
        ];
        for (found, row) in told.iter().zip([3, 2]) {
            assert!(matches!(found.problem, DataProblem::Beyond { .. }), "{found}");
            assert_eq!((found.place.row, found.place.column.as_deref()), (Some(row), Some("joint_xi")), "{found}");
        }
    }
}

#[test]
fn deep_nesting_of_json_and_toml_is_an_error() {
    use lss::chain_input::Simulation;
    use lss::gap::outside;
    use lss::signal::{Campaign, Sidecar};
    use std::path::Path;

    let deep = 200_000;
    for (open, close) in [("[", "]"), ("{\"a\":", "}"), ("{\"effects\":[", "]}")] {
        let text = open.repeat(deep) + &close.repeat(deep);
        assert!(Simulation::read(text.as_bytes()).is_err());
        assert!(outside::description(&text).is_err() && outside::series(&text, &[], 0.0, 1.0).is_err());
    }
    for text in [
        format!("a = {}{}", "[".repeat(deep), "]".repeat(deep)),
        format!("a = {}1{}", "{a = ".repeat(deep), "}".repeat(deep)),
        format!("{} = 1", "a.".repeat(deep) + "a"),
        format!("[{}]\nb = 1", "a.".repeat(deep) + "a"),
    ] {
        assert!(Sidecar::read(text.as_bytes(), Path::new("run.toml")).is_err());
        assert!(Campaign::files(text.as_bytes(), Path::new("campaign.toml")).is_err());
    }
}

#[test]
fn imports_without_end_are_one_message() {
    let names: Vec<String> = (0..600).map(|i| format!("f{i}.lss")).collect();
    let texts: Vec<String> = (0..600).map(|i| format!("use \"f{}.lss\"\n", i + 1)).collect();
    let files: Vec<(&str, &[u8])> = names.iter().map(String::as_str).zip(texts.iter().map(String::as_bytes)).collect();
    let mut sources = SourceMap::default();
    let (mut loader, main) = Loader::memory(&mut sources, &files).expect("UTF-8");
    let said = analyse(&mut sources, &mut loader, main, None).diagnostics;
    assert!(codes(&said).contains(&"E0309"), "{:?}", codes(&said));
    // In a circle, each is read once.
    let (mut loader, main) =
        Loader::memory(&mut sources, &[("f0.lss", b"use \"f1.lss\""), ("f1.lss", b"use \"f0.lss\"")]).unwrap();
    analyse(&mut sources, &mut loader, main, None);
}

/// What fuzzing found: a page without its dictionary and a length of too many bytes, which were panics; a dictionary of
/// a few bytes that says to be of gigabytes; a field that ends behind the file, which took minutes.
#[test]
fn parquet_files_that_fuzzing_found_end_in_errors() {
    use lss::signal::parquet;
    use std::fs::{File, read_dir};

    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/seeds/parquet");
    let mut found = 0;
    for entry in read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let read = parquet::read(File::open(&path).unwrap(), &path);
        let is_bad = path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("found-"));
        assert_eq!(read.is_err(), is_bad, "{}: {:?}", path.display(), read.err());
        found += usize::from(is_bad);
    }
    assert_eq!(found, 4);
}
