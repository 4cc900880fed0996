//! Drawings as PDF: the same SVG on a page of the sheet's size, with text as text in the embedded font.
//!
//! usvg reads the drawing and `pdf-writer` writes the file. What is between them stands here and knows only what the
//! drawings have (paths, hatching, text): the libraries that turn any SVG into PDF bring a second usvg and its fonts.

mod fonts;
mod painter;

use pdf_writer::{Filter, Name, Pdf, Rect, Ref, TextStr};
use resvg::usvg::Transform;

use super::{DrawError, png};
use fonts::Fonts;
use painter::Painter;

/// Points a pixel: 72 and 96 an inch.
const POINTS: f32 = 0.75;

/// Renders each SVG of [`Theme::Light`](super::svg::Theme) on a page of its size. The file holds no dates.
///
/// # Errors
/// [`DrawError::Raster`] with the words of the reader of SVG or of fonts.
pub fn render<S: AsRef<str>>(svgs: &[S], title: &str) -> Result<Vec<u8>, DrawError> {
    let mut ids = Ids(1);
    let (catalog, pages, info) = (ids.fresh(), ids.fresh(), ids.fresh());
    let mut fonts = Fonts::default();
    let mut pdf = Pdf::new();
    let mut kids = Vec::new();
    for svg in svgs {
        let tree = png::parse(svg.as_ref())?;
        let (width, height) = (POINTS * tree.size().width(), POINTS * tree.size().height());
        // From pixels, y down, to points, y up.
        let page_transform = Transform::from_row(POINTS, 0.0, 0.0, -POINTS, 0.0, height);
        let (page, content) = (ids.fresh(), ids.fresh());
        let mut painter = Painter::new(&tree, page_transform, &mut ids, &mut fonts);
        painter.group(tree.root());
        let painted = painter.finish()?;
        {
            let mut entry = pdf.page(page);
            entry.parent(pages).media_box(Rect::new(0.0, 0.0, width, height)).contents(content);
            painted.list(&fonts, &mut entry.resources());
        }
        pdf.stream(content, &packed(&painted.content)).filter(Filter::FlateDecode);
        painted.write(&mut pdf);
        kids.push(page);
    }
    pdf.catalog(catalog).pages(pages);
    pdf.pages(pages).count(kids.len() as i32).kids(kids);
    pdf.document_info(info).title(TextStr(title)).producer(TextStr("lss"));
    fonts.write(&mut pdf, &mut ids)?;
    Ok(pdf.finish())
}

/// Numbers of objects.
struct Ids(i32);

impl Ids {
    fn fresh(&mut self) -> Ref {
        self.0 += 1;
        Ref::new(self.0 - 1)
    }
}

/// Compressed, as all streams are.
fn packed(bytes: &[u8]) -> Vec<u8> {
    use std::io::Write;
    let mut encoder = flate2::write::ZlibEncoder::new(Vec::new(), flate2::Compression::default());
    // A vector takes every byte: nothing can fail.
    let written = encoder.write_all(bytes);
    debug_assert!(written.is_ok(), "{written:?}");
    encoder.finish().unwrap_or_default()
}

/// A name of a resource: `F1`.
fn named(kind: char, index: usize) -> String {
    format!("{kind}{}", index + 1)
}

fn name(text: &str) -> Name<'_> {
    Name(text.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emit::plan::samples;
    use crate::emit::svg::{Theme, drawing};

    fn pdf() -> Vec<u8> {
        render(&[drawing(&samples::crowded(), Theme::Light).expect("drawn")], "crowded").expect("written")
    }

    #[test]
    fn the_same_drawing_gives_the_same_bytes_without_dates() {
        let bytes = pdf();
        assert_eq!(bytes, pdf());
        let text = String::from_utf8_lossy(&bytes);
        assert!(text.starts_with("%PDF-1.") && text.trim_end().ends_with("%%EOF"));
        assert!(!text.contains("Date"));
    }

    #[test]
    fn the_page_has_the_size_of_the_sheet() {
        let svg = drawing(&samples::rectangle(), Theme::Light).expect("drawn");
        let bytes = render(&[svg], "rectangle").expect("written");
        let text = String::from_utf8_lossy(&bytes);
        let (_, rest) = text.split_once("/MediaBox [").expect("a page");
        let numbers: Vec<f64> =
            rest.split(']').next().expect("closed").split(' ').map(|n| n.parse().expect("a number")).collect();
        // A3, 420 by 297 mm.
        for (found, millimetres) in [(numbers[2], 420.0), (numbers[3], 297.0)] {
            assert!((found - millimetres / 25.4 * 72.0).abs() < 0.01, "{numbers:?}");
        }
    }

    /// Reads a PDF from standard input and prints its page size in mm, its fonts and its text.
    const SCRIPT: &str = r#"
import io, sys
file = io.BytesIO(sys.stdin.buffer.read())
try:
    import pypdf
except ImportError:
    print("missing"); sys.exit(0)
reader = pypdf.PdfReader(file, strict=True)
[page] = reader.pages
print(*(float(x) * 25.4 / 72 for x in page.mediabox[2:]))
fonts = page["/Resources"]["/Font"]
print(*sorted(str(fonts[f]["/BaseFont"]) for f in fonts))
print(page.extract_text())
"#;

    #[test]
    fn another_reader_finds_page_fonts_and_words() {
        use std::io::Write;
        use std::process::{Command, Stdio};
        let child = Command::new("python3").args(["-c", SCRIPT]).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn();
        let Ok(mut child) = child else {
            println!("skipped: python3 is not there");
            return;
        };
        child.stdin.take().expect("a pipe").write_all(&pdf()).expect("sent");
        let output = child.wait_with_output().expect("ended");
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        if text.starts_with("missing") {
            println!("skipped: pypdf is not there");
            return;
        }
        assert!(output.status.success());
        let mut lines = text.lines();
        let size: Vec<f64> =
            lines.next().expect("a size").split(' ').map(|word| word.parse().expect("a number")).collect();
        let standard = [(420.0, 297.0), (594.0, 420.0), (841.0, 594.0), (1189.0, 841.0)];
        assert!(standard.iter().any(|(w, h)| (size[0] - w).abs() < 0.01 && (size[1] - h).abs() < 0.01), "{size:?}");
        assert_eq!(lines.next(), Some("/LSSDRW+DejaVuSans /LSSDRW+DejaVuSans-Bold"));
        for words in ["control cabinet", "general arrangement of the track", "crowded", "date of revision"] {
            assert!(text.contains(words), "{words} in {text}");
        }
    }
}
