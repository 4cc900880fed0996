//! The chain in motion: free rigid carts on any centre line, held by force elements (thesis chapter 2; design: chain model).

mod chain;
mod contact;
mod control;
pub mod forces;
mod inspect;
pub mod integrate;
mod lanes;
pub mod law;
mod model;
mod motors;
mod segments;
mod start;
mod state;
mod width;

pub use chain::Chain;
pub use inspect::Placement;
pub use model::{Model, Unfit};
pub use state::PACK;
pub use width::Width;
