//! SHA-256 (FIPS 180-4) as hexadecimal digits.

use sha2::{Digest, Sha256};
use std::fmt::Write;
use std::io::{self, Read};

/// Hexadecimal digits of SHA-256.
pub fn sha256(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

/// The same of all that a reader gives.
///
/// # Errors
///
/// The reader's.
pub fn sha256_of(reader: &mut dyn Read) -> io::Result<String> {
    let mut sum = Sha256::new();
    let mut bytes = vec![0; 1 << 16];
    loop {
        match reader.read(&mut bytes) {
            Ok(0) => return Ok(hex(&sum.finalize())),
            Ok(count) => sum.update(&bytes[..count]),
            Err(why) if why.kind() == io::ErrorKind::Interrupted => {}
            Err(why) => return Err(why),
        }
    }
}

pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::with_capacity(2 * bytes.len()), |mut text, b| {
        let _ = write!(text, "{b:02x}");
        text
    })
}
