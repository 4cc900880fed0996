//! Simulations that were made before: kept in a file while a diagnosis runs, so that one which was stopped goes on where it was.
//!
//! The file's first line tells of what model and runs it is; another's is begun anew. Then a line a simulation: the SHA-256 of what was
//! asked, and the bits of the features, or of laps' variances and deviations. A line that was cut is one that was never made.

use super::digest::sha256;
use super::simulator::{Applied, Candidate, Frame, Laps, Request, Simulator};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

const MARK: &str = "lss gap simulations 2";

/// A simulator that asks another one only what is not known.
pub struct Remembered<'a> {
    simulator: &'a dyn Simulator,
    path: PathBuf,
    book: Mutex<Book>,
}

/// An answer a request.
type Answers = Vec<Option<Vec<f64>>>;

struct Book {
    known: BTreeMap<String, Option<Vec<f64>>>,
    /// `None` where nothing can be written: nothing is kept then.
    file: Option<File>,
}

impl<'a> Remembered<'a> {
    /// With what a file knows of the same model and runs. The file and its folder are made if they are missing.
    pub fn new(simulator: &'a dyn Simulator, path: &Path) -> Remembered<'a> {
        let first = format!("{MARK} {}", fingerprint(simulator));
        let known = read(path, &first);
        let file = begun(path, &first, known.is_some()).ok();
        let book = Book { known: known.unwrap_or_default(), file };
        Remembered { simulator, path: path.to_owned(), book: Mutex::new(book) }
    }

    /// How many simulations are known.
    pub fn known(&self) -> usize {
        self.book().known.len()
    }

    /// Removes the file, once the diagnosis is written.
    pub fn forget(self) {
        let _ = fs::remove_file(&self.path);
    }

    fn book(&self) -> std::sync::MutexGuard<'_, Book> {
        self.book.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

impl Simulator for Remembered<'_> {
    fn candidates(&self) -> &[Candidate] {
        self.simulator.candidates()
    }

    fn frames(&self) -> &[Frame] {
        self.simulator.frames()
    }

    fn simulate(&self, run: usize, step: &[f64], effects: &[Applied]) -> Option<Vec<f64>> {
        let request = Request { run, step: step.to_vec(), effects: effects.to_vec() };
        self.simulate_all(&[request]).pop().flatten()
    }

    fn hears(&self) -> bool {
        self.simulator.hears()
    }

    fn laps_all(&self, requests: &[Request]) -> Vec<Option<Laps>> {
        let keys = requests.iter().map(|r| format!("{}l", key(r))).collect();
        let flat =
            |asked: &[Request]| self.simulator.laps_all(asked).iter().map(|l| l.as_ref().map(Laps::flat)).collect();
        let answers = self.remembered(keys, requests, &flat).into_iter().zip(requests);
        answers.map(|(flat, r)| Some(Laps::of_flat(&flat?, self.frames()[r.run].labels.len()))).collect()
    }

    fn simulate_all(&self, requests: &[Request]) -> Vec<Option<Vec<f64>>> {
        let keys = requests.iter().map(key).collect();
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
            line(&mut text, &keys[k], answer.as_deref());
            book.known.insert(keys[k].clone(), answer);
        }
        if let Some(file) = &mut book.file
            && file.write_all(text.as_bytes()).and_then(|()| file.flush()).is_err()
        {
            book.file = None;
        }
        keys.iter().map(|key| book.known.get(key).cloned().flatten()).collect()
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

/// Of the model's effects and the runs as they were fitted.
fn fingerprint(simulator: &dyn Simulator) -> String {
    let mut all = format!("{} {:?}", env!("CARGO_PKG_VERSION"), simulator.candidates()).into_bytes();
    for frame in simulator.frames() {
        all.extend(frame.run.bytes());
        let numbers =
            frame.measured.iter().chain(&frame.nominal).chain(&frame.laps.variance).chain(frame.slopes.iter());
        all.extend(numbers.flat_map(|x| x.to_bits().to_le_bytes()));
    }
    sha256(&all)
}

fn key(request: &Request) -> String {
    let mut all = [request.run as u64, request.step.len() as u64].map(u64::to_le_bytes).concat();
    let bits = |x: &f64| x.to_bits().to_le_bytes();
    all.extend(request.step.iter().flat_map(bits));
    for effect in &request.effects {
        all.extend((effect.candidate as u64).to_le_bytes());
        all.extend(effect.strengths.iter().flat_map(bits));
    }
    sha256(&all)
}

fn line(text: &mut String, key: &str, answer: Option<&[f64]>) {
    // What could not be simulated may have had its reason outside.
    let Some(features) = answer else { return };
    text.push_str(key);
    features.iter().for_each(|x| {
        let _ = write!(text, " {:x}", x.to_bits());
    });
    text.push_str(" .\n");
}

fn read(path: &Path, first: &str) -> Option<BTreeMap<String, Option<Vec<f64>>>> {
    let text = fs::read_to_string(path).ok()?;
    let mut lines = text.lines();
    if lines.next() != Some(first) {
        return None;
    }
    let one = |line: &str| {
        let (key, rest) = line.strip_suffix(" .")?.split_once(' ')?;
        let bits = rest.split(' ').map(|x| u64::from_str_radix(x, 16).map(f64::from_bits));
        Some((key.to_owned(), Some(bits.collect::<Result<Vec<f64>, _>>().ok()?)))
    };
    Some(lines.filter_map(one).collect())
}

/// The file, open for more; begun anew unless it goes on.
fn begun(path: &Path, first: &str, goes_on: bool) -> io::Result<File> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    if !goes_on {
        fs::write(path, first)?;
    }
    let mut file = File::options().append(true).open(path)?;
    // Also after a line that was cut.
    file.write_all(b"\n")?;
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// Counts what it is asked.
    struct Counting(AtomicUsize);

    impl Simulator for Counting {
        fn candidates(&self) -> &[Candidate] {
            &[]
        }

        fn frames(&self) -> &[Frame] {
            &[]
        }

        fn simulate(&self, run: usize, step: &[f64], _: &[Applied]) -> Option<Vec<f64>> {
            self.0.fetch_add(1, Ordering::Relaxed);
            (run < 9).then(|| vec![run as f64 + 0.1, step.iter().sum(), f64::NAN])
        }
    }

    #[test]
    fn laps_come_back_from_one_list() {
        let laps = Laps { variance: vec![1.0, f64::INFINITY], scatter: vec![vec![0.1, 0.0], vec![-0.1, 0.2]] };
        assert_eq!(Laps::of_flat(&laps.flat(), 2), laps);
    }

    #[test]
    fn a_stopped_diagnosis_goes_on() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep/gap.partial");
        let of = |run: usize, step: f64| Request { run, step: vec![step], effects: Vec::new() };
        let bits = |answers: &[Option<Vec<f64>>]| -> Vec<Option<Vec<u64>>> {
            answers.iter().map(|a| a.as_ref().map(|x| x.iter().map(|y| y.to_bits()).collect())).collect()
        };
        let counting = Counting(AtomicUsize::new(0));
        let first = Remembered::new(&counting, &path);
        let whole = first.simulate_all(&[of(0, 1.0 / 3.0), of(9, 0.0), of(1, 0.2)]);
        assert_eq!(counting.0.load(Ordering::Relaxed), 3);
        drop(first);
        // The last line is cut, as when the power fails.
        let text = fs::read_to_string(&path).unwrap();
        fs::write(&path, &text[..text.len() - 4]).unwrap();
        let second = Remembered::new(&counting, &path);
        assert_eq!(second.known(), 1);
        let again = second.simulate_all(&[of(0, 1.0 / 3.0), of(9, 0.0), of(1, 0.2), of(2, 0.2)]);
        assert_eq!(bits(&again[..3]), bits(&whole));
        // Only the first was known; what could not be simulated is asked for again.
        assert_eq!(counting.0.load(Ordering::Relaxed), 6);
        assert_eq!(Remembered::new(&counting, &path).known(), 3);
        // Another model's file is begun anew.
        fs::write(&path, text.replacen(MARK, "lss gap simulations 0", 1)).unwrap();
        let third = Remembered::new(&counting, &path);
        assert_eq!(third.known(), 0);
        third.forget();
        assert!(!path.exists());
    }
}
