//! A headless Chromium, driven over the DevTools protocol: through two pipes, so that it takes no client of WebSockets.
//! Messages are JSON that end with a zero byte.

#![allow(dead_code)]

use serde_json::{Value, json};
use std::fs::File;
use std::io::{BufRead, BufReader, Write};
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// How long anything may take: a slow machine is no mistake of a page.
const PATIENCE: Duration = Duration::from_secs(120);

const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

/// A browser of its own, with nothing remembered.
pub struct Browser {
    process: Child,
    folder: TempDir,
    wire: Arc<Mutex<Wire>>,
}

struct Wire {
    to: File,
    from: Receiver<Value>,
    next: u64,
    /// Messages of the console, and mistakes of pages.
    complaints: Vec<String>,
    /// What pages asked for.
    requests: Vec<String>,
}

/// A page in a tab.
pub struct Tab {
    wire: Arc<Mutex<Wire>>,
    target: Value,
    session: String,
}

impl Browser {
    /// `None` where there is no browser; the test then says that it was skipped.
    pub fn start() -> Option<Browser> {
        let Some(program) = find(&NAMES).filter(|_| find(&["mkfifo"]).is_some()) else {
            eprintln!("SKIPPED: there is no chromium here");
            return None;
        };
        let folder = tempfile::tempdir().unwrap();
        let [to, from] = ["to", "from"].map(|name| folder.path().join(name));
        assert!(Command::new("mkfifo").args([&to, &from]).status().unwrap().success());
        // It reads at descriptor 3 and writes at 4. As root it runs only without its sandbox.
        let process = Command::new("sh")
            .args(["-c", "exec \"$0\" \"$@\" 3<to 4>from"])
            .arg(program)
            .args(["--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--no-first-run"])
            .args(["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"])
            .args(["--remote-debugging-pipe", "--user-data-dir=profile", "about:blank"])
            .current_dir(folder.path())
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        // In the order in which the shell opens them.
        let to = File::options().write(true).open(&to).unwrap();
        let from = BufReader::new(File::open(&from).unwrap());
        let (send, messages) = channel();
        std::thread::spawn(move || {
            for message in from.split(0).map_while(Result::ok) {
                let Ok(message) = serde_json::from_slice(&message) else { continue };
                if send.send(message).is_err() {
                    break;
                }
            }
        });
        let wire = Wire { to, from: messages, next: 0, complaints: Vec::new(), requests: Vec::new() };
        Some(Browser { process, folder, wire: Arc::new(Mutex::new(wire)) })
    }

    /// A tab of this size (px) with a page, in a window of its own.
    pub fn open(&self, address: &str, size: (u32, u32)) -> Tab {
        self.tab(address, size, true)
    }

    /// A tab over the one that was opened last, which is hidden then.
    pub fn open_over(&self, address: &str, size: (u32, u32)) -> Tab {
        self.tab(address, size, false)
    }

    fn tab(&self, address: &str, (width, height): (u32, u32), own_window: bool) -> Tab {
        let mut wire = self.wire.lock().unwrap();
        let asked = json!({ "url": "about:blank", "newWindow": own_window });
        let target = wire.call("Target.createTarget", asked, None)["targetId"].take();
        let asked = json!({ "targetId": target, "flatten": true });
        let session = wire.call("Target.attachToTarget", asked, None)["sessionId"].as_str().unwrap().to_owned();
        drop(wire);
        let tab = Tab { wire: self.wire.clone(), target, session };
        for domain in ["Page", "Runtime", "Log", "Network"] {
            tab.call(&format!("{domain}.enable"), json!({}));
        }
        tab.resize(width, height);
        tab.visit(address);
        tab
    }

    /// What pages complained of: mistakes of their script, and what their policy did not allow.
    pub fn complaints(&self) -> Vec<String> {
        self.wire.lock().unwrap().complaints.clone()
    }

    /// What pages asked for.
    pub fn requests(&self) -> Vec<String> {
        self.wire.lock().unwrap().requests.clone()
    }
}

/// The first of some programs that is there.
fn find(names: &[&str]) -> Option<PathBuf> {
    let folders: Vec<PathBuf> = std::env::split_paths(&std::env::var_os("PATH")?).collect();
    names.iter().flat_map(|name| folders.iter().map(move |folder| folder.join(name))).find(|path| path.is_file())
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
        // Its children end with it, after a moment in which they still write into the profile.
        for _ in 0..50 {
            if std::fs::remove_dir_all(self.folder.path().join("profile")).is_ok() {
                break;
            }
            std::thread::sleep(Duration::from_millis(50));
        }
    }
}

impl Wire {
    fn call(&mut self, method: &str, params: Value, session: Option<&str>) -> Value {
        self.next += 1;
        let id = self.next;
        let mut message = json!({ "id": id, "method": method, "params": params });
        if let Some(session) = session {
            message["sessionId"] = json!(session);
        }
        self.to.write_all(format!("{message}\0").as_bytes()).unwrap();
        loop {
            let mut got = self.from.recv_timeout(PATIENCE).unwrap_or_else(|why| panic!("{method}: {why}"));
            if got["id"] == id {
                assert!(got["error"].is_null(), "{method}: {got}");
                return got["result"].take();
            }
            match got["method"].as_str() {
                Some("Runtime.exceptionThrown") => self.complaints.push(got["params"]["exceptionDetails"].to_string()),
                Some("Runtime.consoleAPICalled") => self.complaints.push(got["params"]["args"].to_string()),
                // Hints for who reads pixels, as tests do, are no mistakes of a page.
                Some("Log.entryAdded") if got["params"]["entry"]["level"] == "error" => {
                    self.complaints.push(got["params"]["entry"].to_string());
                }
                Some("Network.requestWillBeSent") => {
                    self.requests.push(got["params"]["request"]["url"].as_str().unwrap_or_default().to_owned());
                }
                _ => {}
            }
        }
    }
}

impl Tab {
    fn call(&self, method: &str, params: Value) -> Value {
        self.wire.lock().unwrap().call(method, params, Some(&self.session))
    }

    /// Goes to an address.
    pub fn visit(&self, address: &str) {
        let loaded = self.call("Page.navigate", json!({ "url": address }));
        assert!(loaded["errorText"].is_null(), "{loaded}");
    }

    pub fn resize(&self, width: u32, height: u32) {
        let size = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        self.call("Emulation.setDeviceMetricsOverride", size);
    }

    pub fn prefers_dark(&self, dark: bool) {
        let value = if dark { "dark" } else { "light" };
        let feature = json!({ "name": "prefers-color-scheme", "value": value });
        self.call("Emulation.setEmulatedMedia", json!({ "features": [feature] }));
    }

    /// Brings it before the others of its window.
    pub fn show(&self) {
        self.call("Target.activateTarget", json!({ "targetId": self.target }));
    }

    pub fn reload(&self) {
        self.call("Page.reload", json!({}));
    }

    /// The value of an expression.
    pub fn value(&self, expression: &str) -> Value {
        let asked = json!({ "expression": expression, "returnByValue": true, "awaitPromise": true });
        let mut answer = self.call("Runtime.evaluate", asked);
        assert!(answer["exceptionDetails"].is_null(), "{expression}: {answer}");
        answer["result"]["value"].take()
    }

    /// Waits until an expression is true. While a page is loaded there may be nothing to ask.
    pub fn until(&self, expression: &str) {
        let begun = Instant::now();
        let asked = json!({ "expression": format!("!!({expression})"), "returnByValue": true });
        while self.call("Runtime.evaluate", asked.clone())["result"]["value"] != true {
            assert!(begun.elapsed() < PATIENCE, "never: {expression}\n{}", self.value("document.body.innerText"));
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    pub fn text(&self, selector: &str) -> String {
        self.value(&format!("document.querySelector('{selector}').textContent")).as_str().unwrap_or_default().to_owned()
    }

    /// The middle of an element, px.
    pub fn middle(&self, selector: &str) -> (f64, f64) {
        let box_ = format!(
            "(() => {{ const r = document.querySelector({}).getBoundingClientRect(); return [r.x + r.width / 2, r.y + \
             r.height / 2]; }})()",
            json!(selector)
        );
        let at = self.value(&box_);
        (at[0].as_f64().unwrap(), at[1].as_f64().unwrap())
    }

    pub fn mouse(&self, what: &str, (x, y): (f64, f64), pressed: bool) {
        let button = if what == "mouseMoved" && !pressed { "none" } else { "left" };
        let event = json!({
            "type": what, "x": x, "y": y, "button": button, "buttons": u8::from(pressed), "clickCount": 1,
        });
        self.call("Input.dispatchMouseEvent", event);
    }

    pub fn click(&self, at: (f64, f64)) {
        self.mouse("mouseMoved", at, false);
        self.mouse("mousePressed", at, true);
        self.mouse("mouseReleased", at, false);
    }

    /// A key, with Ctrl held (2) or nothing (0).
    pub fn key(&self, key: &str, modifiers: u8) {
        for what in ["keyDown", "keyUp"] {
            self.call("Input.dispatchKeyEvent", json!({ "type": what, "key": key, "modifiers": modifiers }));
        }
    }
}
