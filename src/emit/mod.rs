//! Writers: everything a build leaves behind, from one plain value, [`Compiled`].

pub mod bom;
mod compiled;
mod drawing;
pub mod dxf;
#[cfg(test)]
pub(crate) mod fixture;
pub mod freedom;
pub mod gap;
pub mod identification;
pub mod lap;
pub mod layout;
pub mod outside;
pub mod pareto;
mod plan;
pub mod png;
pub mod polygon;
mod schemas;
pub mod simulation;
mod station;
mod style;
pub mod svg;

pub use crate::source::disk::{Files, WriteError};
pub use compiled::Compiled;
pub use drawing::{DrawError, drawing_files, stages_png, stages_svg};
pub use schemas::schemas;
pub use station::Station;

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
