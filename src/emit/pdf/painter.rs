//! A drawing as the content of a PDF page.

use pdf_writer::types::{LineCapStyle, LineJoinStyle, PaintType, TilingType};
use pdf_writer::writers::Resources;
use pdf_writer::{Content, Filter, Finish, Pdf, Rect, Ref, Str};
use resvg::usvg::fontdb::ID;
use resvg::usvg::tiny_skia_path::{Path as PathData, PathSegment};
use resvg::usvg::{
    Color, Fill, FillRule, Group, LineCap, LineJoin, Node, Paint, PaintOrder, Path, Pattern, Stroke, Text, Transform,
    Tree,
};

use super::fonts::Fonts;
use super::{Ids, name, named, packed};
use crate::emit::DrawError;

/// Adjustments between glyphs that are smaller are none, em.
const SAME_PLACE: f32 = 0.001;

/// A page while it is painted.
pub struct Painter<'a> {
    tree: &'a Tree,
    page: Transform,
    ids: &'a mut Ids,
    content: Content,
    fonts: &'a mut Fonts,
    /// Indices of fonts that this page uses, by their number in the page's drawing.
    known: Vec<(ID, usize)>,
    patterns: Vec<(Ref, Tile)>,
    /// Opacities in use, of lines and of areas alike.
    opacities: Vec<f32>,
    error: Option<DrawError>,
}

/// A cell of a hatching.
struct Tile {
    content: Vec<u8>,
    area: Rect,
    step: (f32, f32),
    matrix: Transform,
}

/// A page as it is written.
pub struct Painted {
    pub content: Vec<u8>,
    patterns: Vec<(Ref, Tile)>,
    opacities: Vec<f32>,
}

impl<'a> Painter<'a> {
    pub fn new(tree: &'a Tree, page: Transform, ids: &'a mut Ids, fonts: &'a mut Fonts) -> Self {
        let mut content = Content::new();
        content.transform(matrix(page));
        Painter {
            tree,
            page,
            ids,
            content,
            fonts,
            known: Vec::new(),
            patterns: Vec::new(),
            opacities: Vec::new(),
            error: None,
        }
    }

    /// # Errors
    /// [`DrawError::Raster`] when a font cannot be read.
    pub fn finish(self) -> Result<Painted, DrawError> {
        if let Some(error) = self.error {
            return Err(error);
        }
        Ok(Painted { content: self.content.finish().to_vec(), patterns: self.patterns, opacities: self.opacities })
    }

    /// Everything in a group; drawings clip and mask nothing.
    pub fn group(&mut self, group: &Group) {
        for node in group.children() {
            match node {
                Node::Group(group) => self.group(group),
                Node::Path(path) if path.is_visible() => self.path(path, true),
                Node::Text(text) => self.text(text),
                Node::Path(_) | Node::Image(_) => {}
            }
        }
    }

    /// A path with its stroke and, unless only that is wanted, its area.
    fn path(&mut self, path: &Path, filled: bool) {
        self.content.save_state();
        self.content.transform(matrix(path.abs_transform()));
        let fill = path.fill().filter(|_| filled);
        let stroke_first = path.paint_order() == PaintOrder::StrokeAndFill;
        for strokes in [stroke_first, !stroke_first] {
            match (strokes, fill, path.stroke()) {
                (true, _, Some(stroke)) => {
                    self.stroke_style(stroke);
                    outline(&mut self.content, path.data());
                    self.content.stroke();
                }
                (false, Some(fill), _) => {
                    self.fill_style(fill, path.abs_transform());
                    outline(&mut self.content, path.data());
                    match fill.rule() {
                        FillRule::NonZero => self.content.fill_nonzero(),
                        FillRule::EvenOdd => self.content.fill_even_odd(),
                    };
                }
                _ => {}
            }
        }
        self.content.restore_state();
    }

    fn stroke_style(&mut self, stroke: &Stroke) {
        if let Paint::Color(colour) = stroke.paint() {
            let [r, g, b] = rgb(*colour);
            self.content.set_stroke_rgb(r, g, b);
        }
        self.opacity(stroke.opacity().get());
        self.content.set_line_width(stroke.width().get());
        self.content.set_line_cap(match stroke.linecap() {
            LineCap::Butt => LineCapStyle::ButtCap,
            LineCap::Round => LineCapStyle::RoundCap,
            LineCap::Square => LineCapStyle::ProjectingSquareCap,
        });
        self.content.set_line_join(match stroke.linejoin() {
            LineJoin::Miter | LineJoin::MiterClip => LineJoinStyle::MiterJoin,
            LineJoin::Round => LineJoinStyle::RoundJoin,
            LineJoin::Bevel => LineJoinStyle::BevelJoin,
        });
        self.content.set_dash_pattern(stroke.dasharray().unwrap_or(&[]).iter().copied(), stroke.dashoffset());
    }

    fn fill_style(&mut self, fill: &Fill, transform: Transform) {
        self.opacity(fill.opacity().get());
        match fill.paint() {
            Paint::Color(colour) => {
                let [r, g, b] = rgb(*colour);
                self.content.set_fill_rgb(r, g, b);
            }
            Paint::Pattern(pattern) => {
                let index = self.pattern(pattern, transform);
                self.content.set_fill_color_space(pdf_writer::types::ColorSpaceOperand::Pattern);
                self.content.set_fill_pattern([], name(&named('P', index)));
            }
            // Drawings have none.
            Paint::LinearGradient(_) | Paint::RadialGradient(_) => {}
        }
    }

    /// Sets opacity where it is not full; every element begins with full opacity.
    fn opacity(&mut self, opacity: f32) {
        if opacity >= 1.0 {
            return;
        }
        let known = self.opacities.iter().position(|o| *o == opacity);
        let index = known.unwrap_or(self.opacities.len());
        if known.is_none() {
            self.opacities.push(opacity);
        }
        self.content.set_parameters(name(&named('G', index)));
    }

    /// Index of a hatching.
    fn pattern(&mut self, pattern: &Pattern, transform: Transform) -> usize {
        let matrix = self.page.pre_concat(transform).pre_concat(pattern.transform());
        let rect = pattern.rect();
        let outside = std::mem::replace(&mut self.content, Content::new());
        self.group(pattern.root());
        let content = std::mem::replace(&mut self.content, outside).finish().to_vec();
        let same = |(_, tile): &(Ref, Tile)| tile.matrix == matrix && tile.content == content;
        if let Some(index) = self.patterns.iter().position(same) {
            return index;
        }
        let tile = Tile {
            content,
            area: Rect::new(rect.left(), rect.top(), rect.right(), rect.bottom()),
            step: (rect.width(), rect.height()),
            matrix,
        };
        self.patterns.push((self.ids.fresh(), tile));
        self.patterns.len() - 1
    }

    /// Text as text over its halo, which is lines, so that a search finds each word once.
    fn text(&mut self, text: &Text) {
        let halo = text.layouted().iter().any(|span| span.stroke.is_some());
        if halo {
            self.halo(text.flattened());
        }
        for span in text.layouted() {
            let (Some(fill), true) = (&span.fill, span.visible) else { continue };
            let Some(first) = span.positioned_glyphs.first() else { continue };
            let Some(font) = self.font(first.font) else { continue };
            self.content.save_state();
            self.content.transform(matrix(text.abs_transform()));
            self.fill_style(fill, text.abs_transform());
            self.content.begin_text();
            self.content.set_font(name(&named('F', font)), 1.0);
            // A glyph's transform is of units of the font, of which an em has these.
            let em = units_per_em(first.outline_transform(), first.font_size());
            let begin = first.outline_transform().pre_scale(em, em);
            self.content.set_text_matrix(matrix(begin));
            let back = begin.invert();
            let mut shown = self.content.show_positioned();
            let mut items = shown.items();
            // Where the last glyph ended, em.
            let mut end = 0.0;
            for glyph in &span.positioned_glyphs {
                let id = glyph.id.0 as u16;
                let place = glyph.outline_transform();
                let at = back.map_or(end, |back| back.pre_concat(place).tx);
                if (at - end).abs() > SAME_PLACE {
                    items.adjust(-1000.0 * (at - end));
                    end = at;
                }
                items.show(Str(&id.to_be_bytes()));
                match self.fonts.glyph(font, id, &glyph.text) {
                    Ok(width) => end += width,
                    Err(error) => self.error = Some(error),
                }
            }
            items.finish();
            shown.finish();
            self.content.end_text();
            self.content.restore_state();
        }
    }

    fn halo(&mut self, group: &Group) {
        for node in group.children() {
            match node {
                Node::Group(group) => self.halo(group),
                Node::Path(path) => self.path(path, false),
                Node::Text(_) | Node::Image(_) => {}
            }
        }
    }

    /// Index of a font among the file's.
    fn font(&mut self, id: ID) -> Option<usize> {
        if let Some((_, index)) = self.known.iter().find(|(other, _)| *other == id) {
            return Some(*index);
        }
        match self.fonts.index(self.tree, id, self.ids) {
            Ok(index) => {
                self.known.push((id, index));
                Some(index)
            }
            Err(error) => {
                self.error = Some(error);
                None
            }
        }
    }
}

impl Painted {
    /// What the page names, and the fonts of the pages before it.
    pub fn list(&self, fonts: &Fonts, resources: &mut Resources) {
        let mut listed = resources.fonts();
        for (i, id) in fonts.ids().enumerate() {
            listed.pair(name(&named('F', i)), id);
        }
        listed.finish();
        let mut patterns = resources.patterns();
        for (i, (id, _)) in self.patterns.iter().enumerate() {
            patterns.pair(name(&named('P', i)), *id);
        }
        patterns.finish();
        let mut states = resources.ext_g_states();
        for (i, opacity) in self.opacities.iter().enumerate() {
            let mut state = states.insert(name(&named('G', i))).start::<pdf_writer::writers::ExtGraphicsState>();
            state.stroking_alpha(*opacity).non_stroking_alpha(*opacity);
        }
    }

    /// Its hatchings.
    pub fn write(&self, pdf: &mut Pdf) {
        for (id, tile) in &self.patterns {
            let content = packed(&tile.content);
            let mut pattern = pdf.tiling_pattern(*id, &content);
            pattern
                .paint_type(PaintType::Colored)
                .tiling_type(TilingType::ConstantSpacing)
                .bbox(tile.area)
                .x_step(tile.step.0)
                .y_step(tile.step.1)
                .matrix(matrix(tile.matrix));
            pattern.resources();
            pattern.filter(Filter::FlateDecode);
        }
    }
}

fn units_per_em(transform: Transform, size: f32) -> f32 {
    let scale = (transform.sx * transform.sx + transform.ky * transform.ky).sqrt();
    if scale > 0.0 { (size / scale).round() } else { 1.0 }
}

fn matrix(t: Transform) -> [f32; 6] {
    [t.sx, t.ky, t.kx, t.sy, t.tx, t.ty]
}

fn rgb(colour: Color) -> [f32; 3] {
    [colour.red, colour.green, colour.blue].map(|part| f32::from(part) / 255.0)
}

/// A path's lines and curves; quadratic ones become cubic.
fn outline(content: &mut Content, data: &PathData) {
    let mut pen = (0.0, 0.0);
    for segment in data.segments() {
        match segment {
            PathSegment::MoveTo(p) => {
                content.move_to(p.x, p.y);
                pen = (p.x, p.y);
            }
            PathSegment::LineTo(p) => {
                content.line_to(p.x, p.y);
                pen = (p.x, p.y);
            }
            PathSegment::QuadTo(c, p) => {
                let third = |from: f32, to: f32| from + 2.0 / 3.0 * (to - from);
                let (a, b) = ((third(pen.0, c.x), third(pen.1, c.y)), (third(p.x, c.x), third(p.y, c.y)));
                content.cubic_to(a.0, a.1, b.0, b.1, p.x, p.y);
                pen = (p.x, p.y);
            }
            PathSegment::CubicTo(a, b, p) => {
                content.cubic_to(a.x, a.y, b.x, b.y, p.x, p.y);
                pen = (p.x, p.y);
            }
            PathSegment::Close => {
                content.close_path();
            }
        }
    }
}
