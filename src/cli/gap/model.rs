//! Options of verbs that ask a program outside.

use crate::cli::limits;
use crate::gap::outside::Settings;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Which program, and how it is asked.
#[derive(Debug, clap::Args)]
pub struct Model {
    /// A program that simulates the runs, as docs/outside-models.md has it; the campaign declares its own channels then.
    #[arg(long, value_name = "COMMAND")]
    pub model: Option<String>,
    /// A functional mock-up unit (FMI 2.0 or 3.0, co-simulation) that simulates the runs; the table [fmu] of
    /// campaign.toml names its parameters. Needs Python with lss_model and FMPy.
    #[arg(long, value_name = "FILE", conflicts_with = "model")]
    pub fmu: Option<PathBuf>,
    /// Seconds after which a program that answers nothing is stopped.
    #[arg(long, value_name = "SECONDS", default_value_t = 600.0, value_parser = seconds)]
    timeout: f64,
    /// Processes of the program at once, as licences allow. As many as threads when not given.
    #[arg(long, value_name = "N")]
    jobs: Option<NonZeroUsize>,
}

impl Model {
    /// The command that starts the program, if one was given.
    pub fn command(&self, campaign: &Path) -> Option<String> {
        let quoted =
            |path: &Path| format!("\"{}\"", path.display().to_string().replace('\\', "\\\\").replace('"', "\\\""));
        let fmu = |file: &PathBuf| {
            let python = if cfg!(windows) { "python" } else { "python3" };
            format!("{python} -m lss_model.fmu {} {}", quoted(file), quoted(campaign))
        };
        self.model.clone().or_else(|| self.fmu.as_ref().map(fmu))
    }

    pub fn settings(&self) -> Settings {
        let threads = self.jobs.map_or_else(limits::threads, NonZeroUsize::get);
        Settings { threads, timeout: Duration::from_secs_f64(self.timeout), ..Settings::default() }
    }
}

/// Seconds above 0, up to a week.
fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x > 0.0 && x <= 604_800.0 => Ok(x),
        _ => Err("it takes seconds above 0, up to 604800".to_owned()),
    }
}
