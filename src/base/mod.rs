//! What has no subject of its own: hashes, the identity of this program, and files that are replaced whole.

pub mod digest;
pub mod disk;
mod program;

pub use program::program;
