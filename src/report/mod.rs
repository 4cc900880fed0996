//! Pages that a person reads in a browser, each one file that opens offline: a lap, an identification, a diagnosis,
//! polygon action, two runs, a campaign, length against cost, a study, a capacity. What a page shows stands beside it as JSON.

pub mod campaign;
pub mod capacity;
pub mod choice;
pub mod comparison;
pub mod gap;
pub mod identification;
pub mod lap;
mod lap_track;
pub mod pareto;
mod plot;
pub mod polygon;
mod rows;
mod schemas;
pub mod study;
pub mod style;

pub use schemas::schemas;
