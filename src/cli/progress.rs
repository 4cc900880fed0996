//! A line that moves while a layout is optimised; silent when standard error is not a terminal.

use crate::solve::Progress;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::time::Duration;

/// Shows stage, iteration, length and violation.
pub struct ProgressLine(Option<ProgressBar>);

impl ProgressLine {
    pub fn new() -> Self {
        if !std::io::stderr().is_terminal() {
            return ProgressLine(None);
        }
        let bar = ProgressBar::new(3).with_style(
            ProgressStyle::with_template("{spinner} [{bar:12}] {msg}")
                .unwrap_or_else(|_| ProgressStyle::default_bar())
                .progress_chars("=> "),
        );
        bar.enable_steady_tick(Duration::from_millis(100));
        ProgressLine(Some(bar))
    }

    pub fn show(&self, progress: Progress) {
        let Some(bar) = &self.0 else { return };
        let stage = progress.stage.trim_start_matches("stage");
        bar.set_position(stage.parse::<u64>().unwrap_or(1).saturating_sub(1));
        bar.set_message(format!(
            "stage {stage}, iteration {}, {:.3} m, violation {:.1e}",
            progress.iteration, progress.length, progress.max_violation
        ));
    }

    pub fn finish(&self) {
        if let Some(bar) = &self.0 {
            bar.finish_and_clear();
        }
    }
}
