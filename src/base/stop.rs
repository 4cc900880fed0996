//! A limit of time. Iterations and nodes limit a search in the first place, so that the same input gives the same
//! result; a limit of time ends it early where a user asks for that, and what was ended so says it.

use serde::Serialize;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// What ended a search before it was done.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Cut {
    /// The limit of time.
    Time,
}

/// When to stop, asked at the beginning of iterations and nodes. Copies share whether something was ended.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stop(Option<Limit>);

#[derive(Clone, Copy, Debug)]
struct Limit {
    at: Instant,
    cut: &'static AtomicBool,
    /// Somebody else may end it earlier.
    ended: Option<&'static AtomicBool>,
}

/// A time that no work takes: a hundred years.
const LONG: Duration = Duration::from_secs(3_155_760_000);

/// Copies of one limit are equal.
impl PartialEq for Limit {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self.cut, other.cut)
    }
}

impl Stop {
    /// Never.
    pub const NEVER: Stop = Stop(None);

    /// So long from now on. A few bytes stay in use until the program ends, so that every copy may look at them.
    pub fn after(limit: Duration) -> Stop {
        let at = Instant::now().checked_add(limit);
        Stop(at.map(|at| Limit { at, cut: Box::leak(Box::new(AtomicBool::new(false))), ended: None }))
    }

    /// As soon as `ended` is set.
    pub fn when(ended: &'static AtomicBool) -> Stop {
        Stop::after_or(LONG, ended)
    }

    /// So long from now on, or as soon as `ended` is set.
    pub fn after_or(limit: Duration, ended: &'static AtomicBool) -> Stop {
        let Stop(limit) = Stop::after(limit);
        Stop(limit.map(|limit| Limit { ended: Some(ended), ..limit }))
    }

    /// Whether the time is over. Who is told so ends its work early: that is remembered.
    pub fn now(&self) -> bool {
        let ended = |limit: &Limit| limit.ended.is_some_and(|ended| ended.load(Ordering::Relaxed));
        let Some(limit) = self.0.filter(|limit| Instant::now() >= limit.at || ended(limit)) else { return false };
        limit.cut.store(true, Ordering::Relaxed);
        true
    }

    /// What ended work early, if anything did.
    pub fn cut(&self) -> Option<Cut> {
        self.0.filter(|limit| limit.cut.load(Ordering::Relaxed)).map(|_| Cut::Time)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_work_that_was_ended_is_cut() {
        let (never, long, over) =
            (Stop::NEVER, Stop::after(Duration::from_secs(1_000_000)), Stop::after(Duration::ZERO));
        assert_eq!((never.now(), long.now(), over.cut()), (false, false, None));
        assert!(over.now());
        assert_eq!((never.cut(), long.cut(), over.cut()), (None, None, Some(Cut::Time)));
        static ENDED: AtomicBool = AtomicBool::new(false);
        let either = Stop::after_or(Duration::from_secs(1_000_000), &ENDED);
        assert!(!either.now());
        ENDED.store(true, Ordering::Relaxed);
        assert!(either.now());
        static SET: AtomicBool = AtomicBool::new(false);
        let (when, copy) = (Stop::when(&SET), Stop::when(&SET));
        assert!(!when.now() && when != copy);
        let same = when;
        assert_eq!(same, when);
        SET.store(true, Ordering::Relaxed);
        assert!(when.now() && copy.now());
        // Too long to be reckoned is no limit.
        assert!(!Stop::after(Duration::MAX).now());
    }
}
