//! `route`: loops that are found, against loops told by hand, and the bound against what is not found.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use crate::small::{Random, layout};
use lss::base::trig::{PI, TAU};
use lss::geometry::{Point, Track};
use lss::model::{ConstraintKind, Layout, Side};
use lss::route::{Found, find, text};
use lss::semantics::analyse;
use lss::solve::{Effort, Options, Status, solve};
use lss::source::{Loader, SourceMap};

const HEAD: &str = "use std.carts.tilt_tray\nuse std.tracks.standard\nuse std.tracks.thesis\n\nlayout hall {\n  \
                    cart tilt_tray(length: 1250 mm)\n  speed 2 m/s\n  width 1.2 m\n";

fn hall(catalog: &str, lines: &str) -> String {
    // Imports that nothing uses are mentioned, which is no mistake.
    format!("{HEAD}  catalog {catalog}\n{lines}}}\n")
}

fn brief() -> Options {
    Options { effort: Effort { nodes: 60, ..Effort::default() }, ..Options::default() }
}

fn found(text: &str) -> Found {
    find(&layout(text), &brief(), &|_| {}).unwrap_or_else(|why| panic!("{why:?}\n{text}"))
}

/// The points of a track, closely.
fn sampled(found: &Found) -> (Track, Vec<Point>) {
    let track = Track::new(&found.stages.last().unwrap().corners);
    let points = (0..20_000).map(|i| track.at(track.length * f64::from(i) / 20_000.0).0).collect();
    (track, points)
}

/// What a route promises, looked at without its rows: sections lie on straights, driven as they are to be; distances
/// are kept; the bound is no more than the length.
fn sound(found: &Found) {
    let stage = found.stages.last().unwrap();
    assert!(matches!(stage.status, Status::BestFound | Status::Proven), "{:?} {:?}", stage.status, stage.violations);
    assert!(found.summary.shortest <= stage.length + 1e-9, "{} > {}", found.summary.shortest, stage.length);
    let (track, points) = sampled(found);
    let layout = &found.layout;
    let mut held = 0;
    for constraint in &layout.constraints {
        let ConstraintKind::Holds { section, part } = &constraint.kind else { continue };
        held += 1;
        let straight = track.straight(*section);
        let direction = (part.to - part.from) * (1.0 / part.from.distance(part.to));
        assert!(Point::unit(straight.heading).dot(direction) > 1.0 - 1e-12, "{}", part.name);
        assert!(direction.cross(straight.begin - part.from).abs() < 1e-5, "{}", part.name);
        let along = |p: Point| direction.dot(p - part.from);
        let (low, high) = (along(straight.begin).max(0.0), along(straight.end).min(part.from.distance(part.to)));
        let wanted = part.length.unwrap_or(part.from.distance(part.to));
        assert!(high - low >= wanted - 1e-5, "{}: {} of {wanted}", part.name, high - low);
    }
    assert!(held > 0);
    let half = layout.width.value / 2.0;
    for obstacle in &layout.obstacles {
        let near = points.iter().map(|&p| obstacle.polygon.distance_to_outline(p)).fold(f64::INFINITY, f64::min);
        assert!(near >= half + obstacle.clearance - 1e-5, "{} at {near}", obstacle.name);
        assert!(points.iter().all(|&p| !obstacle.polygon.contains(p)), "{}", obstacle.name);
    }
    if let Some(building) = &layout.building {
        assert!(points.iter().all(|&p| building.polygon.contains(p)));
    }
}

/// Two sections opposite each other: two half circles, each as two curves with the least straight between. Without a
/// least straight that is the shortest loop of all, and the bound says so.
#[test]
fn a_loop_that_can_be_told_by_hand() {
    let sections = "  section a (10 m, 2 m)..(30 m, 2 m)\n  section b (30 m, 20 m)..(10 m, 20 m)\n  route a, b\n";
    let there = found(&hall("thesis", sections));
    sound(&there);
    let expected = 2.0 * 20.0 + 2.0 * (3.0 * PI + 12.0);
    let length = there.stages.last().unwrap().length;
    assert!((length - expected).abs() < 1e-6, "{length}, not {expected}");
    assert!((there.summary.shortest - expected).abs() < 1e-5, "{}", there.summary.shortest);
    assert_eq!(there.layout.vertices.len(), 4);
    // One section alone: its length twice, and a full circle.
    let alone = found(&hall("thesis", "  section a (10 m, 2 m)..(30 m, 2 m)\n  route a\n"));
    sound(&alone);
    assert!((alone.stages.last().unwrap().length - (40.0 + 3.0 * TAU)).abs() < 1e-6);
    assert!((alone.summary.shortest - (40.0 + 3.0 * TAU)).abs() < 1e-5);
}

#[test]
fn a_layout_without_vertices_has_no_stages() {
    let text = include_str!("../../examples/route.lss");
    assert_eq!(solve(&layout(text), &brief(), &|_| {}).len(), 0);
}

/// A section that slides, the other driven either way: as if it stood in the best place, driven the better way.
#[test]
fn freedom_is_used() {
    let fixed = "  section a (10 m, 2 m)..(30 m, 2 m)\n  section b (30 m, 20 m)..(10 m, 20 m)\n  route a, b\n";
    let sliding = "  section a (10 m, 2 m)..(30 m, 2 m)\n  section b 20 m within (-30 m, 20 m)..(80 m, 20 m) either way\n  \
                   route a, b in any order\n";
    let (fixed, sliding) = (found(&hall("thesis", fixed)), found(&hall("thesis", sliding)));
    sound(&sliding);
    let length = |f: &Found| f.stages.last().unwrap().length;
    assert!((length(&fixed) - length(&sliding)).abs() < 1e-6, "{} {}", length(&fixed), length(&sliding));
    assert!(sliding.summary.shortest > length(&sliding) - 0.1, "{}", sliding.summary.shortest);
    assert_eq!(sliding.summary.rounds, 2);
}

/// The text that is written builds to the same loop, and a layout with vertices by hand is no shorter than the bound.
#[test]
fn what_is_written_is_a_layout() {
    let lines = "  // where parcels come in\n  section a (10 m, 3 m)..(30 m, 3 m) // docks\n  \
                 section b 12 m within (40 m, 36 m)..(6 m, 36 m)\n  \
                 obstacle racks [(18 m, 12 m), (30 m, 12 m), (30 m, 28 m), (18 m, 28 m)] clearance 0.5 m\n  \
                 building [(0 m, 0 m), (50 m, 0 m), (50 m, 40 m), (0 m, 40 m)] clearance 0.3 m\n  route a, b\n";
    let asked = hall("standard", lines);
    let mut sources = SourceMap::default();
    let (mut loader, main) = Loader::memory(&mut sources, &[("hall.lss", asked.as_bytes())]).unwrap();
    let analysis = analyse(&mut sources, &mut loader, main, None);
    let wanted = analysis.chosen().unwrap().unwrap().clone();
    let there = find(&wanted, &brief(), &|_| {}).unwrap();
    sound(&there);
    let corners = &there.stages.last().unwrap().corners;
    let written = text(&sources, &wanted, &there.layout, corners).unwrap();
    assert!(written.contains("// where parcels come in") && written.contains("on P1..P2 // docks"), "{written}");
    assert!(!written.contains("route a"), "{written}");
    let again = layout(&written);
    let rebuilt = solve(&again, &brief(), &|_| {});
    let (first, second) = (there.stages.last().unwrap(), rebuilt.last().unwrap());
    assert!(matches!(second.status, Status::BestFound | Status::Proven), "{:?}", second.violations);
    assert!(second.length <= first.length + 1e-6, "{} {}", second.length, first.length);

    let by_hand = lines.replace("  route a, b\n", "").replace("  section a (10 m, 3 m)..(30 m, 3 m) // docks\n", "");
    let vertices = "  vertex P1 (6 m, 3 m) radius 3 m\n  vertex P2 (44 m, 3 m) radius 4 m\n  \
                    vertex P3 (44 m, 36 m) radius 4 m\n  vertex P4 (6 m, 36 m) radius 3 m\n  \
                    section a (10 m, 3 m)..(30 m, 3 m) on P1..P2\n";
    let by_hand = by_hand.replace(
        "section b 12 m within (40 m, 36 m)..(6 m, 36 m)",
        "section b 12 m within (40 m, 36 m)..(6 m, 36 m) on P3..P4",
    );
    let by_hand = solve(&layout(&hall("standard", &format!("{vertices}{by_hand}"))), &brief(), &|_| {});
    let four = by_hand.last().unwrap();
    assert!(matches!(four.status, Status::BestFound | Status::Proven), "{:?}", four.violations);
    assert!(four.length >= there.summary.shortest - 1e-6, "{} < {}", four.length, there.summary.shortest);
    assert!(first.length <= four.length + 1e-6, "{} > {}", first.length, four.length);
}

/// `pass` decides the side, and either side costs no less than the better one.
#[test]
fn a_side_that_is_asked_for_is_kept() {
    let lines = |pass: &str| {
        format!(
            "  section a (10 m, 2 m)..(30 m, 2 m)\n  section b (30 m, 30 m)..(10 m, 30 m)\n  \
             obstacle box [(38 m, 14 m), (42 m, 14 m), (42 m, 18 m), (38 m, 18 m)]\n{pass}  route a, b\n"
        )
    };
    let free = found(&hall("thesis", &lines("")));
    let inside = found(&hall("thesis", &lines("  pass box left\n")));
    for there in [&free, &inside] {
        sound(there);
    }
    assert_eq!(inside.layout.obstacles[0].side, Side::Left);
    let length = |f: &Found| f.stages.last().unwrap().length;
    assert!(length(&free) < length(&inside), "{} {}", length(&free), length(&inside));
}

/// No track through random sections, written by hand around them, is shorter than the bound: rectangles of every size
/// that hold the sections on their sides.
#[test]
fn the_bound_holds_for_other_layouts() {
    let mut random = Random(3);
    for _ in 0..6 {
        let (width, height) = (random.between(20.0, 60.0), random.between(15.0, 40.0));
        let (from, to) = (random.between(4.0, width / 2.0 - 1.0), random.between(width / 2.0, width - 4.0));
        let slack = random.between(0.0, width - 12.0);
        let length = width - 8.0 - slack;
        let lines = format!(
            "  section a ({from} m, 0 m)..({to} m, 0 m)\n  \
             section b {length} m within ({} m, {height} m)..(4 m, {height} m)\n  route a, b\n",
            width - 4.0
        );
        let there = found(&hall("thesis", &lines));
        sound(&there);
        // The rectangle with the smallest curves holds both sections on its sides.
        let rectangle = 2.0 * (width + height) - 8.0 * 3.0 + 3.0 * TAU;
        assert!(there.summary.shortest <= rectangle + 1e-6, "{} > {rectangle}", there.summary.shortest);
        assert!(there.stages.last().unwrap().length <= rectangle + 1e-6, "{lines}");
    }
}

/// The same layout whatever the number of threads.
#[test]
fn threads_do_not_matter() {
    let text = hall(
        "standard",
        "  section a (10 m, 2 m)..(30 m, 2 m)\n  section b 10 m within (50 m, 30 m)..(0 m, 30 m)\n  route a, b\n",
    );
    let run = |threads| {
        let options = Options { threads, ..brief() };
        let there = find(&layout(&text), &options, &|_| {}).unwrap();
        (format!("{:?}", there.stages.last().unwrap().corners), there.summary)
    };
    assert_eq!(run(1), run(3));
}

/// Cost: no layout is worth less than what the bound says.
#[test]
fn the_cheapest_route_is_bounded() {
    let lines =
        "  section a (10 m, 2 m)..(30 m, 2 m)\n  section b (30 m, 20 m)..(10 m, 20 m)\n  route a, b\n  optimise cost\n";
    let there = found(&hall("standard", lines));
    let least = there.summary.cheapest.unwrap();
    assert!(least <= there.summary.value && least > 0.95 * there.summary.value, "{least} {}", there.summary.value);
}

/// Layouts that cannot be: every one says why.
#[test]
fn what_is_in_the_way_is_named() {
    let said = |lines: &str| {
        let asked: Layout = layout(&hall("standard", lines));
        let why = find(&asked, &brief(), &|_| {}).expect_err("no loop");
        why.iter().map(|d| format!("{} {}", d.code.as_str(), d.message)).collect::<Vec<_>>().join("; ")
    };
    let sections = "  section a (10 m, 2 m)..(30 m, 2 m)\n  section b (30 m, 20 m)..(10 m, 20 m)\n  route a, b\n";
    let wall = "  obstacle racks [(-40 m, 10 m), (80 m, 10 m), (80 m, 12 m), (-40 m, 12 m)]\n  \
                building [(-40 m, -10 m), (80 m, -10 m), (80 m, 40 m), (-40 m, 40 m)]\n";
    assert_eq!(said(&format!("{sections}{wall}")), "E0414 there is no way from `a` to `b` for a track 1.2 m wide");
    let near = "  obstacle box [(15 m, 1 m), (16 m, 1 m), (16 m, 1.8 m), (15 m, 1.8 m)]\n";
    assert_eq!(said(&format!("{sections}{near}")), "E0412 the section `a` is not clear of `box`");
    let oblique = sections.replace("(10 m, 20 m)", "(10 m, 21 m)");
    assert_eq!(said(&oblique), "E0414 no curves of the catalogue join the headings of `a` and `b`");
    let close = sections.replace("20 m)", "2.5 m)");
    assert_eq!(said(&close), "E0412 the sections `a` and `b` need the same floor");
    let nothing = format!("{sections}  optimise nothing\n");
    assert_eq!(said(&nothing), "E0414 a route is optimised, and the layout optimises nothing");
}

/// Layer, text if it is one, and points.
type Entity<'a> = (&'a str, &'a str, Vec<(f64, f64)>);

/// Group codes and values of a drawing, a pair each.
fn drawing(entities: &[Entity]) -> String {
    let mut out = String::from("0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n");
    for (layer, text, points) in entities {
        match (text.is_empty(), &points[..]) {
            (false, [at]) => out += &format!("0\nTEXT\n8\n{layer}\n10\n{}\n20\n{}\n40\n300\n1\n{text}\n", at.0, at.1),
            (_, [a, b]) => {
                out += &format!("0\nLINE\n8\n{layer}\n10\n{}\n20\n{}\n11\n{}\n21\n{}\n", a.0, a.1, b.0, b.1);
            }
            (_, points) => {
                out += &format!("0\nLWPOLYLINE\n8\n{layer}\n90\n{}\n70\n1\n", points.len());
                points.iter().for_each(|p| out += &format!("10\n{}\n20\n{}\n", p.0, p.1));
            }
        }
    }
    out + "0\nENDSEC\n0\nEOF\n"
}

/// A hall in millimetres, with noise of a CAD system on a line.
#[test]
fn a_drawn_hall_asks_for_its_loop() {
    let walls = vec![(0.0, 0.0), (50_000.0, 0.0), (50_000.0, 40_000.0), (0.0, 40_000.0)];
    let text = drawing(&[
        ("BUILDING", "", walls),
        ("Obstacles", "", vec![(20_000.0, 14_000.0), (28_000.0, 14_000.0), (28_000.0, 24_000.0), (20_000.0, 24_000.0)]),
        ("TEXTS", "racks 1", vec![(24_000.0, 19_000.0)]),
        ("sections", "", vec![(10_000.0, 3_000.0), (30_000.000_000_04, 2_999.999_999_96)]),
        ("TEXTS", "Inductions", vec![(20_000.0, 3_500.0)]),
        ("SECTIONS-OUTBOUND", "", vec![(30_000.0, 36_000.0), (12_000.0, 36_000.0)]),
        ("DIMENSIONS", "", vec![(0.0, -500.0), (50_000.0, -500.0)]),
    ]);
    let mut sources = SourceMap::default();
    let file = sources.add("hall.dxf", text);
    let (hall, said) = lss::import::hall(&sources, file, &lss::import::Options::default());
    assert!(said.is_empty(), "{said:?}");
    let hall = hall.unwrap();
    let sections: Vec<_> = hall.sections.iter().map(|s| (s.name.as_str(), s.from, s.to)).collect();
    let at = Point::new;
    assert_eq!(sections, [("Inductions", at(10.0, 3.0), at(30.0, 3.0)), ("outbound", at(30.0, 36.0), at(12.0, 36.0))]);
    assert_eq!((hall.obstacles.len(), hall.obstacles[0].name.as_str()), (1, "racks_1"));
    let there = found(&lss::import::write_hall(&hall, "drawn", "A hall."));
    sound(&there);
    // Without marked lines there is nothing to route.
    let file = sources.add("empty.dxf", drawing(&[("WALLS", "", vec![(0.0, 0.0), (1.0, 0.0)])]));
    let (none, said) = lss::import::hall(&sources, file, &lss::import::Options::default());
    assert!(none.is_none());
    assert_eq!(said[0].code.as_str(), "E0803");
}

/// Two sections that may slide along opposite walls, around racks: where the loop is the shortest there is nothing to choose,
/// and at the ends of the walls there is no room to turn.
#[test]
fn sections_that_slide_leave_room_to_turn() {
    let lines = "  building [(0 m, 0 m), (80 m, 0 m), (80 m, 40 m), (0 m, 40 m)] clearance 0.2 m\n  \
                 obstacle rack [(20 m, 14 m), (60 m, 14 m), (60 m, 24 m), (20 m, 24 m)] clearance 0.5 m\n  \
                 section a 24 m within (2 m, 2 m)..(78 m, 2 m)\n  section b 24 m within (78 m, 38 m)..(2 m, 38 m)\n  \
                 route a, b\n";
    let found = found(&hall("standard", lines));
    sound(&found);
    let stage = found.stages.last().unwrap();
    // The same hall with four vertices drawn by hand, by the solver.
    assert!(stage.length < 142.7, "{}", stage.length);
    let certificate = stage.certificate.as_ref().unwrap();
    assert!(certificate.lower_bound >= found.summary.shortest, "{certificate:?}");
}
