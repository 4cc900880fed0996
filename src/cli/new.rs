//! `lss new`: a project to start from.

use super::{Outcome, could_not, report};
use crate::emit::Files;
use crate::import::as_name;
use crate::source::shown;
use std::path::PathBuf;

/// Start a project: a folder with a layout that builds.
#[derive(Debug, clap::Args)]
pub struct New {
    /// Folder to create; its name becomes the layout's.
    folder: PathBuf,
}

const LAYOUT: &str = include_str!("new_layout.lss");

impl New {
    pub fn run(&self) -> Outcome {
        let Some(name) = self.folder.file_name().map(|n| as_name(&n.to_string_lossy(), "layout")) else {
            report::error("give the new folder a name");
            return Outcome::CouldNotRun;
        };
        if self.folder.exists() {
            report::error(&format!("{} exists already; nothing was changed", shown(&self.folder)));
            return Outcome::CouldNotRun;
        }
        let file = format!("{name}.lss");
        let mut files = Files::default();
        files.push(&file, LAYOUT.replace("NAME", &name));
        files.push("lss.toml", "# Marks the root of this project: layouts may import files from here downwards.\n");
        files.push(".gitignore", "/out\n");
        if let Err(error) = files.write(&self.folder) {
            return could_not("create", &self.folder, error);
        }
        let layout = self.folder.join(&file);
        report::print(&format!(
            "created {0}\nnow try: lss build {0} -o {1}\n",
            shown(&layout),
            shown(self.folder.join("out"))
        ));
        Outcome::Clean
    }
}
