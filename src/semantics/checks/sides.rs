//! On which side of the track each obstacle lies, where no `pass` says so.

use crate::geometry::{Curve, Piece, PieceKind, Point, Track, point_piece};
use crate::model::{Obstacle, Side};

/// Takes the side from the written layout: that of the obstacle's middle, seen from the nearest point of the centre
/// line.
pub(super) fn settle(track: &Track, obstacles: &mut [Obstacle]) {
    let boxes: Vec<(Point, Point)> = track.pieces.iter().map(|p| Curve::from(p).bounds()).collect();
    for obstacle in obstacles.iter_mut().filter(|o| o.pass.is_none()) {
        let middle = middle(obstacle.polygon.points());
        let mut best: Option<(f64, &Piece, Point)> = None;
        for (piece, (low, high)) in track.pieces.iter().zip(&boxes) {
            let dx = (low.x - middle.x).max(middle.x - high.x).max(0.0);
            let dy = (low.y - middle.y).max(middle.y - high.y).max(0.0);
            if best.as_ref().is_none_or(|(d, ..)| dx * dx + dy * dy < d * d) {
                let (foot, distance) = point_piece(middle, piece);
                if best.as_ref().is_none_or(|(d, ..)| distance < *d) {
                    best = Some((distance, piece, foot));
                }
            }
        }
        if let Some((_, piece, foot)) = best {
            let along = match piece.kind {
                PieceKind::Straight => piece.end - piece.begin,
                PieceKind::Arc { centre, turn, .. } => (foot - centre).left() * turn.signum(),
            };
            obstacle.side = if along.cross(middle - foot) < 0.0 { Side::Right } else { Side::Left };
        }
    }
}

fn middle(points: &[Point]) -> Point {
    points.iter().fold(Point::default(), |sum, p| sum + *p) * (1.0 / points.len().max(1) as f64)
}
