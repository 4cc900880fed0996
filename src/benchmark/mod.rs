//! The sealed challenge: campaigns whose effects are withheld, made by another simulation than the diagnosis has, and
//! the score of what it says of them.
//!
//! A challenge is a folder: `case-001/` and so on, each a campaign of three runs with its layout; `challenge.json` with
//! what everybody may know, the salted SHA-256 of the key among it; and `key.sealed`. [`answering::answer`] fills
//! `answers/`, and only [`answering::score_folder`] opens the key.

pub mod answering;
mod curves;
mod draw;
pub mod generate;
mod key;
mod reality;
mod score;
mod scored_case;
pub mod seal;
mod source;
mod sources;
mod statistics;
pub mod table;
#[cfg(test)]
mod tests;
mod tracks;

pub use key::{Answer, Case, CaseKind, Facts, GapPart, Key, Named, StrengthInterval, StrengthLevel, Truth};
pub use score::{Accuracy, CaseRow, Score, ScoreRow, score};
pub use scored_case::{Rank, ScoredCase};
pub use statistics::{Bin, Mean, Share};

/// Public facts of a challenge.
pub const CHALLENGE: &str = "challenge.json";
/// What was put in.
pub const KEY: &str = "key.sealed";
