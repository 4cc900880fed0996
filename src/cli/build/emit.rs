//! What `--emit` takes, and what is said where something else is asked of it that a build writes in another way.

use clap::builder::{EnumValueParser, PossibleValue, TypedValueParser};
use clap::error::ErrorKind;
use clap::{Arg, Command, Error, ValueEnum};
use std::ffi::OsStr;

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Emit {
    /// The checked layout with every default filled in.
    Model,
    /// The optimisation problem, each row with its source line.
    Problem,
    /// What the layout is still free to do, and what each row at its limit costs; with -o freedom.txt and freedom.json.
    Freedom,
    /// Length against cost, or what --pareto names: layouts that no other one beats; with -o pareto.json and pareto.html.
    Pareto,
    /// The continuous stages for other solvers, with the build: stage1.nl, stage2.nl, names in .row and .col.
    Nl,
    /// The discrete stage without building and obstacles for other solvers, with the build: stage3.mps.
    Mps,
}

/// Reads an [`Emit`], and knows the option that is meant by the name of a kind of file.
#[derive(Clone, Debug)]
pub struct EmitParser;

impl TypedValueParser for EmitParser {
    type Value = Emit;

    fn parse_ref(&self, command: &Command, arg: Option<&Arg>, value: &OsStr) -> Result<Emit, Error> {
        match value.to_str().and_then(instead) {
            Some(instead) => {
                let words = format!("--emit {}: {instead}\n", value.to_string_lossy());
                Err(Error::raw(ErrorKind::InvalidValue, words).with_cmd(command))
            }
            None => EnumValueParser::<Emit>::new().parse_ref(command, arg, value),
        }
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(Emit::value_variants().iter().filter_map(ValueEnum::to_possible_value)))
    }
}

/// What to write instead of `--emit` with the name of a kind of file.
fn instead(name: &str) -> Option<&'static str> {
    Some(match name.to_ascii_lowercase().as_str() {
        "gltf" | "glb" => "use --gltf, which writes the layout in space as track.glb",
        "xlsx" | "xls" => "use --xlsx, which writes the bill as bom.xlsx",
        "pdf" => "use --pdf, which writes drawing.pdf, or --report, which writes report.pdf",
        "report" => "use --report, which writes report.pdf",
        "stages" => "use --stages, which writes stages.svg and stages.png",
        "svg" | "png" | "dxf" => "every build writes the drawing, as drawing.svg, drawing.png and drawing.dxf",
        "bom" | "csv" => "every build writes the bill, as bom.csv and bom.json",
        "json" | "layout" => {
            "every build writes layout.json and simulation.json; --format json prints the summary as JSON"
        }
        "step" | "stp" | "iges" | "igs" | "ifc" => {
            "lss writes no solids; use --gltf, which writes the layout in space as track.glb, and drawing.dxf, which every \
             build writes, for the plan"
        }
        _ => return None,
    })
}
