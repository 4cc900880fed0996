//! Any line as the answer of a model outside.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lss::gap::outside::{description, series};

fuzz_target!(|line: &str| {
    let _ = description(line).map_err(|why| why.to_string());
    match series(line, &["x".to_owned()], 0.0, 2.0) {
        Ok(rows) => assert!(rows.iter().flatten().all(|x| !x.is_infinite()), "{rows:?}"),
        Err(why) => drop(why.to_string()),
    }
});
