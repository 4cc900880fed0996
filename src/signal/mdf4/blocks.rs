//! The blocks of an MDF4 file: an identifier, links to other blocks, and data.

use super::Torn;
use std::cell::RefCell;
use std::collections::BTreeSet;
use std::io::{Read, Seek, SeekFrom};

/// A file whose blocks are read where they are asked for.
pub struct Blocks<R> {
    data: RefCell<R>,
    length: u64,
}

/// Where a block stands, and how much of it are links and data.
struct Head {
    kind: [u8; 4],
    links: usize,
    /// Where its data begin, behind the links.
    at: u64,
    data: u64,
}

/// One block, but no recorded data.
pub struct Block {
    pub kind: [u8; 4],
    links: Vec<u64>,
    data: Vec<u8>,
}

/// Most that compressed blocks may hold together, bytes: a file of a megabyte could hold a thousand.
const INFLATED: u64 = 4 << 30;

/// Most that a compressed block may hold, bytes. The standard allows 4 MiB.
const INFLATED_BLOCK: u64 = 64 << 20;

/// Most that a block takes that is no recorded data, bytes: a list of eight million blocks.
const READ: u64 = 64 << 20;

/// Where the header block stands, behind the identification.
const HEADER: u64 = 64;

impl<R: Read + Seek> Blocks<R> {
    pub fn new(mut data: R) -> Result<Self, Torn> {
        let length = data.seek(SeekFrom::End(0)).map_err(|why| why.to_string())?;
        let blocks = Blocks { data: RefCell::new(data), length };
        let mut head = [0; HEADER as usize];
        let known = usize::try_from(length).unwrap_or(usize::MAX).min(head.len());
        blocks.fill(0, &mut head[..known])?;
        match &head[..8] {
            b"MDF     " => {}
            b"UnFinMF " => return Err("the recording was not finalised".to_owned()),
            _ => return Err("this is not MDF".to_owned()),
        }
        if u16::from_le_bytes([head[28], head[29]]) < 400 {
            return Err("this is MDF of a version before 4".to_owned());
        }
        Ok(blocks)
    }

    /// Reads what stands at an address.
    fn fill(&self, at: u64, bytes: &mut [u8]) -> Result<(), Torn> {
        let mut data = self.data.borrow_mut();
        let read = data.seek(SeekFrom::Start(at)).and_then(|_| data.read_exact(bytes));
        read.map_err(|why| format!("what stands at byte {at} cannot be read: {why}"))
    }

    /// The header.
    pub fn header(&self) -> Result<Block, Torn> {
        self.block(HEADER, b"##HD")
    }

    fn head(&self, address: u64) -> Result<Head, Torn> {
        let torn = || format!("the block at byte {address} is torn");
        let mut bytes = [0; 24];
        let behind = address.checked_add(24).filter(|&end| end <= self.length).ok_or_else(torn)?;
        self.fill(address, &mut bytes)?;
        let number = |at| u64_at(&bytes, at).ok_or_else(torn);
        let (length, links) = (number(8)?, number(16)?);
        let end = address.checked_add(length).filter(|&end| end <= self.length).ok_or_else(torn)?;
        let at = links.checked_mul(8).and_then(|n| behind.checked_add(n)).filter(|&at| at <= end).ok_or_else(torn)?;
        let [a, b, c, d, ..] = bytes;
        Ok(Head { kind: [a, b, c, d], links: usize::try_from(links).map_err(|_| torn())?, at, data: end - at })
    }

    /// The links of a block, and of its data so much.
    fn body(&self, address: u64, head: &Head, data: u64) -> Result<Block, Torn> {
        let large = || format!("the block at byte {address} holds more than {} MiB", READ >> 20);
        let size = Some(head.at - (address + 24) + data).filter(|&size| size <= READ).ok_or_else(large)?;
        let mut bytes = vec![0; usize::try_from(size).map_err(|_| large())?];
        self.fill(address + 24, &mut bytes)?;
        let data = bytes.split_off(8 * head.links);
        let links = bytes.as_chunks::<8>().0.iter().map(|link| u64::from_le_bytes(*link)).collect();
        Ok(Block { kind: head.kind, links, data })
    }

    /// The block at an address, whatever its kind.
    pub fn any(&self, address: u64) -> Result<Block, Torn> {
        let head = self.head(address)?;
        self.body(address, &head, head.data)
    }

    /// The block at an address, which is of this kind.
    pub fn block(&self, address: u64, kind: &[u8; 4]) -> Result<Block, Torn> {
        let head = self.head(address)?;
        if head.kind == *kind {
            return self.body(address, &head, head.data);
        }
        Err(format!("at byte {address} is no block {}", String::from_utf8_lossy(kind)))
    }

    /// A list of blocks of one kind, each of which links to the next one first.
    pub fn chain(&self, first: u64, kind: &[u8; 4]) -> Result<Vec<Block>, Torn> {
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

    /// What is recorded from an address on: one block or lists of them, plain or compressed.
    pub fn recorded(&self, first: u64) -> Result<Recorded<'_, R>, Torn> {
        let (mut pieces, mut left, mut inflated) = (Vec::new(), 0, 0_u64);
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
            let head = self.head(address)?;
            match &head.kind {
                b"##DT" | b"##DV" => {
                    left += head.data;
                    pieces.push(RecordPart::Plain { at: head.at, left: head.data });
                }
                b"##DZ" => {
                    let packed = packed(&self.body(address, &head, head.data.min(PACKED))?, &head)?;
                    inflated = inflated.saturating_add(packed.length);
                    if inflated > INFLATED {
                        return Err(format!("its compressed blocks hold more than {} MiB", INFLATED >> 20));
                    }
                    left += packed.length;
                    pieces.push(RecordPart::Packed(packed));
                }
                b"##HL" => next.push(self.body(address, &head, 0)?.link(0)),
                // The first link goes to the list after this one.
                b"##DL" => {
                    let links = self.body(address, &head, 0)?.links;
                    next.extend(links.first());
                    next.extend(links.iter().skip(1).rev());
                }
                kind => return Err(format!("data in blocks {} are not known", String::from_utf8_lossy(kind))),
            }
        }
        pieces.reverse();
        Ok(Recorded { blocks: self, left, pieces, inflated: Vec::new(), at: 0 })
    }

    /// What a block holds compressed. Transposed, the first bytes of all records come first, then the second ones, with
    /// what is left of a record behind.
    fn inflate(&self, packed: &Packed) -> Result<Vec<u8>, Torn> {
        let mut data = self.data.borrow_mut();
        data.seek(SeekFrom::Start(packed.at)).map_err(|why| why.to_string())?;
        let mut plain = Vec::new();
        flate2::read::ZlibDecoder::new(data.by_ref().take(packed.size))
            .take(packed.length.saturating_add(1))
            .read_to_end(&mut plain)
            .map_err(|why| format!("a compressed block is torn: {why}"))?;
        if plain.len() as u64 != packed.length {
            return Err("a compressed block is torn".to_owned());
        }
        Ok(match packed.columns.and_then(|columns| Some((columns, plain.len().checked_div(columns)?))) {
            Some((columns, rows)) if rows > 0 => {
                let (table, rest) = plain.split_at(rows * columns);
                let mut bytes = Vec::with_capacity(plain.len());
                bytes.extend((0..rows).flat_map(|row| table.iter().skip(row).step_by(rows)));
                bytes.extend_from_slice(rest);
                bytes
            }
            _ => plain,
        })
    }
}

/// A part of what is recorded.
enum RecordPart {
    Plain { at: u64, left: u64 },
    Packed(Packed),
}

/// A compressed block.
struct Packed {
    at: u64,
    /// Bytes in the file, and unpacked.
    size: u64,
    length: u64,
    /// Bytes of a record, when they are transposed.
    columns: Option<usize>,
}

/// What stands before the compressed bytes.
const PACKED: u64 = 24;

fn packed(block: &Block, head: &Head) -> Result<Packed, Torn> {
    let torn = || "a compressed block is torn".to_owned();
    let (method, columns) = (block.u8(2).ok_or_else(torn)?, block.u32(4).ok_or_else(torn)?);
    if method > 1 {
        return Err(format!("compression of kind {method} is not known"));
    }
    let (length, size) = (block.u64(8).ok_or_else(torn)?, block.u64(16).ok_or_else(torn)?);
    if length > INFLATED_BLOCK {
        return Err(format!("a compressed block holds more than {} MiB", INFLATED_BLOCK >> 20));
    }
    if head.data.checked_sub(PACKED).is_none_or(|there| size > there) {
        return Err(torn());
    }
    Ok(Packed { at: head.at + PACKED, size, length, columns: (method == 1).then_some(columns as usize) })
}

/// What is recorded, read from its first byte to its last: one block is held at a time, if it is compressed.
pub struct Recorded<'a, R> {
    blocks: &'a Blocks<R>,
    left: u64,
    /// What is left, the next one last.
    pieces: Vec<RecordPart>,
    /// The block that is read, unpacked, and how much of it was.
    inflated: Vec<u8>,
    at: usize,
}

impl<R> Recorded<'_, R> {
    /// What is left, bytes.
    pub fn left(&self) -> u64 {
        self.left
    }
}

impl<R: Read + Seek> Recorded<'_, R> {
    /// Fills `bytes`, or as much of it as is left. How much that was.
    pub fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Torn> {
        let mut done = 0;
        while done < bytes.len() {
            let open = &mut bytes[done..];
            let ready = &self.inflated[self.at..];
            if !ready.is_empty() {
                let size = ready.len().min(open.len());
                open[..size].copy_from_slice(&ready[..size]);
                self.at += size;
                done += size;
                continue;
            }
            match self.pieces.pop() {
                None => break,
                Some(RecordPart::Plain { at, left }) => {
                    let size = usize::try_from(left).unwrap_or(usize::MAX).min(open.len());
                    self.blocks.fill(at, &mut open[..size])?;
                    if left > size as u64 {
                        self.pieces.push(RecordPart::Plain { at: at + size as u64, left: left - size as u64 });
                    }
                    done += size;
                }
                Some(RecordPart::Packed(packed)) => {
                    self.inflated = self.blocks.inflate(&packed)?;
                    self.at = 0;
                }
            }
        }
        self.left -= done as u64;
        Ok(done)
    }
}

impl Block {
    /// An address; 0 is none.
    pub fn link(&self, i: usize) -> u64 {
        self.links.get(i).copied().unwrap_or(0)
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
        u64_at(&self.data, at)
    }

    pub fn f64(&self, at: usize) -> Option<f64> {
        self.u64(at).map(f64::from_bits)
    }
}

fn u64_at(bytes: &[u8], at: usize) -> Option<u64> {
    bytes.get(at..)?.first_chunk().map(|b| u64::from_le_bytes(*b))
}
