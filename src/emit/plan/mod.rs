//! What the drawings share, in world coordinates (metres, y up): lines and true arcs, the band's two sides, clearance
//! outlines, and the places of the equipment.

mod climbs;
mod marks;
mod offset;
#[cfg(test)]
pub mod samples;
mod setting_out;

pub use climbs::{Climb, climbs};
pub use marks::{Mark, MarkKind, marks};
pub use offset::{inset, outset};
pub use setting_out::{PointGroup, WallDistance, from_origin, ordinates, points, wall_distances};

use crate::base::trig;
use crate::geometry::{Piece, PieceKind, Point, Track};

/// A line or a circular arc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlanCurve {
    Line {
        begin: Point,
        end: Point,
    },
    /// Angles in rad from +x; the sweep is signed, left positive.
    Arc {
        centre: Point,
        radius: f64,
        start: f64,
        sweep: f64,
    },
}

impl PlanCurve {
    pub fn begin(&self) -> Point {
        match *self {
            PlanCurve::Line { begin, .. } => begin,
            PlanCurve::Arc { centre, radius, start, .. } => centre + Point::unit(start) * radius,
        }
    }

    pub fn end(&self) -> Point {
        match *self {
            PlanCurve::Line { end, .. } => end,
            PlanCurve::Arc { centre, radius, start, sweep } => centre + Point::unit(start + sweep) * radius,
        }
    }

    /// m
    #[cfg(test)]
    pub fn length(&self) -> f64 {
        match *self {
            PlanCurve::Line { begin, end } => begin.distance(end),
            PlanCurve::Arc { radius, sweep, .. } => radius * sweep.abs(),
        }
    }

    /// The point at the fraction `t` of the curve.
    pub fn at(&self, t: f64) -> Point {
        match *self {
            PlanCurve::Line { begin, end } => begin.lerp(end, t),
            PlanCurve::Arc { centre, radius, start, sweep } => centre + Point::unit(start + sweep * t) * radius,
        }
    }

    /// The part between two fractions.
    fn part(&self, from: f64, to: f64) -> PlanCurve {
        match *self {
            PlanCurve::Line { .. } => PlanCurve::Line { begin: self.at(from), end: self.at(to) },
            PlanCurve::Arc { centre, radius, start, sweep } => {
                PlanCurve::Arc { centre, radius, start: start + sweep * from, sweep: sweep * (to - from) }
            }
        }
    }

    /// Smallest and largest coordinates.
    pub fn bounds(&self) -> (Point, Point) {
        let mut points = vec![self.begin(), self.end()];
        if let PlanCurve::Arc { centre, radius, start, sweep } = *self {
            let quarter = trig::FRAC_PI_2;
            let (from, to) = if sweep < 0.0 { (start + sweep, start) } else { (start, start + sweep) };
            let first = (from / quarter).ceil() as i64;
            let last = (to / quarter).floor() as i64;
            points.extend((first..=last).map(|k| centre + Point::unit(k as f64 * quarter) * radius));
        }
        crate::geometry::bounds(points.into_iter())
    }
}

/// The centre line moved to its left by `shift` (m, negative to the right). Arcs that the shift would turn inside
/// out are left out: the lines beside them then cross. Pieces without length are left out too.
pub fn side(track: &Track, shift: f64) -> Vec<PlanCurve> {
    track.pieces.iter().filter_map(|piece| shifted(piece, shift)).collect()
}

fn shifted(piece: &Piece, shift: f64) -> Option<PlanCurve> {
    if piece.length.abs() < 1e-9 {
        return None;
    }
    match piece.kind {
        PieceKind::Straight => {
            let across = Point::unit(piece.heading).left() * shift;
            Some(PlanCurve::Line { begin: piece.begin + across, end: piece.end + across })
        }
        PieceKind::Arc { centre, radius, turn } => {
            let side = turn.signum();
            let radius = radius - side * shift;
            let start = piece.heading - side * trig::FRAC_PI_2;
            (radius > 1e-9).then_some(PlanCurve::Arc { centre, radius, start, sweep: turn })
        }
    }
}

/// The stretch of the centre line from arc length `s` on (measured from vertex 0's outgoing tangent point), over
/// `length`, moved to the left by `shift`; all m.
pub fn stretch(track: &Track, s: f64, length: f64, shift: f64) -> Vec<PlanCurve> {
    let mut curves = Vec::new();
    let length = length.min(track.length);
    let s = s.rem_euclid(track.length);
    for (turn, piece) in [0.0, 1.0].iter().flat_map(|turn| track.pieces.iter().map(move |piece| (turn, piece))) {
        let begin = piece.s + turn * track.length;
        let (from, to) = ((s - begin).max(0.0), (s + length - begin).min(piece.length));
        if to - from > 1e-9
            && let Some(curve) = shifted(piece, shift)
        {
            curves.push(curve.part(from / piece.length, to / piece.length));
        }
    }
    curves
}

/// +1 when the loop as a whole turns left, else -1: what lies on the right of travel is then outside (+1).
pub fn winding(track: &Track) -> f64 {
    let total: f64 = track.fillets.iter().map(|f| f.turn).sum();
    if total < 0.0 { -1.0 } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::fixture;

    #[test]
    fn sides_of_a_rectangle_have_the_length_of_its_offset() {
        let track = Track::new(&fixture::rectangle(20.0, 10.0, 3.0).corners());
        for shift in [-0.6, 0.0, 0.6] {
            let length: f64 = side(&track, shift).iter().map(PlanCurve::length).sum();
            assert!((length - (36.0 + 2.0 * trig::PI * (3.0 - shift))).abs() < 1e-9, "{shift}: {length}");
        }
    }

    #[test]
    fn sides_are_connected_and_at_their_distance() {
        let corners = [
            (0.0, 0.0, 3.0),
            (30.0, 0.0, 4.0),
            (30.0, 9.0, 3.0),
            (18.0, 9.0, 2.0),
            (18.0, 20.0, 3.0),
            (0.0, 20.0, 5.0),
        ];
        let track = Track::new(&fixture::loop_through("ell", &corners).corners());
        for shift in [-0.6, 0.6] {
            let curves = side(&track, shift);
            for (i, curve) in curves.iter().enumerate() {
                assert!(curve.end().distance(curves[(i + 1) % curves.len()].begin()) < 1e-9);
                let (p, heading) = track.at(track.pieces[i].s + track.pieces[i].length / 2.0);
                assert!((p + Point::unit(heading).left() * shift).distance(curve.at(0.5)) < 1e-9);
            }
        }
    }

    #[test]
    fn a_stretch_runs_over_the_end_of_the_loop() {
        let track = Track::new(&fixture::rectangle(20.0, 10.0, 3.0).corners());
        let curves = stretch(&track, track.length - 1.0, 3.0, 0.0);
        assert!((curves.iter().map(PlanCurve::length).sum::<f64>() - 3.0).abs() < 1e-9);
        assert!(curves[0].begin().distance(track.at(track.length - 1.0).0) < 1e-9);
        assert!(curves[curves.len() - 1].end().distance(track.at(2.0).0) < 1e-9);
    }

    #[test]
    fn an_arc_bounds_its_extremes() {
        let arc = PlanCurve::Arc { centre: Point::new(1.0, 1.0), radius: 2.0, start: 0.0, sweep: -trig::PI };
        let (low, high) = arc.bounds();
        assert!(low.distance(Point::new(-1.0, -1.0)) < 1e-12 && high.distance(Point::new(3.0, 1.0)) < 1e-12);
    }
}
