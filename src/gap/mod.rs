//! The gap between simulation and reality: where it lies, which unmodelled effect causes it, and how far it shrinks
//! once that effect is added.
//!
//! A [`Simulator`] is what the diagnosis knows of a model. [`Diagnosis`] is its answer.

mod amounts;
pub mod chain;
mod chance;
mod checked;
mod comparison;
mod cost;
mod diagnose;
mod diagnosed;
mod diagnosis;
mod gauss_newton;
mod hypothesis;
mod ids;
mod ladder;
mod likelihood;
mod observation;
pub mod outside;
mod overlays;
mod places;
mod predictive;
#[cfg(test)]
pub(crate) mod random_reports;
mod refit;
mod relinearisation;
mod remembered;
mod repeatability;
mod report;
mod scored;
mod screen;
mod second;
pub mod settings;
mod several_places;
mod shape;
mod signature;
mod significance;
mod simulator;
mod sizes;
mod strengths_beside;
mod tune;
#[cfg(test)]
mod two_effects;
mod untested;
mod words;

pub use cost::{Cost, Costs};
pub use diagnose::{Stage, diagnose, diagnose_and_explain};
pub use diagnosed::{Answer, diagnose_runs};
pub use diagnosis::{
    Amount, Bound, ByAccuracy, CheckedRun, Diagnosis, Extent, Finding, GapPlace, Group, Lost, OutsideModel, Overlay,
    PredictiveCheck, RunGap, SampleError, Shape, Unexplained, Verdict,
};
pub use ids::{CandidateId, Id, List, PerRun, RunId};
pub use remembered::{Left, Remembered};
pub use scored::{Explanation, Terms};
pub use settings::Settings;
pub use simulator::{Applied, Axis, Band, Candidate, Candidates, Frame, Label, Laps, Request, Simulator, Strength};
pub use words::{bound, draws, percent, probability};
