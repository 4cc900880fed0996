//! The share of a simulation and the time left, and Ctrl-C as a request to stop and keep what there is.

use crate::cli::progress::Line;
use crate::dynamics::Progress;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Watches a simulation.
pub struct Watch {
    line: Line,
    stopped: Arc<AtomicBool>,
}

impl Watch {
    pub fn new() -> Self {
        let stopped = Arc::new(AtomicBool::new(false));
        let flag = stopped.clone();
        // Where no handler can be set, Ctrl-C ends the program as it always did. A second one does, too.
        let _ = ctrlc::set_handler(move || {
            if flag.swap(true, Ordering::Relaxed) {
                std::process::exit(130);
            }
        });
        Watch { line: Line::shares(), stopped }
    }

    /// Shows how far it is; whether to go on.
    pub fn show(&self, progress: Progress) -> bool {
        self.line.share(progress.done, || {
            let doing = if progress.laps > 0.0 { "recording" } else { "settling" };
            format!("{doing}, {:.1} s, lap {:.2}", progress.time, progress.laps)
        });
        !self.stopped.load(Ordering::Relaxed)
    }

    pub fn finish(&self) {
        self.line.finish();
    }
}
