//! The file as two other programs read it: the `dxf` crate and, where Python has it, ezdxf with its audit.

use std::collections::{BTreeMap, BTreeSet};
use std::io::Write;
use std::process::{Command, Stdio};

use ::dxf::Drawing;
use ::dxf::entities::EntityType;

use super::*;
use crate::base::trig;
use crate::emit::plan::samples;

fn samples() -> Vec<(&'static str, Compiled)> {
    vec![
        ("rectangle", samples::rectangle()),
        ("ten_vertices", samples::ten_vertices()),
        ("crowded", samples::crowded()),
        ("failed", samples::failed()),
        ("raised", samples::raised()),
        ("equipped", samples::equipped()),
    ]
}

/// Number of arcs and length of the lines and arcs of a layer.
fn arcs_and_length(drawing: &Drawing, layer: &str) -> (usize, f64) {
    let (mut arcs, mut length) = (0, 0.0);
    for entity in drawing.entities().filter(|entity| entity.common.layer == layer) {
        match &entity.specific {
            EntityType::Line(line) => length += trig::hypot(line.p2.x - line.p1.x, line.p2.y - line.p1.y),
            EntityType::Arc(arc) => {
                arcs += 1;
                length += arc.radius * (arc.end_angle - arc.start_angle).rem_euclid(360.0) * trig::PI / 180.0;
            }
            other => panic!("{other:?}"),
        }
    }
    (arcs, length)
}

#[test]
fn the_centre_line_keeps_its_arcs_and_length() {
    for (name, compiled) in samples() {
        let text = drawing(&compiled).expect("drawn");
        let read = Drawing::load(&mut text.as_bytes()).expect("a DXF file");
        assert_eq!(read.header.default_drawing_units, ::dxf::enums::Units::Meters, "{name}");
        let (arcs, length) = arcs_and_length(&read, "TRACK_CENTRE");
        assert_eq!(arcs, compiled.track.corners.len(), "{name}");
        assert!((length - compiled.track.length).abs() < 1e-9, "{name}: {length}");
        // Both sides together are twice the centre line: each arc gains outside what it loses inside.
        let sides = arcs_and_length(&read, "TRACK_LEFT").1 + arcs_and_length(&read, "TRACK_RIGHT").1;
        assert!((sides - 2.0 * compiled.track.length).abs() < 1e-9, "{name}: {sides}");
        let there: BTreeSet<&str> = read.layers().map(|layer| layer.name.as_str()).collect();
        assert!(LAYERS[..BESIDE].iter().all(|layer| there.contains(layer.name)), "{name}: {there:?}");
        let used: BTreeSet<&str> = read.entities().map(|entity| entity.common.layer.as_str()).collect();
        assert!(used.iter().all(|layer| there.contains(layer)), "{name}: {used:?}");
    }
}

#[test]
fn everything_is_on_its_layer() {
    let read = Drawing::load(&mut drawing(&samples::crowded()).expect("drawn").as_bytes()).expect("a DXF file");
    let mut count: BTreeMap<&str, usize> = BTreeMap::new();
    for entity in read.entities() {
        *count.entry(entity.common.layer.as_str()).or_default() += 1;
    }
    for (layer, expected) in
        [("BUILDING", 1), ("OBSTACLES", 3), ("INDUCTIONS", 2), ("CHUTES", 15), ("VERTICES", 6), ("SENSORS", 3)]
    {
        assert_eq!(count.get(layer), Some(&expected), "{layer}");
    }
    // 28.57 m of track with a support on both sides every metre.
    assert_eq!(count.get("SUPPORTS"), Some(&58));
    let texts: Vec<&str> = read
        .entities()
        .filter_map(
            |entity| if let EntityType::Text(text) = &entity.specific { Some(text.value.as_str()) } else { None },
        )
        .collect();
    for text in ["P1", "control cabinet", "south 9x", "0, 0"] {
        assert!(texts.contains(&text), "{text}: {texts:?}");
    }
}

/// Footprints have their size and stand beside the band; the conveyor runs from where it begins to the induction.
#[test]
fn equipment_of_declared_kinds_has_its_footprint() {
    let compiled = samples::equipped();
    assert!(compiled.placement.is_whole(), "{:?}", compiled.placement.missing);
    let read = Drawing::load(&mut drawing(&compiled).expect("drawn").as_bytes()).expect("a DXF file");
    let mut areas: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for entity in read.entities() {
        if let EntityType::LwPolyline(line) = &entity.specific {
            let p: Vec<Point> = line.vertices.iter().map(|v| Point::new(v.x, v.y)).collect();
            let area = (0..p.len()).map(|i| p[i].cross(p[(i + 1) % p.len()])).sum::<f64>() / 2.0;
            areas.entry(entity.common.layer.as_str()).or_default().push(area.abs());
        }
    }
    let near = |layer: &str, expected: &[f64]| {
        let found = areas.get(layer).cloned().unwrap_or_default();
        assert!(found.len() == expected.len(), "{layer}: {found:?}");
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{layer}: {found:?}");
    };
    near("INDUCTIONS", &[12.0]);
    near("CHUTES", &[3.0; 12]);
    // The scanner on both sides, and the gate.
    near("STATIONS", &[0.5, 0.5, 1.2]);
    let conveyors: Vec<_> = read.entities().filter(|e| e.common.layer == "CONVEYORS").collect();
    assert_eq!(conveyors.len(), 1);
    let EntityType::Line(line) = &conveyors[0].specific else { panic!("{:?}", conveyors[0]) };
    // From y = -7.6 to the outer edge, 4.6 m from the centre line: straight up.
    assert!((line.p1.x - 7.5).abs() < 1e-6 && (line.p1.y + 7.6).abs() < 1e-6, "{line:?}");
    assert!((line.p2.x - 7.5).abs() < 1e-6 && (line.p2.y + 4.6).abs() < 1e-6, "{line:?}");
}

/// Every piece of the bill is an insert of its article's block, which begins and ends where the piece does.
#[test]
fn pieces_are_blocks_that_join() {
    for (name, compiled) in samples() {
        let text = drawing(&compiled).expect("drawn");
        let read = Drawing::load(&mut text.as_bytes()).expect("a DXF file");
        let inserts: Vec<_> = read
            .entities()
            .filter_map(|e| if let EntityType::Insert(insert) = &e.specific { Some(insert) } else { None })
            .collect();
        assert_eq!(inserts.len(), compiled.bill.count, "{name}");
        let blocks: BTreeMap<&str, Vec<&::dxf::entities::Line>> = read
            .blocks()
            .map(|block| {
                let lines = block.entities.iter();
                let lines = lines.filter_map(|e| if let EntityType::Line(l) = &e.specific { Some(l) } else { None });
                (block.name.as_str(), lines.collect())
            })
            .collect();
        for (i, (insert, piece)) in inserts.iter().zip(&compiled.pieces).enumerate() {
            // Ends across the band: the first and the last line of the block; their middles, where they are inserted.
            let lines = &blocks[insert.name.as_str()];
            let turned = Point::unit(insert.rotation / 180.0 * trig::PI);
            let place = |p: &::dxf::Point, q: &::dxf::Point| {
                let (x, y) = ((p.x + q.x) / 2.0 * insert.x_scale_factor, (p.y + q.y) / 2.0);
                Point::new(insert.location.x, insert.location.y) + turned * x + turned.left() * y
            };
            let ends = [lines[0], lines[lines.len() - 1]].map(|line| place(&line.p1, &line.p2));
            let next = compiled.pieces[(i + 1) % compiled.pieces.len()].place.position;
            let wanted = [piece.place.position, next];
            let near = |[a, b]: [Point; 2]| a.distance(wanted[0]) < 1e-6 && b.distance(wanted[1]) < 1e-6;
            // The sequence closes to within rounding, or not at all where a layout is not feasible.
            let closes = i + 1 < compiled.pieces.len() || compiled.sequence.closure < 1e-6;
            assert!(!closes || near(ends) || near([ends[1], ends[0]]), "{name} {i}: {ends:?} {wanted:?}");
        }
    }
}

#[test]
fn signs_are_plain() {
    for (name, compiled) in samples() {
        let text = drawing(&compiled).expect("drawn");
        for sign in ["\\U+00B0", "\\U+00D7", "\\U+2192", "\\U+2220"] {
            assert!(!text.contains(sign), "{name}: {sign}");
        }
        assert!(text.contains("%%d"), "{name}");
    }
}

#[test]
fn the_same_layout_gives_the_same_bytes() {
    let compiled = samples::crowded();
    let text = drawing(&compiled).expect("drawn");
    assert_eq!(text, drawing(&compiled.clone()).expect("drawn"));
    assert!(text.is_ascii() && !text.contains("NaN") && !text.contains("inf"));
}

/// Reads a file from standard input, audits it, and prints what the test compares.
const SCRIPT: &str = r#"
import io, math, sys
try:
    import ezdxf
    from ezdxf import bbox
except ImportError:
    print("missing"); sys.exit(0)
document = ezdxf.read(io.StringIO(sys.stdin.read()))
auditor = document.audit()
problems = [str(e.message) for e in auditor.errors + auditor.fixes]
centre = document.modelspace().query('*[layer=="TRACK_CENTRE"]')
length = sum(e.dxf.start.distance(e.dxf.end) if e.dxftype() == "LINE"
             else math.radians((e.dxf.end_angle - e.dxf.start_angle) % 360) * e.dxf.radius for e in centre)
model = document.modelspace()
wrong = []
for d in model.query("DIMENSION"):
    measured = d.get_measurement()
    if not isinstance(measured, float):
        measured = measured.x if d.dxf.dimtype & 64 else measured.y
    block = document.blocks.get(d.dxf.geometry)
    shown = [t.dxf.text for t in block.query("TEXT")]
    number = "%.3f" % d.dxf.actual_measurement
    if abs(measured - d.dxf.actual_measurement) > 1e-9 or len(shown) != 1 or number not in shown[0]:
        wrong.append((d.dimtype, measured, d.dxf.actual_measurement, shown))
articles = {}
for i in model.query("INSERT"):
    values = {a.dxf.tag: a.dxf.text for a in i.attribs}
    asked = [a.dxf.tag for a in document.blocks.get(i.dxf.name).attdefs()]
    if asked != list(values):
        wrong.append((i.dxf.name, asked, values))
    articles[values["ARTICLE"]] = articles.get(values["ARTICLE"], 0) + 1
sheet = document.layout("Sheet")
windows = [v for v in sheet.query("VIEWPORT") if v.dxf.id > 1]
words = {t.dxf.text for t in sheet.query("TEXT")}
box = bbox.extents(document.modelspace().query('*[layer=="TRACK_LEFT" | layer=="TRACK_RIGHT"]'))
print(len(problems), *problems, sep=" | ")
print(len(centre.query("ARC")), repr(length), document.units, document.dxfversion)
print(repr(box.extmin.x), repr(box.extmin.y), repr(box.extmax.x), repr(box.extmax.y))
print(len(wrong), *wrong, sep=" | ")
print(*("%s=%d" % pair for pair in sorted(articles.items())), sep=";")
print(*(v.dxf.view_height / v.dxf.height * 1000 for v in windows), sep=";")
print(*document.layout_names(), sep=";")
print("general arrangement of the track" in words, "approved" in words)
"#;

fn ezdxf(text: &str) -> Option<Vec<String>> {
    let mut child =
        Command::new("python3").args(["-c", SCRIPT]).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().ok()?;
    // A reader that has gone away has said why on its standard output.
    let _ = child.stdin.take()?.write_all(text.as_bytes());
    let output = child.wait_with_output().ok()?;
    let lines: Vec<String> = String::from_utf8_lossy(&output.stdout).lines().map(str::to_owned).collect();
    assert!(output.status.success(), "{lines:?}");
    (lines[0] != "missing").then_some(lines)
}

#[test]
fn ezdxf_finds_no_fault() {
    for (name, compiled) in samples() {
        let Some(lines) = ezdxf(&drawing(&compiled).expect("drawn")) else {
            println!("skipped: python3 with ezdxf is not there");
            return;
        };
        assert_eq!(lines[0], "0", "{name}");
        let words: Vec<&str> = lines[1].split(' ').collect();
        assert_eq!(words[0].parse(), Ok(compiled.track.corners.len()), "{name}");
        let length: f64 = words[1].parse().expect("a number");
        assert!((length - compiled.track.length).abs() < 1e-9, "{name}: {length}");
        assert_eq!(&words[2..], ["6", "AC1015"], "{name}");
        let half = compiled.layout.width.value / 2.0;
        let sides = [half, -half].iter().flat_map(|shift| plan::side(&compiled.track, *shift)).collect::<Vec<_>>();
        let (low, high) = bounds(sides.iter().flat_map(|curve| <[Point; 2]>::from(curve.bounds())));
        let read: Vec<f64> = lines[2].split(' ').map(|word| word.parse().expect("a number")).collect();
        for (read, expected) in read.iter().zip([low.x, low.y, high.x, high.y]) {
            // ezdxf takes an arc's extent from a polyline.
            assert!((read - expected).abs() < 0.01, "{name}: {read} {expected}");
        }
        assert_eq!(lines[3], "0", "{name}");
        let bill: BTreeMap<&str, usize> =
            compiled.bill.lines.iter().map(|line| (line.article.as_str(), line.count)).collect();
        let bill: Vec<String> = bill.into_iter().map(|(article, count)| format!("{article}={count}")).collect();
        assert_eq!(lines[4], bill.join(";"), "{name}");
        let scale: f64 = lines[5].parse().expect("one window");
        let sheet = svg::furniture(&compiled).expect("a sheet").sheet;
        assert!((scale - sheet.scale).abs() < 1e-9, "{name}: {scale}");
        assert_eq!(&lines[6..8], ["Model;Sheet", "True True"], "{name}");
    }
}
