//! Time integrators behind one small trait.

mod cash_karp;
mod verlet;

pub use cash_karp::CashKarp;
pub use verlet::Verlet;

use super::chain::Chain;

/// Moves a chain on in time.
pub trait Integrator: Send {
    /// Advances by `duration`, s, with the controller's command held. Forces and accelerations of the new state are
    /// evaluated at the end.
    fn advance(&mut self, chain: &mut Chain, duration: f64) -> Result<(), TooFine>;

    /// Steps taken so far.
    fn steps(&self) -> u64;
}

/// An adaptive step that had to become too short to go on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TooFine {
    /// s
    pub step: f64,
}
