//! Messages about slips that users made: each names what is wrong and the way out.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use assert_cmd::Command;
use std::fs;
use std::path::Path;

const LAYOUT: &str = "use std.carts.tilt_tray
use std.tracks.standard

layout hall {
  catalog standard
  cart tilt_tray(length: 1250 mm)
  speed 2.0 m/s
  width 1.2 m

  vertex P1 (3 m, 3 m) radius 3 m
  vertex P2 (37 m, 3 m) radius 3 m
  vertex P3 (37 m, 17 m) radius 3 m
  vertex P4 (3 m, 17 m) radius 3 m

  building [(0 m, 0 m), (40 m, 0 m), (40 m, 20 m), (0 m, 20 m)]
  obstacle column [(19 m, 8 m), (21 m, 8 m), (21 m, 10 m), (19 m, 10 m)] clearance 0.5 m
  fix all P1..P2

  optimise length
}
";

/// What a command says on standard error; it must not succeed.
fn refused(folder: &Path, args: &[&str]) -> String {
    let out = Command::cargo_bin("lss").expect("the binary").current_dir(folder).args(args).assert().failure();
    String::from_utf8_lossy(&out.get_output().stderr).into_owned()
}

/// What `lss check` says of the layout with a text replaced, without its line breaks.
fn checked(from: &str, to: &str) -> String {
    assert!(LAYOUT.contains(from));
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("hall.lss"), LAYOUT.replace(from, to)).expect("written");
    refused(folder.path(), &["check", "hall.lss"]).replace("\n        ", " ")
}

#[test]
fn the_layout_itself_is_clean() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("hall.lss"), LAYOUT).expect("written");
    let mut command = Command::cargo_bin("lss").expect("the binary");
    command.current_dir(folder.path()).args(["check", "hall.lss"]).assert().success();
}

#[test]
fn a_decimal_comma_becomes_a_point() {
    for (from, to, meant) in [
        ("speed 2.0 m/s", "speed 2,0 m/s", "write `2.0`"),
        ("width 1.2 m", "width 1,25 m", "write `1.25`"),
        ("P1 (3 m, 3 m)", "P1 (3,5 m, 3 m)", "write `3.5`"),
        ("radius 3 m\n  vertex P2", "radius 3,0 m\n  vertex P2", "write `3.0`"),
    ] {
        let said = checked(from, to);
        assert!(said.contains(meant) && said.contains("1 error"), "{said}");
        assert!(!said.contains("leave `,` out"), "{said}");
    }
    let said = checked("P1 (3 m, 3 m)", "P1 (3,5 m, 3,25 m)");
    assert!(said.contains("write `3.5`") && said.contains("write `3.25`") && said.contains("2 errors"), "{said}");
}

#[test]
fn a_file_that_is_no_layout_is_named_with_the_verb_that_reads_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    fs::write(at.join("hall.lss"), LAYOUT).expect("written");
    let mut build = Command::cargo_bin("lss").expect("the binary");
    build.current_dir(at).args(["build", "hall.lss", "-o", "out"]).assert().success();
    fs::write(at.join("campaign.toml"), "layout = \"hall.lss\"\n\n[[run]]\nfile = \"run-01.csv\"\n").expect("written");
    fs::write(at.join("run-01.toml"), "layout = \"hall.lss\"\nsensor_cart = 1\n").expect("written");
    fs::write(at.join("run-01.csv"), "time,trigger\n0,0\n").expect("written");
    let said = refused(at, &["simulate", "out/layout.json", "-o", "again"]);
    assert!(said.contains("is not a simulation input: it is the result of a build"), "{said}");
    for (file, is, verb) in [
        ("out/simulation.json", "a simulation input", "`lss simulate`"),
        ("out/layout.json", "the result of a build", "`lss build`"),
        ("out/bom.json", "a bill of elements", "`lss build`"),
        ("out/bom.csv", "a bill of elements", "`lss build`"),
        ("out/drawing.dxf", "a drawing", "`lss import`"),
        ("campaign.toml", "a campaign", "`lss runs`"),
        ("run-01.toml", "the sidecar of a run", "`lss compare`"),
        ("run-01.csv", "a run", "`lss compare`"),
    ] {
        for verb_tried in [&["build", file, "-o", "again"][..], &["check", file], &["fmt", file]] {
            let said = refused(at, verb_tried);
            assert!(said.contains(&format!("{file}: it is {is}, not a layout")), "{said}");
            assert!(said.contains(verb) && said.lines().count() == 2, "{said}");
        }
    }
}

#[test]
fn a_folder_is_named_with_the_layouts_in_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    fs::create_dir(at.join("plant")).expect("a folder");
    assert!(refused(at, &["build", "plant"]).contains("plant: it is a folder, without a layout (.lss) in it"));
    fs::write(at.join("plant/ring.lss"), LAYOUT).expect("written");
    for verb in ["build", "check", "diff"] {
        let words = [&[verb, "plant/"][..], if verb == "diff" { &["plant/ring.lss"] } else { &[] }].concat();
        let said = refused(at, &words);
        assert!(said.contains("it is a folder: name the layout in it, plant/ring.lss"), "{said}");
    }
    fs::write(at.join("plant/hall.lss"), LAYOUT).expect("written");
    let said = refused(at, &["build", "plant"]);
    assert!(said.contains("name layouts in it: plant/hall.lss, plant/ring.lss"), "{said}");
}

#[test]
fn a_layout_given_for_a_run_or_a_campaign_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("hall.lss"), LAYOUT).expect("written");
    for verb in [
        &["compare", "hall.lss", "hall.lss"][..],
        &["runs", "hall.lss"],
        &["identify", "hall.lss", "-o", "out"],
        &["gap", "diagnose", "hall.lss", "-o", "out"],
    ] {
        let said = refused(folder.path(), verb);
        assert!(said.contains("hall.lss: is a layout, not a run or a campaign"), "{verb:?}: {said}");
        assert!(said.contains("`lss simulate` makes a run of it"), "{said}");
    }
}

#[test]
fn a_vertex_outside_the_hall_is_named_with_how_far() {
    let said = checked("P3 (37 m, 17 m)", "P3 (42.5 m, 17 m)");
    assert!(said.contains("`P3` lies 2.5 m outside"), "{said}");
    assert!(said.contains("found `P3` 2.5 m outside") && said.contains("1 error"), "{said}");
}

#[test]
fn a_run_without_its_sidecar_names_the_missing_file() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("run-01.csv"), "time,trigger\n0,0\n0.002,0\n").expect("written");
    for verb in [
        &["compare", "run-01.csv", "run-01.csv"][..],
        &["runs", "."],
        &["runs", "run-01.csv"],
        &["identify", ".", "-o", "out"],
    ] {
        let said = refused(folder.path(), verb);
        assert!(said.contains("there is no sidecar") && said.contains("run-01.toml"), "{verb:?}: {said}");
    }
}

#[test]
fn the_nearest_effect_is_named_first() {
    let said = checked("  optimise length", "  effect wheel_slip(share: 0.1)\n  optimise length");
    assert!(said.contains("expected `wheel_sliding`, "), "{said}");
    let said = checked("  optimise length", "  effect joint_clearence(gap: 0.1 mm)\n  optimise length");
    assert!(
        said.contains("expected `joint_clearance`, ") && said.contains("did you mean `joint_clearance`?"),
        "{said}"
    );
}

#[test]
fn a_crossing_loop_gets_one_message() {
    // Written row by row, not in driving order.
    let vertices = LAYOUT.find("  vertex P1").unwrap()..LAYOUT.find("  building").unwrap();
    let rows = "  vertex P1 (3 m, 3 m) radius 3 m\n  vertex P2 (37 m, 17 m) radius 3 m\n  \
                vertex P3 (20 m, 3 m) radius 3 m\n  \
                vertex P4 (3 m, 17 m) radius 3 m\n  vertex P5 (37 m, 3 m) radius 3 m\n  \
                vertex P6 (20 m, 17 m) radius 3 m\n\n";
    let said = checked(&LAYOUT[vertices], rows);
    assert_eq!(said.matches("E0405").count(), 1, "{said}");
    assert!(said.contains("are the vertices in driving order?"), "{said}");
    assert!(said.contains("more times"), "{said}");
}

#[test]
fn a_fixed_section_through_an_obstacle_or_out_of_the_building_is_told_by_check() {
    let said = checked(
        "obstacle column [(19 m, 8 m), (21 m, 8 m), (21 m, 10 m), (19 m, 10 m)]",
        "obstacle column [(19 m, 2 m), (21 m, 2 m), (21 m, 5 m), (19 m, 5 m)]",
    );
    assert!(said.contains("`P1..P2` is fixed and runs through obstacle `column`"), "{said}");
    let near = "obstacle column [(19 m, 4 m), (21 m, 4 m), (21 m, 5 m), (19 m, 5 m)]";
    let said = checked("obstacle column [(19 m, 8 m), (21 m, 8 m), (21 m, 10 m), (19 m, 10 m)]", near);
    assert!(said.contains("`P1..P2` is fixed too near to obstacle `column`"), "{said}");
    assert!(said.contains("expected 1.1 m at least") && said.contains("found 1 m from"), "{said}");
    let wall = "building [(0 m, 2.5 m), (40 m, 2.5 m), (40 m, 20 m), (0 m, 20 m)]";
    let said = checked("building [(0 m, 0 m), (40 m, 0 m), (40 m, 20 m), (0 m, 20 m)]", wall);
    assert!(said.contains("`P1..P2` is fixed too near to the building"), "{said}");
    // Two fixed vertices hold the section between them, too.
    let both = "obstacle column [(19 m, 2 m), (21 m, 2 m), (21 m, 5 m), (19 m, 5 m)] clearance 0.5 m\n  fix P1\n  \
                fix P2\n\n  optimise";
    let old = "obstacle column [(19 m, 8 m), (21 m, 8 m), (21 m, 10 m), (19 m, 10 m)] clearance 0.5 m\n  \
               fix all P1..P2\n\n  optimise";
    assert!(checked(old, both).contains("`P1..P2` is fixed and runs through obstacle `column`"));
}
