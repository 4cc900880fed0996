//! The plan of a layout for the pages: the drawing, where its vertices are written, and what a pointer is told.

use super::forces::Forces;
use super::known::Known;
use crate::base::number::{fixed, trimmed};
use crate::base::trig::PI;
use crate::compiled::Compiled;
use crate::emit::DrawError;
use crate::emit::svg::{Detail, Sheet, screen, screen_sheet};
use crate::geometry::{Corner, PieceKind, Point};
use crate::model::ConstraintKind;
use maud::html;
use serde_json::{Map, Value, json};

/// A layout with what a plan of it goes by.
pub struct Subject<'a> {
    pub known: &'a Known,
    pub compiled: &'a Compiled,
    /// The sheet of the plan before.
    pub sheet: Option<&'a Sheet>,
    pub forces: Option<&'a Forces>,
    /// Whether it is not on the catalogue's grid yet.
    pub near: bool,
    /// What came before it; `None` where nothing did.
    pub before: Option<&'a Compiled>,
}

/// The sheet and all that a page shows of a plan.
///
/// # Errors
/// [`DrawError`] of what has no extent.
pub fn part(subject: &Subject) -> Result<(Sheet, Value), DrawError> {
    let Subject { known, compiled, near, .. } = *subject;
    let written = written(known, compiled);
    let sheet = screen_sheet(compiled, &written, subject.sheet)?;
    let detail = if near { Detail::Labels } else { Detail::All };
    let mut plan = json!({
        "text": known.id,
        "name": compiled.layout.name,
        "length": format!("{} m", fixed(compiled.length(), 3)),
        "near": near,
        "svg": svg(compiled, &written, &sheet, detail),
        "vertices": vertices(known),
        "tips": tips(subject),
        "lines": lines_of_sections(known, compiled),
    });
    if let Some(remark) = subject.before.filter(|_| !near).and_then(|before| unmoved(before, compiled)) {
        plan["remark"] = json!(remark);
    }
    place(&mut plan, &sheet);
    Ok((sheet, plan))
}

/// Tracks whose corners lie no farther apart than this are the same, m.
const SAME: f64 = 1e-4;

/// What is said where vertices are written elsewhere than before, and the optimiser came to the same track.
fn unmoved(before: &Compiled, after: &Compiled) -> Option<String> {
    let (written, now) = (&before.layout.vertices, &after.layout.vertices);
    let (corners, same) = (&before.track.corners, &after.track.corners);
    if written.len() != now.len() || corners.len() != same.len() || after.failed() || before.failed() {
        return None;
    }
    let is_same = |(a, b): (&Corner, &Corner)| a.point.distance(b.point) < SAME && (a.radius - b.radius).abs() < SAME;
    let moved = written.iter().zip(now).filter(|(a, b)| a.name == b.name && a.point.distance(b.point) > SAME);
    let moved: Vec<&str> = moved.map(|(_, vertex)| vertex.name.as_str()).collect();
    let first = moved.first().filter(|_| corners.iter().zip(same).all(is_same))?;
    let was =
        if let [one] = moved.as_slice() { format!("{one} was") } else { format!("{} vertices were", moved.len()) };
    Some(format!(
        "{was} moved, and the optimiser came to the same track: `fix {first}` or `optimise nothing` keeps it there"
    ))
}

/// The same of a picture that will not stay: lines alone, on the sheet of the plan before.
///
/// # Errors
/// As [`part`].
pub fn lines(known: &Known, compiled: &Compiled, before: Option<&Sheet>) -> Result<Value, DrawError> {
    let written = written(known, compiled);
    let sheet = match before {
        Some(sheet) => *sheet,
        None => screen_sheet(compiled, &written, None)?,
    };
    let mut picture = json!({
        "length": format!("{} m", fixed(compiled.track.length, 3)),
        "svg": svg(compiled, &written, &sheet, Detail::Lines),
    });
    if let (true, Some(row)) = (compiled.failed(), compiled.stages.last().and_then(|s| s.violations.first())) {
        picture["problem"] = json!(format!("not met: {}", row.row));
    }
    place(&mut picture, &sheet);
    Ok(picture)
}

fn written(known: &Known, compiled: &Compiled) -> Vec<Corner> {
    if known.layout.vertices.is_empty() { compiled.layout.corners() } else { known.layout.corners() }
}

fn svg(compiled: &Compiled, written: &[Corner], sheet: &Sheet, detail: Detail) -> String {
    let document = screen(compiled, written, sheet, detail);
    // In a page there is no XML declaration.
    document.find("<svg").map_or(String::new(), |at| document[at..].to_owned())
}

/// Where the floor lies on the paper.
fn place(plan: &mut Value, sheet: &Sheet) {
    let zero = sheet.at(Point::default());
    plan["paper"] =
        json!({ "width": sheet.width, "height": sheet.height, "x": zero.x, "y": zero.y, "scale": sheet.mm(1.0) });
}

/// The written vertices, which can be dragged where their coordinates are numbers.
fn vertices(known: &Known) -> Vec<Value> {
    let one = |(vertex, at): (&crate::model::Vertex, &Option<super::edit::Coordinates>)| {
        let (x, y) = at.as_ref().map_or((false, false), |at| (at.x.is_some(), at.y.is_some()));
        let why = match (at, x, y) {
            (None, ..) => "stands in another file",
            (_, false, false) => "a formula places it",
            (_, false, true) => "a formula gives its x",
            (_, true, false) => "a formula gives its y",
            _ => "",
        };
        json!({
            "name": vertex.name,
            "x": vertex.point.x,
            "y": vertex.point.y,
            "moves": { "x": x, "y": y },
            "why": why,
            "line": known.line(vertex.point_span),
        })
    };
    known.layout.vertices.iter().zip(&known.coordinates).map(one).collect()
}

/// What a pointer is told of each straight and curve, as HTML: `s3`, `c3`.
fn tips(subject: &Subject) -> Map<String, Value> {
    let (compiled, layout, track) = (subject.compiled, &subject.compiled.layout, &subject.compiled.track);
    let forces =
        subject.forces.filter(|_| !subject.near).and_then(|forces| forces.of(compiled).ok()).unwrap_or_default();
    let tip = |piece: &crate::geometry::Piece| {
        let straight = piece.kind == PieceKind::Straight;
        let (title, measures) = match piece.kind {
            PieceKind::Straight => (
                layout.section_name(piece.vertex),
                format!("straight of {} m, heading {}°", fixed(piece.length, 3), heading(piece.heading)),
            ),
            PieceKind::Arc { radius, turn, .. } => {
                let hand = if turn < 0.0 { "right" } else { "left" };
                let radius = trimmed(radius, 3);
                (
                    layout.vertices[piece.vertex].name.clone(),
                    format!("radius {radius} m, {}° to the {hand}, {} m", degrees(turn.abs()), fixed(piece.length, 3)),
                )
            }
        };
        // Before it is on the grid it is made of no elements.
        let elements = if subject.near { Vec::new() } else { elements(compiled, piece.vertex, straight) };
        let key = format!("{}{}", if straight { 's' } else { 'c' }, piece.vertex);
        let told = forces.get(&key).map_or(&[][..], Vec::as_slice);
        let html = html! {
            b { (title) } br; (measures) br;
            @for (article, count, listed) in &elements {
                (count) " × " code { (article) } @if !listed { " (not in the catalogue)" } br;
            }
            @for line in told { span.note { (line) } br; }
        };
        (key, json!(html.into_string()))
    };
    track.pieces.iter().map(tip).collect()
}

/// The elements of a straight or of a curve: article, count, whether the catalogue has it.
fn elements(compiled: &Compiled, vertex: usize, straight: bool) -> Vec<(&str, usize, bool)> {
    let mut found: Vec<(&str, usize, bool)> = Vec::new();
    for piece in compiled.pieces.iter().filter(|p| p.place.vertex == vertex && p.turns() != straight) {
        match found.iter_mut().find(|(article, ..)| *article == piece.article) {
            Some((_, count, _)) => *count += 1,
            None => found.push((&piece.article, 1, piece.in_catalog)),
        }
    }
    found
}

/// Lines of the source that a straight or a curve comes from: those of its vertices, and what fixes it.
fn lines_of_sections(known: &Known, compiled: &Compiled) -> Map<String, Value> {
    let mut all = Map::new();
    let n = known.layout.vertices.len();
    if n == 0 {
        // A route: the section that a straight holds, or else its statement.
        let route = known.layout.route.as_ref().and_then(|route| known.line(route.span));
        for piece in &compiled.track.pieces {
            let straight = piece.kind == PieceKind::Straight;
            let held = compiled.layout.constraints.iter().find(
                |c| matches!(&c.kind, ConstraintKind::Holds { section, .. } if straight && *section == piece.vertex),
            );
            let line = held.and_then(|c| known.line(c.span)).or(route);
            let kind = if straight { 's' } else { 'c' };
            all.insert(format!("{kind}{}", piece.vertex), json!(line.into_iter().collect::<Vec<_>>()));
        }
        return all;
    }
    for i in 0..n {
        let vertex = |i: usize| known.line(known.layout.vertices[i].span);
        let fixing = known.layout.constraints.iter().filter(|c| match &c.kind {
            ConstraintKind::FixSection { target, .. } => target.from == i,
            ConstraintKind::Holds { section, .. } => *section == i,
            _ => false,
        });
        let mut lines: Vec<usize> = vertex(i).into_iter().chain(vertex((i + 1) % n)).collect();
        lines.extend(fixing.filter_map(|c| known.line(c.span)));
        all.insert(format!("s{i}"), json!(lines));
        let own = known.layout.constraints.iter().filter(|c| match &c.kind {
            ConstraintKind::FixVertex { vertex } | ConstraintKind::FixRadius { vertex } => *vertex == i,
            _ => false,
        });
        let lines: Vec<usize> = vertex(i).into_iter().chain(own.filter_map(|c| known.line(c.span))).collect();
        all.insert(format!("c{i}"), json!(lines));
    }
    all
}

fn degrees(angle: f64) -> String {
    trimmed(angle * 180.0 / PI, 2)
}

/// A heading in (-180°, 180°], also where rounding would leave that.
fn heading(angle: f64) -> String {
    let text = degrees(angle);
    if text == "-180" { "180".to_owned() } else { text }
}
