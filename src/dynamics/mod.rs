//! The chain in motion: free rigid carts on any centre line, held by force elements (thesis chapter 2; design: chain
//! model).

mod chain;
mod clock;
mod contact;
mod control;
mod coverage;
mod ensemble;
pub mod forces;
mod inspect;
pub mod integrate;
mod lanes;
pub mod law;
mod model;
pub mod parameters;
mod reactions;
mod run;
mod segments;
mod sensor;
mod series;
mod settled;
mod start;
mod state;
mod step;
mod trouble;
mod warming;
mod width;

pub use chain::Chain;
pub use ensemble::{CartRecord, Ensemble, EnsemblePlan, run_ensemble};
pub use inspect::Placement;
pub use model::Model;
pub use run::{End, Method, Outcome, Plan, Progress, simulate};
pub use settled::Settled;
pub use state::PACK;
pub use trouble::{Trouble, TroubleKind};
pub use width::{NoWidth, Width};
