//! Any bytes as a run in CSV, of a sensor cart and of another machine: columns that can be written again, or an error
//! that can be shown.
#![no_main]

use libfuzzer_sys::fuzz_target;
use lss::signal::{Run, Sidecar, csv, measures};
use std::path::Path;

fuzz_target!(|bytes: &[u8]| {
    let file = Path::new("run.csv");
    let _ =
        csv::read_as(std::io::Cursor::new(bytes), file, &|name, _| Ok((name != "skipped").then(|| name.to_owned())))
            .map_err(|why| why.to_string());
    match csv::read(bytes, file) {
        Ok((time, channels)) => {
            let run = Run { time, channels, sidecar: Sidecar::default() };
            assert!(run.rate().is_finite() && run.duration().is_finite());
            run.warnings(Some(50.0));
            for samples in run.channels.values() {
                if let Some(found) = measures::statistics(samples) {
                    assert!(found.mean.is_finite() && found.sd.is_finite(), "{found:?}");
                }
            }
            let (time, _) = csv::read(&csv::write(&run), file).expect("what is written is read");
            assert_eq!(time, run.time);
        }
        Err(why) => drop(why.to_string()),
    }
});
