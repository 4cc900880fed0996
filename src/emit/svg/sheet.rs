//! The sheet: size, frame (ISO 5457), scale (ISO 5455, with the 1:25 and 1:250 that buildings are drawn in), and the
//! way from the floor to paper.

use crate::base::trig;
use crate::emit::DrawError;
use crate::emit::paper::{PaperPoint, Projection};
use crate::geometry::Point;

use super::text::{self, Height};
use super::xml::{XmlElement, number};

/// Height of the strip under the drawing, which holds legend, scale bar and title block, mm.
pub const STRIP: f64 = 62.0;
/// Paper left free between the layout and the drawing area's edge for what is written around it, mm.
const MARGIN: f64 = 21.0;
/// A layout that fills this share of the drawing area in one direction needs no larger sheet.
const FILLED: f64 = 0.5;
/// Mean length of a section, mm on paper, under which a larger sheet is taken.
const SECTION: f64 = 36.0;
/// Largest share of the sheet's width that tables take.
const TABLES: f64 = 0.4;
/// Width of the band on paper that shows what lies in it, mm.
const BAND: f64 = 4.0;

/// Name, width and height, mm; landscape.
const SIZES: [(&str, f64, f64); 4] =
    [("A3", 420.0, 297.0), ("A2", 594.0, 420.0), ("A1", 841.0, 594.0), ("A0", 1189.0, 841.0)];

/// Factors of a decade.
const STEPS: [f64; 4] = [1.0, 2.0, 2.5, 5.0];

/// A rectangle on paper, mm, y down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperArea {
    pub low: PaperPoint,
    pub high: PaperPoint,
}

impl PaperArea {
    pub fn width(&self) -> f64 {
        self.high.x - self.low.x
    }

    pub fn height(&self) -> f64 {
        self.high.y - self.low.y
    }
}

/// What is to be drawn.
pub struct Extent {
    /// Smallest and largest coordinates, m.
    pub low: Point,
    pub high: Point,
    /// Of the track, m.
    pub length: f64,
    pub sections: usize,
    /// Of the band, m.
    pub band: f64,
    /// Height that notes take away from the drawing area, mm.
    pub notes: f64,
    /// Height that a height profile takes away from it, mm.
    pub profile: f64,
    /// Tables at its right side.
    pub table: TableSize,
}

/// Lines of tables, and how wide one is, mm.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct TableSize {
    pub lines: usize,
    pub width: f64,
}

/// Height of a line of a table, mm.
pub const TABLE_LINE: f64 = 3.6;
/// Room over and under a column of lines together, mm.
pub const TABLE_ROOM: f64 = 10.0;

/// How many lines a column holds that is this high, mm.
pub fn table_lines(height: f64) -> usize {
    ((height - TABLE_ROOM) / TABLE_LINE).floor().max(1.0) as usize
}

/// A sheet with its drawing area and scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheet {
    pub size: &'static str,
    pub width: f64,
    pub height: f64,
    /// 1 : scale
    pub scale: f64,
    /// Drawing, height profile under it, notes under that, tables beside them, and the strip under all.
    pub drawing: PaperArea,
    pub tables: PaperArea,
    /// Whether the tables hold all of their lines.
    pub holds_tables: bool,
    pub profile: PaperArea,
    pub notes: PaperArea,
    pub strip: PaperArea,
    projection: Projection,
}

impl Sheet {
    /// The smallest sheet that the layout fills at a standard scale.
    pub fn choose(extent: &Extent) -> Result<Sheet, DrawError> {
        let span = extent.high - extent.low;
        if !(span.x.is_finite() && span.y.is_finite() && span.x.max(span.y) > 0.0 && span.x.max(span.y) < 1e7) {
            return Err(DrawError::Extent);
        }
        let mut best: Option<(f64, Sheet)> = None;
        for (size, width, height) in SIZES {
            let sheet = Sheet::fit(size, width, height, extent, span);
            let fill = sheet.fill(span);
            let section = 1000.0 * extent.length / extent.sections.max(1) as f64 / sheet.scale;
            let band = sheet.mm(extent.band);
            if fill >= FILLED && section >= SECTION && band >= BAND && sheet.holds_tables {
                return Ok(sheet);
            }
            // Room for every section and a band that can be read come before a filled sheet.
            let whole = if sheet.holds_tables { 1.0 } else { 0.0 };
            let merit = (section / SECTION).min(1.0) + (band / BAND).min(1.0) + whole + 0.1 * fill;
            if best.is_none_or(|(least, _)| merit > least + 1e-9) {
                best = Some((merit, sheet));
            }
        }
        best.map(|(_, sheet)| sheet).ok_or(DrawError::Extent)
    }

    fn fit(size: &'static str, width: f64, height: f64, extent: &Extent, span: Point) -> Sheet {
        let inside = PaperArea { low: PaperPoint::new(20.0, 10.0), high: PaperPoint::new(width - 10.0, height - 10.0) };
        let strip = PaperArea { low: PaperPoint::new(inside.low.x, inside.high.y - STRIP), high: inside.high };
        let columns = extent.table.lines.div_ceil(table_lines(strip.low.y - inside.low.y));
        let most = if extent.table.width > 0.0 { (TABLES * width / extent.table.width).floor() as usize } else { 0 };
        let right = inside.high.x - columns.min(most) as f64 * extent.table.width;
        let tables =
            PaperArea { low: PaperPoint::new(right, inside.low.y), high: PaperPoint::new(inside.high.x, strip.low.y) };
        let notes = PaperArea {
            low: PaperPoint::new(inside.low.x, strip.low.y - extent.notes.min(0.4 * height)),
            high: PaperPoint::new(right, strip.low.y),
        };
        let profile = PaperArea {
            low: PaperPoint::new(inside.low.x, notes.low.y - extent.profile),
            high: PaperPoint::new(right, notes.low.y),
        };
        let drawing = PaperArea { low: inside.low, high: PaperPoint::new(right, profile.low.y) };
        let room = PaperPoint::new(drawing.width() - 2.0 * MARGIN, drawing.height() - 2.0 * MARGIN);
        let needed = (1000.0 * span.x / room.x).max(1000.0 * span.y / room.y);
        let scale = standard_scale(needed);
        let middle = (drawing.low + drawing.high) * 0.5;
        let centre = (extent.low + extent.high) * 0.5;
        let millimetres = 1000.0 / scale;
        let origin = middle - Projection::turned(centre) * millimetres;
        let projection = Projection { floor: Point::default(), paper: origin, scale: millimetres };
        let holds_tables = columns <= most;
        Sheet { size, width, height, scale, drawing, tables, holds_tables, profile, notes, strip, projection }
    }

    /// An A3 sheet at a standard scale, with a panel of this width (mm) at the right of its drawing.
    pub fn beside(extent: &Extent, panel: f64) -> Result<(Sheet, PaperArea), DrawError> {
        let span = extent.high - extent.low;
        if !(span.x.is_finite() && span.y.is_finite() && span.x.max(span.y) > 0.0 && span.x.max(span.y) < 1e7) {
            return Err(DrawError::Extent);
        }
        let (size, width, height) = SIZES[0];
        // Fitted to a sheet that ends where the panel begins, and widened by it.
        let mut sheet = Sheet::fit(size, width - panel, height, extent, span);
        let panel = PaperArea {
            low: PaperPoint::new(sheet.drawing.high.x, sheet.drawing.low.y),
            high: PaperPoint::new(sheet.drawing.high.x + panel, sheet.drawing.high.y),
        };
        sheet.width = width;
        sheet.strip.high.x = panel.high.x;
        sheet.notes.high.x = panel.high.x;
        Ok((sheet, panel))
    }

    /// A sheet that is as large as the layout with a margin (mm) at the largest scale at which it keeps within so much
    /// room, mm: for screens, which have neither standard sizes nor scales.
    pub fn around(extent: &Extent, room: PaperPoint, margin: f64) -> Result<Sheet, DrawError> {
        let span = extent.high - extent.low;
        if !(span.x.is_finite() && span.y.is_finite() && span.x.max(span.y) > 0.0 && span.x.max(span.y) < 1e7) {
            return Err(DrawError::Extent);
        }
        let free = PaperPoint::new(room.x - 2.0 * margin, room.y - 2.0 * margin);
        let scale = 1000.0 * (span.x / free.x).max(span.y / free.y);
        let millimetres = 1000.0 / scale;
        let size = Projection::turned(span) * millimetres;
        let (width, height) = (size.x + 2.0 * margin, -size.y + 2.0 * margin);
        let end = PaperPoint::new(width, height);
        let (none, drawing) = (PaperArea { low: end, high: end }, PaperArea { low: PaperPoint::default(), high: end });
        let paper = PaperPoint::new(margin, height - margin);
        Ok(Sheet {
            size: "screen",
            width,
            height,
            scale,
            drawing,
            tables: none,
            holds_tables: true,
            profile: none,
            notes: none,
            strip: none,
            projection: Projection { floor: extent.low, paper, scale: millimetres },
        })
    }

    fn fill(&self, span: Point) -> f64 {
        let room = PaperPoint::new(self.drawing.width() - 2.0 * MARGIN, self.drawing.height() - 2.0 * MARGIN);
        (self.mm(span.x) / room.x).max(self.mm(span.y) / room.y)
    }

    /// A length on paper, mm.
    pub fn mm(&self, metres: f64) -> f64 {
        metres * 1000.0 / self.scale
    }

    /// A point of the floor on paper.
    pub fn at(&self, p: Point) -> PaperPoint {
        self.projection.at(p)
    }

    /// The point of the floor that lies here on paper.
    pub fn floor(&self, p: PaperPoint) -> Point {
        self.projection.floor_at(p)
    }

    /// The frame with its centring marks and reference grid.
    pub fn frame(&self) -> XmlElement {
        let mut group = XmlElement::group("sheet");
        group.push(XmlElement::new("rect").attr("class", "ground").num("width", self.width).num("height", self.height));
        let (low, high) = (self.drawing.low, self.strip.high);
        group.push(rectangle(low, high, "frame"));
        let (outer_low, outer_high) = (low - PaperPoint::new(5.0, 5.0), high + PaperPoint::new(5.0, 5.0));
        group.push(rectangle(outer_low, outer_high, "rule"));
        let middle = PaperPoint::new(self.width / 2.0, self.height / 2.0);
        let mut rules = String::new();
        let mut rule = |a: PaperPoint, b: PaperPoint| {
            rules.push_str(&path_line(a, b));
        };
        let fields = |length: f64| 2 * (length / 100.0).round().max(1.0) as usize;
        let (columns, rows) = (fields(self.width), fields(self.height));
        let column = |i: usize| low.x + (high.x - low.x) * i as f64 / columns as f64;
        let row = |i: usize| low.y + (high.y - low.y) * i as f64 / rows as f64;
        for i in 1..columns {
            rule(PaperPoint::new(column(i), outer_low.y), PaperPoint::new(column(i), low.y));
            rule(PaperPoint::new(column(i), high.y), PaperPoint::new(column(i), outer_high.y));
        }
        for i in 1..rows {
            rule(PaperPoint::new(outer_low.x, row(i)), PaperPoint::new(low.x, row(i)));
            rule(PaperPoint::new(high.x, row(i)), PaperPoint::new(outer_high.x, row(i)));
        }
        group.push(path(&rules, "rule"));
        let marks = [
            (PaperPoint::new(middle.x, outer_low.y), PaperPoint::new(middle.x, low.y + 5.0)),
            (PaperPoint::new(middle.x, high.y), PaperPoint::new(middle.x, outer_high.y)),
            (PaperPoint::new(outer_low.x, middle.y), PaperPoint::new(low.x + 5.0, middle.y)),
            (PaperPoint::new(high.x - 5.0, middle.y), PaperPoint::new(outer_high.x, middle.y)),
        ];
        group.push(path(&marks.map(|(a, b)| path_line(a, b)).concat(), "frame"));
        let between = |a: f64, b: f64| (a + b) / 2.0;
        for i in 0..columns {
            let x = between(column(i), column(i + 1));
            for y in [outer_low.y + 2.5, high.y + 2.5] {
                group.push(text::centred(PaperPoint::new(x, y), 0.0, (i + 1).to_string(), Height::H18, "quiet"));
            }
        }
        for i in 0..rows {
            // Letters without I and O (ISO 5457).
            let letter = "ABCDEFGHJKLMNPQRSTUVWXYZ".chars().nth(i).unwrap_or('Z').to_string();
            let y = between(row(i), row(i + 1));
            for x in [outer_low.x + 2.5, high.x + 2.5] {
                group.push(text::centred(PaperPoint::new(x, y), 0.0, letter.clone(), Height::H18, "quiet"));
            }
        }
        group
    }
}

/// The smallest standard scale that is at least `needed`.
fn standard_scale(needed: f64) -> f64 {
    let mut decade = 10.0;
    loop {
        for step in STEPS {
            if decade * step >= needed {
                return decade * step;
            }
        }
        decade *= 10.0;
    }
}

pub fn rectangle(low: PaperPoint, high: PaperPoint, class: &str) -> XmlElement {
    XmlElement::new("rect")
        .attr("class", class)
        .num("x", low.x)
        .num("y", low.y)
        .num("width", high.x - low.x)
        .num("height", high.y - low.y)
}

pub fn path(data: &str, class: &str) -> XmlElement {
    XmlElement::new("path").attr("class", class).attr("d", data)
}

/// `x y`, as the data of paths have it.
pub fn coordinates(p: PaperPoint) -> String {
    format!("{} {}", number(p.x), number(p.y))
}

/// `M a L b`
pub fn path_line(a: PaperPoint, b: PaperPoint) -> String {
    format!("M{}L{}", coordinates(a), coordinates(b))
}

/// A closed path through points.
pub fn polygon(points: &[PaperPoint]) -> String {
    let mut data = String::new();
    for (i, p) in points.iter().enumerate() {
        data.push(if i == 0 { 'M' } else { 'L' });
        data.push_str(&coordinates(*p));
    }
    data.push('Z');
    data
}

/// Degrees, clockwise on paper, at which text along this paper direction reads from below or from the right.
pub fn reading_angle(direction: PaperPoint) -> f64 {
    let degrees = trig::atan2(direction.y, direction.x) * 180.0 / trig::PI;
    let turned = if degrees > 90.0 - 1e-6 {
        degrees - 180.0
    } else if degrees < -90.0 - 1e-6 {
        degrees + 180.0
    } else {
        degrees
    };
    if turned.abs() < 1e-6 { 0.0 } else { turned }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn extent(width: f64, height: f64, length: f64, sections: usize) -> Extent {
        Extent {
            low: Point::new(-1.0, 2.0),
            high: Point::new(width - 1.0, height + 2.0),
            length,
            sections,
            band: 1.2,
            notes: 0.0,
            profile: 0.0,
            table: TableSize::default(),
        }
    }

    #[test]
    fn scales_are_standard_and_the_layout_fits() {
        for (width, height) in [(0.5, 0.3), (10.0, 6.0), (112.0, 62.0), (30.0, 200.0), (5000.0, 40.0)] {
            let extent = extent(width, height, 2.0 * (width + height), 4);
            let sheet = Sheet::choose(&extent).expect("fits");
            let (low, high) = (sheet.at(extent.low), sheet.at(extent.high));
            assert!(low.x >= sheet.drawing.low.x + MARGIN - 1e-9 && high.x <= sheet.drawing.high.x - MARGIN + 1e-9);
            assert!(high.y >= sheet.drawing.low.y + MARGIN - 1e-9 && low.y <= sheet.drawing.high.y - MARGIN + 1e-9);
        }
        assert_eq!(
            [7.0, 11.0, 21.0, 49.0, 250.0, 251.0, 1001.0].map(standard_scale),
            [10.0, 20.0, 25.0, 50.0, 250.0, 500.0, 2000.0]
        );
    }

    #[test]
    fn tables_take_room_from_the_drawing() {
        let extent = Extent { table: TableSize { lines: 100, width: 60.0 }, ..extent(112.0, 62.0, 150.0, 10) };
        let sheet = Sheet::choose(&extent).expect("fits");
        let columns = 100_usize.div_ceil(table_lines(sheet.tables.height()));
        assert!((sheet.tables.width() - 60.0 * columns as f64).abs() < 1e-9 && sheet.holds_tables);
        assert!(sheet.drawing.high.x == sheet.tables.low.x && sheet.at(extent.high).x < sheet.tables.low.x - MARGIN);
        let endless = Extent { table: TableSize { lines: 100_000, width: 60.0 }, ..extent };
        let sheet = Sheet::choose(&endless).expect("fits");
        assert!(!sheet.holds_tables && sheet.tables.width() <= TABLES * sheet.width);
    }

    #[test]
    fn no_extent_is_an_error() {
        for width in [f64::NAN, f64::INFINITY, 0.0, 1e9] {
            assert_eq!(Sheet::choose(&extent(width, 0.0, 1.0, 4)), Err(DrawError::Extent));
        }
    }

    #[test]
    fn text_never_stands_on_its_head() {
        assert_eq!(reading_angle(PaperPoint::new(-1.0, 0.0)), 0.0);
        assert_eq!(reading_angle(PaperPoint::new(0.0, 1.0)), -90.0);
        assert_eq!(reading_angle(PaperPoint::new(0.0, -1.0)), -90.0);
        assert!((reading_angle(PaperPoint::new(-1.0, -1.0)) - 45.0).abs() < 1e-9);
    }
}
