//! The gap between simulation and reality: where it lies, which unmodelled effect causes it, and how far it shrinks once that
//! effect is added.
//!
//! A [`Simulator`] is what the diagnosis knows of a model. [`Diagnosis`] is its answer.

pub mod blind;
pub mod chain;
mod chance;
mod court;
mod diagnose;
mod diagnosis;
pub mod effects;
mod evidence;
mod floor;
mod judge;
mod looks;
pub mod outside;
mod refit;
mod remembered;
mod report;
mod screen;
mod second;
mod significance;
mod simulator;
mod tune;
mod words;

pub use diagnose::{Stage, diagnose};
pub use diagnosis::{Amount, Diagnosis, Finding, Group, Overlay, Place, RunGap, Verdict};
pub use remembered::{Left, Remembered};
pub use simulator::{Applied, Band, Candidate, Differs, Frame, Label, Laps, Request, Simulator, Strength};
