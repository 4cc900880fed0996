//! The way from a file to one checked layout that can be built, shared by the verbs that need one.

use super::check::{Opened, open};
use super::{MessageFormat, Outcome, could_not, report};
use crate::diagnostic::Diagnostic;
use crate::model::Layout;
use crate::semantics::analyse;
use crate::source::SourceMap;
use std::path::Path;

/// A checked layout, its sources, and what was said of it so far.
pub struct Read {
    pub sources: SourceMap,
    pub layout: Layout,
    pub said: Vec<Diagnostic>,
}

/// Reads and checks; mistakes are reported here, and end the verb with the outcome returned.
pub fn read(file: &Path, name: Option<&str>, format: MessageFormat) -> Result<Read, Outcome> {
    let mut sources = SourceMap::default();
    let (mut loader, main) = match open(&mut sources, file) {
        Ok(opened) => opened,
        Err(Opened::Unreadable(why)) => return Err(could_not("read", file, why)),
        Err(Opened::Problem(diagnostic)) => return Err(tell(&sources, &[*diagnostic], format)),
    };
    let analysis = analyse(&mut sources, &mut loader, main, name);
    let mut said = analysis.diagnostics.clone();
    match analysis.chosen() {
        Ok(Some(layout)) if !analysis.has_errors() => Ok(Read { layout: layout.clone(), sources, said }),
        Ok(_) => Err(tell(&sources, &said, format)),
        Err(unclear) => {
            if !said.contains(&unclear) {
                said.push(*unclear);
            }
            Err(tell(&sources, &said, format))
        }
    }
}

/// Reports diagnostics, and whether they are problems.
pub fn tell(sources: &SourceMap, said: &[Diagnostic], format: MessageFormat) -> Outcome {
    report::diagnostics(&mut std::io::stderr(), sources, said, format);
    if said.iter().any(Diagnostic::is_error) { Outcome::Problems } else { Outcome::Clean }
}
