//! Track and equipment together, against layouts told by hand and against every split of chutes over straights.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use crate::small::layout;
use lss::compiled::Compiled;
use lss::geometry::{Corner, Point, Track};
use lss::model::{Layout, Stands};
use lss::placement;
use lss::solve::{Effort, Options, Status, solve};

const HEAD: &str = "use std.carts.tilt_tray\nuse std.tracks.standard\nuse std.tracks.thesis\nuse std.equipment\n\n\
                    equipment slide {\n  kind = chute\n  stretch = 1.5 m\n  depth = 2 m\n  side = outer\n  price = 1000 EUR\n}\n\
                    equipment feeder {\n  kind = induction\n  stretch = 3 m\n  depth = 2 m\n  side = outer\n  \
                    price = 5000 EUR\n  conveyor = 1000 EUR/m\n}\n\n\
                    layout hall {\n  cart tilt_tray(length: 1250 mm)\n  speed 2 m/s\n  width 1.2 m\n";

/// A rectangle whose straights run along the axes: P1..P2 to the east.
fn hall(catalog: &str, lines: &str) -> Layout {
    let loop_ = "  vertex P1 (10 m, 10 m) radius 3 m\n  vertex P2 (40 m, 10 m) radius 3 m\n  \
                 vertex P3 (40 m, 25 m) radius 3 m\n  vertex P4 (10 m, 25 m) radius 3 m\n  radii 3 m .. 3 m\n  turns 90 deg .. 90 deg\n";
    layout(&format!("{HEAD}  catalog {catalog}\n{loop_}{lines}}}\n"))
}

fn built(layout: &Layout) -> Compiled {
    let options = Options { effort: Effort { nodes: 2000, ..Effort::default() }, ..Options::default() };
    let compiled = Compiled::new(layout.clone(), solve(layout, &options, &|_| {}));
    assert!(!compiled.failed() && compiled.placement.is_whole(), "{:?}", compiled.stages.last());
    assert!(placement::findings(&compiled.layout, &compiled.track).is_empty());
    compiled
}

/// The shortest loop of four quarter turns around so many chutes, on straights of a and b twice over: the chutes are
/// split over both pairs in every way.
fn every_split(chutes: usize, stretch: f64, shortest: f64) -> f64 {
    let mut best = f64::INFINITY;
    for a in 0..=chutes {
        for b in 0..=chutes {
            if 2 * (a + b) >= chutes {
                let straights = (a as f64 * stretch).max(shortest) + (b as f64 * stretch).max(shortest);
                best = best.min(2.0 * straights);
            }
        }
    }
    best + 6.0 * std::f64::consts::PI
}

#[test]
fn the_shortest_track_has_room_for_chutes_wherever_they_stand() {
    for chutes in [1, 5, 8, 11, 17] {
        let layout =
            hall("standard", &format!("  chutes row_a of slide at least {chutes} anywhere\n  fix rotation P1..P2\n"));
        let compiled = built(&layout);
        let expected = every_split(chutes, 1.5, 0.2);
        let last = compiled.stages.last().unwrap();
        assert!((last.length - expected).abs() < 1e-5, "{chutes}: {} and not {expected}", last.length);
        let certificate = last.certificate.as_ref().unwrap();
        assert!(certificate.lower_bound <= expected + 1e-9, "{certificate:?}");
        assert_eq!(last.status, Status::Proven, "{certificate:?}");
    }
}

/// A track that only has to be short may lie against a wall of an empty hall: it is moved to where there is room, and is as
/// short as without walls.
#[test]
fn an_empty_hall_has_room_for_what_stands_outside_the_track() {
    let building = "  building [(0 m, 0 m), (40 m, 0 m), (40 m, 40 m), (0 m, 40 m)]\n  fix rotation P1..P2\n";
    for written in [3.0, 20.0] {
        let corners = [(8.0, 0.0), (30.0, 0.0), (30.0, 12.0), (8.0, 12.0)].map(|(x, y)| (x, y + written));
        let named = corners.iter().enumerate();
        let loop_: String =
            named.map(|(i, (x, y))| format!("  vertex P{} ({x} m, {y} m) radius 3 m\n", i + 1)).collect();
        let lines = "  radii 3 m .. 3 m\n  turns 90 deg .. 90 deg\n  chutes row_a of slide at least 8 on P1..P2\n  \
                     chutes row_b of slide at least 8 on P3..P4\n";
        let layout = layout(&format!("{HEAD}  catalog standard\n{loop_}{building}{lines}}}\n"));
        let compiled = built(&layout);
        let expected = 2.0 * (8.0 * 1.5 + 0.2) + 6.0 * std::f64::consts::PI;
        let last = compiled.stages.last().unwrap();
        assert!((last.length - expected).abs() < 1e-5, "{written}: {} and not {expected}", last.length);
        assert_eq!(last.status, Status::Proven, "{:?}", last.certificate);
    }
}

#[test]
fn a_named_straight_is_as_long_as_what_stands_on_it() {
    let lines = "  fix rotation P1..P2\n  chutes row_a of slide at least 7 on P1..P2\n  gate crossing of gate_walkway on P1..P2\n";
    let compiled = built(&hall("standard", lines));
    let last = compiled.stages.last().unwrap();
    // Both stand on the outer side: seven chutes and the gate, of which only the latter keeps away from curves.
    let straight = compiled.track.straight(0).length;
    let least = 7.0 * 1.5 + 1.2;
    assert!((least - 1e-6..=least + 0.3 + 1e-6).contains(&straight), "{straight}");
    assert!(last.certificate.as_ref().unwrap().lower_bound <= last.length);
}

/// Rectangles of every size on the grid of pieces, a little away from a building's walls and in its middle: the length of the
/// shortest on which all equipment finds a place.
fn shortest_rectangle(layout: &Layout, (x, y): (f64, f64), longest: f64) -> f64 {
    let mut best = f64::INFINITY;
    let steps = (longest / 0.6) as usize;
    for (a, b) in (0..=steps).flat_map(|a| (0..=steps).map(move |b| (a, b))) {
        // No straight is shorter than the shortest piece.
        let [width, height] = [a, b].map(|steps| 6.0 + (0.6 * steps as f64).max(0.2));
        let length = 2.0 * (width + height) - 24.0 + 6.0 * std::f64::consts::PI;
        if length >= best {
            continue;
        }
        let from = (x - 0.5 * width, y - 0.5 * height);
        let corners = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)]
            .map(|(dx, dy)| Corner { point: Point::new(from.0 + dx, from.1 + dy), radius: 3.0 });
        if placement::place(layout, &Track::new(&corners)).is_whole() {
            best = length;
        }
    }
    best
}

/// Rows that may stand on any straight, of which a rectangle makes two longer at once, in a hall that has walls in the way.
#[test]
fn equipment_anywhere_takes_no_longer_track_than_rectangles_do() {
    for (chutes, written) in [(4, 11.4), (10, 15.0), (16, 30.0)] {
        let text = format!(
            "{HEAD}  catalog standard\n  vertex P1 (12 m, 13 m) radius 3 m\n  vertex P2 ({east} m, 13 m) radius 3 m\n  \
             vertex P3 ({east} m, 19.2 m) radius 3 m\n  vertex P4 (12 m, 19.2 m) radius 3 m\n  \
             building [(0 m, 0 m), (50 m, 0 m), (50 m, 33 m), (0 m, 33 m)] clearance 0.5 m\n  fix rotation P1..P2\n  \
             induction a of induction_45 anywhere\n  chutes row_a of chute at least {chutes} anywhere\n}}\n",
            east = 12.0 + written
        );
        let layout = layout(&text);
        let compiled = built(&layout);
        let found = compiled.stages.last().unwrap().length;
        let rectangle = shortest_rectangle(&layout, (25.0, 16.5), 20.0);
        // Straights are halved down to 0.05 m, and a rectangle has two of each.
        assert!(found <= rectangle + 0.1, "{chutes}: {found} and not {rectangle}");
        assert!(compiled.stages.last().unwrap().certificate.as_ref().unwrap().lower_bound <= rectangle);
    }
}

/// A column in the way: the shortest track is longer than lengths alone ask for, and the bound does not claim it.
/// The written layout is shorter than any that closes, and is no result.
#[test]
fn what_is_found_closes_the_chain_as_asked() {
    for goal in ["length", "cost"] {
        let layout = hall(
            "standard",
            &format!(
                "  fix all P1..P2\n  fix rotation P3..P4\n  require length(P2..P3) >= 15 m\n  chain closes within 5 mm\n  \
                 chutes row_a of slide at least 8 anywhere\n  optimise {goal}\n"
            ),
        );
        let compiled = built(&layout);
        let left = compiled.chain.expect("a chain").left_over;
        assert!(left.abs() <= 0.005 + 1e-6, "{goal}: {left} m left over on {} m", compiled.track.length);
    }
}

#[test]
fn a_column_makes_the_track_longer() {
    let lines = "  fix P1\n  fix rotation P1..P2\n  chutes row_a of slide at least 4 on P1..P2\n  \
                 obstacle column [(16 m, 7 m), (17 m, 7 m), (17 m, 8 m), (16 m, 8 m)]\n";
    let compiled = built(&hall("standard", lines));
    let last = compiled.stages.last().unwrap();
    // From (13, 10) on: two chutes before the column, two behind it from x = 17 on.
    assert!(compiled.track.straight(0).length >= 7.0 - 1e-6, "{}", compiled.track.straight(0).length);
    assert!((compiled.track.straight(0).length - 7.0).abs() < 1.6, "{}", compiled.track.straight(0).length);
    let certificate = last.certificate.as_ref().unwrap();
    assert!(certificate.lower_bound <= 2.0 * (6.0 + 0.2) + 6.0 * std::f64::consts::PI + 1e-5);
    assert_eq!(last.status, Status::BestFound);
}

/// The induction stands on the northern straight, and its conveyor comes from farther north. Each metre of height costs
/// two metres of track and saves one of conveyor.
#[test]
fn track_and_conveyor_are_traded_against_each_other() {
    // Metres of track at 210 EUR, pieces apart: the conveyor at 1000 EUR is worth every metre of height.
    let north = "  fix all P1..P2\n  fix rotation P3..P4\n  induction in of feeder on P3..P4 fed from (25 m, 40 m)\n";
    let far = built(&hall("standard", &format!("{north}  optimise cost\n")));
    let last = far.stages.last().unwrap();
    let certificate = last.certificate.as_ref().unwrap();
    // The outer edge is 2.6 m north of the centre line.
    let height = far.track.straight(2).begin.y;
    assert!((40.0 - 2.6 - height - far.placement.conveyors / 1000.0).abs() < 1e-6);
    assert!(far.placement.conveyors < 1000.0, "{} {}", far.placement.conveyors, height);
    assert!(certificate.lower_bound <= certificate.value && certificate.gap < 1e-3, "{certificate:?}");
    let whole = far.bill.price + far.placement.price();
    assert!((certificate.value - whole).abs() < 1.0, "{} {whole}", certificate.value);
    // Cheap conveyors are not: the loop stays as flat as it can.
    let mut cheap = hall("standard", &format!("{north}  optimise cost\n"));
    cheap.equipment.declared[0].of.conveyor = 50.0;
    let near = built(&cheap);
    assert!(near.track.straight(2).begin.y < 17.0, "{}", near.track.straight(2).begin.y);
    assert!(near.placement.conveyors > 900.0);
}

/// Two inductions are fed from places 30 m apart, and ten chutes of 1.5 m stand between them: on a straight of 21 m their
/// middles are 18 m apart. Longer straights cost two metres of track, at 210 EUR and more, for each metre of conveyor.
#[test]
fn what_stands_between_inductions_counts_for_their_conveyors() {
    let lines = "  induction a of feeder on P1..P2 fed from (0 m, 0 m)\n  chutes row_a of slide at least 10 on P1..P2 after a before b\n  \
                 induction b of feeder on P1..P2 fed from (30 m, 0 m)\n  optimise cost\n";
    let cases = [(300.0, 12.0, 21.0), (1000.0, 0.0, 33.0)];
    for ((price, metres, length), fix) in
        cases.into_iter().flat_map(|case| [(case, "  fix rotation P1..P2\n"), (case, "")])
    {
        let mut layout = hall("standard", &format!("{fix}{lines}"));
        layout.equipment.declared.iter_mut().filter(|d| d.fed.is_some()).for_each(|d| d.of.conveyor = price);
        let compiled = built(&layout);
        let certificate = compiled.stages.last().unwrap().certificate.clone().unwrap();
        assert!(
            (compiled.placement.conveyors - price * metres).abs() < 0.1,
            "{price}: {}",
            compiled.placement.conveyors
        );
        let straight = compiled.track.straight(0).length;
        assert!((straight - length).abs() < 1e-3, "{price}: {straight}");
        let within = if fix.is_empty() { 1e-3 } else { 1e-4 };
        assert!(certificate.gap < within && certificate.lower_bound > 0.0, "{fix}{certificate:?}");
    }
}

/// An induction 2 m deep is fed from a wall, which chutes 5 m deep beside it keep 5 m from the band: a metre of conveyor is
/// worth more than all of track that reaches for the wall.
#[test]
fn walls_keep_a_track_from_where_its_conveyors_come() {
    let lines = "  building [(0 m, 0 m), (60 m, 0 m), (60 m, 40 m), (0 m, 40 m)]\n  fix rotation P1..P2\n  \
                 chutes row_a of slide at least 6 on P1..P2 after in\n  \
                 induction in of feeder on P1..P2 fed from (25 m, 0 m)\n  optimise cost\n";
    let mut layout = hall("standard", lines);
    let of = |layout: &Layout, name: &str| layout.equipment.declared.iter().position(|d| d.name == name).unwrap();
    let row = of(&layout, "row_a");
    layout.equipment.declared[row].of.depth = 5.0;
    let compiled = built(&layout);
    let certificate = compiled.stages.last().unwrap().certificate.clone().unwrap();
    let (conveyors, left) = (compiled.placement.conveyors, certificate.value - certificate.lower_bound);
    assert!(certificate.gap < 1e-3, "{certificate:?}");
    assert!((2999.9..3000.1 + left).contains(&conveyors), "{conveyors} {left}");
}

/// A conveyor to a given place is as long as the track lets it be, and counts: the loop lies where it is shortest, and not
/// where it was written.
#[test]
fn a_conveyor_to_a_given_place_counts() {
    let lines = "  fix rotation P1..P2\n  induction in of feeder on P1..P2 at 3 m fed from (60 m, 4 m)\n";
    for goal in ["cost", "total_price"] {
        let compiled = built(&hall("standard", &format!("{lines}  optimise {goal}\n")));
        assert!(compiled.placement.conveyors < 1e-3, "{goal}: {}", compiled.placement.conveyors);
        let certificate = compiled.stages.last().unwrap().certificate.clone().unwrap();
        assert!(certificate.gap < 1e-3, "{goal}: {certificate:?}");
    }
}

/// A certificate holds for every other track with its equipment: those of straights longer by some metres.
#[test]
fn no_longer_track_beats_the_bound() {
    let north = "  fix all P1..P2\n  fix rotation P3..P4\n  induction in of feeder on P3..P4 fed from (25 m, 34 m)\n  \
                 chutes row_a of slide at least 9 on P2..P3, P3..P4, P4..P1 after in\n";
    for conveyor in [300.0, 450.0, 700.0] {
        let mut layout = hall("standard", &format!("{north}  optimise cost\n"));
        layout.equipment.declared[0].of.conveyor = conveyor;
        let best = built(&layout);
        let certificate = best.stages.last().unwrap().certificate.clone().unwrap();
        for side in 0..14 {
            let least = format!("  require length(straight(P2..P3)) >= {side} m\n");
            let mut other = hall("standard", &format!("{north}  optimise cost\n{least}"));
            other.equipment.declared[0].of.conveyor = conveyor;
            let other = built(&other);
            let price = other.bill.price + other.placement.price();
            assert!(price >= certificate.lower_bound - 1.0, "{side}: {price} {certificate:?}");
            // And the search comes near to the best of them.
            assert!(certificate.value <= price * 1.01, "{side}: {price} {certificate:?}");
        }
    }
}

#[test]
fn equipment_does_not_depend_on_the_threads() {
    let lines = "  fix all P1..P2\n  fix rotation P3..P4\n  chutes row_a of slide at least 30 anywhere\n  \
                 induction in of feeder anywhere fed from (0 m, 30 m)\n  optimise cost\n";
    let layout = hall("standard", lines);
    let run = |threads| {
        solve(
            &layout,
            &Options { threads, effort: Effort { nodes: 200, ..Effort::default() }, ..Options::default() },
            &|_| {},
        )
    };
    let (one, two) = (run(1), run(2));
    assert_eq!(one.last().unwrap().corners, two.last().unwrap().corners);
    let free = layout.equipment.declared.iter().filter(|d| matches!(d.stands, Stands::Free { .. })).count();
    assert_eq!(free, 2);
}

/// Two inductions and two rows of chutes, wherever they stand: behind both inductions, chutes leave carriers to be used once
/// in a lap. With a row between them, more than once, and so much is asked for.
#[test]
fn an_order_that_takes_enough_is_told() {
    let lines = |order: [&str; 2], asked: &str| {
        let [a, b] = order;
        format!(
            "  fix rotation P1..P2\n  induction a of feeder anywhere\n  induction b of feeder anywhere after a\n  \
             chutes row_a of slide at least 12 anywhere{a}\n  chutes row_b of slide at least 12 anywhere{b}\n  \
             require capacity >= {asked} per hour\n  optimise length\n"
        )
    };
    let said = |lines: &str| {
        let layout = hall("standard", lines);
        let compiled = Compiled::new(layout.clone(), solve(&layout, &Options::default(), &|_| {}));
        compiled.short_of_capacity().map(|said| said.help.unwrap())
    };
    let help = said(&lines(["", ""], "6500")).unwrap();
    assert!(help.contains("write `chutes row_a ... after a before b` and `chutes row_b ... after b`"), "{help}");
    assert_eq!(said(&lines([" after a before b", " after b"], "6500")), None, "what is told is enough");
    // No order takes as many.
    let help = said(&lines(["", ""], "20000")).unwrap();
    assert!(!help.contains("in this order"), "{help}");
}

/// With chutes on either of two straights a price has a bound beyond what the equipment costs, and is no more than that of
/// the shortest track with room for everything.
#[test]
fn a_price_is_bounded_and_no_more_than_that_of_the_shortest_track() {
    let text = |goal: &str| {
        format!(
            "use std.carts.tilt_tray\nuse std.tracks.standard\nuse std.equipment\n\nlayout two {{\n  catalog standard\n  \
             cart tilt_tray(length: 1 m)\n  speed 1.9 m/s\n  width 1.1 m\n  vertex P1 (1.61 m, 4.6 m) radius 3 m\n  \
             vertex P2 (15.26 m, 4.6 m) radius 3 m\n  vertex P3 (15.26 m, 17.41 m) radius 3 m\n  \
             vertex P4 (1.61 m, 17.41 m) radius 3 m\n  \
             building [(0 m, 0 m), (30 m, 0 m), (30 m, 10 m), (21 m, 10 m), (21 m, 22 m), (0 m, 22 m)] clearance 0.3 m\n  \
             start on P1..P2 at 0 m\n  induction a of induction_manual on P1..P2 fed from (1 m, 1 m)\n  \
             chutes r of chute at least 6 on P2..P3, P3..P4 after a\n  optimise {goal}\n}}\n"
        )
    };
    let solved = |goal: &str| {
        let layout = layout(&text(goal));
        let options = Options { effort: Effort { nodes: 300, ..Effort::default() }, ..Options::default() };
        Compiled::new(layout.clone(), solve(&layout, &options, &|_| {}))
    };
    let cost = |compiled: &Compiled| compiled.bill.price + compiled.placement.price();
    let shortest = solved("length");
    assert!(!shortest.failed() && shortest.placement.is_whole());
    let cheapest = solved("cost");
    let certificate = cheapest.stages.last().and_then(|s| s.certificate.clone()).expect("a certificate");
    assert!(certificate.lower_bound > cheapest.placement.equipment, "{certificate:?}");
    let bought = Layout { objective: cheapest.layout.objective.clone(), ..shortest.layout.clone() };
    let bought = Compiled::new(bought, shortest.stages.clone());
    assert!(cost(&cheapest) <= cost(&bought) + 0.5, "{} {}", cost(&cheapest), cost(&bought));
    let total = |compiled: &Compiled| lss::compiled::order::total(compiled).all;
    assert!(total(&solved("total_price")) <= total(&bought) + 0.5);
}
