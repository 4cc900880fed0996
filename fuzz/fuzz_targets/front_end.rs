//! Any bytes go through the whole front end, in memory: a model or diagnostics, and every diagnostic can be shown.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lss::diagnostic::{json, text};
use lss::semantics::{analyse, unreadable};
use lss::solve::unsupported;
use lss::source::{Loader, SourceMap};

fuzz_target!(|bytes: &[u8]| {
    let mut sources = SourceMap::default();
    let diagnostics = match Loader::memory(&mut sources, &[("main.lss", bytes)]) {
        Ok((mut loader, main)) => {
            let analysis = analyse(&mut sources, &mut loader, main, None);
            let mut diagnostics = analysis.diagnostics.clone();
            for layout in &analysis.layouts {
                diagnostics.extend(unsupported(layout));
                lss::model::print(layout);
            }
            diagnostics
        }
        Err(error) => unreadable(&mut sources, &error, "main.lss").into_iter().collect(),
    };
    for diagnostic in &diagnostics {
        text::render(&sources, diagnostic, text::Style::Plain);
        json::line(&sources, diagnostic);
    }
});
