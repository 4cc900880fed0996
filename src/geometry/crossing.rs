//! Where a loop crosses itself, and where its band overlaps itself.
//!
//! Two points of a track may be close because the track is continuous, or because it comes back. What tells them apart
//! is a theorem of Schur (1921): on a curve that nowhere bends tighter than radius R, points at arc length ℓ ≤ πR are
//! at least 2R sin(ℓ/2R) apart, as on a circle; up to half a turn of the tightest radius between them, a track gets
//! away from itself, and beyond it, whatever is closer than 2R has come back. So a pair of points counts here only
//! when, both ways round the loop, at least πR of track lies between them. R is taken to be at least half the band's
//! width: a tighter arc folds the band by itself, which is a matter of the radius and of no pair of pieces (and what
//! comes back within π/2 widths of such a fold is taken for a part of it). Neighbouring pieces never count; fillets
//! that overlap on their section are another fault.

use std::ops::Range;

use super::contact::{circle_circle, line_circle};
use super::{Curve, Piece, PieceKind, Point, Track};
use crate::base::trig;

/// Pieces closer than this touch, m.
const TOUCH: f64 = 1e-9;

/// Pairs (i, j), i < j, ascending, of pieces of the centre line that cross or touch although they are no neighbours
/// along the track.
pub fn self_crossings(track: &Track) -> Vec<(usize, usize)> {
    band_overlaps(track, TOUCH).into_iter().map(|(i, j, _)| (i, j)).collect()
}

/// Pairs (i, j), i < j, ascending, of pieces between which the centre line comes back to itself closer than `width`, m,
/// each with the distance, m: a band of that width overlaps itself there.
///
/// O(n log n) and the number of pairs whose bounding boxes come close along x.
pub fn band_overlaps(track: &Track, width: f64) -> Vec<(usize, usize, f64)> {
    let curves: Vec<Curve> = track.pieces.iter().map(Curve::from).collect();
    let boxes: Vec<(Point, Point)> = curves.iter().map(Curve::bounds).collect();
    let mut order: Vec<usize> = (0..curves.len()).collect();
    order.sort_by(|&i, &j| boxes[i].0.x.total_cmp(&boxes[j].0.x));

    let mut overlaps = Vec::new();
    for (place, &a) in order.iter().enumerate() {
        let (low, high) = boxes[a];
        for &b in order[place + 1..].iter().take_while(|&&b| boxes[b].0.x < high.x + width) {
            let apart = boxes[b].0.y >= high.y + width || boxes[b].1.y <= low.y - width;
            let (i, j) = (a.min(b), a.max(b));
            if apart || j - i == 1 || j - i == curves.len() - 1 {
                continue;
            }
            let distance = pairs(&curves[i], &curves[j])
                .into_iter()
                .filter(|pair| pair.distance < width && comes_back(track, &curves, (i, j), pair, width))
                .map(|pair| pair.distance)
                .fold(f64::INFINITY, f64::min);
            if distance < width {
                overlaps.push((i, j, distance));
            }
        }
    }
    overlaps.sort_by_key(|&(i, j, _)| (i, j));
    overlaps
}

/// Least distance between two pieces, m; 0 when they cross.
pub fn piece_distance(a: &Piece, b: &Piece) -> f64 {
    pairs(&a.into(), &b.into()).into_iter().map(|pair| pair.distance).fold(f64::INFINITY, f64::min)
}

/// The piece's point closest to `p`, and its distance, m.
pub fn point_piece(p: Point, piece: &Piece) -> (Point, f64) {
    let curve = Curve::from(piece);
    let candidates = [Some(curve.begin()), Some(curve.end()), curve.foot(p).map(|along| curve.at(along))];
    let closest = |best: (Point, f64), q: Point| if q.distance(p) < best.1 { (q, q.distance(p)) } else { best };
    candidates.into_iter().flatten().fold((curve.begin(), f64::INFINITY), closest)
}

/// Whether the track between a pair's points, both ways round, is long enough to have come back (see the module).
fn comes_back(track: &Track, curves: &[Curve], (i, j): (usize, usize), pair: &Pair, width: f64) -> bool {
    let length = |range: Range<usize>| curves[range].iter().map(Curve::length).sum::<f64>();
    let tightest = |range: Range<usize>| {
        let radii = track.pieces[range].iter().filter_map(|p| match p.kind {
            PieceKind::Arc { radius, turn, .. } if turn != 0.0 => Some(radius),
            _ => None,
        });
        radii.fold(f64::INFINITY, f64::min)
    };
    let half_turn = |radius: f64| trig::PI * radius.max(width / 2.0) * (1.0 - 1e-9);
    let n = curves.len();
    let forth = length(i..j) - pair.along.0 + pair.along.1;
    let back = length(j..n) - pair.along.1 + length(0..i) + pair.along.0;
    forth >= half_turn(tightest(i..j + 1)) && back >= half_turn(tightest(j..n).min(tightest(0..i + 1)))
}

/// A point on each of two curves.
struct Pair {
    /// Distance of the points along their curves, m.
    along: (f64, f64),
    /// Distance between the points, m; exactly 0 for a crossing.
    distance: f64,
}

/// All pairs of points at which the distance between two curves may have a local minimum: crossings, ends, feet of
/// ends, and the common normals of the curves' insides.
fn pairs(a: &Curve, b: &Curve) -> Vec<Pair> {
    let ends = |c: &Curve| [(0.0, c.begin()), (c.length(), c.end())];
    let mut pairs = Vec::with_capacity(12);
    for (s, p) in ends(a) {
        for (t, q) in ends(b) {
            pairs.push(Pair { along: (s, t), distance: p.distance(q) });
        }
    }
    for (s, p) in ends(a) {
        pairs.extend(b.foot(p).map(|t| Pair { along: (s, t), distance: p.distance(b.at(t)) }));
    }
    for (t, q) in ends(b) {
        pairs.extend(a.foot(q).map(|s| Pair { along: (s, t), distance: q.distance(a.at(s)) }));
    }
    for point in crossings(a, b) {
        if let (Some(s), Some(t)) = (a.foot(point), b.foot(point)) {
            pairs.push(Pair { along: (s, t), distance: 0.0 });
        }
    }
    for (on_a, on_b) in common_normals(a, b) {
        if let (Some(s), Some(t)) = (a.foot(on_a), b.foot(on_b)) {
            pairs.push(Pair { along: (s, t), distance: a.at(s).distance(b.at(t)) });
        }
    }
    pairs
}

/// Points that the whole lines and circles of two curves have in common.
fn crossings(a: &Curve, b: &Curve) -> Vec<Point> {
    let points = match (*a, *b) {
        (Curve::Segment { begin, end }, Curve::Segment { begin: from, end: to }) => {
            let (u, v) = (end - begin, to - from);
            let t = (from - begin).cross(v) / u.cross(v);
            return t.is_finite().then(|| begin + u * t).into_iter().collect();
        }
        (Curve::Segment { begin, end }, Curve::Arc { centre, radius, .. })
        | (Curve::Arc { centre, radius, .. }, Curve::Segment { begin, end }) => line_circle(begin, end, centre, radius),
        (Curve::Arc { centre, radius, .. }, Curve::Arc { centre: other, radius: r, .. }) => {
            circle_circle(centre, radius, other, r)
        }
    };
    points.into_iter().flatten().collect()
}

/// Pairs of points on the whole lines and circles of two curves whose connection is perpendicular to both, as far as
/// these are single; those of parallel lines and of concentric circles run through an end.
fn common_normals(a: &Curve, b: &Curve) -> Vec<(Point, Point)> {
    let on_line = |begin: Point, end: Point, centre: Point, radius: f64| {
        let d = end - begin;
        let foot = begin + d * ((centre - begin).dot(d) / d.dot(d));
        let out = unit(foot - centre) * radius;
        (foot, centre + out)
    };
    match (*a, *b) {
        (Curve::Segment { .. }, Curve::Segment { .. }) => Vec::new(),
        (Curve::Segment { begin, end }, Curve::Arc { centre, radius, .. }) => vec![on_line(begin, end, centre, radius)],
        (Curve::Arc { centre, radius, .. }, Curve::Segment { begin, end }) => {
            let (foot, point) = on_line(begin, end, centre, radius);
            vec![(point, foot)]
        }
        (Curve::Arc { centre, radius, .. }, Curve::Arc { centre: other, radius: r, .. }) => {
            let u = unit(other - centre);
            let sides = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
            sides.map(|(s, t)| (centre + u * (s * radius), other + u * (t * r))).to_vec()
        }
    }
}

/// The vector at length 1; not a number for the zero vector, which no foot then accepts.
fn unit(v: Point) -> Point {
    v * (1.0 / v.norm())
}
