//! The drawings' files.

use super::{DrawError, dxf, pdf, png, svg};
use crate::compiled::Compiled;
use crate::geometry::Corner;

/// `drawing.svg`, `drawing.png` and `drawing.dxf`: names and contents, in this order.
///
/// # Errors
/// As the writers.
pub fn drawing_files(compiled: &Compiled) -> Result<Vec<(String, Vec<u8>)>, DrawError> {
    let adaptive = svg::drawing(compiled, svg::Theme::Adaptive)?;
    let raster = png::render(&svg::drawing(compiled, svg::Theme::Light)?)?;
    Ok(vec![
        ("drawing.svg".to_owned(), adaptive.into_bytes()),
        ("drawing.png".to_owned(), raster),
        ("drawing.dxf".to_owned(), dxf::drawing(compiled)?.into_bytes()),
    ])
}

/// `stages.svg`: the written layout and every stage over each other.
///
/// # Errors
/// As [`svg::stages`].
pub fn stages_svg(compiled: &Compiled, written: &[Corner]) -> Result<String, DrawError> {
    svg::stages(compiled, written, svg::Theme::Adaptive)
}

/// The same as PNG.
///
/// # Errors
/// As [`svg::stages`] and [`png::render`].
pub fn stages_png(compiled: &Compiled, written: &[Corner]) -> Result<Vec<u8>, DrawError> {
    png::render(&svg::stages(compiled, written, svg::Theme::Light)?)
}

/// `drawing.pdf`: the drawing on a page of the sheet's size.
///
/// # Errors
/// As [`svg::drawing`] and [`pdf::render`].
pub fn drawing_pdf(compiled: &Compiled) -> Result<Vec<u8>, DrawError> {
    pdf::render(&[svg::drawing(compiled, svg::Theme::Light)?], &compiled.layout.name)
}

/// `stages.pdf`: the same of the stages.
///
/// # Errors
/// As [`svg::stages`] and [`pdf::render`].
pub fn stages_pdf(compiled: &Compiled, written: &[Corner]) -> Result<Vec<u8>, DrawError> {
    let title = format!("{}: stages", compiled.layout.name);
    pdf::render(&[svg::stages(compiled, written, svg::Theme::Light)?], &title)
}

/// `change.svg`: two layouts over each other, each with its name.
///
/// # Errors
/// As [`svg::change`].
pub fn change_svg(names: (&str, &str), both: (&Compiled, &Compiled)) -> Result<String, DrawError> {
    svg::change(names, both, svg::Theme::Adaptive)
}

/// The same as PNG.
///
/// # Errors
/// As [`svg::change`] and [`png::render`].
pub fn change_png(names: (&str, &str), both: (&Compiled, &Compiled)) -> Result<Vec<u8>, DrawError> {
    png::render(&svg::change(names, both, svg::Theme::Light)?)
}
