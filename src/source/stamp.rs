//! Whether a file may have changed, without reading it.

use std::fs;
use std::path::Path;
use std::time::{Duration, SystemTime};

/// A file that changed this lately may change again within one tick of its clock.
const FRESH: Duration = Duration::from_secs(2);

/// What the disk says of a file: when it was written and how long it is. Two that are alike are of the same content,
/// unless the file [is fresh](Stamp::is_fresh).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Stamp(Option<(Option<SystemTime>, u64)>);

impl Stamp {
    /// Of the file at a place; one that is not there has a stamp, too.
    pub fn of(place: &Path) -> Stamp {
        Stamp(fs::metadata(place).ok().map(|facts| (facts.modified().ok(), facts.len())))
    }

    /// Whether it was written so lately that the next writing may have the same time, or says no time at all.
    pub fn is_fresh(&self) -> bool {
        let Some((written, _)) = self.0 else { return false };
        written.is_none_or(|at| at.elapsed().is_ok_and(|age| age < FRESH))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_is_written_gone_or_replaced_has_another_stamp() {
        let at = tempfile::tempdir().unwrap();
        let path = at.path().join("a.lss");
        let absent = Stamp::of(&path);
        fs::write(&path, "one").unwrap();
        let first = Stamp::of(&path);
        assert!(first.is_fresh() && !absent.is_fresh() && first != absent);
        let old = fs::File::options().write(true).open(&path).unwrap();
        old.set_modified(SystemTime::now() - Duration::from_secs(100)).unwrap();
        let older = Stamp::of(&path);
        assert!(older != first && !older.is_fresh());
        fs::write(at.path().join("b.lss"), "two").unwrap();
        fs::rename(at.path().join("b.lss"), &path).unwrap();
        assert_ne!(Stamp::of(&path), older);
        fs::remove_file(&path).unwrap();
        assert_eq!(Stamp::of(&path), absent);
    }
}
