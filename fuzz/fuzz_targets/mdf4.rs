//! Any bytes as a run in MDF4.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lss::signal::mdf4;
use std::path::Path;

fuzz_target!(|bytes: &[u8]| {
    let _ = mdf4::read(std::io::Cursor::new(bytes), Path::new("run.mf4")).map_err(|why| why.to_string());
});
