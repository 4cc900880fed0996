//! On which side of the track each obstacle lies, where no `pass` says so.

use crate::geometry::{Curve, PieceKind, Point, Track, point_piece};
use crate::model::{Obstacle, Side};

/// Takes the side of an obstacle's middle from the written layout. Of a loop that does not cross itself (`simple`), the
/// inside is one side and the outside the other; else the nearest point of the centre line tells.
pub fn settle(track: &Track, simple: bool, obstacles: &mut [Obstacle]) {
    let boxes: Vec<(Point, Point)> = track.pieces.iter().map(|p| Curve::from(p).bounds()).collect();
    // A simple loop turns by one whole turn, left or right.
    let inside_is_left = track.fillets.iter().map(|f| f.turn).sum::<f64>() > 0.0;
    for obstacle in obstacles.iter_mut().filter(|o| o.pass.is_none()) {
        let middle = middle(obstacle.polygon.points());
        let inside = if simple { inside(track, &boxes, middle) } else { None };
        let left = match inside {
            Some(inside) => inside == inside_is_left,
            None => left_of_nearest(track, &boxes, middle),
        };
        obstacle.side = if left { Side::Left } else { Side::Right };
    }
}

/// Whether a point lies inside the loop (even-odd rule); `None` beside an arc, whose chord then does not stand for it.
fn inside(track: &Track, boxes: &[(Point, Point)], p: Point) -> Option<bool> {
    let mut inside = false;
    for (piece, (low, high)) in track.pieces.iter().zip(boxes) {
        if p.y < low.y || p.y > high.y || p.x > high.x {
            continue;
        }
        if p.x >= low.x && matches!(piece.kind, PieceKind::Arc { .. }) {
            return None;
        }
        let (a, b) = (piece.begin, piece.end);
        if (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x) {
            inside = !inside;
        }
    }
    Some(inside)
}

/// Whether a point lies to the left of travel, seen from the nearest point of the centre line.
fn left_of_nearest(track: &Track, boxes: &[(Point, Point)], p: Point) -> bool {
    let mut best = f64::INFINITY;
    let mut left = true;
    for (piece, (low, high)) in track.pieces.iter().zip(boxes) {
        let dx = (low.x - p.x).max(p.x - high.x).max(0.0);
        let dy = (low.y - p.y).max(p.y - high.y).max(0.0);
        if dx * dx + dy * dy > best * best {
            continue;
        }
        let (foot, distance) = point_piece(p, piece);
        if distance < best {
            let along = match piece.kind {
                PieceKind::Straight => piece.end - piece.begin,
                PieceKind::Arc { centre, turn, .. } => (foot - centre).left() * turn.signum(),
            };
            best = distance;
            left = along.cross(p - foot) >= 0.0;
        }
    }
    left
}

fn middle(points: &[Point]) -> Point {
    points.iter().fold(Point::default(), |sum, p| sum + *p) * (1.0 / points.len().max(1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Corner;

    /// Both ways of telling the side agree on a loop with left and right turns, driven either way round.
    #[test]
    fn inside_and_nearest_agree() {
        let points = [
            (0.0, 0.0),
            (40.0, 0.0),
            (40.0, 30.0),
            (25.0, 30.0),
            (25.0, 15.0),
            (15.0, 15.0),
            (15.0, 30.0),
            (0.0, 30.0),
        ];
        let mut corners: Vec<Corner> =
            points.iter().map(|&(x, y)| Corner { point: Point::new(x, y), radius: 4.0 }).collect();
        for _ in 0..2 {
            let track = Track::new(&corners);
            let boxes: Vec<(Point, Point)> = track.pieces.iter().map(|p| Curve::from(p).bounds()).collect();
            let ccw = track.fillets.iter().map(|f| f.turn).sum::<f64>() > 0.0;
            let mut told = 0;
            for i in 0..60 {
                for j in 0..50 {
                    let p = Point::new(f64::from(i) - 9.7, f64::from(j) - 9.3);
                    if let Some(inside) = inside(&track, &boxes, p) {
                        assert_eq!(inside == ccw, left_of_nearest(&track, &boxes, p), "{p:?}");
                        told += 1;
                    }
                }
            }
            assert!(told > 2_500, "{told}");
            corners.reverse();
        }
    }
}
