//! One preview: the file that is shown, and the thread that checks and solves it.
//!
//! Pages and the watcher ask; the thread answers by what it puts on the [`Board`]. A search over the grid is abandoned
//! as soon as something newer is asked for; of several movements of a vertex that wait, the last one counts.

use super::board::Board;
use super::edit;
use super::forces::Forces;
use super::known::{Known, chosen};
use super::plan::Subject;
use super::{facts, listing, messages, plan, solving};
use crate::compiled::Compiled;
use crate::diagnostic::{Code, Diagnostic};
use crate::emit::svg::Sheet;
use crate::geometry::Point;
use crate::model;
use crate::semantics::Checked;
use crate::source::{LoadError, Overlay, root, shown};
use serde_json::{Value, json};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// A movement that nobody goes on with is over after this time: its page has gone.
const FORGOTTEN: Duration = Duration::from_secs(15);

/// What is shown, and how.
#[derive(Clone, Debug)]
pub struct Settings {
    pub file: PathBuf,
    /// Which layout, when the file has several.
    pub layout: Option<String>,
    /// Port on the loopback; 0 for one that is free.
    pub port: u16,
    /// When the search for the best layout on the grid ends.
    pub limit: Duration,
    pub threads: usize,
    /// A simulated run, whose forces are told where it is of the same track.
    pub forces: Option<Arc<Forces>>,
}

/// What the thread is asked for.
#[derive(Clone, Debug)]
pub enum Ask {
    /// Files may have changed.
    Look,
    /// A vertex (its number) of the text with this id is dragged to a place, m.
    Move {
        vertex: usize,
        to: Point,
        text: String,
    },
    /// It is dragged no more.
    Still,
    End,
}

/// What others know of the thread.
#[derive(Debug)]
pub struct Session {
    pub file: PathBuf,
    pub board: Board,
    asks: Mutex<Sender<Ask>>,
    /// Ends a search over the grid.
    ended: &'static AtomicBool,
    known: Mutex<Option<Arc<Known>>>,
    watched: Mutex<Watched>,
}

/// What the watcher looks at.
#[derive(Clone, Debug, Default)]
pub struct Watched {
    /// The files, each with its text as it was read; `None` of one that could not be.
    pub texts: Vec<(PathBuf, Option<String>)>,
    /// Whether a file was missing that may come.
    pub incomplete: bool,
}

impl Session {
    /// Starts the thread.
    pub fn start(settings: &Settings) -> Arc<Session> {
        let (asks, queue) = channel();
        let session = Arc::new(Session {
            file: settings.file.clone(),
            board: Board::default(),
            asks: Mutex::new(asks),
            // One for each preview, which a process has one of.
            ended: Box::leak(Box::new(AtomicBool::new(false))),
            known: Mutex::default(),
            watched: Mutex::default(),
        });
        let worker = Worker {
            session: session.clone(),
            settings: settings.clone(),
            texts: Vec::new(),
            sheet: None,
            solved: None,
            pending: None,
            moving: false,
        };
        session.ask(Ask::Look);
        std::thread::spawn(move || worker.run(&queue));
        session
    }

    pub fn ask(&self, ask: Ask) {
        let asks = self.asks.lock().unwrap_or_else(PoisonError::into_inner);
        // Without the thread nobody is there to tell.
        let _ = asks.send(ask);
        self.ended.store(true, Ordering::Relaxed);
    }

    /// The text on the disk as it was last looked at, if it has no mistakes.
    pub fn known(&self) -> Option<Arc<Known>> {
        self.known.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    pub fn watched(&self) -> Watched {
        self.watched.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// A layout that is to be solved.
struct Job {
    known: Arc<Known>,
    key: String,
}

struct Worker {
    session: Arc<Session>,
    settings: Settings,
    /// What was read last, by place.
    texts: Vec<(PathBuf, String)>,
    sheet: Option<Sheet>,
    /// What was solved last, and from what.
    solved: Option<(String, Compiled)>,
    pending: Option<Job>,
    /// Whether a movement is shown.
    moving: bool,
}

impl Worker {
    fn run(mut self, queue: &Receiver<Ask>) {
        loop {
            let first = if self.pending.is_some() {
                queue.try_recv().ok()
            } else if self.moving {
                match queue.recv_timeout(FORGOTTEN) {
                    Ok(ask) => Some(ask),
                    Err(RecvTimeoutError::Timeout) => Some(Ask::Still),
                    Err(RecvTimeoutError::Disconnected) => return,
                }
            } else {
                let Ok(ask) = queue.recv() else { return };
                Some(ask)
            };
            self.session.ended.store(false, Ordering::Relaxed);
            let (mut look, mut movement, mut still) = (false, None, false);
            for ask in first.into_iter().chain(queue.try_iter()) {
                match ask {
                    Ask::Look => look = true,
                    Ask::Move { vertex, to, text } => (movement, still) = (Some((vertex, to, text)), false),
                    Ask::Still => (movement, still) = (None, true),
                    Ask::End => return,
                }
            }
            // A mistake in the program costs one picture, not the preview.
            let done = catch_unwind(AssertUnwindSafe(|| {
                if still {
                    self.stand();
                }
                if look {
                    self.look();
                }
                if let Some((vertex, to, text)) = movement {
                    self.follow(vertex, to, &text);
                } else if let Some(job) = self.pending.take() {
                    self.solve(job);
                }
            }));
            if done.is_err() {
                self.moving = false;
                let status = self.status("a mistake in lss itself: this cannot be shown", false, true);
                self.show([("moving", Value::Null), status]);
            }
        }
    }

    fn show(&self, parts: impl IntoIterator<Item = (&'static str, Value)>) {
        self.session.board.show(parts);
    }

    fn status(&self, words: &str, busy: bool, stale: bool) -> (&'static str, Value) {
        ("status", json!({ "words": words, "busy": busy, "stale": stale }))
    }

    fn stand(&mut self) {
        self.moving = false;
        self.show([("moving", Value::Null)]);
    }

    /// Reads and checks the file; nothing happens where every text is as it was.
    fn look(&mut self) {
        let checked = Arc::new(Checked::new(&self.settings.file, &Arc::default()));
        let texts: Vec<(PathBuf, String)> = checked
            .sources
            .ids()
            .filter_map(|id| {
                let place = match checked.home(id)? {
                    crate::semantics::Home::Disk(place) => place.clone(),
                    crate::semantics::Home::Standard(_) => return None,
                };
                Some((place, checked.text(id).to_owned()))
            })
            .collect();
        let unread = checked.unread.as_ref().filter(|_| checked.diagnostics.is_empty());
        self.watch(&checked, &texts);
        if texts == self.texts && unread.is_none() {
            return;
        }
        self.texts = texts;
        if let Some(why) = unread {
            self.texts.clear();
            return self.refuse(None, &messages::sentence(&unreadable(&self.settings.file, why)));
        }
        let name = self.settings.layout.as_deref();
        if checked.diagnostics.iter().any(Diagnostic::is_error) {
            return self.refuse(Some(&checked), &messages::all(&checked.sources, &checked.diagnostics));
        }
        let layout = match chosen(&checked, name) {
            Ok(layout) => layout,
            Err(why) => return self.refuse(Some(&checked), &messages::sentence(&why)),
        };
        let key = model::print(&layout);
        let known = Arc::new(Known::new(checked.clone(), layout));
        self.set_known(Some(known.clone()));
        let warnings = messages::all(&checked.sources, &checked.diagnostics);
        self.show([("errors", json!(warnings)), listing::part(&checked), self.status("solving …", true, false)]);
        let is_new = self.solved.as_ref().is_none_or(|(solved, _)| *solved != key);
        if is_new && let Some(picture) = solving::quick(&known.layout, self.settings.threads) {
            // Until it is on the grid.
            let subject = Subject { near: true, ..self.subject(&known, &picture) };
            if let Ok((sheet, plan)) = plan::part(&subject) {
                self.sheet = Some(sheet);
                self.moving = false;
                self.show([("plan", plan), ("moving", Value::Null)]);
            }
        }
        self.pending = Some(Job { known, key });
    }

    fn set_known(&self, known: Option<Arc<Known>>) {
        *self.session.known.lock().unwrap_or_else(PoisonError::into_inner) = known;
    }

    fn watch(&self, checked: &Checked, texts: &[(PathBuf, String)]) {
        let mut all: Vec<(PathBuf, Option<String>)> =
            texts.iter().map(|(p, text)| (p.clone(), Some(text.clone()))).collect();
        let main = root::given(&self.settings.file).unwrap_or_else(|_| self.settings.file.clone());
        if !texts.iter().any(|(place, _)| *place == main) {
            all.push((main, None));
        }
        let incomplete = checked.diagnostics.iter().any(|d| matches!(d.code, Code::E0202 | Code::E0203));
        *self.session.watched.lock().unwrap_or_else(PoisonError::into_inner) = Watched { texts: all, incomplete };
    }

    /// Says why there is nothing new to draw; the last drawing stays.
    fn refuse(&mut self, text: Option<&Checked>, why: &str) {
        self.set_known(None);
        self.pending = None;
        self.moving = false;
        let words = if self.solved.is_some() { "the drawing is of the text before" } else { "nothing to draw yet" };
        let errors = [("errors", json!(why)), ("moving", Value::Null), self.status(words, false, true)];
        self.show(errors.into_iter().chain(text.map(listing::part)));
    }

    fn subject<'a>(&'a self, known: &'a Known, compiled: &'a Compiled) -> Subject<'a> {
        let (sheet, forces) = (self.sheet.as_ref(), self.settings.forces.as_deref());
        Subject { known, compiled, sheet, forces, near: false, before: None }
    }

    /// Shows a picture that will not stay.
    fn picture(&mut self, known: &Known, compiled: &Compiled, mut more: Value) {
        let Ok(picture) = plan::lines(known, compiled, self.sheet.as_ref()) else { return };
        if let (Some(own), Some(picture)) = (more.as_object_mut(), picture.as_object()) {
            own.extend(picture.iter().map(|(name, value)| (name.clone(), value.clone())));
        }
        self.moving = true;
        self.show([("moving", more)]);
    }

    /// Solves what a movement makes of the text.
    fn follow(&mut self, vertex: usize, to: Point, text: &str) {
        let Some(known) = self.session.known().filter(|known| known.id == text) else { return };
        let Some(Some(at)) = known.coordinates.get(vertex) else { return };
        let from = known.layout.vertices[vertex].point;
        let moved = edit::moved(known.text(), at, from, to);
        let Ok(place) = root::given(&self.settings.file) else { return };
        let overlay: Overlay = [(place.clone(), moved)].into();
        let checked = Arc::new(Checked::new(&place, &Arc::new(overlay)));
        let wanted = json!({ "vertex": vertex, "x": to.x, "y": to.y });
        let problem = checked.diagnostics.iter().find(|d| d.is_error()).cloned();
        let layout = chosen(&checked, self.settings.layout.as_deref()).ok().filter(|_| problem.is_none());
        let Some(layout) = layout else {
            let words = problem.map_or_else(|| "there is no such layout".to_owned(), |d| d.message);
            self.moving = true;
            return self.show([("moving", json!({ "moved": wanted, "problem": words }))]);
        };
        let moved = Known::new(checked, layout);
        if let Some(compiled) = solving::quick(&moved.layout, self.settings.threads) {
            self.picture(&moved, &compiled, json!({ "moved": wanted }));
        }
    }

    /// Solves a layout on the grid, unless something newer comes.
    fn solve(&mut self, job: Job) {
        let known = &job.known;
        let before = self.solved.take_if(|(key, compiled)| *key == job.key && !compiled.failed());
        let (result, said) = match before {
            // Comments and spacing changed, not the layout: spans are new, stages are not.
            Some((_, compiled)) if compiled.layout.route.is_none() && known.layout.route.is_none() => {
                solving::again(&known.layout, compiled.stages)
            }
            _ => {
                let (limit, threads) = (self.settings.limit, self.settings.threads);
                match solving::whole(&known.layout, threads, limit, self.session.ended) {
                    Some(done) => done,
                    None => return self.pending = Some(job),
                }
            }
        };
        let checked = &known.checked;
        let all: Vec<Diagnostic> = checked.diagnostics.iter().cloned().chain(said).collect();
        let errors = json!(messages::all(&checked.sources, &all));
        let compiled = match result {
            Ok(compiled) => compiled,
            Err(_) => {
                let status = self.status("this layout cannot be built", false, true);
                self.moving = false;
                return self.show([("errors", errors), ("moving", Value::Null), status]);
            }
        };
        self.moving = false;
        let before = self.solved.as_ref().map(|(_, compiled)| compiled);
        match plan::part(&Subject { before, ..self.subject(known, &compiled) }) {
            Ok((sheet, plan)) => {
                self.sheet = Some(sheet);
                let (facts, status) = (
                    json!(facts::html(known, &compiled, self.settings.forces.as_deref())),
                    self.status(compiled.state(), false, false),
                );
                self.show([("errors", errors), ("plan", plan), ("facts", facts), ("moving", Value::Null), status]);
            }
            Err(why) => {
                let status = self.status(&format!("this cannot be drawn: {why}"), false, true);
                self.show([("errors", errors), ("moving", Value::Null), status]);
            }
        }
        self.solved = Some((job.key, compiled));
    }
}

fn unreadable(file: &Path, why: &LoadError) -> String {
    let why = match why {
        LoadError::Unreadable(why) => why.clone(),
        LoadError::OutsideRoot(root) => format!("it lies outside the project's root, {root}"),
        LoadError::TooLarge(bytes) => format!("it is too large, {bytes} bytes"),
        LoadError::NotUtf8 { .. } => "it is no text".to_owned(),
    };
    format!("{} cannot be read: {why}", shown(file))
}
