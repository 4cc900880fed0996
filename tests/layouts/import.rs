//! Drawings from CAD: what this tool draws comes back the same, and what other programs draw is read.

#![allow(clippy::expect_used, clippy::unwrap_used)]

use std::path::{Path, PathBuf};

use lss::base::trig;
use lss::compiled::Compiled;
use lss::diagnostic::{Code, Diagnostic};
use lss::emit::dxf;
use lss::geometry::{Point, Track};
use lss::import::{self, LengthUnit, Options, Plan};
use lss::model::Layout;
use lss::semantics::analyse;
use lss::solve;
use lss::source::{Loader, SourceMap};

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

fn layout(name: &str, text: &str) -> (Option<Layout>, Vec<Diagnostic>) {
    let mut sources = SourceMap::default();
    let (mut loader, main) = Loader::memory(&mut sources, &[(name, text.as_bytes())]).expect("text");
    let analysis = analyse(&mut sources, &mut loader, main, None);
    let layout = analysis.chosen().ok().flatten().cloned();
    (layout, analysis.diagnostics)
}

fn read(text: &str, options: &Options) -> (Option<Plan>, Vec<Diagnostic>) {
    let mut sources = SourceMap::default();
    let file = sources.add("plan.dxf", text);
    import::read(&sources, file, options)
}

fn fixture(name: &str) -> String {
    let bytes = std::fs::read(folder("tests/fixtures/drawings").join(name)).expect("a fixture");
    String::from_utf8(bytes).unwrap_or_else(|e| e.as_bytes().iter().map(|b| char::from(*b)).collect())
}

/// The plan of a drawing and the layout that it becomes; neither has mistakes.
fn imported(text: &str, options: &Options) -> (Plan, Layout, Vec<Diagnostic>) {
    let (plan, said) = read(text, options);
    let plan = plan.unwrap_or_else(|| panic!("{said:#?}"));
    let source = import::write(&plan, "plan", "Imported.");
    let (layout, found) = layout("plan.lss", &source);
    assert!(!found.iter().any(Diagnostic::is_error), "{source}\n{found:#?}");
    (plan, layout.expect("a layout"), said)
}

fn same_points(a: &[Point], b: &[Point], within: f64) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.distance(*b) < within)
}

/// The drawing of a layout, imported, has its vertices, names, length, width and areas.
fn comes_back(name: &str, compiled: &Compiled) {
    let (_, back, said) = imported(&dxf::drawing(compiled).expect("drawn"), &Options::default());
    assert!(said.is_empty(), "{name}: {said:#?}");
    let track = Track::new(&back.corners());
    assert!((track.length - compiled.track.length).abs() < 1e-6, "{name}");
    assert_eq!(back.vertices.len(), compiled.layout.vertices.len(), "{name}");
    for ((a, b), written) in track.corners.iter().zip(&compiled.track.corners).zip(&compiled.layout.vertices) {
        assert!(a.point.distance(b.point) < 1e-6 && (a.radius - b.radius).abs() < 1e-6, "{name}: {a:?} {b:?}");
        assert!(back.vertices.iter().any(|v| v.name == written.name), "{name}: {}", written.name);
    }
    let order: Vec<&str> = back.vertices.iter().map(|v| v.name.as_str()).collect();
    let written: Vec<&str> = compiled.layout.vertices.iter().map(|v| v.name.as_str()).collect();
    assert_eq!(order, written, "{name}");
    assert!((back.width.value - compiled.layout.width.value).abs() < 1e-9, "{name}");
    assert_eq!(back.building.is_some(), compiled.layout.building.is_some(), "{name}");
    for (a, b) in back.building.iter().zip(&compiled.layout.building) {
        assert!(same_points(a.polygon.points(), b.polygon.points(), 1e-6), "{name}");
        assert!((a.clearance - b.clearance).abs() < 1e-6, "{name}: {} {}", a.clearance, b.clearance);
    }
    assert_eq!(back.obstacles.len(), compiled.layout.obstacles.len(), "{name}");
    for (a, b) in back.obstacles.iter().zip(&compiled.layout.obstacles) {
        assert_eq!(a.name, b.name, "{name}");
        assert!(same_points(a.polygon.points(), b.polygon.points(), 1e-6), "{name}: {}", a.name);
        assert!((a.clearance - b.clearance).abs() < 1e-6, "{name}: {} {}", a.clearance, b.clearance);
    }
}

fn examples() -> Vec<(String, Layout)> {
    let mut list = Vec::new();
    for entry in std::fs::read_dir(folder("examples")).expect("examples") {
        let path = entry.expect("an entry").path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        // It holds mistakes on purpose.
        if name.ends_with(".lss") && name != "errors.lss" {
            let text = std::fs::read_to_string(&path).expect("an example");
            let (layout, found) = layout(&name, &text);
            list.push((name, layout.unwrap_or_else(|| panic!("{found:#?}"))));
        }
    }
    assert!(list.len() >= 8);
    list.sort_by(|a, b| a.0.cmp(&b.0));
    list
}

#[test]
fn every_example_comes_back_as_written() {
    // A route has no track to draw before it is built.
    for (name, layout) in examples().into_iter().filter(|(_, layout)| layout.route.is_none()) {
        comes_back(&name, &Compiled::new(layout, Vec::new()));
    }
}

#[test]
fn an_optimised_layout_comes_back() {
    let (name, layout) = examples().into_iter().find(|(name, _)| name == "smallest.lss").expect("an example");
    let stages = solve::solve(&layout, &solve::Options::default(), &|_| ());
    comes_back(&name, &Compiled::new(layout, stages));
}

/// Straights without length are not drawn. The loop begins behind one, between two arcs that turn the same way, which
/// must not become a single vertex.
#[test]
fn arcs_that_meet_directly_come_back() {
    let t = 4.0 * trig::tan(trig::PI / 8.0);
    let corners =
        [(0.0, t), (t, 0.0), (30.0, 0.0), (30.0, 20.0), (0.0, 20.0)].map(|(x, y)| format!("({x} m, {y} m) radius 4 m"));
    let vertices: String = corners.iter().enumerate().map(|(i, at)| format!("  vertex V{i} {at}\n")).collect();
    // The diagonal is as long as its two tangents: 4 tan 22.5° √2.
    let text = format!(
        "use std.carts.tilt_tray\nuse std.tracks.thesis\nlayout l {{\n  catalog thesis\n  \
         cart tilt_tray(length: 1250 mm)\n  speed 2 m/s\n  width 1 m\n{}  optimise nothing\n}}\n",
        vertices.replace(&format!("{t} m"), &format!("{} m", 2.0 * t / trig::hypot(1.0, 1.0)))
    );
    let (layout, found) = layout("l.lss", &text);
    let layout = layout.unwrap_or_else(|| panic!("{found:#?}"));
    let compiled = Compiled::new(layout, Vec::new());
    assert!(compiled.track.straight(0).length.abs() < 1e-9);
    comes_back("arcs", &compiled);
}

#[test]
fn reverse_drives_the_other_way() {
    let (_, layout) = examples().swap_remove(0);
    let text = dxf::drawing(&Compiled::new(layout.clone(), Vec::new())).expect("drawn");
    let (_, back, _) = imported(&text, &Options { reverse: true, ..Options::default() });
    let (there, back) = (Track::new(&layout.corners()), Track::new(&back.corners()));
    assert!((there.length - back.length).abs() < 1e-6);
    let turn = |track: &Track| track.fillets.iter().map(|f| f.turn).sum::<f64>();
    assert!((turn(&there) + turn(&back)).abs() < 1e-9);
}

const RACE: [(f64, f64, f64); 6] =
    [(2.0, 1.0, 4.0), (32.0, 1.0, 4.0), (32.0, 21.0, 5.0), (18.0, 21.0, 3.0), (18.0, 12.0, 3.0), (2.0, 12.0, 4.0)];

/// The vertices up to where the loop begins, each within `within` m.
fn expect(plan: &Plan, expected: &[(f64, f64, f64)], within: f64) {
    let found: Vec<(f64, f64, f64)> =
        plan.vertices.iter().map(|v| (v.corner.point.x, v.corner.point.y, v.corner.radius)).collect();
    assert_eq!(found.len(), expected.len(), "{found:?}");
    let near = |a: &(f64, f64, f64), b: &(f64, f64, f64)| {
        (a.0 - b.0).abs() < within && (a.1 - b.1).abs() < within && (a.2 - b.2).abs() < within
    };
    let n = expected.len();
    let fits = (0..n).any(|k| (0..n).all(|i| near(&found[i], &expected[(i + k) % n])));
    assert!(fits, "{found:?}\n{expected:?}");
}

#[test]
fn polylines_with_bulges_in_millimetres() {
    let options = Options {
        centre_line: "fahrlinie".into(),
        building: "Gebäude".into(),
        obstacles: vec!["Stützen".into()],
        ..Options::default()
    };
    let (plan, layout, said) = imported(&fixture("polyline_mm.dxf"), &options);
    assert!(said.is_empty(), "{said:#?}");
    assert_eq!(plan.unit, LengthUnit::Millimetre);
    // Each half circle of 4 m becomes two right angles.
    expect(&plan, &[(6.0, 0.0, 4.0), (34.0, 0.0, 4.0), (34.0, 8.0, 4.0), (6.0, 8.0, 4.0)], 1e-9);
    assert!((plan.length - (40.0 + 8.0 * trig::PI)).abs() < 1e-9);
    assert!((layout.building.expect("a building").polygon.area() - 800.0).abs() < 1e-9);
    let [column, stair] = &layout.obstacles[..] else { panic!("{:?}", layout.obstacles) };
    assert_eq!((column.name.as_str(), stair.name.as_str()), ("obstacle_1", "Treppe_2"));
    // The polygon holds the round column, and not much more.
    let middle = Point::new(20.0, 4.0);
    let corners = column.polygon.points().iter().map(|p| p.distance(middle));
    assert!(corners.fold(0.0, f64::max) < 0.511);
    assert!((column.polygon.distance_to_outline(middle) - 0.5).abs() < 1e-9);
}

#[test]
fn r12_polylines_in_inches() {
    let text = fixture("r12_inch.dxf");
    let (plan, said) = read(&text, &Options::default());
    assert!(plan.is_none());
    assert_eq!(said.iter().map(|d| d.code).collect::<Vec<_>>(), [Code::E0802]);
    let options = Options { unit: Some(LengthUnit::Inch), ..Options::default() };
    let (plan, layout, _) = imported(&text, &options);
    expect(&plan, &RACE, 1e-6);
    assert!((layout.building.expect("a building").polygon.area() - 38.0 * 28.0).abs() < 1e-6);
}

#[test]
fn loose_pieces_with_gaps_are_healed() {
    let options = Options { centre_line: "0".into(), ..Options::default() };
    let (plan, _, said) = imported(&fixture("loose_mm.dxf"), &options);
    let s = 8.0 * trig::tan(trig::PI / 8.0) * 0.5_f64.sqrt();
    let race = [
        (0.0, 0.0, 4.0),
        (30.0, 0.0, 4.0),
        (30.0, 14.0, 4.0),
        (30.0 - s, 14.0 + s, 4.0),
        (30.0 - s, 26.0, 4.0),
        (0.0, 26.0, 4.0),
    ];
    let mut back = race;
    back.reverse();
    let counter_clockwise = Track::new(&plan.vertices.iter().map(|v| v.corner).collect::<Vec<_>>())
        .fillets
        .iter()
        .map(|f| f.turn)
        .sum::<f64>()
        > 0.0;
    expect(&plan, if counter_clockwise { &race } else { &back }, 1e-3);
    assert_eq!(said.iter().map(|d| d.code).collect::<Vec<_>>(), [Code::W0801]);
    assert_eq!(plan.healed.dropped, 1);
    // Vertices away from the S are whole millimetres again, and turns right angles.
    let whole =
        |v: &import::DrawnVertex| (v.corner.point.x * 1e3).fract() == 0.0 && (v.corner.point.y * 1e3).fract() == 0.0;
    assert!(plan.vertices.iter().filter(|v| whole(v)).count() >= 4, "{:?}", plan.vertices);
    assert!(plan.healed.gaps > 8 && plan.healed.largest_gap < 3e-4 && plan.healed.largest_shift < 4e-4, "{plan:#?}");
    // With less tolerance the gaps are a mistake that says where and how wide.
    let (plan, said) = read(&fixture("loose_mm.dxf"), &Options { tolerance: 2e-5, ..options });
    assert!(plan.is_none() && said.iter().any(|d| d.code == Code::E0804), "{said:#?}");
}

#[test]
fn blocks_are_where_they_are_inserted() {
    let (plan, layout, said) = imported(&fixture("blocks.dxf"), &Options::default());
    assert!(said.iter().all(|d| !d.is_error()), "{said:#?}");
    // Enlarged twice and turned left by a right angle about (1, 1), which comes to lie at (10, 5).
    let placed = RACE.map(|(x, y, r)| (10.0 - (y - 2.0), 5.0 + (x - 2.0), r));
    expect(&plan, &placed, 1e-6);
    assert_eq!(layout.obstacles.len(), 3);
    let (low, high) = layout.obstacles[2].polygon.bounds();
    assert!(low.distance(Point::new(5.0, 12.0)) < 1e-9 && high.distance(Point::new(5.4, 12.4)) < 1e-9);
}

#[test]
fn sharp_corners_need_a_radius() {
    let text = fixture("sharp.dxf");
    let (plan, said) = read(&text, &Options::default());
    assert!(plan.is_none());
    assert_eq!(said.iter().map(|d| d.code).collect::<Vec<_>>(), [Code::E0805]);
    assert_eq!(said[0].related.len(), 5);
    let (plan, _, _) = imported(&text, &Options { radius: Some(3.0), ..Options::default() });
    expect(&plan, &RACE.map(|(x, y, _)| (x, y, 3.0)), 1e-9);
}

/// A small generator for reproducible damage (Marsaglia's xorshift).
fn random(state: &mut u64) -> usize {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    (*state >> 11) as usize
}

#[test]
fn damaged_drawings_give_messages() {
    let names = ["polyline_mm.dxf", "r12_inch.dxf", "loose_mm.dxf", "blocks.dxf", "sharp.dxf"];
    let mut state = 0x9E37_79B9_7F4A_7C15;
    for name in names {
        let whole = fixture(name);
        let lines: Vec<&str> = whole.lines().collect();
        for round in 0..120 {
            let mut kept: Vec<String> = lines.iter().map(|l| l.to_string()).collect();
            match round % 4 {
                0 => kept.truncate(random(&mut state) % lines.len()),
                1 => {
                    kept.remove(random(&mut state) % lines.len());
                }
                2 => {
                    for _ in 0..6 {
                        let words =
                            ["nan", "1e308", "-1", "0", "INSERT", "POLYLINE", "", "é", "SECTION", "ENDBLK", "70"];
                        let at = random(&mut state) % kept.len();
                        kept[at] = words[random(&mut state) % words.len()].to_string();
                    }
                }
                _ => {
                    for _ in 0..4 {
                        let (a, b) = (random(&mut state) % kept.len(), random(&mut state) % kept.len());
                        kept.swap(a, b);
                    }
                }
            }
            let options = Options {
                centre_line: if name == "loose_mm.dxf" { "0".into() } else { "TRACK_CENTRE".into() },
                unit: Some(LengthUnit::Millimetre),
                radius: Some(1.0),
                ..Options::default()
            };
            let (plan, said) = read(&kept.join("\n"), &options);
            assert!(plan.is_some() || said.iter().any(Diagnostic::is_error), "{name} {round}");
            if let Some(plan) = plan {
                import::write(&plan, "plan", "Imported.");
            }
        }
    }
}

#[test]
fn blocks_that_insert_each_other_without_end_are_refused() {
    let mut text = String::from("0\nSECTION\n2\nBLOCKS\n");
    for k in 0..12 {
        text += &format!("0\nBLOCK\n2\nB{k}\n10\n0\n20\n0\n");
        for _ in 0..10 {
            text += &format!("0\nINSERT\n8\nTRACK_CENTRE\n2\nB{}\n10\n0\n20\n0\n", (k + 1) % 13);
        }
        text += "0\nENDBLK\n";
    }
    text += "0\nENDSEC\n0\nSECTION\n2\nENTITIES\n0\nINSERT\n2\nB0\n10\n0\n20\n0\n0\nENDSEC\n0\nEOF\n";
    let (plan, said) = read(&text, &Options { unit: Some(LengthUnit::Metre), ..Options::default() });
    assert!(plan.is_none());
    assert!(said.iter().any(|d| d.code == Code::E0309), "{said:#?}");
}
