//! From an edit to its diagnostics, on a layout of 1,000 lines: `cargo bench --bench editor`.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use divan::{Bencher, black_box};
use lss::editor::Server;
use serde_json::{Value, json};
use std::cell::RefCell;
use std::fmt::Write;
use std::rc::Rc;
use std::sync::mpsc::channel;

fn main() {
    divan::main();
}

/// 1,000 lines: values, a comb of 40 vertices, obstacles and requirements, with comments.
fn layout() -> String {
    let mut text = String::from("use std.carts.tilt_tray\nuse std.tracks.thesis\n");
    for i in 0..400 {
        let _ = writeln!(text, "let aisle_{i} = {} * 1.2 m + {i} mm // between racks", i % 7 + 1);
    }
    text += "layout large {\n  catalog thesis\n  cart tilt_tray(length: 1250 mm)\n  speed 2 m/s\n  width 1.2 m\n";
    let teeth = 9;
    for i in 0..teeth {
        let x = 40.0 * f64::from(i);
        for (k, (dx, y)) in [(0.0, 0.0), (12.0, 0.0), (12.0, 30.0), (28.0, 30.0)].into_iter().enumerate() {
            let _ = writeln!(text, "  vertex P{i}_{k} ({} m, {} m) radius 4 m", x + dx, 100.0 - y);
        }
    }
    let end = 40.0 * f64::from(teeth);
    let _ = writeln!(text, "  vertex E0 ({end} m, 100 m) radius 4 m\n  vertex E1 ({end} m, 200 m) radius 4 m");
    text += "  vertex E2 (-40 m, 200 m) radius 4 m\n  vertex E3 (-40 m, 112 m) radius 4 m\n";
    for i in 0..258 {
        let _ = writeln!(text, "  // rack {i}");
        let x = 1.5 * f64::from(i);
        let (a, b) = (format!("{x} m"), format!("{} m", x + 1.0));
        let _ = writeln!(text, "  obstacle rack_{i} [({a}, 150 m), ({b}, 150 m), ({b}, 151 m), ({a}, 151 m)]");
    }
    for i in 0..36 {
        let _ = writeln!(text, "  require radius(P{}_{}) <= 8 m \"row {i}\"", i / 4, i % 4);
    }
    text += "  optimise length\n}\n";
    text
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
    let text = layout();
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
