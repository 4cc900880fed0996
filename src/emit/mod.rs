//! Writers: everything a build leaves behind, from one plain value, [`Compiled`].

use crate::base::json;
use crate::chain_input::Simulation;
use crate::compiled::Compiled;

mod bill_row;
pub mod bom;
mod draw_error;
mod drawing;
pub mod dxf;
pub mod freedom;
pub mod gltf;
pub mod layout;
mod layout_report;
pub mod outside;
mod own_numbers;
pub mod paper;
pub mod pareto;
pub mod pdf;
mod plan;
pub mod png;
pub mod svg;
pub mod xlsx;

pub use crate::source::disk::{Files, WriteError};
pub use draw_error::DrawError;
pub use drawing::{change_png, change_svg, drawing_files, drawing_pdf, stages_pdf, stages_png, stages_svg};
pub use layout_report::pdf as report_pdf;
pub use own_numbers::{OwnNumbers, own_numbers};
#[cfg(test)]
pub use plan::samples;

/// The data outputs, name and content: `layout.json`, `simulation.json`, `bom.csv` and `bom.json`.
pub fn data_files(compiled: &Compiled, own: &OwnNumbers) -> Vec<(String, Vec<u8>)> {
    vec![
        ("layout.json".to_owned(), layout::json(compiled)),
        ("simulation.json".to_owned(), json::to_json(&Simulation::new(compiled))),
        ("bom.csv".to_owned(), bom::csv(compiled, own)),
        ("bom.json".to_owned(), bom::json(compiled, own)),
    ]
}
