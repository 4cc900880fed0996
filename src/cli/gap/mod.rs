//! `lss gap`: where a built system and its simulation part.

mod apply;
mod challenge;
mod check;
mod diagnose;
mod model;
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
    Check(check::Check),
    Challenge(challenge::Challenge),
}

impl Gap {
    pub fn run(&self) -> Outcome {
        match &self.what {
            What::Diagnose(verb) => verb.run(),
            What::Check(verb) => verb.run(),
            What::Challenge(verb) => verb.run(),
        }
    }
}
