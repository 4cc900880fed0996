//! What has no subject of its own: hashes, and the identity of this program.

pub mod digest;
mod program;
pub mod unique;

pub use program::program;
