//! The track's own lines: band, centre line, arrows, joints, fixed sections, vertices; and the floor around it.

use crate::elements::OrderedPiece;
use crate::emit::paper::{PaperPoint, Projection};
use crate::emit::plan::{self, Climb, Mark, MarkKind, PlanCurve};
use crate::geometry::{Point, Track};
use crate::model::{ConstraintKind, FixKind, Layout};

use super::place::{Layer, PaperBox, TakenPaper};
use super::sheet::{Sheet, coordinates, path, path_line, polygon};
use super::symbol::{self, Spot};
use super::xml::{XmlElement, number};

/// Width of the hatching along walls, mm.
const WALL: f64 = 1.8;

/// Path data of curves on paper; what continues where the last ended is one line.
pub fn curves(sheet: &Sheet, curves: &[PlanCurve]) -> String {
    let mut data = String::new();
    let mut pen: Option<Point> = None;
    for curve in curves {
        if pen.is_none_or(|p| p.distance(curve.begin()) > 1e-6) {
            data.push_str(&format!("M{}", coordinates(sheet.at(curve.begin()))));
        }
        let end = coordinates(sheet.at(curve.end()));
        match *curve {
            PlanCurve::Line { .. } => data.push_str(&format!("L{end}")),
            PlanCurve::Arc { radius, sweep, .. } => {
                let r = number(sheet.mm(radius));
                let large = u8::from(sweep.abs() > std::f64::consts::PI);
                let clockwise = u8::from(sweep < 0.0);
                data.push_str(&format!("A{r} {r} 0 {large} {clockwise} {end}"));
            }
        }
        pen = Some(curve.end());
    }
    data
}

/// The building.
pub fn building(sheet: &Sheet, layout: &Layout) -> XmlElement {
    let mut group = XmlElement::group("building");
    if let Some(building) = &layout.building {
        let outline = polygon(&building.polygon.points().iter().map(|p| sheet.at(*p)).collect::<Vec<_>>());
        let wall = plan::outset(&building.polygon, WALL * sheet.scale / 1000.0);
        group.push(path(&(outline.clone() + &curves(sheet, &wall) + "Z"), "wall-hatch").attr("fill-rule", "evenodd"));
        group.push(path(&outline, "wall"));
        let clear = plan::inset(&building.polygon, building.clearance);
        if !clear.is_empty() {
            group.push(path(&curves(sheet, &clear), "clearance"));
        }
    }
    group
}

/// The band between its two sides.
pub fn band(sheet: &Sheet, track: &Track, width: f64) -> XmlElement {
    let sides: Vec<String> = [0.5, -0.5].iter().map(|k| curves(sheet, &plan::side(track, k * width)) + "Z").collect();
    XmlElement::group("track").with(path(&sides.concat(), "band")).with(path(&sides.concat(), "edge"))
}

/// The band where the track climbs.
pub fn climbs(sheet: &Sheet, track: &Track, width: f64, climbs: &[Climb]) -> XmlElement {
    let mut group = XmlElement::group("climbs");
    for climb in climbs.iter().filter(|climb| !climb.is_level()) {
        let side = |k: f64| plan::stretch(track, climb.s, climb.run, k * width / 2.0);
        group.push(path(&ribbon(sheet, &side(1.0), &side(-1.0)), "climb"));
    }
    group
}

/// The centre line, and the lines through the vertices that its fillets round.
pub fn centre(sheet: &Sheet, track: &Track) -> XmlElement {
    let mut group = XmlElement::group("centre-line");
    let mut tangents = String::new();
    for (corner, fillet) in track.corners.iter().zip(&track.fillets) {
        let points = [fillet.begin, corner.point, fillet.end].map(|p| sheet.at(p));
        if fillet.tangent > 1e-9 {
            tangents.push_str(&path_line(points[0], points[1]));
            tangents.push_str(&path_line(points[2], points[1]));
        }
    }
    group.push(path(&tangents, "tangent"));
    group.push(path(&(curves(sheet, &plan::side(track, 0.0)) + "Z"), "centre"));
    group
}

/// Ticks across the band where a piece begins: heavy ones where the article changes.
pub fn joints(sheet: &Sheet, pieces: &[OrderedPiece], width: f64) -> XmlElement {
    let (mut like, mut change) = (String::new(), String::new());
    let n = pieces.len();
    for (i, piece) in pieces.iter().enumerate() {
        let changes = pieces[(i + n - 1) % n].article != piece.article;
        let across = Point::unit(piece.place.heading).left();
        let reach = width / 2.0 + if changes { 0.8 * sheet.scale / 1000.0 } else { 0.0 };
        let at = piece.place.position;
        let tick = path_line(sheet.at(at - across * reach), sheet.at(at + across * reach));
        if changes { &mut change } else { &mut like }.push_str(&tick);
    }
    let mut group = XmlElement::group("joints");
    for (data, class) in [(like, "joint"), (change, "change")] {
        if !data.is_empty() {
            group.push(path(&data, class));
        }
    }
    group
}

/// What is fixed, in words, or what lies there, by the section it is marked on.
pub fn fixed_sections(layout: &Layout) -> Vec<(usize, String)> {
    let mut sections = Vec::new();
    for constraint in &layout.constraints {
        if let ConstraintKind::Holds { section, part } = &constraint.kind {
            sections.push((*section, part.name.clone()));
        }
        if let ConstraintKind::FixSection { target, kinds } = &constraint.kind {
            let all = [FixKind::Length, FixKind::Rotation, FixKind::Parallel, FixKind::Perpendicular];
            let words: Vec<&str> = kinds
                .iter()
                .map(|kind| match kind {
                    FixKind::Length => "length",
                    FixKind::Rotation => "rotation",
                    FixKind::Parallel => "parallel",
                    FixKind::Perpendicular => "perpendicular",
                })
                .collect();
            let what = if all.iter().all(|kind| kinds.contains(kind)) { "all".to_owned() } else { words.join(", ") };
            let straight = if target.straight { " of straight" } else { "" };
            sections.push((target.from, format!("fix {what}{straight}")));
        }
    }
    sections
}

/// Heavy lines along both edges of the fixed sections' straights.
pub fn fixed(sheet: &Sheet, track: &Track, layout: &Layout) -> XmlElement {
    let mut data = String::new();
    for (section, _) in fixed_sections(layout) {
        let piece = track.straight(section);
        for side in [0.5, -0.5] {
            let across = Point::unit(piece.heading).left() * (side * layout.width.value);
            data.push_str(&path_line(sheet.at(piece.begin + across), sheet.at(piece.end + across)));
        }
    }
    let group = XmlElement::group("fixed-sections");
    if data.is_empty() { group } else { group.with(path(&data, "fixed")) }
}

/// Crosses at the vertices, in a square where the vertex is fixed.
pub fn vertices(sheet: &Sheet, track: &Track, layout: &Layout, field: &mut TakenPaper) -> XmlElement {
    let (mut crosses, mut squares) = (String::new(), String::new());
    for (i, corner) in track.corners.iter().enumerate() {
        let at = sheet.at(corner.point);
        crosses.push_str(&symbol::cross(at, 1.5));
        if is_fixed_vertex(layout, i) {
            let d = |x: f64, y: f64| at + PaperPoint::new(x, y) * 2.0;
            squares.push_str(&polygon(&[d(-1.0, -1.0), d(1.0, -1.0), d(1.0, 1.0), d(-1.0, 1.0)]));
        }
        field.add(PaperBox::upright(at, 3.6, 3.6), Layer::Solid);
    }
    let mut group = XmlElement::group("vertices").with(path(&crosses, "vertex"));
    if !squares.is_empty() {
        group.push(path(&squares, "fixed"));
    }
    group
}

pub fn is_fixed_vertex(layout: &Layout, i: usize) -> bool {
    layout.constraints.iter().any(|c| matches!(c.kind, ConstraintKind::FixVertex { vertex } if vertex == i))
}

pub fn is_fixed_radius(layout: &Layout, i: usize) -> bool {
    layout.constraints.iter().any(|c| matches!(c.kind, ConstraintKind::FixRadius { vertex } if vertex == i))
}

/// Where a mark stands on paper.
pub fn spot(sheet: &Sheet, track: &Track, mark: &Mark, width: f64) -> Spot {
    let out = mark.heading - mark.out * plan::winding(track) * std::f64::consts::FRAC_PI_2;
    Spot {
        at: sheet.at(mark.point),
        along: Projection::direction(mark.heading),
        out: Projection::direction(out),
        half: sheet.mm(width) / 2.0,
    }
}

/// Motors, inductions, chutes, supports, photocell and start, and the paper they take.
pub fn equipment(sheet: &Sheet, track: &Track, layout: &Layout, marks: &[Mark], field: &mut TakenPaper) -> XmlElement {
    let mut group = XmlElement::group("equipment");
    let width = layout.width.value;
    let order = |kind: MarkKind| match kind {
        MarkKind::Motor => 0,
        MarkKind::Support => 1,
        MarkKind::Chute => 2,
        _ => 3,
    };
    let mut sorted: Vec<&Mark> = marks.iter().collect();
    sorted.sort_by_key(|mark| order(mark.kind));
    for mark in sorted {
        let spot = spot(sheet, track, mark, width);
        if mark.kind == MarkKind::Motor {
            let side = |k: f64| plan::stretch(track, mark.s, mark.length, 0.45 * k * width / 2.0);
            group.push(path(&ribbon(sheet, &side(1.0), &side(-1.0)), "motor"));
            continue;
        }
        if !mark.covers.is_empty() {
            group.push(covered(sheet, mark));
            field.add(taken(sheet, mark, &spot), Layer::Solid);
            continue;
        }
        let pitch = chute_pitch(sheet, layout, mark);
        let (element, taken) = symbol::mark(mark.kind, &spot, pitch);
        group.push(element);
        field.add(taken, Layer::Solid);
    }
    group
}

/// What equipment of a declared kind covers, and the conveyor that feeds it.
fn covered(sheet: &Sheet, mark: &Mark) -> XmlElement {
    let corners = |r: &[Point; 4]| polygon(&r.map(|p| sheet.at(p)));
    let outlines: String = mark.covers.iter().map(corners).collect();
    let mut group = XmlElement::group("footprint").with(footprint(mark.kind, &outlines));
    if let Some((from, to)) = mark.conveyor {
        group.push(conveyor(sheet.at(from), sheet.at(to)));
    }
    group
}

/// Outlines that equipment covers.
pub fn footprint(kind: MarkKind, outlines: &str) -> XmlElement {
    match kind {
        MarkKind::Induction => path(outlines, "induction-footprint"),
        MarkKind::Chute => path(outlines, "chute"),
        _ => path(outlines, "photocell"),
    }
}

/// A conveyor from where items come to the induction.
pub fn conveyor(from: PaperPoint, to: PaperPoint) -> XmlElement {
    XmlElement::group("conveyor").with(path(&path_line(from, to), "conveyor-line")).with(symbol::circle(
        from,
        1.0,
        "photocell",
    ))
}

/// How far what a mark covers reaches from the band, mm.
pub fn reach(sheet: &Sheet, mark: &Mark, spot: &Spot) -> f64 {
    let out = |p: &Point| {
        let d = sheet.at(*p) - spot.at;
        d.x * spot.out.x + d.y * spot.out.y - spot.half
    };
    mark.covers.iter().flatten().map(out).fold(0.0, f64::max)
}

fn taken(sheet: &Sheet, mark: &Mark, spot: &Spot) -> PaperBox {
    let half = mark.covers.first().map_or(0.0, |r| sheet.mm(r[0].distance(r[1])) / 2.0);
    let reach = reach(sheet, mark, spot);
    PaperBox {
        centre: spot.at + spot.out * (spot.half + reach / 2.0),
        half: PaperPoint::new(half, reach / 2.0),
        axis: spot.along,
    }
}

/// Distance between neighbours of a row of chutes on paper, mm.
fn chute_pitch(sheet: &Sheet, layout: &Layout, mark: &Mark) -> f64 {
    if mark.kind != MarkKind::Chute {
        return 0.0;
    }
    let rows = layout.equipment.chutes.iter().flat_map(|chutes| chutes.rows()).filter(|row| row.count > 1);
    sheet.mm(rows.map(|row| row.every).fold(10.0, f64::min))
}

/// A closed area between two lines along the track.
fn ribbon(sheet: &Sheet, left: &[PlanCurve], right: &[PlanCurve]) -> String {
    let back: Vec<PlanCurve> = right.iter().rev().map(reversed).collect();
    let forth = curves(sheet, left);
    let back = curves(sheet, &back);
    forth + &back.replacen('M', "L", 1) + "Z"
}

fn reversed(curve: &PlanCurve) -> PlanCurve {
    match *curve {
        PlanCurve::Line { begin, end } => PlanCurve::Line { begin: end, end: begin },
        PlanCurve::Arc { centre, radius, start, sweep } => {
            PlanCurve::Arc { centre, radius, start: start + sweep, sweep: -sweep }
        }
    }
}

/// Arrow heads on the centre line of the straights that have room for one between the motors.
pub fn arrows(sheet: &Sheet, track: &Track, marks: &[Mark]) -> XmlElement {
    const LENGTH: f64 = 4.0;
    let length = LENGTH * sheet.scale / 1000.0;
    let free = |s: f64| {
        marks.iter().all(|mark| {
            let ahead = (s - mark.s).rem_euclid(track.length);
            let room = 0.4 * length;
            ahead > mark.length + length + room && ahead < track.length - room
        })
    };
    let mut data = String::new();
    for piece in track.pieces.iter().step_by(2).filter(|piece| piece.length > 2.0 * length) {
        let tips = [0.5, 0.4, 0.6, 0.3, 0.7, 0.2, 0.8].map(|t| piece.s + t * piece.length + length / 2.0);
        if let Some(s) = tips.into_iter().find(|s| free(*s)) {
            let (p, heading) = track.at(s);
            data.push_str(&symbol::arrow(sheet.at(p), Projection::direction(heading), LENGTH, 1.8));
        }
    }
    let group = XmlElement::group("direction");
    if data.is_empty() { group } else { group.with(path(&data, "arrow")) }
}

/// Registers what labels keep off (the band) and rather keep off (walls, obstacles, clearances, tangents).
pub fn occupy(sheet: &Sheet, track: &Track, layout: &Layout, field: &mut TakenPaper) {
    let width = sheet.mm(layout.width.value) + 0.6;
    for curve in plan::side(track, 0.0) {
        for_chords(sheet, &curve, |a, b| field.add_line(a, b, width, Layer::Solid));
    }
    for (corner, fillet) in track.corners.iter().zip(&track.fillets) {
        let at = sheet.at(corner.point);
        field.add_line(sheet.at(fillet.begin), at, 0.3, Layer::Line);
        field.add_line(at, sheet.at(fillet.end), 0.3, Layer::Line);
    }
    let mut line = |curve: &PlanCurve, thickness, layer| {
        for_chords(sheet, curve, |a, b| field.add_line(a, b, thickness, layer));
    };
    let outlines = layout.building.iter().map(|b| &b.polygon).chain(layout.obstacles.iter().map(|o| &o.polygon));
    for (begin, end) in outlines.flat_map(|polygon| polygon.edges()) {
        line(&PlanCurve::Line { begin, end }, 0.7, Layer::Line);
    }
    if let Some(building) = &layout.building {
        plan::inset(&building.polygon, building.clearance).iter().for_each(|curve| line(curve, 0.3, Layer::Line));
        plan::outset(&building.polygon, WALL / 2.0 * sheet.scale / 1000.0)
            .iter()
            .for_each(|curve| line(curve, WALL, Layer::Hatch));
    }
    for obstacle in &layout.obstacles {
        plan::outset(&obstacle.polygon, obstacle.clearance).iter().for_each(|curve| line(curve, 0.3, Layer::Line));
    }
}

/// Chords of a curve on paper, each over at most 10°.
fn for_chords(sheet: &Sheet, curve: &PlanCurve, mut each: impl FnMut(PaperPoint, PaperPoint)) {
    let parts = match curve {
        PlanCurve::Line { .. } => 1,
        PlanCurve::Arc { sweep, .. } => (sweep.abs() / 0.175).ceil().clamp(1.0, 72.0) as usize,
    };
    for i in 0..parts {
        let at = |k: usize| sheet.at(curve.at(k as f64 / parts as f64));
        each(at(i), at(i + 1));
    }
}
