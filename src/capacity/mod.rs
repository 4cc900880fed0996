//! How many items an hour a sorter takes: closed forms, and carriers and items simulated.
//!
//! - [`sorter`]: what both know of a sorter,
//! - [`bound`]: the most in closed form; [`flow`]: what is used up first; [`split`]: in which proportions most goes over it,
//!   [`scanners`]: with scanners that fail,
//! - [`simulate`]: carriers and items, carrier by carrier,
//! - [`waves`], [`outage`]: waves of items and failures of equipment as they happen; [`stream`]: their random numbers,
//! - [`warm_up`], [`replicate`]: where a simulation's beginning ends, and how sure its mean is,
//! - [`explore`]: where carriers are in use, other speeds and fewer inductions,
//! - [`reached`]: whether a layout takes what it is asked to.

pub mod bound;
pub mod explore;
pub mod flow;
mod outage;
mod reached;
pub mod replicate;
mod scanners;
pub mod simulate;
pub mod sorter;
mod split;
mod stream;
#[cfg(test)]
mod tests;
pub mod warm_up;
mod waves;

pub use bound::{Bound, Bounds, bound};
pub use flow::Limit;
pub use reached::{limit_words, most_words, reached, way_out};
pub use replicate::{Mean, Measured, Settings, measure};
pub use sorter::Sorter;
