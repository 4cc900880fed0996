//! Identification: the chain model's parameters from measured laps (thesis §2.4).

mod design;
pub mod fit;
pub mod floor;
pub mod local;
mod measured;
pub mod model;
pub mod noise;
mod parameter;
mod places;
pub mod posterior;
pub mod summary;

pub use fit::{Fit, Settings};
pub use measured::{CHANNELS, Measured};
pub use parameter::{COUNT, Parameter, damping, restitution};
