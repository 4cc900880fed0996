//! Runs as MDF4 (ASAM MDF 4.x), as measuring systems write it: groups of channels over a time master each.
//!
//! What is read: records sorted or not, in one block or in lists of them, plain or compressed (deflate, transposed or
//! not); integers and floats of either byte order, at any bit; conversions that are linear or rational; invalidation
//! bits, which make a lost sample; masters that are written or counted. Blocks are laid out as the ASAM MDF standard,
//! version 4.1, describes them in its chapter on block types.
//!
//! This reader is the project's own: the crates for MDF4 that read compressed data allocate what a length field asks
//! for, so that one wrong byte aborts the process. Here every access is checked, and no more is allocated than the file
//! can fill.

mod blocks;
mod records;

use super::columns::Columns;
use super::mapping::Mapping;
use super::{Channel, DataProblem, RunError, columns};
use blocks::{Block, Blocks};
use records::{Reader, Records};
use std::collections::BTreeMap;
use std::io::{Read, Seek};
use std::path::Path;

/// Why bytes are no MDF4 that can be read.
type Torn = String;

/// A group of channels that were sampled together.
struct Group {
    records: Records,
    time: Option<Block>,
    channels: Vec<(Channel, Block)>,
}

/// Reads a data file; `file` is named in errors. A channel called `time`, `t` or `timestamp`, or the master, is time;
/// the others are known by their names and have their units, if they name any.
///
/// # Errors
///
/// The first of what [`DataProblem`] lists, with the number of the sample and the channel.
/// [`DataProblem::OtherTimeBase`] for a channel outside the group that holds most, unless its times are the same ones:
/// to resample would be to guess.
pub fn read<R: Read + Seek>(data: R, file: &Path) -> Result<Columns, RunError> {
    read_mapped(data, file, &Mapping::default())
}

/// The same with channels as a sidecar says.
///
/// # Errors
///
/// As [`read`].
pub fn read_mapped<R: Read + Seek>(data: R, file: &Path, mapping: &Mapping) -> Result<Columns, RunError> {
    let torn = |why: Torn| RunError::new(file, DataProblem::Malformed(why));
    let blocks = Blocks::new(data).map_err(torn)?;
    let mut groups = Vec::new();
    let mut taken = Vec::new();
    for records in Records::all(&blocks).map_err(torn)? {
        let group = group(&blocks, records, &mut taken, (file, mapping))?;
        if !group.channels.is_empty() {
            groups.push(group);
        }
    }
    // The first of those that hold most.
    groups.sort_by_key(|group| std::cmp::Reverse(group.channels.len()));
    let mut base: Option<Vec<f64>> = None;
    let mut channels: BTreeMap<Channel, Vec<f64>> = BTreeMap::new();
    for group in &groups {
        let Some((first, _)) = group.channels.first() else { continue };
        let at = |problem| RunError::new(file, problem).column(first.name());
        let rows = usize::try_from(group.records.count).unwrap_or(usize::MAX);
        columns::room(rows, taken.len() + 1, columns::MOST_NUMBERS).map_err(at)?;
        let Some(time) = &group.time else {
            return Err(at(DataProblem::Malformed("its group has no channel of time".to_owned())));
        };
        let reader = |channel: &Block, name| {
            Reader::new(&blocks, channel, &group.records).map_err(|problem| RunError::new(file, problem).column(name))
        };
        let mut readers = vec![reader(time, "time")?];
        for (channel, block) in &group.channels {
            readers.push(reader(block, channel.name())?);
        }
        let read = records::samples(&blocks, &group.records, readers);
        let mut columns = read.map_err(|why| torn(why).column(first.name()))?.into_iter();
        let time = columns.next().unwrap_or_default();
        match &base {
            Some(base) if !same(base, &time) => return Err(at(DataProblem::OtherTimeBase)),
            Some(_) => {}
            None => base = Some(time),
        }
        channels.extend(group.channels.iter().map(|(channel, _)| *channel).zip(columns));
    }
    let time = base.ok_or_else(|| RunError::new(file, DataProblem::TooFewSamples))?;
    columns::check(&time, &channels, file, 1)?;
    let mut columns = (time, channels);
    mapping.scale(&mut columns);
    columns::check_trigger(&columns.1, file, 1)?;
    Ok(columns)
}

/// Tells a group's channels by their names; those of groups before it are `taken`.
fn group<R: Read + Seek>(
    blocks: &Blocks<R>,
    records: Records,
    taken: &mut Vec<Channel>,
    (file, mapping): (&Path, &Mapping),
) -> Result<Group, RunError> {
    let torn = |why: Torn| RunError::new(file, DataProblem::Malformed(why));
    let mut group = Group { records, time: None, channels: Vec::new() };
    let mut named = None;
    for block in blocks.chain(group.records.first_channel, b"##CN").map_err(torn)? {
        let name = blocks.text(block.link(2)).map_err(torn)?;
        let at = |problem| RunError::new(file, problem).column(&name);
        let master = matches!(block.u8(0), Some(records::MASTER | records::VIRTUAL_MASTER));
        let is_time = mapping.is_time(&name, &["time", "t", "timestamp"]);
        if master || is_time {
            if !mapping.says(&name) {
                unit(blocks, &block, "s").map_err(at)?;
            }
            // A master goes before a channel that is only called so.
            let place = if master { &mut group.time } else { &mut named };
            if place.replace(block).is_some() {
                return Err(at(DataProblem::DuplicateColumn));
            }
            continue;
        }
        let Some(channel) = mapping.pick(&name, taken).map_err(at)? else { continue };
        if channel != Channel::Trigger && !mapping.says(&name) {
            unit(blocks, &block, channel.unit()).map_err(at)?;
        }
        taken.push(channel);
        group.channels.push((channel, block));
    }
    group.time = group.time.or(named);
    Ok(group)
}

/// That a channel's unit, when it or its conversion names one, is this.
fn unit<R: Read + Seek>(blocks: &Blocks<R>, channel: &Block, expected: &'static str) -> Result<(), DataProblem> {
    let mut found = blocks.text(channel.link(6)).map_err(DataProblem::Malformed)?;
    if found.is_empty() && channel.link(4) != 0 {
        let conversion = blocks.block(channel.link(4), b"##CC").map_err(DataProblem::Malformed)?;
        found = blocks.text(conversion.link(1)).map_err(DataProblem::Malformed)?;
    }
    let same = match (expected, found.as_str()) {
        (_, "") | ("°C", "degC" | "C") => true,
        (expected, found) => expected == found,
    };
    if same { Ok(()) } else { Err(DataProblem::OtherUnit { expected, found }) }
}

/// Whether two groups were sampled at the same times, to a nanosecond.
fn same(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len()
        && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-9 * a.abs().max(1.0) || a.is_nan() && b.is_nan())
}

#[cfg(test)]
mod tests {
    use super::super::csv;
    use super::*;

    const CSV: &[u8] = include_bytes!("../../../tests/fixtures/mdf4/run.csv");
    const PLAIN: &[u8] = include_bytes!("../../../tests/fixtures/mdf4/plain.mf4");
    const DEFLATED: &[u8] = include_bytes!("../../../tests/fixtures/mdf4/deflated.mf4");
    const TRANSPOSED: &[u8] = include_bytes!("../../../tests/fixtures/mdf4/transposed.mf4");

    const FRAGMENTS: &[u8] = include_bytes!("../../../tests/fixtures/mdf4/fragments.mf4");

    fn back(bytes: &[u8]) -> Result<Columns, RunError> {
        read(std::io::Cursor::new(bytes), Path::new("run.mf4"))
    }

    /// Columns in bits, with one NaN for all.
    fn bits((time, channels): Columns) -> (Vec<u64>, BTreeMap<Channel, Vec<u64>>) {
        let bits = |x: Vec<f64>| x.into_iter().map(|x| if x.is_nan() { 0 } else { (x + 0.0).to_bits() + 1 }).collect();
        (bits(time), channels.into_iter().map(|(c, x)| (c, bits(x))).collect())
    }

    #[test]
    fn another_writers_files_say_the_same_as_csv() {
        let expected = bits(csv::read(CSV, Path::new("run.csv")).expect("a run"));
        assert_eq!(expected.1.len(), 5);
        for bytes in [PLAIN, DEFLATED, TRANSPOSED, FRAGMENTS] {
            assert_eq!(bits(back(bytes).expect("a run")), expected);
        }
        assert!(FRAGMENTS.windows(4).any(|w| w == b"##DL"));
        assert!(DEFLATED.windows(4).any(|w| w == b"##DZ") && !PLAIN.windows(4).any(|w| w == b"##DZ"));
    }

    /// The joint's force in mN, of the other sign, a wheel's that is another's, and one that is passed over.
    #[test]
    fn channels_are_what_a_sidecar_says() {
        let table = "time = { channel = \"time\", factor = 0.001 }\njoint_xi = { channel = \"joint_xi\", factor = -1000 }\nsteer_left = \"run_left\"\nsteer_right = false";
        let mapping = Mapping::new(&toml::from_str(table).expect("a table")).expect("channels");
        let read = |mapping| read_mapped(std::io::Cursor::new(PLAIN), Path::new("run.mf4"), mapping).expect("a run");
        let ((time, own), (plain_time, plain)) = (read(&mapping), read(&Mapping::default()));
        assert_eq!(
            own.keys().copied().collect::<Vec<_>>(),
            [Channel::RunLeft, Channel::JointXi, Channel::Temperature, Channel::Trigger]
        );
        for k in (0..time.len()).filter(|k| plain[&Channel::JointXi][*k].is_finite()) {
            assert_eq!(own[&Channel::JointXi][k], -1000.0 * plain[&Channel::JointXi][k]);
        }
        assert_eq!(own[&Channel::RunLeft], plain[&Channel::SteerLeft]);
        assert_eq!(time[1], 0.001 * plain_time[1]);
        assert_eq!(mapping.unused(), None);
    }

    #[test]
    fn a_block_that_unpacks_to_more_than_the_limit_is_refused() {
        let mut bytes = DEFLATED.to_vec();
        let block = bytes.windows(4).position(|w| w == b"##DZ").expect("a compressed block");
        // What it holds unpacked.
        bytes[block + 32..block + 40].copy_from_slice(&(3_u64 << 30).to_le_bytes());
        let told = back(&bytes).expect_err("too large").to_string();
        assert!(told.contains("a compressed block holds more than 64 MiB"), "{told}");
    }

    #[test]
    fn mistakes_are_told_with_their_channel_and_a_way_out() {
        let cases: [(&[u8], &str); 6] = [
            (
                include_bytes!("../../../tests/fixtures/mdf4/rates.mf4"),
                "run.mf4, `temperature`: the channel is written in a group with another time base\n  \
                 help: export all channels with one rate, on one time base",
            ),
            (
                include_bytes!("../../../tests/fixtures/mdf4/foreign.mf4"),
                "run.mf4, `steer_lefd`: there is no such column\n  help: did you mean `steer_left`?",
            ),
            (
                include_bytes!("../../../tests/fixtures/mdf4/unit.mf4"),
                "run.mf4, `joint_xi`: the unit is kN, not N\n  help: export it in N",
            ),
            (
                include_bytes!("../../../tests/fixtures/mdf4/text.mf4"),
                "run.mf4, `trigger`: `text or bytes` is not a number",
            ),
            (CSV, "run.mf4: is malformed: this is not MDF\n  help: export the file again as MDF 4.x"),
            (b"UnFinMF 4.10    ", "run.mf4: is malformed: the recording was not finalised"),
        ];
        for (bytes, expected) in cases {
            let told = back(bytes).expect_err("a mistake").to_string();
            assert!(told.starts_with(expected), "{told}\n{expected}");
        }
    }

    /// A file cut off anywhere is refused, or what is lost is no part of the run.
    #[test]
    fn torn_files_are_refused() {
        for whole in [PLAIN, TRANSPOSED] {
            let expected = bits(back(whole).expect("a run"));
            for length in 0..whole.len() {
                match back(&whole[..length]) {
                    Ok(run) => assert_eq!(bits(run), expected, "cut at {length}"),
                    Err(error) => {
                        assert!(matches!(error.problem, DataProblem::Malformed(_)), "cut at {length}: {error}")
                    }
                }
            }
        }
    }

    /// Any byte may be wrong: that ends in an error or in other numbers, never in a panic, nor in memory without end.
    #[test]
    fn a_wrong_byte_is_no_panic() {
        for whole in [PLAIN, TRANSPOSED] {
            for i in 0..whole.len() {
                for wrong in [0x00, 0x55, 0xff] {
                    let mut bytes = whole.to_vec();
                    bytes[i] ^= wrong;
                    if let Ok((time, _)) = back(&bytes) {
                        assert!(time.len() <= 1000 * whole.len());
                    }
                }
            }
        }
    }
}
