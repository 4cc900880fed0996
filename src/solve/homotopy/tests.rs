//! The bound against closed forms, and against loops that were made at random.

use super::{Peg, taut, turning, word};
use crate::base::random::Random;
use crate::base::trig::{PI, TAU};
use crate::geometry::{Corner, PieceKind, Point, Track, distance_to_segment};
use std::f64::consts::SQRT_2;

fn pegs(points: &[(f64, f64)], distance: f64) -> Vec<Peg> {
    points.iter().map(|&(x, y)| Peg { at: Point::new(x, y), distance }).collect()
}

fn corners(points: &[(f64, f64)], radius: f64) -> Vec<Corner> {
    points.iter().map(|&(x, y)| Corner { point: Point::new(x, y), radius }).collect()
}

/// The bound of the class of a loop through corners.
fn bound(corners: &[Corner], pegs: &[Peg], radius: f64) -> Option<f64> {
    let line = super::line(&Track::new(corners), 1e-3);
    let points: Vec<Point> = pegs.iter().map(|p| p.at).collect();
    let taut = taut::pulled(&line, &points)?;
    assert_eq!(word::cyclic(&line, &points), word::cyclic(&taut.beside(), &points));
    Some(turning::longest_bound(&taut, pegs, radius))
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
    let lines = [&around[..], &dented].map(|line| super::line(&Track::new(&corners(line, 2.0)), 1e-3));
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
        let mut held = Vec::new();
        for piece in &track.pieces {
            if let PieceKind::Arc { centre, .. } = piece.kind {
                let middle = piece.at(0.5 * piece.length).0;
                let inwards = (centre - middle) * (1.0 / (centre - middle).norm());
                held.push(Peg {
                    at: middle + inwards * (DISTANCE + 0.05 + 2.0 * random.uniform()),
                    distance: DISTANCE,
                });
            }
        }
        let points: Vec<Point> = held.iter().map(|p| p.at).collect();
        let feasible = |at: &[Corner]| {
            let track = Track::new(at);
            let fits = track.pieces.iter().all(|p| p.kind != PieceKind::Straight || p.length >= 0.0);
            let line = super::line(&track, 1e-3);
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
