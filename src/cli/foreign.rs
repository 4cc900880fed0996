//! What a file is that was given where a layout belongs, and which verb reads it.

use serde_json::Value;
use std::path::Path;

/// Largest file that is looked into, bytes.
const LOOKED_INTO: u64 = 8 << 20;

/// What to say of a file that is not a layout by the ending of its name; `None` for one that may be.
pub fn not_a_layout(file: &Path) -> Option<String> {
    let ending = file.extension()?.to_str()?.to_ascii_lowercase();
    let (what, way) = match ending.as_str() {
        "json" => json(&text(file).unwrap_or_default()),
        "toml" => toml(&text(file).unwrap_or_default()),
        "csv" => csv(&text(file).unwrap_or_default()),
        "parquet" | "mf4" => RUN,
        "dxf" => ("a drawing", "`lss import` makes a layout of it"),
        "svg" | "png" | "html" => ("a picture or page", "it is a result: no verb reads it"),
        _ => return None,
    };
    Some(format!("it is {what}, not a layout\n  help: {way}"))
}

const RUN: (&str, &str) =
    ("a run", "`lss compare`, and with its folder `lss runs`, `lss identify` and `lss gap`, read it");

/// What to say of JSON that is not a simulation input; `None` where it may be a broken one.
pub fn not_a_simulation(bytes: &[u8]) -> Option<String> {
    let (what, _) = json(std::str::from_utf8(bytes).ok()?);
    let known = !matches!(what, "a simulation input" | "a JSON file");
    known.then(|| format!("it is {what}\n  help: give the simulation.json beside it, or the .lss"))
}

/// The text of a file that is not too large.
fn text(file: &Path) -> Option<String> {
    let size = std::fs::metadata(file).ok().filter(|m| m.is_file())?.len();
    if size > LOOKED_INTO { None } else { std::fs::read_to_string(file).ok() }
}

fn json(text: &str) -> (&'static str, &'static str) {
    let value: Value = serde_json::from_str(text).unwrap_or_default();
    let has = |key: &str| value.get(key).is_some();
    if has("track") && has("chain") && has("steering_wheel") {
        ("a simulation input", "`lss simulate` and `lss polygon` read it")
    } else if has("centre_line") && has("elements") {
        ("the result of a build", "`lss build` wrote it for other programs; give the .lss that it was built from")
    } else if has("articles") {
        ("a bill of elements", "`lss build` wrote it for other programs; give the .lss that it was built from")
    } else {
        ("a JSON file", "`lss simulate` and `lss polygon` read a simulation.json; `lss build` reads the .lss")
    }
}

fn toml(text: &str) -> (&'static str, &'static str) {
    let line = |key: &str| text.lines().any(|line| line.trim_start().starts_with(key));
    if line("[[run]]") {
        ("a campaign", "`lss runs`, `lss identify` and `lss gap diagnose` read it, or its folder")
    } else if line("sensor_cart") {
        ("the sidecar of a run", "`lss compare` and `lss runs` read it with the data file beside it: give that")
    } else {
        ("a TOML file", "`lss runs`, `lss identify` and `lss gap diagnose` read a campaign.toml")
    }
}

fn csv(text: &str) -> (&'static str, &'static str) {
    let head = text.lines().next().unwrap_or_default();
    if head.starts_with("article,") {
        ("a bill of elements", "`lss build` wrote it for spreadsheets; give the .lss that it was built from")
    } else if head.starts_with("time") {
        RUN
    } else {
        ("a table", "`lss compare` and `lss runs` read the CSV of a run, whose first column is `time`")
    }
}
