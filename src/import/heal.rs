//! From a drawn loop to vertices with radii.
//!
//! Between two arcs lies a section: a drawn straight or, where arcs meet directly, their common tangent. A vertex is
//! the point at which two neighbouring sections' lines meet; its fillet has the drawn arc's radius. On a tangent loop
//! that is the drawing exactly. Otherwise ends that do not meet and headings that differ make the result deviate from
//! the drawing. How far is measured afterwards, piece by piece, and has to be within the tolerance: nothing that was
//! done to heal is trusted.

use super::shapes::Drawn;
use super::walk::{self, Ring, headings, metres, place};
use super::{Healed, Options};
use crate::base::number::trimmed;
use crate::base::trig;
use crate::diagnostic::{Code, Diagnostic};
use crate::geometry::{Corner, Curve, Point, Track, point_piece};
use crate::source::Span;

/// An imported centre line.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportedLine {
    pub track: Track,
    pub start: Option<f64>,
    pub healed: Healed,
}

/// Smaller turns are none, and larger ones are split, rad: what the language takes at a vertex.
const LEAST_TURN: f64 = 0.05 * trig::PI / 180.0;
const LARGEST_TURN: f64 = 175.0 * trig::PI / 180.0;
/// A bend that no drawing means, rad.
const STRAIGHT_ON: f64 = 1e-7;
/// Points of a piece whose distance is measured, between its ends.
const SAMPLES: usize = 16;
/// Rounds of moving vertices apart whose fillets touch.
const ROUNDS: usize = 400;
/// Vertices of a layout.
const MOST: usize = 2000;

/// A vertex to be: an arc, or a corner that is drawn sharp.
#[derive(Clone, Copy, Debug)]
struct Node {
    radius: f64,
    sharp: bool,
    span: Span,
    /// The corner, or the arc's middle.
    at: Point,
}

/// The line behind a node: a point on it and its heading, rad.
#[derive(Clone, Copy, Debug)]
struct Section {
    through: Point,
    heading: f64,
}

pub fn centre_line(
    ring: &Ring,
    marks: &[Point],
    options: &Options,
    said: &mut Vec<Diagnostic>,
) -> Option<ImportedLine> {
    let mut healed = Healed { dropped: ring.dropped, ..Healed::default() };
    joints(&ring.pieces, &mut healed);
    let origin = ring.pieces.first()?.curve.begin();
    let parts = split(merged(&ring.pieces, options.tolerance, marks.is_empty()));
    let (nodes, sections) = nodes(&parts, options);
    if !sharp_corners(&nodes, &parts, options, said) {
        return None;
    }
    if nodes.len() < 3 || nodes.len() > MOST {
        let span = parts.first().map_or(ring.pieces[0].span, |part| part.span);
        said.push(
            Diagnostic::new(Code::E0805, "the centre line is no loop of straights and curves", span, "begins here")
                .expected(format!("3 to {MOST} curves"), nodes.len().to_string()),
        );
        return None;
    }
    let Some(mut corners) = corners(&nodes, &sections) else {
        said.push(kinked(&parts, "curves between straights that are parallel"));
        return None;
    };
    make_room(&mut corners, options.tolerance);
    let mut track = Track::new(&corners);
    let (far, largest) = shifts(ring, &track, &nodes);
    healed.largest_shift = largest;
    if largest > options.tolerance {
        said.push(moved(&ring.pieces, &far, &healed, options.tolerance));
        return None;
    }
    if let Some(corners) = snapped(&track, &healed, options.tolerance) {
        let snapped = Track::new(&corners);
        let largest = shifts(ring, &snapped, &nodes).1;
        if largest <= options.tolerance {
            track = snapped;
            healed.largest_shift = largest;
        }
    }
    if let Some(report) = report(ring, &healed) {
        said.push(report);
    }
    let first = track.straight(0);
    let along = (origin - first.begin).dot(Point::unit(first.heading));
    let inside = along > options.tolerance && along < first.length - options.tolerance;
    Some(ImportedLine { track, start: inside.then_some(along), healed })
}

/// Measures how the pieces meet.
fn joints(pieces: &[Drawn], healed: &mut Healed) {
    for (i, piece) in pieces.iter().enumerate() {
        let next = &pieces[(i + 1) % pieces.len()].curve;
        let gap = piece.curve.end().distance(next.begin());
        let bend = trig::wrap(headings(next).0 - headings(&piece.curve).1).abs();
        if gap > 1e-9 {
            healed.gaps += 1;
        }
        healed.largest_gap = healed.largest_gap.max(gap);
        // A sharp corner is a matter of its own.
        let arcs = [&piece.curve, next].iter().any(|c| matches!(c, Curve::Arc { .. }));
        if arcs {
            healed.largest_bend = healed.largest_bend.max(bend);
        }
    }
}

/// Straights that go on as one, and arcs about one centre; arcs that hardly turn count as straights. The first part
/// holds the first piece's begin. Arcs stay apart in a drawing that marks its vertices.
fn merged(pieces: &[Drawn], tolerance: f64, arcs: bool) -> Vec<Drawn> {
    let mut parts: Vec<Drawn> = Vec::new();
    for piece in pieces {
        let mut piece = *piece;
        if let Curve::Arc { begin, end, sweep, .. } = piece.curve
            && sweep.abs() < LEAST_TURN
        {
            piece.curve = Curve::Segment { begin, end };
        }
        match parts.last_mut() {
            Some(last) if joined(&last.curve, &piece.curve, tolerance, arcs).is_some() => {
                last.curve = joined(&last.curve, &piece.curve, tolerance, arcs).unwrap_or(last.curve);
            }
            _ => parts.push(piece),
        }
    }
    // Around the end.
    if parts.len() > 1
        && let (Some(first), Some(last)) = (parts.first(), parts.last())
        && let Some(curve) = joined(&last.curve, &first.curve, tolerance, arcs)
    {
        parts[0].curve = curve;
        parts.pop();
    }
    parts
}

/// Two curves as one.
fn joined(a: &Curve, b: &Curve, tolerance: f64, arcs: bool) -> Option<Curve> {
    match (*a, *b) {
        (Curve::Segment { begin, end }, Curve::Segment { begin: from, end: to }) => {
            let bend = trig::wrap(headings(b).0 - headings(a).1).abs();
            let aside = bend * begin.distance(end).min(from.distance(to));
            (bend < LEAST_TURN && (bend < STRAIGHT_ON || aside <= tolerance))
                .then_some(Curve::Segment { begin, end: to })
        }
        (
            Curve::Arc { begin, centre, radius, start, sweep, .. },
            Curve::Arc { end, centre: other, radius: r, sweep: more, .. },
        ) if arcs => {
            let same = centre.distance(other) <= tolerance && (radius - r).abs() <= tolerance && sweep * more > 0.0;
            let whole = sweep + more;
            (same && whole.abs() <= trig::TAU).then_some(Curve::Arc { begin, end, centre, radius, start, sweep: whole })
        }
        _ => None,
    }
}

/// Arcs beyond what a vertex can turn by, as several of at most a right angle.
fn split(parts: Vec<Drawn>) -> Vec<Drawn> {
    let pieces = |part: Drawn| -> Vec<Drawn> {
        let Curve::Arc { begin, end, centre, radius, start, sweep } = part.curve else { return vec![part] };
        if sweep.abs() <= LARGEST_TURN {
            return vec![part];
        }
        let count = (sweep.abs() / trig::FRAC_PI_2 - 1e-9).ceil().max(2.0);
        let step = sweep / count;
        let at = |k: f64| centre + Point::unit(start + k * step) * radius;
        (0..count as usize)
            .map(|k| {
                let k = k as f64;
                let begin = if k == 0.0 { begin } else { at(k) };
                let end = if k + 1.0 == count { end } else { at(k + 1.0) };
                let curve = Curve::Arc { begin, end, centre, radius, start: start + k * step, sweep: step };
                Drawn { curve, ..part }
            })
            .collect()
    };
    parts.into_iter().flat_map(pieces).collect()
}

/// Nodes with the section behind each. The first node's section holds the first part, or ends where it begins.
fn nodes(parts: &[Drawn], options: &Options) -> (Vec<Node>, Vec<Section>) {
    let n = parts.len();
    let (mut nodes, mut sections) = (Vec::new(), Vec::new());
    let before = |i: usize| &parts[(i + n - 1) % n];
    // The node in front of the first section is the last one of the loop, so that it comes out first.
    let last_arc = matches!(before(0).curve, Curve::Arc { .. });
    let first_arc = matches!(parts[0].curve, Curve::Arc { .. });
    let sharp = options.radius.unwrap_or(0.0);
    let corner = |part: &Drawn| Node { radius: sharp, sharp: true, span: part.span, at: part.curve.begin() };
    let arc = |part: &Drawn| match part.curve {
        Curve::Arc { radius, .. } => {
            let at = part.curve.at(part.curve.length() / 2.0);
            Some(Node { radius, sharp: false, span: part.span, at })
        }
        Curve::Segment { .. } => None,
    };
    let straight = |i: usize| {
        let part = &parts[i];
        let (p, q) = (before(i), &parts[(i + 1) % n]);
        let (begin, end) = (part.curve.begin(), part.curve.end());
        let gap = p.curve.end().distance(begin) + end.distance(q.curve.begin());
        let length = part.curve.length();
        let heading = headings(&part.curve).0;
        // A straight hardly longer than its ends are inexact says little of its heading; tangents say more.
        let (a, b) = (trig::wrap(headings(&p.curve).1 - heading), trig::wrap(headings(&q.curve).0 - heading));
        let heading = if length < 50.0 * gap && a.abs().max(b.abs()) < 0.2 { heading + (a + b) / 2.0 } else { heading };
        Section { through: begin.lerp(end, 0.5), heading }
    };
    let tangent = |i: usize| {
        let (p, q) = (before(i), &parts[i]);
        let heading = headings(&p.curve).1;
        let bend = trig::wrap(headings(&q.curve).0 - heading);
        Section { through: p.curve.end().lerp(q.curve.begin(), 0.5), heading: heading + bend / 2.0 }
    };
    for (i, part) in parts.iter().enumerate() {
        match (arc(before(i)), arc(part)) {
            (None, None) => nodes.push(corner(part)),
            (Some(_), Some(_)) => sections.push(tangent(i)),
            _ => {}
        }
        match arc(part) {
            Some(node) => nodes.push(node),
            None => sections.push(straight(i)),
        }
    }
    // Now in the order of the parts; a loop that begins behind an arc begins with that arc's vertex.
    if last_arc {
        nodes.rotate_right(1);
    } else if first_arc {
        // A straight in front of the first arc: it is the first section, behind the vertex before it.
        sections.rotate_right(1);
        nodes.rotate_right(1);
    }
    (nodes, sections)
}

/// Whether corners without a curve can be rounded.
fn sharp_corners(nodes: &[Node], parts: &[Drawn], options: &Options, said: &mut Vec<Diagnostic>) -> bool {
    let sharp: Vec<&Node> = nodes.iter().filter(|node| node.sharp).collect();
    let Some(first) = sharp.first().filter(|_| options.radius.is_none()) else { return true };
    let message = match sharp.len() {
        1 => "the centre line has a corner without a curve".to_string(),
        count => format!("the centre line has {count} corners without a curve"),
    };
    let mut diagnostic = Diagnostic::new(Code::E0805, message, first.span, place(first.at));
    for node in sharp.iter().skip(1).take(12) {
        diagnostic = diagnostic.related(node.span, place(node.at));
    }
    let curved = sharp.len() > 20 && 2 * sharp.len() > parts.len();
    said.push(
        diagnostic.expected("straights and arcs that run into each other", "straights with a bend between them").help(
            match curved {
                true => "curves drawn as many short lines have to be redrawn as arcs",
                false => "round the corners in the drawing, or all of them here: `--radius 4m`",
            },
        ),
    );
    false
}

/// Where neighbouring sections meet; `None` where they do not.
fn corners(nodes: &[Node], sections: &[Section]) -> Option<Vec<Corner>> {
    let n = nodes.len();
    if sections.len() != n {
        return None;
    }
    let meet = |i: usize| {
        let (a, b) = (&sections[(i + n - 1) % n], &sections[i]);
        let turn = trig::wrap(b.heading - a.heading).abs();
        if !(LEAST_TURN / 2.0..=LARGEST_TURN + 1e-6).contains(&turn) {
            return None;
        }
        let (u, v) = (Point::unit(a.heading), Point::unit(b.heading));
        let along = (b.through - a.through).cross(v) / u.cross(v);
        Some(Corner { point: a.through + u * along, radius: nodes[i].radius })
    };
    (0..n).map(meet).collect()
}

/// Moves vertices apart whose fillets overlap by no more than the tolerance, and shrinks radii by as much where that
/// does not help.
fn make_room(corners: &mut [Corner], tolerance: f64) {
    let n = corners.len();
    for round in 0..ROUNDS {
        let track = Track::new(corners);
        let mut moved = false;
        for i in 0..n {
            let (j, lacking) = ((i + 1) % n, -track.straight(i).length);
            if lacking <= 2e-10 || lacking > tolerance {
                continue;
            }
            moved = true;
            if round + 20 < ROUNDS {
                let step = Point::unit(track.straight(i).heading) * (lacking / 2.0 + 1e-10);
                corners[i].point = corners[i].point - step;
                corners[j].point = corners[j].point + step;
            } else {
                let tangents = track.fillets[i].tangent + track.fillets[j].tangent;
                let keep = 1.0 - (lacking + 1e-10) / tangents;
                corners[i].radius *= keep;
                corners[j].radius *= keep;
            }
        }
        if !moved {
            return;
        }
    }
}

/// Farthest distance of a drawn piece from the track, m. What a sharp corner's fillet cuts off is meant to be cut off.
fn shift(piece: &Drawn, track: &Track, nodes: &[Node]) -> f64 {
    let cut = |p: Point| {
        track
            .fillets
            .iter()
            .zip(nodes)
            .zip(&track.corners)
            .any(|((fillet, node), corner)| node.sharp && corner.point.distance(p) < fillet.tangent)
    };
    let length = piece.curve.length();
    (0..=SAMPLES)
        .map(|k| piece.curve.at(length * k as f64 / SAMPLES as f64))
        .filter(|p| !cut(*p))
        .map(|p| track.pieces.iter().map(|piece| point_piece(p, piece).1).fold(f64::INFINITY, f64::min))
        .fold(0.0, f64::max)
}

/// Radii, and coordinates of vertices, that are whole millimetres but for what the drawing is inexact by: turns of a
/// right angle come out as such. A vertex whose fillet touches its neighbour's stays. `None` where fillets no longer
/// fit.
fn snapped(track: &Track, healed: &Healed, tolerance: f64) -> Option<Vec<Corner>> {
    let noise = 2.0 * healed.largest_gap.max(healed.largest_shift);
    let whole = |length: f64| {
        let whole = (length * 1e3).round() / 1e3;
        if (length - whole).abs() <= noise { whole } else { length }
    };
    let n = track.corners.len();
    let free = |i: usize| track.straight(i).length.min(track.straight((i + n - 1) % n).length) > 4.0 * noise;
    let at = |p: Point| Point::new(whole(p.x), whole(p.y));
    let corner = |(i, c): (usize, &Corner)| match free(i) {
        true => Corner { point: at(c.point), radius: whole(c.radius) },
        false => *c,
    };
    let mut snapped: Vec<Corner> = track.corners.iter().enumerate().map(corner).collect();
    make_room(&mut snapped, tolerance);
    let lengths = Track::new(&snapped).pieces;
    (snapped.iter().all(|c| c.radius > 0.0) && lengths.iter().all(|piece| piece.length > -1e-9)).then_some(snapped)
}

/// Distance of each drawn piece from a track, m, and the largest.
fn shifts(ring: &Ring, track: &Track, nodes: &[Node]) -> (Vec<f64>, f64) {
    let shifts: Vec<f64> = ring.pieces.iter().map(|piece| shift(piece, track, nodes)).collect();
    let largest = shifts.iter().fold(0.0, |a: f64, b| if b.is_nan() { f64::INFINITY } else { a.max(*b) });
    (shifts, largest)
}

fn kinked(parts: &[Drawn], found: &str) -> Diagnostic {
    let worst = parts
        .iter()
        .enumerate()
        .map(|(i, part)| (trig::wrap(headings(&parts[(i + 1) % parts.len()].curve).0 - headings(&part.curve).1), part))
        .fold(None::<(f64, &Drawn)>, |worst, (bend, part)| match worst {
            Some((most, _)) if most >= bend.abs() => worst,
            _ => Some((bend.abs(), part)),
        });
    let (bend, span) = worst.map_or((0.0, parts[0].span), |(bend, part)| (bend, part.span));
    let label = format!("bends by {} after this", degrees(bend));
    Diagnostic::new(Code::E0805, "the pieces of the centre line do not run into each other", span, label)
        .expected("straights and arcs that are tangent", found)
        .help("draw arcs as fillets between straights")
}

fn moved(pieces: &[Drawn], shifts: &[f64], healed: &Healed, tolerance: f64) -> Diagnostic {
    let mut far: Vec<(f64, &Drawn)> =
        shifts.iter().copied().zip(pieces).filter(|(shift, _)| shift.is_nan() || *shift > tolerance).collect();
    far.sort_by(|a, b| b.0.total_cmp(&a.0));
    let widest = healed.largest_shift;
    let label = |shift: f64, part: &Drawn| {
        format!("would be moved by {} {}", metres(shift), place(part.curve.at(part.curve.length() / 2.0)))
    };
    let first = far.first().copied().unwrap_or((widest, &pieces[0]));
    let message = "the pieces of the centre line do not run into each other";
    let mut diagnostic = Diagnostic::new(Code::E0805, message, first.1.span, label(first.0, first.1));
    for (shift, part) in far.iter().skip(1).take(12) {
        diagnostic = diagnostic.related(part.span, label(*shift, part));
    }
    let found =
        format!("bends of up to {}, gaps of up to {}", degrees(healed.largest_bend), metres(healed.largest_gap));
    let help = match widest < 0.5 {
        true => format!("make them tangent in the drawing, or allow it: `--tolerance {}mm`", (widest * 1e3).ceil()),
        false => "draw arcs as fillets between straights".to_string(),
    };
    diagnostic.expected(format!("a tangent line within {} of the drawing", metres(tolerance)), found).help(help)
}

/// What was done, if anything was.
fn report(ring: &Ring, healed: &Healed) -> Option<Diagnostic> {
    if healed.gaps == 0 && healed.largest_bend < 1e-6 && healed.dropped == 0 && healed.largest_shift < 1e-7 {
        return None;
    }
    let n = ring.pieces.len();
    let rough = |i: usize| {
        let (a, b) = (&ring.pieces[i].curve, &ring.pieces[(i + 1) % n].curve);
        (a.end().distance(b.begin()), trig::wrap(headings(b).0 - headings(a).1).abs())
    };
    let curved = |i: usize| [i, (i + 1) % n].iter().any(|&k| matches!(ring.pieces[k].curve, Curve::Arc { .. }));
    let mut worst: Vec<usize> = (0..n).filter(|&i| rough(i).0 > 1e-9 || curved(i) && rough(i).1 > 1e-6).collect();
    worst.sort_by(|&i, &j| rough(j).0.total_cmp(&rough(i).0).then(rough(j).1.total_cmp(&rough(i).1)));
    let label = |i: usize| {
        let (gap, bend) = rough(i);
        let gap = (gap > 1e-9).then(|| format!("a gap of {}", metres(gap)));
        let bend = (curved(i) && bend > 1e-6).then(|| format!("a bend of {}", degrees(bend)));
        let both: Vec<String> = gap.into_iter().chain(bend).collect();
        format!("ends with {} {}", both.join(" and "), place(ring.pieces[i].curve.end()))
    };
    let first = worst.first().copied();
    let (span, text) = match first {
        Some(i) => (ring.pieces[i].span, label(i)),
        None => (ring.pieces[0].span, "begins here".to_string()),
    };
    let mut diagnostic = Diagnostic::new(Code::W0801, "the centre line was healed", span, text);
    for &i in worst.iter().skip(1).take(12) {
        diagnostic = diagnostic.related(ring.pieces[i].span, label(i));
    }
    let mut found = Vec::new();
    if healed.gaps > 0 {
        found.push(format!("{} of up to {}", walk::count(healed.gaps, "gap"), metres(healed.largest_gap)));
    }
    if healed.largest_bend > 1e-6 {
        found.push(format!("bends of up to {}", degrees(healed.largest_bend)));
    }
    if healed.dropped > 0 {
        found.push(format!("{} too many", walk::count(healed.dropped, "piece")));
    }
    if found.is_empty() {
        found.push("pieces that are not quite straight".to_string());
    }
    let help = format!("no drawn point lies more than {} from the imported line", walk::metres(healed.largest_shift));
    Some(diagnostic.expected("a closed, tangent line", found.join(", ")).help(help))
}

fn degrees(angle: f64) -> String {
    format!("{}°", trimmed(angle * 180.0 / trig::PI, 4))
}
