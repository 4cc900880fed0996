//! Text sync, diagnostics, and the protocol's own rules.

use super::client::{Client, at, capable, position, project, uri};
use serde_json::{Value, json};

const SMALLEST: &str = include_str!("../../../examples/smallest.lss");

#[test]
fn a_layout_is_checked_as_it_is_typed() {
    let (_folder, root) = project(&[]);
    let path = root.join("plant ä.lss");
    let mut client = Client::new();
    client.open(&path, SMALLEST);
    assert!(client.codes(&path).is_empty());
    // `// ä 🚚` before a token of the same line: characters count in UTF-16.
    let line = SMALLEST.lines().count();
    client.change(
        &path,
        json!([{ "range": { "start": at(line, 0), "end": at(line, 0) }, "text": "let a = 1 m // ä 🚚 b\n" }]),
    );
    assert!(client.codes(&path).is_empty());
    client.change(&path, json!([{ "range": { "start": at(line, 17), "end": at(line, 18) }, "text": "🚚🚚" }]));
    client.change(&path, json!([{ "range": { "start": at(line, 8), "end": at(line, 21) }, "text": "2 foo // ä" }]));
    assert_eq!(client.codes(&path), ["E0303"]);
    let range = &client.published[&uri(&path).replace('ä', "%C3%A4")]
        .first()
        .or(client.published[&uri(&path)].first())
        .expect("one")["range"];
    assert_eq!(*range, json!({ "start": at(line, 10), "end": at(line, 13) }));
    client.close(&path);
    assert!(client.codes(&path).is_empty());
    assert_eq!(client.shut_down(), (Some(0), String::new()));
}
