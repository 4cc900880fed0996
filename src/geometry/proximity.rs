//! Where a track comes close to itself.
//!
//! Two strands come closest where at least one of them curves towards the other, so an arc takes part in every local
//! minimum: against a straight, against the outer side of another arc, or from within another arc. Strands that cross
//! do not meet in this sense; [`self_crossings`](super::self_crossings) finds those.

use super::Track;
use super::clearance::NearPiece;

/// A local minimum of the distance between two parts of the centre line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    /// Vertex of the arc that bulges towards the other part.
    pub arc: usize,
    pub other: NearPiece,
    /// On which side of the other part, in its direction of travel, the arc lies: +1 left, -1 right.
    pub side: f64,
    /// m
    pub distance: f64,
}

/// Every meeting of parts that are not neighbours and closer than `reach`, in a fixed order.
pub fn meetings(track: &Track, reach: f64) -> Vec<Meeting> {
    let n = track.fillets.len();
    let mut found = Vec::new();
    for arc in 0..n {
        let (before, next) = ((arc + n - 1) % n, (arc + 1) % n);
        for vertex in 0..n {
            if vertex != arc && vertex != before {
                found.extend(with_straight(track, arc, vertex, reach));
            }
            if vertex != arc && vertex != before && vertex != next {
                if vertex > arc {
                    found.extend(with_arc(track, arc, vertex, reach));
                }
                found.extend(within_arc(track, arc, vertex, reach));
            }
        }
    }
    found
}

fn with_straight(track: &Track, arc: usize, vertex: usize, reach: f64) -> Option<Meeting> {
    let (fillet, straight) = (&track.fillets[arc], track.straight(vertex));
    let along = (straight.end - straight.begin) * (1.0 / straight.length);
    let offset = along.cross(fillet.centre - straight.begin);
    let side = if offset < 0.0 { -1.0 } else { 1.0 };
    let distance = side * offset - fillet.radius;
    let foot = along.dot(fillet.centre - straight.begin);
    let beside = straight.length > 0.0 && foot >= 0.0 && foot <= straight.length;
    (beside && distance > 0.0 && distance < reach && fillet.faces(along.left() * -side)).then_some(Meeting {
        arc,
        other: NearPiece::Straight(vertex),
        side,
        distance,
    })
}

/// Two arcs that bulge towards each other.
fn with_arc(track: &Track, arc: usize, vertex: usize, reach: f64) -> Option<Meeting> {
    let (a, b) = (&track.fillets[arc], &track.fillets[vertex]);
    let between = b.centre - a.centre;
    let distance = between.norm() - a.radius - b.radius;
    let meet = distance > 0.0 && distance < reach && a.faces(between) && b.faces(-between);
    meet.then_some(Meeting { arc, other: NearPiece::Arc(vertex), side: -b.turn.signum(), distance })
}

/// The arc of `arc` on the concave side of that of `vertex`.
fn within_arc(track: &Track, arc: usize, vertex: usize, reach: f64) -> Option<Meeting> {
    let (a, b) = (&track.fillets[arc], &track.fillets[vertex]);
    let out = a.centre - b.centre;
    let distance = b.radius - out.norm() - a.radius;
    let meet = distance > 0.0 && distance < reach && a.faces(out) && b.faces(out);
    meet.then_some(Meeting { arc, other: NearPiece::Arc(vertex), side: b.turn.signum(), distance })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Corner, Point, band_overlaps};

    /// A dumb-bell: two lobes joined by a neck of the given width, whose four corners bulge inwards.
    fn dumbbell(neck: f64) -> Track {
        let corner = |x: f64, y: f64| Corner { point: Point::new(x, y), radius: 3.0 };
        let h = neck / 2.0;
        let right = [(6.0, -h), (14.0, -10.0), (30.0, -10.0), (30.0, 10.0), (14.0, 10.0), (6.0, h)];
        let left = [(-6.0, h), (-14.0, 10.0), (-30.0, 10.0), (-30.0, -10.0), (-14.0, -10.0), (-6.0, -h)];
        Track::new(&right.iter().chain(&left).map(|&(x, y)| corner(x, y)).collect::<Vec<_>>())
    }

    #[test]
    fn the_nearest_meeting_is_the_distance_of_the_nearest_pieces() {
        for neck in [0.5, 1.0, 2.0, 4.0] {
            let track = dumbbell(neck);
            let nearest = meetings(&track, 5.0).iter().map(|m| m.distance).fold(f64::INFINITY, f64::min);
            let pieces = band_overlaps(&track, 5.0).iter().map(|o| o.2).fold(f64::INFINITY, f64::min);
            assert!((nearest - pieces).abs() < 1e-9, "neck {neck}: {nearest} {pieces}");
        }
    }
}
