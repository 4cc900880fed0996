//! The plan for a screen: as the general-arrangement drawing has it, without frame, tables and title block, and with
//! lettering that is read at the width of a window. Parts that a pointer may ask for carry what they are.

use crate::compiled::Compiled;
use crate::emit::DrawError;
use crate::emit::paper::PaperPoint;
use crate::emit::plan::{self, MarkKind};
use crate::geometry::{Corner, PieceKind, Track};
use crate::solve::Status;

use super::decimals::Decimals;
use super::labels::Labels;
use super::obstacles;
use super::place::TakenPaper;
use super::sheet::{Sheet, path};
use super::xml::XmlElement;
use super::{extent, hatches, paper, track};

/// Largest width and height of the plan with its labels, mm. At 900 px, letters of 3.4 mm are then 14 px high.
const ROOM: PaperPoint = PaperPoint::new(216.0, 150.0);
/// Left free around the track for what is written beside it, mm.
const MARGIN: f64 = 13.0;
/// A plan keeps its sheet while the track stays this far within, mm,
const INSIDE: f64 = 6.0;
/// and would not be drawn larger than by this on a sheet of its own: the ratio of both scales.
const NEARER: f64 = 0.8;

/// How much of a plan is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Detail {
    /// Lines and names, for what changes while a pointer moves.
    Lines,
    /// With equipment and labels, for a track that is not made of elements yet.
    Labels,
    /// With elements, too.
    All,
}

/// A sheet for the plan: that of the plan before, as long as it fits, so that nothing jumps.
///
/// # Errors
/// [`DrawError::Extent`] where there is nothing that could be drawn.
pub fn screen_sheet(compiled: &Compiled, written: &[Corner], before: Option<&Sheet>) -> Result<Sheet, DrawError> {
    let written = Track::new(written);
    let extent = extent(&compiled.layout, &[&compiled.track, &written], 0.0, 0.0);
    let fresh = Sheet::around(&extent, ROOM, MARGIN)?;
    let kept = before.filter(|sheet| {
        let (low, high) = (sheet.at(extent.low), sheet.at(extent.high));
        let within = low.x.min(high.y) >= INSIDE && high.x <= sheet.width - INSIDE && low.y <= sheet.height - INSIDE;
        within && fresh.scale > NEARER * sheet.scale
    });
    Ok(kept.copied().unwrap_or(fresh))
}

/// The plan of a layout as an `svg` element. Straights (`data-section`) and curves (`data-curve`) have areas for the
/// pointer, each with the number of its vertex; the lines of the stages are in the group `stages`.
pub fn screen(compiled: &Compiled, written: &[Corner], sheet: &Sheet, detail: Detail) -> String {
    let (layout, line) = (&compiled.layout, &compiled.track);
    let width = layout.width.value;
    // A title would show at the pointer; the page around it has the styles.
    let mut svg = paper(sheet).attr("aria-label", format!("plan of {}", layout.name)).with(hatches());
    let mut field = TakenPaper::new(PaperPoint::new(2.0, 2.0), PaperPoint::new(sheet.width - 2.0, sheet.height - 2.0));
    track::occupy(sheet, line, layout, &mut field);
    let names = obstacles::names(sheet, layout, &mut field);
    svg.push(track::building(sheet, layout));
    svg.push(obstacles::draw(sheet, layout, &names));
    svg.push(track::band(sheet, line, width));
    let (mut marks, climbs) = (plan::marks(compiled), plan::climbs(compiled));
    // Many small symbols, which hide the track at this scale.
    marks.retain(|mark| mark.kind != MarkKind::Support);
    if climbs.iter().any(|climb| !climb.is_level()) {
        svg.push(track::climbs(sheet, line, width, &climbs));
    }
    if detail == Detail::All {
        svg.push(track::joints(sheet, &compiled.pieces, width));
    }
    svg.push(track::fixed(sheet, line, layout));
    svg.push(track::centre(sheet, line));
    if detail != Detail::Lines {
        svg.push(track::equipment(sheet, line, layout, &marks, &mut field));
        svg.push(track::arrows(sheet, line, &marks));
        svg.push(track::vertices(sheet, line, layout, &mut field));
        svg.push(stages(compiled, written, sheet));
    }
    let decimals = Decimals::new(compiled, &climbs, &[], &[]);
    let mut labels = Labels::new(sheet, line, layout, field, decimals);
    layout.obstacles.iter().zip(&names).for_each(|(obstacle, name)| labels.obstacle(obstacle, name));
    let n = line.corners.len();
    (0..n).for_each(|i| labels.vertex(i));
    if detail != Detail::Lines {
        marks.iter().filter(|mark| mark.kind != MarkKind::Motor).for_each(|mark| labels.mark(mark));
        (0..n).for_each(|i| labels.straight(i));
        let curved = line.pieces.iter().filter(|p| matches!(p.kind, PieceKind::Arc { .. }) && p.length > 1e-9);
        curved.for_each(|piece| labels.curve(piece.vertex, false));
    }
    svg.push(labels.finish());
    if detail != Detail::Lines {
        svg.push(areas(compiled, sheet));
    }
    svg.document()
}

/// The written layout and the stages before the last one.
fn stages(compiled: &Compiled, written: &[Corner], sheet: &Sheet) -> XmlElement {
    let mut group = XmlElement::group("stages");
    let optimised = compiled.stages.iter().filter(|stage| stage.status != Status::AsWritten);
    let mut lines: Vec<&[Corner]> = optimised.map(|stage| stage.corners.as_slice()).collect();
    // The last one is what the drawing shows.
    lines.pop();
    lines.insert(0, written);
    for (k, corners) in lines.into_iter().enumerate().filter(|(_, corners)| corners.len() >= 3) {
        let curves = track::curves(sheet, &plan::side(&Track::new(corners), 0.0));
        group.push(path(&(curves + "Z"), &format!("stage-{}", k.min(2))));
    }
    group
}

/// What a pointer finds: the band of each straight and curve.
fn areas(compiled: &Compiled, sheet: &Sheet) -> XmlElement {
    let mut group = XmlElement::group("areas");
    let (line, width) = (&compiled.track, sheet.mm(compiled.layout.width.value).max(3.0));
    for piece in line.pieces.iter().filter(|piece| piece.length > 1e-9) {
        let what = if piece.kind == PieceKind::Straight { "data-section" } else { "data-curve" };
        let curves = track::curves(sheet, &plan::stretch(line, piece.s, piece.length, 0.0));
        let area = path(&curves, "area").attr(what, piece.vertex.to_string()).num("stroke-width", width);
        group.push(area);
    }
    group
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compiled::fixture::compile;
    use crate::emit::samples;
    use crate::model::instances::thesis10;
    use crate::solve::{Discretise, Options, solve_with};

    #[test]
    fn every_straight_and_curve_can_be_pointed_at_and_nothing_is_styled_inline() {
        let nothing: Discretise = |_, _, solution, _, _, _| solution.clone().into();
        let layout = thesis10();
        let stages = solve_with(&layout, &Options::default(), nothing, &|_| {});
        let compiled = Compiled::new(layout, stages);
        let written = compiled.layout.corners();
        let sheet = screen_sheet(&compiled, &written, None).expect("a sheet");
        let svg = screen(&compiled, &written, &sheet, Detail::All);
        for piece in &compiled.track.pieces {
            let what = if piece.kind == PieceKind::Straight { "data-section" } else { "data-curve" };
            // Some straights have no length.
            let count = usize::from(piece.length > 1e-9);
            assert_eq!(svg.matches(&format!("{what}=\"{}\"", piece.vertex)).count(), count, "{what} {}", piece.vertex);
        }
        assert!(!svg.contains("style=") && !svg.contains("<style"));
        assert_eq!(svg.matches("class=\"stage-").count(), 3, "the written layout and two stages");
        // Nor is equipment, which the page's security policy would leave out.
        for compiled in [samples::equipped(), samples::raised()] {
            let written = compiled.layout.corners();
            let sheet = screen_sheet(&compiled, &written, None).expect("a sheet");
            let svg = screen(&compiled, &written, &sheet, Detail::All);
            assert!(!svg.contains("style=") && !svg.contains("<style"), "{}", compiled.layout.name);
        }
    }

    /// Points of the floor stay where they are on the paper while somebody moves a vertex a little.
    #[test]
    fn a_sheet_is_kept_while_the_track_fits() {
        let compiled = compile(thesis10());
        let written = compiled.layout.corners();
        let sheet = screen_sheet(&compiled, &written, None).expect("a sheet");
        let mut moved = written.clone();
        moved[0].point.x -= 0.3;
        assert_eq!(screen_sheet(&compiled, &moved, Some(&sheet)).expect("a sheet"), sheet);
        moved[0].point.x -= 300.0;
        let wider = screen_sheet(&compiled, &moved, Some(&sheet)).expect("a sheet");
        assert!(wider.scale > sheet.scale);
        // And it is not kept for a layout that takes little of it.
        assert_eq!(screen_sheet(&compiled, &written, Some(&wider)).expect("a sheet"), sheet);
    }
}
