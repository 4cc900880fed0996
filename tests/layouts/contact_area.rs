//! Track sides and contact areas against closed forms, polygon clipping and the definition by distance.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use lss::base::trig::{FRAC_PI_2, PI, TAU, acos, asin};
use lss::geometry::{Corner, Curve, Hand, Outline, Point, Polygon, Track, contact_area, outside_area, point_piece};
use proptest::prelude::*;

const HALF: f64 = 0.6;

fn track(corners: &[(f64, f64, f64)]) -> Track {
    let corner = |&(x, y, radius): &(f64, f64, f64)| Corner { point: Point::new(x, y), radius };
    Track::new(&corners.iter().map(corner).collect::<Vec<_>>())
}

/// A counter-clockwise 20 m × 10 m loop.
fn rectangle(radius: f64) -> Track {
    track(&[(0.0, 0.0, radius), (20.0, 0.0, radius), (20.0, 10.0, radius), (0.0, 10.0, radius)])
}

fn polygon(points: &[Point]) -> Polygon {
    Polygon::new(points.to_vec()).expect("simple")
}

fn square(x0: f64, y0: f64, x1: f64, y1: f64) -> Polygon {
    polygon(&[Point::new(x0, y0), Point::new(x1, y0), Point::new(x1, y1), Point::new(x0, y1)])
}

/// A rectangle with its axis through `centre` at 45°: from `near` to `far` along it, `half` to each side.
fn slanted(centre: Point, near: f64, far: f64, half: f64) -> Polygon {
    let (u, v) = (Point::unit(FRAC_PI_2 / 2.0), Point::unit(FRAC_PI_2 / 2.0).left());
    let at = |along: f64, across: f64| centre + u * along + v * across;
    polygon(&[at(near, -half), at(far, -half), at(far, half), at(near, half)])
}

/// Between a circle and a chord at distance `d` from its centre.
fn segment(r: f64, d: f64) -> f64 {
    r * r * acos(d / r) - d * (r * r - d * d).sqrt()
}

fn close(found: f64, expected: f64, tolerance: f64, what: &str) {
    assert!((found - expected).abs() <= tolerance, "{what}: found {found}, expected {expected}");
}

#[test]
fn contacts_have_their_closed_form_areas() {
    use Hand::{Left, Right};
    // The loop's lower right arc and upper right arc have centres (17, 3) and (17, 7).
    let corner = Point::new(17.0, 7.0);
    let (outer, inner) = (3.0 + HALF, 3.0 - HALF);
    let poke = |r: f64, d: f64, a: f64| 2.0 * a * d - (a * (r * r - a * a).sqrt() + r * r * asin(a / r));
    let diamond = |x: f64, y: f64, r: f64| {
        polygon(&[Point::new(x - r, y), Point::new(x, y - r), Point::new(x + r, y), Point::new(x, y + r)])
    };
    let on_arc = corner + Point::unit(0.3) * outer;
    let cases = [
        ("pokes into the lower straight", square(8.0, -3.0, 10.0, -0.35), Right, 2.0 * 0.25),
        ("pokes into a vertical straight", square(20.35, 4.0, 22.0, 5.5), Right, 1.5 * 0.25),
        ("straddles a vertical straight", square(-2.0, 4.0, 2.0, 5.0), Right, 2.6),
        ("straddles it, seen from the inside", square(-2.0, 4.0, 2.0, 5.0), Left, 2.6),
        ("edge on the straight", square(8.0, -3.0, 10.0, -0.6), Right, 0.0),
        ("edge on the straight, inside", square(8.0, 0.6, 10.0, 3.0), Left, 0.0),
        ("edge on the straight, wrong side", square(8.0, -0.6, 10.0, 3.0), Right, 7.2),
        ("longer edge on the straight", square(-5.0, -3.0, 25.0, -0.6), Right, 0.0),
        ("edge exactly the straight", square(3.0, -3.0, 17.0, -0.6), Right, 0.0),
        ("edge on the vertical straight", square(20.6, 2.0, 22.0, 8.0), Right, 0.0),
        ("vertex on the straight", diamond(10.0, -1.6, 1.0), Right, 0.0),
        ("vertex through the straight", diamond(10.0, -1.4, 1.0), Right, 0.04),
        ("vertex on the vertical straight", diamond(21.6, 5.0, 1.0), Right, 0.0),
        ("vertex through the vertical straight", diamond(21.4, 5.0, 1.0), Right, 0.04),
        ("vertex on the arc", diamond(on_arc.x + 1.0, on_arc.y, 1.0), Right, 0.0),
        ("side tangent to the arc", slanted(corner, outer, 6.0, 2.5), Right, 0.0),
        ("side through the arc", slanted(corner, 3.0, 6.0, 2.5), Right, segment(outer, 3.0)),
        ("side barely through the arc", slanted(corner, 3.599, 6.0, 2.5), Right, segment(outer, 3.599)),
        ("out of the inner arc", slanted(corner, -1.0, 2.5, 1.0), Left, poke(inner, 2.5, 1.0)),
        ("far inside", square(5.0, 3.0, 9.0, 6.0), Left, 0.0),
        ("far inside, wrong side", square(5.0, 3.0, 9.0, 6.0), Right, 12.0),
        ("far away", square(50.0, 30.0, 52.0, 31.0), Right, 0.0),
        ("far away, wrong side", square(50.0, 30.0, 52.0, 31.0), Left, 2.0),
        ("beside, outside the box of the loop", square(-9.0, 3.0, -8.0, 4.0), Right, 0.0),
        ("around everything", square(-5.0, -5.0, 25.0, 15.0), Right, 21.2 * 11.2 - (4.0 - PI) * outer * outer),
        ("the loop's own box", square(-0.6, -0.6, 20.6, 10.6), Right, 21.2 * 11.2 - (4.0 - PI) * outer * outer),
        ("the inner side's box", square(0.6, 0.6, 19.4, 9.4), Left, (4.0 - PI) * inner * inner),
    ];
    let loop_ = rectangle(3.0);
    for (what, polygon, lies, expected) in cases {
        close(contact_area(&loop_, HALF, lies, &polygon, lies), expected, 1e-9, what);
    }
}

#[test]
fn outlines_enclose_what_their_offsets_enclose() {
    let rounded = |w: f64, h: f64, r: f64| w * h - (4.0 - PI) * r * r;
    let cases = [
        ("outer", rectangle(3.0), HALF, Hand::Right, rounded(21.2, 11.2, 3.6)),
        ("inner", rectangle(3.0), HALF, Hand::Left, rounded(18.8, 8.8, 2.4)),
        ("inner, arc shrunk to a point", rectangle(HALF), HALF, Hand::Left, 18.8 * 8.8),
        ("inner, arc tighter than the offset", rectangle(0.2), HALF, Hand::Left, 18.8 * 8.8),
        ("inner, sharp corner", rectangle(0.0), HALF, Hand::Left, 18.8 * 8.8),
        ("outer, sharp corner", rectangle(0.0), HALF, Hand::Right, rounded(21.2, 11.2, HALF)),
        ("inner, wider than the loop", rectangle(3.0), 5.5, Hand::Left, 0.0),
        (
            "a circle narrower than its band",
            track(&[(0.0, 0.0, 0.5), (1.0, 0.0, 0.5), (1.0, 1.0, 0.5), (0.0, 1.0, 0.5)]),
            HALF,
            Hand::Left,
            0.0,
        ),
        (
            "a circle",
            track(&[(0.0, 0.0, 5.0), (10.0, 0.0, 5.0), (10.0, 10.0, 5.0), (0.0, 10.0, 5.0)]),
            HALF,
            Hand::Right,
            PI * 5.6 * 5.6,
        ),
    ];
    for (what, track, half, hand, expected) in cases {
        let outline = Outline::side(&track, half, hand);
        assert_eq!(outline.orientation(), 1, "{what}");
        close(outline.area(), expected, 1e-9, what);
        let building = square(-30.0, -30.0, 10.0, 30.0);
        let parts = outline.area_within(&building) + outside_area(&track, half, hand, &building);
        close(parts, expected, 1e-9, what);
    }
}

#[test]
fn a_building_holds_the_loop_or_measures_what_sticks_out() {
    let loop_ = rectangle(3.0);
    let outside = |building: &Polygon| outside_area(&loop_, HALF, Hand::Right, building);
    close(outside(&square(-1.0, -1.0, 21.0, 11.0)), 0.0, 0.0, "roomy");
    close(outside(&square(-0.6, -0.6, 20.6, 10.6)), 0.0, 1e-9, "tight");
    close(outside(&square(-0.6, -0.6, 20.0, 10.6)), 0.6 * 4.0 + 2.0 * quarter_cap(3.6, 3.0), 1e-9, "a wall through it");
}

/// Area of a quarter disc of radius `r` beyond `x = d`.
fn quarter_cap(r: f64, d: f64) -> f64 {
    segment(r, d) / 2.0
}

#[test]
fn contains_agrees_with_the_distance_to_the_centre_line() {
    let wavy =
        [(0.0, 0.0, 1.0), (12.0, 1.0, 0.3), (13.0, 9.0, 0.5), (7.0, 5.0, 0.4), (6.0, 10.0, 0.1), (1.0, 9.0, 2.0)];
    let mut reversed = wavy;
    reversed.reverse();
    for corners in [wavy, reversed] {
        let track = track(&corners);
        let ccw = Outline::side(&track, 0.0, Hand::Left);
        for (hand, half) in [(Hand::Left, 0.9), (Hand::Right, 0.9), (Hand::Left, HALF), (Hand::Right, HALF)] {
            let outline = Outline::side(&track, half, hand);
            let grows = (hand == Hand::Right) == (outline.orientation() > 0);
            for i in 0..160 {
                for j in 0..130 {
                    let p = Point::new(-1.503 + 0.1 * i as f64, -1.507 + 0.1 * j as f64);
                    let distance = track.pieces.iter().map(|q| point_piece(p, q).1).fold(f64::INFINITY, f64::min);
                    let near = distance < half;
                    let expected = if grows { ccw.contains(p) || near } else { ccw.contains(p) && !near };
                    assert_eq!(outline.contains(p), expected, "{p:?}, {hand:?}, half width {half}");
                }
            }
        }
    }
}

#[test]
fn a_side_is_one_closed_curve_of_tangent_lines_and_arcs() {
    let outline = Outline::side(&rectangle(3.0), HALF, Hand::Left);
    assert_eq!(outline.pieces.len(), 8);
    for (i, piece) in outline.pieces.iter().enumerate() {
        assert_eq!(piece.end(), outline.pieces[(i + 1) % 8].begin());
        if let Curve::Arc { begin, end, centre, radius, start, sweep } = *piece {
            close(radius, 2.4, 1e-12, "radius");
            close((centre + Point::unit(start) * radius).distance(begin), 0.0, 1e-12, "begin");
            close((centre + Point::unit(start + sweep) * radius).distance(end), 0.0, 1e-12, "end");
        }
    }
}

#[test]
fn nonsense_ends_in_a_number() {
    let nonsense = [
        track(&[(0.0, 0.0, 9.0), (1.0, 0.0, 9.0), (0.0, 1.0, 9.0)]),
        track(&[(0.0, 0.0, 1.0), (5.0, 0.0, 1.0), (0.0, 0.0, 1.0), (0.0, 7.0, 1.0)]),
        track(&[(0.0, 0.0, f64::NAN), (5.0, 0.0, 1e300), (0.0, 4.0, f64::INFINITY)]),
    ];
    for track in nonsense {
        for hand in [Hand::Left, Hand::Right] {
            let area = contact_area(&track, HALF, hand, &square(0.0, 0.0, 1.0, 1.0), hand);
            assert!(area >= 0.0, "{area}");
        }
    }
}

/// A side as chords, straight from the pieces' own `at`; for arcs wider than the offset.
fn chords(track: &Track, offset: f64) -> Vec<Point> {
    let mut points = Vec::new();
    for piece in &track.pieces {
        for i in 0..1500 {
            let (p, heading) = piece.at(piece.length * i as f64 / 1500.0);
            points.push(p + Point::unit(heading).left() * offset);
        }
    }
    points
}

fn shoelace(points: &[Point]) -> f64 {
    (0..points.len()).map(|i| points[i].cross(points[(i + 1) % points.len()])).sum::<f64>() / 2.0
}

/// Sutherland and Hodgman (1974): the part of any polygon within a convex counter-clockwise one.
fn clip(subject: &[Point], window: &[Point]) -> Vec<Point> {
    let mut points = subject.to_vec();
    for k in 0..window.len() {
        let (a, b) = (window[k], window[(k + 1) % window.len()]);
        let height = |p: Point| (b - a).cross(p - a);
        let mut kept = Vec::with_capacity(points.len());
        for i in 0..points.len() {
            let (p, q) = (points[i], points[(i + 1) % points.len()]);
            let (from, to) = (height(p), height(q));
            if from >= 0.0 {
                kept.push(p);
            }
            if from * to < 0.0 {
                kept.push(p.lerp(q, from / (from - to)));
            }
        }
        points = kept;
    }
    points
}

#[derive(Clone, Debug)]
struct Star {
    centre: Point,
    points: Vec<Point>,
}

impl Star {
    fn polygon(&self) -> Polygon {
        polygon(&self.points)
    }

    /// Area within a curve of chords, by triangles about the centre.
    fn overlap(&self, chords: &[Point]) -> f64 {
        let n = self.points.len();
        let triangle = |i: usize| [self.centre, self.points[i], self.points[(i + 1) % n]];
        (0..n).map(|i| shoelace(&clip(chords, &triangle(i))).abs()).sum()
    }
}

/// A loop about the origin, counter-clockwise, with right turns among the left ones.
fn loops() -> impl Strategy<Value = Track> {
    let corner = (0.6..1.0, -0.25..0.25, 0.9..2.5);
    (12.0..20.0, prop::collection::vec(corner, 4..9))
        .prop_map(|(size, corners): (f64, Vec<(f64, f64, f64)>)| {
            let step = TAU / corners.len() as f64;
            let corner = |(i, &(reach, shift, radius)): (usize, &(f64, f64, f64))| Corner {
                point: Point::unit((i as f64 + shift) * step) * (size * reach),
                radius,
            };
            Track::new(&corners.iter().enumerate().map(corner).collect::<Vec<_>>())
        })
        .prop_filter("fillets overlap", |track| track.pieces.iter().all(|p| p.length >= 0.0))
}

fn stars() -> impl Strategy<Value = Star> {
    let point = (0.5..6.0, -0.2..0.2);
    (-18.0..18.0, -18.0..18.0, prop::collection::vec(point, 3..8)).prop_map(|(x, y, points)| {
        let (centre, step) = (Point::new(x, y), TAU / points.len() as f64);
        let point = |(i, &(r, shift)): (usize, &(f64, f64))| centre + Point::unit((i as f64 + shift) * step) * r;
        Star { centre, points: points.iter().enumerate().map(point).collect() }
    })
}

fn hands() -> impl Strategy<Value = Hand> {
    prop_oneof![Just(Hand::Left), Just(Hand::Right)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn areas_agree_with_clipped_chords(track in loops(), star in stars(), hand in hands()) {
        let overlap = star.overlap(&chords(&track, hand.sign() * HALF));
        let polygon = star.polygon();
        let area = |lies| contact_area(&track, HALF, hand, &polygon, lies);
        prop_assert!((area(Hand::Right) - overlap).abs() < 1e-5, "{} {overlap}", area(Hand::Right));
        prop_assert!((area(Hand::Left) + area(Hand::Right) - polygon.area()).abs() < 1e-9);
        let outline = Outline::side(&track, HALF, hand);
        let whole = shoelace(&chords(&track, hand.sign() * HALF));
        prop_assert!((outline.area() - whole).abs() < 1e-4, "{} {whole}", outline.area());
        let outside = outside_area(&track, HALF, hand, &polygon);
        prop_assert!((outside + area(Hand::Right) - outline.area()).abs() < 1e-9);
    }
}

proptest! {
    #[test]
    fn a_wider_track_touches_more(
        track in loops(), star in stars(), hand in hands(), narrow in 0.0..2.0, more in 0.0..2.0,
    ) {
        let area = |half| contact_area(&track, half, hand, &star.polygon(), hand);
        prop_assert!(area(narrow) <= area(narrow + more) + 1e-9);
    }

    #[test]
    fn parts_add_up(track in loops(), star in stars(), hand in hands(), lies in hands(), half in 0.0..3.0) {
        let cut = 2.min(star.points.len() - 2).max(1);
        let part = |points: &[Point]| [&[star.centre], points].concat();
        let first = part(&star.points[..=cut]);
        let second = part(&[&star.points[cut..], &star.points[..1]].concat());
        prop_assume!(Polygon::new(first.clone()).is_ok() && Polygon::new(second.clone()).is_ok());
        let area = |polygon: &Polygon| contact_area(&track, half, hand, polygon, lies);
        let parts = area(&polygon(&first)) + area(&polygon(&second));
        prop_assert!((area(&star.polygon()) - parts).abs() < 1e-9);
    }

    #[test]
    fn motion_and_direction_do_not_matter(
        track in loops(), star in stars(), hand in hands(), lies in hands(), half in 0.0..3.0,
        angle in -PI..PI, x in -50.0..50.0, y in -50.0..50.0,
    ) {
        let area = contact_area(&track, half, hand, &star.polygon(), lies);
        let mut corners = track.corners.clone();
        corners.reverse();
        let reversed = contact_area(&Track::new(&corners), half, hand.opposite(), &star.polygon(), lies.opposite());
        prop_assert!((area - reversed).abs() < 1e-9, "{area} {reversed}");

        let (u, shift) = (Point::unit(angle), Point::new(x, y));
        let moved = |p: Point| u * p.x + u.left() * p.y + shift;
        let corners: Vec<Corner> =
            track.corners.iter().map(|c| Corner { point: moved(c.point), radius: c.radius }).collect();
        let points: Vec<Point> = star.points.iter().map(|&p| moved(p)).collect();
        let elsewhere = contact_area(&Track::new(&corners), half, hand, &polygon(&points), lies);
        prop_assert!((area - elsewhere).abs() < 1e-9, "{area} {elsewhere}");
    }
}
