//! Solves a layout's optimisation problem in the thesis' three stages (§3.3).

mod outcome;

pub use outcome::{Stage, Status, Violation};
