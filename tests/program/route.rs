//! From a drawing of a hall to a layout with vertices, as users go.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use assert_cmd::Command;
use serde_json::Value;
use std::fs;

fn lss() -> Command {
    let mut command = Command::cargo_bin("lss").expect("the binary");
    command.current_dir(env!("CARGO_MANIFEST_DIR"));
    command
}

/// A hall of 50 m by 30 m with a section along each long wall, in millimetres.
pub const HALL: &str = "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n\
                    0\nLWPOLYLINE\n8\nBUILDING\n90\n4\n70\n1\n10\n0\n20\n0\n10\n50000\n20\n0\n10\n50000\n20\n30000\n\
                    10\n0\n20\n30000\n\
                    0\nLINE\n8\nSECTIONS-INDUCTIONS\n10\n10000\n20\n3000\n11\n30000\n21\n3000\n\
                    0\nLINE\n8\nSECTIONS-CHUTES\n10\n40000\n20\n27000\n11\n12000\n21\n27000\n0\nENDSEC\n0\nEOF\n";

#[test]
fn a_hall_becomes_a_route_and_a_route_a_layout() {
    let folder = tempfile::tempdir().expect("a folder");
    let (drawing, plant) = (folder.path().join("hall.dxf"), folder.path().join("plant"));
    fs::write(&drawing, HALL).expect("written");
    lss().arg("new").arg(&plant).args(["--route", "--from"]).arg(&drawing).assert().success();
    let asked = plant.join("plant.lss");
    let text = fs::read_to_string(&asked).expect("a layout");
    assert!(text.contains("section chutes (40 m, 27 m)..(12 m, 27 m)\n  route inductions, chutes\n"), "{text}");

    let out = plant.join("out");
    let built = lss().arg("build").arg(&asked).args(["--nodes", "50", "--format", "json", "-o"]).arg(&out).assert();
    let said: Value = serde_json::from_slice(&built.success().get_output().stdout).expect("JSON");
    let route = &said["route"];
    assert_eq!(route["sections"].as_array().map(Vec::len), Some(2));
    assert!(route["lower_bound_m"].as_f64().unwrap() <= said["length_m"].as_f64().unwrap());
    let found = fs::read_to_string(out.join("layout.lss")).expect("the layout with vertices");
    assert!(found.contains("vertex P1 ") && found.contains(" on P1..P2") && !found.contains("route "), "{found}");
    lss().arg("check").arg(out.join("layout.lss")).assert().success();
    lss().arg("fmt").arg("--check").arg(out.join("layout.lss")).assert().success();

    // Verbs that want what a layout builds find the same vertices.
    let polygon = |file: &std::path::Path| {
        let run = lss().arg("polygon").arg(file).args(["--format", "json"]).assert().success();
        run.get_output().stdout.clone()
    };
    assert!(!polygon(&asked).is_empty());
    lss().arg("diff").arg(&asked).arg(&asked).assert().success();
    // One that starts from what is written says where to get them.
    let refused = lss().arg("choose").arg(&asked).assert().code(1);
    let said = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
    assert!(said.contains("E0414") && said.contains("layout.lss"), "{said}");
}
