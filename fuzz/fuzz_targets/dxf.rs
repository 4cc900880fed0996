//! Any text as a drawing: a plan whose layout is free of mistakes of form, or diagnostics that can be shown.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lss::diagnostic::{json, text};
use lss::import::{self, Options};
use lss::source::{FileId, SourceMap};
use lss::syntax::parse;

fuzz_target!(|drawing: &str| {
    let mut sources = SourceMap::default();
    let file = sources.add("plan.dxf", drawing);
    let (plan, said) = import::read(&sources, file, &Options::default());
    for diagnostic in &said {
        text::render(&sources, diagnostic, text::Style::Plain);
        json::line(&sources, diagnostic);
    }
    if let Some(plan) = plan {
        let layout = import::write(&plan, "plan", "Imported.");
        let (_, mistakes) = parse(FileId(0), &layout);
        assert!(mistakes.is_empty(), "{mistakes:?}\n{layout}");
    }
});
