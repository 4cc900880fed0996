//! Reading long runs: `cargo bench --bench runs` makes one of 10 million rows and 16 columns in the folder for
//! temporary files, reads it as CSV, MDF4 and Parquet in a process of its own each, and prints megabytes a second and
//! the most memory that was used. `cargo bench --bench runs -- ROWS` takes another length.

#![allow(clippy::expect_used, clippy::unwrap_used)]

#[path = "../tests/support/mdf4.rs"]
mod mdf4;

use lss::signal::health::health;
use lss::signal::{Channel, Run, parquet};
use std::fmt::Write as _;
use std::fs;
use std::io::{BufWriter, Write};
use std::path::Path;
use std::process::Command;
use std::time::Instant;

const ROWS: usize = 10_000_000;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    match &arguments[..] {
        [verb, path] if verb == "read" => read(Path::new(path)),
        [verb, path] if verb == "convert" => convert(Path::new(path)),
        [rows] => all(rows.parse().expect("a number of rows")),
        _ => all(ROWS),
    }
}

fn all(rows: usize) {
    let folder = std::env::temp_dir().join(format!("lss-bench-runs-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("a folder");
    let path = folder.join("run.csv");
    write(&path, rows);
    fs::write(path.with_extension("toml"), SIDECAR).expect("written");
    let again = |verb: &str, path: &Path| {
        let this = std::env::current_exe().expect("this program");
        let done = Command::new(this).arg(verb).arg(path).status().expect("it runs");
        assert!(done.success(), "{verb} {}", path.display());
    };
    println!("{rows} rows of {} columns", 1 + Channel::ALL.len());
    again("read", &path);
    again("convert", &path);
    fs::remove_file(&path).expect("removed");
    again("read", &path.with_extension("parquet"));
    fs::remove_file(path.with_extension("parquet")).expect("removed");
    let path = path.with_extension("mf4");
    write_mdf4(&path, rows);
    again("read", &path);
    fs::remove_dir_all(&folder).expect("removed");
}

const SIDECAR: &str =
    "layout = \"none.lss\"\nsensor_cart = 1\nspeed_setpoint = 2\ntrigger_position = 0\nlowpass = 100\nlaps = 100\n";

/// Seven digits a number, as `lss simulate` writes them.
fn write(path: &Path, rows: usize) {
    let mut file = BufWriter::with_capacity(1 << 20, fs::File::create(path).expect("a file"));
    let names: Vec<&str> = Channel::ALL.iter().map(|c| c.name()).collect();
    writeln!(file, "time,{}", names.join(",")).expect("written");
    let (mut state, mut line) = (1_u64, String::new());
    for row in 0..rows {
        line.clear();
        let _ = write!(line, "{}", row as f64 / 500.0);
        for channel in Channel::ALL {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let _ = match channel {
                Channel::Trigger => write!(line, ",{}", u8::from(row % 40_000 < 25)),
                _ => write!(line, ",{}.{:04}", state >> 55, (state >> 32) % 10_000),
            };
        }
        line.push('\n');
        file.write_all(line.as_bytes()).expect("written");
    }
    file.flush().expect("written");
}

fn write_mdf4(path: &Path, rows: usize) {
    let names: Vec<&str> = std::iter::once("time").chain(Channel::ALL.iter().map(|c| c.name())).collect();
    let file = BufWriter::with_capacity(1 << 20, fs::File::create(path).expect("a file"));
    mdf4::write(file, &names, rows, |row, numbers| {
        numbers[0] = row as f64 / 500.0;
        for (k, (channel, number)) in Channel::ALL.iter().zip(&mut numbers[1..]).enumerate() {
            *number = match channel {
                Channel::Trigger => f64::from(u8::from(row % 40_000 < 25)),
                _ => ((row * (k + 7)) % 497) as f64 + (row % 9973) as f64 / 1e4,
            };
        }
    });
}

fn read(path: &Path) {
    let size = fs::metadata(path).expect("a file").len() as f64;
    let begin = Instant::now();
    let run = Run::read(path).expect("a run");
    let seconds = begin.elapsed().as_secs_f64();
    let numbers = 8.0 * run.time.len() as f64 * (1 + run.channels.len()) as f64;
    let name = path.extension().unwrap_or_default().to_string_lossy().into_owned();
    println!(
        "{name}: {:.0} MB of file, {:.0} MB of numbers: {seconds:.1} s, {:.0} MB/s of file, peak {:.0} MB",
        size / 1e6,
        numbers / 1e6,
        size / 1e6 / seconds,
        peak() / 1e6
    );
    let begin = Instant::now();
    let health = health(&run, None);
    println!(
        "  at a glance: {:.1} s, {} edges, peak {:.0} MB",
        begin.elapsed().as_secs_f64(),
        health.edges,
        peak() / 1e6
    );
}

fn convert(path: &Path) {
    let run = Run::read(path).expect("a run");
    fs::write(path.with_extension("parquet"), parquet::write(&run).expect("columns")).expect("written");
}

/// The most memory that this process had, bytes; 0 where the system does not tell.
fn peak() -> f64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    line.and_then(|l| l.split_whitespace().next()?.parse::<f64>().ok()).map_or(0.0, |kib| 1024.0 * kib)
}
