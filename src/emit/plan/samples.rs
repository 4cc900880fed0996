//! Layouts that the drawings are tested on.

use crate::base::trig;
use crate::compiled::Compiled;
use crate::compiled::fixture::{compile, on};
use crate::geometry::{Corner, Point, Polygon, Track};
use crate::model::{
    Building, Chutes, Constraint, ConstraintKind, Declared, EquipmentKind, EquipmentSide, EquipmentType, FixKind,
    Induction, Layout, Level, Motors, Obstacle, PlaceRow, Rate, Side, Stands, Target, VerticalStock, fixture,
};
use crate::solve::{Stage, Status, Violation};
use crate::source::Spanned;

pub fn polygon(points: &[(f64, f64)]) -> Polygon {
    Polygon::new(points.iter().map(|&(x, y)| Point::new(x, y)).collect()).expect("simple")
}

fn obstacle(name: &str, clearance: f64, points: &[(f64, f64)]) -> Obstacle {
    let polygon = polygon(points);
    Obstacle { name: name.to_owned(), polygon, clearance, side: Side::Left, pass: None, span: fixture::span() }
}

fn building(clearance: f64, points: &[(f64, f64)]) -> Option<Building> {
    Some(Building { polygon: polygon(points), clearance, span: fixture::span() })
}

fn fix(kind: ConstraintKind) -> Constraint {
    Constraint { kind, span: fixture::span(), reason: None }
}

fn fix_section(from: usize, kinds: &[FixKind]) -> Constraint {
    fix(ConstraintKind::FixSection { target: Target { from, straight: false }, kinds: kinds.to_vec() })
}

/// A rectangle of 20 m by 10 m with what every layout has.
pub fn rectangle() -> Compiled {
    compile(fixture::rectangle(20.0, 10.0, 3.0))
}

/// A rectangle of 40 m by 20 m with equipment of declared kinds: an induction and its conveyor from the south, a scanner,
/// twelve chutes about a column, and a gate inside of the loop.
pub fn equipped() -> Compiled {
    let mut layout = fixture::rectangle(40.0, 20.0, 4.0);
    layout.building = building(0.0, &[(-8.0, -8.0), (48.0, -8.0), (48.0, 28.0), (-8.0, 28.0)]);
    let column = obstacle("column", 0.2, &[(20.0, -3.0), (21.0, -3.0), (21.0, -2.0), (20.0, -2.0)]);
    layout.obstacles = vec![Obstacle { side: Side::Right, ..column }];
    let of = |kind, stretch, depth, side| fixture::equipment_type(kind, stretch, depth, side);
    let induction = of(EquipmentKind::Induction, 3.0, 4.0, EquipmentSide::Outer);
    let induction = EquipmentType { conveyor: 100.0, ..induction };
    let after = |name: &str, declared: Declared| {
        let (count, on) = (declared.count(), vec![0]);
        Declared { stands: Stands::Free { count, on, after: vec![name.to_owned()], before: Vec::new() }, ..declared }
    };
    let fed = Some(Point::new(7.5, -7.6));
    layout.equipment.declared = vec![
        Declared { fed, ..fixture::anywhere("west", induction, 1) },
        after("west", fixture::anywhere("scan", of(EquipmentKind::Scanner, 1.0, 0.5, EquipmentSide::Both), 1)),
        after("scan", fixture::anywhere("row_a", of(EquipmentKind::Chute, 1.5, 2.0, EquipmentSide::Outer), 12)),
        fixture::anywhere("crossing", of(EquipmentKind::Gate, 1.2, 1.0, EquipmentSide::Inner), 1),
    ];
    compile(layout)
}

/// A rectangle that climbs on one long straight and comes down on a short one.
pub fn raised() -> Compiled {
    let mut layout = fixture::rectangle(40.0, 30.0, 4.0);
    let rate = Rate { per_piece: 180.0, per_metre: 380.0 };
    layout.catalog.vertical = Some(VerticalStock {
        article: "VC".into(),
        radii: vec![6.0, 10.0],
        angle_step: 0.0,
        steepest: 0.2,
        price: rate,
        mass: rate,
    });
    let level = |from, to, height| Level { from, to, height, span: fixture::span() };
    layout.levels = vec![level(1, 2, 2.2), level(3, 0, 1.0)];
    compile(layout)
}

/// Ten vertices, left and right turns, oblique sections, obstacles and a building with notches: the thesis' instance.
pub fn ten_vertices() -> Compiled {
    let corners = [
        (16.0, 22.0, 5.0),
        (26.0, 7.0, 5.0),
        (60.0, 7.0, 5.0),
        (80.257, 16.0, 5.0),
        (97.643_664_873_203_24, 20.658_742_811_845_37, 5.0),
        (96.257, 37.0, 4.0),
        (69.0, 37.5, 4.0),
        (67.0, 55.0, 5.0),
        (40.0, 55.0, 5.0),
        (33.0, 36.0, 5.0),
    ];
    let mut layout = fixture::loop_through("thesis10", &corners);
    layout.building = building(
        0.0,
        &[
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
        ],
    );
    layout.obstacles = vec![
        obstacle("O1", 0.3, &[(25.2, 16.0), (30.5, 14.5), (31.5, 19.5), (26.5, 20.5)]),
        obstacle("O2", 0.5, &[(48.0, 24.0), (56.0, 24.0), (56.0, 34.0), (48.0, 34.0)]),
        obstacle("O3", 0.0, &[(102.0, 12.0), (108.0, 12.0), (108.0, 30.0), (105.0, 33.0), (102.0, 30.0)]),
        obstacle("O4", 1.0, &[(2.0, 2.0), (8.0, 2.0), (8.0, 8.0), (2.0, 8.0)]),
    ];
    let all = [FixKind::Length, FixKind::Rotation, FixKind::Parallel, FixKind::Perpendicular];
    layout.constraints =
        vec![fix_section(1, &all), fix_section(7, &all), fix_section(3, &[FixKind::Length, FixKind::Rotation])];
    layout.equipment.motors = Motors::Evenly { count: 13 };
    layout.equipment.supports = Some(Spanned::new(2.5, fixture::span()));
    layout.equipment.photocell = Some(on(0, 1.0));
    layout.equipment.inductions = vec![
        Induction { name: "west".to_owned(), place: on(0, 5.0) },
        Induction { name: "north".to_owned(), place: on(7, 4.0) },
    ];
    let row = |section, count| PlaceRow { place: on(section, 3.0), every: 1.25, count };
    layout.equipment.chutes = vec![
        Chutes { name: "row_a".to_owned(), row: row(1, 18), more: Vec::new() },
        Chutes { name: "row_b".to_owned(), row: row(5, 12), more: Vec::new() },
    ];
    compile(layout)
}

/// A loop of 10 m by 6 m with more equipment than room.
pub fn crowded() -> Compiled {
    let corners =
        [(0.0, 0.0, 1.5), (10.0, 0.0, 1.5), (10.0, 3.0, 1.0), (7.0, 3.0, 1.0), (7.0, 6.0, 1.5), (0.0, 6.0, 1.5)];
    let mut layout = fixture::loop_through("crowded", &corners);
    layout.width.value = 0.8;
    layout.building = building(0.2, &[(-1.5, -1.5), (11.5, -1.5), (11.5, 7.5), (-1.5, 7.5)]);
    layout.obstacles = vec![
        obstacle("column_a", 0.2, &[(3.0, 2.0), (3.4, 2.0), (3.4, 2.4), (3.0, 2.4)]),
        obstacle("column_b", 0.2, &[(8.5, 4.6), (8.9, 4.6), (8.9, 5.0), (8.5, 5.0)]),
        obstacle("control cabinet", 0.3, &[(1.6, 3.5), (4.6, 3.5), (4.6, 4.3), (2.6, 4.3), (2.6, 4.6), (1.6, 4.6)]),
    ];
    let equipment = &mut layout.equipment;
    equipment.start = Some(on(5, 0.5));
    equipment.photocell = Some(on(0, 0.4));
    equipment.inductions = vec![
        Induction { name: "in_1".to_owned(), place: on(5, 1.0) },
        Induction { name: "in_2".to_owned(), place: on(5, 2.0) },
    ];
    let row = |section, at, count| PlaceRow { place: on(section, at), every: 0.6, count };
    equipment.chutes = vec![
        Chutes { name: "south".to_owned(), row: row(0, 1.0, 9), more: Vec::new() },
        Chutes { name: "north".to_owned(), row: row(4, 0.5, 6), more: Vec::new() },
    ];
    equipment.motors = Motors::Evenly { count: 6 };
    equipment.supports = Some(Spanned::new(1.0, fixture::span()));
    layout.constraints = vec![
        fix_section(4, &[FixKind::Length]),
        fix(ConstraintKind::FixVertex { vertex: 0 }),
        fix(ConstraintKind::FixRadius { vertex: 3 }),
    ];
    compile(layout)
}

/// Ten vertices whose solve found nothing feasible.
pub fn failed() -> Compiled {
    let mut compiled = ten_vertices();
    let violation = |row: &str, amount, unit| Violation { row: row.to_owned(), span: fixture::span(), amount, unit };
    compiled.stages.push(Stage {
        name: "stage2",
        status: Status::Infeasible,
        max_violation: 0.613,
        violations: vec![
            violation("clearance of O2 to the straight P4..P5", 0.613, "m"),
            violation("turn at P3 at most 90°", 0.0123, "rad"),
            violation("length(P7..P8) >= 18 m, \"the chute wall needs 18 m\"", 0.25, "m"),
        ],
        ..compiled.stages[0].clone()
    });
    compiled
}

/// A wavy ring of many vertices among columns.
pub fn large(vertices: usize, obstacles: usize) -> Compiled {
    let around = |i: usize, n: usize, r: f64| {
        let p = Point::unit(trig::TAU * i as f64 / n as f64) * r;
        (p.x, p.y)
    };
    let corners: Vec<(f64, f64, f64)> = (0..vertices)
        .map(|i| {
            let (x, y) = around(i, vertices, if i % 2 == 0 { 150.0 } else { 156.0 });
            (x, y, 2.0)
        })
        .collect();
    let mut layout: Layout = fixture::loop_through("large", &corners);
    layout.obstacles = (0..obstacles)
        .map(|i| {
            let (x, y) = around(i, obstacles, 135.0);
            obstacle(&format!("column_{i}"), 0.3, &[(x, y), (x + 1.0, y), (x + 1.0, y + 1.0), (x, y + 1.0)])
        })
        .collect();
    compile(layout)
}

/// Three made-up stages, each a little smaller than the one before.
pub fn staged() -> (Compiled, Vec<Corner>) {
    let mut compiled = ten_vertices();
    let written = compiled.layout.corners();
    let pulled = |k: f64| -> Vec<Corner> {
        let middle = Point::new(60.0, 30.0);
        written.iter().map(|c| Corner { point: c.point.lerp(middle, k), ..*c }).collect()
    };
    let first = compiled.stages[0].clone();
    compiled.stages = ["stage1", "stage2", "stage3"]
        .into_iter()
        .zip([0.12, 0.07, 0.05])
        .map(|(name, k)| {
            let corners = pulled(k);
            let length = Track::new(&corners).length;
            Stage { name, corners, length, status: Status::Local, ..first.clone() }
        })
        .collect();
    (compiled, written)
}
