//! Same input, same bytes: two runs, and one thread and several. That debug and release builds agree is held by the
//! committed snapshots of `tests/cases.rs`, which both profiles meet, and by the digest below.

use assert_cmd::Command;
use std::collections::BTreeMap;

fn build(example: &str, threads: &str) -> BTreeMap<String, Vec<u8>> {
    let out = tempfile::tempdir().expect("a temporary folder");
    Command::cargo_bin("lss")
        .expect("the binary")
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .args(["build", example, "--stages", "--threads", threads, "-o"])
        .arg(out.path())
        .assert()
        .success();
    let entries = std::fs::read_dir(out.path()).expect("outputs");
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
        assert_eq!(once.len(), 9, "{:?}", once.keys());
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
