//! `lss gap check`.

use super::model::Model;
use crate::cli::{Outcome, report};
use crate::gap::outside;
use std::path::PathBuf;

/// Try a program as a model before a diagnosis: a dry run.
///
/// Asks what a diagnosis begins with, everything in one run and the nominal model in each; looks at units, bounds and
/// trials, asks the same twice, and tells how many questions a diagnosis would ask and how long that takes. Exit code 1
/// where something cannot work.
#[derive(Debug, clap::Args)]
pub struct Check {
    /// Folder of a campaign, or its campaign.toml.
    campaign: PathBuf,
    #[command(flatten)]
    model: Model,
}

impl Check {
    pub fn run(&self) -> Outcome {
        let Some(command) = self.model.command(&self.campaign) else {
            report::error("there is no model to check\n  help: give one by --model COMMAND or --fmu FILE");
            return Outcome::Problems;
        };
        match outside::check(&command, &self.campaign, &self.model.settings()) {
            Ok(dry) => {
                report::print(&dry.text);
                dry.warnings.iter().for_each(|warning| report::warning(warning));
                Outcome::Clean
            }
            Err(error) => {
                report::error(&format!("{error}\n  help: {}", error.help()));
                Outcome::Problems
            }
        }
    }
}
