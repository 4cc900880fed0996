//! `lss fmt`: one spelling for every layout.

use super::check::{Opened, open};
use super::{MessageFormat, Outcome, could_not, is_stdin, report};
use crate::source::{SourceMap, disk, shown};
use crate::syntax;
use diffy::DiffOptions;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Format layouts in place, keeping every comment. `-` formats standard input to standard output.
#[derive(Debug, clap::Args)]
pub struct Fmt {
    /// Layout files, or `-`.
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// Change nothing; exit with 1 when a file is not formatted.
    #[arg(long)]
    check: bool,
    /// Change nothing; print what would change.
    #[arg(long)]
    diff: bool,
}

impl Fmt {
    pub fn run(&self) -> Outcome {
        let mut outcome = Outcome::Clean;
        for file in &self.files {
            match (self.file(file), outcome) {
                (Outcome::CouldNotRun, _) => outcome = Outcome::CouldNotRun,
                (Outcome::Problems, Outcome::Clean) => outcome = Outcome::Problems,
                _ => {}
            }
        }
        outcome
    }

    fn file(&self, path: &Path) -> Outcome {
        let mut sources = SourceMap::default();
        let main = if is_stdin(path) {
            let mut text = String::new();
            if let Err(why) = std::io::stdin().read_to_string(&mut text) {
                return could_not("read", path, why);
            }
            sources.add("standard input", text)
        } else {
            match open(&mut sources, path) {
                Ok((_, main)) => main,
                Err(Opened::Unreadable(why)) => return could_not("read", path, why),
                Err(Opened::Problem(diagnostic)) => {
                    report::diagnostics(&mut std::io::stderr(), &sources, &[*diagnostic], MessageFormat::Text);
                    return Outcome::Problems;
                }
            }
        };
        let before = sources.file(main).text.clone();
        let (tree, mistakes) = syntax::parse(main, &before);
        if mistakes.iter().any(|d| d.is_error()) {
            report::diagnostics(&mut std::io::stderr(), &sources, &mistakes, MessageFormat::Text);
            return Outcome::Problems;
        }
        let after = syntax::format(&tree, &before);
        let changed = before != after;
        if self.diff && changed {
            report::print_source(&diff(path, &before, &after));
        }
        if self.check || self.diff {
            if self.check && changed && !self.diff {
                report::note(&format!("{} is not formatted", shown(path)));
            }
            return if changed { Outcome::Problems } else { Outcome::Clean };
        }
        if is_stdin(path) {
            report::print_source(&after);
            return Outcome::Clean;
        }
        if changed && let Err(why) = disk::rewrite(path, &after) {
            return could_not("write", path, why);
        }
        Outcome::Clean
    }
}

fn diff(path: &Path, before: &str, after: &str) -> String {
    let name = shown(path);
    let mut options = DiffOptions::new();
    options.set_original_filename(name.to_string()).set_modified_filename(format!("{name} (formatted)"));
    options.create_patch(before, after).to_string()
}
