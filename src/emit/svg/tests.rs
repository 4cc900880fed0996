//! Whole drawings: well-formed, nothing cut off, no two texts over each other.

use std::path::PathBuf;

use super::*;
use crate::emit::plan::samples;
use crate::emit::{Compiled, drawing_files, stages_png, stages_svg};

fn drawings() -> Vec<(&'static str, Compiled)> {
    vec![
        ("rectangle", samples::rectangle()),
        ("ten_vertices", samples::ten_vertices()),
        ("crowded", samples::crowded()),
        ("failed", samples::failed()),
        ("large", samples::large(60, 20)),
    ]
}

/// Writes the drawings into the folder that `LSS_DRAWINGS` names, to be looked at.
#[test]
#[ignore = "writes files to look at"]
fn write_samples() {
    let folder = PathBuf::from(std::env::var("LSS_DRAWINGS").expect("LSS_DRAWINGS names a folder"));
    for (name, compiled) in drawings() {
        for (file, content) in drawing_files(&compiled).expect("drawn") {
            std::fs::write(folder.join(format!("{name}.{file}")), content).expect("written");
        }
    }
    let (compiled, written) = samples::staged();
    std::fs::write(folder.join("stages.svg"), stages_svg(&compiled, &written).expect("drawn")).expect("written");
    std::fs::write(folder.join("stages.png"), stages_png(&compiled, &written).expect("drawn")).expect("written");
}
