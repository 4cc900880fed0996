//! Simulations that were made before: kept in a file while a diagnosis runs, so that one which was stopped goes on
//! where it was.
//!
//! The file's first line is a hash of everything the simulations come from; another's is begun anew. Then a line a
//! simulation: what was asked, and the bits of the features, or of laps' variances and deviations. A line that was cut
//! is one that was never made.
//!
//! A hash cannot see everything (a module that a model's program loads, a remote server), so a few of the kept answers
//! are asked again before any is used. Where one differs, none is used. What could not be simulated is not kept: the
//! reason may have been outside.

use super::ids::{CandidateId, Id, PerRun, RunId};
use super::settings::Checks;
use super::simulator::{Applied, Axis, Candidates, Frame, Laps, Outline, Request, Simulator};
use crate::base::digest::sha256;
use crate::identify::Effort;
use crate::identify::noise::ChannelNoise;
use crate::signal::read::DATA_LIMIT;
use crate::source::disk::{Temporary, sweep, sync_folder};
use crate::source::root;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;
use std::sync::Mutex;

const MARK: &str = "lss gap simulations 3";

/// What a file held that a diagnosis would go on from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Left {
    Nothing,
    /// So many simulations, which are used.
    Used(usize),
    /// Simulations of another program, model, layout, run or option.
    OfOthers,
    /// So many simulations, to one of which the model gives another answer now.
    Contradicted(usize),
}

/// A simulator that asks another one only what is not known.
pub struct Remembered<'a> {
    simulator: &'a dyn Simulator,
    left: Left,
    book: Mutex<Book>,
}

/// An answer a request.
type Answers = Vec<Option<Vec<f64>>>;

type Known = BTreeMap<String, Vec<f64>>;

struct Book {
    known: Known,
    /// `None` where nothing can be written: nothing is kept then.
    file: Option<File>,
}

impl<'a> Remembered<'a> {
    /// With what a file knows of the same origin: a hash of all that the simulator is made of, beside what it says of
    /// itself. The file and its folder are made if they are missing.
    pub fn new(simulator: &'a dyn Simulator, path: &Path, origin: &str, settings: &Checks) -> Remembered<'a> {
        let first = format!("{MARK} {}", fingerprint(simulator, origin));
        let (known, left) = match read(path, &first) {
            None => (Known::new(), Left::Nothing),
            Some(None) => (Known::new(), Left::OfOthers),
            Some(Some(known)) if known.is_empty() => (known, Left::Nothing),
            Some(Some(known)) if is_confirmed(simulator, &known, settings.asked_again) => {
                let count = known.len();
                (known, Left::Used(count))
            }
            Some(Some(known)) => (Known::new(), Left::Contradicted(known.len())),
        };
        let file = begun(path, &first, &known).ok();
        Remembered { simulator, left, book: Mutex::new(Book { known, file }) }
    }

    /// What the file held.
    pub fn left(&self) -> Left {
        self.left
    }

    /// Removes a file of simulations, once the diagnosis is written.
    pub fn forget(path: &Path) {
        let _ = fs::remove_file(path);
    }

    fn book(&self) -> std::sync::MutexGuard<'_, Book> {
        self.book.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

impl Simulator for Remembered<'_> {
    fn candidates(&self) -> &Candidates {
        self.simulator.candidates()
    }

    fn frames(&self) -> &PerRun<Frame> {
        self.simulator.frames()
    }

    fn begin(&self) -> &[Applied] {
        self.simulator.begin()
    }

    fn threads(&self) -> usize {
        self.simulator.threads()
    }

    fn axis(&self) -> Axis {
        self.simulator.axis()
    }

    fn reason(&self, request: &Request) -> Option<String> {
        self.simulator.reason(request)
    }

    fn effort(&self) -> Effort {
        self.simulator.effort()
    }

    fn outline(&self, applied: &Applied, at: Option<&[f64]>) -> Option<Outline> {
        self.simulator.outline(applied, at)
    }

    fn noise(&self) -> BTreeMap<String, BTreeMap<String, ChannelNoise>> {
        self.simulator.noise()
    }

    fn applies_sensor_models(&self) -> bool {
        self.simulator.applies_sensor_models()
    }

    fn laps_all(&self, requests: &[Request]) -> Vec<Option<Laps>> {
        let keys = requests.iter().map(|r| key(LAPS, r)).collect();
        let flat =
            |asked: &[Request]| self.simulator.laps_all(asked).iter().map(|l| l.as_ref().map(Laps::flat)).collect();
        let answers = self.remembered(keys, requests, &flat).into_iter().zip(requests);
        answers.map(|(flat, r)| Some(Laps::of_flat(&flat?, self.frames()[r.run].labels.len()))).collect()
    }

    fn simulate_all(&self, requests: &[Request]) -> Vec<Option<Vec<f64>>> {
        let keys = requests.iter().map(|r| key(MEANS, r)).collect();
        self.remembered(keys, requests, &|asked| self.simulator.simulate_all(asked))
    }
}

impl Remembered<'_> {
    /// Answers from the book, and to what is not in it from the simulator.
    fn remembered(&self, keys: Vec<String>, requests: &[Request], ask: &dyn Fn(&[Request]) -> Answers) -> Answers {
        let missing: Vec<usize> = {
            let book = self.book();
            (0..requests.len()).filter(|k| !book.known.contains_key(&keys[*k])).collect()
        };
        let asked: Vec<Request> = missing.iter().map(|k| requests[*k].clone()).collect();
        let answers = ask(&asked);
        let mut book = self.book();
        let mut text = String::new();
        for (k, answer) in missing.into_iter().zip(answers) {
            let Some(features) = answer else { continue };
            line(&mut text, &keys[k], &features);
            book.known.insert(keys[k].clone(), features);
        }
        if let Some(file) = &mut book.file
            && file.write_all(text.as_bytes()).and_then(|()| file.flush()).is_err()
        {
            book.file = None;
        }
        keys.iter().map(|key| book.known.get(key).cloned()).collect()
    }
}

impl Laps {
    /// As one list.
    fn flat(&self) -> Vec<f64> {
        [&self.variance].into_iter().chain(&self.scatter).flatten().copied().collect()
    }

    /// From one list, of so many features.
    fn of_flat(flat: &[f64], features: usize) -> Laps {
        let mut each = flat.chunks(features.max(1)).map(<[f64]>::to_vec);
        Laps { variance: each.next().unwrap_or_default(), scatter: each.collect() }
    }
}

/// Of the origin, the model's effects and the runs as they were fitted.
fn fingerprint(simulator: &dyn Simulator, origin: &str) -> String {
    let mut all = format!("{origin} {:?}", simulator.candidates()).into_bytes();
    for frame in simulator.frames() {
        all.extend(frame.run.bytes());
        let numbers =
            frame.measured.iter().chain(&frame.nominal).chain(&frame.laps.variance).chain(frame.slopes.iter());
        all.extend(numbers.flat_map(|x| x.to_bits().to_le_bytes()));
    }
    sha256(&all)
}

/// What is asked for: features, or laps.
const MEANS: char = 'm';
const LAPS: char = 'l';

/// A question as one word: what for, run, nuisances' step, and each effect with its strengths.
fn key(what: char, request: &Request) -> String {
    let mut text = format!("{what}{}/{}", request.run, bits(&request.step));
    for effect in &request.effects {
        let _ = write!(text, "/{}:{}", effect.candidate, bits(&effect.strengths));
    }
    text
}

fn bits(numbers: &[f64]) -> String {
    numbers.iter().map(|x| format!("{:x}", x.to_bits())).collect::<Vec<_>>().join(",")
}

fn of_bits(text: &str) -> Option<Vec<f64>> {
    let one = |x: &str| u64::from_str_radix(x, 16).map(f64::from_bits).ok();
    text.split(',').filter(|x| !x.is_empty()).map(one).collect()
}

/// The question that a word is.
fn question(key: &str) -> Option<(char, Request)> {
    let mut parts = key.split('/');
    let head = parts.next()?;
    let (what, run) = (head.chars().next()?, RunId::new(head.get(1..)?.parse().ok()?));
    let step = of_bits(parts.next()?)?;
    let effect = |text: &str| {
        let (candidate, strengths) = text.split_once(':')?;
        Some(Applied { candidate: CandidateId::new(candidate.parse().ok()?), strengths: of_bits(strengths)? })
    };
    Some((what, Request { run, step, effects: parts.map(effect).collect::<Option<_>>()? }))
}

/// Asks so many of the kept answers again, spread over all.
fn is_confirmed(simulator: &dyn Simulator, known: &Known, count: usize) -> bool {
    let stride = known.len().div_ceil(count).max(1);
    known.iter().step_by(stride).all(|(key, kept)| {
        let Some((what, request)) = question(key) else { return false };
        let fits = simulator.frames().at(request.run).is_some()
            && request.effects.iter().all(|e| simulator.candidates().at(e.candidate).is_some());
        let asked = [request];
        let now = match what {
            _ if !fits => None,
            LAPS => simulator.laps_all(&asked).pop().flatten().as_ref().map(Laps::flat),
            _ => simulator.simulate_all(&asked).pop().flatten(),
        };
        now.is_some_and(|now| bits(&now) == bits(kept))
    })
}

fn line(text: &mut String, key: &str, features: &[f64]) {
    let _ = writeln!(text, "{key} {} .", bits(features));
}

/// `None` without a file, `Some(None)` for one of another origin.
fn read(path: &Path, first: &str) -> Option<Option<Known>> {
    path.symlink_metadata().ok().filter(fs::Metadata::is_file)?;
    let text = String::from_utf8(root::read_given(path, DATA_LIMIT).ok()?).ok()?;
    let mut lines = text.lines();
    if lines.next() != Some(first) {
        return Some(None);
    }
    let one = |line: &str| {
        let (key, features) = line.strip_suffix(" .")?.split_once(' ')?;
        question(key)?;
        Some((key.to_owned(), of_bits(features)?))
    };
    Some(Some(lines.filter_map(one).collect()))
}

/// A new file with what is known, open for more. It takes the place of the one before, whatever that was.
fn begun(path: &Path, first: &str, known: &Known) -> io::Result<File> {
    let folder = path.parent().filter(|f| !f.as_os_str().is_empty()).unwrap_or(Path::new("."));
    fs::create_dir_all(folder)?;
    sweep(folder);
    let mut text = format!("{first}\n");
    known.iter().for_each(|(key, features)| line(&mut text, key, features));
    let mut fresh = Temporary::new(folder, None)?;
    fresh.fill(text.as_bytes())?;
    let file = fresh.place(path)?;
    sync_folder(folder)?;
    file.ok_or_else(|| io::ErrorKind::NotFound.into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// Counts what it is asked; run 9 cannot be simulated.
    struct Counting {
        asked: AtomicUsize,
        candidates: Candidates,
        frames: PerRun<Frame>,
        bias: f64,
    }

    impl Default for Counting {
        fn default() -> Self {
            let frame = Frame::bare(Vec::new(), Vec::new());
            let candidates = Candidates::default();
            Counting { asked: AtomicUsize::new(0), candidates, frames: vec![frame; 10].into(), bias: 0.0 }
        }
    }

    impl Counting {
        fn asked(&self) -> usize {
            self.asked.load(Ordering::Relaxed)
        }
    }

    impl Simulator for Counting {
        fn candidates(&self) -> &Candidates {
            &self.candidates
        }

        fn frames(&self) -> &PerRun<Frame> {
            &self.frames
        }

        fn simulate(&self, run: RunId, step: &[f64], _: &[Applied]) -> Option<Vec<f64>> {
            self.asked.fetch_add(1, Ordering::Relaxed);
            let run = run.index();
            (run < 9).then(|| vec![run as f64 + 0.1, step.iter().sum::<f64>() + self.bias, f64::NAN])
        }
    }

    #[test]
    fn laps_come_back_from_one_list() {
        let laps = Laps { variance: vec![1.0, f64::INFINITY], scatter: vec![vec![0.1, 0.0], vec![-0.1, 0.2]] };
        assert_eq!(Laps::of_flat(&laps.flat(), 2), laps);
    }

    fn of(run: usize, step: f64) -> Request {
        let effects = vec![Applied { candidate: CandidateId::new(3), strengths: vec![-0.5, step] }];
        Request { run: RunId::new(run), step: vec![step], effects: if run == 1 { effects } else { Vec::new() } }
    }

    #[test]
    fn questions_are_read_from_their_words() {
        let none = Request { run: RunId::new(12), step: Vec::new(), effects: Vec::new() };
        for request in [of(0, 1.0 / 3.0), none] {
            assert_eq!(question(&key(LAPS, &request)), Some((LAPS, request)));
        }
        let (what, read) = question(&key(MEANS, &of(1, f64::NAN))).unwrap();
        assert!(what == MEANS && read.step[0].is_nan() && read.effects[0].candidate == CandidateId::new(3));
        for broken in ["", "m", "mx/0", "m0", "m0/z", "m0//1", "ä0/0"] {
            assert_eq!(question(broken).filter(|(what, _)| *what == MEANS), None, "{broken}");
        }
    }

    #[test]
    fn a_failure_is_asked_again() {
        let folder = tempfile::tempdir().unwrap();
        let counting = Counting::default();
        let known = Remembered::new(&counting, &folder.path().join("gap.partial"), "", &Checks::default());
        for _ in 0..2 {
            assert_eq!(known.simulate_all(&[of(9, 0.0)]), [None]);
        }
        assert_eq!(counting.asked(), 2);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_is_not_written_through() {
        let folder = tempfile::tempdir().unwrap();
        let (secret, path) = (folder.path().join("secret"), folder.path().join("gap.partial"));
        fs::write(&secret, "mine").unwrap();
        std::os::unix::fs::symlink(&secret, &path).unwrap();
        let counting = Counting::default();
        Remembered::new(&counting, &path, "", &Checks::default()).simulate_all(&[of(0, 0.5)]);
        assert_eq!(fs::read_to_string(&secret).unwrap(), "mine");
        assert!(fs::read_to_string(&path).unwrap().starts_with(MARK));
    }

    #[test]
    fn a_stopped_diagnosis_goes_on() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep/gap.partial");
        let of = |run: usize, step: f64| Request { run: RunId::new(run), step: vec![step], effects: Vec::new() };
        let bits = |answers: &[Option<Vec<f64>>]| -> Vec<Option<Vec<u64>>> {
            answers.iter().map(|a| a.as_ref().map(|x| x.iter().map(|y| y.to_bits()).collect())).collect()
        };
        let counting = Counting::default();
        let first = Remembered::new(&counting, &path, "a", &Checks::default());
        assert_eq!(first.left(), Left::Nothing);
        let whole = first.simulate_all(&[of(0, 1.0 / 3.0), of(9, 0.0), of(1, 0.2)]);
        assert_eq!(counting.asked(), 3);
        drop(first);
        // The last line is cut, as when the power fails.
        let text = fs::read_to_string(&path).unwrap();
        fs::write(&path, &text[..text.len() - 4]).unwrap();
        let second = Remembered::new(&counting, &path, "a", &Checks::default());
        assert_eq!((second.left(), counting.asked()), (Left::Used(1), 4), "the one that is kept was asked again");
        let again = second.simulate_all(&[of(0, 1.0 / 3.0), of(9, 0.0), of(1, 0.2), of(2, 0.2)]);
        assert_eq!(bits(&again[..3]), bits(&whole));
        // Only the first was known; what could not be simulated is asked for again.
        assert_eq!(counting.asked(), 7);
        assert_eq!(second.simulate(RunId::new(9), &[0.0], &[]), None);
        assert_eq!(counting.asked(), 8, "a failure is never kept");
        let third = Remembered::new(&counting, &path, "a", &Checks::default());
        assert_eq!(third.left(), Left::Used(3));
        Remembered::forget(&path);
        assert!(!path.exists());
    }

    #[test]
    fn what_another_origin_or_another_model_answered_is_not_used() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("gap.partial");
        let ask = [0.1, 0.2, 0.3, 0.4, 0.5].map(|step| of(0, step));
        let counting = Counting::default();
        Remembered::new(&counting, &path, "a", &Checks::default()).simulate_all(&ask);
        let text = fs::read_to_string(&path).unwrap();
        for (origin, text) in [("b", text.clone()), ("a", text.replacen(MARK, "lss gap simulations 2", 1))] {
            fs::write(&path, text).unwrap();
            let other = Remembered::new(&counting, &path, origin, &Checks::default());
            assert_eq!(other.left(), Left::OfOthers);
            assert_eq!(Remembered::new(&counting, &path, origin, &Checks::default()).left(), Left::Nothing);
        }
        // The same by all that can be known before it is asked.
        fs::write(&path, &text).unwrap();
        let biased = Counting { bias: 1e-9, ..Counting::default() };
        let other = Remembered::new(&biased, &path, "a", &Checks::default());
        assert_eq!(other.left(), Left::Contradicted(5));
        assert_eq!(other.simulate_all(&ask)[4].as_ref().map(|x| x[1]), Some(0.5 + 1e-9));
    }
}
