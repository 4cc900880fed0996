//! A chain that does not fit its track, as users see it: in the build, on the drawing, in the outputs and in the
//! simulation.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use assert_cmd::Command;
use serde_json::Value;
use std::fs;
use std::path::Path;

fn lss() -> Command {
    let mut command = Command::cargo_bin("lss").expect("the binary");
    command.current_dir(env!("CARGO_MANIFEST_DIR"));
    command
}

fn read(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).expect("a file")).expect("JSON")
}

/// The smallest example with carts of which 39 leave 127.8 mm over.
fn loose(folder: &Path) -> std::path::PathBuf {
    let text = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/examples/smallest.lss")).expect("an example");
    let file = folder.join("loose.lss");
    fs::write(&file, text.replace("length: 0.7 m", "length: 500 mm")).expect("written");
    file
}

#[test]
fn a_chain_that_does_not_fit_is_warned_of_and_stands_in_the_title_block() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out");
    let built = lss().arg("build").arg(loose(folder.path())).arg("-o").arg(&out).assert().success();
    let output = built.get_output();
    let (said, warned) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(said.contains("39 carts, 127.8 mm left over, beyond the take-up of 20 mm"), "{said}");
    assert!(warned.contains("W0712") && warned.contains("`chain closes within 20 mm`"), "{warned}");
    assert!(warned.replace("\n        ", " ").contains("carts of 700 mm: 28 of them leave 7.6 mm over"), "{warned}");
    let drawing = fs::read_to_string(out.join("drawing.svg")).expect("a drawing");
    assert!(drawing.contains("127.8 mm (20 mm)") && drawing.contains("optimised; chain does not fit"));
    let chain = &read(&out.join("layout.json"))["chain"];
    assert_eq!((chain["carts"].as_u64(), chain["fits"].as_bool()), (Some(39), Some(false)));
    assert_eq!(read(&out.join("simulation.json"))["chain"]["take_up_m"].as_f64(), Some(0.02));
}

#[test]
fn a_simulation_says_which_cart_length_it_used_and_why() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = |file: &Path, format: &str| {
        let mut command = lss();
        command.arg("simulate").arg(file).args(["--settle", "0.1s", "--format", format, "-o"]).arg(folder.path());
        let out = command.assert().success();
        String::from_utf8_lossy(&out.get_output().stdout).into_owned()
    };
    let loose = loose(folder.path());
    let text = run(&loose, "text");
    assert!(text.contains("m instead of the product line's 0.5 m (+3.1"), "{text}");
    assert!(text.contains("39 carts of 0.5 m leave 127.8 mm over, beyond the take-up of 20 mm"), "{text}");
    let json: Value = serde_json::from_str(&run(&loose, "json")).expect("JSON");
    let length = &json["cart_length"];
    assert_eq!((length["product_line_m"].as_f64(), length["fits"].as_bool()), (Some(0.5), Some(false)));
    assert!((length["left_over_m"].as_f64().expect("a number") - 0.1278).abs() < 1e-4, "{length}");
    assert!(length["why"].as_str().expect("words").contains("beyond the take-up"), "{length}");
    let text = run(Path::new("examples/smallest.lss"), "text");
    assert!(text.contains("28 carts of 0.7 m leave 7.6 mm over, within the take-up of 20 mm"), "{text}");
    assert!(!text.contains("instead of"), "{text}");
}

#[test]
fn a_new_project_has_a_chain_that_fits() {
    let folder = tempfile::tempdir().expect("a folder");
    let plant = folder.path().join("plant");
    lss().arg("new").arg(&plant).assert().success();
    let built = lss().arg("build").arg(plant.join("plant.lss")).arg("-o").arg(plant.join("out")).assert().success();
    assert_eq!(String::from_utf8_lossy(&built.get_output().stderr), "");
    assert_eq!(read(&plant.join("out/layout.json"))["chain"]["fits"].as_bool(), Some(true));
}
