//! What a verb tells while it works: a line that moves on a terminal, else a line a minute, so that the log of a long
//! run shows that it goes on.

use super::{MessageFormat, report};
use crate::base::number::{duration, fixed};
use crate::solve::Progress;
use crate::source::one_line;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Between two lines where there is no terminal.
const EVERY: Duration = Duration::from_secs(60);

/// The line of one piece of work. Any thread may tell.
pub struct Line {
    /// On a terminal.
    bar: Option<ProgressBar>,
    /// Elsewhere; none where nothing but messages for machines may be written.
    log: Option<Mutex<Log>>,
    /// Steps in all, where they are known.
    whole: Option<u64>,
}

/// What was told last where there is no terminal.
struct Log {
    begin: Instant,
    last: Instant,
    done: u64,
    /// Of them, those that were done before.
    known: u64,
}

impl Line {
    /// A line of work whose steps are known, and what they are called: `fits`.
    pub fn steps(whole: u64, name: &str) -> Self {
        let template = format!("{{spinner}} [{{bar:24}}] {{pos}} of {{len}} {name}, {{msg}}, {{eta}} left");
        Line::new(&template, Some(whole), MessageFormat::Text)
    }

    /// The same, of which so many were done before.
    pub fn resumed(whole: u64, done: u64, name: &str) -> Self {
        let line = Line::steps(whole, name);
        if let Some(bar) = &line.bar {
            bar.set_position(done);
            bar.reset_eta();
        }
        if let Some(log) = &line.log {
            let mut log = log.lock().unwrap_or_else(PoisonError::into_inner);
            (log.done, log.known) = (done, done);
        }
        line
    }

    /// A line of work that is done in shares, without a count of steps.
    pub fn shares() -> Self {
        Line::new("{spinner} [{bar:24}] {msg}, {eta} left", Some(WHOLE), MessageFormat::Text)
    }

    /// A line of work of which nobody knows how long it takes.
    pub fn open(format: MessageFormat) -> Self {
        Line::new("{spinner} {msg}, {elapsed}", None, format)
    }

    fn new(template: &str, whole: Option<u64>, format: MessageFormat) -> Self {
        if !std::io::stderr().is_terminal() {
            let now = Instant::now();
            let log =
                (format == MessageFormat::Text).then(|| Mutex::new(Log { begin: now, last: now, done: 0, known: 0 }));
            return Line { bar: None, log, whole };
        }
        let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
        let bar = whole.map_or_else(ProgressBar::new_spinner, ProgressBar::new);
        let bar = bar.with_style(style.progress_chars("=> "));
        bar.enable_steady_tick(Duration::from_millis(200));
        Line { bar: Some(bar), log: None, whole }
    }

    /// Shows what is done now; `message` is only made where it is shown.
    pub fn say(&self, message: impl Fn() -> String) {
        self.show(None, message);
    }

    /// One step more is done.
    pub fn step(&self, message: impl Fn() -> String) {
        if let Some(bar) = &self.bar {
            bar.inc(1);
        }
        let done = self.log.as_ref().map(|log| {
            let mut log = log.lock().unwrap_or_else(PoisonError::into_inner);
            log.done += 1;
            log.done
        });
        self.show(done, message);
    }

    /// So many steps are done.
    pub fn at(&self, done: u64, message: impl Fn() -> String) {
        self.show(Some(done), message);
    }

    /// This share of the whole is done, from 0 to 1.
    pub fn share(&self, done: f64, message: impl Fn() -> String) {
        self.show(Some((done * WHOLE as f64) as u64), message);
    }

    fn show(&self, done: Option<u64>, message: impl Fn() -> String) {
        if let Some(bar) = &self.bar {
            if bar.is_finished() {
                bar.reset();
            }
            if let Some(done) = done {
                bar.set_position(done);
            }
            bar.set_message(one_line(&message()).into_owned());
        }
        let Some(log) = &self.log else { return };
        let mut log = log.lock().unwrap_or_else(PoisonError::into_inner);
        log.done = done.unwrap_or(log.done);
        let now = Instant::now();
        if now.duration_since(log.last) >= EVERY {
            log.last = now;
            let worked = now.duration_since(log.begin).as_secs_f64();
            report::note(&format!("{}{}", one_line(&message()), so_far(worked, (log.known, log.done), self.whole)));
        }
    }

    /// Does what writes beside the line, such as a warning.
    pub fn beside(&self, write: impl FnOnce()) {
        match &self.bar {
            Some(bar) => bar.suspend(write),
            None => write(),
        }
    }

    /// Whether somebody looks at a moving line.
    pub fn moves(&self) -> bool {
        self.bar.is_some()
    }

    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// Steps of a line of shares.
const WHOLE: u64 = 1000;

/// The time so far, and how much is left if steps go on as they did since those that were known.
fn so_far(worked: f64, (known, done): (u64, u64), whole: Option<u64>) -> String {
    let after = format!(", after {}", duration(worked));
    match whole {
        Some(whole) if done > known && done < whole => {
            let left = worked / (done - known) as f64 * (whole - done) as f64;
            let share = 100.0 * done as f64 / whole as f64;
            format!(", {} % done{after}, about {} left", fixed(share, 0), duration(left))
        }
        _ => after,
    }
}

/// The line of a solve.
pub struct Solving(Line);

impl Solving {
    pub fn new(format: MessageFormat) -> Self {
        Solving(Line::open(format))
    }

    pub fn show(&self, progress: Progress) {
        self.0.say(|| words(progress));
    }

    pub fn finish(&self) {
        self.0.finish();
    }
}

/// What a solve is at.
pub fn words(progress: Progress) -> String {
    match progress {
        Progress::Iteration { stage, iteration, length, max_violation } => {
            let stage =
                stage.strip_prefix("stage").map_or_else(|| stage.to_owned(), |number| format!("stage {number}"));
            format!("{stage}, iteration {iteration}, {length:.3} m, violation {max_violation:.1e}")
        }
        Progress::Node { nodes, most, gap: None, .. } => format!("stage 3, node {nodes} of {most}"),
        Progress::Node { nodes, most, gap: Some(gap), unit } => {
            let than = if unit == "m" { "shorter" } else { "cheaper" };
            format!("stage 3, node {nodes} of {most}, no layout more than {gap:.3} {unit} {than}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_log_says_how_far_it_is() {
        assert_eq!(so_far(60.0, (0, 0), Some(12)), ", after 60 s");
        assert_eq!(so_far(120.0, (0, 3), Some(12)), ", 25 % done, after 2 min, about 6 min left");
        assert_eq!(so_far(120.0, (0, 12), Some(12)), ", after 2 min");
        // What was done before took no time of this run.
        assert_eq!(so_far(120.0, (6, 9), Some(12)), ", 75 % done, after 2 min, about 2 min left");
        assert_eq!(so_far(240.0, (0, 7), None), ", after 4 min");
    }

    #[test]
    fn a_search_says_what_is_left_open() {
        let node = |gap, unit| words(Progress::Node { nodes: 7, most: 6000, gap, unit });
        assert_eq!(node(None, "m"), "stage 3, node 7 of 6000");
        assert_eq!(node(Some(0.25), "m"), "stage 3, node 7 of 6000, no layout more than 0.250 m shorter");
        assert_eq!(node(Some(12.0), "EUR"), "stage 3, node 7 of 6000, no layout more than 12.000 EUR cheaper");
        let polygon = Progress::Iteration { stage: "polygon", iteration: 2, length: 40.0, max_violation: 0.0 };
        assert_eq!(words(polygon), "polygon, iteration 2, 40.000 m, violation 0.0e0");
    }
}
