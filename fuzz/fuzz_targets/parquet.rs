//! Any bytes as a run in Parquet.
#![no_main]

use bytes::Bytes;
use libfuzzer_sys::fuzz_target;
use lss::signal::parquet;
use std::path::Path;

fuzz_target!(|bytes: &[u8]| {
    let _ = parquet::read(Bytes::copy_from_slice(bytes), Path::new("run.parquet")).map_err(|why| why.to_string());
});
