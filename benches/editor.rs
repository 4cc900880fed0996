//! From an edit to its diagnostics, on a layout of 1,000 lines: `cargo bench --bench editor`.

#![allow(clippy::expect_used, clippy::unwrap_used)]

#[path = "common/large.rs"]
mod large;

use divan::{Bencher, black_box};
use large::large;
use lss::editor::Server;
use serde_json::{Value, json};
use std::cell::RefCell;
use std::rc::Rc;
use std::sync::mpsc::channel;

fn main() {
    divan::main();
}

/// A server with the layout open, and how many diagnostics it has published.
struct Session {
    server: Server,
    published: Rc<RefCell<usize>>,
    line: usize,
    version: i32,
}

impl Session {
    fn new(text: &str) -> Session {
        let (events, _queue) = channel();
        let published = Rc::new(RefCell::new(0));
        let seen = published.clone();
        let mut server = Server::new(
            events,
            Box::new(move |message| {
                if let lsp_server::Message::Notification(n) = message {
                    *seen.borrow_mut() += n.params["diagnostics"].as_array().map_or(0, Vec::len) + 1;
                }
            }),
        );
        let initialize = lsp_server::Request::new(1.into(), "initialize".into(), json!({ "capabilities": {} }));
        server.handle(initialize.into());
        let line = text.lines().position(|l| l.contains("speed 2")).expect("a speed");
        let mut session = Session { server, published, line, version: 1 };
        let document = json!({ "uri": "file:///none/large.lss", "languageId": "lss", "version": 1, "text": text });
        session.tell("textDocument/didOpen", json!({ "textDocument": document }));
        session.server.publish();
        session
    }

    fn tell(&mut self, method: &str, params: Value) {
        self.server.handle(lsp_server::Notification::new(method.to_owned(), params).into());
    }

    /// Takes the unit of the speed away, or puts it back.
    fn edit(&mut self, from: usize, to: usize, text: &str) {
        self.version += 1;
        let at = |character: usize| json!({ "line": self.line, "character": character });
        let change = json!([{ "range": { "start": at(from), "end": at(to) }, "text": text }]);
        let document = json!({ "uri": "file:///none/large.lss", "version": self.version });
        self.tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": change }));
        self.server.publish();
    }
}

#[divan::bench]
fn edit_to_diagnostics(bencher: Bencher) {
    let text = large(400, 9, 258, 36);
    eprintln!("{} lines, {} bytes", text.lines().count(), text.len());
    let mut session = Session::new(&text);
    let mut bare = false;
    bencher.bench_local(|| {
        let before = *session.published.borrow();
        match bare {
            true => session.edit(9, 9, " m/s"),
            false => session.edit(9, 13, ""),
        }
        bare = !bare;
        assert!(*session.published.borrow() > before, "nothing was published");
        black_box(&session.server);
    });
}
