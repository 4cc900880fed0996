//! Any bytes as a campaign and as a sidecar.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lss::signal::{Campaign, Sidecar};
use std::path::Path;

fuzz_target!(|bytes: &[u8]| {
    let _ = Campaign::files(bytes, Path::new("campaign.toml")).map_err(|why| why.to_string());
    match Sidecar::read(bytes, Path::new("run.toml")) {
        Ok(sidecar) => {
            let again = Sidecar::read(&sidecar.write(), Path::new("run.toml")).expect("what is written is read");
            assert_eq!(again.write(), sidecar.write());
        }
        Err(why) => drop(why.to_string()),
    }
});
