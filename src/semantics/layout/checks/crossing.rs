//! A loop that crosses itself without headroom.

use crate::diagnostic::{Code, Diagnostic};
use crate::geometry::{Curve, Piece, PieceKind, Point, Track, piece_distance};
use crate::model::{Heights, Level, Vertex};
use crate::semantics::scope::Context;
use crate::semantics::value::metres;

/// Pieces closer than this touch, m.
const TOUCH: f64 = 1e-9;
/// Crossings after which no more are looked for.
const MOST: usize = 10;

impl Context<'_> {
    /// Whether the loop stays clear of itself: where it crosses in the plan, one section is `headroom` above the other,
    /// m.
    pub(super) fn check_crossings(&self, vertices: &[Vertex], track: &Track, levels: &[Level], headroom: f64) -> bool {
        let heights = Heights::new(vertices.len(), levels);
        let name = |piece: &Piece| {
            let (at, next) = (&vertices[piece.vertex].name, &vertices[(piece.vertex + 1) % vertices.len()].name);
            match piece.kind {
                PieceKind::Straight => format!("`{at}..{next}`"),
                PieceKind::Arc { .. } => format!("the curve at `{at}`"),
            }
        };
        let found = crossings(track, &heights, headroom.max(TOUCH));
        if let Some(((a, b), others)) = found.split_first() {
            let place = |piece: &Piece| vertices[piece.vertex].span;
            let count = match (found.len(), found.len() == MOST) {
                (1, _) => String::new(),
                (n, false) => format!(" and {} more times", n - 1),
                (n, true) => format!(" and {} more times or more", n - 1),
            };
            let message = format!("the loop crosses itself: {} meets {}{count}", name(a), name(b));
            let mut diagnostic = Diagnostic::new(Code::E0405, message, place(b), format!("{} crosses", name(b)))
                .related(place(a), format!("{} here", name(a)))
                .help(match headroom {
                    h if h > 0.0 => format!(
                        "are the vertices in driving order? Where one section is meant to pass above the other, give \
                         both a `level`, {} apart or more",
                        metres(h)
                    ),
                    _ => "are the vertices in driving order? Where one section is meant to pass above the other, give \
                          both a `level`, at different heights"
                        .to_string(),
                });
            for (a, b) in others {
                diagnostic = diagnostic.related(place(b), format!("{} crosses {}", name(b), name(a)));
            }
            if let Some(point) = meeting(a, b) {
                let found = format!("a crossing at ({}, {})", metres(point.x), metres(point.y));
                let apart = heights.apart(a, b);
                let (expected, found) = match apart > 0.0 {
                    true => (
                        format!("the catalogue's headroom of {}", metres(headroom)),
                        format!("{found} with {} between the levels", metres(apart)),
                    ),
                    false => ("a loop that does not cross itself on one level".to_string(), found),
                };
                diagnostic = diagnostic.expected(expected, found);
            }
            self.report(diagnostic);
        }
        found.is_empty()
    }
}

/// Pairs of pieces that cross without headroom, at most [`MOST`]. A sweep along x: O(n log n) and the pairs whose
/// extents in x overlap, each of which costs a comparison. [`crate::geometry::self_crossings`] finds all, and how near
/// a miss is; this one stops early, because hostile input crosses itself millions of times.
fn crossings<'a>(track: &'a Track, heights: &Heights, headroom: f64) -> Vec<(&'a Piece, &'a Piece)> {
    let boxes: Vec<(Point, Point)> = track.pieces.iter().map(|p| Curve::from(p).bounds()).collect();
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    order.sort_by(|a, b| boxes[*a].0.x.total_cmp(&boxes[*b].0.x));
    let mut found = Vec::new();
    for (place, &a) in order.iter().enumerate() {
        let (low, high) = boxes[a];
        for &b in order[place + 1..].iter().take_while(|b| boxes[**b].0.x <= high.x) {
            if boxes[b].0.y > high.y || boxes[b].1.y < low.y {
                continue;
            }
            let (i, j) = (a.min(b), a.max(b));
            let neighbours = j - i == 1 || j - i == boxes.len() - 1;
            let (p, q) = (&track.pieces[i], &track.pieces[j]);
            if neighbours || near_each_other(track, i, j) || heights.apart(p, q) >= headroom - TOUCH || !meet(p, q) {
                continue;
            }
            found.push((i, j));
            if found.len() == MOST {
                return pieces(track, found);
            }
        }
    }
    pieces(track, found)
}

fn pieces(track: &Track, mut found: Vec<(usize, usize)>) -> Vec<(&Piece, &Piece)> {
    found.sort_unstable();
    found.into_iter().map(|(i, j)| (&track.pieces[i], &track.pieces[j])).collect()
}

/// Pieces on both sides of a straight of no length touch without crossing.
fn near_each_other(track: &Track, i: usize, j: usize) -> bool {
    let n = track.pieces.len();
    let empty = |k: usize| track.pieces[k % n].length < 1e-6;
    (j - i == 2 && empty(i + 1)) || (n - (j - i) == 2 && empty(j + 1))
}

fn meet(a: &Piece, b: &Piece) -> bool {
    match (a.kind, b.kind) {
        (PieceKind::Straight, PieceKind::Straight) => meeting(a, b).is_some(),
        _ => piece_distance(a, b) < TOUCH,
    }
}

/// Where two straights meet; `None` for arcs and parallels.
fn meeting(a: &Piece, b: &Piece) -> Option<Point> {
    if a.kind != PieceKind::Straight || b.kind != PieceKind::Straight {
        return None;
    }
    let (u, v, w) = (a.end - a.begin, b.end - b.begin, b.begin - a.begin);
    let det = u.cross(v);
    let (s, t) = (w.cross(v) / det, w.cross(u) / det);
    let inside = |x: f64| (-1e-12..=1.0 + 1e-12).contains(&x);
    if inside(s) && inside(t) {
        return Some(a.begin + u * s);
    }
    // Parallels meet where one begins on the other.
    let on = |p: Point, piece: &Piece| crate::geometry::point_piece(p, piece).1 < TOUCH;
    let parallel = det.abs() < 1e-12 * u.norm() * v.norm();
    (parallel && (on(b.begin, a) || on(b.end, a) || on(a.begin, b))).then_some(b.begin)
}
