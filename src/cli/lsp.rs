//! `lss lsp`: the language server.

use super::{Outcome, report};
use crate::editor;

/// Serve an editor: diagnostics, completion, hover and more while a layout is written.
///
/// Speaks the Language Server Protocol over standard input and output; an editor starts it. docs/editor.md says how to
/// set editors up.
#[derive(Debug, clap::Args)]
pub struct Lsp {
    /// Taken for clients that give it: standard input and output are the only way.
    #[arg(long, hide = true)]
    stdio: bool,
}

impl Lsp {
    pub fn run(&self) -> Outcome {
        match editor::serve() {
            Ok(()) => Outcome::Clean,
            Err(why) => {
                report::error(&why);
                Outcome::Problems
            }
        }
    }
}
