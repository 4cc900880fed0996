//! Reading a long run takes little more memory than its numbers, as CSV and as MDF4. Each is read in a process of its
//! own, whose peak is its own.

#![allow(clippy::expect_used, clippy::unwrap_used)]

#[path = "../support/mdf4.rs"]
mod mdf4;

use lss::signal::health::health;
use lss::signal::{Channel, Run};
use std::fmt::Write as _;
use std::fs;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::process::Command;

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
    fs::write(path.with_extension("toml"), SIDECAR).expect("written");
}

/// The same samples.
fn write_mdf4(path: &Path) {
    let names: Vec<&str> = std::iter::once("time").chain(Channel::ALL.iter().map(|c| c.name())).collect();
    let file = BufWriter::new(fs::File::create(path).expect("a file"));
    mdf4::write(file, &names, ROWS, |row, numbers| {
        numbers[0] = row as f64 / 500.0;
        for (k, (channel, number)) in Channel::ALL.iter().zip(&mut numbers[1..]).enumerate() {
            *number = match channel {
                Channel::Trigger => f64::from(u8::from(row % 40_000 < 25)),
                _ if row % 1000 == k => f64::NAN,
                _ => ((row * (k + 7)) % 497) as f64 + (row % 9973) as f64 / 1e4,
            };
        }
    });
    fs::write(path.with_extension("toml"), SIDECAR).expect("written");
}

const SIDECAR: &str =
    "layout = \"none.lss\"\nsensor_cart = 1\nspeed_setpoint = 2\ntrigger_position = 0\nlowpass = 100\nlaps = 10\n";

#[test]
fn a_long_run_takes_little_more_memory_than_its_numbers() {
    let folder = tempfile::tempdir().expect("a folder");
    let (csv, mdf4) = (folder.path().join("run.csv"), folder.path().join("same.mf4"));
    write(&csv);
    write_mdf4(&mdf4);
    for path in [csv, mdf4] {
        let this = std::env::current_exe().expect("this program");
        let arguments = ["long_runs::read_one", "--exact", "--ignored", "--nocapture"];
        let done = Command::new(this).args(arguments).env("LSS_TEST_RUN", &path).status().expect("it runs");
        assert!(done.success(), "{}", path.display());
    }
}

#[test]
#[ignore = "a part of the test above, in a process of its own"]
fn read_one() {
    let Some(path) = std::env::var_os("LSS_TEST_RUN") else { return };
    let Some(before) = peak() else {
        eprintln!("passed over: this system does not tell a process's memory");
        return;
    };
    let run = Run::read(Path::new(&path)).expect("a run");
    let told = health(&run, None);
    assert_eq!((told.samples, told.edges, told.lost), (ROWS, 9, 14 * ROWS / 1000));
    assert_eq!(told.bridged, told.lost - 1, "the first sample of a channel has none before it");
    let numbers = (8 * ROWS * (1 + Channel::ALL.len())) as f64;
    let used = peak().expect("as before") - before;
    println!("{}: {:.0} MB for {:.0} MB of numbers", path.display(), used / 1e6, numbers / 1e6);
    // Buffers are of a fixed size.
    assert!(used < SHARE * numbers + 8e6, "{:.0} MB for {:.0} MB of numbers", used / 1e6, numbers / 1e6);
}
