//! `lss identify`: the model's parameters from measurements.

mod stiffness;

use super::Outcome;
use clap::Subcommand;

/// Find parameters of the model from measurements.
#[derive(Debug, clap::Args)]
pub struct Identify {
    #[command(subcommand)]
    what: What,
}

#[derive(Debug, Subcommand)]
enum What {
    Stiffness(stiffness::Stiffness),
}

impl Identify {
    pub fn run(&self) -> Outcome {
        match &self.what {
            What::Stiffness(verb) => verb.run(),
        }
    }
}
