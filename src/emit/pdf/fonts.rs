//! Fonts of a PDF: embedded as they are, with the widths and the characters of the glyphs in use.

use std::collections::BTreeMap;

use pdf_writer::types::{CidFontType, FontFlags, SystemInfo, UnicodeCmap};
use pdf_writer::{Filter, Name, Pdf, Rect, Ref, Str};
use resvg::usvg::Tree;
use resvg::usvg::fontdb::ID;
use skrifa::instance::{LocationRef, Size};
use skrifa::{FontRef, GlyphId, MetadataProvider};

use super::{Ids, name, packed};
use crate::emit::DrawError;

const SYSTEM: SystemInfo = SystemInfo { registry: Str(b"Adobe"), ordering: Str(b"Identity"), supplement: 0 };
/// Marks the name of a font of which not all glyphs are there.
const SUBSET: &str = "LSSDRW+";

/// A font in use.
struct Font {
    id: Ref,
    /// `DejaVuSans-Bold`
    title: String,
    data: Vec<u8>,
    /// Width in thousandths of an em, and the characters that it stands for, by glyph.
    glyphs: BTreeMap<u16, (f32, String)>,
}

/// The fonts of a file, which its pages share.
#[derive(Default)]
pub struct Fonts(Vec<Font>);

impl Fonts {
    /// Index of a font of a page; its first use embeds it.
    pub fn index(&mut self, tree: &Tree, font: ID, ids: &mut Ids) -> Result<usize, DrawError> {
        let title = tree.fontdb().face(font).map(|face| face.post_script_name.clone()).ok_or_else(broken)?;
        if let Some(known) = self.0.iter().position(|known| known.title == title) {
            return Ok(known);
        }
        let data = tree.fontdb().with_face_data(font, |data, _| data.to_vec()).ok_or_else(broken)?;
        self.0.push(Font { id: ids.fresh(), title, data, glyphs: BTreeMap::new() });
        Ok(self.0.len() - 1)
    }

    /// Takes a glyph of a font into use; its width in em.
    pub fn glyph(&mut self, font: usize, glyph: u16, text: &str) -> Result<f32, DrawError> {
        self.0.get_mut(font).ok_or_else(broken)?.glyph(glyph, text)
    }

    /// Of all so far, in the order of their indices.
    pub fn ids(&self) -> impl Iterator<Item = Ref> {
        self.0.iter().map(|font| font.id)
    }

    pub fn write(&self, pdf: &mut Pdf, ids: &mut Ids) -> Result<(), DrawError> {
        self.0.iter().try_for_each(|font| font.write(pdf, ids))
    }
}

/// Why a font cannot be embedded.
fn broken() -> DrawError {
    DrawError::Raster("a font of the drawing cannot be read".to_owned())
}

impl Font {
    /// Takes a glyph into use; its width in em.
    fn glyph(&mut self, glyph: u16, text: &str) -> Result<f32, DrawError> {
        if let Some((width, _)) = self.glyphs.get(&glyph) {
            return Ok(*width / 1000.0);
        }
        let font = FontRef::new(&self.data).map_err(|_| broken())?;
        let units = f32::from(font.metrics(Size::unscaled(), LocationRef::default()).units_per_em);
        let metrics = font.glyph_metrics(Size::unscaled(), LocationRef::default());
        let width = metrics.advance_width(GlyphId::from(glyph)).unwrap_or(0.0) / units;
        self.glyphs.insert(glyph, (1000.0 * width, text.to_owned()));
        Ok(width)
    }

    fn write(&self, pdf: &mut Pdf, ids: &mut Ids) -> Result<(), DrawError> {
        let (cid, descriptor, map, file) = (ids.fresh(), ids.fresh(), ids.fresh(), ids.fresh());
        let title = format!("{SUBSET}{}", self.title);
        pdf.type0_font(self.id)
            .base_font(name(&title))
            .encoding_predefined(Name(b"Identity-H"))
            .descendant_font(cid)
            .to_unicode(map);
        {
            let mut font = pdf.cid_font(cid);
            font.subtype(CidFontType::Type2)
                .base_font(name(&title))
                .system_info(SYSTEM)
                .font_descriptor(descriptor)
                .default_width(0.0)
                .cid_to_gid_map_predefined(Name(b"Identity"));
            let mut widths = font.widths();
            for (glyph, (width, _)) in &self.glyphs {
                widths.consecutive(*glyph, [*width]);
            }
        }
        let font = FontRef::new(&self.data).map_err(|_| broken())?;
        let metrics = font.metrics(Size::unscaled(), LocationRef::default());
        let em = |units: f32| 1000.0 * units / f32::from(metrics.units_per_em);
        let bounds = metrics.bounds.unwrap_or_default();
        pdf.font_descriptor(descriptor)
            .name(name(&title))
            .flags(FontFlags::NON_SYMBOLIC)
            .bbox(Rect::new(em(bounds.x_min), em(bounds.y_min), em(bounds.x_max), em(bounds.y_max)))
            .italic_angle(0.0)
            .ascent(em(metrics.ascent))
            .descent(em(metrics.descent))
            .cap_height(em(metrics.cap_height.unwrap_or(metrics.ascent)))
            .stem_v(if self.title.ends_with("Bold") { 140.0 } else { 80.0 })
            .font_file2(file);
        let mut characters = UnicodeCmap::<u16>::new(Name(b"Custom"), SYSTEM);
        for (glyph, (_, text)) in &self.glyphs {
            characters.pair_with_multiple(*glyph, text.chars());
        }
        pdf.stream(map, &packed(&characters.finish())).filter(Filter::FlateDecode);
        let program = packed(&self.data);
        let mut stream = pdf.stream(file, &program);
        stream.filter(Filter::FlateDecode).pair(Name(b"Length1"), self.data.len() as i32);
        Ok(())
    }
}
