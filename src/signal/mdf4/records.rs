//! Records: what the channels of a group measured at one time, side by side.

use super::blocks::{Block, Blocks};
use super::{Problem, Torn};
use std::borrow::Cow;
use std::collections::BTreeMap;

pub const MASTER: u8 = 2;
pub const VIRTUAL_MASTER: u8 = 3;
const FIXED: u8 = 0;
const VIRTUAL: u8 = 6;

/// The records of a channel group.
pub struct Records<'a> {
    /// The address of the group's first channel.
    pub first_channel: u64,
    /// How many there are.
    pub count: u64,
    /// Bytes of the channels, then of the invalidation bits.
    data: usize,
    invalid: usize,
    /// The block of the data group, and what its records are marked with when several groups share it.
    home: Block<'a>,
    id: u64,
}

/// A channel group whose records hold one value of any length each.
const VARIABLE: u16 = 1;

impl<'a> Records<'a> {
    /// Of all groups of a file.
    pub fn all(blocks: &Blocks<'a>) -> Result<Vec<Records<'a>>, Torn> {
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
                        home,
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

    /// The records, one behind the other.
    pub fn bytes(&self, blocks: &Blocks<'a>) -> Result<Cow<'a, [u8]>, Torn> {
        let torn = || "the data end before the last record".to_owned();
        let length = usize::try_from(self.count).ok().and_then(|n| n.checked_mul(self.size())).ok_or_else(torn)?;
        let mut bytes = blocks.recorded(self.home.link(2))?;
        if self.home.u8(0) != Some(0) {
            bytes = Cow::Owned(self.sorted(blocks, &bytes)?);
        }
        // Records without a byte, of channels that are only counted, would have no end.
        if bytes.len() < length || self.size() == 0 {
            return Err(torn());
        }
        Ok(match bytes {
            Cow::Borrowed(bytes) => Cow::Borrowed(&bytes[..length]),
            Cow::Owned(mut bytes) => {
                bytes.truncate(length);
                Cow::Owned(bytes)
            }
        })
    }

    /// This group's records of those of several groups, each behind its mark.
    fn sorted(&self, blocks: &Blocks, bytes: &[u8]) -> Result<Vec<u8>, Torn> {
        let mut layouts = BTreeMap::new();
        for group in blocks.chain(self.home.link(1), b"##CG")? {
            let layout = layout(&group).ok_or("a channel group is torn")?;
            layouts.insert(layout.id, layout);
        }
        let width = match self.home.u8(0) {
            Some(width @ (1 | 2 | 4 | 8)) => usize::from(width),
            _ => return Err("records are marked in an unknown way".to_owned()),
        };
        let (mut own, mut rest) = (Vec::new(), bytes);
        while let Some((mark, behind)) = rest.split_at_checked(width)
            && !mark.is_empty()
        {
            let id = mark.iter().rev().fold(0, |id, &b| id << 8 | u64::from(b));
            let layout = layouts.get(&id).ok_or("a record belongs to no group")?;
            let (size, behind) = match behind.first_chunk::<4>() {
                Some(size) if layout.variable => (u32::from_le_bytes(*size) as usize, &behind[4..]),
                _ => (layout.data + layout.invalid, behind),
            };
            let Some((record, behind)) = behind.split_at_checked(size) else { break };
            if id == self.id {
                own.extend_from_slice(record);
            }
            rest = behind;
        }
        Ok(own)
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

/// A channel's samples in its unit, NaN where one is invalid.
pub fn samples(blocks: &Blocks, channel: &Block, records: &Records, bytes: &[u8]) -> Result<Vec<f64>, Problem> {
    let torn = || Problem::Malformed("the channel lies outside its records".to_owned());
    let field = field(channel).ok_or_else(torn)?;
    if channel.link(1) != 0 {
        return Err(Problem::NotANumber("an array or a structure".to_owned()));
    }
    if field.number > 5 || !matches!(field.kind, FIXED | MASTER | VIRTUAL_MASTER | VIRTUAL) {
        return Err(Problem::NotANumber("text or bytes".to_owned()));
    }
    let convert = conversion(blocks, channel.link(4)).map_err(Problem::Malformed)?;
    let counted = matches!(field.kind, VIRTUAL_MASTER | VIRTUAL);
    let float = matches!(field.number, 4 | 5);
    if !counted && (field.bits == 0 || field.bits > 64 || field.bit > 7 || float && !matches!(field.bits, 32 | 64)) {
        return Err(Problem::Malformed(format!("numbers of {} bits are not known", field.bits)));
    }
    let width = (field.bit + field.bits).div_ceil(8) as usize;
    let mut samples = Vec::with_capacity(bytes.len() / records.size().max(1));
    for (i, record) in bytes.chunks_exact(records.size().max(1)).enumerate() {
        let valid = match field.flags & 3 {
            0 => true,
            flags if flags & 1 != 0 => false,
            _ => {
                let byte = record.get(records.data + field.invalid_bit / 8).ok_or_else(torn)?;
                byte >> (field.invalid_bit % 8) & 1 == 0
            }
        };
        let raw = if counted {
            i as f64
        } else {
            let end = field.byte.checked_add(width).filter(|&end| end <= records.data).ok_or_else(torn)?;
            number(record.get(field.byte..end).ok_or_else(torn)?, &field)
        };
        samples.push(if valid { convert.physical(raw) } else { f64::NAN });
    }
    Ok(samples)
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

fn conversion(blocks: &Blocks, address: u64) -> Result<Conversion, Torn> {
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
        let (time, channels) = super::super::read(&file, Path::new("run.mf4")).expect("a run");
        assert_eq!(time, [0.0, 1.0, 2.0]);
        assert_eq!(channels[&Channel::SteerLeft], [-1.0, 1000.0, -2048.0]);
        assert_eq!(channels[&Channel::Trigger], records.map(|r| f64::from(r[1] >> 7)));
    }
}
