use super::mesh::{Mesh, Section};
use super::*;
use crate::base::trig;
use crate::compiled::fixture::compile;
use crate::emit::plan::samples;
use crate::geometry::{CentreLine, Form};
use crate::model::fixture;

const SECTION: Section = Section { half_width: 0.4, low: -0.3, high: -0.1 };

/// Volumes of boxes along curves (Pappus), and that every surface faces outwards.
#[test]
fn boxes_along_the_centre_line_enclose_what_they_should() {
    let area = 0.8 * 0.2;
    let cases = [
        (Form::Straight { length: 7.0, slope: 0.1 }, area * 7.0),
        (Form::Arc { radius: 4.0, turn: 1.2 }, area * 4.8),
        (Form::Arc { radius: 4.0, turn: -1.2 }, area * 4.8),
        // The middle of the section runs 0.2 m below the line: on the inside of a crest, on the outside of a sag.
        (Form::Vertical { radius: 10.0, slope_from: 0.0, slope_to: 0.15 }, area * trig::atan(0.15) * 10.2),
        (Form::Vertical { radius: 10.0, slope_from: 0.15, slope_to: 0.0 }, area * trig::atan(0.15) * 9.8),
    ];
    for (form, volume) in cases {
        // What follows keeps the line's end from being its begin, as in a loop.
        let after = Form::Straight { length: 5.0, slope: trig::tan(form.inclination().1) };
        let line = CentreLine::new([3.0, -2.0, 1.0, 0.7], &[form, after]);
        let mesh = Mesh::along(&line, 0.0, form.length(), SECTION);
        let found = mesh.volume();
        // Chords of 2.5° lose a ten-thousandth.
        assert!((found / volume - 1.0).abs() < 4e-4, "{form:?}: {found} for {volume}");
        closed(&mesh);
    }
    let block = Mesh::block(Vector3::new(1.0, 2.0, 0.5), 0.4, [2.0, 0.5, 3.0]);
    assert!((block.volume() - 3.0).abs() < 1e-12, "{}", block.volume());
    closed(&block);
}

/// Whether each edge is met once in each direction.
fn closed(mesh: &Mesh) {
    let key = |p: &Vector3<f64>| [p.x, p.y, p.z].map(|v| (v * 1e6).round() as i64);
    let mut edges = std::collections::BTreeMap::new();
    for t in mesh.positions.chunks_exact(3) {
        for k in 0..3 {
            *edges.entry((key(&t[k]), key(&t[(k + 1) % 3]))).or_insert(0) += 1;
        }
    }
    for ((a, b), count) in &edges {
        assert_eq!((*count, edges.get(&(*b, *a))), (1, Some(&1)), "{a:?} {b:?}");
    }
}

/// What another reader finds: names, articles, and where things are, y up.
#[test]
fn another_reader_finds_every_piece() {
    let compiled = samples::raised();
    let bytes = scene(&compiled);
    let file = gltf::Gltf::from_slice(&bytes).expect("valid glTF");
    let blob = file.blob.clone().expect("numbers");
    let roots: Vec<_> = file.scenes().next().unwrap().nodes().collect();
    let names: Vec<_> = roots.iter().map(|n| n.name().unwrap().to_owned()).collect();
    assert_eq!(names[0], "track");
    let pieces: Vec<_> = roots[0].children().collect();
    assert_eq!(pieces.len(), compiled.bill.count);
    let mut highest = f32::NEG_INFINITY;
    for (node, piece) in pieces.iter().zip(&compiled.pieces) {
        assert!(node.name().unwrap().ends_with(&piece.article));
        let extras: serde_json::Value = serde_json::from_str(node.extras().as_ref().unwrap().get()).unwrap();
        assert!((extras["length_m"].as_f64().unwrap() - piece.part.length()).abs() < 1e-6);
        let primitive = node.mesh().unwrap().primitives().next().unwrap();
        let reader = primitive.reader(|_| Some(&blob));
        let points: Vec<[f32; 3]> = reader.read_positions().unwrap().collect();
        let bounds = primitive.bounding_box();
        for p in &points {
            assert!((0..3).all(|k| bounds.min[k] <= p[k] && p[k] <= bounds.max[k]));
        }
        highest = highest.max(bounds.max[1]);
        // The piece begins beside its place in the plan: z is against y. A slope moves what lies below the line.
        let begin = piece.place.position;
        let near = points.iter().map(|p| trig::hypot(f64::from(p[0]) - begin.x, f64::from(p[2]) + begin.y));
        let near = near.fold(f64::INFINITY, f64::min);
        assert!((near - half_width(&compiled)).abs() < 0.06, "{} {near}", piece.article);
        let lengths = reader.read_normals().unwrap().map(|n| n.iter().map(|c| c * c).sum::<f32>());
        assert!(lengths.into_iter().all(|l| (l - 1.0).abs() < 1e-5));
    }
    // Rails lie below the centre line by the wheels' height and radius.
    let top = compiled.layout.levels.iter().map(|l| l.height).fold(f64::NEG_INFINITY, f64::max);
    assert!((f64::from(highest) - (top - below(&compiled))).abs() < 1e-3, "{highest} {top}");
}

/// Stations stand on the hall's floor, and a conveyor is as long as it is billed.
#[test]
fn stations_stand_on_the_floor_and_are_fed() {
    let compiled = samples::equipped();
    let bytes = scene(&compiled);
    let file = gltf::Gltf::from_slice(&bytes).expect("valid glTF");
    let group = |name: &str| {
        let nodes: Vec<_> = file.nodes().filter(|node| node.name() == Some(name)).collect();
        nodes[0].children().map(|node| (node.name().unwrap().to_owned(), node.mesh().unwrap())).collect::<Vec<_>>()
    };
    let bounds = |mesh: &gltf::Mesh| mesh.primitives().next().unwrap().bounding_box();
    let stations = group("stations");
    assert!(stations.len() >= 15, "{}", stations.len());
    for (name, mesh) in &stations {
        let bounds = bounds(mesh);
        assert_eq!((bounds.min[1], bounds.max[1]), (0.0, 1.0), "{name}");
    }
    let conveyors = group("conveyors");
    let [(name, mesh)] = conveyors.as_slice() else { panic!("{} conveyors", conveyors.len()) };
    assert_eq!(name, "conveyor to west");
    let bounds = bounds(mesh);
    let billed = compiled.placement.placed.iter().find_map(|placed| placed.conveyor).unwrap();
    // It comes straight from the south, where z is against y.
    assert!((f64::from(bounds.max[2] - bounds.min[2]) - billed).abs() < 1e-3, "{bounds:?} {billed}");
    assert!((f64::from(bounds.max[2]) - 7.6).abs() < 1e-3, "{bounds:?}");
    // Beside a raised track blocks end at its height, and no block reaches below the floor.
    assert_eq!([foot(3.0, 1.0), foot(0.4, 1.0), foot(0.0, 1.0), foot(-0.5, 1.0)], [2.0, 0.0, 0.0, -0.5]);
}

#[test]
fn a_layout_on_the_floor_has_no_posts_and_gives_the_same_bytes() {
    let mut layout = fixture::rectangle(20.0, 10.5, 4.0);
    layout.equipment.supports = Some(crate::source::Spanned { value: 2.5, span: fixture::span() });
    let compiled = compile(layout);
    let bytes = scene(&compiled);
    assert_eq!(bytes, scene(&compiled));
    let file = gltf::Gltf::from_slice(&bytes).expect("valid glTF");
    let names: Vec<_> = file.nodes().filter_map(|n| n.name().map(str::to_owned)).collect();
    assert!(!names.iter().any(|n| n.starts_with("support")), "{names:?}");
    assert!(["M1", "M4", "swept by carts"].iter().all(|n| names.iter().any(|m| m == n)), "{names:?}");
}
