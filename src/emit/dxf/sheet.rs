//! The sheet in paper space: frame, title block and tables as in the SVG drawing, and a window on the model at scale.

use crate::emit::paper::PaperPoint;
use crate::emit::svg::{Furniture, Sheet, XmlElement};
use crate::geometry::Point;

use super::tables::Paper;
use super::writer::{Align, Writer};

const LAYER: &str = "SHEET";

/// Draws the sheet.
pub fn sheet(dxf: &mut Writer, furniture: &Furniture) -> Paper {
    let sheet = &furniture.sheet;
    let mut viewport = 0;
    dxf.on_paper(|dxf| {
        let all = (Point::default(), Point::new(sheet.width, sheet.height));
        // The first one stands for the sheet itself.
        dxf.viewport(1, all, all.1 * 0.5, sheet.height);
        for element in &furniture.elements {
            element.visit(&mut |element| draw(dxf, sheet, element));
        }
        let (low, high) = (sheet.drawing.low, sheet.drawing.high);
        let corners = (up(sheet, PaperPoint::new(low.x, high.y)), up(sheet, PaperPoint::new(high.x, low.y)));
        let tall = (high.y - low.y) * sheet.scale / 1000.0;
        viewport = dxf.viewport(2, corners, sheet.floor((low + high) * 0.5), tall);
    });
    Paper { size: sheet.size, width: sheet.width, height: sheet.height, viewport }
}

/// A point of the SVG's sheet, y down, on the DXF's, y up.
fn up(sheet: &Sheet, p: PaperPoint) -> Point {
    Point::new(p.x, sheet.height - p.y)
}

fn draw(dxf: &mut Writer, sheet: &Sheet, element: &XmlElement) {
    let number = |name: &str| element.get(name).and_then(|value| value.parse::<f64>().ok()).unwrap_or(0.0);
    let at = |x: f64, y: f64| up(sheet, PaperPoint::new(x, y));
    match element.name() {
        "rect" if element.get("class") != Some("ground") => {
            let (x, y, wide, tall) = (number("x"), number("y"), number("width"), number("height"));
            dxf.polygon(LAYER, &[at(x, y), at(x + wide, y), at(x + wide, y + tall), at(x, y + tall)]);
        }
        "path" => {
            for line in element.get("d").unwrap_or("").split('M').filter(|line| !line.is_empty()) {
                let points: Vec<Point> = line
                    .trim_end_matches('Z')
                    .split('L')
                    .filter_map(|p| {
                        let (x, y) = p.split_once(' ')?;
                        Some(at(x.parse().ok()?, y.parse().ok()?))
                    })
                    .collect();
                for pair in points.windows(2) {
                    dxf.line(LAYER, pair[0], pair[1]);
                }
            }
        }
        "text" => {
            let class = element.get("class").unwrap_or("");
            let heights = [("h18", 1.8), ("h25", 2.5), ("h35", 3.5), ("h50", 5.0)];
            let height = heights.iter().find(|(name, _)| class.contains(name)).map_or(1.8, |(_, height)| *height);
            let (p, words) = (at(number("x"), number("y")), element.words());
            if class.contains("middle") {
                dxf.sized_text(LAYER, p + Point::new(0.0, height / 2.0), 0.0, height, Align::Middle, words);
            } else {
                dxf.sized_text(LAYER, p, 0.0, height, Align::Left, words);
            }
        }
        _ => {}
    }
}
