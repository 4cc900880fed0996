//! Distances between pieces, loops that cross themselves, and bands that overlap themselves.

use lss::base::trig::{PI, TAU, cos, sin};
use lss::geometry::{
    Corner, Piece, PieceKind, Point, Track, band_overlaps, piece_distance, point_piece, self_crossings,
};
use proptest::prelude::*;

fn track(corners: &[(f64, f64, f64)]) -> Track {
    let corner = |&(x, y, radius): &(f64, f64, f64)| Corner { point: Point::new(x, y), radius };
    Track::new(&corners.iter().map(corner).collect::<Vec<_>>())
}

fn straight(x0: f64, y0: f64, x1: f64, y1: f64) -> Piece {
    let (begin, end) = (Point::new(x0, y0), Point::new(x1, y1));
    let (heading, length) = ((end - begin).heading(), begin.distance(end));
    Piece { kind: PieceKind::Straight, vertex: 0, begin, end, heading, s: 0.0, length }
}

/// From the angle `start` about (x, y), both in degrees.
fn arc(x: f64, y: f64, radius: f64, start: f64, turn: f64) -> Piece {
    let (centre, start, turn) = (Point::new(x, y), start * PI / 180.0, turn * PI / 180.0);
    let [begin, end] = [start, start + turn].map(|angle| centre + Point::unit(angle) * radius);
    let heading = start + turn.signum() * PI / 2.0;
    let kind = PieceKind::Arc { centre, radius, turn };
    Piece { kind, vertex: 0, begin, end, heading, s: 0.0, length: radius * turn.abs() }
}

#[test]
fn pieces_are_as_far_apart_as_drawn() {
    let base = straight(0.0, 0.0, 10.0, 0.0);
    let root = 2f64.sqrt();
    let cases = [
        ("crossing", base, straight(4.0, -1.0, 5.0, 2.0), 0.0),
        ("touching with an end", base, straight(4.0, 0.0, 5.0, 2.0), 0.0),
        ("parallel", base, straight(8.0, 2.0, 15.0, 2.0), 2.0),
        ("parallel, apart", base, straight(13.0, 4.0, 15.0, 4.0), 5.0),
        ("collinear, apart", base, straight(12.0, 0.0, 15.0, 0.0), 2.0),
        ("collinear, common part", base, straight(8.0, 0.0, 15.0, 0.0), 0.0),
        ("end over inside", base, straight(5.0, 1.0, 6.0, 9.0), 1.0),
        ("no length", base, straight(13.0, 4.0, 13.0, 4.0), 5.0),
        ("bulge over the line", base, arc(5.0, 4.0, 3.0, 180.0, 180.0), 1.0),
        ("bulge, driven backwards", base, arc(5.0, 4.0, 3.0, 0.0, -180.0), 1.0),
        ("bulge away from the line", base, arc(5.0, 4.0, 3.0, 0.0, 180.0), 4.0),
        ("bulge beside the end", base, arc(13.0, 4.0, 2.0, 180.0, 90.0), 3.0),
        ("bulge through the line", base, arc(5.0, 2.0, 3.0, 180.0, 180.0), 0.0),
        ("bulge tangent to the line", base, arc(5.0, 3.0, 3.0, 180.0, 180.0), 0.0),
        ("line within the bulge", straight(-1.0, 0.0, 1.0, 0.0), arc(0.0, 0.0, 3.0, 0.0, 179.0), 2.0),
        ("circles apart", arc(0.0, 0.0, 1.0, -90.0, 179.0), arc(5.0, 0.0, 2.0, 90.0, 179.0), 2.0),
        ("circles apart, backs", arc(0.0, 0.0, 1.0, 90.0, 179.0), arc(5.0, 0.0, 2.0, -90.0, 179.0), 26f64.sqrt()),
        ("circles within", arc(0.0, 0.0, 5.0, -90.0, 179.0), arc(1.0, 0.0, 2.0, -90.0, 179.0), 2.0),
        ("circles across", arc(0.0, 0.0, 2.0, 0.0, 179.0), arc(2.0, 0.0, 2.0, 1.0, 178.0), 0.0),
        ("concentric", arc(0.0, 0.0, 2.0, 0.0, 90.0), arc(0.0, 0.0, 3.0, 60.0, 90.0), 1.0),
        ("concentric, beside", arc(0.0, 0.0, 2.0, 0.0, 45.0), arc(0.0, 0.0, 2.0, 135.0, 45.0), 2.0 * root),
    ];
    for (what, a, b, expected) in cases {
        for distance in [piece_distance(&a, &b), piece_distance(&b, &a)] {
            let off = (distance - expected).abs();
            // "backs": the closest ends are only nearly at (0, 1) and (5, 2).
            let tolerance = if what == "circles apart, backs" { 0.1 } else { 1e-12 };
            assert!(off <= tolerance, "{what}: found {distance}, expected {expected}");
        }
    }
}

#[test]
fn loops_that_cross_are_found() {
    let simple = track(&[(0.0, 0.0, 3.0), (20.0, 0.0, 3.0), (20.0, 10.0, 3.0), (0.0, 10.0, 3.0)]);
    let eight = track(&[(0.0, 0.0, 1.0), (20.0, 10.0, 1.0), (20.0, 0.0, 1.0), (0.0, 10.0, 1.0)]);
    // A finger from above whose tip (an arc pair with no straight between) just reaches the lower straight.
    let finger = |tip: f64| {
        track(&[
            (0.0, 0.0, 2.0),
            (20.0, 0.0, 2.0),
            (20.0, 10.0, 2.0),
            (12.0, 10.0, 1.0),
            (12.0, tip, 2.0),
            (8.0, tip, 2.0),
            (8.0, 10.0, 1.0),
            (0.0, 10.0, 2.0),
        ])
    };
    // Pieces: 2 i is the straight after vertex i, 2 i + 1 the arc of vertex i + 1.
    let cases = [
        ("simple", &simple, vec![]),
        ("eight", &eight, vec![(0, 4)]),
        ("finger short of it", &finger(0.1), vec![]),
        ("finger on it", &finger(0.0), vec![(0, 7), (0, 8), (0, 9)]),
        ("finger through it", &finger(-1.0), vec![(0, 7), (0, 9)]),
        ("finger far through it", &finger(-5.0), vec![(0, 6), (0, 10)]),
    ];
    for (what, track, expected) in cases {
        assert_eq!(self_crossings(track), expected, "{what}");
    }
    let overlaps = band_overlaps(&finger(0.5), 1.2);
    let found: Vec<_> = overlaps.iter().map(|&(i, j, _)| (i, j)).collect();
    assert_eq!(found, [(0, 7), (0, 8), (0, 9)]);
    assert!(overlaps.iter().all(|&(_, _, distance)| (distance - 0.5).abs() < 1e-12), "{overlaps:?}");
    assert_eq!(band_overlaps(&finger(1.2 + 1e-9), 1.2), []);
}

#[test]
fn only_a_track_that_comes_back_overlaps_itself() {
    // A hairpin whose straights are 2 R apart, with no straight between its two arcs.
    let hairpin = |radius: f64| {
        let y = 2.0 * radius;
        let tip = [(0.0, 0.0, 2.0), (20.0, 0.0, radius), (20.0, y, radius)];
        track(&[&tip[..], &[(10.0, y, 2.0), (10.0, 9.0, 2.0), (0.0, 9.0, 2.0)]].concat())
    };
    assert_eq!(band_overlaps(&hairpin(0.601), 1.2), []);
    let found = band_overlaps(&hairpin(0.5), 1.2);
    assert!(found.iter().any(|&(i, j, d)| (i, j) == (0, 4) && (d - 1.0).abs() < 1e-12), "{found:?}");

    // Small bends one after the other, shorter than the band is wide, are no overlap.
    let n = 144;
    let corner = |i: usize| (6.0 * cos(TAU * i as f64 / n as f64), 6.0 * sin(TAU * i as f64 / n as f64), 3.0);
    assert_eq!(band_overlaps(&track(&(0..n).map(corner).collect::<Vec<_>>()), 1.2), []);
    // Nor are sharp corners, or vertices on a straight.
    assert_eq!(band_overlaps(&track(&[(0.0, 0.0, 0.0), (9.0, 0.0, 0.0), (9.0, 9.0, 0.0), (0.0, 9.0, 0.0)]), 1.2), []);
    let flat = [(0.0, 0.0, 1.0), (4.0, 0.0, 1.0), (4.5, 0.0, 1.0), (5.0, 0.0, 1.0), (9.0, 0.0, 1.0), (4.0, 9.0, 1.0)];
    assert_eq!(band_overlaps(&track(&flat), 1.2), []);

    // A spiral arm that closes on its beginning: two arcs of one almost full circle, with a short straight between.
    let (near, reach) = (0.3, 40.0);
    let ring = track(&[
        (0.0, -near, 3.0),
        (6.0, -near, 3.0),
        (6.0, 6.0, 3.0),
        (0.0, 6.0, 3.0),
        (0.0, near, 0.1),
        (-reach, near, 1.0),
        (-reach, -near - 2.0, 1.0),
        (-2.0, -near - 2.0, 0.5),
    ]);
    assert!(!band_overlaps(&ring, 1.2).is_empty());
    assert_eq!(self_crossings(&ring), []);
}

/// The least distance between samples along two pieces, and how far it may be off.
fn sampled(a: &Piece, b: &Piece) -> (f64, f64) {
    let n = 300;
    let points = |p: &Piece| (0..=n).map(|i| p.at(p.length * i as f64 / n as f64).0).collect::<Vec<_>>();
    let (a_points, b_points) = (points(a), points(b));
    let distances = a_points.iter().flat_map(|p| b_points.iter().map(|q| p.distance(*q)));
    (distances.fold(f64::INFINITY, f64::min), (a.length + b.length) / n as f64 / 2.0)
}

fn pieces() -> impl Strategy<Value = Piece> {
    let (x, y) = (-5.0..5.0, -5.0..5.0);
    prop_oneof![
        (x.clone(), y.clone(), -5.0..5.0, -5.0..5.0).prop_map(|(a, b, c, d)| straight(a, b, c, d)),
        (x, y, 0.5..6.0, -180.0..180.0, prop_oneof![-179.0..-1.0, 1.0..179.0])
            .prop_map(|(x, y, r, start, turn)| arc(x, y, r, start, turn)),
    ]
}

proptest! {
    #[test]
    fn distances_agree_with_samples(a in pieces(), b in pieces(), x in -8.0..8.0, y in -8.0..8.0) {
        let (found, (sampled_distance, slack)) = (piece_distance(&a, &b), sampled(&a, &b));
        prop_assert!(found <= sampled_distance + 1e-12 && found >= sampled_distance - slack - 1e-12);
        prop_assert_eq!(found, piece_distance(&b, &a));
        let p = Point::new(x, y);
        let (closest, distance) = point_piece(p, &a);
        let spot = straight(x, y, x, y);
        prop_assert!((piece_distance(&spot, &a) - distance).abs() < 1e-12);
        prop_assert!((closest.distance(p) - distance).abs() < 1e-12);
    }

    #[test]
    fn the_sweep_finds_what_all_pairs_find(
        corners in prop::collection::vec((-20.0..20.0, -20.0..20.0, 0.3..1.0), 4..12),
    ) {
        let track = track(&corners);
        prop_assume!(track.pieces.iter().all(|p| p.length > 0.0));
        let n = track.pieces.len();
        let far = |i: usize, j: usize| j - i > 1 && (i, j) != (0, n - 1);
        let all: Vec<(usize, usize)> = (0..n)
            .flat_map(|i| (i + 1..n).map(move |j| (i, j)))
            .filter(|&(i, j)| far(i, j) && piece_distance(&track.pieces[i], &track.pieces[j]) == 0.0)
            .collect();
        prop_assert_eq!(self_crossings(&track), all);
    }
}
