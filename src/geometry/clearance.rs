//! Where a track comes close to a region it must stay out of, and how far away it is there.
//!
//! The track's centre line is a smooth curve of straights and arcs, so its distance to a polygon has its local
//! minima at two kinds of place only: a corner of the polygon that faces the track, against a straight or an arc;
//! and an edge of the polygon against the outer (convex) side of an arc. Each such [`Approach`] has a closed form
//! with a derivative, which is what steers the optimiser; the overlap area of thesis §3.3.1 cannot, because its
//! gradient is zero wherever the constraint holds.

use super::contact::line_circle;
use super::polygon::segments_meet;
use super::{Piece, PieceKind, Point, Polygon, Track};

/// A polygon that the centre line keeps a distance from.
#[derive(Clone, Debug)]
pub struct Region {
    pub polygon: Polygon,
    /// The forbidden part is outside the polygon (a building) rather than inside (an obstacle).
    pub outside: bool,
    /// +1 when the forbidden part lies to the left of travel, -1 to the right.
    pub lies: f64,
}

/// The part of a polygon that is approached, by index of its point or of the edge that begins there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Feature {
    Corner(usize),
    Edge(usize),
}

/// The part of the track that approaches, by vertex.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum NearPiece {
    Straight(usize),
    Arc(usize),
}

/// A local minimum of the distance between a region and the centre line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach {
    pub feature: Feature,
    pub part: NearPiece,
    /// Signed distance from the centre line to the forbidden part, m; negative when the track is in it or passes it
    /// on the wrong side.
    pub distance: f64,
}

/// An edge of a region with the unit normal into the allowed part.
#[derive(Clone, Copy, Debug)]
pub struct Edge {
    pub begin: Point,
    pub end: Point,
    pub normal: Point,
}

/// How far beyond a concave end of the allowed part an edge's line still counts, m: an arc that pokes out of a
/// building's convex corner is beyond both walls.
const BEYOND: f64 = 5.0;
/// Tolerance on being beside a straight or within an arc, m.
const SLACK: f64 = 1e-9;

impl Region {
    pub fn edge(&self, i: usize) -> Edge {
        let points = self.polygon.points();
        let (begin, end) = (points[i], points[(i + 1) % points.len()]);
        let along = (end - begin) * (1.0 / begin.distance(end));
        let normal = if self.outside { along.left() } else { -along.left() };
        Edge { begin, end, normal }
    }

    /// Whether the forbidden part is convex at this corner: only then can the corner be what the track meets.
    fn faces(&self, i: usize) -> bool {
        self.polygon.is_convex_at(i) != self.outside
    }

    fn forbids(&self, p: Point) -> bool {
        self.polygon.contains(p) != self.outside
    }

    /// Every approach closer than `reach`, in a fixed order. Those on the wrong side are always among them.
    pub fn approaches(&self, track: &Track, reach: f64) -> Vec<Approach> {
        let mut found = Vec::new();
        let count = self.polygon.points().len();
        for i in (0..count).filter(|&i| self.faces(i)) {
            self.corner_approaches(track, i, reach, &mut found);
        }
        for i in 0..count {
            self.edge_approaches(track, i, reach, &mut found);
        }
        for index in self.pierced(track) {
            self.piercing_approaches(track, index, &mut found);
        }
        if self.outside && found.iter().all(|a| a.distance >= 0.0) && self.forbids(track.pieces[0].begin) {
            found.extend(self.away(track));
        }
        found
    }

    /// A track that lies outside of everything, as it passes no corner and is over no edge: the least of what its arcs are
    /// behind an edge's line.
    fn away(&self, track: &Track) -> Option<Approach> {
        let behind = |(vertex, i): (usize, usize)| {
            let (edge, fillet) = (self.edge(i), &track.fillets[vertex]);
            let distance = edge.normal.dot(fillet.centre - edge.normal * fillet.radius - edge.begin);
            let approach = Approach { feature: Feature::Edge(i), part: NearPiece::Arc(vertex), distance };
            (distance < 0.0 && fillet.faces(-edge.normal)).then_some(approach)
        };
        let edges = 0..self.polygon.points().len();
        let all = edges.flat_map(|i| (0..track.fillets.len()).map(move |vertex| (vertex, i)));
        all.filter_map(behind).max_by(|a, b| a.distance.total_cmp(&b.distance))
    }

    /// The track's pieces that cut or touch the outline.
    pub fn pierced(&self, track: &Track) -> Vec<usize> {
        let (low, high) = self.polygon.bounds();
        let meets = |piece: &Piece| {
            let arc = matches!(piece.kind, PieceKind::Arc { .. });
            let swell = if arc { piece.length / 2.0 } else { 0.0 };
            let (near, far) = super::polygon::bounds([piece.begin, piece.end].into_iter());
            let apart =
                near.x - swell > high.x || far.x + swell < low.x || near.y - swell > high.y || far.y + swell < low.y;
            !apart && self.polygon.edges().any(|(a, b)| piece_meets(track, piece, a, b))
        };
        (0..track.pieces.len()).filter(|&i| track.pieces[i].length > 0.0 && meets(&track.pieces[i])).collect()
    }

    /// Signed distance from the centre line to the forbidden part, m.
    pub fn distance(&self, track: &Track) -> f64 {
        let near = |reach| self.approaches(track, reach).iter().map(|a| a.distance).fold(f64::INFINITY, f64::min);
        let distance = near(f64::INFINITY);
        if distance > 0.0 && !self.pierced(track).is_empty() { 0.0 } else { distance }
    }

    fn corner_approaches(&self, track: &Track, i: usize, reach: f64, found: &mut Vec<Approach>) {
        let q = self.polygon.points()[i];
        // A local offset tells the side only where nothing lies between: at the nearest part.
        let mut nearest: Option<Approach> = None;
        for index in 0..track.pieces.len() {
            let Some((part, offset)) = offset(track, index, q) else { continue };
            let approach = Approach { feature: Feature::Corner(i), part, distance: self.lies * offset };
            if nearest.is_none_or(|n| approach.distance.abs() < n.distance.abs()) {
                nearest = Some(approach);
            }
            if approach.distance >= 0.0 && approach.distance < reach {
                found.push(approach);
            }
        }
        found.extend(nearest.filter(|n| n.distance < 0.0));
    }

    /// Where a piece cuts through, the corners on its wrong side count for it, whatever else is nearer to them: a
    /// strand that crosses an obstacle may leave every corner on the right side of some other strand.
    fn piercing_approaches(&self, track: &Track, index: usize, found: &mut Vec<Approach>) {
        let count = track.pieces.len();
        let around = [index, (index + 1) % count, (index + count - 1) % count];
        for (i, &q) in self.polygon.points().iter().enumerate().filter(|(i, _)| self.faces(*i)) {
            let Some((part, offset)) = around.iter().find_map(|&k| offset(track, k, q)) else { continue };
            let approach = Approach { feature: Feature::Corner(i), part, distance: self.lies * offset };
            let known = |a: &Approach| a.feature == approach.feature && a.part == part;
            if approach.distance < 0.0 && !found.iter().any(known) {
                found.push(approach);
            }
        }
    }

    fn edge_approaches(&self, track: &Track, i: usize, reach: f64, found: &mut Vec<Approach>) {
        let edge = self.edge(i);
        let length = edge.begin.distance(edge.end);
        let along = (edge.end - edge.begin) * (1.0 / length);
        let encloses = self.encloses(i);
        let (low, high) = if encloses { (f64::NEG_INFINITY, f64::INFINITY) } else { self.range(i) };
        for (vertex, fillet) in track.fillets.iter().enumerate() {
            let lowest = fillet.centre - edge.normal * fillet.radius;
            let distance = edge.normal.dot(lowest - edge.begin);
            let foot = along.dot(lowest - edge.begin);
            if distance >= reach || foot < low || foot > high || !fillet.faces(-edge.normal) {
                continue;
            }
            let behind = distance < 0.0 && !encloses;
            if behind && (!self.forbids(lowest) || self.nearest_edge(lowest) != i) {
                continue;
            }
            found.push(Approach { feature: Feature::Edge(i), part: NearPiece::Arc(vertex), distance });
        }
    }

    /// Whether everything that is allowed lies on one side of an edge's line, so that no arc may be behind it anywhere.
    pub fn encloses(&self, i: usize) -> bool {
        if !self.outside {
            return false;
        }
        let edge = self.edge(i);
        self.polygon.points().iter().all(|p| edge.normal.dot(*p - edge.begin) >= -SLACK)
    }

    /// From where to where along an edge that does not enclose, m from its begin, an arc over it approaches it.
    pub fn range(&self, i: usize) -> (f64, f64) {
        let edge = self.edge(i);
        let beyond = |corner: usize| if self.faces(corner) { SLACK } else { BEYOND };
        let next = (i + 1) % self.polygon.points().len();
        (-beyond(i), edge.begin.distance(edge.end) + beyond(next))
    }

    fn nearest_edge(&self, p: Point) -> usize {
        let mut best = (f64::INFINITY, 0);
        for (i, (a, b)) in self.polygon.edges().enumerate() {
            let d = super::polygon::distance_to_segment(p, a, b);
            if d < best.0 {
                best = (d, i);
            }
        }
        best.1
    }
}

/// Whether a piece and the edge `a`..`b` have a point in common.
fn piece_meets(track: &Track, piece: &Piece, a: Point, b: Point) -> bool {
    match piece.kind {
        PieceKind::Straight => segments_meet(piece.begin, piece.end, a, b),
        PieceKind::Arc { centre, radius, .. } => {
            let fillet = &track.fillets[piece.vertex];
            let within = |p: &Point| (*p - a).dot(*p - b) <= 0.0 && fillet.faces(*p - centre);
            line_circle(a, b, centre, radius).is_some_and(|points| points.iter().any(within))
        }
    }
}

/// The lateral offset (m, left positive) of `q` from piece `index`, when the foot lies on the piece.
pub fn offset(track: &Track, index: usize, q: Point) -> Option<(NearPiece, f64)> {
    let piece = &track.pieces[index];
    match piece.kind {
        PieceKind::Straight => {
            if piece.length < 0.0 {
                return None;
            }
            let (a, b) =
                (track.corners[piece.vertex].point, track.corners[(piece.vertex + 1) % track.corners.len()].point);
            let along = (b - a) * (1.0 / a.distance(b));
            let foot = along.dot(q - piece.begin);
            (foot >= -SLACK && foot <= piece.length + SLACK)
                .then(|| (NearPiece::Straight(piece.vertex), along.cross(q - a)))
        }
        PieceKind::Arc { centre, radius, turn } => {
            let fillet = &track.fillets[piece.vertex];
            fillet
                .faces(q - centre)
                .then(|| (NearPiece::Arc(piece.vertex), turn.signum() * (radius - q.distance(centre))))
        }
    }
}

/// The lateral offset (m, left positive) of a point from the nearest part of the centre line: which side of travel
/// it lies on. `None` when the track is so infeasible that no part lies beside the point.
pub fn lateral_offset(track: &Track, q: Point) -> Option<f64> {
    (0..track.pieces.len())
        .filter_map(|i| offset(track, i, q))
        .map(|(_, offset)| offset)
        .min_by(|a, b| a.abs().total_cmp(&b.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Corner;

    /// 20 m x 10 m, corners of 3 m, counter-clockwise from the origin.
    fn loop_20_by_10() -> Track {
        let corner = |x, y| Corner { point: Point::new(x, y), radius: 3.0 };
        Track::new(&[corner(0.0, 0.0), corner(20.0, 0.0), corner(20.0, 10.0), corner(0.0, 10.0)])
    }

    fn square(x: f64, y: f64, side: f64) -> Polygon {
        let p = Point::new;
        Polygon::new(vec![p(x, y), p(x + side, y), p(x + side, y + side), p(x, y + side)]).unwrap()
    }

    /// Distance of the polygon's outline to the centre line, both sampled finely.
    fn sampled(track: &Track, polygon: &Polygon) -> f64 {
        let line: Vec<Point> = (0..40_000).map(|i| track.at(track.length * i as f64 / 40_000.0).0).collect();
        line.iter().map(|&p| polygon.distance_to_outline(p)).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn distance_agrees_with_sampling() {
        let track = loop_20_by_10();
        for (x, y, side, lies) in [
            (8.0, 2.0, 2.0, 1.0),    // inside, against a straight
            (3.0, 3.0, 1.0, 1.0),    // inside a corner's arc
            (1.5, 6.0, 1.0, 1.0),    // inside, in the opposite corner
            (-4.0, -4.0, 4.2, -1.0), // outside an arc, corner first
            (22.0, 3.0, 2.0, -1.0),  // outside, against a straight
        ] {
            let region = Region { polygon: square(x, y, side), outside: false, lies };
            let (exact, fine) = (region.distance(&track), sampled(&track, &region.polygon));
            assert!((exact - fine).abs() < 1e-3, "square at ({x}, {y}): {exact} against {fine}");
        }
    }

    #[test]
    fn building_walls_and_notches() {
        let track = loop_20_by_10();
        let p = Point::new;
        // Walls 1 m outside, with a notch that reaches 0.5 m closer at the top.
        let walls = vec![
            p(-1.0, -1.0),
            p(21.0, -1.0),
            p(21.0, 11.0),
            p(12.0, 11.0),
            p(12.0, 10.5),
            p(8.0, 10.5),
            p(8.0, 11.0),
            p(-1.0, 11.0),
        ];
        let region = Region { polygon: Polygon::new(walls).unwrap(), outside: true, lies: -1.0 };
        assert!((region.distance(&track) - 0.5).abs() < 1e-12);
    }

    #[test]
    fn a_loop_outside_of_its_building_is_told() {
        let p = Point::new;
        let hall = vec![p(0.0, 0.0), p(60.0, 0.0), p(60.0, 40.0), p(0.0, 40.0)];
        // No edge of a star holds all of it.
        let star = (0..10).map(|k| {
            let far = if k % 2 == 0 { 60.0 } else { 20.0 };
            p(30.0, 20.0) + Point::unit(std::f64::consts::PI * f64::from(k) / 5.0) * far
        });
        for walls in [hall, star.collect()] {
            let region = Region { polygon: Polygon::new(walls).unwrap(), outside: true, lies: -1.0 };
            for (x, y) in [(-30.0, -30.0), (-30.0, 70.0), (100.0, 70.0), (100.0, -40.0), (25.0, -60.0), (-90.0, 15.0)] {
                let corner = |dx, dy| Corner { point: p(x + dx, y + dy), radius: 3.0 };
                let track = Track::new(&[corner(0.0, 0.0), corner(20.0, 0.0), corner(20.0, 10.0), corner(0.0, 10.0)]);
                assert!(region.distance(&track) < -1.0, "({x}, {y}): {}", region.distance(&track));
            }
            let corner = |dx, dy| Corner { point: p(20.0 + dx, 15.0 + dy), radius: 3.0 };
            let track = Track::new(&[corner(0.0, 0.0), corner(20.0, 0.0), corner(20.0, 10.0), corner(0.0, 10.0)]);
            assert!(region.distance(&track) > 1.0);
        }
    }

    #[test]
    fn an_arc_against_an_edge_is_closed_form() {
        let track = loop_20_by_10();
        // A 45° wall off the lower left corner: its line is x + y = -0.2.
        let p = Point::new;
        let wedge = Polygon::new(vec![p(-4.2, 4.0), p(-6.0, -6.0), p(4.0, -4.2)]).unwrap();
        let region = Region { polygon: wedge, outside: false, lies: -1.0 };
        let expected = (6.2 / 2f64.sqrt()) - 3.0;
        assert!((region.distance(&track) - expected).abs() < 1e-12);
    }

    #[test]
    fn a_bar_across_the_loop_is_pierced() {
        let track = loop_20_by_10();
        let p = Point::new;
        // All four corners lie outside, to the right of the strand nearest to each.
        let bar = vec![p(9.0, -5.0), p(11.0, -5.0), p(11.0, 15.0), p(9.0, 15.0)];
        let region = Region { polygon: Polygon::new(bar).unwrap(), outside: false, lies: -1.0 };
        assert_eq!(region.pierced(&track), [0, 4]);
        assert!((region.distance(&track) + 15.0).abs() < 1e-12);
    }

    #[test]
    fn penetration_is_negative() {
        let track = loop_20_by_10();
        // A square on the lower straight that should lie to the left: its lower edge is 0.5 m on the wrong side.
        let region = Region { polygon: square(9.0, -0.5, 1.0), outside: false, lies: 1.0 };
        assert!((region.distance(&track) + 0.5).abs() < 1e-12);
    }
}
