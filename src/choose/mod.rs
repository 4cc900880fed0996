//! Which components a layout is built with: carts and their length, speed, motors and where they stand, least radius. Every
//! candidate of the product line is worked out in closed form, the cheapest one that does what is required is checked in
//! the simulation of its capacity and in the dynamic model, and those that no other one beats are kept for a trade.
//!
//! - [`drive`]: thrust that a chain needs to run, start and stop, with its sources,
//! - [`places`]: motors on straights, as evenly as can be,
//! - [`tracks`]: the track of each least radius, and of each length of cart where the chain has to close,
//! - [`candidate`]: what one choice gives, and what it falls short of,
//! - [`find`]: all candidates in order, what requirements cost,
//! - [`simulated`]: items an hour in the simulation of the capacity,
//! - [`check`]: forces and fatigue in the dynamic model,
//! - [`trade`]: candidates that no other one beats,
//! - [`pareto`]: the same with tracks that trade length, prices and an even run,
//! - [`refused`]: why there is none,
//! - [`write`]: the layout with what was chosen.

pub mod candidate;
pub mod check;
pub mod drive;
pub mod find;
pub mod pareto;
pub mod places;
pub mod refused;
mod settings;
pub mod simulated;
#[cfg(test)]
mod tests;
pub mod tracks;
pub mod trade;
pub mod write;

pub use candidate::{Candidate, Fitted, Requirement, Shortfall};
pub use check::{Carried, Check};
pub use find::{Chosen, TooMany, choose};
pub use pareto::{Pareto, pareto};
pub use refused::refused;
pub use settings::{Settings, Tell, Told};
pub use simulated::Simulated;
pub use trade::{Measure, undominated};
