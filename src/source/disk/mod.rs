//! Writing files so that a crash loses nothing.
//!
//! New content goes to a temporary file in the target's folder and onto the disk; then the temporary takes the target's
//! name in one step. At every moment the target is the old file or the new one, whole. [`Files`] does that for a set of
//! files, [`replace`] for one.
//!
//! What a killed process leaves are temporaries; the next writing into the folder removes them ([`sweep`]). A
//! [manifest](inspect) says whether a set is whole.
//!
//! The rename decides what happens to a target that is not plain: a symbolic link is replaced, and what it points to
//! stays as it is; a hard link is broken. Permissions of the target are kept, its owner and group where the system
//! allows that; access lists and extended attributes are not.

mod files;
mod manifest;
mod scratch;
mod temporary;

pub use files::{Files, WriteError, replace, rewrite};
pub use manifest::{Found, inspect};
pub use scratch::Scratch;
pub use temporary::{Temporary, sweep, sync_folder};
