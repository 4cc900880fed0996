//! Pages that a person reads in a browser, each one file that opens offline: a lap, an identification, a diagnosis,
//! polygon action, a study. What a page shows stands beside it as JSON.

pub mod gap;
pub mod identification;
pub mod lap;
pub mod polygon;
mod schemas;
pub mod study;
pub mod style;

pub use schemas::schemas;
