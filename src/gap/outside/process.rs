//! Child processes that answer lines by lines.

use super::Error;
use crate::base::digest::sha256_of;
use crate::base::unique::unlike_any_other;
use crate::gap::settings::Processes;
use std::fs::File;
use std::io::{BufRead, BufReader, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

/// A line longer than this is no answer, bytes.
const LONGEST_LINE: u64 = 1 << 28;

/// A program with its arguments.
#[derive(Clone, Debug)]
pub(super) struct Program {
    command: String,
    words: Vec<String>,
}

impl Program {
    /// Splits a command into words as a shell does: by blanks, with quotes of both kinds; but a backslash stands for
    /// itself (as in paths of Windows) unless it precedes a quote, a backslash or a blank.
    pub fn new(command: &str) -> Result<Program, Error> {
        let mut words = Vec::new();
        let mut word: Option<String> = None;
        let mut quote: Option<char> = None;
        let mut chars = command.chars().peekable();
        while let Some(c) = chars.next() {
            match (c, quote) {
                (c, Some(q)) if c == q => quote = None,
                ('\\', q) if q != Some('\'') && chars.peek().is_some_and(|n| matches!(n, '"' | '\'' | '\\' | ' ')) => {
                    word.get_or_insert_default().extend(chars.next());
                }
                ('"' | '\'', None) => {
                    quote = Some(c);
                    word.get_or_insert_default();
                }
                (c, None) if c.is_whitespace() => words.extend(word.take()),
                (c, _) => word.get_or_insert_default().push(c),
            }
        }
        words.extend(word);
        match quote {
            Some(quote) => Err(Error::Command(format!("{quote} is not closed in `{command}`"))),
            None if words.iter().all(String::is_empty) => Err(Error::Command("it is empty".to_owned())),
            None => Ok(Program { command: command.to_owned(), words }),
        }
    }

    /// What the program is made of, as far as its command tells: the words, and the content of the files that they
    /// name. A word names a file by its path, or by what stands behind its `=`; the first one also by the folders of
    /// PATH.
    pub fn origin(&self) -> String {
        let named = |word: &String| {
            let behind = word.split_once('=').map(|(_, path)| PathBuf::from(path));
            [Some(PathBuf::from(word)), behind].into_iter().flatten().collect::<Vec<_>>()
        };
        let found = self.words.first().and_then(|program| in_path(program));
        let files = found.into_iter().chain(self.words.iter().flat_map(named)).filter(|path| path.is_file());
        let mut origin = format!("{:?}", self.words);
        for path in files {
            let hash = File::open(&path).and_then(|mut file| sha256_of(&mut file));
            // One that cannot be read may be another each time.
            let hash = hash.unwrap_or_else(|_| unlike_any_other());
            origin.push_str(&format!(" {path:?} {hash}"));
        }
        origin
    }

    fn start(&self, patience: Duration) -> Result<Process, Error> {
        let failed = |why: String| Error::Start { command: self.command.clone(), why };
        let (program, arguments) = self.words.split_first().ok_or_else(|| failed("it is empty".to_owned()))?;
        let mut child = Command::new(program)
            .args(arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(|why| failed(why.to_string()))?;
        let (input, output) = (child.stdin.take(), child.stdout.take());
        let (sender, lines) = sync_channel(4);
        let process = Process { child, input, lines, patience };
        let output = output.ok_or_else(|| failed("it has no standard output".to_owned()))?;
        let reader = thread::Builder::new().name("model".to_owned()).spawn(move || listen(output, &sender));
        reader.map(|_| process).map_err(|why| failed(why.to_string()))
    }
}

/// Where the system looks for a program that is named without a folder.
fn in_path(program: &str) -> Option<PathBuf> {
    let plain = Path::new(program).components().count() == 1 && !program.contains(['/', '\\']);
    let folders = std::env::var_os("PATH").filter(|_| plain)?;
    let name = format!("{program}{}", std::env::consts::EXE_SUFFIX);
    std::env::split_paths(&folders).flat_map(|f| [f.join(program), f.join(&name)]).find(|path| path.is_file())
}

/// Sends each line, until there is none or nobody takes them.
fn listen(output: ChildStdout, lines: &SyncSender<Vec<u8>>) {
    let mut output = BufReader::new(output);
    loop {
        let mut line = Vec::new();
        match output.by_ref().take(LONGEST_LINE).read_until(b'\n', &mut line) {
            Ok(0) | Err(_) => return,
            Ok(_) => {}
        }
        if lines.send(line).is_err() {
            return;
        }
    }
}

/// A running program. Its input ends when it is dropped; it is stopped if that does not end it, and never left a
/// zombie.
struct Process {
    child: Child,
    input: Option<ChildStdin>,
    lines: Receiver<Vec<u8>>,
    /// What it is given to end by itself once its input has ended.
    patience: Duration,
}

impl Process {
    fn ask(&mut self, request: &str, timeout: Duration) -> Result<String, Error> {
        if let Ok(line) = self.lines.try_recv() {
            return Err(Error::Unasked { line: String::from_utf8_lossy(&line).into_owned() });
        }
        let written = match &mut self.input {
            Some(input) => input.write_all(format!("{request}\n").as_bytes()).and_then(|()| input.flush()),
            None => Ok(()),
        };
        // A program that has ended says so better than a broken pipe does.
        if let Err(why) = written {
            return Err(self.ended().unwrap_or_else(|| Error::Deaf(why.to_string())));
        }
        match self.lines.recv_timeout(timeout) {
            Ok(line) if !line.ends_with(b"\n") && line.len() as u64 >= LONGEST_LINE => {
                let line = String::from_utf8_lossy(&line[..1024]).into_owned();
                Err(Error::NotJson { line, why: "the line does not end".to_owned() })
            }
            Ok(line) => String::from_utf8(line).map_err(|why| Error::NotJson {
                line: String::from_utf8_lossy(why.as_bytes()).into_owned(),
                why: "it is not text in UTF-8".to_owned(),
            }),
            Err(RecvTimeoutError::Timeout) => Err(Error::Silent { seconds: timeout.as_secs_f64() }),
            Err(RecvTimeoutError::Disconnected) => {
                Err(self.ended().unwrap_or(Error::Ended { status: "its standard output is closed".to_owned() }))
            }
        }
    }

    /// How it ended, if it does within a moment.
    fn ended(&mut self) -> Option<Error> {
        self.input = None;
        let begin = Instant::now();
        loop {
            match self.child.try_wait() {
                Ok(Some(status)) => return Some(Error::Ended { status: status.to_string() }),
                Ok(None) if begin.elapsed() < self.patience => thread::sleep(Duration::from_millis(2)),
                _ => return None,
            }
        }
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        if self.ended().is_none() {
            // Either fails only for a process that is already gone.
            let _ = self.child.kill();
            let _ = self.child.wait();
        }
    }
}

/// Who is to blame where a process is lost.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Blame {
    /// The program as a whole: one that is lost too often is not asked any more.
    Program,
    /// The effects that were asked for: others may well be simulated.
    Effects,
}

/// Processes of one program, started when they are needed.
pub(super) struct Pool {
    program: Program,
    timeout: Duration,
    most: usize,
    settings: Processes,
    state: Mutex<State>,
    freed: Condvar,
}

#[derive(Default)]
struct State {
    idle: Vec<Process>,
    busy: usize,
    failures: usize,
    /// Set once the program is not asked any more.
    given_up: Option<Error>,
}

impl Pool {
    pub fn new(program: Program, most: usize, timeout: Duration, settings: &Processes) -> Pool {
        Pool {
            program,
            timeout,
            most: most.max(1),
            settings: settings.clone(),
            state: Mutex::default(),
            freed: Condvar::new(),
        }
    }

    /// Processes that may be at work at once.
    pub fn most(&self) -> usize {
        self.most
    }

    /// Asks a process that has nothing to do; `read` reads its answer. A process that fails, or whose answer is not
    /// one, is ended, as what it says next may be about anything.
    pub fn ask<T>(&self, request: &str, blame: Blame, read: impl FnOnce(&str) -> Result<T, Error>) -> Result<T, Error> {
        let idle = self.take()?;
        let started = idle.map_or_else(|| self.program.start(Duration::from_secs_f64(self.settings.patience)), Ok);
        let mut process = match started {
            Ok(process) => process,
            Err(error) => return Err(self.lost(error, Blame::Program)),
        };
        let answer = process.ask(request, self.timeout).and_then(|line| read(&line));
        match answer {
            Ok(_) | Err(Error::Refused(_)) => {
                let mut state = self.state();
                state.busy -= 1;
                state.idle.push(process);
                drop(state);
                self.freed.notify_one();
                answer
            }
            Err(error) => {
                drop(process);
                Err(self.lost(error, blame))
            }
        }
    }

    /// Asks no more, for a reason.
    pub fn give_up(&self, error: Error) {
        let last = match error {
            Error::GivenUp(last) => last,
            error => Box::new(error),
        };
        self.state().given_up.get_or_insert(Error::GivenUp(last));
    }

    /// Ends all idle processes, so that the next answer comes from a fresh one.
    pub fn renew(&self) {
        let idle = std::mem::take(&mut self.state().idle);
        drop(idle);
    }

    /// An idle process, or leave to start one.
    fn take(&self) -> Result<Option<Process>, Error> {
        let mut state = self.state();
        loop {
            if let Some(error) = &state.given_up {
                return Err(error.clone());
            }
            if state.busy < self.most {
                state.busy += 1;
                return Ok(state.idle.pop());
            }
            state = self.freed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// A process was lost. One that is silent costs minutes each time, so it is not asked twice.
    fn lost(&self, error: Error, blame: Blame) -> Error {
        let mut state = self.state();
        state.busy -= 1;
        if blame == Blame::Program {
            state.failures += 1;
            if state.failures >= self.settings.most_failures
                || matches!(error, Error::Silent { .. } | Error::Start { .. })
            {
                state.given_up.get_or_insert_with(|| Error::GivenUp(Box::new(error.clone())));
            }
        }
        drop(state);
        self.freed.notify_all();
        error
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_program_is_what_its_files_hold() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name).display().to_string();
        fs::write(at("m.py"), "1").unwrap();
        fs::write(at("data.json"), "1").unwrap();
        let origin =
            || Program::new(&format!("sh \"{}\" --data=\"{}\"", at("m.py"), at("data.json"))).unwrap().origin();
        let first = origin();
        assert_eq!(origin(), first);
        assert!(!cfg!(unix) || first.contains("/sh\" "), "{first}");
        let mut seen = vec![first];
        for (name, text) in [("m.py", "2"), ("data.json", "2"), ("data.json", "3")] {
            fs::write(at(name), text).unwrap();
            let now = origin();
            assert!(!seen.contains(&now), "{name}");
            seen.push(now);
        }
    }

    #[test]
    fn commands_are_split_as_by_a_shell() {
        let words = |c: &str| Program::new(c).map(|p| p.words);
        assert_eq!(words(" python3  'a b.py' --x=\"1 2\"'3' ").expect("words"), ["python3", "a b.py", "--x=1 23"]);
        assert_eq!(
            words(r#"C:\run\m.exe a\ b "c\"d" 'e\f' """#).expect("words"),
            [r"C:\run\m.exe", "a b", "c\"d", r"e\f", ""]
        );
        assert_eq!(words("python3 'a"), Err(Error::Command("' is not closed in `python3 'a`".to_owned())));
        assert_eq!(words(" "), Err(Error::Command("it is empty".to_owned())));
    }
}
