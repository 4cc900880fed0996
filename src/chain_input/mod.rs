//! The input of a simulation as a plain type, which `simulation.json` holds without any `.lss` (design: chain model),
//! and the deviations from it that a built machine may have.

mod check;
mod deviations;
mod document;
mod from_layout;
mod track;
mod unfit;

pub use check::{Contradiction, Unusable};
pub(crate) use deviations::closed;
pub use deviations::{Deviations, Every, Guides, HARMONICS, Ripple, Warming, WheelPlace, WornWheel};
pub use document::*;
pub use unfit::Unfit;
