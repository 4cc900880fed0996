//! Layouts with a story, built in code for unit tests.

use super::fixture::{loop_through, span};
use super::*;

/// The reference instance of the thesis' layout problem (figures 3.3-3.6): ten vertices, building and four obstacles;
/// the same numbers as `examples/thesis10.lss`.
pub fn thesis10() -> Layout {
    let mut layout = loop_through(
        "thesis10",
        &[
            (16.0, 22.0, 5.0),
            (26.0, 7.0, 5.0),
            (60.0, 7.0, 5.0),
            (80.257, 16.0, 5.0),
            (97.64366487320324, 20.65874281184537, 5.0),
            (96.257, 37.0, 4.0),
            (69.0, 37.5, 4.0),
            (67.0, 55.0, 5.0),
            (40.0, 55.0, 5.0),
            (33.0, 36.0, 5.0),
        ],
    );
    let walls = [
        (0.0, 0.0),
        (68.0, 0.0),
        (68.0, 8.0),
        (112.0, 8.0),
        (112.0, 62.0),
        (86.0, 62.0),
        (86.0, 42.3),
        (69.9, 42.3),
        (69.9, 62.0),
        (0.0, 62.0),
        (0.0, 41.0),
        (28.0, 41.0),
        (28.0, 35.0),
        (0.0, 35.0),
    ];
    layout.building = Some(Building { polygon: polygon(&walls), clearance: 0.0, span: span() });
    layout.obstacles = vec![
        obstacle("O1", &[(25.2, 16.0), (30.5, 14.5), (31.5, 19.5), (26.5, 20.5)], Side::Left),
        obstacle("O2", &[(48.0, 24.0), (56.0, 24.0), (56.0, 34.0), (48.0, 34.0)], Side::Left),
        obstacle("O3", &[(102.0, 12.0), (108.0, 12.0), (108.0, 30.0), (105.0, 33.0), (102.0, 30.0)], Side::Right),
        obstacle("O4", &[(2.0, 2.0), (8.0, 2.0), (8.0, 8.0), (2.0, 8.0)], Side::Right),
    ];
    use FixKind::*;
    layout.constraints = vec![
        fix(1, &[Length, Rotation, Parallel, Perpendicular]),
        fix(7, &[Length, Rotation, Parallel, Perpendicular]),
        fix(3, &[Length, Rotation]),
    ];
    layout
}

/// A loop around a building's wing that stands in its mouth. Both strands shrink around it, and at the bottom they
/// would end up on each other.
pub fn horseshoe() -> Layout {
    let corners =
        [(0.0, 0.0), (40.0, 0.0), (40.0, 30.0), (28.0, 30.0), (28.0, 12.0), (12.0, 12.0), (12.0, 30.0), (0.0, 30.0)];
    let mut layout = loop_through("horseshoe", &corners.map(|(x, y)| (x, y, 3.0)));
    layout.obstacles = vec![obstacle("mouth", &[(14.0, 14.0), (26.0, 14.0), (26.0, 40.0), (14.0, 40.0)], Side::Right)];
    layout.constraints = [2, 3, 6, 7]
        .map(|vertex| Constraint { kind: ConstraintKind::FixVertex { vertex }, span: span(), reason: None })
        .to_vec();
    layout
}

fn polygon(points: &[(f64, f64)]) -> Polygon {
    Polygon::new(points.iter().map(|&(x, y)| Point::new(x, y)).collect()).expect("a simple polygon")
}

fn obstacle(name: &str, points: &[(f64, f64)], side: Side) -> Obstacle {
    Obstacle { name: name.into(), polygon: polygon(points), clearance: 0.0, side, pass: None, span: span() }
}

fn fix(from: usize, kinds: &[FixKind]) -> Constraint {
    let target = Target { from, straight: false };
    Constraint { kind: ConstraintKind::FixSection { target, kinds: kinds.to_vec() }, span: span(), reason: None }
}
