//! The bound against closed forms, and against loops that were made at random.

use super::{End, Held, Peg, Place, Range, Turn, word};
use crate::base::random::Random;
use crate::base::trig::{PI, TAU};
use crate::geometry::{Corner, Piece, PieceKind, Point, Track, distance_to_segment};
use std::f64::consts::SQRT_2;

fn pegs(points: &[(f64, f64)], distance: f64) -> Vec<Peg> {
    points.iter().map(|&(x, y)| Peg { at: Point::new(x, y), distance }).collect()
}

fn corners(points: &[(f64, f64)], radius: f64) -> Vec<Corner> {
    points.iter().map(|&(x, y)| Corner { point: Point::new(x, y), radius }).collect()
}

/// The bound of the class of a loop through corners.
fn bound(corners: &[Corner], pegs: &[Peg], radius: f64) -> Option<f64> {
    bound_with(corners, pegs, radius, &[])
}

/// The same of loops that have some sections.
fn bound_with(corners: &[Corner], pegs: &[Peg], radius: f64, sections: &[Held]) -> Option<f64> {
    let track = Track::new(corners);
    let (line, begins) = super::line(&track, 1e-3);
    super::bound(pegs, (&line, &begins), &track, (radius, sections))
}

#[test]
fn around_a_square_the_bound_is_the_shortest_loop_itself() {
    let (side, distance, radius) = (10.0, 0.6, 3.0);
    let held = pegs(&[(0.0, 0.0), (side, 0.0), (side, side), (0.0, side)], distance);
    let closed_form = 4.0 * side + 4.0 * (radius * PI / 2.0 - SQRT_2 * (radius - distance));
    // Each arc touches its corner in its middle.
    let out = radius - (radius - distance) / SQRT_2;
    let far = side + out;
    let shortest = corners(&[(-out, -out), (far, -out), (far, far), (-out, far)], radius);
    assert!((Track::new(&shortest).length - closed_form).abs() < 1e-9);
    for loose in [0.0, 1.0, 5.0] {
        let around = [(-out - loose, -out), (far, -out - loose), (far + 2.0 * loose, far), (-out, far + loose)];
        let found = bound(&corners(&around, radius), &held, radius).expect("held up");
        assert!((found - closed_form).abs() < 1e-6, "{found} for {closed_form}");
    }
}

#[test]
fn a_point_on_the_other_side_is_another_class() {
    let held = pegs(&[(0.0, 0.0), (20.0, 0.0), (20.0, 20.0), (0.0, 20.0), (10.0, 3.0)], 0.6);
    let around = [(-3.0, -3.0), (23.0, -3.0), (23.0, 23.0), (-3.0, 23.0)];
    let dented = [(-3.0, -3.0), (5.0, -3.0), (10.0, 8.0), (15.0, -3.0), (23.0, -3.0), (23.0, 23.0), (-3.0, 23.0)];
    let [short, long] = [&around[..], &dented].map(|line| bound(&corners(line, 2.0), &held, 2.0).expect("held up"));
    let points: Vec<Point> = held.iter().map(|p| p.at).collect();
    let lines = [&around[..], &dented].map(|line| super::line(&Track::new(&corners(line, 2.0)), 1e-3).0);
    let [a, b] = lines.map(|line| word::cyclic(&line, &points));
    assert_ne!(a, b);
    assert!(long > short + 0.5, "{long} beside {short}");
}

#[test]
fn nothing_is_said_where_nothing_holds_a_loop() {
    let around = corners(&[(0.0, 0.0), (20.0, 0.0), (20.0, 20.0), (0.0, 20.0)], 3.0);
    assert_eq!(bound(&around, &pegs(&[(30.0, 5.0), (-8.0, 9.0)], 0.6), 3.0), None);
    assert_eq!(bound(&around, &pegs(&[(10.0, 10.0)], 0.6), 3.0), None);
}

/// How far a line of chords stays from a point at least, m.
fn clear(line: &[Point], peg: &Peg) -> f64 {
    let ends = line.iter().zip(line.iter().cycle().skip(1));
    ends.map(|(a, b)| distance_to_segment(peg.at, *a, *b)).fold(f64::INFINITY, f64::min)
}

/// A point on the inner side of each curve, a little farther off than it must be.
fn within_curves(track: &Track, distance: f64, random: &mut Random) -> Vec<Peg> {
    let point = |piece: &Piece| {
        let PieceKind::Arc { centre, .. } = piece.kind else { return None };
        let middle = piece.at(0.5 * piece.length).0;
        let inwards = (centre - middle) * (1.0 / (centre - middle).norm());
        Some(Peg { at: middle + inwards * (distance + 0.05 + 2.0 * random.uniform()), distance })
    };
    track.pieces.iter().filter_map(point).collect()
}

/// Loops with dents around points beside their corners, shortened at random as far as they go: none gets below the
/// bound of its class, which is near them.
#[test]
fn no_loop_of_a_class_is_shorter_than_its_bound() {
    const RADIUS: f64 = 2.0;
    const DISTANCE: f64 = 0.7;
    let mut left = Vec::new();
    for seed in 1..=12 {
        let mut random = Random::new(seed);
        let count = 5 + 2 * (seed as usize % 4);
        let mut at: Vec<Corner> = (0..count)
            .map(|k| {
                let far = if k % 2 == 1 { 14.0 } else { 30.0 } + 6.0 * random.uniform();
                let point = Point::unit(TAU * (k as f64 + 0.3 * random.uniform()) / count as f64) * far;
                Corner { point, radius: RADIUS + random.uniform() }
            })
            .collect();
        let track = Track::new(&at);
        let held = within_curves(&track, DISTANCE, &mut random);
        let points: Vec<Point> = held.iter().map(|p| p.at).collect();
        let feasible = |at: &[Corner]| {
            let track = Track::new(at);
            let fits = track.pieces.iter().all(|p| p.kind != PieceKind::Straight || p.length >= 0.0);
            let line = super::line(&track, 1e-3).0;
            (fits && held.iter().all(|peg| clear(&line, peg) >= DISTANCE + 1e-3)).then_some((track.length, line))
        };
        let Some((mut length, first)) = feasible(&at) else { continue };
        let least = bound(&at, &held, RADIUS).expect("held up");
        for step in 0..4000 {
            let size = 0.5 * (1.0 - f64::from(step) / 4000.0) + 1e-3;
            let mut moved = at.clone();
            let k = (random.uniform() * count as f64) as usize % count;
            moved[k].point = moved[k].point + Point::new(random.normal(), random.normal()) * size;
            moved[k].radius = (moved[k].radius + size * random.normal()).max(RADIUS);
            if let Some((shorter, line)) = feasible(&moved)
                && shorter < length
                && word::cyclic(&line, &points) == word::cyclic(&first, &points)
            {
                assert!(shorter >= least, "seed {seed}: {shorter} m, below {least} m");
                (at, length) = (moved, shorter);
            }
        }
        left.push((length - least) / length);
    }
    assert!(left.len() >= 8, "only {} loops", left.len());
    let mean = left.iter().sum::<f64>() / left.len() as f64;
    assert!(mean < 0.01, "{mean} of the length is left: {left:?}");
}

/// A way of a loop at a vertex as it is.
fn as_it_is(track: &Track, vertex: usize, beyond: usize, straight: f64) -> End {
    let fillet = &track.fillets[vertex];
    let straight = straight.min(track.straight(beyond).length);
    let turns = vec![Turn::new(fillet.radius, fillet.turn.abs(), straight)];
    End { vertex: track.corners[vertex].point, sign: fillet.turn.signum(), turns }
}

#[test]
fn from_a_section_around_a_point_the_bound_is_the_loop_itself() {
    // Straight from a known section's quarter circles to a half circle around the point, and back.
    let (tight, wide) = (2.0, 5.0);
    let held = pegs(&[(20.0, 5.0)], wide);
    let mut around = corners(&[(0.0, 10.0), (0.0, 0.0), (25.0, 0.0), (25.0, 10.0)], wide);
    (around[0].radius, around[1].radius) = (tight, tight);
    let track = Track::new(&around);
    let closed_form = (10.0 - 2.0 * tight) + tight * PI + 2.0 * (20.0 - tight) + wide * PI;
    assert!((track.length - closed_form).abs() < 1e-9);
    assert_eq!(bound(&around, &held, wide), None, "a point alone holds nothing");
    for straight in [0.0, 7.0] {
        let ends = [as_it_is(&track, 0, 3, straight), as_it_is(&track, 1, 1, straight)];
        let sections = [Held { section: 0, heading: -0.5 * PI, place: Place::Known(ends) }];
        let found = bound_with(&around, &held, wide, &sections).expect("held up");
        assert!((found - closed_form).abs() < 1e-6, "{found} for {closed_form}");
    }
}

/// Loops with a section of known heading, at known vertices or anywhere in a rectangle, made and moved at random: none is
/// below the bound of its class.
#[test]
fn no_loop_with_a_section_is_shorter_than_its_bound() {
    const RADIUS: f64 = 2.0;
    const DISTANCE: f64 = 0.7;
    let (mut left, mut moved_on) = ([Vec::new(), Vec::new()], 0);
    for seed in 1..=30 {
        let mut random = Random::new(seed);
        let is_known = seed % 2 == 0;
        let count = 6 + seed as usize % 5;
        let mut at: Vec<Corner> = (0..count)
            .map(|k| {
                let far = if k % 2 == 1 && k > 1 { 16.0 } else { 30.0 } + 6.0 * random.uniform();
                let point = Point::unit(TAU * (k as f64 + 0.3 * random.uniform()) / count as f64) * far;
                Corner { point, radius: RADIUS + 2.0 * random.uniform() }
            })
            .collect();
        let section = (at[1].point - at[0].point) * (1.0 / at[1].point.distance(at[0].point));
        let heading = section.heading();
        let track = Track::new(&at);
        let held = within_curves(&track, DISTANCE, &mut random);
        let points: Vec<Point> = held.iter().map(|p| p.at).collect();
        // The rectangle begins where the section is, or further in, away from all points.
        let across = section.left().dot(at[0].point);
        let nearest = points.iter().map(|p| section.left().dot(*p) - across).fold(f64::INFINITY, f64::min);
        let deep = nearest.clamp(0.0, 4.0) * random.uniform();
        let begin = section.dot(at[0].point);
        let along = (begin - 5.0, begin + at[0].point.distance(at[1].point) + 5.0);
        let across = (across - 1.0, across + 0.9 * deep);
        let range = Range { begin: along, end: along, across, shortest: 1.0 };
        let sections = |track: &Track| {
            let place = match is_known {
                true => Place::Known([as_it_is(track, 0, count - 1, 3.0), as_it_is(track, 1, 1, 3.0)]),
                false => Place::Within(range),
            };
            vec![Held { section: 0, heading, place }]
        };
        let feasible = |at: &[Corner]| {
            let track = Track::new(at);
            let fits = track.pieces.iter().all(|p| p.kind != PieceKind::Straight || p.length >= 0.0);
            let begins = super::line(&track, 1e-3);
            let clear = held.iter().all(|peg| clear(&begins.0, peg) >= DISTANCE + 1e-3);
            let straight = track.straight(0);
            let within = |value: f64, (low, high): (f64, f64)| low <= value && value <= high;
            let ends = [straight.begin, straight.end];
            let along = ends.iter().all(|end| within(section.dot(*end), along));
            let across = within(section.left().dot(straight.begin), range.across);
            let inside = is_known || (along && across && straight.length >= range.shortest);
            (fits && clear && inside).then_some((track, begins))
        };
        let words = |(line, begins): &(Vec<Point>, Vec<usize>)| word::parts(line, &begins[..2], &points);
        let Some((track, first)) = feasible(&at) else { continue };
        let Some(mut least) = bound_with(&at, &held, RADIUS, &sections(&track)) else { continue };
        if !least.is_finite() {
            continue;
        }
        let mut length = track.length;
        assert!(length >= least, "seed {seed}: {length} m, below {least} m");
        for step in 0..3000 {
            let size = 0.5 * (1.0 - f64::from(step) / 3000.0) + 1e-3;
            let mut moved = at.clone();
            let k = (random.uniform() * count as f64) as usize % count;
            let by = Point::new(random.normal(), random.normal()) * size;
            match k {
                0 | 1 if is_known => {}
                // Both of them across, each along.
                0 | 1 => {
                    let (along, across) = (section * section.dot(by), section.left() * section.left().dot(by));
                    moved[k].point = moved[k].point + along;
                    (0..2).for_each(|i| moved[i].point = moved[i].point + across);
                }
                _ => moved[k].point = moved[k].point + by,
            }
            moved[k].radius = (moved[k].radius + size * random.normal()).max(RADIUS);
            let Some((track, _)) = feasible(&moved).filter(|(_, line)| words(line) == words(&first)) else {
                continue;
            };
            // A loop with other turns at known vertices has a bound of its own.
            if track.length < length {
                if is_known {
                    least = bound_with(&moved, &held, RADIUS, &sections(&track)).unwrap_or(0.0);
                }
                assert!(track.length >= least, "seed {seed}: {} m, below {least} m", track.length);
                (at, length) = (moved, track.length);
                moved_on += 1;
            }
        }
        left[usize::from(is_known)].push((length - least) / length);
    }
    assert!(moved_on > 1000, "only {moved_on} moves");
    assert!(left.iter().all(|left| left.len() >= 10), "loops that were bounded: {left:?}");
    let mean = left[1].iter().sum::<f64>() / left[1].len() as f64;
    assert!(mean < 0.01, "at known vertices {mean} of the length is left: {left:?}");
}

/// A loop around a rectangle whose section is farther out than the corners: it is not much longer than its bound.
#[test]
fn a_section_farther_out_than_the_corners_holds_a_loop_up() {
    let (radius, distance) = (2.0, 1.0);
    let held = pegs(&[(0.0, 0.0), (20.0, 0.0), (20.0, 12.0), (0.0, 12.0)], distance);
    let around =
        [(-6.0, 9.0), (-6.0, 3.0), (0.0, -2.0), (20.0, -2.0), (22.0, 0.0), (22.0, 12.0), (20.0, 14.0), (0.0, 14.0)];
    let mut at = corners(&around, radius);
    // Its left is the east.
    let range = Range { begin: (-16.0, 4.0), end: (-16.0, 4.0), across: (-9.0, -6.0), shortest: 1.0 };
    let sections = [Held { section: 0, heading: -0.5 * PI, place: Place::Within(range) }];
    let free = bound(&at, &held, radius).expect("held up");
    let least = bound_with(&at, &held, radius, &sections).expect("held up");
    let feasible = |at: &[Corner]| {
        let track = Track::new(at);
        let fits = track.pieces.iter().all(|p| p.kind != PieceKind::Straight || p.length >= 0.0);
        let line = super::line(&track, 1e-3).0;
        let clear = held.iter().all(|peg| clear(&line, peg) >= distance + 1e-3);
        (fits && clear && track.straight(0).length >= range.shortest).then_some(track.length)
    };
    let mut random = Random::new(1);
    let mut length = feasible(&at).expect("a loop");
    for step in 0..40_000 {
        let size = 0.3 * (1.0 - f64::from(step) / 40_000.0) + 1e-4;
        let mut moved = at.clone();
        let k = (random.uniform() * at.len() as f64) as usize % at.len();
        let by = Point::new(random.normal(), random.normal()) * size;
        moved[k].point = moved[k].point + if k < 2 { Point::new(0.0, by.y) } else { by };
        if let Some(shorter) = feasible(&moved).filter(|shorter| *shorter < length) {
            assert!(shorter >= least, "{shorter} m, below {least} m");
            (at, length) = (moved, shorter);
        }
    }
    assert!(least > free + 1.0, "{least} m with the section, {free} m without");
    assert!(length - least < 0.01 * length, "{length} m, no less than {least} m: {at:?}");
}
