//! A bar with the time left, and Ctrl-C as a request to stop and keep what there is.

use crate::dynamics::Progress;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Watches a simulation.
pub struct Watch {
    bar: Option<ProgressBar>,
    stopped: Arc<AtomicBool>,
}

/// Steps of the bar.
const WHOLE: u64 = 1000;

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
        let bar = std::io::stderr().is_terminal().then(|| {
            ProgressBar::new(WHOLE).with_style(
                ProgressStyle::with_template("{spinner} [{bar:24}] {msg}, {eta} left")
                    .unwrap_or_else(|_| ProgressStyle::default_bar())
                    .progress_chars("=> "),
            )
        });
        Watch { bar, stopped }
    }

    /// Shows how far it is; whether to go on.
    pub fn show(&self, progress: Progress) -> bool {
        if let Some(bar) = &self.bar {
            bar.set_position((progress.done * WHOLE as f64) as u64);
            let doing = if progress.laps > 0.0 { "recording" } else { "settling" };
            bar.set_message(format!("{doing}, {:.1} s, lap {:.2}", progress.time, progress.laps));
        }
        !self.stopped.load(Ordering::Relaxed)
    }

    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
