//! The gap between simulation and reality: where it lies, which unmodelled effect causes it, and how far it shrinks once that
//! effect is added.
//!
//! A [`Simulator`] is what the diagnosis knows of a model. [`Diagnosis`] is its answer.

mod diagnosis;
pub mod effects;
mod simulator;

pub use diagnosis::{Amount, Diagnosis, Finding, Group, Overlay, Place, RunGap, Verdict};
pub use simulator::{Applied, Band, Candidate, Frame, Label, Request, Simulator, Strength};
