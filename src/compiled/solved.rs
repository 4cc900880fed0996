//! From a checked layout to a compiled one, with what there is to say of it.

use super::Compiled;
use crate::diagnostic::Diagnostic;
use crate::model::Layout;
use crate::route;
use crate::solve::{self, Options, unsupported};

/// A layout, solved; where it asks for its vertices, with those that were found. `Err` says in a sentence why there is
/// none. The diagnostics are what a build says, but why nothing was found only where `options.stop` did not end the search.
pub fn solved(layout: &Layout, options: &Options) -> (Result<Compiled, String>, Vec<Diagnostic>) {
    let refused = unsupported(layout);
    if let Some(first) = refused.first() {
        return (Err(first.message.clone()), refused);
    }
    let compiled = match layout.route {
        None => Compiled::new(layout.clone(), solve::solve(layout, options, &|_| ())),
        Some(_) => match route::find(layout, options, &|_| ()) {
            Ok(found) => Compiled::new(found.layout, found.stages),
            Err(said) => {
                let why = said.first().map_or_else(|| "no loop was found".to_owned(), |d| d.message.clone());
                return (Err(why), said);
            }
        },
    };
    let mut said = Vec::new();
    match options.stop.cut() {
        None => compiled.tell(&mut said),
        Some(_) => compiled.tell_of_result(&mut said),
    }
    (Ok(compiled), said)
}
