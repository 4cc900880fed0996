//! Any text ends in a tree and diagnostics; what has no mistakes is formatted once and for all.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lss::source::FileId;
use lss::syntax::{format, parse};

fuzz_target!(|text: &str| {
    let (tree, problems) = parse(FileId(0), text);
    let once = format(&tree, text);
    if problems.is_empty() {
        let (again, problems) = parse(FileId(0), &once);
        assert!(problems.is_empty(), "the formatter broke the file: {problems:?}");
        assert_eq!(once, format(&again, &once), "not idempotent");
    }
});
