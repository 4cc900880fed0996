//! How a choice is made.

use crate::dynamics::Width;
use crate::solve::Options;
use std::time::Duration;

/// How a choice is made.
#[derive(Clone, Copy, Debug)]
pub struct Settings {
    pub options: Options,
    /// How long tracks are searched, all together; what is not proven by then is the best that was found.
    pub tracks_within: Option<Duration>,
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
