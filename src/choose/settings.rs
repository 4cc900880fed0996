//! How a choice is made.

use crate::dynamics::Width;
use crate::solve::Options;

/// How a choice is made.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    pub options: Options,
    pub width: Width,
    /// Candidates that are checked in the dynamic model until one passes, at most; 0 leaves this check and that of the
    /// simulated capacity out.
    pub checks: usize,
}

/// What is told while a choice goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Told {
    /// A track was solved.
    Track,
    /// The capacity of a candidate is simulated.
    Capacity,
    /// A candidate is checked in the dynamic model.
    Check,
}

/// Takes what is told; any thread may tell.
pub type Tell<'a> = &'a (dyn Fn(Told) + Sync);
