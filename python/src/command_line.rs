//! The command line, as the script `lss` of the wheel runs it.

use lss::base::{Host, loaded_by};
use pyo3::prelude::*;
use std::ffi::OsString;
use std::io::Write;
use std::path::PathBuf;

/// Says where the extension is and what starts the command line: results that are kept on the disk belong to a version.
#[pyfunction]
pub fn loaded(file: PathBuf, program: PathBuf) {
    loaded_by(Host { file, program });
}

/// Runs a command line, whose first word is the program's name; its exit code.
#[pyfunction]
pub fn main(py: Python, words: Vec<OsString>) -> u8 {
    py.detach(|| {
        let code = lss::cli::run(words).code();
        // A reader that went away is no error.
        let _ = std::io::stdout().flush();
        code
    })
}
