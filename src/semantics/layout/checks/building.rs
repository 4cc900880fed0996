//! A start layout outside the building.

use crate::diagnostic::{Code, Diagnostic};
use crate::geometry::{Curve, Piece, PieceKind, Track, piece_distance};
use crate::model::{Building, Vertex};
use crate::semantics::scope::Context;
use crate::semantics::value::metres;

/// The vertices outside the walls and how far, m, the farthest first.
fn vertices_outside(vertices: &[Vertex], building: &Building) -> Vec<(usize, f64)> {
    let outline = &building.polygon;
    let away =
        |i: usize| (!outline.contains(vertices[i].point)).then(|| outline.distance_to_outline(vertices[i].point));
    // On the wall is not outside.
    let out = (0..vertices.len()).filter_map(|i| Some((i, away(i)?))).filter(|(_, by)| *by > 1e-9);
    let mut found: Vec<(usize, f64)> = out.collect();
    found.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
    found
}

impl Context<'_> {
    /// The centre line must run inside the walls. Room for the band beside it is the optimiser's matter.
    pub(super) fn check_building(&self, vertices: &[Vertex], track: &Track, building: &Building) {
        let walls: Vec<Piece> = building
            .polygon
            .edges()
            .map(|(begin, end)| {
                let (heading, length) = ((end - begin).heading(), begin.distance(end));
                Piece { kind: PieceKind::Straight, vertex: 0, begin, end, heading, s: 0.0, length }
            })
            .collect();
        let boxes: Vec<_> = walls.iter().map(|w| Curve::from(w).bounds()).collect();
        let (low, high) = building.polygon.bounds();
        let mut outside: Vec<&Piece> = Vec::new();
        let mut farthest: f64 = 0.0;
        for piece in &track.pieces {
            let (from, to) = Curve::from(piece).bounds();
            let within_bounds = from.x >= low.x && from.y >= low.y && to.x <= high.x && to.y <= high.y;
            let begins_outside = !building.polygon.contains(piece.begin);
            if begins_outside {
                farthest = farthest.max(building.polygon.distance_to_outline(piece.begin));
            }
            let meets = |(wall, (a, b)): (&Piece, &(crate::geometry::Point, crate::geometry::Point))| {
                a.x <= to.x && b.x >= from.x && a.y <= to.y && b.y >= from.y && piece_distance(wall, piece) < 1e-9
            };
            if begins_outside || !within_bounds || walls.iter().zip(&boxes).any(meets) {
                outside.push(piece);
            }
        }
        let Some(first) = outside.first() else { return };
        let name = |piece: &Piece| {
            let (at, next) = (&vertices[piece.vertex].name, &vertices[(piece.vertex + 1) % vertices.len()].name);
            match piece.kind {
                PieceKind::Straight => format!("`{at}..{next}` leaves it"),
                PieceKind::Arc { .. } => format!("the curve at `{at}` leaves it"),
            }
        };
        let beyond = vertices_outside(vertices, building);
        let found = match (beyond.first(), farthest > 0.0) {
            (Some((worst, by)), _) => format!("`{}` {} outside", vertices[*worst].name, metres(*by)),
            (None, true) => format!("tangent points up to {} outside", metres(farthest)),
            (None, false) => "a wall in its way".to_string(),
        };
        let lies = |i: usize, by: f64| format!("`{}` lies {} outside", vertices[i].name, metres(by));
        let (vertex, label) = match beyond.first() {
            Some((worst, by)) => (*worst, lies(*worst, *by)),
            None => (first.vertex, name(first)),
        };
        let message = "the written layout leaves the building";
        let mut diagnostic = Diagnostic::new(Code::E0407, message, vertices[vertex].span, label)
            .expected("a centre line inside the walls", found)
            .related(building.span, "the building");
        let mut said = vec![vertex];
        for (i, by) in beyond.iter().skip(1).take(19) {
            said.push(*i);
            diagnostic = diagnostic.related(vertices[*i].span, lies(*i, *by));
        }
        for piece in &outside {
            // The neighbours of a vertex outside leave the building with it.
            let told = |i: usize| said.contains(&i);
            let straight = piece.kind == PieceKind::Straight;
            let known = told(piece.vertex) || (straight && told((piece.vertex + 1) % vertices.len()));
            if !known && said.len() < 20 {
                said.push(piece.vertex);
                diagnostic = diagnostic.related(vertices[piece.vertex].span, name(piece));
            }
        }
        self.report(diagnostic.help("the optimiser starts from the written layout, which must lie inside"));
    }
}
