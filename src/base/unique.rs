//! Words that nobody guesses and no other process has.

use super::digest::hex;
use std::io;

/// Bytes of such a word.
const BYTES: usize = 16;

/// 32 hexadecimal digits from the system's source of random numbers.
///
/// # Errors
///
/// The system has none.
pub fn random() -> io::Result<String> {
    let mut bytes = [0; BYTES];
    getrandom::fill(&mut bytes).map_err(|why| io::Error::other(why.to_string()))?;
    Ok(hex(&bytes))
}

/// Whether a text has the form that [`random`] gives.
pub fn has_form(text: &str) -> bool {
    text.len() == 2 * BYTES && text.bytes().all(|b| matches!(b, b'0'..=b'9' | b'a'..=b'f'))
}

/// A word that no other process has; of this process and moment where the system has no random numbers.
pub fn unlike_any_other() -> String {
    random().unwrap_or_else(|_| format!("{}-{:?}", std::process::id(), std::time::Instant::now()))
}
