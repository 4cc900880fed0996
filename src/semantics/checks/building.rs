//! A start layout outside the building.

use crate::diagnostic::{Code, Diagnostic};
use crate::geometry::{Curve, Piece, PieceKind, Track, piece_distance};
use crate::model::{Building, Vertex};
use crate::semantics::scope::Context;
use crate::semantics::value::metres;

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
        let found = match farthest > 0.0 {
            true => format!("tangent points up to {} outside", metres(farthest)),
            false => "a wall in its way".to_string(),
        };
        let mut diagnostic = Diagnostic::new(
            Code::E0407,
            "the written layout leaves the building",
            vertices[first.vertex].span,
            name(first),
        )
        .expected("a centre line inside the walls", found)
        .related(building.span, "the building");
        let mut said = vec![first.vertex];
        for piece in outside.iter().skip(1) {
            if !said.contains(&piece.vertex) && said.len() < 20 {
                said.push(piece.vertex);
                diagnostic = diagnostic.related(vertices[piece.vertex].span, name(piece));
            }
        }
        self.report(diagnostic.help("the optimiser starts from the written layout, which must lie inside"));
    }
}
