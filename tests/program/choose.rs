//! `lss choose` as users run it.

use assert_cmd::Command;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

fn lss() -> Command {
    let mut command = Command::cargo_bin("lss").expect("the binary");
    command.current_dir(env!("CARGO_MANIFEST_DIR"));
    command
}

fn chosen(folder: &Path, more: &[&str]) -> Value {
    let out = lss().args(["choose", "examples/choice.lss", "--format", "json", "-o"]).arg(folder).args(more).assert();
    serde_json::from_slice(&out.success().get_output().stdout).expect("one JSON object")
}

/// The layout that is written builds to the price that was promised, and choosing from it anew has nothing to choose.
#[test]
fn what_is_written_is_what_was_promised() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let found = chosen(folder.path(), &["--checks", "1"]);
    assert_eq!(found["candidates"], 12 * 11 * 2 * 2);
    assert_eq!(found["tracks"], found["tracks_proven"]);
    let choice = &found["choice"];
    assert!(choice["capacity_per_hour"].as_f64().expect("a capacity") >= 7500.0);

    let written = folder.path().join("layout.lss");
    let text = fs::read_to_string(&written).expect("a layout");
    let starts = |word: &str| text.lines().any(|line| line.trim_start().starts_with(word));
    assert!(!starts("choose ") && !text.contains("linear_motor\n"), "{text}");
    let built = folder.path().join("built");
    let out = lss().arg("build").arg(&written).arg("-o").arg(&built).assert().success();
    assert_eq!(String::from_utf8_lossy(&out.get_output().stderr), "", "nothing to be said of it");
    let price = price(&built);
    assert!((price - choice["price_eur"].as_f64().expect("a price")).abs() < 0.005, "{price}");
    let motors: usize = text.lines().filter_map(|line| line.trim().strip_prefix("motors on ")).map(count).sum();
    assert_eq!(choice["motors"], motors);

    // And it takes what is required, in the same simulation.
    let out = lss().arg("capacity").arg(&written).args(["--format", "json"]).assert().success();
    let capacity: Value = serde_json::from_slice(&out.get_output().stdout).expect("JSON");
    let (alone, told) = (&capacity["always_fed"]["per_hour"], &choice["simulated_per_hour"]);
    for (alone, told) in [(&alone["value"], &told["value"]), (&alone["half_width"], &told["half_width"])] {
        let (alone, told) = (alone.as_f64().expect("a mean"), told.as_f64().expect("a mean"));
        assert!((alone - told).abs() < 0.01 * alone, "{alone} {told}");
    }
}

/// A variant says its choice itself: the layout that it changes, and others of the file, stay as they were.
#[test]
fn a_choice_of_a_variant_leaves_its_base_alone() {
    let place = tempfile::tempdir().expect("a temporary folder");
    let base = "use std.carts.tilt_tray\nuse std.drives.linear_motor\nuse std.drives.linear_motor_800\n\
                use std.tracks.standard\n\nlayout a {\n  catalog standard\n  cart tilt_tray(length: 1000 mm)\n  \
                motor linear_motor\n  speed 2 m/s\n  width 1.2 m\n  vertex P1 (4 m, 4 m) radius 4 m\n  \
                vertex P2 (24 m, 4 m) radius 4 m\n  vertex P3 (24 m, 16 m) radius 4 m\n  \
                vertex P4 (4 m, 16 m) radius 4 m\n  fix all P1..P2\n  fix rotation P3..P4\n  \
                require length(straight(P2..P3)) >= 4 m\n  motors 6 evenly\n  chain closes within 20 mm\n  optimise length\n}\n";
    let free = "  choose cart tilt_tray lengths 900 mm .. 1100 mm\n  choose motor linear_motor, linear_motor_800 on straights\n";
    for (variants, layout) in [
        (format!("\nlayout b from a {{\n{free}}}\n\nlayout c from a {{\n  speed 1.8 m/s\n}}\n"), "b"),
        (format!("\nlayout b from a {{\n{free}}}\n\nlayout c from b\n"), "c"),
    ] {
        let (file, out) = (place.path().join("variants.lss"), place.path().join(layout));
        fs::write(&file, format!("{base}{variants}")).expect("a layout");
        let choose = |file: &Path, more: &[&str]| {
            let mut command = lss();
            command.args(["choose", "--layout", layout, "--checks", "0", "--format", "json"]).args(more).arg(file);
            command
        };
        let told = choose(&file, &["-o", out.to_str().expect("a path")]).assert().success();
        let found: Value = serde_json::from_slice(&told.get_output().stdout).expect("one JSON object");
        let text = fs::read_to_string(out.join("layout.lss")).expect("a layout");
        let block = |text: &str| text[text.find("layout a").expect("a")..text.find("layout b").expect("b")].to_owned();
        assert_eq!(block(&text), block(base.to_owned().as_str().replace("}\n", "}\n\nlayout b").as_str()), "{text}");
        if layout == "c" {
            assert!(text.contains("choose cart tilt_tray"), "what `b` leaves free stays free there\n{text}");
        }
        let built = out.join("built");
        lss().args(["build", "--layout", layout]).arg(out.join("layout.lss")).arg("-o").arg(&built).assert().success();
        let price = price(&built);
        assert!((price - found["choice"]["price_eur"].as_f64().expect("a price")).abs() < 0.005, "{price}\n{text}");
    }
}

/// The dynamic model needs the thrust of the closed form where the chain runs so slowly that it hardly vibrates.
#[test]
fn a_slow_chain_needs_the_thrust_of_the_closed_form() {
    let place = tempfile::tempdir().expect("a temporary folder");
    let text = fs::read_to_string("examples/choice.lss").expect("the example");
    let less = text.replace("require capacity >= 7500 per hour", "require capacity >= 6500 per hour");
    assert_ne!(text, less);
    let file = place.path().join("slow.lss");
    fs::write(&file, less).expect("a layout");
    let out = lss().arg("choose").arg(&file).args(["--format", "json", "--checks", "1"]).assert().success();
    let found: Value = serde_json::from_slice(&out.get_output().stdout).expect("JSON");
    let choice = &found["choice"];
    assert!(choice["speed_m_s"].as_f64().expect("a speed") <= 1.9, "{choice}");
    let thrust = &choice["thrust_n"];
    let steady: f64 = ["rolling", "curves", "air"].iter().map(|part| thrust[part].as_f64().expect("a force")).sum();
    let simulated = found["check"]["thrust_n"].as_f64().expect("a force");
    assert!((simulated / steady - 1.0).abs() < 0.02, "{simulated} {steady}");
}

/// Of `P1..P2 from 1 m every 2 m count 3`.
fn count(row: &str) -> usize {
    row.rsplit(' ').next().and_then(|n| n.parse().ok()).expect("a count")
}

/// What `lss choose` and `lss capacity` write is as the schemas in the docs say.
#[test]
fn files_are_as_their_schemas_say() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().to_str().expect("a path");
    let quick = ["--hours", "0.5", "--replications", "2"];
    // Two with all fields of failures and waves, and without.
    let waves = tempfile::tempdir().expect("a temporary folder");
    let slow = ["--hours", "2", "--replications", "2", "-o", waves.path().to_str().expect("a path")];
    lss().args(["capacity", "examples/waves.lss"]).args(slow).assert().success();
    lss().args(["capacity", "examples/capacity.lss", "-o", out]).args(quick).assert().success();
    chosen(folder.path(), &["--checks", "1", "--pareto", "price,capacity"]);
    for name in ["capacity", "choice"] {
        let json = |path: &Path| -> Value { serde_json::from_slice(&fs::read(path).expect(name)).expect("JSON") };
        let schema = format!("docs/schemas/{name}.schema.json");
        let schema = json(&Path::new(env!("CARGO_MANIFEST_DIR")).join(schema));
        let validator = jsonschema::validator_for(&schema).expect("a schema");
        let mut document = json(&folder.path().join(format!("{name}.json")));
        let wrong: Vec<String> = validator.iter_errors(&document).map(|e| e.to_string()).collect();
        assert_eq!(wrong, Vec::<String>::new(), "{name}");
        if name == "capacity" {
            let document = json(&waves.path().join("capacity.json"));
            let wrong: Vec<String> = validator.iter_errors(&document).map(|e| e.to_string()).collect();
            assert_eq!(wrong, Vec::<String>::new(), "of waves");
            for field in ["waves", "costs"] {
                assert!(document[field].as_array().is_some_and(|rows| rows.len() > 1), "{field}: {document}");
            }
        }
        document.as_object_mut().expect("an object").remove("layout");
        assert!(!validator.is_valid(&document), "{name}: without its layout's name");
    }
}

/// The table has every candidate; the winner is the cheapest of those that fall short of nothing, and the front is none
/// that another row beats.
#[test]
fn the_table_holds_the_proof() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let found = chosen(folder.path(), &["--checks", "0", "--pareto", "price,capacity,energy"]);
    let mut reader = csv::Reader::from_path(folder.path().join("candidates.csv")).expect("a table");
    let rows: Vec<BTreeMap<String, String>> = reader.deserialize().map(|row| row.expect("a row")).collect();
    assert_eq!(found["candidates"], rows.len());
    let number = |row: &BTreeMap<String, String>, name: &str| row[name].parse::<f64>().expect("a number");
    let sound: Vec<_> = rows.iter().filter(|row| row["short_of"].is_empty()).collect();
    assert_eq!(found["feasible"], sound.len());
    let least = sound.iter().map(|row| number(row, "total_eur")).fold(f64::INFINITY, f64::min);
    assert!((found["choice"]["total_eur"].as_f64().expect("a total") - least).abs() < 0.01);
    let columns = ["price_eur", "capacity_per_hour", "energy_kwh_per_year"];
    let worth = |row: &BTreeMap<String, String>| {
        let [price, capacity, energy] = columns.map(|name| number(row, name));
        [price, -capacity, energy]
    };
    let all: Vec<[f64; 3]> = sound.iter().map(|row| worth(row)).collect();
    let beats = |a: &[f64; 3], b: &[f64; 3]| a.iter().zip(b).all(|(x, y)| x <= y) && a != b;
    let mut front: Vec<[f64; 3]> = all.iter().filter(|b| !all.iter().any(|a| beats(a, b))).copied().collect();
    front.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
    front.dedup();
    let told = found["pareto"]["rows"].as_array().expect("rows");
    assert_eq!(told.len(), front.len());
    for (row, expected) in told.iter().zip(&front) {
        let value = |k: usize| row["values"][k].as_f64().expect("a number");
        assert!((value(0) - expected[0]).abs() < 0.01 && (value(1) + expected[1]).abs() < 0.01, "{row} {expected:?}");
    }
}

#[test]
fn any_number_of_threads_writes_the_same_bytes() {
    let read = |folder: &Path| -> BTreeMap<String, Vec<u8>> {
        let files = ["choice.json", "choice.html", "candidates.csv", "layout.lss"];
        files.iter().map(|name| ((*name).to_owned(), fs::read(folder.join(name)).expect("an output"))).collect()
    };
    let run = |threads: &str| {
        let folder = tempfile::tempdir().expect("a temporary folder");
        chosen(folder.path(), &["--checks", "1", "--threads", threads, "--pareto", "price,smoothness"]);
        read(folder.path())
    };
    assert!(run("1") == run("3"), "outputs differ");
}

#[test]
fn measures_are_two_or_three_unlike_ones() {
    for (measures, said) in [("price", "two or three"), ("price,price", "twice"), ("price,beauty", "invalid value")] {
        let out = lss().args(["choose", "examples/choice.lss", "--pareto", measures]).assert().code(2);
        let text = String::from_utf8_lossy(&out.get_output().stderr).into_owned();
        assert!(text.contains(said), "{measures}: {text}");
    }
    let out = lss().args(["choose", "examples/capacity.lss", "--pareto", "price,energy"]).assert().code(2);
    assert!(String::from_utf8_lossy(&out.get_output().stderr).contains("how long the sorter runs"));
}

const NUMBERS: &str = "use std.carts.tilt_tray\nuse std.equipment\nuse std.tracks.standard\n\nlayout hub {\n  \
    catalog standard\n  cart tilt_tray(length: 1000 mm)\n  speed 2 m/s\n  width 1.2 m\n  \
    choose count west, east [1, 2]\n  choose count row_a 6 .. 10 step 4\n  \
    vertex P1 (0 m, 0 m) radius 4 m\n  vertex P2 (50 m, 0 m) radius 4 m\n  \
    vertex P3 (50 m, 14.465 m) radius 4 m\n  vertex P4 (0 m, 14.465 m) radius 4 m\n  start on P1..P2 at 0 m\n  \
    motors 20 evenly\n  induction west of induction_45 on P1..P2\n  chutes row_a of chute at least 6 on P1..P2 after west\n  \
    induction east of induction_45 on P3..P4\n  chutes row_b of chute at least 8 on P3..P4 after east\n  \
    scanner scan of scanner_portal on straights after the last induction of each zone\n  \
    feed west 2600 per hour up to 1500 per hour\n  feed east 2600 per hour up to 1500 per hour\n  \
    storage row_a 40 every 12 s\n  storage row_b 40 every 12 s\n  \
    require capacity >= 4900 per hour\n  optimise nothing\n}\n";

/// Every number of equipment is what a layout gives that says so, and the one that is chosen is written where it belongs.
#[test]
fn numbers_of_equipment_are_chosen() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("hub.lss");
    fs::write(&file, NUMBERS).expect("a layout");
    let out =
        lss().arg("choose").arg(&file).args(["--format", "json", "--checks", "0", "-o"]).arg(folder.path()).assert();
    let found: Value = serde_json::from_slice(&out.success().get_output().stdout).expect("JSON");
    let mut reader = csv::Reader::from_path(folder.path().join("candidates.csv")).expect("a table");
    let rows: Vec<BTreeMap<String, String>> = reader.deserialize().map(|row| row.expect("a row")).collect();
    assert_eq!((rows.len(), &found["tracks"]), (4, &Value::from(4)));
    let without: Vec<&str> = NUMBERS.lines().filter(|line| !line.contains("choose count")).collect();
    let mut least = f64::INFINITY;
    for row in &rows {
        let text = without.join("\n").replace("induction_45 on", &format!("induction_45 at least {} on", row["west"]));
        let text = text.replace("at least 6", &format!("at least {}", row["row_a"])) + "\n";
        let one = folder.path().join("one.lss");
        fs::write(&one, text).expect("a layout");
        // One that takes too little is an error, whose files are written all the same.
        let built = folder.path().join("one");
        let _ = lss().arg("build").arg(&one).arg("-o").arg(&built).assert();
        near(price(&built), &row["price_eur"]);
        let out = lss().arg("capacity").arg(&one).args(["--format", "json", "--hours", "0.5"]).assert();
        let capacity: Value = serde_json::from_slice(&out.get_output().stdout).expect("JSON");
        near(capacity["bound_per_hour"].as_f64().expect("a capacity"), &row["capacity_per_hour"]);
        let number = |name: &str| row[name].parse::<f64>().expect("a number");
        assert_eq!(row["short_of"].is_empty(), number("capacity_per_hour") >= 4900.0, "{row:?}");
        if row["short_of"].is_empty() {
            least = least.min(number("total_eur"));
        }
    }
    assert!((found["choice"]["total_eur"].as_f64().expect("a total") - least).abs() < 0.01);
    assert_eq!(found["choice"]["equipment"], serde_json::json!({ "west": 2, "east": 2, "row_a": 10 }));
    let text = fs::read_to_string(folder.path().join("layout.lss")).expect("a layout");
    assert!(!text.contains("choose") && text.contains("induction east of induction_45 at least 2 on P3..P4"), "{text}");
    assert!(text.contains("chutes row_a of chute at least 10 on P1..P2 after west"), "{text}");
}

fn near(found: f64, told: &str) {
    let told: f64 = told.parse().expect("a number");
    assert!((found - told).abs() < 0.01, "{found} {told}");
}

/// Of everything that is built into a folder, EUR.
fn price(folder: &Path) -> f64 {
    let bill: Value = serde_json::from_slice(&fs::read(folder.join("bom.json")).expect("a bill")).expect("JSON");
    let beside = bill["beside"].as_array().expect("lines").iter().filter_map(|line| line["price_eur"].as_f64());
    bill["price_eur"].as_f64().expect("a price") + beside.sum::<f64>()
}

const OVAL: &str = "use std.carts.tilt_tray
use std.take_ups.pneumatic_150
use std.take_ups.spring_20
use std.take_ups.spring_60
use std.tracks.standard

cart taut(length: 1250 mm) from tilt_tray(length: length) {
  tension = 2000 N
  price   = 300 EUR
}

layout oval {
  catalog standard
  cart tilt_tray(length: 1250 mm)
  speed 2 m/s
  width 1.2 m
  choose take_up spring_20, spring_60, pneumatic_150
  vertex P1 (8 m, 8 m) radius 4 m
  vertex P2 (44 m, 8 m) radius 4 m
  vertex P3 (44 m, 24 m) radius 4 m
  vertex P4 (8 m, 24 m) radius 4 m
  fix all P1..P2
  fix rotation P3..P4
  motors 6 evenly
";

fn oval(folder: &Path, more: &str) -> std::path::PathBuf {
    let file = folder.join("oval.lss");
    let import = if more.contains("of chute") { "use std.equipment.chute\n" } else { "" };
    fs::write(&file, format!("{import}{OVAL}{more}\n}}\n")).expect("a layout");
    file
}

/// Of each choice the layout that is written builds, to its price, with its take-up.
#[test]
fn what_is_written_fits_the_take_up_that_was_chosen() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let closes = "  require length(P2..P3) >= 16 m\n  chain closes within";
    for (more, take_up) in [
        // What is left over is as little as the take-up asks for, though the layout allows more.
        (format!("{closes} 60 mm\n  optimise length"), Some("spring_20")),
        // The chosen cart's tension is another than that of the layout's own.
        (format!("  choose cart taut\n{closes} 60 mm\n  optimise length"), Some("spring_60")),
        (format!("  choose cart taut\n  chain tension 400 N\n{closes} 15 mm\n  optimise length"), Some("spring_20")),
        // Built as written, some cart leaves so little over.
        ("  choose cart tilt_tray lengths 600 mm .. 1250 mm\n  optimise nothing".to_owned(), None),
    ] {
        let out = folder.path().join("out");
        let file = oval(folder.path(), &more);
        let assert = lss()
            .arg("choose")
            .arg(&file)
            .args(["--format", "json", "--checks", "0", "-o"])
            .arg(&out)
            .assert()
            .success();
        let found: Value = serde_json::from_slice(&assert.get_output().stdout).expect("JSON");
        let choice = &found["choice"];
        assert!(take_up.is_none_or(|take_up| choice["take_up"] == take_up), "{more}: {found}");
        let built = folder.path().join("built");
        let assert = lss().arg("build").arg(out.join("layout.lss")).arg("-o").arg(&built).assert().success();
        let said = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
        assert!(!said.contains("W0712"), "{more}: {said}");
        let told = choice["price_eur"].as_f64().expect("a price");
        assert!((price(&built) - told).abs() < 0.005, "{more}: {told}, not {}", price(&built));
    }
}

/// Where no track can be built there is no candidate to draw: the files say so, and the message is that of a build.
#[test]
fn without_any_track_there_are_files_and_a_reason() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = oval(folder.path(), "  chutes row of chute at least 60 on P1..P2\n  optimise nothing");
    let out = folder.path().join("out");
    let assert = lss().arg("choose").arg(&file).arg("-o").arg(&out).assert().code(1);
    let said = String::from_utf8_lossy(&assert.get_output().stderr).into_owned();
    assert!(said.contains("E0606"), "{said}");
    assert!(out.join("choice.html").is_file() && out.join("candidates.csv").is_file());
}

/// A trade that cannot be made says why, and writes nothing.
#[test]
fn trades_that_cannot_be_made_say_so() {
    let place = tempfile::tempdir().expect("a temporary folder");
    for (file, more, words) in [
        ("examples/thesis10.lss", &["--pareto", "length"][..], "--pareto takes two or three measures"),
        ("examples/thesis10.lss", &["--pareto", "length,length"], "--pareto names a measure twice"),
        ("examples/thesis10.lss", &["--pareto", "length,cost", "--emit", "nl"], "--pareto is an --emit of its own"),
        ("examples/thesis10.lss", &["--pareto", "length,energy"], "needs to know how long the sorter runs"),
        ("examples/smallest.lss", &["--pareto", "length,capacity"], "no layout that was found has a capacity"),
        ("examples/levels.lss", &["--pareto", "length,smoothness"], "polygon action on different heights"),
        ("examples/route.lss", &["--pareto", "length,cost"], "this --emit needs vertices"),
    ] {
        let folder = place.path().join("out");
        let run = lss().args(["build", file, "-o"]).arg(&folder).args(more).assert().failure();
        let said = String::from_utf8_lossy(&run.get_output().stderr).into_owned();
        assert!(said.contains(words), "{file} {more:?}: {said}");
        assert!(!folder.exists(), "{file} {more:?}");
    }
}
