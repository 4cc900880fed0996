//! Entities of a DXF R2000 file: in model space, in paper space and in blocks.
//!
//! Written here, because a drawing needs few kinds of records, and the crate for DXF, with which tests read it back, is
//! a second opinion on them only as long as it is not the writer, too.

use crate::base::trig;
use crate::emit::plan::PlanCurve;
use crate::geometry::Point;

use super::tags::{Tags, escape};

/// A layer: name, AutoCAD colour index, line type, line weight in 0.01 mm.
#[derive(Clone, Copy, Debug)]
pub struct Layer {
    pub name: &'static str,
    pub colour: u8,
    pub line_type: &'static str,
    pub weight: u16,
}

// Owners need handles before they are written.
pub const MODEL_SPACE: u32 = 1;
pub const PAPER_SPACE: u32 = 2;
pub const ROOT: u32 = 3;
pub const MODEL_LAYOUT: u32 = 4;
pub const PAPER_LAYOUT: u32 = 5;
const FIRST_FREE: u32 = 0x20;

/// How a text stands at its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    Middle,
    /// At the left end of its base line.
    Left,
}

/// A block: a name, and the entities in it.
pub struct Block {
    pub name: String,
    /// Of its record.
    pub handle: u32,
    /// 1: of a dimension; 2: with attributes.
    pub flags: i64,
    pub entities: String,
}

/// Tag, prompt and value of an attribute.
pub type Attribute = (&'static str, &'static str, String);

/// A drawing: model space in m, a sheet in paper space in mm.
pub struct Writer {
    pub layers: &'static [Layer],
    /// m
    pub text_height: f64,
    pub tags: Tags,
    pub blocks: Vec<Block>,
    /// Of model space.
    pub extents: Vec<Point>,
    owner: u32,
}

impl Writer {
    /// `text_height` (m) also scales the line types.
    pub fn new(layers: &'static [Layer], text_height: f64) -> Self {
        let (tags, blocks, extents) = (Tags::new(FIRST_FREE), Vec::new(), Vec::new());
        Writer { layers, text_height, tags, blocks, extents, owner: MODEL_SPACE }
    }

    fn entity(&mut self, kind: &str, layer: &str, class: &str) -> u32 {
        self.tags.entity(kind, self.owner, self.owner == PAPER_SPACE, layer, class)
    }

    /// What `draw` draws lies on the sheet.
    pub fn on_paper(&mut self, draw: impl FnOnce(&mut Self)) {
        let (owner, extents) = (std::mem::replace(&mut self.owner, PAPER_SPACE), self.extents.len());
        draw(self);
        self.owner = owner;
        self.extents.truncate(extents);
    }

    /// What `draw` draws is a block.
    pub fn block(&mut self, name: String, flags: i64, draw: impl FnOnce(&mut Self)) {
        let handle = self.tags.fresh();
        let outside = std::mem::take(&mut self.tags.out);
        let (owner, extents) = (std::mem::replace(&mut self.owner, handle), self.extents.len());
        draw(self);
        self.owner = owner;
        self.extents.truncate(extents);
        let entities = std::mem::replace(&mut self.tags.out, outside);
        self.blocks.push(Block { name, handle, flags, entities });
    }

    fn reaches(&mut self, points: impl IntoIterator<Item = Point>) {
        self.extents.extend(points);
    }

    pub fn line(&mut self, layer: &str, a: Point, b: Point) {
        self.entity("LINE", layer, "AcDbLine");
        self.tags.point(10, a);
        self.tags.point(11, b);
        self.reaches([a, b]);
    }

    /// A LINE, or an ARC, which DXF draws counter-clockwise whatever the curve's sense.
    pub fn curve(&mut self, layer: &str, curve: &PlanCurve) {
        match *curve {
            PlanCurve::Line { begin, end } => self.line(layer, begin, end),
            PlanCurve::Arc { centre, radius, start, sweep } => {
                self.entity("ARC", layer, "AcDbCircle");
                self.tags.point(10, centre);
                self.tags.real(40, radius);
                self.tags.text(100, "AcDbArc");
                let degrees = |angle: f64| angle * 180.0 / trig::PI;
                let from = degrees(if sweep < 0.0 { start + sweep } else { start }).rem_euclid(360.0);
                self.tags.real(50, from);
                self.tags.real(51, (from + degrees(sweep.abs())).rem_euclid(360.0));
                let (low, high) = curve.bounds();
                self.reaches([low, high]);
            }
        }
    }

    /// A closed LWPOLYLINE.
    pub fn polygon(&mut self, layer: &str, points: &[Point]) {
        self.entity("LWPOLYLINE", layer, "AcDbPolyline");
        self.tags.int(90, points.len() as i64);
        self.tags.int(70, 1);
        for p in points {
            self.tags.pair(10, *p);
        }
        self.reaches(points.iter().copied());
    }

    /// A filled triangle.
    pub fn triangle(&mut self, layer: &str, [a, b, c]: [Point; 3]) {
        self.entity("SOLID", layer, "AcDbTrace");
        for (code, p) in [(10, a), (11, b), (12, c), (13, c)] {
            self.tags.point(code, p);
        }
    }

    pub fn circle(&mut self, layer: &str, centre: Point, radius: f64) {
        self.entity("CIRCLE", layer, "AcDbCircle");
        self.tags.point(10, centre);
        self.tags.real(40, radius);
        self.reaches([centre - Point::new(radius, radius), centre + Point::new(radius, radius)]);
    }

    pub fn node(&mut self, layer: &str, at: Point) {
        self.entity("POINT", layer, "AcDbPoint");
        self.tags.point(10, at);
        self.reaches([at]);
    }

    /// Centred text of the drawing's height, turned by `angle` (rad).
    pub fn text(&mut self, layer: &str, at: Point, angle: f64, text: &str) {
        self.sized_text(layer, at, angle, self.text_height, Align::Middle, text);
    }

    /// Text of any height.
    pub fn sized_text(&mut self, layer: &str, at: Point, angle: f64, height: f64, align: Align, text: &str) {
        self.entity("TEXT", layer, "AcDbText");
        self.tags.point(10, at);
        self.tags.real(40, height);
        self.tags.text(1, &escape(text));
        self.tags.real(50, angle * 180.0 / trig::PI);
        self.tags.text(7, "Standard");
        if align == Align::Middle {
            self.tags.int(72, 1);
            self.tags.point(11, at);
        }
        self.tags.text(100, "AcDbText");
        if align == Align::Middle {
            self.tags.int(73, 2);
        }
    }

    /// Inserts a block with values of its attributes; `stretch` scales it along its own x axis.
    pub fn insert(&mut self, layer: &str, block: &str, at: Point, angle: f64, stretch: f64, values: &[Attribute]) {
        let insert = self.entity("INSERT", layer, "AcDbBlockReference");
        if !values.is_empty() {
            self.tags.int(66, 1);
        }
        self.tags.text(2, block);
        self.tags.point(10, at);
        self.tags.real(41, stretch);
        self.tags.real(42, 1.0);
        self.tags.real(43, 1.0);
        self.tags.real(50, (angle * 180.0 / trig::PI).rem_euclid(360.0));
        let paper = self.owner == PAPER_SPACE;
        for (tag, _, value) in values {
            self.tags.entity("ATTRIB", insert, paper, layer, "AcDbText");
            self.tags.point(10, at);
            self.tags.real(40, self.text_height);
            self.tags.text(1, &escape(value));
            self.tags.text(7, "Standard");
            self.tags.text(100, "AcDbAttribute");
            self.tags.text(2, tag);
            self.tags.int(70, INVISIBLE);
        }
        if !values.is_empty() {
            self.tags.entity("SEQEND", insert, paper, layer, "");
        }
    }

    /// What attributes a block has, with what they are when nothing else is said.
    pub fn attribute(&mut self, layer: &str, (tag, prompt, value): &Attribute) {
        self.entity("ATTDEF", layer, "AcDbText");
        self.tags.point(10, Point::default());
        self.tags.real(40, self.text_height);
        self.tags.text(1, &escape(value));
        self.tags.text(7, "Standard");
        self.tags.text(100, "AcDbAttributeDefinition");
        self.tags.text(3, prompt);
        self.tags.text(2, tag);
        self.tags.int(70, INVISIBLE);
    }

    /// The head of a DIMENSION, whose picture is the block of this name: kind of dimension, a point of its line, the
    /// middle of its text, what it measures, and what its text is instead of that.
    #[allow(clippy::too_many_arguments)]
    pub fn dimension(
        &mut self,
        layer: &str,
        block: &str,
        kind: i64,
        on_line: Point,
        text_at: Point,
        measured: f64,
        text: &str,
    ) {
        self.entity("DIMENSION", layer, "AcDbDimension");
        self.tags.text(2, block);
        self.tags.point(10, on_line);
        self.tags.point(11, text_at);
        // The block belongs to this dimension alone.
        self.tags.int(70, 32 + kind);
        if !text.is_empty() {
            self.tags.text(1, text);
        }
        self.tags.int(71, 5);
        self.tags.real(42, measured);
        self.tags.text(3, "Standard");
    }

    /// A window on model space: where it lies on paper (mm), its middle in the model (m) and how high it shows (m).
    pub fn viewport(&mut self, id: i64, (low, high): (Point, Point), looks_at: Point, tall: f64) -> u32 {
        let handle = self.entity("VIEWPORT", "VIEWPORTS", "AcDbViewport");
        let tags = &mut self.tags;
        tags.point(10, (low + high) * 0.5);
        tags.real(40, high.x - low.x);
        tags.real(41, high.y - low.y);
        tags.int(68, id);
        tags.int(69, id);
        tags.pair(12, looks_at);
        for code in [13, 14, 15] {
            tags.pair(code, if code == 13 { Point::default() } else { Point::new(1.0, 1.0) });
        }
        tags.point(16, Point::default());
        tags.out.truncate(tags.out.len() - " 36\n0.0\n".len());
        tags.real(36, 1.0);
        tags.point(17, Point::default());
        tags.real(42, 50.0);
        for code in [43, 44] {
            tags.real(code, 0.0);
        }
        tags.real(45, tall);
        for code in [50, 51] {
            tags.real(code, 0.0);
        }
        tags.int(72, 1000);
        // Locked: its scale is the sheet's.
        tags.int(90, if id > 1 { 0x4000 } else { 0 });
        tags.text(1, "");
        tags.int(281, 0);
        tags.int(71, 0);
        tags.int(74, 0);
        handle
    }
}

/// Attributes are data: the drawing shows what they say in other ways.
const INVISIBLE: i64 = 1;
