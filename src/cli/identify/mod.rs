//! `lss identify`: the model's parameters from measurements.

mod campaign;
pub mod fitted;
mod stiffness;
mod table;

use super::Outcome;
use clap::Subcommand;

/// Find parameters of the model from measurements.
///
/// Fits restitutions, speed, tension, rolling resistance, the trigger's place and the controller's gains to measured
/// laps, each run on its own, with intervals. Writes a JSON file a law, identification.html, and for every layout a
/// fitted .lss and simulation.json. What is finished is kept in DIR/fits, so that a study that was stopped goes on
/// there.
#[derive(Debug, clap::Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub struct Identify {
    #[command(flatten)]
    campaign: campaign::Campaign,
    #[command(subcommand)]
    what: Option<What>,
}

#[derive(Debug, Subcommand)]
enum What {
    Stiffness(stiffness::Stiffness),
}

impl Identify {
    pub fn run(&self) -> Outcome {
        match &self.what {
            Some(What::Stiffness(verb)) => verb.run(),
            None => self.campaign.run(),
        }
    }
}
