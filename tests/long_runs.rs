//! Reading a long run takes little more memory than its numbers. One test, so that the process's peak is its own.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use lss::signal::health::health;
use lss::signal::{Channel, Run};
use std::fmt::Write as _;
use std::fs;
use std::io::{BufWriter, Write};
use std::path::Path;

const ROWS: usize = 400_000;

/// 10 million rows of 16 columns are 1.28 GB of numbers and may take 1.5 GB.
const SHARE: f64 = 1.5 / 1.28;

/// The most memory that this process had, bytes; where the system does not tell, the test is passed over.
fn peak() -> Option<f64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    line.split_whitespace().next()?.parse::<f64>().ok().map(|kib| 1024.0 * kib)
}

fn write(path: &Path) {
    let mut file = BufWriter::new(fs::File::create(path).expect("a file"));
    let names: Vec<&str> = Channel::ALL.iter().map(|c| c.name()).collect();
    writeln!(file, "time,{}", names.join(",")).expect("written");
    let mut line = String::new();
    for row in 0..ROWS {
        line.clear();
        let _ = write!(line, "{}", row as f64 / 500.0);
        for (k, channel) in Channel::ALL.iter().enumerate() {
            let _ = match channel {
                Channel::Trigger => write!(line, ",{}", u8::from(row % 40_000 < 25)),
                // Now and then a sample is lost.
                _ if row % 1000 == k => write!(line, ","),
                _ => write!(line, ",{}.{}", (row * (k + 7)) % 497, row % 9973),
            };
        }
        line.push('\n');
        file.write_all(line.as_bytes()).expect("written");
    }
    file.flush().expect("written");
    let sidecar =
        "layout = \"none.lss\"\nsensor_cart = 1\nspeed_setpoint = 2\ntrigger_position = 0\nlowpass = 100\nlaps = 10\n";
    fs::write(path.with_extension("toml"), sidecar).expect("written");
}

#[test]
fn a_long_run_takes_little_more_memory_than_its_numbers() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.csv");
    write(&path);
    let Some(before) = peak() else {
        eprintln!("passed over: this system does not tell a process's memory");
        return;
    };
    let run = Run::read(&path).expect("a run");
    let told = health(&run, None);
    assert_eq!((told.samples, told.edges, told.lost), (ROWS, 9, 14 * ROWS / 1000));
    assert_eq!(told.bridged, told.lost - 1, "the first sample of a channel has none before it");
    let numbers = (8 * ROWS * (1 + Channel::ALL.len())) as f64;
    let used = peak().expect("as before") - before;
    // Buffers are of a fixed size.
    assert!(used < SHARE * numbers + 8e6, "{:.0} MB for {:.0} MB of numbers", used / 1e6, numbers / 1e6);
}
