//! Identification: the chain model's parameters from measured laps, as the thesis' §2.4 has it.
//!
//! [`Measured`] makes a run ready; [`fit`](fit::fit) finds the parameters of one run in one damping law; [`study`] goes
//! over the runs of a campaign and all laws; [`share`] combines runs. [`stiffness`] is the static test of a joint.
//!
//! The motion is chaotic, so laps are compared by what two replicate laps share (`accumulator`), weighted by how far
//! apart such laps are (`repeatability`). Slopes come from designs of simulations rather than from single differences
//! (`design`, `local`), and what the run and the prior together say is a normal distribution within bounds
//! (`posterior`).

pub mod accumulator;
pub mod cases;
pub mod coverage;
mod design;
mod effort;
pub mod excess;
pub mod feature_spec;
pub mod fit;
pub mod goodness;
pub mod grid;
pub mod groups;
pub mod hum;
pub mod lack_of_fit;
pub mod law_fits;
pub mod local;
mod measured;
pub mod model;
pub mod noise;
mod parameter;
pub mod places;
mod posterior;
pub mod recorder;
pub mod repeatability;
pub mod reports;
mod resolution;
pub mod scales;
pub mod share;
pub mod static_test;
mod steady;
pub mod stiffness;
pub mod study;
mod sums;
pub mod unshared;
mod words;

pub use effort::{Counter, Effort};
pub use fit::{Fit, FitSettings};
pub use goodness::Goodness;
pub use measured::Measured;
pub use model::{Coordinates, Model};
pub use parameter::FLOOR_SCALE;
pub use parameter::{COUNT, Parameter, damping, restitution};
pub use posterior::{interval, mode_within};
