//! A client of the language server with framing of its own, over the standard input and output of the program.

use assert_cmd::cargo::CommandCargoExt;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

/// Longer than any answer takes: a test that waits so long has failed.
const PATIENCE: Duration = Duration::from_secs(60);

pub struct Client {
    child: Child,
    input: Option<ChildStdin>,
    messages: Receiver<Value>,
    /// By URI, the last that was published.
    pub published: BTreeMap<String, Vec<Value>>,
    /// Requests of the server.
    pub asked: Vec<Value>,
    next: i64,
    versions: BTreeMap<String, i64>,
    _cache: tempfile::TempDir,
}

/// A position as the protocol has it.
pub fn at(line: usize, character: usize) -> Value {
    json!({ "line": line, "character": character })
}

pub fn uri(path: &Path) -> String {
    let mut out = "file://".to_owned();
    for byte in path.to_string_lossy().bytes() {
        match byte {
            b'/' | b'.' | b'-' | b'_' => out.push(char::from(byte)),
            byte if byte.is_ascii_alphanumeric() => out.push(char::from(byte)),
            byte => out += &format!("%{byte:02X}"),
        }
    }
    out
}

/// All that a capable client says it can do.
pub fn capable() -> Value {
    json!({
        "textDocument": {
            "publishDiagnostics": { "relatedInformation": true, "codeDescriptionSupport": true },
            "completion": { "completionItem": { "snippetSupport": true } },
            "documentSymbol": { "hierarchicalDocumentSymbolSupport": true },
        },
        "workspace": { "inlayHint": { "refreshSupport": true } },
    })
}

impl Client {
    /// A server that was started and nothing else.
    pub fn start() -> Client {
        let cache = tempfile::tempdir().expect("a folder");
        let mut command = Command::cargo_bin("lss").expect("the binary");
        command.arg("lsp").env("XDG_CACHE_HOME", cache.path());
        let mut child =
            command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("a process");
        let input = child.stdin.take();
        let mut output = BufReader::new(child.stdout.take().expect("its output"));
        let (send, messages) = channel();
        std::thread::spawn(move || {
            while let Some(message) = read(&mut output) {
                if send.send(message).is_err() {
                    break;
                }
            }
        });
        let (published, asked, versions) = (BTreeMap::new(), Vec::new(), BTreeMap::new());
        Client { child, input, messages, published, asked, next: 0, versions, _cache: cache }
    }

    /// The same, initialised.
    pub fn with(capabilities: Value) -> (Client, Value) {
        let mut client = Client::start();
        let params = json!({ "processId": null, "rootUri": null, "capabilities": capabilities });
        let answer = client.ask("initialize", params).expect("initialised");
        client.tell("initialized", json!({}));
        (client, answer["capabilities"].clone())
    }

    pub fn new() -> Client {
        Client::with(capable()).0
    }

    /// Sends bytes as they are.
    pub fn raw(&mut self, bytes: &[u8]) {
        let input = self.input.as_mut().expect("open");
        // The server may have ended because of what came before.
        let _ = input.write_all(bytes).and_then(|()| input.flush());
    }

    fn send(&mut self, message: &Value) {
        let text = message.to_string();
        self.raw(format!("Content-Length: {}\r\n\r\n{text}", text.len()).as_bytes());
    }

    pub fn tell(&mut self, method: &str, params: Value) {
        self.send(&json!({ "jsonrpc": "2.0", "method": method, "params": params }));
    }

    /// Sends a request and does not wait.
    pub fn request(&mut self, method: &str, params: Value) -> i64 {
        self.next += 1;
        self.send(&json!({ "jsonrpc": "2.0", "id": self.next, "method": method, "params": params }));
        self.next
    }

    /// The answer to a request; `Err` is the error of the server.
    pub fn answer(&mut self, id: i64) -> Result<Value, Value> {
        loop {
            let message = self.message();
            if message["id"] == json!(id) && message.get("method").is_none() {
                return match message.get("error") {
                    Some(error) => Err(error.clone()),
                    None => Ok(message["result"].clone()),
                };
            }
        }
    }

    pub fn ask(&mut self, method: &str, params: Value) -> Result<Value, Value> {
        let id = self.request(method, params);
        self.answer(id)
    }

    /// The next message, taken notice of.
    fn message(&mut self) -> Value {
        let message = self.messages.recv_timeout(PATIENCE).expect("a message");
        match (message["method"].as_str(), message.get("id")) {
            (Some("textDocument/publishDiagnostics"), _) => {
                let params = &message["params"];
                let all = params["diagnostics"].as_array().cloned().expect("a list");
                self.published.insert(params["uri"].as_str().expect("a URI").to_owned(), all);
            }
            (Some(_), Some(id)) => {
                self.asked.push(message.clone());
                let answer = json!({ "jsonrpc": "2.0", "id": id, "result": null });
                self.send(&answer);
            }
            _ => {}
        }
        message
    }

    /// Waits for a notification or request of the server.
    pub fn wait(&mut self, method: &str) -> Value {
        loop {
            let message = self.message();
            if message["method"] == method {
                return message["params"].clone();
            }
        }
    }

    pub fn open(&mut self, path: &Path, text: &str) {
        let uri = uri(path);
        self.versions.insert(uri.clone(), 1);
        let document = json!({ "uri": uri, "languageId": "lss", "version": 1, "text": text });
        self.tell("textDocument/didOpen", json!({ "textDocument": document }));
    }

    pub fn change(&mut self, path: &Path, changes: Value) {
        let uri = uri(path);
        let version = self.versions.entry(uri.clone()).or_default();
        *version += 1;
        let document = json!({ "uri": uri, "version": *version });
        self.tell("textDocument/didChange", json!({ "textDocument": document, "contentChanges": changes }));
    }

    pub fn close(&mut self, path: &Path) {
        self.tell("textDocument/didClose", json!({ "textDocument": { "uri": uri(path) } }));
    }

    /// The codes that are published of a file once the server has done all that was asked.
    pub fn codes(&mut self, path: &Path) -> Vec<String> {
        // Diagnostics are published when nothing waits: the first request sees to it that they are sent before the
        // answer of the second.
        for _ in 0..2 {
            let _ =
                self.ask("textDocument/hover", json!({ "textDocument": { "uri": uri(path) }, "position": at(0, 0) }));
        }
        let all = self.published.get(&uri(path)).cloned().unwrap_or_default();
        all.iter().map(|d| d["code"].as_str().expect("a code").to_owned()).collect()
    }

    /// Asks about a position of a document.
    pub fn ask_at(&mut self, method: &str, path: &Path, position: Value) -> Result<Value, Value> {
        self.ask(method, json!({ "textDocument": { "uri": uri(path) }, "position": position }))
    }

    /// What the hover says there.
    pub fn hover(&mut self, path: &Path, position: Value) -> String {
        let found = self.ask_at("textDocument/hover", path, position).expect("an answer");
        found["contents"]["value"].as_str().unwrap_or_default().to_owned()
    }

    pub fn complete(&mut self, path: &Path, position: Value) -> Vec<Value> {
        let found = self.ask_at("textDocument/completion", path, position).expect("an answer");
        found.as_array().cloned().unwrap_or_default()
    }

    /// Ends as the protocol wants it: the exit code, and what stood on standard error.
    pub fn shut_down(mut self) -> (Option<i32>, String) {
        assert_eq!(self.ask("shutdown", Value::Null), Ok(Value::Null));
        self.tell("exit", Value::Null);
        self.ended()
    }

    /// Closes the server's input and waits for its end.
    pub fn ended(mut self) -> (Option<i32>, String) {
        self.input = None;
        let status = self.child.wait().expect("an end");
        let mut said = String::new();
        self.child.stderr.take().expect("its errors").read_to_string(&mut said).expect("text");
        (status.code(), said)
    }
}

impl Drop for Client {
    fn drop(&mut self) {
        // Of a test that failed; one that ended is not there any more.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn read(output: &mut impl BufRead) -> Option<Value> {
    let mut length = None;
    loop {
        let mut line = String::new();
        if output.read_line(&mut line).ok()? == 0 {
            return None;
        }
        match line.trim_end() {
            "" => break,
            header => {
                if let Some(value) = header.strip_prefix("Content-Length: ") {
                    length = value.parse().ok();
                }
            }
        }
    }
    let mut bytes = vec![0; length?];
    output.read_exact(&mut bytes).ok()?;
    serde_json::from_slice(&bytes).ok()
}

/// A folder of a project, with files.
pub fn project(files: &[(&str, &str)]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let place = folder.path().canonicalize().expect("there");
    std::fs::write(place.join("lss.toml"), "").expect("written");
    for (name, text) in files {
        let path = place.join(name);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        std::fs::write(path, text).expect("written");
    }
    (folder, place)
}

/// Where a mark stands in a text, in UTF-16 from the protocol's own count.
pub fn position(text: &str, mark: &str, nth: usize) -> Value {
    let (offset, _) = text.match_indices(mark).nth(nth).unwrap_or_else(|| panic!("no {mark}"));
    let line = text[..offset].matches('\n').count();
    let begin = text[..offset].rfind('\n').map_or(0, |b| b + 1);
    at(line, text[begin..offset].encode_utf16().count())
}

/// A text after edits of the protocol.
pub fn applied(text: &str, edits: &[Value]) -> String {
    let offset = |position: &Value| {
        let (line, character) =
            (position["line"].as_u64().expect("a line"), position["character"].as_u64().expect("a place"));
        let begin = text.split_inclusive('\n').take(line as usize).map(str::len).sum::<usize>();
        let mut units = 0;
        for (at, c) in text[begin..].char_indices() {
            if units >= character as usize {
                return begin + at;
            }
            units += c.len_utf16();
        }
        text.len()
    };
    let mut all: Vec<(usize, usize, String)> = edits
        .iter()
        .map(|e| {
            (offset(&e["range"]["start"]), offset(&e["range"]["end"]), e["newText"].as_str().expect("text").to_owned())
        })
        .collect();
    all.sort();
    let mut text = text.to_owned();
    for (start, end, new) in all.into_iter().rev() {
        text.replace_range(start..end, &new);
    }
    text
}
