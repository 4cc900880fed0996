//! Writes a run as MDF4 as a measuring system may: one group of doubles over a master, its records in blocks of a list.

use std::io::{Seek, SeekFrom, Write};

/// Bytes of records in a block, about.
const BLOCK: usize = 4 << 20;

/// A file that is written block by block.
struct Writer<W> {
    file: W,
    at: u64,
}

impl<W: Write + Seek> Writer<W> {
    /// Appends a block and tells its address.
    fn block(&mut self, kind: &str, links: &[u64], data: &[u8]) -> u64 {
        let address = self.at;
        let size = 24 + 8 * links.len() + data.len();
        let mut bytes = [kind.as_bytes(), &[0; 4]].concat();
        for n in [size as u64, links.len() as u64].iter().chain(links) {
            bytes.extend_from_slice(&n.to_le_bytes());
        }
        bytes.extend_from_slice(data);
        bytes.resize(size.next_multiple_of(8), 0);
        self.file.write_all(&bytes).expect("written");
        self.at += bytes.len() as u64;
        address
    }

    fn channel(&mut self, next: u64, name: &str, master: bool, byte: usize) -> u64 {
        let name = self.block("##TX", &[], name.as_bytes());
        // A double, whose lowest byte comes first.
        let mut data = vec![if master { 2 } else { 0 }, u8::from(master), 4, 0];
        data.extend_from_slice(&u32::try_from(byte).expect("a record").to_le_bytes());
        data.extend_from_slice(&64_u32.to_le_bytes());
        data.resize(72, 0);
        self.block("##CN", &[next, 0, name, 0, 0, 0, 0, 0], &data)
    }
}

/// Writes `rows` records of `names`, the first of which is time; `record` fills one.
pub fn write<W: Write + Seek>(file: W, names: &[&str], rows: usize, mut record: impl FnMut(usize, &mut [f64])) {
    let mut to = Writer { file, at: 0 };
    let mut head = b"MDF     4.10    lss     \0\0\0\0\x9a\x01".to_vec();
    head.resize(64, 0);
    to.file.write_all(&head).expect("written");
    to.at = 64;
    // The header is filled in when it is known what it points to.
    to.block("##HD", &[0; 6], &[0; 32]);
    let first = names.iter().enumerate().rev().fold(0, |next, (k, name)| to.channel(next, name, k == 0, 8 * k));
    let size = 8 * names.len();
    let mut group = [0; 32];
    group[8..16].copy_from_slice(&(rows as u64).to_le_bytes());
    group[24..28].copy_from_slice(&u32::try_from(size).expect("a record").to_le_bytes());
    let group = to.block("##CG", &[0, first, 0, 0, 0, 0], &group);
    let mut list = vec![0];
    let mut numbers = vec![0.0; names.len()];
    let each = BLOCK / size;
    for begin in (0..rows).step_by(each) {
        let mut bytes = Vec::with_capacity(each * size);
        for row in begin..rows.min(begin + each) {
            record(row, &mut numbers);
            bytes.extend(numbers.iter().flat_map(|x| x.to_le_bytes()));
        }
        list.push(to.block("##DT", &[], &bytes));
    }
    let list = to.block("##DL", &list, &[0; 16]);
    let home = to.block("##DG", &[0, group, list, 0], &[0; 8]);
    to.file.seek(SeekFrom::Start(64)).expect("a place");
    to.block("##HD", &[home, 0, 0, 0, 0, 0], &[0; 32]);
    to.file.flush().expect("written");
}
