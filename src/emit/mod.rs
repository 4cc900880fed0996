//! Writers: everything a build leaves behind, from one plain value, [`Compiled`].

pub mod bom;
mod document;
mod drawing;
pub mod dxf;
mod files;
#[cfg(test)]
mod fixture;
pub mod layout;
pub mod number;
mod plan;
pub mod png;
mod schemas;
pub mod simulation;
mod station;
pub mod svg;

pub use drawing::{DrawError, drawing_files, stages_png, stages_svg};
pub use files::{Files, WriteError};
pub use schemas::schemas;
pub use station::Station;

use crate::elements::{Bill, Sequence};
use crate::geometry::Track;
use crate::model::Layout;
use crate::solve::Stage;

/// A layout after solving: what every writer reads.
#[derive(Clone, Debug)]
pub struct Compiled {
    pub layout: Layout,
    /// The centre line that is drawn and ordered (the last stage's, or the best found when a solve failed).
    pub track: Track,
    /// The written layout is not among them; the last one is what `track` shows. At least one.
    pub stages: Vec<Stage>,
    pub sequence: Sequence,
    pub bill: Bill,
    /// Contact areas and clearances per obstacle, in the order of `layout.obstacles`, then the building.
    pub contacts: Vec<Contact>,
    /// Floor covered by the track's band, m².
    pub footprint: f64,
}

impl Compiled {
    /// Whether the last stage failed: drawings then carry a watermark and the rows that are violated.
    pub fn failed(&self) -> bool {
        self.stages.last().is_some_and(|s| s.status == crate::solve::Status::Infeasible)
    }
}

/// How the track's band meets an obstacle, or the building's outside.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct Contact {
    /// The obstacle's name, or `building`.
    pub name: String,
    /// Overlap of the region (without clearance) with what lies within the left and right track side (thesis
    /// §3.3.1), m².
    pub area_left: f64,
    pub area_right: f64,
    /// Signed distance from the band's edge to the region, m; negative when they overlap.
    pub clearance: f64,
    /// What the layout asks for, m.
    pub required: f64,
}

/// The data outputs, name and content: `layout.json`, `simulation.json`, `bom.csv` and `bom.json`.
pub fn data_files(compiled: &Compiled) -> Vec<(String, Vec<u8>)> {
    vec![
        ("layout.json".to_owned(), layout::json(compiled)),
        ("simulation.json".to_owned(), simulation::json(compiled)),
        ("bom.csv".to_owned(), bom::csv(compiled)),
        ("bom.json".to_owned(), bom::json(compiled)),
    ]
}
