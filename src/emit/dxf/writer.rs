//! The few tables and entities of a DXF R2000 file (AutoCAD 2000 DXF Reference), as text and the same bytes each
//! time: handles are counted, and there are no dates.
//!
//! Written here, because a drawing needs few kinds of records, and the crate for DXF, with which tests read it back, is
//! a second opinion on them only as long as it is not the writer, too.

use std::fmt::Write;

use crate::base::trig;
use crate::emit::plan::PlanCurve;
use crate::geometry::{Point, bounds};

/// A layer: name, AutoCAD colour index, line type, line weight in 0.01 mm.
#[derive(Clone, Copy, Debug)]
pub struct Layer {
    pub name: &'static str,
    pub colour: u8,
    pub line_type: &'static str,
    pub weight: u16,
}

/// Line types: name, description and the pattern in text heights.
const LINE_TYPES: [(&str, &str, &[f64]); 5] = [
    ("ByBlock", "", &[]),
    ("ByLayer", "", &[]),
    ("Continuous", "Solid line", &[]),
    ("CENTER", "Centre ____ _ ____", &[6.0, -1.0, 1.0, -1.0]),
    ("DASHED", "Dashed __ __ __", &[2.0, -1.0]),
];

// Owners need handles before they are written.
const MODEL_SPACE: u32 = 1;
const PAPER_SPACE: u32 = 2;
const ROOT: u32 = 3;
const MODEL_LAYOUT: u32 = 4;
const PAPER_LAYOUT: u32 = 5;
const FIRST_FREE: u32 = 0x20;

/// A drawing in model space, m.
pub struct Writer {
    layers: &'static [Layer],
    text_height: f64,
    entities: Tags,
    extents: Vec<Point>,
}

/// Group codes and values, a line each.
struct Tags {
    out: String,
    next: u32,
}

impl Tags {
    fn text(&mut self, code: u16, value: &str) {
        let _ = write!(self.out, "{code:>3}\n{value}\n");
    }

    fn int(&mut self, code: u16, value: i64) {
        let _ = write!(self.out, "{code:>3}\n{value}\n");
    }

    fn real(&mut self, code: u16, value: f64) {
        // Twelve decimals keep a kilometre to the digits of a double; negative zero is zero.
        let text = format!("{:.12}", if value.abs() < 5e-13 { 0.0 } else { value });
        let short = text.trim_end_matches('0');
        let zero = if short.ends_with('.') { "0" } else { "" };
        let _ = write!(self.out, "{code:>3}\n{short}{zero}\n");
    }

    fn point(&mut self, code: u16, p: Point) {
        self.real(code, p.x);
        self.real(code + 10, p.y);
        self.real(code + 20, 0.0);
    }

    fn handle(&mut self, code: u16, handle: u32) {
        let _ = write!(self.out, "{code:>3}\n{handle:X}\n");
    }

    fn fresh(&mut self) -> u32 {
        self.next += 1;
        self.next - 1
    }

    fn table(&mut self, name: &str, count: usize) -> u32 {
        let handle = self.fresh();
        self.text(0, "TABLE");
        self.text(2, name);
        self.handle(5, handle);
        self.handle(330, 0);
        self.text(100, "AcDbSymbolTable");
        self.int(70, count as i64);
        if name == "DIMSTYLE" {
            self.text(100, "AcDbDimStyleTable");
            self.int(71, 0);
        }
        handle
    }

    fn record(&mut self, table: &str, owner: u32, class: &str, name: &str) {
        let handle = self.fresh();
        self.record_with(table, handle, owner, class, name);
    }

    fn record_with(&mut self, table: &str, handle: u32, owner: u32, class: &str, name: &str) {
        self.text(0, table);
        self.handle(if table == "DIMSTYLE" { 105 } else { 5 }, handle);
        self.handle(330, owner);
        self.text(100, "AcDbSymbolTableRecord");
        self.text(100, class);
        self.text(2, name);
    }

    fn end_table(&mut self) {
        self.text(0, "ENDTAB");
    }

    fn section(&mut self, name: &str) {
        self.text(0, "SECTION");
        self.text(2, name);
    }

    fn end_section(&mut self) {
        self.text(0, "ENDSEC");
    }
}

impl Writer {
    /// `text_height` (m) also scales the line types.
    pub fn new(layers: &'static [Layer], text_height: f64) -> Self {
        Writer { layers, text_height, entities: Tags { out: String::new(), next: 0x1000 }, extents: Vec::new() }
    }

    fn entity(&mut self, kind: &str, layer: &str, class: &str) {
        let handle = self.entities.fresh();
        let tags = &mut self.entities;
        tags.text(0, kind);
        tags.handle(5, handle);
        tags.handle(330, MODEL_SPACE);
        tags.text(100, "AcDbEntity");
        tags.text(8, layer);
        tags.text(100, class);
    }

    pub fn line(&mut self, layer: &str, a: Point, b: Point) {
        self.entity("LINE", layer, "AcDbLine");
        self.entities.point(10, a);
        self.entities.point(11, b);
        self.extents.extend([a, b]);
    }

    /// A LINE, or an ARC, which DXF draws counter-clockwise whatever the curve's sense.
    pub fn curve(&mut self, layer: &str, curve: &PlanCurve) {
        match *curve {
            PlanCurve::Line { begin, end } => self.line(layer, begin, end),
            PlanCurve::Arc { centre, radius, start, sweep } => {
                self.entity("ARC", layer, "AcDbCircle");
                self.entities.point(10, centre);
                self.entities.real(40, radius);
                self.entities.text(100, "AcDbArc");
                let degrees = |angle: f64| angle * 180.0 / trig::PI;
                let from = degrees(if sweep < 0.0 { start + sweep } else { start }).rem_euclid(360.0);
                self.entities.real(50, from);
                self.entities.real(51, (from + degrees(sweep.abs())).rem_euclid(360.0));
                let (low, high) = curve.bounds();
                self.extents.extend([low, high]);
            }
        }
    }

    /// A closed LWPOLYLINE.
    pub fn polygon(&mut self, layer: &str, points: &[Point]) {
        self.entity("LWPOLYLINE", layer, "AcDbPolyline");
        self.entities.int(90, points.len() as i64);
        self.entities.int(70, 1);
        for p in points {
            self.entities.real(10, p.x);
            self.entities.real(20, p.y);
        }
        self.extents.extend(points);
    }

    pub fn circle(&mut self, layer: &str, centre: Point, radius: f64) {
        self.entity("CIRCLE", layer, "AcDbCircle");
        self.entities.point(10, centre);
        self.entities.real(40, radius);
        self.extents.extend([centre - Point::new(radius, radius), centre + Point::new(radius, radius)]);
    }

    pub fn node(&mut self, layer: &str, at: Point) {
        self.entity("POINT", layer, "AcDbPoint");
        self.entities.point(10, at);
        self.extents.push(at);
    }

    /// Centred text, turned by `angle` (rad).
    pub fn text(&mut self, layer: &str, at: Point, angle: f64, text: &str) {
        self.entity("TEXT", layer, "AcDbText");
        self.entities.point(10, at);
        self.entities.real(40, self.text_height);
        self.entities.text(1, &escape(text));
        self.entities.real(50, angle * 180.0 / trig::PI);
        self.entities.text(7, "Standard");
        self.entities.int(72, 1);
        self.entities.point(11, at);
        self.entities.text(100, "AcDbText");
        self.entities.int(73, 2);
    }

    pub fn finish(self) -> String {
        let (low, high) = bounds(self.extents.iter().copied());
        let mut tags = Tags { out: String::new(), next: FIRST_FREE };
        header(&mut tags, low, high, self.entities.next, self.text_height);
        tags.section("CLASSES");
        tags.end_section();
        self.tables(&mut tags, low, high);
        blocks(&mut tags);
        tags.section("ENTITIES");
        tags.out.push_str(&self.entities.out);
        tags.end_section();
        objects(&mut tags);
        tags.text(0, "EOF");
        tags.out
    }

    fn tables(&self, tags: &mut Tags, low: Point, high: Point) {
        tags.section("TABLES");
        let owner = tags.table("VPORT", 1);
        tags.record("VPORT", owner, "AcDbViewportTableRecord", "*Active");
        tags.int(70, 0);
        let pair = |tags: &mut Tags, code: u16, p: Point| {
            tags.real(code, p.x);
            tags.real(code + 10, p.y);
        };
        pair(tags, 10, Point::new(0.0, 0.0));
        pair(tags, 11, Point::new(1.0, 1.0));
        pair(tags, 12, (low + high) * 0.5);
        tags.real(40, 1.1 * (high.y - low.y).max((high.x - low.x) / 1.6).max(1.0));
        tags.real(41, 1.6);
        tags.end_table();

        let owner = tags.table("LTYPE", LINE_TYPES.len());
        for (name, description, pattern) in LINE_TYPES {
            tags.record("LTYPE", owner, "AcDbLinetypeTableRecord", name);
            tags.int(70, 0);
            tags.text(3, description);
            tags.int(72, 65);
            tags.int(73, pattern.len() as i64);
            tags.real(40, pattern.iter().map(|dash| dash.abs()).sum::<f64>() * self.text_height);
            for dash in pattern {
                tags.real(49, dash * self.text_height);
                tags.int(74, 0);
            }
        }
        tags.end_table();

        let owner = tags.table("LAYER", self.layers.len() + 1);
        let zero = Layer { name: "0", colour: 7, line_type: "Continuous", weight: 25 };
        for layer in std::iter::once(&zero).chain(self.layers) {
            tags.record("LAYER", owner, "AcDbLayerTableRecord", layer.name);
            tags.int(70, 0);
            tags.int(62, i64::from(layer.colour));
            tags.text(6, layer.line_type);
            tags.int(370, i64::from(layer.weight));
        }
        tags.end_table();

        let owner = tags.table("STYLE", 1);
        tags.record("STYLE", owner, "AcDbTextStyleTableRecord", "Standard");
        tags.int(70, 0);
        tags.real(40, 0.0);
        tags.real(41, 1.0);
        tags.real(50, 0.0);
        tags.int(71, 0);
        tags.real(42, self.text_height);
        tags.text(3, "txt");
        tags.text(4, "");
        tags.end_table();

        for table in ["VIEW", "UCS"] {
            tags.table(table, 0);
            tags.end_table();
        }
        let owner = tags.table("APPID", 1);
        tags.record("APPID", owner, "AcDbRegAppTableRecord", "ACAD");
        tags.int(70, 0);
        tags.end_table();
        let owner = tags.table("DIMSTYLE", 1);
        tags.record("DIMSTYLE", owner, "AcDbDimStyleTableRecord", "Standard");
        tags.int(70, 0);
        tags.end_table();
        let owner = tags.table("BLOCK_RECORD", 2);
        for (handle, name, layout) in
            [(MODEL_SPACE, "*Model_Space", MODEL_LAYOUT), (PAPER_SPACE, "*Paper_Space", PAPER_LAYOUT)]
        {
            tags.record_with("BLOCK_RECORD", handle, owner, "AcDbBlockTableRecord", name);
            tags.handle(340, layout);
        }
        tags.end_table();
        tags.end_section();
    }
}

fn header(tags: &mut Tags, low: Point, high: Point, seed: u32, text_height: f64) {
    tags.section("HEADER");
    for (name, code, value) in [("$ACADVER", 1, "AC1015"), ("$DWGCODEPAGE", 3, "ANSI_1252")] {
        tags.text(9, name);
        tags.text(code, value);
    }
    tags.text(9, "$HANDSEED");
    tags.handle(5, seed);
    for (name, p) in [("$EXTMIN", low), ("$EXTMAX", high)] {
        tags.text(9, name);
        tags.point(10, p);
    }
    // Metres, decimal, metric; vertices show as crosses.
    for (name, value) in
        [("$INSUNITS", 6), ("$MEASUREMENT", 1), ("$LUNITS", 2), ("$LUPREC", 3), ("$AUNITS", 0), ("$PDMODE", 2)]
    {
        tags.text(9, name);
        tags.int(70, value);
    }
    for (name, value) in [("$PDSIZE", 2.0 * text_height), ("$TEXTSIZE", text_height), ("$LTSCALE", 1.0)] {
        tags.text(9, name);
        tags.real(40, value);
    }
    tags.end_section();
}

fn blocks(tags: &mut Tags) {
    tags.section("BLOCKS");
    for (owner, name) in [(MODEL_SPACE, "*Model_Space"), (PAPER_SPACE, "*Paper_Space")] {
        for (kind, class) in [("BLOCK", "AcDbBlockBegin"), ("ENDBLK", "AcDbBlockEnd")] {
            let handle = tags.fresh();
            tags.text(0, kind);
            tags.handle(5, handle);
            tags.handle(330, owner);
            tags.text(100, "AcDbEntity");
            if owner == PAPER_SPACE {
                tags.int(67, 1);
            }
            tags.text(8, "0");
            tags.text(100, class);
            if kind == "BLOCK" {
                tags.text(2, name);
                tags.int(70, 0);
                tags.point(10, Point::default());
                tags.text(3, name);
                tags.text(1, "");
            }
        }
    }
    tags.end_section();
}

fn objects(tags: &mut Tags) {
    tags.section("OBJECTS");
    let (group, layouts) = (tags.fresh(), tags.fresh());
    let dictionary = |tags: &mut Tags, handle: u32, owner: u32, entries: &[(&str, u32)]| {
        tags.text(0, "DICTIONARY");
        tags.handle(5, handle);
        tags.handle(330, owner);
        tags.text(100, "AcDbDictionary");
        tags.int(281, 1);
        for (name, entry) in entries {
            tags.text(3, name);
            tags.handle(350, *entry);
        }
    };
    dictionary(tags, ROOT, 0, &[("ACAD_GROUP", group), ("ACAD_LAYOUT", layouts)]);
    dictionary(tags, group, ROOT, &[]);
    dictionary(tags, layouts, ROOT, &[("Layout1", PAPER_LAYOUT), ("Model", MODEL_LAYOUT)]);
    for (order, (handle, name, block, flags)) in
        [(MODEL_LAYOUT, "Model", MODEL_SPACE, 1024), (PAPER_LAYOUT, "Layout1", PAPER_SPACE, 0)].into_iter().enumerate()
    {
        tags.text(0, "LAYOUT");
        tags.handle(5, handle);
        tags.handle(330, layouts);
        tags.text(100, "AcDbPlotSettings");
        tags.text(1, "");
        tags.int(70, flags);
        tags.text(100, "AcDbLayout");
        tags.text(1, name);
        tags.int(70, 1);
        tags.int(71, order as i64);
        tags.handle(330, block);
    }
    tags.end_section();
}

/// R2000 text is ASCII here: other characters are written by their code point, and control characters left out.
fn escape(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars().filter(|c| !c.is_control()) {
        match c {
            // `%%` begins a control code and `\U+` a character.
            '%' => out.push_str("%%%"),
            '\\' => out.push_str("\\U+005C"),
            ' '..='~' => out.push(c),
            c => {
                for unit in c.encode_utf16(&mut [0; 2]) {
                    let _ = write!(out, "\\U+{unit:04X}");
                }
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_ascii_on_one_line() {
        assert_eq!(escape("R5 90°\n"), "R5 90\\U+00B0");
        assert!(escape("a\\b 50 % 😀").is_ascii());
    }

    #[test]
    fn reals_are_short_and_never_minus_zero() {
        let mut tags = Tags { out: String::new(), next: 0 };
        tags.real(40, -0.0);
        tags.real(40, -1e-14);
        tags.real(40, 2.5);
        assert_eq!(tags.out, " 40\n0.0\n 40\n0.0\n 40\n2.5\n");
    }
}
