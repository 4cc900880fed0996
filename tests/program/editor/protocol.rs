//! Text sync, diagnostics, and the protocol's own rules.

use super::client::{Client, at, capable, project, uri};
use lss::base::random::mix;
use serde_json::{Value, json};

const SMALLEST: &str = include_str!("../../../examples/smallest.lss");
const CONSTRAINTS: &str = include_str!("../../../examples/constraints.lss");

/// An edit that puts a text between two places of a line.
fn edit(line: usize, from: usize, to: usize, text: &str) -> Value {
    json!([{ "range": { "start": at(line, from), "end": at(line, to) }, "text": text }])
}

#[test]
fn a_layout_is_checked_as_it_is_typed() {
    let (_folder, root) = project(&[]);
    let path = root.join("plant ä.lss");
    let mut client = Client::new();
    client.open(&path, SMALLEST);
    assert!(client.codes(&path).is_empty());
    // Characters before a place count in UTF-16: `ä` one, `🚚` two.
    let line = SMALLEST.lines().count();
    client.change(&path, edit(line, 0, 0, "let b = 1 m // ä 🚚 b\n"));
    assert!(client.codes(&path).is_empty());
    client.change(&path, edit(line, 19, 20, "🚚🚚"));
    client.change(&path, edit(line, 10, 11, "foo"));
    client.change(&path, edit(line, 24, 25, "end"));
    assert_eq!(client.codes(&path), ["E0303"]);
    let published = client.published[&uri(&path)][0].clone();
    assert_eq!(published["range"], json!({ "start": at(line, 10), "end": at(line, 13) }));
    assert_eq!((published["severity"].as_u64(), published["source"].as_str()), (Some(1), Some("lss")));
    let page = published["codeDescription"]["href"].as_str().expect("a page").trim_start_matches("file://");
    assert!(std::fs::read_to_string(page).expect("the page").contains("unit"));
    // Also what the client asks for by itself.
    let pulled = client.ask("textDocument/diagnostic", json!({ "textDocument": { "uri": uri(&path) } })).expect("all");
    assert_eq!(pulled["items"], json!([published]));
    client.close(&path);
    assert!(client.codes(&path).is_empty());
    assert_eq!(client.shut_down(), (Some(0), String::new()));
}

#[test]
fn bytes_are_counted_where_the_client_can() {
    let (_folder, root) = project(&[]);
    let path = root.join("a.lss");
    let mut capabilities = capable();
    capabilities["general"] = json!({ "positionEncodings": ["utf-8", "utf-16"] });
    let (mut client, offered) = Client::with(capabilities);
    assert_eq!(offered["positionEncoding"], "utf-8");
    let text = "let a = \"ä 🚚\" + b\n";
    client.open(&path, text);
    assert!(client.codes(&path).contains(&"E0206".to_owned()));
    let of =
        |client: &Client| client.published[&uri(&path)].iter().find(|d| d["code"] == "E0206").cloned().expect("one");
    assert_eq!(of(&client)["range"]["start"], at(0, text.find("+ b").expect("there") + 2));
    let (mut client, offered) = Client::with(json!({}));
    assert_eq!(offered["positionEncoding"], "utf-16");
    client.open(&path, text);
    client.codes(&path);
    assert_eq!(of(&client)["range"]["start"], at(0, 17));
}

#[test]
fn open_texts_stand_in_for_files_also_as_imports() {
    let main = format!("use \"shared.lss\"\n{}", SMALLEST.replace("width ", "width 0 m + "));
    let (_folder, root) = project(&[("shared.lss", "let aisle = 1 m\n"), ("main.lss", &main)]);
    let (main_path, shared, new) = (root.join("main.lss"), root.join("shared.lss"), root.join("new.lss"));
    let main = format!("use \"shared.lss\"\nlet wide = aisle\n{SMALLEST}");
    let mut client = Client::new();
    client.open(&main_path, &main);
    assert!(client.codes(&main_path).is_empty());
    // Unsaved: the name has gone.
    client.open(&shared, "let gang = 1 m\n");
    assert_eq!(client.codes(&main_path), ["W0701", "E0206"]);
    client.change(&shared, edit(0, 4, 8, "aisle"));
    assert!(client.codes(&main_path).is_empty());
    // What is wrong in an imported file that is not open is published, too, and taken back.
    client.close(&shared);
    std::fs::write(&shared, "let aisle = 1 foo\n").expect("written");
    client.tell("workspace/didChangeWatchedFiles", json!({ "changes": [{ "uri": uri(&shared), "type": 2 }] }));
    assert_eq!(client.codes(&shared), ["E0303"]);
    // A file that was never saved can be imported.
    client.open(&new, "let aisle = 2 m\n");
    client.change(&main_path, edit(0, 5, 15, "new.lss"));
    assert!(client.codes(&main_path).is_empty() && client.codes(&shared).is_empty());
    client.close(&new);
    assert_eq!(client.codes(&main_path), ["E0202", "E0206"]);
    client.close(&main_path);
    assert!(client.codes(&main_path).is_empty());
    assert_eq!(client.shut_down(), (Some(0), String::new()));
}

#[test]
fn places_that_take_part_are_told_of() {
    let (_folder, root) = project(&[]);
    let path = root.join("a.lss");
    let text = "let a = 1 m\nlet a = 2 m\n";
    let mut client = Client::new();
    client.open(&path, text);
    assert_eq!(client.codes(&path), ["E0212"]);
    let related = &client.published[&uri(&path)][0]["relatedInformation"][0];
    assert_eq!(
        (related["message"].as_str(), &related["location"]["range"]["start"]),
        (Some("first declared here"), &at(0, 4))
    );
    // A client without them reads them in the message.
    let (mut client, _) = Client::with(json!({}));
    client.open(&path, text);
    client.codes(&path);
    let published = &client.published[&uri(&path)][0];
    assert!(published["message"].as_str().expect("text").contains("a.lss:1: first declared here"), "{published}");
    assert!(published.get("relatedInformation").is_none());
}

#[test]
fn the_rules_of_the_protocol_hold() {
    let code = |answer: Result<Value, Value>| answer.expect_err("an error")["code"].as_i64().expect("a code");
    let mut client = Client::start();
    assert_eq!(code(client.ask("textDocument/hover", json!({}))), -32002);
    client.ask("initialize", json!({ "capabilities": {} })).expect("initialised");
    client.tell("initialized", json!({}));
    assert_eq!(code(client.ask("textDocument/nonsense", json!({}))), -32601);
    assert_eq!(code(client.ask("textDocument/hover", json!({ "position": 3 }))), -32602);
    assert_eq!(code(client.ask("initialize", json!({ "capabilities": {} }))), -32600);
    // Of a document that is not open nothing is known.
    let nowhere = json!({ "textDocument": { "uri": "file:///no/such.lss" }, "position": at(1, 1) });
    assert_eq!(client.ask("textDocument/hover", nowhere), Ok(Value::Null));
    client.tell("$/unknown", json!({}));
    client.tell("textDocument/didOpen", json!({ "nonsense": 1 }));
    assert_eq!(client.ask("shutdown", Value::Null), Ok(Value::Null));
    assert_eq!(code(client.ask("textDocument/hover", json!({}))), -32600);
    client.tell("exit", Value::Null);
    assert_eq!(client.ended(), (Some(0), String::new()));
}

#[test]
fn a_client_that_goes_away_or_talks_nonsense_ends_the_server() {
    let mut client = Client::new();
    client.tell("exit", Value::Null);
    assert_eq!(client.ended().0, Some(1));
    let (code, said) = Client::new().ended();
    assert_eq!((code, said.contains("went away")), (Some(1), true), "{said}");
    for bytes in [
        &b"Content-Length: 5\r\n\r\nhello"[..],
        b"hello\r\n\r\n",
        b"Content-Length: x\r\n\r\n",
        b"Content-Type: a\r\n\r\n",
        b"Content-Length: 4\r\n\r\n\xff\xff\xff\xff",
        b"Content-Length: 2\r\n\r\n[]",
    ] {
        let mut client = Client::new();
        client.raw(bytes);
        let (code, said) = client.ended();
        let shown = String::from_utf8_lossy(bytes);
        assert_eq!(
            (code, said.contains("no message of the protocol"), said.contains("panicked")),
            (Some(1), true, false),
            "{shown}: {said}"
        );
    }
}

#[test]
fn what_is_cancelled_is_not_worked_on() {
    let (_folder, root) = project(&[]);
    let path = root.join("a.lss");
    let mut client = Client::new();
    client.open(&path, CONSTRAINTS);
    let params = json!({ "query": "P" });
    let ids: Vec<i64> = (0..50).map(|_| client.request("workspace/symbol", params.clone())).collect();
    for id in &ids {
        client.tell("$/cancelRequest", json!({ "id": id }));
    }
    let answers: Vec<Result<Value, Value>> = ids.iter().map(|id| client.answer(*id)).collect();
    let cancelled = answers.iter().filter(|a| a.as_ref().is_err_and(|e| e["code"] == -32800)).count();
    assert!(
        cancelled > 0
            && answers
                .iter()
                .all(|a| a.as_ref().is_ok_and(Value::is_array) || a.as_ref().is_err_and(|e| e["code"] == -32800))
    );
    assert_eq!(client.shut_down(), (Some(0), String::new()));
}

/// Pieces that break a layout in many ways.
const PIECES: [&str; 18] = [
    "",
    "{",
    "}",
    "(",
    ")",
    "\"",
    "\n",
    "..",
    "//",
    "P1",
    "vertex ",
    "12 m",
    "ä",
    "🚚",
    "\r\n",
    "use std.",
    "= ",
    "fix length P1..P2\n",
];

#[test]
fn random_edits_and_questions_end_nothing_and_edits_are_what_a_fresh_text_is() {
    let (_folder, root) = project(&[]);
    let path = root.join("a.lss");
    let fresh = root.join("fresh.lss");
    let (mut client, _) = Client::with(capable());
    let mut state = 7;
    let mut next = |below: usize| (mix(&mut state) % below.max(1) as u64) as usize;
    let mut lines: Vec<Vec<u16>> = CONSTRAINTS.split('\n').map(|l| l.encode_utf16().collect()).collect();
    client.open(&path, CONSTRAINTS);
    for round in 0..150 {
        if round % 25 == 24 {
            // Begins anew, or nothing is left of the layout.
            lines = CONSTRAINTS.split('\n').map(|l| l.encode_utf16().collect()).collect();
            client.change(&path, json!([{ "text": CONSTRAINTS }]));
        }
        // The test's own edit, in UTF-16 and line by line: no half of a character, no half of a line break.
        let whole = |line: &[u16], at: usize| {
            let at = at.min(line.len());
            let at = at - usize::from(at > 0 && (0xd800..0xdc00).contains(&line[at - 1]));
            at - usize::from(at > 0 && line[at - 1] == u16::from(b'\r'))
        };
        let a = next(lines.len());
        let b = (a + next(2)).min(lines.len() - 1);
        let (mut from, mut to) =
            (whole(&lines[a], next(lines[a].len() + 1)), whole(&lines[b], next(lines[b].len() + 1)));
        if a == b && from > to {
            std::mem::swap(&mut from, &mut to);
        }
        if next(4) > 0 {
            to = if a == b { from } else { to };
        }
        let piece = PIECES[next(PIECES.len())];
        client.change(&path, json!([{ "range": { "start": at(a, from), "end": at(b, to) }, "text": piece }]));
        let mut joined = lines[a][..from].to_vec();
        joined.extend(piece.encode_utf16());
        joined.extend(&lines[b][to..]);
        let parts: Vec<Vec<u16>> = joined.split(|c| *c == u16::from(b'\n')).map(<[u16]>::to_vec).collect();
        lines.splice(a..=b, parts);
        for method in ["completion", "hover", "definition", "references", "documentHighlight", "prepareRename"] {
            let position = at(next(lines.len() + 3), next(90));
            let params = json!({ "textDocument": { "uri": uri(&path) }, "position": position, "context": { "includeDeclaration": true, "triggerKind": 1 } });
            if let Err(error) = client.ask(&format!("textDocument/{method}"), params) {
                assert_eq!((method, error["code"].as_i64()), ("prepareRename", Some(-32803)), "{error}");
            }
        }
        let document = json!({ "uri": uri(&path) });
        let range = json!({ "start": at(next(lines.len()), next(40)), "end": at(next(lines.len() + 2), next(40)) });
        for (method, params) in [
            ("documentSymbol", json!({ "textDocument": document })),
            ("foldingRange", json!({ "textDocument": document })),
            ("semanticTokens/full", json!({ "textDocument": document })),
            ("formatting", json!({ "textDocument": document, "options": { "tabSize": 2, "insertSpaces": true } })),
            ("inlayHint", json!({ "textDocument": document, "range": range })),
            ("codeAction", json!({ "textDocument": document, "range": range, "context": { "diagnostics": [] } })),
            ("selectionRange", json!({ "textDocument": document, "positions": [range["start"]] })),
        ] {
            client.ask(&format!("textDocument/{method}"), params).unwrap_or_else(|error| panic!("{method}: {error}"));
        }
        let text: Vec<String> = lines.iter().map(|l| String::from_utf16(l).expect("whole characters")).collect();
        client.open(&fresh, &text.join("\n"));
        let pulled = |client: &mut Client, uri: String| {
            client.ask("textDocument/diagnostic", json!({ "textDocument": { "uri": uri } })).expect("all")["items"]
                .clone()
        };
        let (edited, opened) = (pulled(&mut client, uri(&path)), pulled(&mut client, uri(&fresh)));
        let alike = |all: &Value| all.to_string().replace("/fresh.lss", "/a.lss");
        assert_eq!(alike(&edited), alike(&opened), "round {round}");
        client.close(&fresh);
    }
    assert_eq!(client.shut_down(), (Some(0), String::new()));
}
