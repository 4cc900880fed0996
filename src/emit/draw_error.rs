//! Why there is no drawing.

use std::fmt;

/// Why there is no drawing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DrawError {
    /// Coordinates that are not finite, or a layout without extent or beyond 10 000 km.
    Extent,
    /// The renderer's words.
    Raster(String),
    /// The words of the workbook's writer.
    Workbook(String),
}

impl fmt::Display for DrawError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            DrawError::Extent => write!(f, "no sheet can show the layout's extent"),
            DrawError::Workbook(message) => write!(f, "the workbook could not be written: {message}"),
            DrawError::Raster(message) => write!(f, "the drawing could not be rendered: {message}"),
        }
    }
}

impl std::error::Error for DrawError {}
