//! What program this is, by its content, and how it is started again.

use super::digest::sha256_of;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// A program that loads this one as a library.
static HOST: OnceLock<Host> = OnceLock::new();

/// Where this program is, when another one loads it as a library: Python.
#[derive(Clone, Debug)]
pub struct Host {
    /// The library's file.
    pub file: PathBuf,
    /// What starts the command line.
    pub program: PathBuf,
}

/// Says that this program is loaded by another one. The first call counts, and has to come before [`program`] is asked.
pub fn loaded_by(host: Host) {
    let _ = HOST.set(host);
}

/// SHA-256 of the running program's file: two builds that may answer differently have different ones.
pub fn program() -> &'static str {
    static PROGRAM: OnceLock<String> = OnceLock::new();
    PROGRAM.get_or_init(|| {
        let file = match HOST.get() {
            Some(host) => File::open(&host.file),
            // On Linux this is the file that runs, even after another one took its name.
            None => File::open("/proc/self/exe").or_else(|_| File::open(std::env::current_exe()?)),
        };
        let hash = file.and_then(|mut file| sha256_of(&mut file));
        // A program that cannot be read is like no other, so that nothing is taken for its work.
        hash.unwrap_or_else(|_| super::unique::unlike_any_other())
    })
}

/// The running program, to be started as a child: also after another one took its name.
///
/// # Errors
///
/// The program's file is not known.
pub fn running() -> io::Result<PathBuf> {
    let file = Path::new("/proc/self/exe");
    match HOST.get() {
        None if cfg!(target_os = "linux") && file.exists() => Ok(file.to_owned()),
        _ => installed(),
    }
}

/// Where the program is, for what starts it later or elsewhere.
///
/// # Errors
///
/// As [`running`].
pub fn installed() -> io::Result<PathBuf> {
    HOST.get().map_or_else(std::env::current_exe, |host| Ok(host.program.clone()))
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_program_knows_its_own_content() {
        let file = std::fs::read(std::env::current_exe().unwrap()).unwrap();
        assert_eq!(super::program(), crate::base::digest::sha256(&file));
    }

    #[test]
    fn a_program_knows_where_it_is() {
        let file = std::env::current_exe().unwrap();
        assert_eq!(super::installed().unwrap(), file);
        assert_eq!(std::fs::read(super::running().unwrap()).unwrap(), std::fs::read(file).unwrap());
    }
}
