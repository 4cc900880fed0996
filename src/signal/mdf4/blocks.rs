//! The blocks of an MDF4 file: an identifier, links to other blocks, and data.

use super::Torn;
use std::borrow::Cow;
use std::collections::BTreeSet;
use std::io::Read;

/// A whole file.
pub struct Blocks<'a> {
    bytes: &'a [u8],
}

/// One block of it.
#[derive(Clone, Copy)]
pub struct Block<'a> {
    pub kind: [u8; 4],
    links: &'a [u8],
    data: &'a [u8],
}

/// Most that compressed blocks may hold together, bytes: a file of a megabyte could hold a thousand.
const INFLATED: u64 = 2 << 30;

/// Where the header block stands, behind the identification.
const HEADER: u64 = 64;

impl<'a> Blocks<'a> {
    pub fn new(bytes: &'a [u8]) -> Result<Self, Torn> {
        match bytes.get(..8) {
            Some(b"MDF     ") => {}
            Some(b"UnFinMF ") => return Err("the recording was not finalised".to_owned()),
            _ => return Err("this is not MDF".to_owned()),
        }
        match bytes.get(28..30) {
            Some(version) if u16::from_le_bytes([version[0], version[1]]) >= 400 => Ok(Blocks { bytes }),
            _ => Err("this is MDF of a version before 4".to_owned()),
        }
    }

    /// The header.
    pub fn header(&self) -> Result<Block<'a>, Torn> {
        self.block(HEADER, b"##HD")
    }

    /// The block at an address, whatever its kind.
    pub fn any(&self, address: u64) -> Result<Block<'a>, Torn> {
        let torn = || format!("the block at byte {address} is torn");
        let bytes = usize::try_from(address).ok().and_then(|at| self.bytes.get(at..)).ok_or_else(torn)?;
        let kind = bytes.first_chunk::<4>().ok_or_else(torn)?;
        let length = u64_at(bytes, 8).and_then(|n| usize::try_from(n).ok()).ok_or_else(torn)?;
        let links = u64_at(bytes, 16).and_then(|n| usize::try_from(n).ok()?.checked_mul(8)).ok_or_else(torn)?;
        let body = bytes.get(24..length).ok_or_else(torn)?;
        let (links, data) = body.split_at_checked(links).ok_or_else(torn)?;
        Ok(Block { kind: *kind, links, data })
    }

    /// The block at an address, which is of this kind.
    pub fn block(&self, address: u64, kind: &[u8; 4]) -> Result<Block<'a>, Torn> {
        let block = self.any(address)?;
        if block.kind == *kind {
            return Ok(block);
        }
        Err(format!("at byte {address} is no block {}", String::from_utf8_lossy(kind)))
    }

    /// A list of blocks of one kind, each of which links to the next one first.
    pub fn chain(&self, first: u64, kind: &[u8; 4]) -> Result<Vec<Block<'a>>, Torn> {
        let (mut list, mut seen, mut address) = (Vec::new(), BTreeSet::new(), first);
        while address != 0 {
            if !seen.insert(address) {
                return Err(format!("the blocks from byte {first} go in a circle"));
            }
            let block = self.block(address, kind)?;
            address = block.link(0);
            list.push(block);
        }
        Ok(list)
    }

    /// Text, plain or as the first `<TX>` of a comment in XML. Empty without a block.
    pub fn text(&self, address: u64) -> Result<String, Torn> {
        if address == 0 {
            return Ok(String::new());
        }
        let block = self.any(address)?;
        let end = block.data.iter().position(|&b| b == 0).unwrap_or(block.data.len());
        let text = std::str::from_utf8(&block.data[..end]).map_err(|why| why.to_string())?;
        let text = match &block.kind {
            b"##MD" => text.split_once("<TX>").and_then(|(_, rest)| rest.split_once("</TX>")).map_or("", |(tx, _)| tx),
            _ => text,
        };
        Ok(text.trim().to_owned())
    }

    /// What is recorded from an address on: one block or lists of them, plain or compressed. What stands in one plain block is not
    /// copied.
    pub fn recorded(&self, first: u64) -> Result<Cow<'a, [u8]>, Torn> {
        if let Some(block) = Some(first).filter(|first| *first != 0).map(|first| self.any(first)).transpose()?
            && matches!(&block.kind, b"##DT" | b"##DV")
        {
            return Ok(Cow::Borrowed(block.data));
        }
        let mut bytes = Vec::new();
        // Every block is read once, so that lists that name one again and again fill no more than the file can.
        let mut seen = BTreeSet::new();
        let mut next = vec![first];
        while let Some(address) = next.pop() {
            if address == 0 {
                continue;
            }
            if !seen.insert(address) {
                return Err(format!("the block at byte {address} is recorded twice"));
            }
            let block = self.any(address)?;
            match &block.kind {
                b"##DT" | b"##DV" => bytes.extend_from_slice(block.data),
                b"##DZ" => inflate(&block, &mut bytes)?,
                b"##HL" => next.push(block.link(0)),
                // The first link goes to the list after this one.
                b"##DL" => {
                    let mut links = block.links();
                    next.extend(links.next());
                    let data: Vec<u64> = links.collect();
                    next.extend(data.into_iter().rev());
                }
                kind => return Err(format!("data in blocks {} are not known", String::from_utf8_lossy(kind))),
            }
        }
        Ok(Cow::Owned(bytes))
    }
}

impl<'a> Block<'a> {
    /// An address; 0 is none.
    pub fn link(&self, i: usize) -> u64 {
        self.links().nth(i).unwrap_or(0)
    }

    pub fn links(&self) -> impl Iterator<Item = u64> + 'a {
        self.links.as_chunks::<8>().0.iter().map(|link| u64::from_le_bytes(*link))
    }

    /// A byte of the data.
    pub fn u8(&self, at: usize) -> Option<u8> {
        self.data.get(at).copied()
    }

    pub fn u16(&self, at: usize) -> Option<u16> {
        self.data.get(at..)?.first_chunk().map(|b| u16::from_le_bytes(*b))
    }

    pub fn u32(&self, at: usize) -> Option<u32> {
        self.data.get(at..)?.first_chunk().map(|b| u32::from_le_bytes(*b))
    }

    pub fn u64(&self, at: usize) -> Option<u64> {
        u64_at(self.data, at)
    }

    pub fn f64(&self, at: usize) -> Option<f64> {
        self.u64(at).map(f64::from_bits)
    }
}

fn u64_at(bytes: &[u8], at: usize) -> Option<u64> {
    bytes.get(at..)?.first_chunk().map(|b| u64::from_le_bytes(*b))
}

/// Appends what a block holds compressed. Transposed, the first bytes of all records come first, then the second ones, with
/// what is left of a record behind.
fn inflate(block: &Block, bytes: &mut Vec<u8>) -> Result<(), Torn> {
    let torn = || "a compressed block is torn".to_owned();
    let (method, columns) = (block.u8(2).ok_or_else(torn)?, block.u32(4).ok_or_else(torn)?);
    if method > 1 {
        return Err(format!("compression of kind {method} is not known"));
    }
    let length = block.u64(8).ok_or_else(torn)?;
    if length.saturating_add(bytes.len() as u64) > INFLATED {
        return Err(format!("its compressed blocks hold more than {} MiB", INFLATED >> 20));
    }
    let packed = block.data.get(24..).ok_or_else(torn)?;
    let packed =
        usize::try_from(block.u64(16).ok_or_else(torn)?).ok().and_then(|n| packed.get(..n)).ok_or_else(torn)?;
    let mut plain = Vec::new();
    flate2::read::ZlibDecoder::new(packed)
        .take(length.saturating_add(1))
        .read_to_end(&mut plain)
        .map_err(|why| format!("a compressed block is torn: {why}"))?;
    if plain.len() as u64 != length {
        return Err(torn());
    }
    let columns = columns as usize;
    match plain.len().checked_div(columns) {
        Some(rows) if method == 1 && rows > 0 => {
            let (table, rest) = plain.split_at(rows * columns);
            bytes.extend((0..rows).flat_map(|row| table.iter().skip(row).step_by(rows)));
            bytes.extend_from_slice(rest);
        }
        _ => bytes.extend_from_slice(&plain),
    }
    Ok(())
}
