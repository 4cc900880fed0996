//! Solves a layout's optimisation problem in the thesis' three stages (§3.3).

mod convex;
mod discrete;
mod outcome;
mod perturb;
pub mod sqp;
mod stages;
mod subproblem;

pub use outcome::{Stage, Status, Violation};
