//! Drawings as SVG, in mm on a standard sheet at a standard scale, with an SVG writer of our own.

mod decimals;
mod general;
mod labels;
mod obstacles;
mod overview;
mod place;
mod profile;
mod screen;
mod setting_out;
pub(crate) mod sheet;
mod stages;
pub(crate) mod strip;
pub(crate) mod symbol;
mod tables;
pub(crate) mod text;
mod theme;
mod track;
pub(crate) mod xml;

#[cfg(test)]
mod tests;

pub use general::{Furniture, drawing, furniture};
pub use overview::overview;
pub use screen::{Detail, screen, screen_sheet};
pub use sheet::Sheet;
pub use stages::{change, stages};
pub use theme::{Theme, sheet as style};
pub use xml::XmlElement;

use crate::emit::plan;
use crate::geometry::{Point, Track, bounds};
use crate::model::Layout;

use sheet::{Extent, TableSize};
use xml::number;

/// The root element with title, description, styles and hatches.
pub(crate) fn root(sheet: &Sheet, theme: Theme, title: &str, description: &str) -> XmlElement {
    page((sheet.width, sheet.height), theme, title, description)
}

/// The same for a page of a size, mm.
pub(crate) fn page(size: (f64, f64), theme: Theme, title: &str, description: &str) -> XmlElement {
    let mut style = XmlElement::new("style");
    style.style(theme::sheet(theme));
    sized(size)
        .attr("aria-labelledby", "title description")
        .with(XmlElement::new("title").attr("id", "title").text(title))
        .with(XmlElement::new("desc").attr("id", "description").text(description))
        .with(style)
        .with(hatches())
}

/// The root element without a title.
fn paper(sheet: &Sheet) -> XmlElement {
    sized((sheet.width, sheet.height))
}

fn sized((width, height): (f64, f64)) -> XmlElement {
    XmlElement::new("svg")
        .attr("xmlns", "http://www.w3.org/2000/svg")
        .attr("class", "drawing")
        .attr("width", format!("{}mm", number(width)))
        .attr("height", format!("{}mm", number(height)))
        .attr("viewBox", format!("0 0 {} {}", number(width), number(height)))
        .attr("role", "img")
}

fn hatches() -> XmlElement {
    let hatch = |id: &str, spacing: f64, class: &str, line: &str| {
        XmlElement::new("pattern")
            .attr("id", id)
            .attr("patternUnits", "userSpaceOnUse")
            .num("width", spacing)
            .num("height", spacing)
            .with(sheet::path(line, class))
    };
    // Lines at 45° that run on from tile to tile.
    XmlElement::new("defs")
        .with(hatch("wall-hatch", 1.2, "wall-line", "M-.3 .3L.3 -.3M0 1.2L1.2 0M.9 1.5L1.5 .9"))
        .with(hatch("obstacle-hatch", 2.4, "obstacle-line", "M-.6 .6L.6 -.6M0 2.4L2.4 0M1.8 3L3 1.8"))
}

/// Smallest and largest coordinates of all that is drawn, m.
fn extent(layout: &Layout, tracks: &[&Track], notes: f64, profile: f64) -> Extent {
    let half = layout.width.value / 2.0;
    let mut points: Vec<Point> = Vec::new();
    for track in tracks {
        points.extend(track.corners.iter().map(|corner| corner.point));
        for shift in [-half, half] {
            for curve in plan::side(track, shift) {
                let (low, high) = curve.bounds();
                points.extend([low, high]);
            }
        }
    }
    let polygons = layout
        .obstacles
        .iter()
        .map(|o| (&o.polygon, o.clearance))
        .chain(layout.building.iter().map(|b| (&b.polygon, 0.0)));
    for (polygon, clearance) in polygons {
        let (low, high) = polygon.bounds();
        let reach = Point::new(clearance, clearance);
        points.extend([low - reach, high + reach]);
    }
    // Coordinates that are no number would vanish in the minimum.
    let broken = points.iter().any(|p| !p.x.is_finite() || !p.y.is_finite());
    let (low, high) =
        if broken { (Point::new(f64::NAN, f64::NAN), Point::default()) } else { bounds(points.into_iter()) };
    let (length, sections) = tracks.first().map_or((0.0, 1), |track| (track.length, track.corners.len()));
    Extent { low, high, length, sections, band: layout.width.value, notes, profile, table: TableSize::default() }
}
