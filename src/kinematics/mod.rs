//! The chain on the centre line, without forces: joints that ride on it, one pitch apart.

mod closing;
mod fit;
pub mod polygon;

pub use closing::{Closing, Unclosed, closing};
pub use fit::{Fit, better_length, fit, left_over, level};
