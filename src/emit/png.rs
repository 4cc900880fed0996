//! Drawings as PNG: the same SVG, rendered with an embedded subset of DejaVu Sans and no font of the system.

use resvg::usvg::fontdb::Database;
use resvg::usvg::{Options, Transform, Tree};
use std::sync::Arc;

use super::DrawError;

const REGULAR: &[u8] = include_bytes!("fonts/DejaVuSans-subset.ttf");
const BOLD: &[u8] = include_bytes!("fonts/DejaVuSans-Bold-subset.ttf");
const FAMILY: &str = "DejaVu Sans";
/// Pixels.
const WIDTH: f32 = 2400.0;

/// Renders an SVG of [`Theme::Light`](super::svg::Theme) on white, 2400 px wide.
///
/// # Errors
/// [`DrawError::Raster`] with the renderer's words.
pub fn render(svg: &str) -> Result<Vec<u8>, DrawError> {
    let tree = parse(svg)?;
    let scale = WIDTH / tree.size().width();
    let height = (tree.size().height() * scale).round().max(1.0);
    let mut pixels = tiny_skia::Pixmap::new(WIDTH as u32, height as u32)
        .ok_or_else(|| DrawError::Raster("the sheet has no size".to_owned()))?;
    pixels.fill(tiny_skia::Color::WHITE);
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut pixels.as_mut());
    pixels.encode_png().map_err(|error| DrawError::Raster(error.to_string()))
}

pub(super) fn parse(svg: &str) -> Result<Tree, DrawError> {
    let mut fonts = Database::new();
    fonts.load_font_data(REGULAR.to_vec());
    fonts.load_font_data(BOLD.to_vec());
    fonts.set_sans_serif_family(FAMILY);
    let options = Options { font_family: FAMILY.to_owned(), fontdb: Arc::new(fonts), ..Options::default() };
    Tree::from_str(svg, &options).map_err(|error| DrawError::Raster(error.to_string()))
}
