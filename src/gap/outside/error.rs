//! What can go wrong with a model outside and its runs: what was said, and a way out.

use crate::signal::RunError;
use crate::source::{one_line, steers};
use std::fmt;

/// Why a model outside cannot be used.
#[derive(Clone, Debug, PartialEq)]
pub enum Error {
    /// The command is empty, or a quote in it is not closed.
    Command(String),
    /// The program does not start; the command and the reason.
    Start { command: String, why: String },
    /// The program does not take the request; the reason.
    Deaf(String),
    /// No answer after so many seconds.
    Silent { seconds: f64 },
    /// The program ended instead of answering, with this status.
    Ended { status: String },
    /// The answer is not one object of JSON; the line and why.
    NotJson { line: String, why: String },
    /// A line that nothing had asked for.
    Unasked { line: String },
    /// The answer does not hold what it has to; what was asked, the line, and what is wrong with it.
    Answer { request: &'static str, line: String, why: String },
    /// So many features of how many that can be compared are no finite numbers.
    NotFinite { lacking: usize, of: usize },
    /// The model says that it cannot do it.
    Refused(String),
    /// A run cannot be simulated even without effects, and why.
    InRun { run: String, why: Box<Error> },
    /// The model has failed so often that it is not asked any more; its last failure.
    GivenUp(Box<Error>),
    /// A run or the campaign cannot be read.
    Run(RunError),
    /// The campaign declares no channels.
    NoChannels,
    /// A run lacks a declared channel; its own columns.
    NoSuchChannel { file: String, channel: String, columns: Vec<String> },
    /// A run is too short to be compared: samples that it has, and that it needs.
    Short { run: String, samples: usize, needed: usize },
    /// The same question had another answer: the channel, by how much, and what its noise is, in its unit.
    Random { channel: String, by: f64, noise: f64 },
    /// The run's features do not depend on the model or on anything measured.
    Nothing { run: String },
}

impl Error {
    /// Whether the fault lies in the input rather than in running the program.
    pub fn is_input(&self) -> bool {
        match self {
            Error::Run(error) => !error.is_unreadable(),
            Error::NoChannels | Error::NoSuchChannel { .. } | Error::Short { .. } | Error::Nothing { .. } => true,
            Error::InRun { why, .. } => why.is_input(),
            _ => false,
        }
    }

    /// The same with the run that it is about.
    pub(super) fn in_run(self, run: &str) -> Error {
        match self {
            Error::Run(_) | Error::Short { .. } | Error::Nothing { .. } => self,
            why => Error::InRun { run: run.to_owned(), why: Box::new(why) },
        }
    }

    /// A way out.
    pub fn help(&self) -> String {
        match self {
            Error::Command(_) => "write it as in a shell: --model \"python3 'my models/oven.py' --fast\"".to_owned(),
            Error::Start { .. } => {
                "a command is a program and its arguments, seen from the present folder; no shell is \
                 involved"
                    .to_owned()
            }
            Error::Deaf(_) | Error::Ended { .. } => {
                "see what it wrote to its standard error; it has to answer line by line until its standard input ends"
                    .to_owned()
            }
            Error::Silent { .. } => {
                "flush the standard output after each answer, and answer each request by one line".to_owned()
            }
            Error::NotJson { line, .. } if line.contains("NaN") || line.contains("Infinity") => {
                "JSON has no NaN and no Infinity: write null for what is not known".to_owned()
            }
            Error::NotJson { .. } | Error::Unasked { .. } => {
                "the standard output is for answers, one JSON object a line; print everything else to the standard \
                 error"
                    .to_owned()
            }
            Error::Answer { .. } => "docs/outside-models.md says what an answer holds".to_owned(),
            Error::NotFinite { .. } => "answer numbers wherever the nominal model does".to_owned(),
            Error::Random { .. } => {
                "draw the same random numbers each time (a fixed seed, set before each simulation), start each simulation \
                 from the same state, and leave out what hangs on the clock"
                    .to_owned()
            }
            Error::Refused(_) => "the words are the model's own; ask those who wrote it".to_owned(),
            Error::GivenUp(last) | Error::InRun { why: last, .. } => last.help(),
            Error::Run(error) => error.help(),
            Error::NoChannels => {
                "add to campaign.toml a table [channels] with lines of name = \"unit\" for what is compared".to_owned()
            }
            Error::NoSuchChannel { columns, .. } => {
                format!("[channels] names columns of the data; this file has {}", one_line(&columns.join(", ")))
            }
            Error::Short { .. } => "give longer runs, sampled faster, or fewer lost samples".to_owned(),
            Error::Nothing { .. } => "check that the channel is measured, and that the model answers \
             numbers"
                .to_owned(),
        }
    }
}

/// The beginning of a line, which may be long.
fn shown(line: &str) -> String {
    const LONGEST: usize = 120;
    let line = line.trim_end();
    let begin: String = line.chars().take(LONGEST).map(|c| if steers(c) { ' ' } else { c }).collect();
    if line.chars().nth(LONGEST).is_some() { format!("{begin}...") } else { begin }
}

impl fmt::Display for Error {
    /// What is wrong, without the way out.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::Command(why) => write!(f, "the model's command cannot be read: {why}"),
            Error::Start { command, why } => write!(f, "the model `{command}` does not start: {why}"),
            Error::Deaf(why) => write!(f, "the model does not take requests: {why}"),
            Error::Silent { seconds } => write!(f, "the model did not answer within {seconds} s and was stopped"),
            Error::Ended { status } => write!(f, "the model ended instead of answering ({status})"),
            Error::NotJson { line, why } => {
                write!(f, "the model said `{}`, which is no answer: {}", shown(line), one_line(why))
            }
            Error::Unasked { line } => write!(f, "the model said `{}` without being asked", shown(line)),
            Error::Answer { request, line, why } => {
                write!(f, "the model's answer to `{request}` is wrong: {}\n  it said: {}", one_line(why), shown(line))
            }
            Error::NotFinite { lacking, of } => write!(f, "of {lacking} of {of} windows the model says nothing finite"),
            Error::Refused(why) => write!(f, "the model refused: {}", shown(why)),
            Error::InRun { run, why } => write!(f, "{run}, without any effect: {why}"),
            Error::GivenUp(last) => write!(f, "the model failed too often; at last: {last}"),
            Error::Run(error) => write!(f, "{}: {}", error.place, error.problem),
            Error::NoChannels => write!(f, "the campaign declares no channels to compare"),
            Error::NoSuchChannel { file, channel, .. } => {
                write!(f, "{file}: there is no column `{}`", one_line(channel))
            }
            Error::Short { run, samples, needed } => {
                write!(f, "{run}: {samples} samples are too few, it takes {needed}")
            }
            Error::Random { channel, by, noise } => write!(
                f,
                "asked the same twice, the model answers differently: `{}` by {by:.3} (root mean square), more than the \
                 measured noise of {noise:.3}",
                one_line(channel)
            ),
            Error::Nothing { run } => write!(f, "{run}: nothing measured can be compared with what the model says"),
        }
    }
}

impl std::error::Error for Error {}

impl From<RunError> for Error {
    fn from(error: RunError) -> Self {
        Error::Run(error)
    }
}
