//! A page in headless Chromium, spoken to over the DevTools protocol: by the browser's own pipe, so that no port and no
//! client is needed. Messages are JSON that end with a zero byte.

#![allow(dead_code)]

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

/// How long an answer may take: a slow machine is no mistake of a page.
const PATIENCE: Duration = Duration::from_secs(120);

pub struct Browser {
    child: Child,
    to: ChildStdin,
    from: Receiver<Value>,
    session: String,
    asked: u64,
    /// What the page threw, logged or was refused.
    pub errors: Vec<String>,
    /// What it asked for.
    pub requests: Vec<String>,
    _profile: tempfile::TempDir,
}

impl Browser {
    /// `None`, and a word of it, where there is no Chromium.
    pub fn start() -> Option<Browser> {
        let known = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];
        let there = |name: &&str| {
            let version = Command::new(name).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status();
            version.is_ok_and(|status| status.success())
        };
        let Some(name) = known.iter().find(|name| there(name)) else {
            eprintln!("skipped: there is no Chromium to open pages with");
            return None;
        };
        let profile = tempfile::tempdir().expect("a folder");
        // The browser reads messages from its third channel and writes to its fourth.
        let script = "exec \"$0\" \"$@\" 3<&0 4>&1 </dev/null >/dev/null 2>&1";
        let mut child = Command::new("sh")
            .args(["-c", script, name, "--headless=new", "--no-sandbox", "--remote-debugging-pipe", "--no-first-run"])
            .args([
                "--disable-dev-shm-usage",
                "--use-gl=angle",
                "--use-angle=swiftshader",
                "--enable-unsafe-swiftshader",
            ])
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .arg("about:blank")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("a shell");
        let to = child.stdin.take().expect("a pipe");
        let mut out = BufReader::new(child.stdout.take().expect("a pipe"));
        let (send, from) = channel();
        std::thread::spawn(move || {
            let mut message = Vec::new();
            while out.read_until(0, &mut message).is_ok_and(|n| n > 0) {
                message.pop();
                if let Ok(value) = serde_json::from_slice(&message)
                    && send.send(value).is_err()
                {
                    return;
                }
                message.clear();
            }
        });
        let (errors, requests) = (Vec::new(), Vec::new());
        let mut browser =
            Browser { child, to, from, session: String::new(), asked: 0, errors, requests, _profile: profile };
        let target = browser.call("Target.createTarget", &json!({"url": "about:blank"}))["targetId"].clone();
        let attached = browser.call("Target.attachToTarget", &json!({"targetId": target, "flatten": true}));
        browser.session = attached["sessionId"].as_str().expect("a session").to_owned();
        for domain in ["Page", "Runtime", "Log", "Network"] {
            browser.call(&format!("{domain}.enable"), &json!({}));
        }
        Some(browser)
    }

    fn call(&mut self, method: &str, parameters: &Value) -> Value {
        self.asked += 1;
        let mut message = json!({"id": self.asked, "method": method, "params": parameters});
        if !self.session.is_empty() {
            message["sessionId"] = json!(self.session);
        }
        self.to.write_all(format!("{message}\0").as_bytes()).expect("the browser listens");
        let end = Instant::now() + PATIENCE;
        loop {
            let left = end.saturating_duration_since(Instant::now());
            let answer = self.from.recv_timeout(left).unwrap_or_else(|_| panic!("no answer to {method}"));
            if answer["id"] == self.asked {
                assert!(answer.get("error").is_none(), "{method}: {answer}");
                return answer["result"].clone();
            }
            self.event(&answer);
        }
    }

    fn event(&mut self, event: &Value) {
        let of = &event["params"];
        match event["method"].as_str() {
            Some("Runtime.exceptionThrown") => self.errors.push(of["exceptionDetails"].to_string()),
            Some("Runtime.consoleAPICalled") => self.errors.push(of["args"].to_string()),
            // Hints for who reads pixels, as tests do, are no errors of a page.
            Some("Log.entryAdded") if of["entry"]["level"] == "error" => {
                self.errors.push(of["entry"]["text"].to_string())
            }
            Some("Network.requestWillBeSent") => {
                self.requests.push(of["request"]["url"].as_str().unwrap_or_default().to_owned());
            }
            _ => {}
        }
    }

    /// Opens a page in a window of a size, light or dark, and waits until its pictures stand.
    pub fn open(&mut self, page: &Path, (width, height): (u32, u32), dark: bool) {
        let size = json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": false});
        self.call("Emulation.setDeviceMetricsOverride", &size);
        let scheme = if dark { "dark" } else { "light" };
        let features = json!({"features": [{"name": "prefers-color-scheme", "value": scheme}]});
        self.call("Emulation.setEmulatedMedia", &features);
        let page = page.canonicalize().expect("a page");
        let loaded = self.call("Page.navigate", &json!({"url": format!("file://{}", page.display())}));
        assert!(loaded.get("errorText").is_none(), "{loaded}");
        self.wait("document.readyState === 'complete' && Boolean(window.page) && location.protocol === 'file:'");
    }

    /// The value of an expression.
    pub fn ask(&mut self, expression: &str) -> Value {
        let how = json!({"expression": expression, "returnByValue": true, "awaitPromise": true});
        let answer = self.call("Runtime.evaluate", &how);
        assert!(answer.get("exceptionDetails").is_none(), "{expression}: {}", answer["exceptionDetails"]);
        answer["result"]["value"].clone()
    }

    /// A number.
    pub fn number(&mut self, expression: &str) -> f64 {
        let value = self.ask(expression);
        value.as_f64().unwrap_or_else(|| panic!("{expression} is {value}"))
    }

    /// Until something holds.
    pub fn wait(&mut self, expression: &str) {
        let end = Instant::now() + PATIENCE;
        while self.ask(expression) != json!(true) {
            assert!(Instant::now() < end, "never: {expression}");
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// The mouse: `mouseMoved`, `mousePressed`, `mouseReleased` at a pixel of the window.
    pub fn mouse(&mut self, kind: &str, x: f64, y: f64) {
        let down = kind != "mouseMoved";
        let button = if down { "left" } else { "none" };
        self.call(
            "Input.dispatchMouseEvent",
            &json!({"type": kind, "x": x, "y": y, "button": button, "clickCount": u8::from(down)}),
        );
    }

    /// Middle of an element in the window, which is scrolled there.
    pub fn middle(&mut self, selector: &str) -> (f64, f64) {
        let found = self.ask(&format!(
            "(() => {{ const e = document.querySelector({}); e.scrollIntoView({{block: 'center'}});
               const b = e.getBoundingClientRect(); return [b.x + b.width / 2, b.y + b.height / 2]; }})()",
            json!(selector)
        ));
        (found[0].as_f64().expect("x"), found[1].as_f64().expect("y"))
    }

    /// Presses and lets go in the middle of an element.
    pub fn click(&mut self, selector: &str) {
        let (x, y) = self.middle(selector);
        for kind in ["mouseMoved", "mousePressed", "mouseReleased"] {
            self.mouse(kind, x, y);
        }
    }

    /// What every page holds to: no errors, nothing asked for but the page itself, no weight, no width beyond the window.
    pub fn hold(&mut self, page: &Path) {
        let size = std::fs::metadata(page).expect("a page").len();
        assert!(size < 1_500_000, "{} has {size} bytes", page.display());
        for (width, dark) in [(1400, false), (1400, true), (600, false), (600, true)] {
            self.open(page, (width, 900), dark);
            let beyond = self.number("document.documentElement.scrollWidth - document.documentElement.clientWidth");
            assert!(beyond <= 0.0, "{} is {beyond} px wider than {width} px", page.display());
            let drawn = "[...page.curves.values()].every(c => c.plot || !c.canvas.checkVisibility())";
            assert_eq!(self.ask(drawn), json!(true), "{} has curves that are not drawn", page.display());
            let ground = self.ask("getComputedStyle(document.body).backgroundColor");
            assert_eq!(ground == json!("rgb(255, 255, 255)"), !dark, "{ground}");
        }
        assert_eq!(self.errors, Vec::<String>::new());
        let own = |url: &String| url.starts_with("file://") || url.starts_with("about:");
        assert!(self.requests.iter().all(own), "{:?}", self.requests);
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
