//! What program this is, by its content.

use super::digest::sha256_of;
use std::fs::File;
use std::sync::OnceLock;

/// SHA-256 of the running program's file: two builds that may answer differently have different ones.
pub fn program() -> &'static str {
    static PROGRAM: OnceLock<String> = OnceLock::new();
    PROGRAM.get_or_init(|| {
        // On Linux this is the file that runs, even after another one took its name.
        let file = File::open("/proc/self/exe").or_else(|_| File::open(std::env::current_exe()?));
        let hash = file.and_then(|mut file| sha256_of(&mut file));
        // A program that cannot be read is like no other, so that nothing is taken for its work.
        hash.unwrap_or_else(|_| super::unique::unlike_any_other())
    })
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_program_knows_its_own_content() {
        let file = std::fs::read(std::env::current_exe().unwrap()).unwrap();
        assert_eq!(super::program(), crate::base::digest::sha256(&file));
    }
}
