//! A hub from text to bill: equipment that finds its places, components that are chosen, and a capacity that is required.

#![allow(clippy::expect_used)]

use assert_cmd::Command;
use serde_json::Value;
use std::fs;
use std::path::Path;

fn lss() -> Command {
    let mut command = Command::cargo_bin("lss").expect("the binary");
    command.current_dir(env!("CARGO_MANIFEST_DIR"));
    command
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&fs::read(path).expect("an output")).expect("JSON")
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

/// The lines of a bill beside the track whose description begins so: how many pieces, and their price.
fn ordered(bill: &Value, begin: &str) -> (u64, f64) {
    let lines = bill["beside"].as_array().expect("lines");
    let own = lines.iter().filter(|line| line["description"].as_str().is_some_and(|text| text.starts_with(begin)));
    own.fold((0, 0.0), |(count, price), line| {
        (count + line["count"].as_u64().expect("a count"), price + line["price_eur"].as_f64().unwrap_or(0.0))
    })
}

/// `choose`, `build` of what it writes and `capacity` say the same of price, counts and capacity, which closed forms give.
#[test]
fn a_hub_goes_from_text_to_bill() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let at = |name: &str| folder.path().join(name);
    lss().args(["choose", "examples/parcel_hub.lss", "--checks", "1", "-o"]).arg(folder.path()).assert().success();
    let choice = json(&at("choice.json"))["choice"].clone();
    let written = at("layout.lss");
    lss().arg("fmt").arg("--check").arg(&written).assert().success();
    lss().arg("build").arg(&written).arg("-o").arg(at("built")).assert().success();
    lss()
        .arg("capacity")
        .arg(&written)
        .args(["--hours", "1", "--replications", "2", "-o"])
        .arg(at("capacity"))
        .assert()
        .success();

    // The bill is the price that was promised, with equipment and conveyors, and has what the layout asks for.
    let (bill, layout) = (json(&at("built/bom.json")), json(&at("built/layout.json")));
    let (_, beside) = ordered(&bill, "");
    let price = number(&bill["price_eur"]) + beside;
    assert!((price - number(&choice["price_eur"])).abs() < 0.005, "{price} {choice}");
    let pieces = [("induction ", 4), ("scanner ", 4), ("chute ", 80), ("conveyor ", 4)];
    for (kind, count) in pieces {
        assert_eq!(ordered(&bill, kind).0, count, "{kind}");
    }
    assert_eq!(choice["carts"], ordered(&bill, "cart ").0);
    assert_eq!(choice["motors"], ordered(&bill, "motor ").0);
    let stations: f64 =
        ["induction ", "scanner ", "chute ", "conveyor "].iter().map(|kind| ordered(&bill, kind).1).sum();
    let placed = number(&layout["placement"]["equipment_eur"]) + number(&layout["placement"]["conveyors_eur"]);
    assert!((placed - stations).abs() < 0.05, "{placed} {stations}");

    // Four zones with as many items each, to as many chutes each: an item uses every stretch with probability 5/8, so that
    // 8/5 times as many fit as carriers pass, less what doubles, readings that fail and stops take.
    let capacity = json(&at("capacity/capacity.json"));
    let bound = number(&capacity["bound_per_hour"]);
    assert!((bound - number(&choice["capacity_per_hour"])).abs() < 0.01 && bound >= 12_000.0, "{bound}");
    let carts = number(&choice["carts"]);
    let carriers = 3600.0 * number(&choice["speed_m_s"]) * carts / number(&choice["length_m"]);
    let most = 8.0 / 5.0 * carriers;
    assert!(bound < most && bound > 0.9 * most, "{bound} {most}");
}
