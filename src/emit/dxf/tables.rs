//! Header, tables, blocks and objects: what stands around the entities of a DXF file.

use crate::geometry::{Point, bounds};

use super::tags::Tags;
use super::writer::{Layer, MODEL_LAYOUT, MODEL_SPACE, PAPER_LAYOUT, PAPER_SPACE, ROOT, Writer};

/// Line types: name, description and the pattern in text heights.
const LINE_TYPES: [(&str, &str, &[f64]); 5] = [
    ("ByBlock", "", &[]),
    ("ByLayer", "", &[]),
    ("Continuous", "Solid line", &[]),
    ("CENTER", "Centre ____ _ ____", &[6.0, -1.0, 1.0, -1.0]),
    ("DASHED", "Dashed __ __ __", &[2.0, -1.0]),
];

/// The sheet in paper space.
#[derive(Clone, Copy, Debug)]
pub struct Paper {
    /// `A2`
    pub size: &'static str,
    /// mm
    pub width: f64,
    pub height: f64,
    /// Handle of the window on model space.
    pub viewport: u32,
}

/// The whole file.
pub fn finish(mut writer: Writer, paper: &Paper) -> String {
    let (low, high) = bounds(writer.extents.iter().copied());
    let entities = std::mem::take(&mut writer.tags.out);
    let mut tags = Tags::new(writer.tags.next);
    tags.section("CLASSES");
    tags.end_section();
    tables(&writer, &mut tags, low, high);
    blocks(&writer, &mut tags);
    tags.section("ENTITIES");
    tags.out.push_str(&entities);
    tags.end_section();
    objects(&mut tags, paper, low, high);
    tags.text(0, "EOF");
    // The header names the first free handle.
    let mut head = Tags::new(0);
    header(&mut head, low, high, tags.next, writer.text_height);
    head.out + &tags.out
}

fn table(tags: &mut Tags, name: &str, count: usize) -> u32 {
    let handle = tags.fresh();
    tags.text(0, "TABLE");
    tags.text(2, name);
    tags.handle(5, handle);
    tags.handle(330, 0);
    tags.text(100, "AcDbSymbolTable");
    tags.int(70, count as i64);
    if name == "DIMSTYLE" {
        tags.text(100, "AcDbDimStyleTable");
        tags.int(71, 0);
    }
    handle
}

fn record(tags: &mut Tags, table: &str, owner: u32, class: &str, name: &str) {
    let handle = tags.fresh();
    record_with(tags, table, handle, owner, class, name);
}

fn record_with(tags: &mut Tags, table: &str, handle: u32, owner: u32, class: &str, name: &str) {
    tags.text(0, table);
    tags.handle(if table == "DIMSTYLE" { 105 } else { 5 }, handle);
    tags.handle(330, owner);
    tags.text(100, "AcDbSymbolTableRecord");
    tags.text(100, class);
    tags.text(2, name);
}

fn end_table(tags: &mut Tags) {
    tags.text(0, "ENDTAB");
}

fn tables(writer: &Writer, tags: &mut Tags, low: Point, high: Point) {
    let tall = writer.text_height;
    tags.section("TABLES");
    let owner = table(tags, "VPORT", 1);
    record(tags, "VPORT", owner, "AcDbViewportTableRecord", "*Active");
    tags.int(70, 0);
    tags.pair(10, Point::new(0.0, 0.0));
    tags.pair(11, Point::new(1.0, 1.0));
    tags.pair(12, (low + high) * 0.5);
    tags.real(40, 1.1 * (high.y - low.y).max((high.x - low.x) / 1.6).max(1.0));
    tags.real(41, 1.6);
    end_table(tags);

    let owner = table(tags, "LTYPE", LINE_TYPES.len());
    for (name, description, pattern) in LINE_TYPES {
        record(tags, "LTYPE", owner, "AcDbLinetypeTableRecord", name);
        tags.int(70, 0);
        tags.text(3, description);
        tags.int(72, 65);
        tags.int(73, pattern.len() as i64);
        tags.real(40, pattern.iter().map(|dash| dash.abs()).sum::<f64>() * tall);
        for dash in pattern {
            tags.real(49, dash * tall);
            tags.int(74, 0);
        }
    }
    end_table(tags);

    let owner = table(tags, "LAYER", writer.layers.len() + 1);
    let zero = Layer { name: "0", colour: 7, line_type: "Continuous", weight: 25 };
    for layer in std::iter::once(&zero).chain(writer.layers) {
        record(tags, "LAYER", owner, "AcDbLayerTableRecord", layer.name);
        tags.int(70, 0);
        tags.int(62, i64::from(layer.colour));
        tags.text(6, layer.line_type);
        if layer.name == "VIEWPORTS" {
            // The window's edge is not plotted.
            tags.int(290, 0);
        }
        tags.int(370, i64::from(layer.weight));
    }
    end_table(tags);

    let owner = table(tags, "STYLE", 1);
    record(tags, "STYLE", owner, "AcDbTextStyleTableRecord", "Standard");
    tags.int(70, 0);
    for (code, value) in [(40, 0.0), (41, 1.0), (50, 0.0)] {
        tags.real(code, value);
    }
    tags.int(71, 0);
    tags.real(42, tall);
    tags.text(3, "arial.ttf");
    tags.text(4, "");
    end_table(tags);

    for name in ["VIEW", "UCS"] {
        table(tags, name, 0);
        end_table(tags);
    }
    let owner = table(tags, "APPID", 1);
    record(tags, "APPID", owner, "AcDbRegAppTableRecord", "ACAD");
    tags.int(70, 0);
    end_table(tags);
    let owner = table(tags, "DIMSTYLE", 1);
    record(tags, "DIMSTYLE", owner, "AcDbDimStyleTableRecord", "Standard");
    tags.int(70, 0);
    // Scale, arrows, gap and reach of extension lines, gap and height of text, all as large as text.
    for (code, value) in [(40, 1.0), (41, tall), (42, 0.4 * tall), (44, 0.5 * tall), (140, tall), (147, 0.3 * tall)] {
        tags.real(code, value);
    }
    // Text along its line and above it; metres with three decimals and a point.
    for (code, value) in [(73, 0), (74, 0), (77, 1), (78, 0), (271, 3), (277, 2), (278, 46)] {
        tags.int(code, value);
    }
    end_table(tags);
    let owner = table(tags, "BLOCK_RECORD", 2 + writer.blocks.len());
    for (handle, name, layout) in
        [(MODEL_SPACE, "*Model_Space", MODEL_LAYOUT), (PAPER_SPACE, "*Paper_Space", PAPER_LAYOUT)]
    {
        record_with(tags, "BLOCK_RECORD", handle, owner, "AcDbBlockTableRecord", name);
        tags.handle(340, layout);
    }
    for block in &writer.blocks {
        record_with(tags, "BLOCK_RECORD", block.handle, owner, "AcDbBlockTableRecord", &block.name);
        tags.handle(340, 0);
    }
    end_table(tags);
    tags.end_section();
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
    // Line types on the sheet are as long as in the model.
    tags.text(9, "$PSLTSCALE");
    tags.int(70, 0);
    tags.end_section();
}

fn blocks(writer: &Writer, tags: &mut Tags) {
    tags.section("BLOCKS");
    for (owner, name) in [(MODEL_SPACE, "*Model_Space"), (PAPER_SPACE, "*Paper_Space")] {
        block(tags, owner, name, 0, "");
    }
    for b in &writer.blocks {
        block(tags, b.handle, &b.name, b.flags, &b.entities);
    }
    tags.end_section();
}

fn block(tags: &mut Tags, owner: u32, name: &str, flags: i64, entities: &str) {
    let paper = owner == PAPER_SPACE;
    tags.entity("BLOCK", owner, paper, "0", "AcDbBlockBegin");
    tags.text(2, name);
    tags.int(70, flags);
    tags.point(10, Point::default());
    tags.text(3, name);
    tags.text(1, "");
    tags.out.push_str(entities);
    tags.entity("ENDBLK", owner, paper, "0", "AcDbBlockEnd");
}

fn objects(tags: &mut Tags, paper: &Paper, low: Point, high: Point) {
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
    dictionary(tags, layouts, ROOT, &[("Model", MODEL_LAYOUT), ("Sheet", PAPER_LAYOUT)]);
    let sheet = (Point::default(), Point::new(paper.width, paper.height));
    for (order, (handle, name, block, (low, high))) in
        [(MODEL_LAYOUT, "Model", MODEL_SPACE, (low, high)), (PAPER_LAYOUT, "Sheet", PAPER_SPACE, sheet)]
            .into_iter()
            .enumerate()
    {
        let is_sheet = block == PAPER_SPACE;
        tags.text(0, "LAYOUT");
        tags.handle(5, handle);
        tags.handle(330, layouts);
        tags.text(100, "AcDbPlotSettings");
        tags.text(1, "");
        tags.text(2, "none_device");
        let media = format!("ISO_{}_({:.2}_x_{:.2}_MM)", paper.size, paper.width, paper.height);
        tags.text(4, if is_sheet { &media } else { "" });
        tags.text(6, "");
        for code in [40, 41, 42, 43] {
            tags.real(code, 0.0);
        }
        tags.real(44, if is_sheet { paper.width } else { 0.0 });
        tags.real(45, if is_sheet { paper.height } else { 0.0 });
        for code in [46, 47, 48, 49, 140, 141] {
            tags.real(code, 0.0);
        }
        tags.real(142, 1.0);
        tags.real(143, 1.0);
        // Whether it is model space, mm, not turned, all of the layout, at full size.
        tags.int(70, if is_sheet { 0 } else { 1024 });
        tags.int(72, 1);
        tags.int(73, 0);
        tags.int(74, if is_sheet { 5 } else { 1 });
        tags.text(7, "");
        tags.int(75, 16);
        for (code, value) in [(147, 1.0), (148, 0.0), (149, 0.0)] {
            tags.real(code, value);
        }
        tags.text(100, "AcDbLayout");
        tags.text(1, name);
        tags.int(70, 1);
        tags.int(71, order as i64);
        tags.pair(10, low);
        tags.pair(11, high);
        tags.point(12, Point::default());
        tags.point(14, low);
        tags.point(15, high);
        tags.real(146, 0.0);
        tags.point(13, Point::default());
        tags.point(16, Point::new(1.0, 0.0));
        tags.point(17, Point::new(0.0, 1.0));
        tags.int(76, 0);
        tags.handle(330, block);
        if is_sheet {
            tags.handle(331, paper.viewport);
        }
    }
    tags.end_section();
}
