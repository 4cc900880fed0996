//! A preview that runs, and a client that speaks as much HTTP as it takes.

use serde_json::Value;
use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// How long anything may take before a test fails.
pub const PATIENCE: Duration = Duration::from_secs(120);

/// A hall with four vertices, one of them with a comment, and one placed by a formula.
pub const HALL: &str = "\
// A hall.
use std.carts.tilt_tray
use std.tracks.standard

let far = 37 m

layout hall {
  catalog standard
  cart tilt_tray(length: 1250 mm)
  speed 2.0 m/s
  width 1.2 m

  vertex P1 (3 m, 3 m) radius 3 m
  vertex P2   (37.0 m ,  3000 mm) radius 3 m // the dock, measured
  vertex P3 (far, 17 m) radius 3 m
  vertex P4 (3 m, 17 m) radius 3 m

  building [(0 m, 0 m), (40 m, 0 m), (40 m, 20 m), (0 m, 20 m)]
  require length(straight(P3..P4)) >= 12 m \"room for ten chutes\"
  optimise nothing
}
";

/// The same, optimised; with a heading given, which leaves little to search.
pub fn optimised() -> String {
    HALL.replace("optimise nothing", "fix rotation P1..P2\n  optimise length")
}

/// An answer of the server.
#[derive(Debug)]
pub struct Answer {
    pub status: u16,
    pub headers: String,
    pub body: String,
}

impl Answer {
    pub fn json(&self) -> Value {
        serde_json::from_str(&self.body).unwrap_or_else(|why| panic!("{why}: {self:?}"))
    }
}

/// A preview of a file in a folder of its own.
pub struct Preview {
    pub folder: TempDir,
    pub file: PathBuf,
    process: Child,
    pub address: String,
    pub port: u16,
    /// `/TOKEN/`
    pub path: String,
}

impl Preview {
    pub fn new(text: &str) -> Preview {
        Preview::with(text, &[])
    }

    pub fn with(text: &str, arguments: &[&str]) -> Preview {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("lss.toml"), "").unwrap();
        fs::write(folder.path().join("hall.lss"), text).unwrap();
        Preview::of(folder, arguments)
    }

    /// Of `hall.lss` in a folder.
    pub fn of(folder: TempDir, arguments: &[&str]) -> Preview {
        let mut process = Command::new(env!("CARGO_BIN_EXE_lss"))
            .current_dir(folder.path())
            .args(["preview", "hall.lss"])
            .args(arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut address = String::new();
        BufReader::new(process.stdout.as_mut().unwrap()).read_line(&mut address).unwrap();
        let address = address.trim().to_owned();
        let rest = address.strip_prefix("http://127.0.0.1:").unwrap_or_else(|| panic!("{address:?}"));
        let (port, token) = rest.split_once('/').unwrap();
        let (port, path) = (port.parse().unwrap(), format!("/{token}"));
        Preview { file: folder.path().join("hall.lss"), folder, process, address, port, path }
    }

    pub fn text(&self) -> String {
        fs::read_to_string(&self.file).unwrap()
    }

    /// Saves the file as editors do that write beside it and rename.
    pub fn save(&self, text: &str) {
        let beside = self.folder.path().join("hall.lss.new");
        fs::write(&beside, text).unwrap();
        fs::rename(beside, &self.file).unwrap();
    }

    /// Whatever request, word for word.
    pub fn raw(&self, request: &str) -> Answer {
        let mut stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        stream.write_all(request.as_bytes()).unwrap();
        let mut answer = String::new();
        // A refused body may end in a reset behind the answer.
        let _ = stream.read_to_string(&mut answer);
        let (head, body) = answer.split_once("\r\n\r\n").unwrap_or_else(|| panic!("{request:?} {answer:?}"));
        let status = head.split(' ').nth(1).unwrap().parse().unwrap();
        Answer { status, headers: head.to_owned(), body: body.to_owned() }
    }

    pub fn get(&self, path: &str) -> Answer {
        self.raw(&format!("GET {path} HTTP/1.0\r\nHost: 127.0.0.1:{}\r\n\r\n", self.port))
    }

    /// A request as the page makes it.
    pub fn post(&self, what: &str, body: &str) -> Answer {
        let (port, length) = (self.port, body.len());
        self.raw(&format!(
            "POST {}{what} HTTP/1.0\r\nHost: 127.0.0.1:{port}\r\nOrigin: http://127.0.0.1:{port}\r\nContent-Length: \
             {length}\r\n\r\n{body}",
            self.path
        ))
    }

    /// A vertex at a place, in the text that the plan is of.
    pub fn placed(&self, vertex: usize, x: f64, y: f64) -> String {
        let text = &self.parts()["plan"]["text"];
        serde_json::json!({ "vertex": vertex, "x": x, "y": y, "text": text }).to_string()
    }

    /// What pages show now.
    pub fn parts(&self) -> Value {
        self.get(&format!("{}state?after=0", self.path)).json()["parts"].take()
    }

    /// Waits until pages show something.
    pub fn until(&self, what: &str, shows: impl Fn(&Value) -> bool) -> Value {
        let begun = Instant::now();
        loop {
            let parts = self.parts();
            if shows(&parts) {
                return parts;
            }
            assert!(begun.elapsed() < PATIENCE, "{what} never came: {parts:#}");
            std::thread::sleep(Duration::from_millis(30));
        }
    }

    /// Waits until the file is solved as it is now.
    pub fn until_solved(&self) -> Value {
        let id = sha256_begin(&self.text());
        self.until("a solved layout", |parts| {
            let plan = &parts["plan"];
            let settled = parts["status"]["busy"] == false && parts["status"]["stale"] == false;
            settled && plan["text"] == id.as_str() && plan["near"] == false && parts["facts"].is_string()
        })
    }

    /// Interrupts it, and waits for its end.
    #[cfg(unix)]
    pub fn interrupt(mut self) -> Option<i32> {
        let id = self.process.id().to_string();
        assert!(Command::new("kill").args(["-INT", &id]).status().unwrap().success());
        let begun = Instant::now();
        loop {
            if let Some(status) = self.process.try_wait().unwrap() {
                return status.code();
            }
            assert!(begun.elapsed() < PATIENCE, "it does not end");
            std::thread::sleep(Duration::from_millis(30));
        }
    }
}

impl Drop for Preview {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// What the server calls a text by.
fn sha256_begin(text: &str) -> String {
    lss::base::digest::sha256(text.as_bytes())[..16].to_owned()
}
