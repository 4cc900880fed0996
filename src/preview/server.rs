//! HTTP on the loopback: the page, what it shows, and what it asks for. No address is the name of a file.

use super::guard::{Guard, Refusal};
use super::page;
use super::session::{Ask, Session};
use super::writing::History;
use crate::geometry::Point;
use serde::Deserialize;
use serde_json::json;
use std::io::{self, Cursor, Read};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;
use tiny_http::{Header, Method, Request, Response, Server};

/// How long a page waits for something new before it asks again.
const WAIT: Duration = Duration::from_secs(20);
/// Requests that are answered at a time: each page has one that waits.
const MOST: usize = 64;
/// Largest body, bytes.
const BODY: u64 = 4096;

/// What pages may load: nothing but what this server gives them, no script or style in the text of a page, and no page
/// of another site may show this one in a frame.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src data:; \
                      base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// A body of a request: a vertex at a place, m, in the text with an id.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Placed {
    vertex: usize,
    x: f64,
    y: f64,
    text: String,
}

impl Placed {
    fn read(body: &str) -> Result<Placed, String> {
        let placed: Placed = serde_json::from_str(body).map_err(|why| why.to_string())?;
        // As far as a layout may reach.
        let within = |x: f64| x.is_finite() && x.abs() <= 1e5;
        if within(placed.x) && within(placed.y) { Ok(placed) } else { Err("no place of a hall".to_owned()) }
    }

    fn to(&self) -> Point {
        Point::new(self.x, self.y)
    }
}

/// Who answers.
pub struct Service {
    pub guard: Guard,
    pub session: Arc<Session>,
    pub history: History,
    busy: AtomicUsize,
}

type Answer = Response<Cursor<Vec<u8>>>;

impl Service {
    pub fn new(guard: Guard, session: Arc<Session>) -> Service {
        Service { guard, session, history: History::default(), busy: AtomicUsize::new(0) }
    }

    /// Answers until the server is unblocked.
    pub fn run(self: &Arc<Service>, server: &Server) {
        while let Ok(request) = server.recv() {
            let service = self.clone();
            if self.busy.fetch_add(1, Ordering::Relaxed) >= MOST {
                self.busy.fetch_sub(1, Ordering::Relaxed);
                reply(request, text(503, "too many pages"));
                continue;
            }
            std::thread::spawn(move || {
                let _busy = Busy(&service.busy);
                let mut request = request;
                let answer = service.answer(&mut request);
                reply(request, answer);
            });
        }
    }

    fn answer(&self, request: &mut Request) -> Answer {
        let (path, query) = match self.guard.admit(request) {
            Ok(admitted) => admitted,
            Err(Refusal::Foreign) => return text(403, "this server answers only to its own page"),
            Err(Refusal::Unknown) => return text(404, "open the address that `lss preview` printed"),
        };
        match (request.method(), path.as_str()) {
            (Method::Get, "") => typed(200, "text/html; charset=utf-8", page::html(&self.session.file)),
            (Method::Get, "page.css") => typed(200, "text/css; charset=utf-8", page::style()),
            (Method::Get, "page.js") => typed(200, "text/javascript; charset=utf-8", page::SCRIPT.to_owned()),
            (Method::Get, "state") => {
                let after = query.strip_prefix("after=").and_then(|n| n.parse().ok()).unwrap_or(0);
                json_of(200, &self.session.board.after(after, WAIT))
            }
            (Method::Post, "move") => self.with_body(request, |body| {
                let placed = Placed::read(body)?;
                self.session.ask(Ask::Move { vertex: placed.vertex, to: placed.to(), text: placed.text });
                Ok(())
            }),
            (Method::Post, "put") => self.with_body(request, |body| {
                let placed = Placed::read(body)?;
                self.changed(self.history.put(&self.session, placed.vertex, placed.to(), &placed.text))
            }),
            (Method::Post, "still") => self.with_body(request, |_| {
                self.session.ask(Ask::Still);
                Ok(())
            }),
            (Method::Post, "undo") => self.with_body(request, |_| self.changed(self.history.undo(&self.session))),
            (Method::Post, "redo") => self.with_body(request, |_| self.changed(self.history.redo(&self.session))),
            _ => text(404, "there is nothing here"),
        }
    }

    /// Shows what can be taken back now; what could not be written is shown no more.
    fn changed(&self, done: Result<(), String>) -> Result<(), String> {
        if done.is_err() {
            self.session.ask(Ask::Still);
        }
        let (undo, redo) = self.history.sizes();
        self.session.board.show([("history", json!({ "undo": undo, "redo": redo }))]);
        done
    }

    fn with_body(&self, request: &mut Request, act: impl FnOnce(&str) -> Result<(), String>) -> Answer {
        let mut body = String::new();
        match request.as_reader().take(BODY + 1).read_to_string(&mut body) {
            Ok(bytes) if bytes as u64 > BODY => return text(413, "too long"),
            Ok(_) => {}
            Err(_) => return text(400, "no text"),
        }
        match act(&body) {
            Ok(()) => json_of(200, &json!({ "problem": null })),
            Err(why) => json_of(409, &json!({ "problem": why })),
        }
    }
}

/// Counts a request until it is answered, or its thread has panicked.
struct Busy<'a>(&'a AtomicUsize);

impl Drop for Busy<'_> {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

fn reply(request: Request, answer: Answer) {
    // A page that has gone needs no answer.
    let _: io::Result<()> = request.respond(answer);
}

fn text(status: u16, words: &str) -> Answer {
    typed(status, "text/plain; charset=utf-8", format!("{words}\n"))
}

fn json_of(status: u16, value: &serde_json::Value) -> Answer {
    typed(status, "application/json", value.to_string())
}

fn typed(status: u16, kind: &str, body: String) -> Answer {
    let headers = [
        ("Content-Type", kind),
        ("Content-Security-Policy", POLICY),
        ("X-Content-Type-Options", "nosniff"),
        ("X-Frame-Options", "DENY"),
        ("Referrer-Policy", "no-referrer"),
        ("Cross-Origin-Resource-Policy", "same-origin"),
        ("Cross-Origin-Opener-Policy", "same-origin"),
        ("Cache-Control", "no-store"),
    ];
    let response = Response::from_string(body).with_status_code(status);
    headers.into_iter().fold(response, |response, (name, value)| match Header::from_bytes(name, value) {
        Ok(header) => response.with_header(header),
        // None of these is no header.
        Err(()) => response,
    })
}
