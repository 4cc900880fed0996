//! Opening inputs: regular files of a bounded size, and nothing else.

use std::fmt;
use std::fs::{self, File, Metadata};
use std::io::{self, Read};
use std::path::Path;

/// Largest `simulation.json`, challenge or answer, bytes.
pub const JSON_LIMIT: u64 = 64 * 1024 * 1024;

/// Why an input is not read. None of these says what stands in it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum InputError {
    /// There is no such file; the system's reason.
    Missing(String),
    /// Not a regular file, or unreadable; the system's reason.
    Unreadable(String),
    /// It lies outside the project's root (as messages show it), directly or through a symbolic link.
    OutsideRoot(String),
    /// Larger than the limit; bytes.
    TooLarge { bytes: u64, limit: u64 },
}

impl InputError {
    /// A way out.
    pub fn help(&self) -> &'static str {
        match self {
            InputError::Missing(_) | InputError::Unreadable(_) => "check the path and its permissions",
            InputError::OutsideRoot(_) => "move it there, or say with --root DIR how far files may name files",
            InputError::TooLarge { .. } => "split it, or leave out what is not needed",
        }
    }
}

impl fmt::Display for InputError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            InputError::Missing(why) | InputError::Unreadable(why) => f.write_str(why),
            InputError::OutsideRoot(root) => write!(f, "it lies outside the project's root, {root}"),
            InputError::TooLarge { bytes, limit } => {
                write!(f, "{:.1} MiB are more than the {} MiB that are read", mebibytes(*bytes), limit >> 20)
            }
        }
    }
}

impl std::error::Error for InputError {}

impl From<io::Error> for InputError {
    fn from(why: io::Error) -> Self {
        match why.kind() {
            io::ErrorKind::NotFound => InputError::Missing(why.to_string()),
            _ => InputError::Unreadable(why.to_string()),
        }
    }
}

fn mebibytes(bytes: u64) -> f64 {
    bytes as f64 / f64::from(1 << 20)
}

/// Reads a file at a canonical place.
pub(super) fn read(place: &Path, limit: u64) -> Result<Vec<u8>, InputError> {
    all(open(place)?, limit)
}

/// All that is in a file that was opened here.
///
/// # Errors
///
/// [`InputError::TooLarge`] beyond `limit` bytes; [`InputError::Unreadable`].
pub fn all(file: File, limit: u64) -> Result<Vec<u8>, InputError> {
    let bytes = within(&file, limit)?;
    let mut all = Vec::with_capacity(bytes as usize);
    // It may grow meanwhile.
    file.take(limit.saturating_add(1)).read_to_end(&mut all)?;
    match all.len() as u64 {
        bytes if bytes > limit => Err(InputError::TooLarge { bytes, limit }),
        _ => Ok(all),
    }
}

/// The size of a file that was opened here, bytes.
///
/// # Errors
///
/// [`InputError::TooLarge`] beyond `limit` bytes; [`InputError::Unreadable`].
pub fn within(file: &File, limit: u64) -> Result<u64, InputError> {
    match file.metadata()?.len() {
        bytes if bytes > limit => Err(InputError::TooLarge { bytes, limit }),
        bytes => Ok(bytes),
    }
}

/// Opens a regular file at a canonical place. What was opened is what was looked at, still stands there, and no link
/// took its place meanwhile.
pub(super) fn open(place: &Path) -> Result<File, InputError> {
    let refused = |why: &str| Err(InputError::Unreadable(why.to_owned()));
    // Looked at before it is opened: to open a pipe waits for somebody to write into it.
    if !fs::metadata(place)?.is_file() {
        return refused("not a regular file");
    }
    let file = File::open(place)?;
    let opened = file.metadata()?;
    if !opened.is_file() || is_system(&opened) {
        return refused("not a regular file");
    }
    if place.canonicalize()? != place || !is_same(&opened, &fs::metadata(place)?) {
        return refused("the file was replaced while it was opened");
    }
    Ok(file)
}

/// Whether two facts are of one file.
#[cfg(unix)]
fn is_same(a: &Metadata, b: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    (a.dev(), a.ino()) == (b.dev(), b.ino())
}

#[cfg(not(unix))]
fn is_same(a: &Metadata, b: &Metadata) -> bool {
    a.len() == b.len()
}

/// Whether a file is the system's talk about itself: under `/proc` and `/sys`, files call themselves regular.
#[cfg(unix)]
fn is_system(file: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    let device = |path: &str| fs::metadata(path).map(|facts| facts.dev()).ok();
    let system = ["/proc", "/sys"].map(device);
    device("/") != Some(file.dev()) && system.contains(&Some(file.dev()))
}

#[cfg(not(unix))]
fn is_system(_: &Metadata) -> bool {
    false
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::root::read_given;

    #[test]
    fn a_file_at_the_limit_is_read_and_one_beyond_is_not() {
        let at = tempfile::tempdir().unwrap();
        let path = at.path().join("a");
        fs::write(&path, [0; 10]).unwrap();
        assert_eq!(read_given(&path, 10).unwrap().len(), 10);
        assert_eq!(read_given(&path, 9), Err(InputError::TooLarge { bytes: 10, limit: 9 }));
        assert!(matches!(read_given(&at.path().join("b"), 9), Err(InputError::Missing(_))));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn only_regular_files_are_read() {
        let at = tempfile::tempdir().unwrap();
        let socket = at.path().join("socket");
        let _listener = std::os::unix::net::UnixListener::bind(&socket).unwrap();
        for path in ["/dev/zero", "/dev/null", "/proc/self/environ", "/proc/version", "/tmp", &socket.to_string_lossy()]
        {
            assert_eq!(
                read_given(Path::new(path), 100),
                Err(InputError::Unreadable("not a regular file".to_owned())),
                "{path}"
            );
        }
    }
}
