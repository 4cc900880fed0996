//! What holds a layout: `freedom.txt` for people, `freedom.json` for machines.

use crate::base::json;
use crate::base::number::{fixed, trimmed};
use crate::base::trig::PI;
use crate::compiled::Compiled;
use crate::solve::{ActiveRow, Freedom, Hold, VertexFreedom, freedom};
use crate::source::SourceMap;
use serde::Serialize;
use std::fmt::Write;

/// Both documents.
#[derive(Clone, Debug)]
pub struct Table {
    pub text: String,
    json: Vec<u8>,
}

impl Table {
    /// At the optimum of the last continuous stage, or as written.
    pub fn new(compiled: &Compiled, sources: &SourceMap) -> Self {
        let continuous = compiled.stages.iter().rfind(|stage| matches!(stage.name, "stage1" | "stage2" | "written"));
        match continuous.map(|stage| freedom(&compiled.layout, stage)) {
            Some(freedom) => {
                Table { text: text(&freedom, &compiled.layout.name, sources), json: json(&freedom, sources) }
            }
            None => Table { text: String::new(), json: Vec::new() },
        }
    }

    pub fn files(&self) -> [(String, Vec<u8>); 2] {
        [("freedom.txt".to_owned(), self.text.clone().into_bytes()), ("freedom.json".to_owned(), self.json.clone())]
    }
}

/// A table of vertices, then one of rows.
fn text(freedom: &Freedom, layout: &str, sources: &SourceMap) -> String {
    let mut out = format!("freedom of {layout}, {}: {} m\n", freedom.stage, fixed(freedom.length, 5));
    let ways = match freedom.degrees {
        0 => "nothing can move without leaving a limit".to_owned(),
        1 => "the layout can still move in one way".to_owned(),
        n => format!("the layout can still move in {n} independent ways"),
    };
    let _ = writeln!(out, "{ways}\n\nvertex       position                radius");
    for vertex in &freedom.vertices {
        let position = match (vertex.position, vertex.directions) {
            (Hold::Free, 1) => "free in one direction",
            (hold, _) => word(hold),
        };
        let _ = writeln!(out, "  {:<10} {position:<23} {}", vertex.vertex, word(vertex.radius));
    }
    out += "\nrows at their limit\n";
    for row in &freedom.rows {
        let name = format!("{} {}", row.row, limit(row));
        let _ = writeln!(out, "  {name:<62} {:<58} // {}", row.words, sources.place(row.span));
    }
    out
}

/// `freedom.json`; numbers in SI.
#[derive(Serialize)]
struct Document<'a> {
    stage: &'a str,
    length_m: f64,
    degrees_of_freedom: usize,
    vertices: &'a [VertexFreedom],
    rows: Vec<RowDocument<'a>>,
}

#[derive(Serialize)]
struct RowDocument<'a> {
    row: &'a str,
    /// `FILE:LINE`
    place: String,
    low: Option<f64>,
    high: Option<f64>,
    unit: &'a str,
    length_per_unit: Option<f64>,
    words: &'a str,
}

impl<'a> RowDocument<'a> {
    fn new(row: &'a ActiveRow, sources: &SourceMap) -> Self {
        let finite = |limit: f64| limit.is_finite().then_some(limit);
        RowDocument {
            row: &row.row,
            place: sources.place(row.span),
            low: finite(row.limit.low),
            high: finite(row.limit.high),
            unit: row.unit,
            length_per_unit: row.length_per_unit,
            words: &row.words,
        }
    }
}

fn json(freedom: &Freedom, sources: &SourceMap) -> Vec<u8> {
    json::to_json(&Document {
        stage: freedom.stage,
        length_m: freedom.length,
        degrees_of_freedom: freedom.degrees,
        vertices: &freedom.vertices,
        rows: freedom.rows.iter().map(|row| RowDocument::new(row, sources)).collect(),
    })
}

fn word(hold: Hold) -> &'static str {
    match hold {
        Hold::Free => "free",
        Hold::Bound => "bound",
        Hold::Fixed => "fixed",
    }
}

/// `>= 0.6 m`, angles in degrees.
pub fn limit(row: &ActiveRow) -> String {
    let (scale, unit) = if row.unit == "rad" { (180.0 / PI, "deg") } else { (1.0, row.unit) };
    let shown = |limit: f64| format!("{} {unit}", trimmed(limit * scale, 6)).trim_end().to_owned();
    let (low, high) = (shown(row.limit.low), shown(row.limit.high));
    match (row.limit.low == row.limit.high, row.limit.low.is_finite()) {
        (true, _) => format!("= {low}"),
        (false, true) => format!(">= {low}"),
        (false, false) => format!("<= {high}"),
    }
}
