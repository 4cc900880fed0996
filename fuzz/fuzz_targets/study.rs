//! Any text as a study.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lss::diagnostic::text::{Style, render};
use lss::source::SourceMap;

fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    let mut sources = SourceMap::default();
    let file = sources.add("study.toml", text);
    let (study, said) = lss::study::read(file, text);
    assert!(!said.is_empty() || !study.sweeps.is_empty());
    said.iter().for_each(|diagnostic| drop(render(&sources, diagnostic, Style::Plain)));
});
