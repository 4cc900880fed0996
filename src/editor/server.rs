//! Messages in, answers and diagnostics out.
//!
//! Messages are taken in order. Diagnostics are published once no message waits: what was typed meanwhile is checked
//! once. A request that its client cancels before its turn is not worked on.

use super::answers;
use super::client::Client;
use super::diagnostics;
use super::place;
use super::session::Session;
use super::solutions::{Outcome, Solutions};
use super::workspace::Workspace;
use crate::semantics::Home;
use lsp_server::{ErrorCode, Message, Notification, Request, RequestId, Response};
use lsp_types as lsp;
use lsp_types::notification::{self as note, Notification as _};
use lsp_types::request::{self as ask, Request as _};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender};
use std::time::{Duration, Instant};

/// After so long without a change, layouts are solved.
const PAUSE: Duration = Duration::from_millis(400);

/// What a server waits for.
pub enum Event {
    Message(Message),
    /// The client's messages ended; with a reason if one was no message.
    Ended(Option<String>),
    Solved(Box<Outcome>),
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Phase {
    /// Not initialised yet.
    Waiting,
    Serving,
    /// `exit` comes next.
    ShutDown,
}

/// A server for one client.
pub struct Server {
    send: Box<dyn FnMut(Message)>,
    events: Sender<Event>,
    phase: Phase,
    session: Session,
    /// What the client shows.
    published: BTreeMap<PathBuf, Vec<lsp::Diagnostic>>,
    /// Whether something changed since.
    changed: bool,
    /// When layouts are to be solved.
    solve_at: Option<Instant>,
    asked: i32,
}

impl Server {
    /// A server whose client has sent nothing yet. `events` is where its own thread reports to.
    pub fn new(events: Sender<Event>, send: Box<dyn FnMut(Message)>) -> Server {
        let client = Client::new(&lsp::InitializeParams::default());
        Server {
            send,
            phase: Phase::Waiting,
            session: Session {
                workspace: Workspace::new(client.encoding),
                solutions: Solutions::new(Duration::ZERO, |_| ()),
                client,
            },
            events,
            published: BTreeMap::new(),
            changed: false,
            solve_at: None,
            asked: 0,
        }
    }

    /// Serves until `exit`.
    ///
    /// # Errors
    ///
    /// The client went away without `shutdown` and `exit`, or sent what is no message.
    pub fn run(mut self, queue: &Receiver<Event>) -> Result<(), String> {
        let mut waiting: VecDeque<Message> = VecDeque::new();
        loop {
            let next = if waiting.is_empty() { self.wait(queue) } else { queue.try_recv().ok() };
            for event in next.into_iter().chain(std::iter::from_fn(|| queue.try_recv().ok())) {
                match event {
                    Event::Message(Message::Notification(n)) if n.method == note::Cancel::METHOD => {
                        self.cancel(&mut waiting, n);
                    }
                    Event::Message(message) => waiting.push_back(message),
                    Event::Solved(outcome) => self.solved(*outcome),
                    Event::Ended(None) if waiting.is_empty() => {
                        return Err("the client went away without `exit`".to_owned());
                    }
                    Event::Ended(None) => {
                        // What it asked for before is answered first.
                        let _ = self.events.send(Event::Ended(None));
                        break;
                    }
                    Event::Ended(Some(why)) => return Err(format!("this is no message of the protocol: {why}")),
                }
            }
            match waiting.pop_front() {
                Some(Message::Notification(n)) if n.method == note::Exit::METHOD => {
                    return match self.phase {
                        Phase::ShutDown => Ok(()),
                        _ => Err("`exit` came without `shutdown`".to_owned()),
                    };
                }
                Some(message) => self.handle(message),
                None => {}
            }
            if waiting.is_empty() {
                self.publish();
            }
        }
    }

    /// The next event; what is due meanwhile is done.
    fn wait(&mut self, queue: &Receiver<Event>) -> Option<Event> {
        let Some(at) = self.solve_at else { return Some(queue.recv().unwrap_or(Event::Ended(None))) };
        match queue.recv_timeout(at.saturating_duration_since(Instant::now())) {
            Ok(event) => Some(event),
            Err(RecvTimeoutError::Timeout) => {
                self.solve();
                None
            }
            Err(RecvTimeoutError::Disconnected) => Some(Event::Ended(None)),
        }
    }

    fn cancel(&mut self, waiting: &mut VecDeque<Message>, n: Notification) {
        let Ok(params) = serde_json::from_value::<lsp::CancelParams>(n.params) else { return };
        let id: RequestId = match params.id {
            lsp::NumberOrString::Number(number) => number.into(),
            lsp::NumberOrString::String(text) => text.into(),
        };
        let known = |m: &Message| matches!(m, Message::Request(request) if request.id == id);
        if let Some(at) = waiting.iter().position(known) {
            waiting.remove(at);
            self.refuse(id, ErrorCode::RequestCanceled, "cancelled".to_owned());
        }
    }

    pub fn handle(&mut self, message: Message) {
        match message {
            Message::Request(request) => self.request(request),
            Message::Notification(n) => self.notification(n),
            // To what was asked of the client, nothing hangs on the answer.
            Message::Response(_) => {}
        }
    }

    fn request(&mut self, request: Request) {
        let id = request.id.clone();
        match (self.phase, request.method.as_str()) {
            (Phase::Waiting, ask::Initialize::METHOD) => self.initialise(request),
            (Phase::Waiting, _) => {
                self.refuse(id, ErrorCode::ServerNotInitialized, "`initialize` comes first".to_owned());
            }
            (Phase::ShutDown, _) => self.refuse(id, ErrorCode::InvalidRequest, "the server is shut down".to_owned()),
            (Phase::Serving, ask::Initialize::METHOD) => {
                self.refuse(id, ErrorCode::InvalidRequest, "`initialize` comes once".to_owned());
            }
            (Phase::Serving, ask::Shutdown::METHOD) => {
                self.phase = Phase::ShutDown;
                self.solve_at = None;
                (self.send)(Response::new_ok(id, ()).into());
            }
            (Phase::Serving, _) => {
                // A mistake in the server costs one answer, not the session.
                let answer = catch_unwind(AssertUnwindSafe(|| answers::answer(&mut self.session, request)));
                let response = answer.unwrap_or_else(|_| {
                    Response::new_err(id, ErrorCode::InternalError as i32, "a mistake in the server".to_owned())
                });
                (self.send)(response.into());
            }
        }
    }

    fn refuse(&mut self, id: RequestId, code: ErrorCode, why: String) {
        (self.send)(Response::new_err(id, code as i32, why).into());
    }

    fn initialise(&mut self, request: Request) {
        let params = match serde_json::from_value::<lsp::InitializeParams>(request.params) {
            Ok(params) => params,
            Err(why) => return self.refuse(request.id, ErrorCode::InvalidParams, why.to_string()),
        };
        self.session.client = Client::new(&params);
        self.session.workspace = Workspace::new(self.session.client.encoding);
        let events = self.events.clone();
        let limit = Duration::try_from_secs_f64(self.session.client.seconds).unwrap_or_default();
        self.session.solutions = Solutions::new(limit, move |outcome| {
            // Without a server nobody waits for it.
            let _ = events.send(Event::Solved(Box::new(outcome)));
        });
        self.phase = Phase::Serving;
        let result = lsp::InitializeResult {
            capabilities: answers::capabilities(&self.session.client),
            server_info: Some(lsp::ServerInfo {
                name: "lss".to_owned(),
                version: Some(env!("CARGO_PKG_VERSION").to_owned()),
            }),
        };
        (self.send)(Response::new_ok(request.id, result).into());
    }

    fn notification(&mut self, n: Notification) {
        if self.phase != Phase::Serving {
            return;
        }
        match n.method.as_str() {
            note::Initialized::METHOD => self.watch(),
            note::DidOpenTextDocument::METHOD => {
                if let Some(params) = read::<lsp::DidOpenTextDocumentParams>(n) {
                    let document = params.text_document;
                    self.session.workspace.open(document.uri, document.version, document.text);
                    self.changed();
                }
            }
            note::DidChangeTextDocument::METHOD => {
                if let Some(params) = read::<lsp::DidChangeTextDocumentParams>(n) {
                    let document = params.text_document;
                    self.session.workspace.edit(&document.uri, document.version, params.content_changes);
                    self.changed();
                }
            }
            note::DidCloseTextDocument::METHOD => {
                if let Some(params) = read::<lsp::DidCloseTextDocumentParams>(n) {
                    self.session.workspace.close(&params.text_document.uri);
                    self.session.solutions.forget(&place::of_uri(&params.text_document.uri));
                    self.changed();
                }
            }
            note::DidSaveTextDocument::METHOD | note::DidChangeWatchedFiles::METHOD => {
                self.session.workspace.forget_all();
                self.changed();
            }
            _ => {}
        }
    }

    fn changed(&mut self) {
        self.changed = true;
        self.solve_at = Some(Instant::now() + PAUSE);
    }

    /// Asks to be told of layouts that change on the disk.
    fn watch(&mut self) {
        if !self.session.client.watches {
            return;
        }
        let watcher =
            lsp::FileSystemWatcher { glob_pattern: lsp::GlobPattern::String("**/*.lss".to_owned()), kind: None };
        let options = lsp::DidChangeWatchedFilesRegistrationOptions { watchers: vec![watcher] };
        let registration = lsp::Registration {
            id: "layouts".to_owned(),
            method: note::DidChangeWatchedFiles::METHOD.to_owned(),
            register_options: serde_json::to_value(options).ok(),
        };
        self.ask::<ask::RegisterCapability>(lsp::RegistrationParams { registrations: vec![registration] });
    }

    fn ask<R: ask::Request>(&mut self, params: R::Params) {
        self.asked += 1;
        let id = RequestId::from(format!("lss-{}", self.asked));
        (self.send)(Request::new(id, R::METHOD.to_owned(), params).into());
    }

    fn tell<N: note::Notification>(&mut self, params: impl Serialize) {
        (self.send)(Notification::new(N::METHOD.to_owned(), params).into());
    }

    /// Publishes what changed since the last time.
    pub fn publish(&mut self) {
        if self.changed {
            self.publish_all();
        }
    }

    fn publish_all(&mut self) {
        self.changed = false;
        let mut now: BTreeMap<PathBuf, Vec<lsp::Diagnostic>> = BTreeMap::new();
        for place in self.session.workspace.places() {
            let Some(checked) = self.session.workspace.checked(&place) else { continue };
            let mut found = diagnostics::by_place(&self.session.workspace, &self.session.client, &checked);
            for said in self.session.solutions.said(&place, &checked) {
                if let Some(Home::Disk(own)) = checked.home(said.label.span.file) {
                    let said = diagnostics::of(&self.session.workspace, &self.session.client, &checked, said);
                    found.entry(own.clone()).or_default().push(said);
                }
            }
            for (place, found) in found {
                let all = now.entry(place).or_default();
                for diagnostic in found {
                    // Files that several open ones import say the same once.
                    if !all.contains(&diagnostic) {
                        all.push(diagnostic);
                    }
                }
            }
        }
        let before = std::mem::take(&mut self.published);
        let places: BTreeSet<&PathBuf> = before.keys().chain(now.keys()).collect();
        for place in places {
            let (old, new) = (before.get(place), now.get(place));
            let is_new = old.is_none() && self.session.workspace.is_open(place);
            if is_new || old.map_or(&[][..], Vec::as_slice) != new.map_or(&[][..], Vec::as_slice) {
                let Some(uri) = self.session.workspace.uri(&Home::Disk(place.clone())) else { continue };
                let version = self.session.workspace.version(place);
                let diagnostics = new.cloned().unwrap_or_default();
                self.tell::<note::PublishDiagnostics>(lsp::PublishDiagnosticsParams { uri, diagnostics, version });
            }
        }
        self.published = now;
    }

    /// Asks for solutions of what is open.
    fn solve(&mut self) {
        self.solve_at = None;
        for place in self.session.workspace.places() {
            if let Some(checked) = self.session.workspace.checked(&place) {
                self.session.solutions.ask(&place, &checked);
            }
        }
    }

    fn solved(&mut self, outcome: Outcome) {
        if self.session.solutions.take(outcome) && self.phase == Phase::Serving {
            self.publish_all();
            if self.session.client.refreshes_hints {
                self.ask::<ask::InlayHintRefreshRequest>(());
            }
        }
    }
}

fn read<P: DeserializeOwned>(n: Notification) -> Option<P> {
    serde_json::from_value(n.params).ok()
}
