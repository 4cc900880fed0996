//! Solves a layout's optimisation problem in the thesis' three stages (§3.3).

mod convex;
mod outcome;
pub mod sqp;
mod subproblem;

pub use outcome::{Stage, Status, Violation};
