//! What the pages show: named parts, each with the version in which it last changed. A page asks for what is newer than
//! what it has and waits until there is something.

use serde_json::{Map, Value, json};
use std::collections::BTreeMap;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// The parts, and who waits for them.
#[derive(Debug, Default)]
pub struct Board {
    inner: Mutex<Inner>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct Inner {
    version: u64,
    parts: BTreeMap<&'static str, (u64, Value)>,
    closed: bool,
}

impl Board {
    fn lock(&self) -> MutexGuard<'_, Inner> {
        // Parts are replaced whole: a panic elsewhere leaves none in halves.
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Shows parts; those that are as before do not count as changed.
    pub fn show(&self, parts: impl IntoIterator<Item = (&'static str, Value)>) {
        let mut inner = self.lock();
        let next = inner.version + 1;
        for (name, value) in parts {
            if inner.parts.get(name).is_none_or(|(_, before)| *before != value) {
                inner.parts.insert(name, (next, value));
                inner.version = next;
            }
        }
        drop(inner);
        self.changed.notify_all();
    }

    /// What changed after a version, as soon as there is anything, or after some time without: `{"version", "parts"}`.
    pub fn after(&self, version: u64, wait: Duration) -> Value {
        let until = Instant::now() + wait;
        let mut inner = self.lock();
        while inner.version <= version && !inner.closed {
            let left = until.saturating_duration_since(Instant::now());
            if left.is_zero() {
                break;
            }
            (inner, _) = self.changed.wait_timeout(inner, left).unwrap_or_else(PoisonError::into_inner);
        }
        let newer = inner.parts.iter().filter(|(_, (own, _))| *own > version);
        let parts: Map<String, Value> = newer.map(|(name, (_, value))| ((*name).to_owned(), value.clone())).collect();
        json!({ "version": inner.version, "parts": parts, "closed": inner.closed })
    }

    /// Lets go everybody who waits: the server ends.
    pub fn close(&self) {
        self.lock().closed = true;
        self.changed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOW: Duration = Duration::ZERO;

    #[test]
    fn pages_get_what_is_newer_than_what_they_have() {
        let board = Board::default();
        board.show([("a", json!(1)), ("b", json!(2))]);
        assert_eq!(board.after(0, NOW), json!({ "version": 1, "parts": { "a": 1, "b": 2 }, "closed": false }));
        board.show([("a", json!(1)), ("b", json!(3))]);
        assert_eq!(board.after(1, NOW), json!({ "version": 2, "parts": { "b": 3 }, "closed": false }));
        board.show([("b", json!(3))]);
        assert_eq!(board.after(2, NOW), json!({ "version": 2, "parts": {}, "closed": false }));
        // A page that comes back has everything as it is now.
        assert_eq!(board.after(0, NOW)["parts"], json!({ "a": 1, "b": 3 }));
    }

    #[test]
    fn who_waits_is_told() {
        let board = Board::default();
        let wait = |after: u64| board.after(after, Duration::from_secs(60));
        std::thread::scope(|scope| {
            let waiting = [(); 3].map(|()| scope.spawn(|| wait(0)));
            board.show([("a", json!("news"))]);
            for page in waiting {
                assert_eq!(page.join().unwrap()["parts"], json!({ "a": "news" }));
            }
            let last = scope.spawn(|| wait(1));
            board.close();
            assert_eq!(last.join().unwrap()["closed"], json!(true));
        });
    }
}
