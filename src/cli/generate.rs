//! Shell completions and man pages, made from the command line's own definition.

use super::{Cli, Outcome, could_not, report};
use crate::emit::Files;
use clap::CommandFactory;
use std::path::PathBuf;

/// Print a completion script for a shell.
#[derive(Debug, clap::Args)]
pub struct Completions {
    #[arg(value_enum)]
    shell: clap_complete::Shell,
}

impl Completions {
    pub fn run(&self) -> Outcome {
        let mut script = Vec::new();
        clap_complete::generate(self.shell, &mut Cli::command(), "lss", &mut script);
        report::print(&String::from_utf8_lossy(&script));
        Outcome::Clean
    }
}

/// Write the man pages into a folder.
#[derive(Debug, clap::Args)]
pub struct Man {
    folder: PathBuf,
}

impl Man {
    pub fn run(&self) -> Outcome {
        let mut command = Cli::command();
        command.build();
        let mut files = Files::default();
        let mut pages = vec![command];
        while let Some(page) = pages.pop() {
            // Verbs may have verbs of their own; those of `help` are all of them once more.
            pages.extend(page.get_subcommands().filter(|verb| verb.get_name() != "help").cloned());
            let name = page.get_display_name().unwrap_or(page.get_name()).to_owned();
            let mut text = Vec::new();
            if let Err(why) = clap_mangen::Man::new(page).render(&mut text) {
                return could_not("write", &self.folder, why);
            }
            files.push(format!("{name}.1"), text);
        }
        match files.write(&self.folder) {
            Ok(()) => Outcome::Clean,
            Err(error) => could_not("write", &self.folder, error),
        }
    }
}
