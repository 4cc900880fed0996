//! Why an input cannot be simulated.

use std::fmt;

/// An input that cannot be simulated.
#[derive(Clone, Debug, PartialEq)]
pub struct Unfit {
    /// Where in the simulation input, as `--set` names it.
    pub place: String,
    pub why: String,
}

impl fmt::Display for Unfit {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}: {}", self.place, self.why)
    }
}

impl std::error::Error for Unfit {}
