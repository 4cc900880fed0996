//! `lss explain`: what a code means.

use super::{Outcome, report};
use crate::diagnostic::Code;
use crate::source::one_line;

/// Explain a diagnostic code: what it means, why it matters, an example, and the way out. Without a code, list all.
#[derive(Debug, clap::Args)]
pub struct Explain {
    /// A code such as E0301, or its name.
    code: Option<String>,
}

impl Explain {
    pub fn run(&self) -> Outcome {
        let Some(wanted) = &self.code else {
            let line = |code: &Code| format!("{}  {}\n", code.as_str(), code.name());
            report::print(&Code::ALL.iter().map(line).collect::<String>());
            return Outcome::Clean;
        };
        let matches = |code: &&Code| code.as_str().eq_ignore_ascii_case(wanted) || code.name() == wanted;
        match Code::ALL.iter().find(matches) {
            Some(code) => {
                report::print(code.page());
                Outcome::Clean
            }
            None => {
                report::error(&format!("there is no code {}; `lss explain` lists them", one_line(wanted)));
                Outcome::CouldNotRun
            }
        }
    }
}
