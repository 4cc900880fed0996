//! SHA-256 (FIPS 180-4) as hexadecimal digits.

use sha2::{Digest, Sha256};
use std::fmt::Write;

/// Hexadecimal digits of SHA-256.
pub fn sha256(bytes: &[u8]) -> String {
    hex(&Sha256::digest(bytes))
}

pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::with_capacity(2 * bytes.len()), |mut text, b| {
        let _ = write!(text, "{b:02x}");
        text
    })
}
