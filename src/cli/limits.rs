//! Limits that a user sets for a whole run: threads, and time.

use crate::solve::Stop;
use std::num::NonZeroUsize;
use std::sync::{OnceLock, PoisonError, RwLock};
use std::time::Duration;

static THREADS: OnceLock<NonZeroUsize> = OnceLock::new();
static STOP: RwLock<Stop> = RwLock::new(Stop::NEVER);

/// Threads at most.
const MOST: usize = 1024;

/// Takes what `--threads` says.
pub fn set_threads(threads: Option<NonZeroUsize>) {
    if let Some(threads) = threads {
        let _ = THREADS.set(threads);
    }
}

/// Threads to use: those of `--threads`, else as many as there are cores. No result depends on it.
pub fn threads() -> usize {
    let cores = || std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    THREADS.get().map_or_else(cores, |threads| threads.get())
}

/// Takes what `--time-limit` says; the time runs from here on.
pub fn set_time(limit: Option<Duration>) {
    if let Some(limit) = limit {
        *STOP.write().unwrap_or_else(PoisonError::into_inner) = Stop::after(limit);
    }
}

/// When to stop.
pub fn stop() -> Stop {
    *STOP.read().unwrap_or_else(PoisonError::into_inner)
}

/// Words of `--threads`: `4`.
pub fn count(text: &str) -> Result<NonZeroUsize, String> {
    let count = text.parse().ok().filter(|n: &NonZeroUsize| n.get() <= MOST);
    count.ok_or_else(|| format!("{text} is not a number of threads from 1 to {MOST}"))
}

/// Words of `--time-limit`: `30`, `30s`, `2min`, `1.5 h`.
pub fn time(text: &str) -> Result<Duration, String> {
    const UNITS: [(&str, f64); 6] = [("min", 60.0), ("ms", 1e-3), ("s", 1.0), ("m", 60.0), ("h", 3600.0), ("", 1.0)];
    let unit = UNITS.into_iter().find_map(|(unit, scale)| Some((text.trim().strip_suffix(unit)?, scale)));
    let seconds = unit.and_then(|(digits, scale)| Some(digits.trim().parse::<f64>().ok()? * scale));
    seconds
        .filter(|seconds| *seconds >= 0.0)
        .and_then(|seconds| Duration::try_from_secs_f64(seconds).ok())
        .ok_or_else(|| format!("{text} is not a time such as 30, 30s or 2min"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_units_or_are_seconds() {
        for (text, seconds) in
            [("30", 30.0), ("30s", 30.0), ("2min", 120.0), ("1.5 h", 5400.0), ("250ms", 0.25), ("0", 0.0)]
        {
            assert_eq!(time(text).map(|t| t.as_secs_f64()), Ok(seconds), "{text}");
        }
        for text in ["", "s", "-1", "nan", "1e400", "2 days", "soon"] {
            assert!(time(text).is_err_and(|why| why.contains("30s")), "{text}");
        }
    }

    #[test]
    fn threads_are_one_or_more() {
        assert_eq!(count("3").map(NonZeroUsize::get), Ok(3));
        for text in ["0", "-1", "1025", "two"] {
            assert!(count(text).is_err(), "{text}");
        }
    }
}
