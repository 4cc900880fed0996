//! Placements against an independent answer: every choice of places on a coarse grid, looked at one by one.

use super::footprint::{Footprint, Line, conveyor, overlap};
use super::{fill_in, findings, place};
use crate::base::random::Random;
use crate::geometry::{Point, Polygon, Track};
use crate::model::fixture::{self, anywhere, equipment_type, span};
use crate::model::{Building, Declared, EquipmentKind, EquipmentSide, Layout, Obstacle, Side, Stands, StraightPlace};
use crate::source::{FileId, Span};

fn square(x: f64, y: f64, size: f64) -> Polygon {
    let p = |dx: f64, dy: f64| Point::new(x + dx, y + dy);
    Polygon::new(vec![p(0.0, 0.0), p(size, 0.0), p(size, size), p(0.0, size)]).unwrap()
}

fn column(name: &str, x: f64, y: f64, size: f64) -> Obstacle {
    Obstacle {
        name: name.to_owned(),
        polygon: square(x, y, size),
        clearance: 0.0,
        side: Side::Right,
        pass: None,
        span: Span::new(FileId(0), 1, 2),
    }
}

fn track(layout: &Layout) -> Track {
    Track::new(&layout.corners())
}

/// Straights of 12 and 6 m, counter-clockwise from (3, 0).
fn rectangle() -> Layout {
    let mut layout = fixture::rectangle(18.0, 12.0, 3.0);
    layout.obstacles.clear();
    layout.building = None;
    layout
}

#[test]
fn chutes_fill_the_straights_from_the_start() {
    let mut layout = rectangle();
    layout.equipment.declared =
        vec![anywhere("row_a", equipment_type(EquipmentKind::Chute, 1.25, 2.0, EquipmentSide::Outer), 12)];
    let found = place(&layout, &track(&layout));
    assert!(found.is_whole() && found.whole);
    let places: Vec<(usize, f64)> = found.placed.iter().map(|p| (p.place.section, p.place.at)).collect();
    // Nine on the straight of 12 m, side by side, and three on the next.
    let expected: Vec<(usize, f64)> = (0..9)
        .map(|i| (0, 0.625 + 1.25 * f64::from(i)))
        .chain((0..3).map(|i| (1, 0.625 + 1.25 * f64::from(i))))
        .collect();
    assert_eq!(places.len(), expected.len());
    for (a, b) in places.iter().zip(&expected) {
        assert!(a.0 == b.0 && (a.1 - b.1).abs() < 1e-5, "{places:?}");
    }
    assert_eq!(found.equipment, 12_000.0);
    fill_in(&mut layout, &found);
    let rows: Vec<(usize, usize)> = layout.equipment.chutes[0].rows().map(|r| (r.place.section, r.count)).collect();
    assert_eq!(rows, [(0, 9), (1, 3)]);
}

#[test]
fn distances_from_curves_and_room_at_the_ends_are_kept() {
    let mut layout = rectangle();
    let mut of = equipment_type(EquipmentKind::Chute, 1.0, 2.0, EquipmentSide::Outer);
    (of.from_curve, of.service) = (0.5, 0.25);
    layout.equipment.declared = vec![anywhere("row_a", of, 100)];
    let found = place(&layout, &track(&layout));
    // n + 0.25 (n - 1) <= 11: 9 on 12 m, and 4 on 6 m.
    assert_eq!(found.missing, [(0, 100 - 2 * (9 + 4))]);
    let first = &found.placed[0];
    assert!((first.place.at - 1.0).abs() < 1e-6 && (found.placed[1].place.at - 2.25).abs() < 1e-6);
}

#[test]
fn a_column_and_a_wall_are_stood_off() {
    let mut layout = rectangle();
    // Beside the first straight, from (3, 0) to (15, 0), whose band is 1.2 m wide.
    layout.obstacles = vec![column("column", 8.0, -2.0, 1.0)];
    let mut of = equipment_type(EquipmentKind::Chute, 1.0, 2.0, EquipmentSide::Outer);
    layout.equipment.declared = vec![anywhere("row_a", of.clone(), 100)];
    let on_first = |found: &super::Placement| found.placed.iter().filter(|p| p.place.section == 0).count();
    // 5 m before it and 6 m behind it.
    assert_eq!(on_first(&place(&layout, &track(&layout))), 11);
    of.service = 0.5;
    layout.equipment.declared = vec![anywhere("row_a", of.clone(), 100)];
    // n + 0.5 (n + 1) <= 5.5 where the column is at one end: 3, and 4 of 6.5 m.
    assert_eq!(on_first(&place(&layout, &track(&layout))), 3 + 4);
    of.service = 0.0;
    layout.building = Some(Building { polygon: square(-2.5, -2.5, 30.0), clearance: 0.0, span: span() });
    layout.equipment.declared = vec![anywhere("row_a", of, 100)];
    // No room of 2 m to the wall in the south, and none to that in the west.
    let found = place(&layout, &track(&layout));
    assert!(found.placed.iter().all(|p| matches!(p.place.section, 1 | 2)), "{:?}", found.placed);
}

#[test]
fn an_induction_stands_where_its_conveyor_is_shortest() {
    let mut layout = rectangle();
    let mut of = equipment_type(EquipmentKind::Induction, 2.0, 1.4, EquipmentSide::Outer);
    of.conveyor = 100.0;
    let fed = |x: f64, y: f64| Declared { fed: Some(Point::new(x, y)), ..anywhere("west", of.clone(), 1) };
    layout.equipment.declared = vec![fed(9.03, -7.0)];
    let found = place(&layout, &track(&layout));
    // The band's edge lies at y = -0.6 and the induction's at -2.
    assert!((found.conveyors - 500.0).abs() < 1e-9 && found.bound == found.conveyors, "{found:?}");
    // Beyond the end of the straight: at its end, with the hypotenuse.
    layout.equipment.declared = vec![fed(-4.0, -6.0)];
    let found = place(&layout, &track(&layout));
    assert_eq!(found.placed[0].place.section, 0);
    let length = Point::new(4.0, -2.0).distance(Point::new(-4.0, -6.0));
    assert!((found.conveyors - 100.0 * length).abs() < 1e-6 && found.bound <= found.conveyors);
}

#[test]
fn the_order_is_kept_from_the_layouts_start() {
    let mut layout = rectangle();
    layout.equipment.start = Some(StraightPlace { section: 2, at: 6.0, span: span() });
    let scanner = anywhere("scan", equipment_type(EquipmentKind::Scanner, 1.0, 0.5, EquipmentSide::Both), 1);
    let mut row = anywhere("row_a", equipment_type(EquipmentKind::Chute, 1.0, 2.0, EquipmentSide::Outer), 9);
    row.stands = Stands::Free { count: 9, on: vec![2], after: vec!["scan".to_owned()], before: Vec::new() };
    layout.equipment.declared = vec![row, scanner];
    let found = place(&layout, &track(&layout));
    assert!(found.is_whole(), "{found:?}");
    let scan = found.placed.iter().find(|p| p.declared == 1).unwrap();
    assert!(scan.place.section == 2 && (scan.place.at - 6.0).abs() < 1e-6, "{scan:?}");
    // Five behind the scanner, and the others on the part of the straight where the loop ends.
    let places: Vec<f64> = found.placed.iter().filter(|p| p.declared == 0).map(|p| p.place.at).collect();
    assert_eq!(places.iter().filter(|at| **at > 6.5).count(), 5);
    assert_eq!(places.iter().filter(|at| **at < 5.5).count(), 4);
}

#[test]
fn two_straights_share_the_room_between_them() {
    // A hairpin: 3 m between the bands of the first and the third straight, whose inner sides face each other.
    let mut layout = fixture::rectangle(18.0, 4.2, 1.5);
    (layout.obstacles, layout.building) = (Vec::new(), None);
    let of = equipment_type(EquipmentKind::Chute, 4.5, 2.0, EquipmentSide::Inner);
    // Straights of 15 m hold three each, and both together no more: four would take 18 m of what they share. That nothing
    // holds the fourth is not proven within the limit of nodes, and not claimed.
    for (wanted, whole) in [(3, true), (4, false)] {
        layout.equipment.declared = vec![anywhere("row_a", of.clone(), wanted)];
        let found = place(&layout, &track(&layout));
        assert!(found.whole == whole && found.placed.len() == 3, "{found:?}");
        no_two_meet(&layout, &found);
    }
    let said = findings(&layout, &track(&layout));
    assert_eq!(said[0].message, "no places were found for 1 of 4 chutes `row_a`");
}

fn no_two_meet(layout: &Layout, found: &super::Placement) {
    for (i, a) in found.placed.iter().enumerate() {
        for b in &found.placed[..i] {
            assert!(!a.footprint.meets(&b.footprint), "{a:?} {b:?}");
        }
        for obstacle in &layout.obstacles {
            assert!(a.footprint.room.iter().all(|r| !overlap(r, obstacle.polygon.points())), "{a:?}");
        }
    }
}

/// The most that fits and the cheapest conveyors, by looking at every choice of places at multiples of `step`.
fn every_choice(layout: &Layout, step: f64) -> (usize, f64) {
    let track = track(layout);
    let half = layout.width.value / 2.0;
    let mut things: Vec<(&Declared, usize)> = Vec::new();
    for declared in &layout.equipment.declared {
        things.extend((0..declared.count()).map(|i| (declared, i)));
    }
    // All places of each, in driving order, with what the conveyor costs.
    let places: Vec<Vec<(f64, Footprint, f64)>> = things
        .iter()
        .map(|(declared, _)| {
            let of = &declared.of;
            let mut all = Vec::new();
            for section in 0..layout.vertices.len() {
                let line = Line::of(track.straight(section));
                let mut begin = 0.0;
                while begin + of.stretch <= line.length + 1e-9 {
                    let footprint = Footprint::new(of, &line, begin, &[-1.0], half);
                    let clear =
                        layout.obstacles.iter().all(|o| footprint.room.iter().all(|r| !overlap(r, o.polygon.points())));
                    if clear {
                        let price =
                            declared.fed.map_or(0.0, |f| of.conveyor * conveyor(of, &line, begin, &[-1.0], half, f));
                        all.push((section as f64 * 1e3 + begin + 0.5 * of.stretch, footprint, price));
                    }
                    begin += step;
                }
            }
            all
        })
        .collect();
    let mut best = (0, f64::INFINITY);
    choose(&things, &places, &mut Vec::new(), &mut best);
    best
}

type Place = (f64, Footprint, f64);

fn choose<'p>(
    things: &[(&Declared, usize)],
    places: &'p [Vec<Place>],
    chosen: &mut Vec<Option<&'p Place>>,
    best: &mut (usize, f64),
) {
    let placed = chosen.iter().flatten().count();
    if placed + (things.len() - chosen.len()) < best.0 {
        return;
    }
    if chosen.len() == things.len() {
        let price: f64 = chosen.iter().flatten().map(|p| p.2).sum();
        if placed > best.0 || (placed == best.0 && price < best.1) {
            *best = (placed, price);
        }
        return;
    }
    let k = chosen.len();
    let (declared, number) = things[k];
    for place in &places[k] {
        let meets = chosen.iter().flatten().any(|other| other.1.meets(&place.1));
        // Of one declaration they stand in driving order; and a declaration comes after those that it names.
        let after: &[String] = if let Stands::Free { after, .. } = &declared.stands { after } else { &[] };
        let early = chosen.iter().zip(things).any(|(other, (of, _))| {
            let same = number > 0 && of.name == declared.name;
            let named = after.contains(&of.name);
            other.is_some_and(|o| (same || named) && o.0 > place.0)
        });
        if !meets && !early {
            chosen.push(Some(place));
            choose(things, places, chosen, best);
            chosen.pop();
        }
    }
}

#[test]
fn no_choice_on_a_grid_is_better() {
    let mut random = Random::new(11);
    let mut compared = 0;
    for _ in 0..60 {
        let mut layout = rectangle();
        let mut within = |low: f64, high: f64| low + (high - low) * random.uniform();
        layout.obstacles =
            (0..3).map(|i| column(&format!("c{i}"), within(2.0, 15.0), within(-2.5, -1.6), 0.6)).collect();
        let mut induction = equipment_type(EquipmentKind::Induction, 3.0, 2.0, EquipmentSide::Right);
        (induction.conveyor, induction.aisle) = (100.0, 0.5);
        let mut chute = equipment_type(EquipmentKind::Chute, 2.5, 1.5, EquipmentSide::Right);
        chute.service = 0.5;
        let mut row = anywhere("row", chute, 2);
        row.stands = Stands::Free { count: 2, on: Vec::new(), after: vec!["a".to_owned()], before: Vec::new() };
        let from = |x: f64, y: f64| Some(Point::new(x, y));
        let (a, b) = (anywhere("a", induction.clone(), 1), anywhere("b", induction, 1));
        let a = Declared { fed: from(within(-5.0, 25.0), within(-9.0, -4.0)), ..a };
        let b = Declared { fed: from(within(-5.0, 25.0), within(-9.0, -4.0)), ..b };
        layout.equipment.declared = vec![a, row, b];
        let found = place(&layout, &track(&layout));
        let (most, price) = every_choice(&layout, 0.5);
        no_two_meet(&layout, &found);
        assert!(found.whole && found.bound <= found.conveyors && found.placed.len() >= most);
        if most == 4 {
            compared += 1;
            assert!(found.is_whole(), "{most} {found:?}");
            // Multiples of 0.5 m are multiples of the step, too; the bound holds for any places.
            assert!(found.conveyors <= price + 1e-6, "{} {price}", found.conveyors);
            assert!(found.conveyors - found.bound <= 2.0 * 100.0 * super::program::STEP, "{found:?}");
        }
    }
    assert!(compared > 30, "{compared}");
}

#[test]
fn a_message_names_what_is_in_the_way_and_what_is_enough() {
    let mut layout = rectangle();
    layout.obstacles = vec![column("column", 8.0, -2.6, 1.0)];
    let mut row = anywhere("row_a", equipment_type(EquipmentKind::Chute, 1.0, 2.0, EquipmentSide::Outer), 12);
    row.stands = Stands::Free { count: 12, on: vec![0], after: Vec::new(), before: Vec::new() };
    layout.equipment.declared = vec![row];
    let said = findings(&layout, &track(&layout));
    assert_eq!(said.len(), 1);
    assert_eq!(said[0].message, "there is room for 11 of 12 chutes `row_a`");
    let help = said[0].help.clone().unwrap();
    // It reaches to y = -1.6, and chutes to -2.6.
    assert!(help.contains("move `column` 1 m away from the track"), "{help}");
    assert!(help.contains("let it stand `anywhere`") && help.contains("ask for 1 fewer"), "{help}");
    assert!(said[0].related.iter().any(|l| l.text == "the obstacle `column` is in the way over 2 m"), "{said:?}");
    // The change is enough.
    layout.obstacles[0] = column("column", 8.0, -3.6, 1.0);
    assert!(findings(&layout, &track(&layout)).is_empty());
}

#[test]
fn what_is_given_a_place_in_a_column_is_told_where_there_is_room() {
    let mut layout = rectangle();
    layout.obstacles = vec![column("column", 8.0, -2.0, 1.0)];
    let place = StraightPlace { section: 0, at: 5.6, span: span() };
    let of = equipment_type(EquipmentKind::Lift, 1.0, 2.0, EquipmentSide::Outer);
    layout.equipment.declared = vec![Declared { stands: Stands::At(place), ..anywhere("hoist", of, 1) }];
    let said = findings(&layout, &track(&layout));
    // The straight begins at x = 3: the lift covers 8.1 m to 9.1 m, and could end at 8 or begin at 9.
    assert_eq!(said[0].message, "lift `hoist` stands in the obstacle `column`, or too near to it");
    assert_eq!(said[0].help.as_deref(), Some("0.9 m on there is room: `at 6.5 m`"));
}

/// Chutes of 2 m beside the straight from (3, 0) to (15, 0), in a hall whose southern wall is so far away from the track.
fn walled(wall: f64, depth: f64, count: usize) -> Layout {
    let mut layout = rectangle();
    let p = |x: f64, y: f64| Point::new(x, y);
    let points = vec![p(-30.0, -wall), p(60.0, -wall), p(60.0, 40.0), p(-30.0, 40.0)];
    layout.building = Some(Building { polygon: Polygon::new(points).unwrap(), clearance: 0.0, span: span() });
    let mut row = anywhere("row_a", equipment_type(EquipmentKind::Chute, 1.0, depth, EquipmentSide::Outer), count);
    row.stands = Stands::Free { count, on: vec![0], after: Vec::new(), before: Vec::new() };
    layout.equipment.declared = vec![row];
    layout
}

fn told(layout: &Layout) -> (Vec<crate::diagnostic::Diagnostic>, String) {
    let said = findings(layout, &track(layout));
    let help = said.first().and_then(|d| d.help.clone()).unwrap_or_default();
    (said, help)
}

/// Of ten none finds room: none fewer would be left. The band reaches to y = -0.6, so that 8.4 m are free across.
#[test]
fn what_is_too_deep_is_told_by_how_much() {
    let layout = walled(9.0, 9.8, 10);
    let (_, help) = told(&layout);
    assert!(help.contains("take 1.4 m off its depth (it needs 9.8 m across, 8.4 m are free)"), "{help}");
    assert!(!help.contains("fewer") && !help.contains("longer"), "{help}");
    assert!(findings(&walled(9.0, 8.4, 10), &track(&layout)).is_empty(), "what is told is enough");
    assert!(!findings(&walled(9.0, 8.41, 10), &track(&layout)).is_empty(), "and no less");
    // The aisle may be less, too.
    let mut with_aisle = walled(9.0, 8.0, 10);
    with_aisle.equipment.declared[0].of.aisle = 1.8;
    let (_, help) = told(&with_aisle);
    assert!(help.contains("take 1.4 m off its depth or its aisle (it needs 9.8 m across"), "{help}");
}

/// Fifteen chutes on a straight of 12 m: three fewer, or three metres more where the hall has them.
#[test]
fn a_longer_straight_is_told_where_the_track_has_room_for_it() {
    let (_, help) = told(&walled(9.0, 2.0, 15));
    assert!(help.contains("ask for 3 fewer or make P1..P2 3 m longer"), "{help}");
    let mut narrow = walled(9.0, 2.0, 15);
    let p = |x: f64, y: f64| Point::new(x, y);
    let points = vec![p(-1.0, -9.0), p(19.0, -9.0), p(19.0, 40.0), p(-1.0, 40.0)];
    narrow.building = Some(Building { polygon: Polygon::new(points).unwrap(), clearance: 0.0, span: span() });
    let (_, help) = told(&narrow);
    assert!(help.contains("ask for 3 fewer") && !help.contains("longer"), "{help}");
}

/// A wall along the whole track that could only be moved out of the hall.
#[test]
fn what_is_in_the_way_stays_within_the_building() {
    let mut layout = walled(9.0, 2.0, 4);
    let p = |x: f64, y: f64| Point::new(x, y);
    let wall = |low: f64| {
        let points = vec![p(-30.0, low), p(60.0, low), p(60.0, -1.0), p(-30.0, -1.0)];
        Obstacle { polygon: Polygon::new(points).unwrap(), ..column("wall", 0.0, 0.0, 1.0) }
    };
    layout.obstacles = vec![wall(-9.0)];
    let (said, help) = told(&layout);
    assert_eq!(said[0].message, "there is room for 0 of 4 chutes `row_a`");
    assert!(!help.contains("move `wall`") && !help.contains("longer"), "{help}");
    layout.obstacles = vec![wall(-7.0)];
    let (_, help) = told(&layout);
    assert!(help.contains("move `wall` 1.6 m away from the track"), "{help}");
}

/// An induction that stands in a row of chutes is told once, at the one that is declared first.
#[test]
fn two_that_stand_in_each_other_are_told_once() {
    let mut layout = rectangle();
    let at = |at: f64| StraightPlace { section: 0, at, span: span() };
    let of = |kind| equipment_type(kind, 1.0, 2.0, EquipmentSide::Outer);
    let row = crate::model::PlaceRow { place: at(5.0), every: 1.0, count: 4 };
    layout.equipment.declared = vec![
        Declared { stands: Stands::At(at(6.5)), ..anywhere("west", of(EquipmentKind::Induction), 1) },
        Declared { stands: Stands::Row(row), ..anywhere("row_a", of(EquipmentKind::Chute), 1) },
    ];
    let said = findings(&layout, &track(&layout));
    let messages: Vec<&str> = said.iter().map(|d| d.message.as_str()).collect();
    assert_eq!(messages, ["induction `west` stands in the chute `row_a`, or too near to it"]);
}

/// A conveyor from (9, -9) to the outer edge of what stands beside the middle of the straight, 2.6 m south of its line.
#[test]
fn a_conveyor_says_what_it_goes_through() {
    let mut layout = walled(9.0, 2.0, 1);
    layout.equipment.declared[0].of.conveyor = 100.0;
    layout.equipment.declared[0].fed = Some(Point::new(9.0, -9.0));
    let said = |layout: &Layout| super::conveyors(layout, &track(layout), &place(layout, &track(layout)));
    assert!(said(&layout).is_empty(), "{:?}", said(&layout));
    layout.obstacles = vec![column("office", 8.0, -6.0, 2.0)];
    let found = said(&layout);
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].message, "the conveyor to chute `row_a` goes through what is in its way");
    assert_eq!(found[0].label.text, "6.4 m, of which 2 m in the obstacle `office`");
    // From the other side it crosses the far straight of the loop, 1.2 m wide, the near one, and what it feeds, which is no
    // obstacle to it.
    layout.obstacles.clear();
    layout.equipment.declared[0].fed = Some(Point::new(9.0, 30.0));
    let found = said(&layout);
    assert_eq!(found[0].label.text, "32.6 m, of which 1.2 m in the track on P1..P2 and 1.2 m in the track on P3..P4");
    layout.equipment.declared[0].fed = Some(Point::new(9.0, -29.0));
    let found = said(&layout);
    assert_eq!(found[0].message, "the conveyor to chute `row_a` begins outside the building");
    assert_eq!(found[0].label.text, "26.4 m, of which 20 m outside the building");
    layout.equipment.declared[0].of.conveyor = 0.0;
    let found = said(&layout);
    assert!(found.iter().any(|d| d.message == "the conveyor to chute `row_a` costs nothing"), "{found:?}");
}

/// Ten of 1.5 m are told to be shorter by what they lack on a straight of 12 m, and that is enough.
#[test]
fn what_is_too_long_is_told_by_how_much() {
    let stretched = |stretch: f64| {
        let mut layout = walled(9.0, 3.0, 10);
        layout.equipment.declared[0].of.stretch = stretch;
        layout
    };
    let (_, help) = told(&stretched(1.5));
    assert!(help.contains("take 0.3 m off the stretch of each (it has 1.5 m, 1.2 m are free)"), "{help}");
    let track = track(&stretched(1.2));
    assert!(findings(&stretched(1.2), &track).is_empty(), "what is told is enough");
    assert!(!findings(&stretched(1.21), &track).is_empty(), "and no less");
}
