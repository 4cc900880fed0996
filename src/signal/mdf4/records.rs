//! Records: what the channels of a group measured at one time, side by side.

use super::blocks::{Block, Blocks, Recorded};
use super::{DataProblem, Torn};
use std::collections::BTreeMap;
use std::io::{Read, Seek};

pub const MASTER: u8 = 2;
pub const VIRTUAL_MASTER: u8 = 3;
const FIXED: u8 = 0;
const VIRTUAL: u8 = 6;

/// The records of a channel group.
pub struct Records {
    /// The address of the group's first channel.
    pub first_channel: u64,
    /// How many there are.
    pub count: u64,
    /// Bytes of the channels, then of the invalidation bits.
    data: usize,
    invalid: usize,
    /// Where the data group's blocks begin: of data, and of groups.
    recorded: u64,
    groups: u64,
    /// Bytes of the mark before each record, 0 where one group has all, and this group's.
    mark: u8,
    id: u64,
}

/// A channel group whose records hold one value of any length each.
const VARIABLE: u16 = 1;

/// Bytes of records that are held at a time.
const HELD: usize = 1 << 20;

impl Records {
    /// Of all groups of a file.
    pub fn all<R: Read + Seek>(blocks: &Blocks<R>) -> Result<Vec<Records>, Torn> {
        let mut all = Vec::new();
        for home in blocks.chain(blocks.header()?.link(0), b"##DG")? {
            for group in blocks.chain(home.link(1), b"##CG")? {
                let layout = layout(&group).ok_or("a channel group is torn")?;
                if !layout.variable {
                    all.push(Records {
                        first_channel: group.link(1),
                        count: layout.count,
                        data: layout.data,
                        invalid: layout.invalid,
                        recorded: home.link(2),
                        groups: home.link(1),
                        mark: home.u8(0).unwrap_or(u8::MAX),
                        id: layout.id,
                    });
                }
            }
        }
        Ok(all)
    }

    /// Bytes of one record.
    fn size(&self) -> usize {
        self.data + self.invalid
    }

    /// Gives the records to `take` in their order, many at a time, one behind the other.
    fn each<R: Read + Seek>(&self, blocks: &Blocks<R>, mut take: impl FnMut(&[u8])) -> Result<(), Torn> {
        let mut recorded = blocks.recorded(self.recorded)?;
        let size = self.size();
        let torn = || "the data end before the last record".to_owned();
        let all = self.count.checked_mul(size as u64).ok_or_else(torn)?;
        // Records without a byte, of channels that are only counted, would have no end.
        if recorded.left() < all || size == 0 {
            return Err(torn());
        }
        if self.mark != 0 {
            return self.sorted(blocks, recorded, take);
        }
        let mut held = vec![0; (HELD / size).max(1) * size];
        let mut left = all;
        while left > 0 {
            let next = usize::try_from(left).unwrap_or(usize::MAX).min(held.len());
            if recorded.read(&mut held[..next])? < next {
                return Err(torn());
            }
            take(&held[..next]);
            left -= next as u64;
        }
        Ok(())
    }

    /// This group's records of those of several groups, each behind its mark.
    fn sorted<R: Read + Seek>(
        &self,
        blocks: &Blocks<R>,
        recorded: Recorded<R>,
        mut take: impl FnMut(&[u8]),
    ) -> Result<(), Torn> {
        let mut layouts = BTreeMap::new();
        for group in blocks.chain(self.groups, b"##CG")? {
            let layout = layout(&group).ok_or("a channel group is torn")?;
            layouts.insert(layout.id, layout);
        }
        if !matches!(self.mark, 1 | 2 | 4 | 8) {
            return Err("records are marked in an unknown way".to_owned());
        }
        let mut rest = Window::new(recorded);
        let mut left = self.count;
        while left > 0 {
            let Some(mark) = rest.next(usize::from(self.mark))? else { break };
            let id = mark.iter().rev().fold(0, |id, &b| id << 8 | u64::from(b));
            let layout = layouts.get(&id).ok_or("a record belongs to no group")?;
            let size = if layout.variable {
                match rest.next(4)?.and_then(|size| size.first_chunk::<4>()) {
                    Some(size) => u64::from(u32::from_le_bytes(*size)),
                    None => break,
                }
            } else {
                (layout.data + layout.invalid) as u64
            };
            if id == self.id {
                let Some(record) = rest.next(self.size())? else { break };
                take(record);
                left -= 1;
            } else if !rest.skip(size)? {
                break;
            }
        }
        if left > 0 { Err("the data end before the last record".to_owned()) } else { Ok(()) }
    }
}

/// What is recorded, a few bytes at a time.
struct Window<'a, R> {
    recorded: Recorded<'a, R>,
    held: Vec<u8>,
    at: usize,
}

impl<'a, R: Read + Seek> Window<'a, R> {
    fn new(recorded: Recorded<'a, R>) -> Self {
        Window { recorded, held: Vec::new(), at: 0 }
    }

    /// The next bytes, if so many are left.
    fn next(&mut self, size: usize) -> Result<Option<&[u8]>, Torn> {
        if self.held.len() - self.at < size {
            self.held.drain(..self.at);
            self.at = 0;
            let there = self.held.len();
            // What is longer than the file can hold is not asked for.
            let wanted =
                size.max(HELD).min(there.saturating_add(usize::try_from(self.recorded.left()).unwrap_or(usize::MAX)));
            self.held.resize(wanted.max(there), 0);
            let read = self.recorded.read(&mut self.held[there..])?;
            self.held.truncate(there + read);
        }
        let found = self.held.get(self.at..self.at + size);
        self.at += found.map_or(0, <[u8]>::len);
        Ok(found)
    }

    /// Passes bytes over; false when fewer are left.
    fn skip(&mut self, mut size: u64) -> Result<bool, Torn> {
        while size > 0 {
            let part = usize::try_from(size).unwrap_or(usize::MAX).min(HELD);
            if self.next(part)?.is_none() {
                return Ok(false);
            }
            size -= part as u64;
        }
        Ok(true)
    }
}

/// What a channel group says of its records.
struct Layout {
    id: u64,
    count: u64,
    data: usize,
    invalid: usize,
    variable: bool,
}

fn layout(group: &Block) -> Option<Layout> {
    Some(Layout {
        id: group.u64(0)?,
        count: group.u64(8)?,
        data: group.u32(24)? as usize,
        invalid: group.u32(28)? as usize,
        variable: group.u16(16)? & VARIABLE != 0,
    })
}

/// How a channel's value stands in a record.
struct Field {
    kind: u8,
    number: u8,
    byte: usize,
    bit: u32,
    bits: u32,
    flags: u32,
    invalid_bit: usize,
}

fn field(channel: &Block) -> Option<Field> {
    Some(Field {
        kind: channel.u8(0)?,
        number: channel.u8(2)?,
        bit: u32::from(channel.u8(3)?),
        byte: channel.u32(4)? as usize,
        bits: channel.u32(8)?,
        flags: channel.u32(12)?,
        invalid_bit: channel.u32(16)? as usize,
    })
}

/// A channel whose samples can be read from records.
pub struct Reader {
    field: Field,
    convert: Conversion,
    /// The bytes of a record in which a number stands; none of one that is only counted.
    bytes: Option<std::ops::Range<usize>>,
    /// The byte and the bit that say whether a sample is lost, where the channel has them.
    lost: Option<(usize, usize)>,
    samples: Vec<f64>,
}

impl Reader {
    /// # Errors
    ///
    /// When the channel is no number, or lies outside its records.
    pub fn new<R: Read + Seek>(blocks: &Blocks<R>, channel: &Block, records: &Records) -> Result<Reader, DataProblem> {
        let torn = || DataProblem::Malformed("the channel lies outside its records".to_owned());
        let field = field(channel).ok_or_else(torn)?;
        if channel.link(1) != 0 {
            return Err(DataProblem::NotANumber("an array or a structure".to_owned()));
        }
        if field.number > 5 || !matches!(field.kind, FIXED | MASTER | VIRTUAL_MASTER | VIRTUAL) {
            return Err(DataProblem::NotANumber("text or bytes".to_owned()));
        }
        let convert = conversion(blocks, channel.link(4)).map_err(DataProblem::Malformed)?;
        let counted = matches!(field.kind, VIRTUAL_MASTER | VIRTUAL);
        let float = matches!(field.number, 4 | 5);
        if !counted && (field.bits == 0 || field.bits > 64 || field.bit > 7 || float && !matches!(field.bits, 32 | 64))
        {
            return Err(DataProblem::Malformed(format!("numbers of {} bits are not known", field.bits)));
        }
        let within = |from: usize, size: usize, end: usize| {
            from.checked_add(size).filter(|&to| to <= end).map(|to| from..to).ok_or_else(torn)
        };
        let width = (field.bit + field.bits).div_ceil(8) as usize;
        let bytes = if counted { None } else { Some(within(field.byte, width, records.data)?) };
        let lost = match field.flags & 3 {
            2 => {
                let byte = within(field.invalid_bit / 8, 1, records.invalid)?.start;
                Some((records.data + byte, field.invalid_bit % 8))
            }
            _ => None,
        };
        Ok(Reader { field, convert, bytes, lost, samples: Vec::new() })
    }

    /// Appends the samples of records that stand one behind the other: in the channel's unit, NaN where one is lost.
    fn read(&mut self, records: &[u8], size: usize) {
        let Reader { field, convert, bytes, lost, samples } = self;
        let first = samples.len();
        samples.extend(records.chunks_exact(size).enumerate().map(|(i, record)| {
            let valid = field.flags & 1 == 0
                && lost.is_none_or(|(byte, bit)| record.get(byte).is_some_and(|b| b >> bit & 1 == 0));
            let raw = match bytes {
                Some(bytes) => record.get(bytes.clone()).map_or(f64::NAN, |bytes| number(bytes, field)),
                None => (first + i) as f64,
            };
            if valid { convert.physical(raw) } else { f64::NAN }
        }));
    }
}

/// The samples of channels, from one passage through the group's records.
pub fn samples<R: Read + Seek>(
    blocks: &Blocks<R>,
    records: &Records,
    mut channels: Vec<Reader>,
) -> Result<Vec<Vec<f64>>, Torn> {
    let count = usize::try_from(records.count).unwrap_or(usize::MAX);
    records.each(blocks, |bytes| {
        for channel in &mut channels {
            // Only now is it known that the file holds so many; grown by doubling, they would take up to twice as much.
            if channel.samples.is_empty() {
                channel.samples.reserve_exact(count);
            }
            channel.read(bytes, records.size());
        }
    })?;
    Ok(channels.into_iter().map(|channel| channel.samples).collect())
}

/// A number of up to 64 bits in up to nine bytes.
fn number(bytes: &[u8], field: &Field) -> f64 {
    let join = |bits: u128, &b: &u8| bits << 8 | u128::from(b);
    // Odd kinds are big-endian.
    let bits =
        if field.number.is_multiple_of(2) { bytes.iter().rev().fold(0, join) } else { bytes.iter().fold(0, join) }
            >> field.bit;
    let bits = (bits as u64) << (64 - field.bits);
    match field.number {
        0 | 1 => (bits >> (64 - field.bits)) as f64,
        2 | 3 => (bits as i64 >> (64 - field.bits)) as f64,
        _ if field.bits == 32 => f64::from(f32::from_bits((bits >> 32) as u32)),
        _ => f64::from_bits(bits),
    }
}

/// How a number in a record becomes one in the channel's unit.
enum Conversion {
    None,
    /// a + b x
    Linear(f64, f64),
    /// (a x² + b x + c) / (d x² + e x + f)
    Rational([f64; 6]),
}

fn conversion<R: Read + Seek>(blocks: &Blocks<R>, address: u64) -> Result<Conversion, Torn> {
    if address == 0 {
        return Ok(Conversion::None);
    }
    let block = blocks.block(address, b"##CC")?;
    let value = |i: usize| block.f64(24 + 8 * i).ok_or_else(|| "a conversion is torn".to_owned());
    match block.u8(0) {
        Some(0) => Ok(Conversion::None),
        Some(1) => Ok(Conversion::Linear(value(0)?, value(1)?)),
        Some(2) => Ok(Conversion::Rational([value(0)?, value(1)?, value(2)?, value(3)?, value(4)?, value(5)?])),
        _ => Err("its conversion is neither linear nor rational".to_owned()),
    }
}

impl Conversion {
    fn physical(&self, x: f64) -> f64 {
        match *self {
            Conversion::None => x,
            Conversion::Linear(a, b) => a + b * x,
            Conversion::Rational([a, b, c, d, e, f]) => ((a * x + b) * x + c) / ((d * x + e) * x + f),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::super::Channel;
    use std::path::Path;

    /// Appends a block and tells its address.
    fn block(file: &mut Vec<u8>, kind: &str, links: &[u64], data: &[u8]) -> u64 {
        let address = file.len() as u64;
        file.extend_from_slice(kind.as_bytes());
        file.extend_from_slice(&[0; 4]);
        for n in [24 + 8 * links.len() as u64 + data.len() as u64, links.len() as u64].iter().chain(links) {
            file.extend_from_slice(&n.to_le_bytes());
        }
        file.extend_from_slice(data);
        file.resize(file.len().next_multiple_of(8), 0);
        address
    }

    /// A channel: kind, number, bit, byte, bits.
    fn channel(file: &mut Vec<u8>, next: u64, name: &str, [kind, number, bit, byte, bits]: [u8; 5]) -> u64 {
        let name = block(file, "##TX", &[], name.as_bytes());
        let mut data = vec![kind, 0, number, bit, byte, 0, 0, 0, bits, 0, 0, 0];
        data.resize(72, 0);
        block(file, "##CN", &[next, 0, name, 0, 0, 0, 0, 0], &data)
    }

    fn group(file: &mut Vec<u8>, next: u64, first: u64, [id, count, flags, bytes]: [u8; 4]) -> u64 {
        let mut data = [0; 32];
        (data[0], data[8], data[16], data[24]) = (id, count, flags, bytes);
        block(file, "##CG", &[next, first, 0, 0, 0, 0], &data)
    }

    /// As a logger writes while it records: groups mixed, one of them text of any length; numbers between bytes, and a
    /// master that is counted.
    #[test]
    fn mixed_records_and_odd_bits_are_read() {
        let mut file = b"MDF     4.10    lss     \0\0\0\0\x9a\x01".to_vec();
        file.resize(64 + 24 + 48, 0);
        let trigger = channel(&mut file, 0, "trigger", [0, 0, 7, 1, 1]);
        let force = channel(&mut file, trigger, "steer_left", [0, 3, 3, 0, 12]);
        let time = channel(&mut file, force, "time", [3, 0, 0, 0, 0]);
        let text = group(&mut file, 0, 0, [2, 2, 1, 0]);
        let own = group(&mut file, text, time, [1, 3, 0, 2]);
        // Big-endian: twelve bits from the fourth on, then the trigger is the highest bit of the second byte.
        let records = [-1_i16, 1000, -2048].map(|x| ((x & 0xfff) << 3).to_be_bytes());
        let mut data = vec![1, records[0][0], records[0][1], 2, 3, 0, 0, 0, 1, 1, 1];
        data.extend([1, records[1][0], records[1][1], 2, 0, 0, 0, 0, 1, records[2][0], records[2][1]]);
        let parts = [&data[..5], &data[5..]].map(|part| block(&mut file, "##DT", &[], part));
        let list = block(&mut file, "##DL", &[0, parts[0], parts[1]], &[0; 16]);
        let home = block(&mut file, "##DG", &[0, own, list, 0], &[1, 0, 0, 0, 0, 0, 0, 0]);
        let mut header = Vec::new();
        block(&mut header, "##HD", &[home, 0, 0], &[]);
        file[64..64 + header.len()].copy_from_slice(&header);
        let (time, channels) = super::super::read(std::io::Cursor::new(file), Path::new("run.mf4")).expect("a run");
        assert_eq!(time, [0.0, 1.0, 2.0]);
        assert_eq!(channels[&Channel::SteerLeft], [-1.0, 1000.0, -2048.0]);
        assert_eq!(channels[&Channel::Trigger], records.map(|r| f64::from(r[1] >> 7)));
    }

    /// Each of the blocks is within the limit, and takes some bytes of the file.
    #[test]
    fn blocks_that_unpack_to_more_than_the_limit_are_refused() {
        let mut file = b"MDF     4.10    lss     \0\0\0\0\x9a\x01".to_vec();
        file.resize(64 + 24 + 48, 0);
        let time = channel(&mut file, 0, "time", [2, 4, 0, 0, 64]);
        let joint = channel(&mut file, time, "joint_xi", [0, 4, 0, 0, 64]);
        let own = group(&mut file, 0, joint, [0, 100, 0, 8]);
        let mut packed = [0; 24];
        packed[8..16].copy_from_slice(&(64_u64 << 20).to_le_bytes());
        let links: Vec<u64> =
            std::iter::once(0).chain((0..65).map(|_| block(&mut file, "##DZ", &[], &packed))).collect();
        let list = block(&mut file, "##DL", &links, &[0; 16]);
        let home = block(&mut file, "##DG", &[0, own, list, 0], &[0; 8]);
        let mut header = Vec::new();
        block(&mut header, "##HD", &[home, 0, 0], &[]);
        file[64..64 + header.len()].copy_from_slice(&header);
        let told = super::super::read(std::io::Cursor::new(file), Path::new("run.mf4")).expect_err("too large");
        assert!(told.to_string().contains("its compressed blocks hold more than 4096 MiB"), "{told}");
    }
}
