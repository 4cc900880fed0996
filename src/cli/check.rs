//! `lss check`: every mistake of a layout, without solving it.

use super::{MessageFormat, Outcome, could_not, foreign, report};
use crate::semantics::{self, analyse};
use crate::source::{InputError, LoadError, Loader, SourceMap, layouts_in, shown};
use std::path::{Path, PathBuf};

/// Report every mistake in layouts, without solving them.
#[derive(Debug, clap::Args)]
pub struct Check {
    /// Layout files.
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// How diagnostics are written: text to standard error, JSON lines to standard output.
    #[arg(long, value_enum, default_value_t)]
    message_format: MessageFormat,
}

impl Check {
    pub fn run(&self) -> Outcome {
        let mut outcome = Outcome::Clean;
        for file in &self.files {
            let mut sources = SourceMap::default();
            let found = match open(&mut sources, file) {
                Ok((mut loader, main)) => analyse(&mut sources, &mut loader, main, None).diagnostics,
                Err(Opened::Unreadable(why)) => {
                    outcome = could_not("read", file, why);
                    continue;
                }
                Err(Opened::Problem(diagnostic)) => vec![*diagnostic],
            };
            match self.message_format {
                MessageFormat::Text => {
                    report::diagnostics(&mut std::io::stderr(), &sources, &found, self.message_format);
                }
                MessageFormat::Json => {
                    report::diagnostics(&mut std::io::stdout(), &sources, &found, self.message_format);
                }
            }
            if outcome == Outcome::Clean && found.iter().any(|d| d.is_error()) {
                outcome = Outcome::Problems;
            }
        }
        outcome
    }
}

/// Why a main file was not opened.
pub enum Opened {
    /// Not there or not readable.
    Unreadable(String),
    /// Readable, but no text.
    Problem(Box<crate::diagnostic::Diagnostic>),
}

/// What is said of a folder that was given for a layout.
fn folder(path: &Path) -> String {
    /// Names that are told.
    const MOST: usize = 5;
    let inside: Vec<PathBuf> = layouts_in(path);
    let names: Vec<String> = inside.iter().take(MOST).map(|file| shown(file).to_string()).collect();
    match inside.len() {
        0 => "it is a folder, without a layout (.lss) in it".to_owned(),
        1 => format!("it is a folder: name the layout in it, {}", names[0]),
        n if n > MOST => format!("it is a folder: name layouts in it, of which there are {n}: {}, …", names.join(", ")),
        _ => format!("it is a folder: name layouts in it: {}", names.join(", ")),
    }
}

/// Opens a main file.
pub fn open(sources: &mut SourceMap, path: &Path) -> Result<(Loader, crate::source::FileId), Opened> {
    if let Some(what) = foreign::not_a_layout(path).filter(|_| path.is_file()) {
        return Err(Opened::Unreadable(what));
    }
    if path.is_dir() {
        return Err(Opened::Unreadable(folder(path)));
    }
    Loader::open(sources, path).map_err(|error| match semantics::unreadable(sources, &error, &path.to_string_lossy()) {
        Some(diagnostic) => Opened::Problem(Box::new(diagnostic)),
        None => Opened::Unreadable(match error {
            LoadError::Unreadable(why) => why,
            LoadError::OutsideRoot(root) => InputError::OutsideRoot(root).to_string(),
            other => format!("{other:?}"),
        }),
    })
}
