//! What a build writes, and what it says of the folder that it writes to.

use super::emit::Emit;
use crate::cli::{Outcome, could_not, report};
use crate::compiled::{Compiled, order};
use crate::emit::freedom::Table;
use crate::emit::{self, DrawError, Files, OwnNumbers};
use crate::source::disk::{Found, inspect};
use crate::source::{SIZE_LIMIT, root, shown};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Files beside those of every build.
#[derive(Debug, clap::Args)]
pub struct More {
    /// Draw start and stages over each other, too: stages.svg and stages.png.
    #[arg(long)]
    stages: bool,
    /// Write the drawing as PDF, too: drawing.pdf, on a page of the sheet's size; with --stages also stages.pdf.
    #[arg(long)]
    pdf: bool,
    /// Write a report on the layout, too: report.pdf, with figures, proof, drawing, constraints and bill.
    #[arg(long)]
    report: bool,
    /// Write the bill as a workbook, too: bom.xlsx, with carts, joints, motors, sensors and supports.
    #[arg(long)]
    xlsx: bool,
    /// Write the layout in space as glTF, too: track.glb, for CAD and viewers.
    #[arg(long)]
    gltf: bool,
    /// A table of own article numbers, which the bills then have, too: CSV with two columns, the catalogue's and the
    /// own one.
    #[arg(long, value_name = "FILE")]
    articles: Option<PathBuf>,
}

impl More {
    /// Whether a folder is needed whatever else is asked.
    pub fn any(&self) -> bool {
        self.stages || self.pdf || self.report || self.xlsx || self.gltf
    }

    /// Own article numbers, where they are given. What is wrong with the file is reported here.
    pub fn own_numbers(&self) -> Result<OwnNumbers, Outcome> {
        let Some(file) = &self.articles else { return Ok(OwnNumbers::default()) };
        let bytes = root::read_given(file, SIZE_LIMIT).map_err(|why| could_not("read", file, why))?;
        emit::own_numbers(&bytes).map_err(|why| {
            report::error(&format!("{}{why}", shown(file)));
            Outcome::Problems
        })
    }

    /// Says of which articles on a bill the table has no own number.
    pub fn tell_missing(&self, compiled: &Compiled, own: &OwnNumbers) {
        let Some(file) = &self.articles else { return };
        let beside = order::lines(compiled).into_iter().filter_map(|line| line.article);
        let all: BTreeSet<String> = compiled.bill.lines.iter().map(|line| line.article.clone()).chain(beside).collect();
        let missing: Vec<&str> = all.iter().map(String::as_str).filter(|article| own.of(article).is_none()).collect();
        if !missing.is_empty() {
            let (file, count, all) = (shown(file), missing.len(), all.len());
            let more = if count > NAMED { format!(" and {} more", count - NAMED) } else { String::new() };
            let names = missing[..count.min(NAMED)].join(", ");
            report::warning(&format!(
                "{file} has no own number of {count} of the {all} articles ordered: {names}{more}"
            ));
        }
    }

    /// All files of a build.
    ///
    /// # Errors
    /// As the writers.
    pub fn files(
        &self,
        compiled: &Compiled,
        emit: Option<Emit>,
        freedom: Option<&Table>,
        own: &OwnNumbers,
    ) -> Result<Files, DrawError> {
        let mut files: Files =
            emit::data_files(compiled, own).into_iter().chain(emit::drawing_files(compiled)?).collect();
        if self.stages {
            let written = compiled.layout.corners();
            files.push("stages.svg", emit::stages_svg(compiled, &written)?);
            files.push("stages.png", emit::stages_png(compiled, &written)?);
            if self.pdf {
                files.push("stages.pdf", emit::stages_pdf(compiled, &written)?);
            }
        }
        if self.pdf {
            files.push("drawing.pdf", emit::drawing_pdf(compiled)?);
        }
        if self.report {
            files.push("report.pdf", emit::report_pdf(compiled, own)?);
        }
        if self.xlsx {
            files.push("bom.xlsx", emit::xlsx::bill(compiled, own)?);
        }
        if self.gltf {
            files.push("track.glb", emit::gltf::scene(compiled));
        }
        match emit {
            Some(Emit::Nl) => files.extend(emit::outside::nl_files(compiled)),
            Some(Emit::Mps) => files.extend(emit::outside::mps_files(compiled)),
            _ => files.extend(freedom.into_iter().flat_map(|table| table.files())),
        }
        Ok(files)
    }
}

/// Articles without an own number that are named.
const NAMED: usize = 12;

/// Of the manifest in the folder of the outputs.
const SET: &str = "build";

/// Writes all files or none, after a word about a folder whose files are no whole set.
pub fn write(files: &Files, folder: &Path) -> Result<(), Outcome> {
    tell_of(&inspect(folder, SET), folder);
    files.write_set(folder, SET).map_err(|error| could_not("write", &error.path, &error.reason))
}

/// Says where the files of an earlier build are no whole set. All of them are written anew.
fn tell_of(found: &Found, folder: &Path) {
    let folder = folder.display();
    match found {
        Found::Whole => {}
        Found::Interrupted { new, old } => report::warning(&format!(
            "{folder} holds parts of two builds, as a build was stopped while it wrote: {} {} new, {} {} not; all are \
             written anew",
            new.join(", "),
            if new.len() == 1 { "is" } else { "are" },
            old.join(", "),
            if old.len() == 1 { "is" } else { "are" },
        )),
        Found::Changed { changed, missing } => {
            if !changed.is_empty() {
                let what = if changed.len() == 1 { "is not what" } else { "are not what" };
                report::warning(&format!(
                    "{} in {folder} {what} the last build wrote there; written anew",
                    changed.join(", ")
                ));
            }
            if !missing.is_empty() {
                let what = if missing.len() == 1 { "is" } else { "are" };
                report::warning(&format!(
                    "{} of the last build {what} gone from {folder}; written anew",
                    missing.join(", ")
                ));
            }
        }
    }
}
