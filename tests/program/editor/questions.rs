//! What an editor asks about a place.

use super::client::{Client, applied, at, position, project, uri};
use serde_json::{Value, json};
use std::path::Path;

const SHARED: &str = "use std.carts.tilt_tray\n\n// Between two racks.\nlet aisle = 2 * 1.2 m\n\ncart heavy(len: 1 m) from tilt_tray(length: len) {\n  mass = 52 kg\n}\n";
const BASE: &str = "use \"shared.lss\"\nuse std.tracks.standard\n\nlayout base {\n  catalog standard\n  cart heavy(len: 1250 mm)\n  speed 2 m/s\n  width aisle / 2\n  vertex P1 (2 m, 2 m) radius 4 m\n  vertex P2 (40 m, 2 m) radius 4 m\n  vertex P3 (40 m, 30 m) radius 4 m\n  vertex P4 (2 m, 30 m) radius 4 m\n  fix length P1..P2\n  require length(P2..P3) >= 3 * aisle // ä 🚚\n}\n";
const VARIANT: &str =
    "use \"base.lss\"\n\nlayout variant from base {\n  vertex P1 (1 m, 2 m) radius 4 m\n  fix rotation P1..P2\n}\n";

/// The three files on the disk, `base.lss` open.
fn three() -> (tempfile::TempDir, std::path::PathBuf, Client, String) {
    let base = BASE.to_owned();
    let (folder, root) = project(&[("shared.lss", SHARED), ("base.lss", &base), ("variant.lss", VARIANT)]);
    let mut client = Client::new();
    client.open(&root.join("base.lss"), &base);
    (folder, root, client, base)
}

fn labels(items: &[Value]) -> Vec<&str> {
    items.iter().map(|item| item["label"].as_str().expect("a label")).collect()
}

/// What is proposed at the mark `|` of a text.
fn proposed(client: &mut Client, path: &Path, marked: &str) -> Vec<Value> {
    let text = marked.replace('|', "");
    client.change(path, json!([{ "text": text }]));
    client.complete(path, position(marked, "|", 0))
}

#[test]
fn what_may_follow_is_proposed_with_units_and_docs() {
    let (_folder, root, mut client, base) = three();
    let path = root.join("base.lss");
    let mut inside =
        |line: &str| proposed(&mut client, &path, &base.replace("  fix length P1..P2\n", &format!("  {line}|\n")));
    let all = inside("ver");
    let vertex = all.iter().find(|item| item["label"] == "vertex").expect("vertex");
    assert_eq!(vertex["textEdit"]["newText"], "vertex ${1:P1} (${2:2} m, ${3:1.5} m) radius ${4:4} m");
    assert!(vertex["documentation"]["value"].as_str().expect("docs").contains("in driving order"));
    let all = inside("fix ");
    assert_eq!(labels(&all)[..7], ["all", "length", "parallel", "perpendicular", "radius", "rotation", "P1"]);
    assert_eq!(labels(&inside("fix length P1.."))[..4], ["P1", "P2", "P3", "P4"]);
    let all = inside("cart heavy(len: 1250 ");
    assert_eq!(labels(&all)[..4], ["m", "mm", "cm", "km"]);
    assert_eq!(all[1]["documentation"]["value"], "`mm`: length; 1 mm = 0.001 m");
    assert_eq!(labels(&inside("speed 2"))[..3], ["m/s", "mm/s", "km/h"]);
    assert_eq!(labels(&inside("cart heavy(")), ["len"]);
    let all = inside("catalog ");
    assert_eq!(labels(&all), ["standard", "thesis"]);
    // What is not imported comes with its import.
    assert_eq!(all[1]["additionalTextEdits"][0]["newText"], "\nuse std.tracks.thesis");
    // What may be chosen is of the kind that the line asks for.
    assert_eq!(labels(&inside("choose take_up ")), ["spring_20", "spring_60", "pneumatic_150"]);
    assert_eq!(labels(&inside("choose sensor light, ")), ["standard", "light"]);
    assert_eq!(labels(&inside("vertex P9 (1 m, 2 m) ")), ["radius"]);
    assert!(labels(&inside("width ")).contains(&"aisle"));
    assert!(labels(&inside("require length(")).contains(&"straight"));
    assert!(labels(&inside("effect ")).contains(&"joint_clearance"));
    // Equipment of the line's kind alone, also where it has its kind from what it is from.
    assert_eq!(labels(&inside("gate crossing of ")), ["gate_walkway"]);
    assert_eq!(labels(&inside("chutes row_a of ")), ["chute", "chute_spiral"]);
    assert_eq!(labels(&inside("induction west of ")), ["induction_45", "induction_manual"]);
    let all = inside("induction west of induction_45 ");
    assert_eq!(labels(&all), ["anywhere", "at", "on"]);
    assert!(inside("// fix ").is_empty());
    let modules = proposed(&mut client, &path, "use std.|");
    assert_eq!(labels(&modules), ["carts", "drives", "equipment", "joints", "sensors", "take_ups", "tracks", "wheels"]);
    assert_eq!(labels(&proposed(&mut client, &path, "use std.tracks.|")), ["standard", "thesis"]);
    assert_eq!(labels(&proposed(&mut client, &path, "use \"|\"")), ["shared.lss", "variant.lss"]);
    let fields = proposed(&mut client, &path, "cart a {\n  |\n}");
    assert_eq!((labels(&fields)[0], fields[0]["detail"].as_str()), ("length", Some("in m")));
    assert_eq!(fields[0]["textEdit"]["newText"], "length = ${1:1} m");
    assert!(fields[0]["documentation"]["value"].as_str().expect("docs").contains("from front joint to rear joint"));
    assert_eq!(labels(&proposed(&mut client, &path, "cart a {\n  mass = 5 |\n}"))[..3], ["kg", "g", "t"]);
    let sides = proposed(&mut client, &path, "equipment a {\n  side = |\n}");
    assert_eq!(labels(&sides), ["left", "right", "outer", "inner", "either", "both"]);
    assert_eq!(client.shut_down(), (Some(0), String::new()));
}

#[test]
fn a_place_says_what_it_is() {
    let (_folder, root, mut client, base) = three();
    let path = root.join("base.lss");
    let said = client.hover(&path, position(&base, "aisle", 0));
    assert!(said.contains("let aisle = 2 * 1.2 m") && said.contains("`aisle` is 2.4 m"), "{said}");
    assert!(said.contains("Between two racks.") && said.contains("shared.lss"), "{said}");
    assert!(client.hover(&path, position(&base, "catalog", 0)).contains("required components"));
    assert!(client.hover(&path, position(&base, "m/s", 0)).contains("speed"));
    assert!(client.hover(&path, position(&base, "length(", 0)).contains("length(straight(P1..P2))"));
    let said = client.hover(&path, position(&base, "P1..P2", 0));
    assert!(said.contains("| length | 38 m | – |") && said.contains("not solved yet"), "{said}");
    assert_eq!(client.hover(&path, position(&base, ".P2", 0)), said, "between the dots");
    assert_eq!(client.shut_down(), (Some(0), String::new()));
}

#[test]
fn a_field_of_equipment_is_told_in_plain_english() {
    let text = "equipment ours {\n  kind = chute\n  stretch = 1.4 m\n}\n";
    let (_folder, root) = project(&[("ours.lss", text)]);
    let path = root.join("ours.lss");
    let mut client = Client::new();
    client.open(&path, text);
    let said = client.hover(&path, position(text, "stretch", 0));
    assert!(said.contains("`stretch` of equipment:"), "{said}");
    assert_eq!(client.shut_down(), (Some(0), String::new()));
}

#[test]
fn a_layout_is_solved_in_the_background() {
    let (_folder, root) = project(&[]);
    let path = root.join("thesis10.lss");
    let text = include_str!("../../../examples/thesis10.lss");
    let mut client = Client::new();
    client.open(&path, text);
    let section = position(text, "P4..P5", 0);
    assert!(client.hover(&path, section.clone()).contains("| heading | 15 deg | – |"));
    client.wait("workspace/inlayHint/refresh");
    let said = client.hover(&path, section.clone());
    assert!(said.contains("| length | 18 m | 18 m |") && said.contains("solved: proven"), "{said}");
    let said = client.hover(&path, position(text, "thesis10 {", 0));
    assert!(
        said.contains("as solved: 159.514 m") && said.contains("45 elements, ") && said.contains("128 carts, "),
        "{said}"
    );
    assert!(client.hover(&path, position(text, "P4 (", 0)).contains("| radius | 5 m | 8 m |"));
    let hints = |client: &mut Client| {
        let range = json!({ "start": at(0, 0), "end": at(999, 0) });
        let params = json!({ "textDocument": { "uri": uri(&path) }, "range": range });
        let all = client.ask("textDocument/inlayHint", params).expect("hints");
        let all = all.as_array().cloned().expect("a list");
        all.iter().map(|h| h["label"].as_str().expect("text").to_owned()).collect::<Vec<_>>()
    };
    let own = hints(&mut client);
    assert!(own.contains(&"→ P5: 18 m, 15°".to_owned()) && own.contains(&"18 m, 15°".to_owned()), "{own:?}");
    // A comment changes nothing. After another change what was solved is marked as such until it is solved again.
    client.change(&path, json!([{ "text": format!("// new\n{text}") }]));
    assert_eq!(hints(&mut client), own);
    client.change(&path, json!([{ "text": text.replace("speed 2.0", "speed 2.1") }]));
    assert!(hints(&mut client).contains(&"→ P5: ≈ 18 m, 15°".to_owned()));
    assert!(client.hover(&path, section).contains("not solved yet since the last change"));
    client.wait("workspace/inlayHint/refresh");
    assert_eq!(hints(&mut client), own);
    assert_eq!(client.shut_down(), (Some(0), String::new()));
}

/// Asking for one layout ends the search for another, which is begun again.
#[test]
fn every_layout_of_a_file_is_solved() {
    let (_folder, root) = project(&[]);
    let path = root.join("both.lss");
    let one = include_str!("../../../examples/thesis10.lss");
    let (head, layout) = one.split_at(one.find("layout thesis10").expect("a layout"));
    let text = format!("{head}{layout}\n{}", layout.replace("layout thesis10", "layout other"));
    let mut client = Client::new();
    client.open(&path, &text);
    client.wait("workspace/inlayHint/refresh");
    client.wait("workspace/inlayHint/refresh");
    for name in ["thesis10 {", "other {"] {
        let said = client.hover(&path, position(&text, name, 0));
        assert!(said.contains("as solved: 159.514 m"), "{said}");
    }
    assert_eq!(client.shut_down(), (Some(0), String::new()));
}

#[test]
fn what_cannot_be_built_is_said_after_a_pause() {
    let (_folder, root) = project(&[]);
    let path = root.join("a.lss");
    let text = include_str!("../../errors/E0601/input.lss");
    let mut client = Client::new();
    client.open(&path, text);
    assert!(client.codes(&path).is_empty());
    client.wait("workspace/inlayHint/refresh");
    assert!(client.codes(&path).contains(&"E0601".to_owned()));
    // Gone with the next change: it may not hold any more.
    client.change(&path, json!([{ "range": { "start": at(0, 0), "end": at(0, 0) }, "text": "// new\n" }]));
    assert!(client.codes(&path).is_empty());
    assert_eq!(client.shut_down(), (Some(0), String::new()));
}

#[test]
fn names_lead_to_their_declarations_across_files() {
    let (_folder, root, mut client, base) = three();
    let path = root.join("base.lss");
    let mut definition = |mark: &str, nth: usize| {
        let found = client.ask_at("textDocument/definition", &path, position(&base, mark, nth)).expect("an answer");
        let found = &found[0];
        let file = found["uri"].as_str().expect("a URI").rsplit('/').next().expect("a name").to_owned();
        (file, found["range"]["start"].clone())
    };
    assert_eq!(definition("aisle", 1), ("shared.lss".to_owned(), at(3, 4)));
    assert_eq!(definition("heavy", 0), ("shared.lss".to_owned(), at(5, 5)));
    assert_eq!(definition("len:", 0), ("shared.lss".to_owned(), at(5, 11)));
    assert_eq!(definition("shared.lss", 0), ("shared.lss".to_owned(), at(0, 0)));
    assert_eq!(definition("P2..P3", 0), ("base.lss".to_owned(), at(9, 9)));
    // The library's own text can be read.
    assert_eq!(definition("standard\n", 1).0, "tracks.lss");
}

#[test]
fn renaming_changes_every_file_or_none() {
    let (_folder, root, mut client, base) = three();
    let path = root.join("base.lss");
    let place = |mark: &str| position(&base, mark, 0);
    let files = |answer: Value| -> Vec<(String, usize)> {
        let changes = answer["changes"].as_object().expect("changes");
        let count = |(uri, edits): (&String, &Value)| {
            (uri.rsplit('/').next().expect("a name").to_owned(), edits.as_array().expect("edits").len())
        };
        let mut all: Vec<_> = changes.iter().map(count).collect();
        all.sort();
        all
    };
    let rename = |client: &mut Client, mark: &str, to: &str| {
        client.ask(
            "textDocument/rename",
            json!({ "textDocument": { "uri": uri(&path) }, "position": place(mark), "newName": to }),
        )
    };
    let vertex = rename(&mut client, "P1 (", "west").expect("edits");
    assert_eq!(files(vertex), [("base.lss".to_owned(), 2), ("variant.lss".to_owned(), 2)]);
    let value = rename(&mut client, "aisle", "gang").expect("edits");
    let edits = value["changes"][&uri(&path)].as_array().expect("edits").clone();
    assert_eq!(applied(&base, &edits), base.replace("aisle", "gang"));
    assert_eq!(files(value), [("base.lss".to_owned(), 2), ("shared.lss".to_owned(), 1)]);
    assert_eq!(
        files(rename(&mut client, "len:", "l").expect("edits")),
        [("base.lss".to_owned(), 1), ("shared.lss".to_owned(), 2)]
    );
    for (mark, to, why) in [
        ("P1 (", "P2", "declared twice"),
        ("P1 (", "9x", "no name"),
        ("P1 (", "a b", "no name"),
        ("standard", "other", "belongs to the standard library"),
        ("speed", "pace", "a word of the language"),
        ("m/s", "x", "a unit"),
        ("length(", "l", "a word of the language"),
    ] {
        let error = rename(&mut client, mark, to).expect_err(mark);
        assert!(error["message"].as_str().expect("why").contains(why), "{mark}: {error}");
    }
    let prepared = client.ask_at("textDocument/prepareRename", &path, place("P1 (")).expect("a name");
    assert_eq!(prepared["placeholder"], "P1");
    // A line that does not parse may use the name.
    client.change(&path, json!([{ "text": base.replace("fix length P1..P2", "fix fix P1..P2") }]));
    let error = rename(&mut client, "P1 (", "west").expect_err("refused");
    assert!(error["message"].as_str().expect("why").contains("base.lss:13 does not parse"), "{error}");
    assert_eq!(client.shut_down(), (Some(0), String::new()));
}

#[test]
fn uses_are_found_in_files_that_are_not_open() {
    let (_folder, root, mut client, base) = three();
    let path = root.join("base.lss");
    let params = |with: bool| json!({ "textDocument": { "uri": uri(&path) }, "position": position(&base, "P1", 0), "context": { "includeDeclaration": with } });
    let count = |client: &mut Client, with| {
        client.ask("textDocument/references", params(with)).expect("uses").as_array().map(Vec::len)
    };
    assert_eq!((count(&mut client, true), count(&mut client, false)), (Some(4), Some(3)));
    let own = client.ask_at("textDocument/documentHighlight", &path, position(&base, "P1", 0)).expect("uses");
    assert_eq!(own.as_array().map(Vec::len), Some(2));
    let found = client.ask("workspace/symbol", json!({ "query": "heav" })).expect("symbols");
    assert_eq!(found[0]["name"], "heavy");
}

#[test]
fn the_formatter_edits_only_lines_that_it_changes() {
    let (_folder, root, mut client, base) = three();
    let path = root.join("base.lss");
    let untidy =
        base.replace("  speed 2 m/s", "speed   2 m/s // ä 🚚").replace("fix length P1..P2", "fix length   P1..P2");
    client.change(&path, json!([{ "text": untidy }]));
    let params = json!({ "textDocument": { "uri": uri(&path) }, "options": { "tabSize": 2, "insertSpaces": true } });
    let edits =
        client.ask("textDocument/formatting", params.clone()).expect("edits").as_array().cloned().expect("a list");
    assert_eq!(edits.len(), 2);
    assert_eq!(applied(&untidy, &edits), base.replace("speed 2 m/s", "speed 2 m/s // ä 🚚"));
    client.change(&path, json!([{ "text": "layout {" }]));
    assert_eq!(client.ask("textDocument/formatting", params), Ok(Value::Null));
}

#[test]
fn the_outline_is_nested_and_folds() {
    let (_folder, root, mut client, _) = three();
    let document = json!({ "textDocument": { "uri": uri(&root.join("base.lss")) } });
    let symbols = client.ask("textDocument/documentSymbol", document.clone()).expect("symbols");
    assert_eq!((symbols[0]["name"].as_str(), symbols[0]["children"][2]["name"].as_str()), (Some("base"), Some("P1")));
    let folds = client.ask("textDocument/foldingRange", document.clone()).expect("folds");
    assert_eq!((folds[0]["kind"].as_str(), folds[1]["startLine"].as_u64()), (Some("imports"), Some(3)));
    let tokens = client.ask("textDocument/semanticTokens/full", document).expect("tokens");
    assert_eq!(tokens["data"].as_array().map(|data| data.len() % 5), Some(0));
}

fn fixes(client: &mut Client, path: &Path) -> Vec<Value> {
    let range = json!({ "start": at(0, 0), "end": at(9999, 0) });
    let params = json!({ "textDocument": { "uri": uri(path) }, "range": range, "context": { "diagnostics": [] } });
    client.ask("textDocument/codeAction", params).expect("actions").as_array().cloned().expect("a list")
}

#[test]
fn fixes_that_are_applied_leave_a_clean_layout() {
    let (_folder, root) = project(&[]);
    let path = root.join("a.lss");
    // No import, a speed without a unit, a misspelt statement, a misspelt vertex, no width.
    let mut text = "layout a {\n  catalog standard\n  cart tilt_tray(length: 1250 mm)\n  speed 2\n  vertx P1 (2 m, 2 m) radius 4 m // ä 🚚\n  vertex P2 (40 m, 2 m) radius 4 m\n  vertex P3 (40 m, 30 m) radius 4 m\n  vertex P4 (2 m, 30 m) radius 4 m\n  fix length P1..P22\n}\n".to_owned();
    let mut client = Client::new();
    client.open(&path, &text);
    for _ in 0..10 {
        let Some(action) = fixes(&mut client, &path).into_iter().next() else { break };
        let edits = action["edit"]["changes"][&uri(&path)].as_array().cloned().expect("edits");
        text = applied(&text, &edits);
        client.change(&path, json!([{ "text": text }]));
    }
    assert!(client.codes(&path).is_empty(), "{text}\n{:?}", client.published);
    assert!(text.starts_with("use std.") && text.contains("  width 1.2 m\n") && text.contains("speed 2 m/s"), "{text}");
}

#[test]
fn every_fix_of_every_code_takes_its_diagnostic_away() {
    let (_folder, root) = project(&[]);
    let mut client = Client::new();
    let mut fixed = Vec::new();
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/errors");
    let mut cases: Vec<_> =
        std::fs::read_dir(cases).expect("cases").map(|entry| entry.expect("a case").path()).collect();
    cases.sort();
    for case in cases {
        let Ok(text) = std::fs::read_to_string(case.join("input.lss")) else { continue };
        let name = case.file_name().expect("a name").to_string_lossy().into_owned();
        for entry in std::fs::read_dir(&case).expect("files") {
            let file = entry.expect("a file").path();
            if file.extension().is_some_and(|e| e == "lss") {
                std::fs::copy(&file, root.join(file.file_name().expect("a name"))).expect("copied");
            }
        }
        let path = root.join("input.lss");
        client.open(&path, &text);
        client.codes(&path);
        for action in fixes(&mut client, &path) {
            let diagnostic = &action["diagnostics"][0];
            let edits = action["edit"]["changes"][&uri(&path)].as_array().cloned().expect("edits of this file");
            let after = root.join("after.lss");
            client.open(&after, &applied(&text, &edits));
            client.codes(&after);
            let count = |client: &Client, path: &Path| {
                let all = client.published.get(&uri(path)).map_or(&[][..], Vec::as_slice);
                all.iter().filter(|d| d["code"] == diagnostic["code"] && d["message"] == diagnostic["message"]).count()
            };
            let (before, after_it) = (count(&client, &path), count(&client, &after));
            // Of E0112 more wait behind those that are shown.
            let helps = after_it < before || name == "E0112" && after_it == before;
            assert!(helps, "{name}: {} does not help", action["title"]);
            client.close(&after);
            fixed.push(diagnostic["code"].as_str().expect("a code").to_owned());
        }
        client.close(&path);
    }
    fixed.sort();
    fixed.dedup();
    assert_eq!(
        fixed.join(" "),
        "E0101 E0102 E0103 E0104 E0107 E0108 E0109 E0110 E0111 E0205 E0206 E0207 E0208 E0209 E0210 E0211 E0214 E0218 E0302 \
         E0310 E0311 E0402 E0404 E0408 W0701 W0704"
    );
}
