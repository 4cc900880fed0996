//! Seeds of each untrusted format with random edits of their bytes hold what the fuzz targets ask. Without coverage to guide
//! them they find less than libFuzzer does, and they run with every `cargo test`.

use proptest::prelude::*;
use std::fs;
use std::path::Path;

#[path = "../../fuzz/src/lib.rs"]
mod formats;

/// What ends a number, a string or a length that a reader trusts.
const PIECES: [&[u8]; 16] = [
    b"",
    b"0",
    b"-1",
    b"1e308",
    b"1e999",
    b"NaN",
    b"4294967296",
    b"\"",
    b",",
    b"\n",
    b"[[",
    b"{",
    b"\xff\xff\xff\xff",
    b"\0\0\0\0\0\0\0\x80",
    b"\xc3",
    b"\xe2\x80\xa8",
];

/// The seeds of a format: its folder of the fuzz targets, or every layout where it has none.
fn seeds(format: &str) -> Vec<Vec<u8>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let own = root.join("fuzz/seeds").join(format);
    let folders = if own.exists() { vec![own] } else { vec![root.join("examples"), root.join("stdlib")] };
    let mut files: Vec<_> = folders
        .iter()
        .flat_map(|folder| {
            fs::read_dir(folder).expect("a folder of seeds").map(|entry| entry.expect("an entry").path())
        })
        .filter(|file| file.is_file())
        .collect();
    files.sort();
    files.iter().map(|file| fs::read(file).expect("a seed")).collect()
}

/// One edit: where, how much of the file (as a share of what is left, squared so that short ones are likely), what, and by what.
type Edit = (prop::sample::Index, f64, u8, usize);

fn edit(bytes: &mut Vec<u8>, (at, share, what, piece): Edit) {
    let from = at.index(bytes.len() + 1);
    let to = from + ((bytes.len() - from) as f64 * share * share) as usize;
    let piece = PIECES[piece];
    match what {
        0 => drop(bytes.splice(from..to, piece.iter().copied())),
        1 => drop(bytes.splice(from..from, piece.iter().copied())),
        2 => bytes.extend_from_within(from..to),
        3 => bytes.truncate(from),
        4 => bytes[from..to].reverse(),
        _ => bytes[from..to].iter_mut().take(1).for_each(|byte| *byte = byte.wrapping_add(share.to_bits() as u8 | 1)),
    }
}

/// Asks it of `cases` seeds with up to six edits each.
fn holds(format: &str, cases: u32, ask: impl Fn(&[u8])) {
    let seeds = seeds(format);
    let edits = prop::collection::vec((any::<prop::sample::Index>(), 0.0..1.0, 0..6u8, 0..PIECES.len()), 1..7);
    proptest!(ProptestConfig::with_cases(cases), |(seed in 0..seeds.len(), edits in edits)| {
        let mut bytes = seeds[seed].clone();
        edits.into_iter().for_each(|how| edit(&mut bytes, how));
        ask(&bytes);
    });
}

/// The same of a format that is text; what is none there is read as far as it is.
fn holds_of_text(format: &str, cases: u32, ask: impl Fn(&str)) {
    holds(format, cases, |bytes| ask(&String::from_utf8_lossy(bytes)));
}

#[test]
fn layouts() {
    holds_of_text("parse", 10_000, formats::parse);
    holds("front_end", 2_000, formats::front_end);
}

#[test]
fn answers_of_models_outside() {
    holds_of_text("answers", 10_000, formats::answers);
}

#[test]
fn campaigns_and_studies() {
    holds("campaign", 10_000, formats::campaign);
    holds_of_text("study", 10_000, formats::study);
}

#[test]
fn drawings() {
    holds_of_text("dxf", 2_000, formats::dxf);
}

#[test]
fn records() {
    holds("csv", 10_000, formats::csv);
    holds("mdf4", 10_000, formats::mdf4);
    holds("parquet", 10_000, formats::parquet);
}

#[test]
fn inputs_of_simulations() {
    holds("simulation", 3_000, formats::simulation);
}
