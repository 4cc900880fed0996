//! Solving in the background: after a pause in typing, on a thread of its own. What comes too late is dropped.

use crate::base::number::trimmed;
use crate::compiled::{Compiled, solved};
use crate::diagnostic::Diagnostic;
use crate::model::{self, Layout};
use crate::semantics::Checked;
use crate::solve::{Options, Stop};
use std::collections::{BTreeMap, VecDeque};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

/// A layout to be solved.
struct Job {
    place: PathBuf,
    checked: Arc<Checked>,
    /// Which of the check's layouts.
    index: usize,
    key: String,
    limit: Duration,
}

/// What became of a job.
pub struct Outcome {
    place: PathBuf,
    name: String,
    key: String,
    /// The check whose spans its diagnostics have.
    checked: Arc<Checked>,
    result: Result<Compiled, String>,
    said: Vec<Diagnostic>,
    seconds: f64,
}

/// A solved layout.
#[derive(Debug)]
pub struct Solved {
    pub compiled: Compiled,
    seconds: f64,
}

impl Solved {
    /// `proven, 0.31 s`
    pub fn state(&self) -> String {
        format!("{} ({} s)", self.compiled.state(), trimmed(self.seconds, 2))
    }
}

#[derive(Debug)]
struct Entry {
    key: String,
    /// The last layout that was solved, and what it was solved from.
    solved: Option<(String, Solved)>,
    refused: Option<String>,
    /// With the check that its spans are of.
    said: Option<(Arc<Checked>, Vec<Diagnostic>)>,
}

/// What is known of a layout.
pub enum Known<'a> {
    No,
    Solved(&'a Solved),
    /// Of the text before the last change.
    Stale(&'a Solved),
    Refused(&'a str),
}

/// Solved layouts, and the thread that solves more.
pub struct Solutions {
    entries: BTreeMap<(PathBuf, String), Entry>,
    jobs: Sender<Job>,
    /// Ends the job that is running.
    ended: &'static AtomicBool,
    limit: Duration,
}

impl Solutions {
    /// Starts the thread; `done` is told of each job on that thread. A limit of no time solves nothing.
    pub fn new(limit: Duration, done: impl Fn(Outcome) + Send + 'static) -> Solutions {
        let (jobs, queue) = channel();
        // One for each server, which a process has one of.
        let ended: &'static AtomicBool = Box::leak(Box::new(AtomicBool::new(false)));
        std::thread::spawn(move || work(&queue, ended, done));
        Solutions { entries: BTreeMap::new(), jobs, ended, limit }
    }

    /// Asks for what is not solved yet of a document.
    pub fn ask(&mut self, place: &Path, checked: &Arc<Checked>) {
        let Some(study) = checked.study.as_ref().filter(|study| !study.analysis.has_errors()) else { return };
        if self.limit.is_zero() {
            return;
        }
        for (index, layout) in study.analysis.layouts.iter().enumerate() {
            let key = model::print(layout);
            let entry = self.entries.entry((place.to_owned(), layout.name.clone())).or_insert_with(|| Entry {
                key: String::new(),
                solved: None,
                refused: None,
                said: None,
            });
            // Spans of diagnostics move with every change, the layout does not.
            let moved = entry.said.as_ref().is_some_and(|(of, said)| !said.is_empty() && !Arc::ptr_eq(of, checked));
            if entry.key == key && !moved {
                continue;
            }
            entry.key.clone_from(&key);
            let job = Job { place: place.to_owned(), checked: checked.clone(), index, key, limit: self.limit };
            // The thread lives as long as the queue does.
            let _ = self.jobs.send(job);
            self.ended.store(true, Ordering::Relaxed);
        }
    }

    /// Takes what the thread did. Whether it is of use still.
    pub fn take(&mut self, outcome: Outcome) -> bool {
        let Some(entry) = self.entries.get_mut(&(outcome.place, outcome.name)) else { return false };
        if entry.key != outcome.key {
            return false;
        }
        entry.said = Some((outcome.checked, outcome.said));
        match outcome.result {
            Ok(compiled) => {
                entry.solved = Some((outcome.key, Solved { compiled, seconds: outcome.seconds }));
                entry.refused = None;
            }
            Err(why) => entry.refused = Some(why),
        }
        true
    }

    pub fn forget(&mut self, place: &Path) {
        self.entries.retain(|(own, _), _| own != place);
    }

    /// What is known of a layout of a document.
    pub fn of(&self, place: &Path, layout: &Layout) -> Known<'_> {
        let Some(entry) = self.entries.get(&(place.to_owned(), layout.name.clone())) else { return Known::No };
        let key = model::print(layout);
        match (&entry.solved, &entry.refused) {
            (Some((own, solved)), _) if *own == key => Known::Solved(solved),
            (_, Some(why)) if entry.key == key => Known::Refused(why),
            (Some((_, solved)), _) => Known::Stale(solved),
            (None, _) => Known::No,
        }
    }

    /// What solving said of a document, as long as its text is what was solved.
    pub fn said(&self, place: &Path, checked: &Arc<Checked>) -> Vec<&Diagnostic> {
        let own = self.entries.iter().filter(|((own, _), _)| own == place).filter_map(|(_, entry)| entry.said.as_ref());
        own.filter(|(of, _)| Arc::ptr_eq(of, checked)).flat_map(|(_, said)| said).collect()
    }
}

fn work(queue: &Receiver<Job>, ended: &'static AtomicBool, done: impl Fn(Outcome)) {
    let mut waiting: VecDeque<Job> = VecDeque::new();
    loop {
        if waiting.is_empty() {
            let Ok(first) = queue.recv() else { return };
            waiting.push_back(first);
        }
        ended.store(false, Ordering::Relaxed);
        for job in queue.try_iter() {
            // The last one asked for a layout is the one that counts.
            waiting.retain(|other| (&other.place, other.index) != (&job.place, job.index));
            waiting.push_back(job);
        }
        let Some(job) = waiting.pop_front() else { continue };
        let Some(study) = &job.checked.study else { continue };
        let Some(layout) = study.analysis.layouts.get(job.index) else { continue };
        let begun = Instant::now();
        let stop = Stop::after_or(job.limit, ended);
        // One thread: the other cores are the editor's.
        let options = Options { threads: 1, stop, ..Options::default() };
        let (result, said) = solved(layout, &options);
        if ended.load(Ordering::Relaxed) && stop.cut().is_some() {
            // Ended for another one, which may be a newer state of this layout, or not.
            waiting.push_back(job);
            continue;
        }
        let (place, name, key) = (job.place, layout.name.clone(), job.key);
        let seconds = begun.elapsed().as_secs_f64();
        done(Outcome { place, name, key, checked: job.checked.clone(), result, said, seconds });
    }
}
