//! `lss gap`: where a built system and its simulation part.

mod apply;
mod challenge;
mod diagnose;
mod text;

use super::Outcome;
use clap::Subcommand;

/// Say where simulation and reality part, which effect does it, and how much adding it closes.
#[derive(Debug, clap::Args)]
pub struct Gap {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    Diagnose(diagnose::Diagnose),
    Challenge(challenge::Challenge),
}

impl Gap {
    pub fn run(&self) -> Outcome {
        match &self.what {
            What::Diagnose(verb) => verb.run(),
            What::Challenge(verb) => verb.run(),
        }
    }
}
