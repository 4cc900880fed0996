//! `lss preview`: a page that follows a layout's file.

use super::{Outcome, limits, report};
use crate::preview::{self, Forces, Settings};
use crate::source::{SIZE_LIMIT, root, shown};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

/// Show a layout in a browser, redrawn whenever its file is saved; vertices can be dragged there.
///
/// Prints the address of a page on this machine, with a token that nobody else knows, and serves it until it is
/// interrupted. A dragged vertex changes its coordinates in the file, and nothing else.
#[derive(Debug, clap::Args)]
pub struct Preview {
    /// A layout, .lss.
    file: PathBuf,
    /// Which layout, when the file has several.
    #[arg(long, value_name = "NAME")]
    layout: Option<String>,
    /// A run that `lss simulate` made of the layout: forces are shown at each straight and curve.
    #[arg(long, value_name = "RUN")]
    run: Option<PathBuf>,
    /// Port to listen on; one that is free when not given.
    #[arg(long, value_name = "PORT", default_value_t = 0, hide_default_value = true)]
    port: u16,
    /// End the search for the best layout on the grid after this time (30, 30s, 2min).
    #[arg(long, value_name = "TIME", value_parser = limits::time, default_value = "10s")]
    time_limit: Duration,
}

impl Preview {
    pub fn run(&self) -> Outcome {
        // A file that is not there is a mistake of the command; one with mistakes is shown with them.
        if let Err(why) = root::read_given(&self.file, SIZE_LIMIT) {
            return super::could_not("read", &self.file, why);
        }
        let forces = match self.run.as_deref().map(Forces::read).transpose() {
            Ok(forces) => forces.map(Arc::new),
            Err(why) => {
                report::error(&why);
                return Outcome::CouldNotRun;
            }
        };
        let settings = Settings {
            file: self.file.clone(),
            layout: self.layout.clone(),
            port: self.port,
            limit: self.time_limit,
            threads: limits::threads(),
            forces,
        };
        let ready = |address: &str| {
            report::print(&format!("{address}\n"));
            report::note(&format!("shows {} there until Ctrl-C", shown(&self.file)));
        };
        match preview::serve(&settings, ready) {
            Ok(()) => Outcome::Clean,
            Err(why) => {
                report::error(&why);
                Outcome::CouldNotRun
            }
        }
    }
}
