//! A step as a process of its own: this program, started anew.

use crate::base;
use std::fs::File;
use std::io;
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};

/// What is started.
#[derive(Debug)]
pub struct Call<'a> {
    /// Words behind the program's name.
    pub arguments: &'a [String],
    /// Where it runs.
    pub folder: &'a Path,
    /// The lock of the task, which the process holds as long as it lives: it is handed over as standard input, which
    /// no verb of a study reads.
    pub held: Option<File>,
}

/// How a process ended.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Ended {
    /// `None` where a signal ended it.
    pub code: Option<i32>,
    pub signal: Option<i32>,
    pub out: String,
    pub said: String,
}

/// What starts processes.
pub type Start<'a> = &'a (dyn Fn(Call) -> io::Result<Ended> + Sync);

/// Starts this program.
///
/// # Errors
///
/// The system's, where it cannot be started.
pub fn start(call: Call) -> io::Result<Ended> {
    let mut command = Command::new(base::running()?);
    // Lists of processes have its name.
    #[cfg(unix)]
    std::os::unix::process::CommandExt::arg0(&mut command, "lss");
    let output = command
        .args(call.arguments)
        .current_dir(call.folder)
        .env("NO_COLOR", "1")
        .stdin(call.held.map_or_else(Stdio::null, Stdio::from))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .output()?;
    Ok(Ended {
        code: output.status.code(),
        signal: signal(output.status),
        out: String::from_utf8_lossy(&output.stdout).into_owned(),
        said: String::from_utf8_lossy(&output.stderr).into_owned(),
    })
}

#[cfg(unix)]
fn signal(status: ExitStatus) -> Option<i32> {
    std::os::unix::process::ExitStatusExt::signal(&status)
}

#[cfg(not(unix))]
fn signal(_: ExitStatus) -> Option<i32> {
    None
}
