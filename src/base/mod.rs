//! What has no subject of its own: hashes, and the identity of this program.

pub mod digest;
pub mod json;
pub mod linear_program;
pub mod number;
pub mod parallel;
mod program;
pub mod random;
pub mod stop;
pub mod student;
pub mod trig;
pub mod unique;
pub mod words;

pub use program::{Host, installed, loaded_by, program, running};
