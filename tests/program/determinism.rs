//! Same input, same bytes: two runs, and one thread and several. That debug and release builds agree is held by the
//! committed snapshots of `tests/layouts/cases.rs`, which both profiles meet, and by the digest below. Simulations also with
//! every vector width that the processor has.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use assert_cmd::Command;
use lss::dynamics::Width;
use std::collections::BTreeMap;
use std::path::Path;

fn build(example: &str, threads: &str) -> BTreeMap<String, Vec<u8>> {
    let out = tempfile::tempdir().expect("a temporary folder");
    Command::cargo_bin("lss")
        .expect("the binary")
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(["build", example, "--stages", "--threads", threads, "-o"])
        .arg(out.path())
        .assert()
        .success();
    contents(out.path())
}

/// The files of a folder, by name.
fn contents(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(folder).expect("outputs");
    entries
        .map(|entry| {
            let path = entry.expect("an output").path();
            (path.file_name().expect("a name").to_string_lossy().into_owned(), std::fs::read(&path).expect("readable"))
        })
        .collect()
}

/// FNV-1a over names and contents.
fn digest(files: &BTreeMap<String, Vec<u8>>) -> u64 {
    let bytes = files.iter().flat_map(|(name, content)| name.bytes().chain(content.iter().copied()));
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3))
}

#[test]
fn two_runs_and_any_number_of_threads_write_the_same_bytes() {
    for example in ["examples/thesis10.lss", "examples/constraints.lss"] {
        let once = build(example, "1");
        assert_eq!(once.len(), 10, "{:?}", once.keys());
        for threads in ["1", "2", "5"] {
            let again = build(example, threads);
            for (name, bytes) in &once {
                assert!(again.get(name) == Some(bytes), "{example}: {name} differs with {threads} threads");
            }
        }
    }
}

#[test]
fn every_profile_writes_the_same_bytes() {
    let files = build("examples/thesis10.lss", "2");
    let digests: String = files
        .iter()
        .map(|f| format!("{:016x} {}\n", digest(&BTreeMap::from([(f.0.clone(), f.1.clone())])), f.0))
        .collect();
    insta::assert_snapshot!("thesis10_digests", digests);
}

#[test]
fn every_vector_width_writes_the_same_bytes() {
    let simulate = |width: &str| {
        let out = tempfile::tempdir().expect("a temporary folder");
        Command::cargo_bin("lss")
            .expect("the binary")
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .env("LSS_SIMD", width)
            .args(["simulate", "examples/smallest.lss", "--settle", "1s", "-o"])
            .arg(out.path())
            .assert()
            .success();
        contents(out.path())
    };
    let names: Vec<&str> = Width::all().into_iter().map(Width::name).collect();
    let scalar = simulate("scalar");
    assert_eq!(scalar.len(), 5, "{:?}", scalar.keys());
    // An empty name is none: the widest.
    for width in names.into_iter().chain([""]) {
        let other = simulate(width);
        for (name, bytes) in &scalar {
            assert!(other.get(name) == Some(bytes), "{name} differs with LSS_SIMD={width}");
        }
    }
}

#[test]
fn a_vector_width_that_is_none_is_refused_with_a_way_out() {
    let lacking = if cfg!(target_arch = "aarch64") { "avx2" } else { "neon" };
    for (width, why) in [("avx9", "there is no such vector width"), (lacking, "this processor does not have it")] {
        let assert = Command::cargo_bin("lss")
            .expect("the binary")
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .env("LSS_SIMD", width)
            .args(["check", "examples/smallest.lss"])
            .assert()
            .code(2);
        let told = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        assert!(
            told.contains(&format!("LSS_SIMD={width}: {why}")) && told.contains("help: this processor has"),
            "{told}"
        );
    }
}
