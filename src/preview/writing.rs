//! What pages may change on the disk: the coordinates of a vertex, and that back again. The file is written whole or
//! not at all, and only if it is still what the page was dragging on.

use super::edit;
use super::session::{Ask, Session};
use crate::geometry::Point;
use crate::source::{SIZE_LIMIT, disk, root};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Changes that can be taken back.
const MOST: usize = 100;

/// Changes of the file, the last one last.
#[derive(Debug, Default)]
pub struct History(Mutex<Changes>);

#[derive(Debug, Default)]
struct Changes {
    done: Vec<Change>,
    undone: Vec<Change>,
}

/// The texts before and after a change.
#[derive(Clone, Debug)]
struct Change {
    before: String,
    after: String,
}

const CHANGED: &str = "the file was changed meanwhile, so nothing was written";

impl History {
    /// One change at a time.
    fn lock(&self) -> MutexGuard<'_, Changes> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// How many changes can be taken back, and done again.
    pub fn sizes(&self) -> (usize, usize) {
        let changes = self.lock();
        (changes.done.len(), changes.undone.len())
    }

    /// Puts a vertex of the text with an id to a place (m) in the file.
    ///
    /// # Errors
    ///
    /// Why nothing was written, in a sentence.
    pub fn put(&self, session: &Session, vertex: usize, to: Point, text: &str) -> Result<(), String> {
        let mut changes = self.lock();
        let known = session.known().filter(|known| known.id == text).ok_or(CHANGED)?;
        let at = known.coordinates.get(vertex).ok_or("there is no such vertex")?;
        let at = at.as_ref().ok_or("the vertex stands in another file, so nothing was written")?;
        let before = known.text();
        let after = edit::moved(before, at, known.layout.vertices[vertex].point, to);
        if before == after {
            session.ask(Ask::Still);
            return Ok(());
        }
        write(session, before, &after)?;
        changes.undone.clear();
        changes.done.push(Change { before: before.to_owned(), after });
        if changes.done.len() > MOST {
            changes.done.remove(0);
        }
        session.ask(Ask::Look);
        Ok(())
    }

    /// Takes the last change back.
    ///
    /// # Errors
    ///
    /// As [`History::put`].
    pub fn undo(&self, session: &Session) -> Result<(), String> {
        let mut changes = self.lock();
        let change = changes.done.last().cloned().ok_or("there is nothing to undo")?;
        write(session, &change.after, &change.before)?;
        changes.done.pop();
        changes.undone.push(change);
        session.ask(Ask::Look);
        Ok(())
    }

    /// Does what was taken back.
    ///
    /// # Errors
    ///
    /// As [`History::put`].
    pub fn redo(&self, session: &Session) -> Result<(), String> {
        let mut changes = self.lock();
        let change = changes.undone.last().cloned().ok_or("there is nothing to redo")?;
        write(session, &change.before, &change.after)?;
        changes.undone.pop();
        changes.done.push(change);
        session.ask(Ask::Look);
        Ok(())
    }
}

/// Replaces the file's text, if it is this one.
fn write(session: &Session, before: &str, after: &str) -> Result<(), String> {
    let now = root::read_given(&session.file, SIZE_LIMIT).map_err(|why| format!("the file cannot be read: {why}"))?;
    if now != before.as_bytes() {
        return Err(CHANGED.to_owned());
    }
    disk::rewrite(&session.file, after).map_err(|why| format!("the file cannot be written: {why}"))
}
