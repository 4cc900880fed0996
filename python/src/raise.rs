//! What went wrong, as Python's exceptions.

use lss::diagnostic::text::{Style, render, summary};
use lss::diagnostic::{Diagnostic, json};
use lss::source::SourceMap;
use pyo3::exceptions::{PyOSError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use std::path::Path;

/// Why there is no answer.
pub enum Failure {
    /// A file could not be read or written.
    File(String),
    /// A value is wrong.
    Value(String),
    /// What was asked for could not be done with this input.
    Run(String),
    /// A layout has mistakes.
    Layout(Said),
}

/// Diagnostics, for people and for programs.
#[derive(Clone, Default)]
pub struct Said {
    /// As a terminal shows them, without colour.
    pub text: String,
    /// A JSON object each.
    pub json: Vec<String>,
}

impl Said {
    pub fn new(sources: &SourceMap, said: &[Diagnostic]) -> Said {
        let mut text: String = said.iter().map(|d| render(sources, d, Style::Plain)).collect();
        text.extend(summary(said));
        Said { text: text.trim().to_owned(), json: said.iter().map(|d| json::line(sources, d)).collect() }
    }
}

impl Failure {
    /// Of a file, in the words of the command line.
    pub fn file(what: &str, path: &Path, why: impl std::fmt::Display) -> Failure {
        Failure::File(format!("could not {what} {}: {why}", path.display()))
    }

    /// As an exception. A layout that was found all the same goes with it.
    pub fn raised(self, py: Python, found: Option<Py<PyAny>>) -> PyErr {
        let error = |name: &str, arguments: (String, Vec<String>, Option<Py<PyAny>>)| -> PyResult<PyErr> {
            let class = py.import("lss._errors")?.getattr(name)?;
            Ok(PyErr::from_value(class.call1(arguments)?))
        };
        let raised = match self {
            Failure::File(words) => return PyOSError::new_err(words),
            Failure::Value(words) => return PyValueError::new_err(words),
            Failure::Run(words) => error("RunError", (words, Vec::new(), None)),
            Failure::Layout(said) => error("LayoutError", (said.text, said.json, found)),
        };
        raised.unwrap_or_else(|why| why)
    }
}

/// What a thread that broke down is reported as.
pub fn broken() -> PyErr {
    PyRuntimeError::new_err("lss broke down: that is a mistake in lss, and its message is on standard error")
}
