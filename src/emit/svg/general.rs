//! The general-arrangement drawing.

use crate::compiled::Compiled;
use crate::emit::DrawError;
use crate::emit::paper::PaperPoint;
use crate::emit::plan::{self, Climb, Mark, MarkKind};
use crate::model::ConstraintKind;
use crate::solve::Stage;

use super::labels::{self, Labels};
use super::place::TakenPaper;
use super::sheet::Sheet;
use super::strip::{self, Key};
use super::text::{self, Height};
use super::xml::XmlElement;
use super::{Theme, extent, profile, root, track};
use crate::base::number::trimmed;

/// The layout on its sheet: building, obstacles, track, equipment, dimensions, legend and title block.
///
/// # Errors
/// [`DrawError::Extent`] when no standard sheet and scale can show the layout.
pub fn drawing(compiled: &Compiled, theme: Theme) -> Result<String, DrawError> {
    let layout = &compiled.layout;
    let line = &compiled.track;
    let failed: Option<&Stage> = compiled.stages.last().filter(|_| compiled.failed());
    let sheet = Sheet::choose(&extent(layout, &[line], strip::notes_height(failed), profile::height(compiled)))?;
    let marks = plan::marks(compiled);
    let climbs = plan::climbs(compiled);
    let pieces = &compiled.pieces;

    let inside = PaperPoint::new(6.0, 6.0);
    let mut field = TakenPaper::new(sheet.drawing.low + inside, sheet.drawing.high - inside);
    track::occupy(&sheet, line, layout, &mut field);

    let description = format!(
        "General arrangement of {}: {} m of track in {} elements through {} vertices, band {} m wide, scale 1:{}.{}",
        layout.name,
        trimmed(compiled.length(), 3),
        compiled.bill.count,
        line.corners.len(),
        trimmed(layout.width.value, 3),
        trimmed(sheet.scale, 1),
        if failed.is_some() { " Not feasible." } else { "" }
    );
    let mut svg = root(&sheet, theme, &layout.name, &description);
    svg.push(sheet.frame());
    if failed.is_some() {
        svg.push(watermark(&sheet));
    }
    svg.push(track::floor(&sheet, layout));
    svg.push(track::band(&sheet, line, layout.width.value));
    if climbs.iter().any(|climb| !climb.is_level()) {
        svg.push(track::climbs(&sheet, line, layout.width.value, &climbs));
    }
    svg.push(track::joints(&sheet, pieces, layout.width.value));
    svg.push(track::fixed(&sheet, line, layout));
    let equipment = track::equipment(&sheet, line, layout, &marks, &mut field);
    svg.push(track::centre(&sheet, line));
    svg.push(equipment);
    svg.push(track::arrows(&sheet, line, &marks));
    svg.push(track::vertices(&sheet, line, layout, &mut field));

    let mut labels = Labels::new(&sheet, line, layout, field);
    labels::all(&mut labels, pieces, &marks, &climbs);
    let omitted = labels.omitted;
    svg.push(labels.finish());
    if omitted > 0 {
        let at = PaperPoint::new(sheet.drawing.low.x + 4.0, sheet.drawing.high.y - 2.5);
        let labels = if omitted == 1 { "label" } else { "labels" };
        let text = format!("{omitted} {labels} found no room on this sheet");
        svg.push(text::line(at, text, Height::H18, "quiet"));
    }
    if !layout.is_flat() {
        svg.push(profile::profile(&sheet, compiled));
    }
    if let Some(stage) = failed {
        svg.push(strip::notes(&sheet, stage));
    }
    svg.push(strip::legend(&sheet, &entries(compiled, &marks, &climbs)));
    svg.push(strip::scale_bar(&sheet));
    svg.push(strip::title(&sheet, &layout.name, "general arrangement of the track", &strip::fields(&sheet, compiled)));
    Ok(svg.document())
}

/// What appears on the drawing, in the legend's order.
fn entries(compiled: &Compiled, marks: &[Mark], climbs: &[Climb]) -> Vec<(Key, String)> {
    let layout = &compiled.layout;
    let pieces = &compiled.pieces;
    let mut entries = vec![(Key::Track, "band, centre line, direction of travel".to_owned())];
    let mut add = |shown: bool, key: Key, text: &str| {
        if shown {
            entries.push((key, text.to_owned()));
        }
    };
    let n = pieces.len();
    let changes = (0..n).filter(|&i| pieces[i].article != pieces[(i + n - 1) % n].article).count();
    let climbing = climbs.iter().any(|climb| !climb.is_level());
    add(climbing, Key::Climb, "ramp: slope in driving direction, heights");
    add(changes < n, Key::Joint, "joint of like elements");
    add(changes > 0, Key::Change, "joint where the article changes");
    add(pieces.iter().any(|p| p.in_catalog), Key::Article, "elements: count × article");
    add(pieces.iter().any(|p| !p.in_catalog), Key::Unlisted, "elements that the catalogue lacks");
    add(true, Key::Vertex, "vertex");
    let dimension = if climbing { "straight: length in the plan ∠ heading" } else { "straight: length ∠ heading" };
    add(true, Key::Dimension, dimension);
    add(true, Key::Radius, "curve: radius, turn");
    let fixes = |kind: fn(&ConstraintKind) -> bool| layout.constraints.iter().any(|c| kind(&c.kind));
    add(fixes(|k| matches!(k, ConstraintKind::FixSection { .. })), Key::FixedSection, "section with fixed values");
    add(fixes(|k| matches!(k, ConstraintKind::FixVertex { .. })), Key::FixedVertex, "fixed vertex");
    add(layout.building.is_some(), Key::Wall, "wall");
    add(!layout.obstacles.is_empty(), Key::Obstacle, "obstacle");
    let clearance = layout.obstacles.iter().map(|o| o.clearance).chain(layout.building.iter().map(|b| b.clearance));
    add(clearance.fold(0.0, f64::max) > 0.0, Key::Clearance, "clearance");
    let any = |kind: MarkKind| marks.iter().any(|mark| mark.kind == kind);
    add(any(MarkKind::Start), Key::Mark(MarkKind::Start), "start of arc length s");
    add(any(MarkKind::Photocell), Key::Mark(MarkKind::Photocell), "photocell");
    add(any(MarkKind::Induction), Key::Mark(MarkKind::Induction), "induction");
    add(any(MarkKind::Chute), Key::Mark(MarkKind::Chute), "chute: row, count");
    let motors = marks.iter().filter(|mark| mark.kind == MarkKind::Motor).count();
    add(motors > 0, Key::Mark(MarkKind::Motor), &format!("motor ({motors})"));
    let every = layout.equipment.supports.map_or(0.0, |every| every.value);
    add(any(MarkKind::Support), Key::Mark(MarkKind::Support), &format!("support, every {} m", trimmed(every, 3)));
    entries
}

fn watermark(sheet: &Sheet) -> XmlElement {
    let middle = (sheet.drawing.low + sheet.drawing.high) * 0.5;
    let size = sheet.drawing.width() / 10.0;
    XmlElement::new("text")
        .attr("class", "watermark")
        .num("font-size", size)
        .num("x", middle.x)
        .num("y", middle.y + 0.36 * size)
        .attr("transform", format!("rotate(-16 {} {})", super::number(middle.x), super::number(middle.y)))
        .text("NOT FEASIBLE")
}
