//! The chain on the centre line, without forces: joints that ride on it, one pitch apart.

mod closing;
pub mod polygon;

pub use closing::{Closing, Unclosed, closing};
