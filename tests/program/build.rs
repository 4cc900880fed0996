//! `lss build` of several files, and where it writes.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use assert_cmd::Command;
use std::fs;
use std::path::Path;

fn layout(length: f64) -> String {
    format!(
        "use std.carts.tilt_tray\nuse std.tracks.standard\n\nlayout hall {{\n  catalog standard\n  \
         cart tilt_tray(length: 1250 mm)\n  speed 2.0 m/s\n  width 1.2 m\n\n  vertex P1 (3 m, 3 m) radius 3 m\n  vertex \
         P2 (17 m, 3 m) radius 3 m\n  vertex P3 (17 m, 13 m) radius 3 m\n  vertex P4 (3 m, 13 m) radius 3 m\n\n  \
         require length(straight(P1..P2)) >= {length} m\n\n  optimise length\n}}\n"
    )
}

fn build(folder: &Path, args: &[&str]) -> (i32, String, String) {
    let run = Command::cargo_bin("lss").unwrap().current_dir(folder).arg("build").args(args).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (run.status.code().unwrap(), text(&run.stdout), text(&run.stderr))
}

/// A folder with layouts: `oval.lss` twice, one that is no layout, and one that has a mistake.
fn plant() -> tempfile::TempDir {
    let plant = tempfile::tempdir().unwrap();
    for folder in ["a", "b"] {
        fs::create_dir(plant.path().join(folder)).unwrap();
    }
    for (name, text) in [
        ("a/oval.lss", layout(8.0)),
        ("b/oval.lss", layout(9.0)),
        ("hook.lss", layout(10.0)),
        ("broken.lss", layout(8.0).replace("speed", "sped")),
    ] {
        fs::write(plant.path().join(name), text).unwrap();
    }
    plant
}

#[test]
fn without_a_folder_outputs_go_to_one_of_the_files_name() {
    let plant = plant();
    let (code, said, wrong) = build(plant.path(), &["hook.lss"]);
    assert_eq!(code, 0, "{said}{wrong}");
    assert!(said.contains("written to out/hook"), "{said}");
    assert!(plant.path().join("out/hook/drawing.svg").is_file());
    // Printing a stage writes nothing, files for other solvers do.
    for (emit, name, written) in [("model", "b/oval.lss", false), ("mps", "a/oval.lss", true)] {
        let (code, _, wrong) = build(plant.path(), &[name, "--emit", emit]);
        assert_eq!(code, 0, "{wrong}");
        assert_eq!(plant.path().join("out/oval").exists(), written);
    }
}

#[test]
fn two_layouts_of_a_file_have_folders_of_their_own() {
    let plant = plant();
    let (_, body) = layout(8.0).split_once("layout hall").map(|(a, b)| (a.to_owned(), b.to_owned())).unwrap();
    let both =
        layout(8.0).replace("layout hall", "layout old") + "\nlayout new" + &body.replace("P2 (17 m", "P2 (19 m");
    fs::write(plant.path().join("two.lss"), both).unwrap();
    for name in ["old", "new"] {
        let (code, said, wrong) = build(plant.path(), &["two.lss", "--layout", name, "--format", "json"]);
        assert_eq!(code, 0, "{said}{wrong}");
        let summary: serde_json::Value = serde_json::from_str(&said).unwrap();
        let folder = format!("out/two-{name}");
        assert_eq!((summary["file"].as_str(), summary["output"].as_str()), (Some("two.lss"), Some(folder.as_str())));
        let written = fs::read_to_string(plant.path().join(&folder).join("layout.json")).unwrap();
        assert!(written.contains(&format!("\"name\": \"{name}\"")), "{written}");
    }
    assert!(!plant.path().join("out/two").exists());
}

#[test]
fn what_emit_does_not_take_names_what_does() {
    let plant = plant();
    for (what, instead) in
        [("gltf", "use --gltf"), ("step", "use --gltf"), ("xlsx", "use --xlsx"), ("pdf", "use --pdf")]
    {
        let (code, _, wrong) = build(plant.path(), &["hook.lss", "--emit", what]);
        assert_eq!(code, 2, "{wrong}");
        assert!(wrong.contains(instead) && wrong.contains(&format!("--emit {what}")), "{wrong}");
    }
    let (code, _, wrong) = build(plant.path(), &["hook.lss", "--emit", "nonsense"]);
    assert!(code == 2 && wrong.contains("possible values: model"), "{wrong}");
}

#[test]
fn each_of_several_files_is_built_and_the_worst_decides() {
    let plant = plant();
    let files = ["hook.lss", "broken.lss", "a/oval.lss", "b/oval.lss"];
    let (code, said, wrong) = build(plant.path(), &[files.as_slice(), &["-o", "to"]].concat());
    assert_eq!(code, 1, "{said}{wrong}");
    assert!(wrong.contains("broken.lss:7"), "{wrong}");
    let written: Vec<&str> = said.lines().filter_map(|line| line.trim().strip_prefix("written to ")).collect();
    assert_eq!(written, ["to/hook", "to/a-oval", "to/b-oval"]);
    for name in ["hook", "a-oval", "b-oval"] {
        assert!(plant.path().join("to").join(name).join("layout.json").is_file(), "{name}");
    }
    assert!(!plant.path().join("to/broken").exists());
    // What a file builds does not depend on its company.
    build(plant.path(), &["b/oval.lss", "-o", "alone"]);
    let read = |folder: &str| fs::read(plant.path().join(folder).join("layout.json")).unwrap();
    assert_eq!(read("alone"), read("to/b-oval"));
    // A file that is not there is worse than a mistake, and stops none of the others.
    let (code, said, wrong) = build(plant.path(), &["broken.lss", "gone.lss", "hook.lss"]);
    assert!((code, wrong.contains("gone.lss"), said.contains("out/hook")) == (2, true, true), "{said}{wrong}");
    // The summaries for machines are a line each.
    let (_, said, _) = build(plant.path(), &["hook.lss", "a/oval.lss", "--format", "json"]);
    let lengths: Vec<f64> = said
        .lines()
        .map(|line| serde_json::from_str::<serde_json::Value>(line).unwrap()["length_m"].as_f64().unwrap())
        .collect();
    assert_eq!(lengths.len(), 2);
    assert!(lengths[0] > lengths[1], "{lengths:?}");
}
