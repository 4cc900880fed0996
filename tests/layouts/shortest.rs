//! Stage 3 against every choice of turns and radii of small random layouts, each solved by another route: straights
//! that close a loop and cost least are a basic solution of their two equations, so all pairs are tried.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use crate::small::{Asked, Random, SHORTEST, Small, choices, last, random, text};
use lss::geometry::{Corner, Point, Polygon, Track};
use lss::solve::Effort;

/// Of the width that the text has, m.
const HALF_WIDTH: f64 = 0.3;

/// The length of the shortest, without obstacles.
fn shortest(small: &Small, asked: &Asked) -> f64 {
    let n = small.turns.len();
    let free: Vec<usize> = (1..n).filter(|&i| !(asked.third && i == 2)).collect();
    let mut best = f64::INFINITY;
    choices(small, asked, &mut |choice| {
        for (j, &a) in free.iter().enumerate() {
            for &b in &free[j + 1..] {
                let mut choice = choice.clone();
                if choice.close(a, b) && choice.straights.iter().all(|&s| s >= SHORTEST - 1e-9) {
                    best = best.min(choice.length());
                }
            }
        }
    });
    best
}

#[test]
fn no_choice_of_turns_and_radii_is_shorter() {
    let mut seeds = Random(7);
    let (mut proven, count) = (0, 100);
    for case in 0..count {
        let n = 4 + case % 2;
        let small = random(&mut seeds, n);
        let asked = Asked { third: case % 3 == 0 && n == 5, ..Asked::default() };
        let best = shortest(&small, &asked);
        let Some(stage) = last(&small, &asked, Effort::default()) else { continue };
        let certificate = stage.certificate.expect("a certificate");
        assert!(certificate.lower_bound <= best + 1e-9, "{case}: {certificate:?} {best}\n{}", text(&small, &asked));
        // Out of nodes, the bound is still one.
        if let Some(hasty) = last(&small, &asked, Effort { nodes: 2, ..Effort::default() }) {
            assert!(hasty.certificate.expect("a certificate").lower_bound <= best + 1e-9);
        }
        // A track's own width may forbid what is shortest without it.
        assert!(stage.length >= best - 1e-5, "{case}: {} {best}", stage.length);
        if certificate.proven && (stage.length - best).abs() < 1e-6 {
            proven += 1;
        }
    }
    assert!(proven * 10 >= count * 9, "{proven} of {count}");
}

/// Points of the centre line, about `step` apart.
fn line(small: &Small, step: f64) -> Vec<Point> {
    let corners = small.points().into_iter().zip(&small.radii);
    let track = Track::new(&corners.map(|(point, &radius)| Corner { point, radius }).collect::<Vec<_>>());
    let count = (track.length / step).ceil() as usize;
    (0..count).map(|k| track.at(track.length * k as f64 / count as f64).0).collect()
}

/// The even-odd rule.
fn encloses(line: &[Point], p: Point) -> bool {
    let crosses =
        |(a, b): (&Point, &Point)| (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x);
    line.iter().zip(line.iter().cycle().skip(1)).filter(|&edge| crosses(edge)).count() % 2 == 1
}

/// Whether a layout keeps its distance from an obstacle and has it on the wanted side, by points of its centre line.
fn clear(small: &Small, obstacle: &[Point], inside: bool, distance: f64) -> bool {
    let line = line(small, 0.1);
    let polygon = Polygon::new(obstacle.to_vec()).expect("a rectangle");
    let near = line.iter().map(|&p| polygon.distance_to_outline(p)).fold(f64::INFINITY, f64::min);
    near >= distance && line.iter().all(|&p| !polygon.contains(p)) && encloses(&line, obstacle[0]) == inside
}

#[test]
fn no_sampled_layout_beside_an_obstacle_is_shorter() {
    let mut seeds = Random(11);
    let (mut proven, mut cases) = (0, 0);
    while cases < 24 {
        let small = random(&mut seeds, 4);
        let (centre, size) = {
            let points = small.points();
            let at = points[seeds.below(4)].lerp(points[seeds.below(4)], seeds.between(-0.2, 1.2));
            (at, Point::new(seeds.between(0.4, 2.0), seeds.between(0.4, 2.0)))
        };
        let corner = |x: f64, y: f64| Point::new(centre.x + x * size.x, centre.y + y * size.y);
        let obstacle = vec![corner(-0.5, -0.5), corner(0.5, -0.5), corner(0.5, 0.5), corner(-0.5, 0.5)];
        let inside = [true, false].into_iter().find(|&inside| clear(&small, &obstacle, inside, HALF_WIDTH + 0.05));
        let Some(inside) = inside else { continue };
        cases += 1;
        let asked = Asked { obstacles: vec![obstacle.clone()], ..Asked::default() };
        let Some(stage) = last(&small, &asked, Effort { nodes: 1_000, ..Effort::default() }) else { continue };
        let certificate = stage.certificate.expect("a certificate");
        proven += usize::from(certificate.proven);
        choices(&small, &asked, &mut |choice| {
            for k in 0..30 {
                let mut choice = choice.clone();
                choice.straights[1] = SHORTEST + 0.5 * f64::from(k);
                let closes = choice.close(2, 3) && choice.straights.iter().all(|&s| s >= SHORTEST);
                let length = choice.length();
                if closes && length < certificate.lower_bound - 1e-4 {
                    let found = clear(&choice, &obstacle, inside, HALF_WIDTH + 2e-3);
                    assert!(!found, "{certificate:?} {length} {choice:?}\n{}", text(&small, &asked));
                }
            }
        });
    }
    assert!(proven * 10 >= cases * 7, "{proven} of {cases}");
}
