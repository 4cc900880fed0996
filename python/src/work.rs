//! Work on a thread of its own, while the thread that called waits without Python's lock, looks for Ctrl-C, and tells how
//! far the work is.

use super::raise::broken;
use pyo3::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::Duration;

/// Between two looks for Ctrl-C.
const LOOK: Duration = Duration::from_millis(50);
/// Work that is stopped is waited for so long. What does not look at its flag by then ends on its own later.
const PATIENCE: Duration = Duration::from_millis(800);
/// Solving and reading go deeper than threads have room for by default.
const STACK: usize = 64 << 20;

/// How far work is: shared by the thread that works and the one that tells.
#[derive(Clone, Default)]
pub struct Board(Arc<Mutex<Option<Told>>>);

/// What is told.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Told {
    pub done: f64,
    /// `None` where it is not known how much there is to do.
    pub total: Option<f64>,
    pub words: String,
}

impl Board {
    pub fn tell(&self, done: f64, total: Option<f64>, words: String) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(Told { done, total, words });
    }

    /// What is new since the last look.
    fn look(&self) -> Option<Told> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

/// A flag that stops work. Its byte stays in use until the program ends, as a thread that is slow to stop may look at it.
pub fn flag() -> &'static AtomicBool {
    Box::leak(Box::new(AtomicBool::new(false)))
}

/// Does work, and tells `progress`, a callable of (done, total, words), how far it is.
///
/// # Errors
///
/// What a handler of signals or `progress` raises: the work is then told to stop by its flag.
pub fn work<T: Send + 'static>(
    py: Python,
    progress: Option<Py<PyAny>>,
    stopped: &'static AtomicBool,
    task: impl FnOnce(&Board) -> T + Send + 'static,
) -> PyResult<T> {
    let (board, (send, receive)) = (Board::default(), channel());
    let own = board.clone();
    let run = move || {
        // Nobody listens any more where the caller went on without it.
        let _ = send.send(catch_unwind(AssertUnwindSafe(|| task(&own))));
    };
    thread::Builder::new().name("lss".into()).stack_size(STACK).spawn(run)?;
    let receive = Mutex::new(receive);
    let wait = |patience: Duration| {
        py.detach(|| receive.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(patience))
    };
    let tell = || -> PyResult<()> {
        py.check_signals()?;
        match (&progress, board.look()) {
            (Some(progress), Some(told)) => progress.call1(py, (told.done, told.total, told.words)).map(drop),
            _ => Ok(()),
        }
    };
    loop {
        match wait(LOOK) {
            Ok(Ok(done)) => {
                tell()?;
                return Ok(done);
            }
            Ok(Err(_)) | Err(RecvTimeoutError::Disconnected) => return Err(broken()),
            Err(RecvTimeoutError::Timeout) => {
                if let Err(raised) = tell() {
                    stopped.store(true, Ordering::Relaxed);
                    let _ = wait(PATIENCE);
                    return Err(raised);
                }
            }
        }
    }
}

/// Threads to use: as many as there are cores where none are given.
pub fn threads(asked: Option<usize>) -> usize {
    asked.unwrap_or_else(|| thread::available_parallelism().map_or(1, usize::from)).max(1)
}
