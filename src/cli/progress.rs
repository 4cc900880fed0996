//! What a verb tells while it works: a line that moves on a terminal, else a line a minute, so that the log of a long
//! run shows that it goes on.

use super::{MessageFormat, report};
use crate::base::number::{duration, fixed};
use crate::solve::Progress;
use crate::source::one_line;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Between two lines where there is no terminal.
const EVERY: Duration = Duration::from_secs(60);

/// The line of one piece of work. Any thread may tell.
pub struct Line {
    shared: Arc<Shared>,
    /// Shows what was told last with the time that is left, though nothing is told for long.
    clock: Option<JoinHandle<()>>,
}

/// What the line and its clock have in common.
struct Shared {
    /// On a terminal.
    bar: Option<ProgressBar>,
    /// Whether lines are written where there is no terminal: not beside messages for machines.
    logs: bool,
    kind: Kind,
    state: Mutex<State>,
    finished: Condvar,
}

/// What is known of the whole.
#[derive(Clone, Copy)]
enum Kind {
    /// So many steps, and what they are called: `fits`.
    Steps(u64, &'static str),
    /// A whole that is done in shares.
    Shares,
    /// Nobody knows how long it takes.
    Open,
}

/// What was told last.
struct State {
    begin: Instant,
    done: f64,
    /// Of them, those that were done before.
    known: f64,
    message: String,
    /// Whether the line was taken away; what is told afterwards shows it again.
    hidden: bool,
    /// Whether the line has come to its end.
    over: bool,
    /// Share of the steps under way that is done, as far as that can be known.
    under_way: Box<dyn Fn() -> f64 + Send>,
}

impl Line {
    /// A line of work whose steps are known, and what they are called: `fits`.
    pub fn steps(whole: u64, name: &'static str) -> Self {
        Line::new(Kind::Steps(whole, name), MessageFormat::Text)
    }

    /// The same, of which so many were done before.
    pub fn resumed(whole: u64, done: u64, name: &'static str) -> Self {
        let line = Line::steps(whole, name);
        let mut state = line.shared.state();
        (state.done, state.known) = (done as f64, done as f64);
        drop(state);
        line.shared.show();
        line
    }

    /// The same; `under_way` says how many steps' worth is done of those that were begun.
    pub fn watched(whole: u64, name: &'static str, under_way: impl Fn() -> f64 + Send + 'static) -> Self {
        let line = Line::steps(whole, name);
        line.shared.state().under_way = Box::new(under_way);
        line.shared.show();
        line
    }

    /// A line of work that is done in shares, without a count of steps.
    pub fn shares() -> Self {
        Line::new(Kind::Shares, MessageFormat::Text)
    }

    /// A line of work of which nobody knows how long it takes.
    pub fn open(format: MessageFormat) -> Self {
        Line::new(Kind::Open, format)
    }

    fn new(kind: Kind, format: MessageFormat) -> Self {
        let terminal = std::io::stderr().is_terminal();
        let bar = terminal.then(|| {
            let (template, whole) = match kind {
                Kind::Steps(..) | Kind::Shares => ("{spinner} [{bar:24}] {msg}", WHOLE),
                Kind::Open => ("{spinner}{msg}, {elapsed}", 0),
            };
            let style = ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar());
            let bar = if whole > 0 { ProgressBar::new(whole) } else { ProgressBar::new_spinner() };
            let bar = bar.with_style(style.progress_chars("=> "));
            bar.enable_steady_tick(Duration::from_millis(200));
            bar
        });
        let state = State {
            begin: Instant::now(),
            done: 0.0,
            known: 0.0,
            message: String::new(),
            hidden: false,
            over: false,
            under_way: Box::new(|| 0.0),
        };
        let logs = !terminal && format == MessageFormat::Text;
        let shared = Arc::new(Shared { bar, logs, kind, state: Mutex::new(state), finished: Condvar::new() });
        let clock = (terminal || logs).then(|| {
            let shared = shared.clone();
            std::thread::spawn(move || shared.tick(if terminal { SECOND } else { EVERY }))
        });
        Line { shared, clock }
    }

    /// Shows what is done now; `message` is only made where it is shown.
    pub fn say(&self, message: impl Fn() -> String) {
        self.show(|done| done, message);
    }

    /// One step more is done.
    pub fn step(&self, message: impl Fn() -> String) {
        self.show(|done| done + 1.0, message);
    }

    /// So many steps are done.
    pub fn at(&self, done: u64, message: impl Fn() -> String) {
        self.show(|_| done as f64, message);
    }

    /// One step more was done before, and takes no time now.
    pub fn known(&self) {
        let mut state = self.shared.state();
        state.done += 1.0;
        state.known += 1.0;
        drop(state);
        self.shared.show();
    }

    /// This share of the whole is done, from 0 to 1.
    pub fn share(&self, done: f64, message: impl Fn() -> String) {
        self.show(|_| done, message);
    }

    fn show(&self, done: impl Fn(f64) -> f64, message: impl Fn() -> String) {
        if self.clock.is_none() {
            return;
        }
        let mut state = self.shared.state();
        state.done = done(state.done);
        state.message = one_line(&message()).into_owned();
        state.hidden = false;
        drop(state);
        self.shared.show();
    }

    /// Does what writes beside the line, such as a warning.
    pub fn beside(&self, write: impl FnOnce()) {
        match &self.shared.bar {
            Some(bar) => bar.suspend(write),
            None => write(),
        }
    }

    /// Whether somebody looks at a moving line.
    pub fn moves(&self) -> bool {
        self.shared.bar.is_some()
    }

    /// Takes the line away.
    pub fn finish(&self) {
        self.shared.state().hidden = true;
        if let Some(bar) = &self.shared.bar {
            bar.finish_and_clear();
        }
    }
}

impl Drop for Line {
    fn drop(&mut self) {
        self.shared.state().over = true;
        self.shared.finished.notify_all();
        if let Some(clock) = self.clock.take() {
            let _ = clock.join();
        }
    }
}

impl Shared {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Shows the line on a terminal.
    fn show(&self) {
        let Some(bar) = &self.bar else { return };
        let state = self.state();
        if state.hidden {
            return;
        }
        if bar.is_finished() {
            bar.reset();
        }
        let (_, left) = self.timing(&state);
        let under_way = (state.under_way)();
        let mut parts = Vec::new();
        match self.kind {
            Kind::Steps(whole, name) => {
                let share = share((state.done, under_way), whole as f64);
                bar.set_position((share * WHOLE as f64) as u64);
                parts.push(format!("{} of {whole} {name}", fixed(state.done, 0)));
                if under_way > 0.0 {
                    parts.push(format!("{} %", fixed(100.0 * share, 0)));
                }
            }
            Kind::Shares => bar.set_position((state.done * WHOLE as f64) as u64),
            Kind::Open => parts.push(String::new()),
        }
        if !state.message.is_empty() {
            parts.push(state.message.clone());
        }
        // The line of open work begins behind its spinner.
        let message = if matches!(self.kind, Kind::Open) { parts.join(" ") } else { parts.join(", ") };
        bar.set_message(format!("{message}{left}").trim_start_matches(", ").to_owned());
    }

    /// Shows the line anew every so often until the line ends.
    fn tick(&self, every: Duration) {
        loop {
            let state = self.state();
            let waited = self.finished.wait_timeout_while(state, every, |state| !state.over);
            let (state, _) = waited.unwrap_or_else(PoisonError::into_inner);
            if state.over {
                return;
            }
            if self.logs && !state.hidden {
                let (so_far, left) = self.timing(&state);
                let message = if state.message.is_empty() { "working" } else { &state.message };
                report::note(&format!("{message}{so_far}{left}"));
            }
            drop(state);
            self.show();
        }
    }

    /// The time so far with what is done, and about how much is left.
    fn timing(&self, state: &State) -> (String, String) {
        let whole = match self.kind {
            Kind::Steps(whole, name) => Some((whole as f64, name)),
            Kind::Shares => Some((1.0, "")),
            Kind::Open => None,
        };
        timing(state.begin.elapsed().as_secs_f64(), (state.known, state.done, (state.under_way)()), whole)
    }
}

/// Between two looks on a terminal.
const SECOND: Duration = Duration::from_secs(1);

/// Parts of a bar.
const WHOLE: u64 = 1000;

/// Which share of steps is done, with those under way.
fn share((done, under_way): (f64, f64), whole: f64) -> f64 {
    if whole > 0.0 { ((done + under_way) / whole).clamp(0.0, 1.0) } else { 1.0 }
}

/// The time so far and how much is done, and how much is left if work goes on as it did since what was known before.
fn timing(worked: f64, (known, done, under_way): (f64, f64, f64), whole: Option<(f64, &str)>) -> (String, String) {
    let after = format!(", after {}", duration(worked));
    let Some((whole, name)) = whole else { return (after, String::new()) };
    let made = (done + under_way).min(whole) - known;
    let of =
        if name.is_empty() { String::new() } else { format!(", {} of {} {name}", fixed(done, 0), fixed(whole, 0)) };
    if made <= 0.0 || done >= whole {
        return (format!("{of}{after}"), String::new());
    }
    let left = worked / made * (whole - known - made);
    let told = name.is_empty() || under_way > 0.0;
    let percent = 100.0 * share((done, under_way), whole);
    let share = if told { format!(", {} % done", fixed(percent, 0)) } else { String::new() };
    let left = if left < 0.5 { String::new() } else { format!(", about {} left", duration(left)) };
    (format!("{of}{share}{after}"), left)
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
    fn a_line_says_how_far_it_is() {
        let fits = |worked, (known, done, under_way)| {
            let (so_far, left) = timing(worked, (known, done, under_way), Some((12.0, "fits")));
            so_far + &left
        };
        assert_eq!(fits(60.0, (0.0, 0.0, 0.0)), ", 0 of 12 fits, after 60 s");
        // Of the first two fits, a quarter each.
        assert_eq!(fits(60.0, (0.0, 0.0, 0.5)), ", 0 of 12 fits, 4 % done, after 60 s, about 23 min left");
        assert_eq!(fits(120.0, (0.0, 3.0, 0.0)), ", 3 of 12 fits, after 2 min, about 6 min left");
        assert_eq!(fits(120.0, (0.0, 12.0, 0.0)), ", 12 of 12 fits, after 2 min");
        // What was done before took no time of this run.
        assert_eq!(fits(120.0, (6.0, 9.0, 0.0)), ", 9 of 12 fits, after 2 min, about 2 min left");
        let share = timing(120.0, (0.0, 0.25, 0.0), Some((1.0, "")));
        assert_eq!(share.0 + &share.1, ", 25 % done, after 2 min, about 6 min left");
        assert_eq!(timing(240.0, (0.0, 7.0, 0.0), None).0, ", after 4 min");
    }

    #[test]
    fn what_was_done_before_is_no_work_of_this_run() {
        let line = Line::steps(60, "cases");
        line.known();
        line.at(1, || "case-002".to_owned());
        let state = line.shared.state();
        assert_eq!((state.done, state.known, state.message.as_str()), (1.0, 1.0, "case-002"));
    }

    #[test]
    fn a_line_ends_while_its_clock_waits() {
        let begin = Instant::now();
        let line = Line::steps(3, "fits");
        line.step(|| "run-01".to_owned());
        drop(line);
        assert!(begin.elapsed() < EVERY / 2, "the clock was waited for");
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
