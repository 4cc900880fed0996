//! The sealed key. Compressed and combined with a keystream of its salt, it cannot be read by accident: not by a search
//! for an effect's name, not by an editor that opens it. It is no secret from somebody who wants to know; what guards
//! against a change is the salted SHA-256 (FIPS 180-4) that was published before anyone answered.

use crate::base::digest::{hex, sha256};
use flate2::Compression;
use flate2::read::ZlibDecoder;
use flate2::write::ZlibEncoder;
use sha2::{Digest, Sha256};
use std::fmt;
use std::io::{Read, Write};

/// The first line of a sealed file.
const MARK: &str = "lss sealed key 1";

/// What is believed of a key at most: 64 MiB.
const MOST: u64 = 1 << 26;

/// A key as it is stored and as it is known.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sealed {
    /// Content of the file.
    pub bytes: Vec<u8>,
    /// SHA-256 of salt and key, in hexadecimal digits.
    pub hash: String,
}

/// Why a key could not be opened.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SealError {
    /// Not a sealed file, or one that was cut.
    Broken,
    /// Not the key that was published.
    OtherHash { published: String, found: String },
}

impl fmt::Display for SealError {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            SealError::Broken => f.write_str("this is not a whole sealed key"),
            SealError::OtherHash { published, found } => {
                write!(f, "the key is not the one that was published: its SHA-256 is {found}, not {published}")
            }
        }
    }
}

impl std::error::Error for SealError {}

/// Seals a key. `secret` makes the salt, so that the same secret seals the same key alike.
pub fn seal(key: &[u8], secret: u64) -> Sealed {
    let salt: [u8; 32] = Sha256::digest([b"salt".as_slice(), &secret.to_le_bytes()].concat()).into();
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
    // Writing to memory does not fail.
    let compressed = encoder.write_all(key).and_then(|()| encoder.finish()).unwrap_or_default();
    let text = format!("{MARK}\n{}\n{}\n", hex(&salt), hex(&combined(&compressed, &salt)));
    Sealed { bytes: text.into_bytes(), hash: salted(&salt, key) }
}

/// The key, if it is the one whose hash was published.
///
/// # Errors
///
/// [`SealError`] otherwise.
pub fn open(bytes: &[u8], published: &str) -> Result<Vec<u8>, SealError> {
    let text = std::str::from_utf8(bytes).map_err(|_| SealError::Broken)?;
    let mut lines = text.lines();
    let (Some(MARK), Some(salt), Some(body)) = (lines.next(), lines.next(), lines.next()) else {
        return Err(SealError::Broken);
    };
    let (salt, body) = (digits(salt).ok_or(SealError::Broken)?, digits(body).ok_or(SealError::Broken)?);
    let mut key = Vec::new();
    let compressed = combined(&body, &salt);
    ZlibDecoder::new(&compressed[..]).take(MOST).read_to_end(&mut key).map_err(|_| SealError::Broken)?;
    let found = salted(&salt, &key);
    if found == published { Ok(key) } else { Err(SealError::OtherHash { published: published.to_owned(), found }) }
}

fn salted(salt: &[u8], key: &[u8]) -> String {
    sha256(&[salt, key].concat())
}

/// Exclusive or with SHA-256 of salt and block number.
fn combined(bytes: &[u8], salt: &[u8]) -> Vec<u8> {
    let blocks = bytes.chunks(32).enumerate();
    let block = |(k, chunk): (usize, &[u8])| {
        let stream = Sha256::digest([salt, &(k as u64).to_le_bytes()].concat());
        chunk.iter().zip(stream).map(|(a, b)| a ^ b).collect::<Vec<u8>>()
    };
    blocks.flat_map(block).collect()
}

fn digits(text: &str) -> Option<Vec<u8>> {
    let pairs = text.as_bytes().chunks(2);
    pairs.map(|pair| u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok().filter(|_| pair.len() == 2)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_that_of_the_standard() {
        // FIPS 180-4, example of one block.
        assert_eq!(sha256(b"abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    }

    #[test]
    fn a_key_comes_back_and_shows_nothing_until_then() {
        let key = br#"{"case-001": "joint_clearance", "case-002": "joint_clearance"}"#.repeat(20);
        let sealed = seal(&key, 7);
        assert_eq!(open(&sealed.bytes, &sealed.hash), Ok(key.clone()));
        assert!(!String::from_utf8_lossy(&sealed.bytes).contains("joint"));
        assert_eq!(seal(&key, 7), sealed);
        assert_ne!(seal(&key, 8).hash, sealed.hash);
    }

    #[test]
    fn a_changed_key_is_told() {
        let sealed = seal(b"one", 1);
        let other = seal(b"two", 1);
        assert!(matches!(open(&other.bytes, &sealed.hash), Err(SealError::OtherHash { .. })));
        let half = &sealed.bytes[..sealed.bytes.len() / 2];
        assert_eq!(open(half, &sealed.hash), Err(SealError::Broken));
        assert_eq!(open("lss sealed key 1\nµ\nzz\n".as_bytes(), ""), Err(SealError::Broken));
        assert_eq!(open(&[0xff, 0xfe], ""), Err(SealError::Broken));
    }
}
