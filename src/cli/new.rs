//! `lss new`: a project to start from.

use super::{MessageFormat, Outcome, could_not, import, read, report};
use crate::emit::Files;
use crate::import::{LengthUnit, Options, as_name, hall, write_hall};
use crate::source::{self, SourceMap, shown};
use std::path::{Path, PathBuf};

/// Start a project: a folder with a layout that builds.
#[derive(Debug, clap::Args)]
pub struct New {
    /// Folder to create; its name becomes the layout's.
    folder: PathBuf,
    /// Begin with a hall from CAD: building, obstacles, and lines on layers `SECTIONS` or `SECTIONS-NAME`.
    #[arg(long, value_name = "DXF", requires = "route")]
    from: Option<PathBuf>,
    /// The loop through the sections of the drawing is to be found.
    #[arg(long, requires = "from")]
    route: bool,
    /// Unit of the drawing, such as mm, m or in, instead of the one that the file states.
    #[arg(long, value_name = "UNIT", value_parser = LengthUnit::parse, requires = "from")]
    unit: Option<LengthUnit>,
    /// Layer of the building's outline.
    #[arg(long, value_name = "LAYER", default_value = "BUILDING")]
    building: String,
    /// Layer of the obstacles' outlines; may be given several times.
    #[arg(long, value_name = "LAYER", default_value = "OBSTACLES")]
    obstacles: Vec<String>,
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
        let text = match &self.from {
            None => LAYOUT.replace("NAME", &name),
            Some(drawing) => match self.hall(drawing, &name) {
                Ok(text) => text,
                Err(outcome) => return outcome,
            },
        };
        let mut files = Files::default();
        files.push(&file, text);
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

    /// The layout that asks for a loop through the drawn sections.
    fn hall(&self, drawing: &Path, name: &str) -> Result<String, Outcome> {
        let mut sources = SourceMap::default();
        let file =
            source::drawing(&mut sources, drawing).map_err(|why| could_not("read", drawing, import::reason(&why)))?;
        let options = Options {
            building: self.building.clone(),
            obstacles: self.obstacles.clone(),
            unit: self.unit,
            ..Options::default()
        };
        let (hall, said) = hall(&sources, file, &options);
        let outcome = read::tell(&sources, &said, MessageFormat::Text);
        let hall = hall.ok_or(outcome)?;
        let from = drawing.file_name().unwrap_or_default().to_string_lossy();
        Ok(write_hall(&hall, name, &format!("The hall of {from}, drawn in {}.", hall.unit.symbol())))
    }
}
